//! How the likelihood and the innovations change with the values.
//!
//! | file | idea |
//! |---|---|
//! | `adjoint.rs` | the gradient in all values by one sweep backwards over the tape |
//! | `information.rs` | Fisher's information in few passes |
//! | `sensitivity.rs` | scores and Fisher's information, value by value |
//! | `tangent.rs` | how innovations change along directions, in one pass |

pub(crate) mod adjoint;
pub(crate) mod information;
pub(crate) mod sensitivity;
pub(crate) mod tangent;
