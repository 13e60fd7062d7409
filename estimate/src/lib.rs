//! Estimation: how likely recordings are under a model, and which values make them likely.
//!
//! A [`Setup`] says what is measured and what disturbs the motion; with [`Recording`]s it becomes an
//! [`Estimation`], a function of the values that its [`Layout`] lists: parameters of the model,
//! levels of disturbances and of noise, biases, scales and delays of sensors, lags and delays of
//! inputs, initial states. All in SI.
//!
//! ```text
//! dx = (f(t, x, u, p) + G w) dt     w white, G = M⁻¹ for forces
//! y  = scale · h(x, u, p) + bias + v    v white
//! ```
//!
//! The files, in the order of the computation:
//!
//! - [`recording`], [`setup`], [`unknown`], [`layout`]: what is given;
//! - [`timeline`]: the order of steps and samples;
//! - [`plant`], [`transition`]: the motion and its transition matrix, step by step, and which steps are
//!   too long;
//! - [`closure`]: closed loops, whose coordinates depend on each other;
//! - [`filter`], [`square_root`]: the extended Kalman filter, innovations, log-likelihood;
//! - [`tape`], [`adjoint`]: the gradient of the log-likelihood in all values by one sweep backwards over what
//!   the filter left;
//! - [`estimation`]: all of it behind one type;
//! - [`prediction`]: where the motion goes from what the filter knows;
//! - [`smoother`]: states given a whole recording;
//! - [`consistency`], [`chi_squared`]: whether innovations are what they should be;
//! - [`free`], [`posterior`], [`curvature`], [`fit`]: the most likely values;
//! - [`sensitivity`]: scores and Fisher's information;
//! - [`scoring`], [`level_scaling`]: scoring fits, with levels of process noise that scale with inertia;
//! - [`shooting`]: fits without disturbances, from starts far from the truth;
//! - [`tangent`], [`information`]: how innovations change with many values, and Fisher's information,
//!   in few passes;
//! - [`identifiability`], [`profile`], [`robust`]: what is known of the values, and how far;
//! - [`regression`]: parameters from accelerations, without a filter.
//!
//! Beside the likelihood:
//!
//! - [`inverse`]: the inputs of a measured motion, and what it must satisfy whatever they were;
//! - [`smoothing`]: derivatives of noisy samples with their covariance.

mod adjoint;
mod chi_squared;
mod closure;
mod consistency;
mod curvature;
mod error;
mod estimation;
mod filter;
mod fit;
mod free;
mod identifiability;
mod information;
pub mod inverse;
mod layout;
mod level_scaling;
mod matrix;
mod plant;
mod posterior;
mod prediction;
mod profile;
mod recording;
mod regression;
mod robust;
mod scoring;
mod sensitivity;
mod setup;
mod shooting;
mod smoother;
pub mod smoothing;
mod square_root;
mod tangent;
mod tape;
mod timeline;
mod transition;
mod unknown;

pub use chi_squared::{chi_squared_probability, chi_squared_quantile};
pub use consistency::Consistency;
pub use error::EstimateError;
pub use estimation::Estimation;
pub use filter::Innovation;
pub use fit::{Effort, Fit};
pub use free::{Coordinate, Free};
pub use identifiability::{Combination, Identifiability};
pub use layout::Layout;
pub use prediction::Predicted;
pub use recording::Recording;
pub use regression::{BaseParameters, Moment, Regression};
pub use robust::Blocks;
pub use sensitivity::Sensitivity;
pub use setup::{Channel, Disturbance, Measured, Setup};
pub use shooting::{Shooting, Shot};
pub use smoother::Smoothed;
pub use tangent::{Along, Direction, Shapes, Tangent};
pub use unknown::Unknown;
