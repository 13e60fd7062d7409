//! Identification from recordings, and diagnosis of model gaps.
//!
//! [`base`] finds the parameters that recordings can determine. [`identify`] estimates parameters from recordings,
//! [`inverse`] from motions with unknown inputs. [`effects`] is the library of effects that a model may lack, and
//! [`diagnose`] selects those that the recordings support. [`experiment`] has inputs that excite a mechanism. [`units`]
//! checks units and signs of channels first.

pub mod base;
pub mod diagnose;
pub mod effects;
pub mod experiment;
mod held_out;
pub mod identify;
pub mod inverse;
mod slope;
pub mod units;
