//! Maximum-likelihood fits.
//!
//! | file | idea |
//! |---|---|
//! | `base_parameters.rs` | combinations of parameters that the equations contain |
//! | `levels.rs` | steps of levels of noise |
//! | `level_scaling.rs` | levels of process noise relative to the inertia |
//! | `curvature.rs` | expected, observed and updated curvature |
//! | `fit.rs` | quasi-Newton fits |
//! | `free.rs` | free values, their coordinates, limits and priors |
//! | `posterior.rs` | the log-posterior |
//! | `scoring.rs` | fits by Fisher scoring, in few passes |

pub(crate) mod base_parameters;
pub(crate) mod curvature;
pub(crate) mod fit;
pub(crate) mod free;
pub(crate) mod level_scaling;
mod levels;
pub(crate) mod posterior;
pub(crate) mod scoring;
