//! The appell mechanism language: text to a checked mechanism.

pub mod expr;
pub mod mechanism;
pub mod units;
