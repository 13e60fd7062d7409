//! The most likely values.
//!
//! | file | idea |
//! |---|---|
//! | `level_scaling.rs` | levels of process noise that follow the inertia |
//! | `curvature.rs` | the second derivatives that a search begins with |
//! | `fit.rs` | the search itself |
//! | `free.rs` | which values are free, and within which limits |
//! | `posterior.rs` | the likelihood with the priors |
//! | `regression.rs` | parameters from accelerations, without a filter |
//! | `scoring.rs` | fits in few passes |

pub(crate) mod curvature;
pub(crate) mod fit;
pub(crate) mod free;
pub(crate) mod level_scaling;
pub(crate) mod posterior;
pub(crate) mod regression;
pub(crate) mod scoring;
