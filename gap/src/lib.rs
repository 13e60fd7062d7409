//! Identification from recordings, and diagnosis of model gaps.
//!
//! [`base`] tells which parameters recordings can determine at all. [`identify`] estimates parameters from recordings, [`inverse`] from motions with unknown inputs.
//! [`effects`] is the library of effects that a model may lack, and [`diagnose`] finds those that it
//! does. [`experiment`] has inputs that excite a mechanism. [`units`] are checked before.

pub mod base;
pub mod diagnose;
pub mod effects;
pub mod experiment;
mod held_out;
pub mod identify;
pub mod inverse;
mod slope;
pub mod units;
