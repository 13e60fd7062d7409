//! Recordings and diagnoses, from the outside.

mod common;

mod data_sets;
mod engine;
mod formats;
mod fuzz;
mod motion_capture;
mod shared;
