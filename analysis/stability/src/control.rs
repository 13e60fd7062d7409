//! Feedback about a steady motion: controllability, and gains that place the poles.
//!
//! The steps from a model to a control law:
//!
//! 1. [`operating_point`]: δẋ = A δx + B δu about a steady motion;
//! 2. [`controllability`]: the controllable subspace and the uncontrollable modes;
//! 3. [`reduction`]: the exact equations of chosen outputs alone;
//! 4. [`placement`] or [`lqr`]: the gains;
//! 5. [`feedback`]: `u = u₀ − K (y − y_des(t))` as the inputs of a simulation.
//!
//! Also: [`sampled`] and [`sampler`] for sampled controllers with a delay, [`schedule`] for gain
//! schedules, [`attraction`] for regions of attraction.
//!
//! All matrices are in SI, in the order of the states and inputs that [`LinearSystem`] names.

pub mod attraction;
pub mod controllability;
pub mod feedback;
pub mod linear_system;
pub mod lqr;
pub mod operating_point;
pub mod placement;
pub mod reduction;
pub mod sampled;
pub mod sampler;
pub mod schedule;
pub mod staircase;

pub use linear_system::LinearSystem;
