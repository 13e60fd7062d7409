//! Recordings of real mechanisms, and where models of them fall short.
//!
//! [`data`] reads recordings: values in SI at increasing times, bound to the names of a spec, each
//! channel with its noise level, and with everything said that was mended or looks wrong. [`identify`]
//! finds parameters from them.

pub mod data;
pub mod identify;
