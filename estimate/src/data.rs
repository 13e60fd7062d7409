//! What is given: what is measured and disturbed, recordings, and the values that the likelihood depends on.
//!
//! | file | idea |
//! |---|---|
//! | `layout.rs` | the values, in their order |
//! | `recording.rs` | samples of one run |
//! | `setup.rs` | what is measured and what disturbs the motion |
//! | `unknown.rs` | what a value means |

pub(crate) mod layout;
pub(crate) mod recording;
pub(crate) mod setup;
pub(crate) mod unknown;
