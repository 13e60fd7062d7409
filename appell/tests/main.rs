//! The library as a program uses it.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

mod chunks;
mod control;
mod ensemble;
mod errors;
mod model_laws;
mod orientations;
mod robots;
mod spinning;
mod steady;
mod studies;
mod switching;
mod turning;
