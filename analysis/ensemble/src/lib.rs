//! Ensembles of cases.
//!
//! - [`study`]: the study file;
//! - [`random`], [`distribution`], [`design`]: which values the factors have in each case, from its number alone;
//! - [`rows`], [`chunk`], [`store`]: rows of results, in chunks that are written atomically;
//! - [`mod@run`]: runs the missing chunks on several threads, through the narrow trait [`run::Engine`];
//! - [`summary`], [`statistics`]: statistics of the rows;
//! - [`splitting`]: probabilities of rare events;
//! - [`limits`]: limits on the size of a study.
//!
//! A row depends on its case alone, and statistics read rows in the order of cases: no result depends on the number
//! of threads, on the size of the chunks, or on the machines.

pub mod chunk;
pub mod design;
pub mod digest;
pub mod distribution;
pub mod limits;
pub mod normal;
#[cfg(feature = "object-store")]
pub mod objects;
pub mod random;
pub mod rows;
pub mod run;
mod sobol;
pub mod splitting;
pub mod statistics;
pub mod store;
pub mod study;
pub mod summary;
mod table_file;

pub use table_file::TAKEN;
