//! Inputs of an estimation: measurements, disturbances, recordings, and the values on which the
//! likelihood depends.
//!
//! | file | idea |
//! |---|---|
//! | `held.rs` | inputs that are held from row to row |
//! | `layout.rs` | the values, in their order |
//! | `recording.rs` | samples of one run |
//! | `setup.rs` | measured quantities and disturbances |
//! | `unknown.rs` | meaning of a value |

mod held;
pub(crate) mod layout;
pub(crate) mod recording;
pub(crate) mod setup;
pub(crate) mod unknown;
