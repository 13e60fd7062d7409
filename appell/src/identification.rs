//! Estimation of parameters from recordings: the options and results of [`crate::Model::identify`].

pub use appell_estimate::EstimateError;
pub use appell_gap::identify::{
    Answer, Begin, Course, Estimate, HeldOut, IdentifyError, Known, Level, Options, Trace,
};
