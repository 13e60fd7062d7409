//! Recordings of real mechanisms, and where models of them fall short.
//!
//! [`data`] reads recordings: values in SI at increasing times, bound to the names of a spec, each
//! channel with its noise level, and with everything said that was mended or looks wrong. [`identify`]
//! finds parameters from them, [`inverse`] from motions whose inputs nobody knows. [`motion_capture`]
//! makes recordings of a capture of rigid bodies. [`effects`] are what a model may lack, and [`diagnose`]
//! tells which of them it does. [`experiment`] has inputs that excite a mechanism.

pub mod data;
pub mod diagnose;
pub mod effects;
pub mod experiment;
pub mod identify;
pub mod inverse;
pub mod motion_capture;
mod slope;
