//! Control about a steady motion: request, design, feedback file, region of attraction.

pub mod attraction;
pub mod design;
pub mod errors;
pub mod law_file;
pub mod parse;
mod request;

pub use design::Design;
pub use errors::DesignError;
pub use request::Request;
