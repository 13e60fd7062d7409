//! appell: from a mechanism spec to equations of motion, motions, gains and diagnoses.
//!
//! Whatever the command line does, a program does with one call of a [`Model`]:
//!
//! | call | command |
//! |---|---|
//! | [`Model::from_spec`], [`Model::shipped`], [`Model::find`] | `MODEL` of every command |
//! | [`Model::simulate`] with a [`Motion`] | `appell simulate` |
//! | [`Model::steady`] with a [`steady::Question`] | `appell steady`, `appell stability` |
//! | [`Model::control`] with a [`control::Request`], [`Model::law`] | `appell control` |
//! | [`recording::read`], [`Model::identify`] | `appell recording`, `appell identify` |
//! | [`diagnose()`], [`diagnosis::Library`] | `appell diagnose` |
//!
//! Numbers given as texts are in the units of the spec, or have units of their own; results are in SI.
//! Pages, figures and drawings are those of the crate `appell-report`.

pub mod cases;
pub mod conditions;
pub mod control;
pub mod diagnosis;
pub mod engine;
mod error;
pub mod files;
pub mod formula;
pub mod inputs;
mod model;
mod motion;
pub mod recording;
pub mod setup;
pub mod source;
pub mod steady;

pub use appell_gap::diagnose::Options as Diagnosis;
pub use error::Error;
pub use model::{Model, diagnose};
pub use motion::{Law, MOST_ROWS, Motion, Simulated};
