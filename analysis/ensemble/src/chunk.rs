//! The cases of a study in pieces, each with a name that follows from the study and the cases alone.

use std::ops::Range;

use crate::rows::Column;
use crate::store::{Store, StoreError};
use crate::table_file;

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

impl Shard {
    /// Whether a chunk belongs to a shard, if there are shards.
    fn has(shard: Option<Self>, number: u64) -> bool {
        shard.is_none_or(|shard| number % shard.of == shard.number - 1)
    }
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
        let first = number.saturating_mul(self.size);
        self.of(first..first.saturating_add(self.size).min(self.cases))
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

    /// Chunks with cases of this study in a store, by their first case; of any size. Their bytes are not read.
    pub fn there(&self, store: &dyn Store) -> Result<Vec<Chunk>, StoreError> {
        let names = store.names()?;
        let chunks = names.iter().filter_map(|name| self.named(name));
        let mut chunks: Vec<Chunk> = chunks.filter(|c| c.cases.start < self.cases).collect();
        chunks.sort_by_key(|chunk| (chunk.cases.start, chunk.cases.end));
        Ok(chunks)
    }

    /// The chunks with a case that no chunk of the store holds, of one shard or of all.
    pub fn missing(&self, there: &[Chunk], shard: Option<Shard>) -> Vec<Chunk> {
        let covered = covered(there);
        let is_missing = |chunk: &Chunk| {
            let before = covered.partition_point(|r| r.start <= chunk.cases.start);
            let holds = |r: &Range<u64>| chunk.cases.end <= r.end;
            !before.checked_sub(1).is_some_and(|r| holds(&covered[r]))
        };
        let own = (0..self.count()).filter(|number| Shard::has(shard, *number));
        own.map(|n| self.chunk(n)).filter(is_missing).collect()
    }

    /// The chunks with a case that no undamaged chunk of the store has. Only the chunks of the shard are read.
    pub fn unsound_or_missing(
        &self,
        store: &dyn Store,
        columns: &[Column],
        shard: Option<Shard>,
    ) -> Result<Missing, StoreError> {
        let mut there = self.there(store)?;
        let needed = |chunk: &Chunk| {
            let last = chunk.cases.end.min(self.cases).saturating_sub(1);
            (chunk.cases.start / self.size..=last / self.size).any(|n| Shard::has(shard, n))
        };
        let mut damaged = Vec::new();
        for chunk in there.iter().filter(|chunk| needed(chunk)) {
            let bytes = store.read(&chunk.name)?;
            if table_file::read(bytes, columns, self, chunk, &|_| false).is_err() {
                damaged.push(chunk.name.clone());
            }
        }
        there.retain(|chunk| !damaged.contains(&chunk.name));
        Ok(Missing {
            chunks: self.missing(&there, shard),
            damaged,
        })
    }
}

/// The chunks missing from a store.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Missing {
    /// The chunks to be run.
    pub chunks: Vec<Chunk>,
    /// Names of damaged objects.
    pub damaged: Vec<String>,
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
