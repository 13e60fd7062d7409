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
//! - [`recording`], [`setup`], [`layout`]: what is given;
//! - [`timeline`]: the order of steps and samples;
//! - [`plant`], [`transition`]: the motion and its transition matrix, step by step;
//! - [`filter`], [`square_root`]: the extended Kalman filter, innovations, log-likelihood;
//! - [`adjoint`]: the gradient of the log-likelihood in all values by one sweep backwards;
//! - [`estimation`]: all of it behind one type;
//! - [`free`], [`fit`]: the most likely values;
//! - [`sensitivity`]: scores and Fisher's information.

mod adjoint;
mod error;
mod estimation;
mod filter;
mod fit;
mod free;
mod layout;
mod matrix;
mod plant;
mod recording;
mod sensitivity;
mod setup;
mod square_root;
mod timeline;
mod transition;

pub use error::EstimateError;
pub use estimation::Estimation;
pub use filter::Innovation;
pub use fit::{Effort, Fit};
pub use free::{Coordinate, Free};
pub use layout::{Layout, Unknown};
pub use recording::Recording;
pub use sensitivity::Sensitivity;
pub use setup::{Channel, Disturbance, Measured, Setup};
