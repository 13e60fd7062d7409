//! Functions kept from run to run, addressed by the text of the spec and the code that derived them.

use std::fmt::Write as _;
use std::sync::OnceLock;

use serde::Serialize;
use serde::de::DeserializeOwned;
use sha2::{Digest as _, Sha256};

/// Keeps entries by their keys, for all threads and processes. Each key has one possible entry.
pub trait Store: Send + Sync {
    /// An entry, if there is one.
    fn get(&self, key: &str) -> Option<Vec<u8>>;
    /// Keeps an entry if that is possible.
    fn put(&self, key: &str, entry: &[u8]);
}

static STORE: OnceLock<Box<dyn Store>> = OnceLock::new();

/// Keeps functions in a store from now on, unless there is one already.
pub fn keep_in(store: Box<dyn Store>) {
    STORE.get_or_init(|| store);
}

/// The entries of one spec.
pub(super) struct Kept {
    store: &'static dyn Store,
    /// The hash of everything that the functions depend on.
    hasher: Sha256,
}

impl Kept {
    /// The entries of a spec, if there is a store.
    pub(super) fn of(text: &str) -> Option<Self> {
        let store = STORE.get()?.as_ref();
        let code = concat!(env!("CARGO_PKG_VERSION"), " ", env!("APPELL_SOURCES"), "\0");
        let hasher = Sha256::new()
            .chain_update(code)
            .chain_update(text)
            .chain_update("\0");
        Some(Self { store, hasher })
    }

    fn key(&self, part: &str) -> String {
        hexadecimal(&self.hasher.clone().chain_update(part).finalize())
    }

    /// An entry that is as it was written: a damaged one is made anew.
    pub(super) fn get<T: DeserializeOwned>(&self, part: &str) -> Option<T> {
        let entry = self.store.get(&self.key(part))?;
        let (sum, value) = entry.split_at_checked(Sha256::output_size())?;
        let is_whole = *Sha256::digest(value) == *sum;
        postcard::from_bytes(value).ok().filter(|_| is_whole)
    }

    /// Keeps an entry.
    pub(super) fn put<T: Serialize>(&self, part: &str, value: &T) {
        if let Ok(value) = postcard::to_stdvec(value) {
            let entry = [&*Sha256::digest(&value), &value].concat();
            self.store.put(&self.key(part), &entry);
        }
    }
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        // Writing to a string never fails.
        let _ = write!(text, "{byte:02x}");
        text
    })
}
