//! Feedback about a steady motion: what the inputs reach, and gains that put the poles where they
//! are wanted.
//!
//! The way from a model to a law:
//!
//! 1. [`operating_point`]: δẋ = A δx + B δu about a motion, with what changes along it;
//! 2. [`controllability`]: what the inputs reach, which modes they do not;
//! 3. [`reduction`]: the exact equations of chosen outputs alone;
//! 4. [`placement`], [`robust_placement`] or [`lqr`]: the gains;
//! 5. [`feedback`]: `u = u₀ − K (y − y_des(t))` as the inputs of a simulation.
//!
//! Beside it: [`sampled`] and [`sampler`] for a controller that measures at intervals and acts with a
//! delay, [`schedule`] for gains over a speed, [`attraction`] for how large a disturbance may be.
//!
//! All matrices are in SI, in the order of the states and inputs that [`LinearSystem`] names.

pub mod attraction;
pub mod controllability;
mod echelon;
pub mod feedback;
pub mod linear_system;
pub mod lqr;
pub mod operating_point;
pub mod placement;
pub mod reduction;
pub mod riccati;
pub mod robust_placement;
pub mod sampled;
pub mod sampler;
pub mod schedule;
pub mod staircase;

pub use linear_system::LinearSystem;
