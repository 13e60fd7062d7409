//! The hash by which chunks belong to a study.

use std::fmt::Write as _;

use sha2::{Digest as _, Sha256};

/// Bytes of the hash that names show.
const SHOWN: usize = 8;

/// A hash of parts, each with its length.
#[derive(Debug, Clone, Default)]
pub struct Digest(Sha256);

impl Digest {
    /// Adds a part.
    pub fn add(&mut self, part: &[u8]) {
        self.0.update((part.len() as u64).to_le_bytes());
        self.0.update(part);
    }

    /// The hash as a word.
    pub fn text(self) -> String {
        hex(&self.0.finalize()[..SHOWN])
    }
}

/// Bytes as digits.
pub(crate) fn hex(bytes: &[u8]) -> String {
    let mut text = String::new();
    for byte in bytes {
        // Writing to a string cannot fail.
        let _ = write!(text, "{byte:02x}");
    }
    text
}
