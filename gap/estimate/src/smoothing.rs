//! Smoothing: derivatives of noisy samples with their covariance.
//!
//! | file | idea |
//! |---|---|
//! | `samples.rs` | measured values at increasing times; estimates of them |
//! | `savitzky_golay.rs`, `window.rs` | polynomials fitted in a moving window; choice of its width |
//! | `kinematic.rs`, `spline.rs` | smoothing of integrated white noise; splines with cross-validation |
//! | `regression_spline.rs` | least-squares splines with knots shared by several quantities |
//! | `butterworth.rs` | a zero-phase low-pass filter |
//! | `noise.rs` | the noise level, from differences and from standstill |
//! | `angle.rs` | unwrapped angles |
//!
//! Choice of a smoother: [`kinematic`] if the noise is known; the likelihood determines the
//! smoothing, and the covariance is that of a model. [`spline`] if it is not. [`savitzky_golay`] if
//! the result must depend on neighbours only, with known weights. [`butterworth`] for a given
//! cut-off frequency, on uniform grids.

pub mod angle;
pub mod butterworth;
pub mod kinematic;
pub mod noise;
pub mod regression_spline;
pub mod samples;
pub mod savitzky_golay;
pub mod spline;
pub mod window;

pub use samples::{Estimate, Samples, SamplesError};
