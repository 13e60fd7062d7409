//! Control about a steady motion: request, design, feedback file, region of attraction.

pub mod attraction;
pub mod design;
pub(crate) mod law_file;
pub(crate) mod parse;
pub mod remedies;
mod request;
mod schedule;

pub use appell_analysis::control::LinearSystem;
pub use appell_analysis::control::controllability::Controllability;
pub use appell_analysis::control::operating_point::MotionEquations;
pub use appell_analysis::control::reduction::Subsystem;
pub use appell_analysis::control::sampled::Sampling;
pub use design::Design;
pub use nalgebra::{Complex, DMatrix};
pub use request::Request;
pub use schedule::Schedule;
