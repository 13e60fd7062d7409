//! The extended Kalman filter, predictions and smoother.
//!
//! | file | idea |
//! |---|---|
//! | `filter.rs` | the pass over a recording: innovations, log-likelihood |
//! | `prediction.rs` | predictions over longer horizons |
//! | `process_noise.rs` | how disturbances enter the covariance |
//! | `smoother.rs` | states given a whole recording |
//! | `square_root.rs` | factors of covariances: triangularisation, updates by one sample |
//! | `tape.rs` | record of a pass, for the gradient and the smoother |

pub(crate) mod filter;
pub(crate) mod prediction;
mod process_noise;
pub(crate) mod smoother;
pub(crate) mod square_root;
pub(crate) mod tape;
