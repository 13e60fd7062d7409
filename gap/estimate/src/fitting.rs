//! Maximum-likelihood fits.
//!
//! | file | idea |
//! |---|---|
//! | `levels.rs` | steps of levels of noise |
//! | `level_scaling.rs` | levels of process noise relative to the inertia |
//! | `curvature.rs` | expected, observed and updated curvature |
//! | `fit.rs` | quasi-Newton fits |
//! | `free.rs` | free values, their coordinates, limits and priors |
//! | `posterior.rs` | the log-posterior |
//! | `regression.rs` | parameters from accelerations, without a filter |
//! | `scoring.rs` | fits by Fisher scoring, in few passes |

pub(crate) mod curvature;
pub(crate) mod fit;
pub(crate) mod free;
pub(crate) mod level_scaling;
mod levels;
pub(crate) mod posterior;
pub(crate) mod regression;
pub(crate) mod scoring;
