//! Smoothing: derivatives of noisy samples with their standard deviations.
//!
//! | file | idea |
//! |---|---|
//! | `samples.rs` | measured values at increasing times; estimates of them |
//! | `savitzky_golay.rs`, `window.rs` | polynomials fitted in a moving window; choice of its width |
//! | `regression_spline.rs` | least-squares splines with knots shared by several quantities |
//! | `noise.rs` | the noise level, from differences and from standstill |
//! | `angle.rs` | unwrapped angles |

pub mod angle;
pub mod noise;
pub(crate) mod regression_spline;
pub mod samples;
pub mod savitzky_golay;
pub mod window;

pub use samples::{Estimate, Samples, SamplesError};
