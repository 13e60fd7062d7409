//! Recordings of real mechanisms, identification, and diagnosis of model gaps.
//!
//! [`data`] reads recordings: values in SI at increasing times, bound to the names of a spec, each
//! channel with its noise level, with findings on repairs and doubts. [`identify`] estimates
//! parameters from them, [`inverse`] from motions with unknown inputs. [`motion_capture`] makes
//! recordings of a capture of rigid bodies. [`effects`] is the library of effects that a model may
//! lack, and [`diagnose`] finds those that it does. [`experiment`] has inputs that excite a
//! mechanism.

pub mod data;
pub mod diagnose;
pub mod effects;
pub mod experiment;
mod held_out;
pub mod identify;
pub mod inverse;
pub mod motion_capture;
mod slope;
