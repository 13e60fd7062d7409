//! The extended Kalman filter and what follows from one pass of it.
//!
//! | file | idea |
//! |---|---|
//! | `filter.rs` | the pass over a recording: innovations, log-likelihood |
//! | `prediction.rs` | where the motion goes from what the filter knows |
//! | `smoother.rs` | states given a whole recording |
//! | `square_root.rs` | factors of covariances: triangularisation, updates by one sample |
//! | `tape.rs` | what a pass leaves for the gradient and the smoother |

pub(crate) mod filter;
pub(crate) mod prediction;
pub(crate) mod smoother;
pub(crate) mod square_root;
pub(crate) mod tape;
