//! What is known of the values, and whether innovations are what they should be.
//!
//! | file | idea |
//! |---|---|
//! | `chi_squared.rs` | its probabilities and quantiles |
//! | `consistency.rs` | whether innovations are white and as large as they should be |
//! | `identifiability.rs` | combinations of values that are known |
//! | `profile.rs` | intervals by fits along one value |
//! | `robust.rs` | covariances that do not believe the noise white |

pub(crate) mod chi_squared;
pub(crate) mod consistency;
pub(crate) mod identifiability;
pub(crate) mod profile;
pub(crate) mod robust;
