//! Statistics with intervals, at 95 %.

pub mod beta;
pub mod moments;
pub mod order;
pub mod sensitivity;
