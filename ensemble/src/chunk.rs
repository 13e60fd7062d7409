//! The cases of a study in pieces, each with a name that follows from the study and the cases alone.

use std::ops::Range;

use crate::store::{Store, StoreError};

/// End of the name of a chunk.
const EXTENSION: &str = ".parquet";

/// All cases of a study, in chunks of one size but the last.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Chunks {
    /// Hash of everything that the rows depend on.
    pub study: String,
    /// Number of cases.
    pub cases: u64,
    /// Cases of a chunk.
    pub size: u64,
}

/// A chunk.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Chunk {
    /// Name of its object.
    pub name: String,
    /// Its cases.
    pub cases: Range<u64>,
}

/// One of several parts of the work: `2/8`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// Its number, from 1.
    pub number: u64,
    /// How many there are.
    pub of: u64,
}

impl std::fmt::Display for Shard {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

impl std::str::FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/');
        let parts = parts.map(|(k, n)| [k.trim(), n.trim()].map(str::parse::<u64>));
        match parts {
            Some([Ok(number), Ok(of)]) if (1..=of).contains(&number) => Ok(Self { number, of }),
            _ => Err("write K/N with K from 1 to N, such as 3/16".to_owned()),
        }
    }
}

impl Chunks {
    /// The number of chunks.
    pub fn count(&self) -> u64 {
        self.cases.div_ceil(self.size.max(1))
    }

    /// A chunk by its number.
    pub fn chunk(&self, number: u64) -> Chunk {
        let first = number * self.size;
        self.of(first..(first + self.size).min(self.cases))
    }

    /// The chunk of these cases.
    pub fn of(&self, cases: Range<u64>) -> Chunk {
        let name = format!(
            "{}-{:012}-{:012}{EXTENSION}",
            self.study, cases.start, cases.end
        );
        Chunk { name, cases }
    }

    /// The chunk of a name, if it is one of this study, whatever its size.
    pub fn named(&self, name: &str) -> Option<Chunk> {
        let rest = name.strip_prefix(self.study.as_str())?.strip_prefix('-')?;
        let (first, end) = rest.strip_suffix(EXTENSION)?.split_once('-')?;
        let cases = first.parse().ok()?..end.parse().ok()?;
        let is_own = cases.start < cases.end && self.of(cases.clone()).name == name;
        is_own.then(|| Chunk {
            name: name.to_owned(),
            cases,
        })
    }

    /// Chunks of this study that a store holds, by their first case; of any size.
    pub fn there(&self, store: &dyn Store) -> Result<Vec<Chunk>, StoreError> {
        let names = store.names()?;
        let mut chunks: Vec<Chunk> = names.iter().filter_map(|name| self.named(name)).collect();
        chunks.sort_by_key(|chunk| (chunk.cases.start, chunk.cases.end));
        Ok(chunks)
    }

    /// The chunks with a case that no chunk of the store holds, of one shard or of all.
    pub fn missing(&self, there: &[Chunk], shard: Option<Shard>) -> Vec<Chunk> {
        let own = |number: &u64| shard.is_none_or(|s| number % s.of == s.number - 1);
        let covered = covered(there);
        let is_missing = |chunk: &Chunk| {
            let holds = |r: &Range<u64>| r.start <= chunk.cases.start && chunk.cases.end <= r.end;
            !covered.iter().any(holds)
        };
        let all = (0..self.count()).filter(own).map(|n| self.chunk(n));
        all.filter(is_missing).collect()
    }
}

/// Cases of chunks, sorted by their first case, as few ranges.
fn covered(there: &[Chunk]) -> Vec<Range<u64>> {
    let mut ranges: Vec<Range<u64>> = Vec::new();
    for chunk in there {
        match ranges.last_mut() {
            Some(last) if chunk.cases.start <= last.end => {
                last.end = last.end.max(chunk.cases.end);
            }
            _ => ranges.push(chunk.cases.clone()),
        }
    }
    ranges
}
