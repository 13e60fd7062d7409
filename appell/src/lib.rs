//! appell: from a mechanism spec to equations of motion, motions, gains and diagnoses.
//!
//! Every command of the command line has a counterpart, mostly one call of a [`Model`] or of its
//! [`Source`]; that of `appell reproduce` is the crate `appell-papers`:
//!
//! | call | command |
//! |---|---|
//! | [`Model::from_spec`], [`Model::shipped`], [`Model::find`] | `MODEL` of every command |
//! | [`Model::simulate`], [`Model::simulate_batch`] with a [`Motion`] | `appell simulate` |
//! | [`Model::steady`] with a [`steady::Question`] | `appell steady`, `appell stability` |
//! | [`Model::control`], [`Model::schedule`] with a [`control::Request`], [`Model::law`], [`Model::attraction`] | `appell control` |
//! | [`Source::check`] | `appell check` |
//! | [`Source::derivation`], [`Source::linear_equations`], [`Source::rust`], [`Source::expanded`] | `appell derive` |
//! | [`Source::drawing`] | `appell draw` |
//! | [`Source::fmu`] | `appell export` |
//! | [`Model::evaluation`] | `appell evaluate` |
//! | [`capture::convert`] | `appell motion` |
//! | [`recording::read`], [`Model::identify`] | `appell recording`, `appell identify` |
//! | [`Model::inverse`] | `appell inverse` |
//! | [`diagnose()`], [`diagnosis::Library`] | `appell diagnose` |
//! | [`effects::library`], [`effects::Example`] | `appell effects` |
//! | [`sample::rig`], [`sample::robot`] | `appell sample` |
//! | [`robot::read`], [`robot::import`] | `appell import` |
//! | [`ensemble::Ensemble`] | `appell ensemble` |
//! | [`Source::improved`], [`correction::correct`] with a [`gap_report::GapReport`] | `appell apply` |
//!
//! Numbers given as texts are in the units of the spec, or have units of their own; results are in SI.
//! Types of lower-level crates that occur in signatures are re-exported. Pages are those of the crate
//! `appell-report`.

pub mod base;
mod batch;
#[cfg(feature = "cache")]
pub mod cache;
pub mod capture;
#[cfg(feature = "cuda")]
pub mod card;
pub mod cases;
pub mod check;
pub mod comparison;
mod conditions;
pub mod control;
pub mod correction;
pub mod derivation;
pub mod diagnosis;
pub mod difference;
pub mod effects;
pub mod engine;
pub mod ensemble;
mod error;
pub mod evaluation;
mod field;
pub mod files;
pub mod fleet;
pub mod fmu;
mod formula;
pub mod gap_report;
pub mod identification;
pub mod improved;
pub mod inputs;
pub mod inverse;
pub mod json;
mod model;
mod motion;
pub mod places;
pub mod recording;
pub mod robot;
pub mod sample;
pub mod setup;
pub mod source;
pub mod steady;

pub use appell_gap::diagnose::Options as DiagnosisOptions;
pub use appell_recordings::DataSet;
pub use appell_report::figure;
pub use appell_runtime::Trajectory;
pub use appell_runtime::inputs::{InputSource, ModelInputs, TabulatedInputs};
pub use appell_runtime::integrate::Options as IntegrationOptions;
pub use appell_runtime::model::{Model as EquationsOfMotion, ModelInfo, Quantity};
pub use appell_runtime::signal::SignalError;
pub use appell_runtime::simulate::{Method, Response, SimulationError, Validity};
pub use appell_runtime::trajectory::{CsvOptions, Extras};
pub use appell_spec::{Code, Diagnostic, Mechanism, Report, Severity};
pub use error::{Class, Error, ExpressionError};
pub use field::Field;
pub use inputs::tabulated::Remarks;
pub use model::{Model, diagnose};
pub use motion::{Driven, Law, MOST_ROWS, Motion, Simulated};
pub use source::Source;
