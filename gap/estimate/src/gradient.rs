//! Derivatives of the likelihood and of the innovations with respect to the values.
//!
//! | file | idea |
//! |---|---|
//! | `adjoint.rs` | the gradient with respect to all values, by one reverse sweep over the tape |
//! | `direction.rs` | directions of differentiation |
//! | `information.rs` | Fisher information in few passes |
//! | `kept.rs` | gradient and information of the means from one pass |
//! | `levels.rs` | that of levels, in one pass |
//! | `sensitivity.rs` | scores and Fisher information, value by value |
//! | `tangent.rs` | directional derivatives of innovations, in one pass |

pub(crate) mod adjoint;
pub(crate) mod direction;
pub(crate) mod information;
pub(crate) mod kept;
mod levels;
pub(crate) mod sensitivity;
pub(crate) mod tangent;
