//! Files: one rule for all that are read, one for all that are written.
//!
//! A spec, a robot file, a recording or a study is untrusted. What is read is a regular file of bounded size, so that a
//! pipe cannot block and a device cannot fill the memory ([`read`], [`read_text`], [`open`]). A file that another file
//! names lies below the folder of the latter, or below one that the user names ([`below`], [`within`]). What is written is there as a
//! whole or not at all ([`Draft`]), and what killed writers left is removed ([`remove_left_behind`]).

mod draft;
mod input;

pub use draft::{Draft, remove_drafts, remove_left_behind};
pub use input::{FileError, below, open, read, read_text, within};
