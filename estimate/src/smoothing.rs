//! Smoothing: derivatives of noisy samples with their covariance.
//!
//! | file | idea |
//! |---|---|
//! | `samples.rs` | measured values at increasing times; what an estimate of them is |
//! | `savitzky_golay.rs`, `window.rs` | polynomials fitted in a window that moves; how wide it may be |
//! | `kinematic.rs`, `spline.rs` | integrated white noise, smoothed; splines with cross-validation |
//! | `regression_spline.rs` | splines of least squares with knots that several quantities share |
//! | `butterworth.rs` | a low-pass filter without a shift in phase |
//! | `noise.rs` | the noise level, from differences and from standstill |
//! | `angle.rs` | angles counted on through whole turns |
//!
//! Which smoother serves? [`kinematic`] where the noise is known: the likelihood chooses how much to
//! smooth, and the covariance is that of a model. [`spline`] where it is not. [`savitzky_golay`] where
//! the result must depend on neighbours only, and its weights must be known. [`butterworth`] where a
//! frequency is to be cut off, on uniform grids.

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
