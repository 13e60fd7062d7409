//! Robot files, from the outside: what they become, and what is said of bad ones.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

mod files;
mod includes;
mod mjcf;
mod orientations;
