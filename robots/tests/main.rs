//! Robot files, from the outside: what they become, and what is said of bad ones.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

mod actuators;
mod corrected;
mod corrected_urdf;
mod equality;
mod files;
mod includes;
mod masses;
mod mjcf;
mod orientations;
