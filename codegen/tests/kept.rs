//! Functions of a model kept from run to run.
#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard};

use appell_codegen::program::FunctionKind;
use appell_codegen::tapes::{Store, Tapes, keep_in};

use crate::findings::chain;

/// Entries, and how many were found.
type Entries = (Option<HashMap<String, Vec<u8>>>, usize);

static ENTRIES: Mutex<Entries> = Mutex::new((None, 0));

struct Memory;

fn entries() -> MutexGuard<'static, Entries> {
    ENTRIES.lock().unwrap()
}

impl Store for Memory {
    fn get(&self, key: &str) -> Option<Vec<u8>> {
        let (entries, hits) = &mut *entries();
        let entry = entries.as_ref()?.get(key).cloned();
        *hits += usize::from(entry.is_some());
        entry
    }

    fn put(&self, key: &str, entry: &[u8]) {
        let (entries, _) = &mut *entries();
        entries
            .get_or_insert_default()
            .insert(key.to_owned(), entry.to_vec());
    }
}

/// All functions of a spec.
fn functions(text: &str) -> Vec<Option<Vec<appell_codegen::tape::Operation>>> {
    let tapes = Tapes::of_spec("spec.toml", text).unwrap();
    let operations = |kind| tapes.get(kind).map(|tape| tape.operations.clone());
    FunctionKind::ALL.into_iter().map(operations).collect()
}

#[test]
fn kept_functions_are_those_that_were_derived() {
    keep_in(Box::new(Memory));
    let text = chain(8);
    let derived = functions(&text);
    let (kept, hits) = {
        let (entries, hits) = &*entries();
        (entries.as_ref().unwrap().len(), *hits)
    };
    // One entry for each function, and one for names and sizes.
    assert_eq!((kept, hits), (FunctionKind::ALL.len() + 1, 0));
    assert_eq!(functions(&text), derived);
    assert_eq!(entries().1, kept);

    // Damaged in the middle, cut, empty.
    for (place, entry) in entries().0.as_mut().unwrap().values_mut().enumerate() {
        let middle = entry.len() / 2;
        match place % 3 {
            0 => entry[middle] ^= 1,
            1 => entry.truncate(middle),
            _ => entry.clear(),
        }
    }
    let hits = entries().1;
    assert_eq!(functions(&text), derived);
    assert_eq!(functions(&text), derived);
    // The first time all were found, none was used, and all were written again.
    assert_eq!(entries().1, hits + 2 * kept);
    let another = text.replace("value = 1, unit = 'kg'", "value = 2, unit = 'kg'");
    assert_eq!(functions(&another).len(), derived.len());
    assert_eq!(entries().0.as_ref().unwrap().len(), 2 * kept);
}
