//! Uncertainty of the values, and consistency of innovations.
//!
//! | file | idea |
//! |---|---|
//! | `chi_squared.rs` | its probabilities and quantiles |
//! | `consistency.rs` | tests of innovations: whiteness and variance |
//! | `robust.rs` | robust (sandwich) covariance |

pub(crate) mod chi_squared;
pub(crate) mod consistency;
pub(crate) mod robust;
