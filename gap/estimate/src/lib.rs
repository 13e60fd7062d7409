//! Estimation: the likelihood of recordings under a model, and maximum-likelihood fits.
//!
//! A [`Setup`] defines the measurements and the disturbances; with [`Recording`]s it becomes an
//! [`Estimation`], a function of the values that its [`Layout`] lists: parameters of the model,
//! levels of disturbances and of noise, biases, scales, delays and lags of sensors, lags and delays
//! of inputs, initial states. All in SI.
//!
//! ```text
//! dx = (f(t, x, u, p) + G w) dt     w white, G = M⁻¹ for forces
//! y  = scale · h(x, u, p) + bias + v    v white
//! ```
//!
//! The modules, in the order of the computation:
//!
//! | module | idea |
//! |---|---|
//! | `data/` | setup, recordings, the values and their order |
//! | `motion/` | the order of steps and samples; the motion and its transition matrix, step by step; closed loops |
//! | `kalman/` | the extended Kalman filter: innovations, log-likelihood, predictions, smoothed states |
//! | `gradient/` | derivatives: of the log-likelihood by one reverse sweep, of innovations by forward passes; Fisher information |
//! | `estimation.rs` | setup, recordings, filter and gradient behind one type |
//! | `fitting/` | maximum-likelihood fits |
//! | `shooting/` | fits without disturbances, from starts far from the truth |
//! | `statistics/` | χ², robust covariance, consistency of innovations |
//! | `inverse/` | the inputs of a measured motion, and its input-free relations |
//! | `smoothing/` | derivatives of noisy samples with their standard deviations |
//! | `parallel.rs` | independent pieces of work on all processors |
//! | `matrix.rs`, `error.rs` | products of dense matrices; errors |

mod data;
mod error;
mod estimation;
mod fitting;
mod gradient;
pub mod inverse;
mod kalman;
mod matrix;
mod motion;
mod parallel;
mod shooting;
pub mod smoothing;
mod statistics;

pub use data::layout::Layout;
pub use data::recording::Recording;
pub use data::setup::{Channel, Disturbance, Measured, Setup};
pub use data::unknown::Unknown;
pub use error::EstimateError;
pub use estimation::Estimation;
pub use fitting::base_parameters::BaseParameters;
pub use fitting::fit::{Effort, Fit};
pub use fitting::free::{Coordinate, Free};
pub use gradient::direction::{Along, Direction, Shapes, Tangent};
pub use gradient::sensitivity::Sensitivity;
pub use kalman::filter::Innovation;
pub use kalman::prediction::Predicted;
pub use kalman::smoother::Smoothed;
pub use parallel::in_parallel;
pub use shooting::{Shooting, Shot};
pub use statistics::chi_squared::{HALF_WIDTH_95, chi_squared_probability, chi_squared_quantile};
pub use statistics::consistency::Consistency;
pub use statistics::robust::robust_covariance;
