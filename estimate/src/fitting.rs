//! The most likely values.
//!
//! | file | idea |
//! |---|---|
//! | `company.rs` | levels that go along with inertia |
//! | `curvature.rs` | the second derivatives that a search begins with |
//! | `fit.rs` | the search itself |
//! | `free.rs` | which values are free, and within which limits |
//! | `posterior.rs` | the likelihood with the priors |
//! | `regression.rs` | parameters from accelerations, without a filter |
//! | `scoring.rs` | fits in few passes |

pub(crate) mod company;
pub(crate) mod curvature;
pub(crate) mod fit;
pub(crate) mod free;
pub(crate) mod posterior;
pub(crate) mod regression;
pub(crate) mod scoring;
