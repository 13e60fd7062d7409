//! From a steady motion to gains: what is asked for, the design, its law file, its region of attraction.

pub mod ask;
pub mod attraction;
pub mod design;
pub mod explain;
pub mod law_file;
mod request;

pub use design::Design;
pub use request::Request;
