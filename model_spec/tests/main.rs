//! The mechanism language, from the outside.

mod advice;
mod bad_specs;
mod expressions;
mod fuzz;
mod joints;
mod language;
mod manual;
mod occurrences;
mod schema;
mod shipped;
