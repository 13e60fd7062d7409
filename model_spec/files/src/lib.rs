//! Reading of untrusted files and atomic writing of files.
//!
//! Specs, robot files, recordings and studies are untrusted. Only regular files of bounded size are read, so that a
//! pipe cannot block and a device cannot fill the memory ([`read`], [`read_text`], [`open`]). A file that is referenced
//! by another file must lie below the folder of the latter, or below a folder given by the user ([`below`],
//! [`within`]). Writing is atomic ([`Draft`]); drafts of killed processes are removed by [`remove_left_behind`].

mod draft;
mod input;

pub use draft::{Draft, remove_drafts, remove_left_behind};
pub use input::{FileError, below, open, read, read_text, within};
