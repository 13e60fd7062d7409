//! What emitted code and integration need. Without the standard library the scalars and the dense
//! systems remain: `cargo test -p appell-runtime --no-default-features --features libm`.

mod dense;
mod real;

#[cfg(feature = "std")]
mod block;
mod common;
#[cfg(feature = "std")]
mod condition;
#[cfg(feature = "std")]
mod events;
#[cfg(feature = "std")]
mod integrate;
#[cfg(feature = "std")]
mod manoeuvres;
#[cfg(feature = "std")]
mod model;
#[cfg(feature = "std")]
mod order_conditions;
#[cfg(feature = "std")]
mod simulate;
