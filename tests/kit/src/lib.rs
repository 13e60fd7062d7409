//! What the tests of all crates share. It knows none of them.

#![allow(
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    reason = "whatever fails here fails a test, which is the point"
)]

use std::path::{Path, PathBuf};

/// Processor time of the thread: what a text costs, however busy the machine is.
pub use cpu_time::ThreadTime;

/// Whether tests take their time: `APPELL_FULL=1`, as `.ci/full` sets it.
///
/// Fuzzers then damage more texts, charts of the books are as fine as for readers, and recordings
/// that do not lie in the repository are read.
pub fn is_full() -> bool {
    std::env::var_os("APPELL_FULL").is_some_and(|value| value == "1")
}

/// How much a test does: in an ordinary run, and in a full one.
pub fn budget(ordinary: usize, full: usize) -> usize {
    if is_full() { full } else { ordinary }
}

/// The root of the workspace.
pub fn workspace() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.ancestors().nth(2).unwrap().to_path_buf()
}

/// Names and texts of the shipped specs in alphabetical order.
pub fn shipped() -> Vec<(String, String)> {
    let folder = workspace().join("generated/mechanisms");
    let mut specs: Vec<(String, String)> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| {
            let path = entry.unwrap().path();
            let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
            (name, std::fs::read_to_string(path).unwrap())
        })
        .collect();
    specs.sort();
    specs
}

/// Most memory that this process has held so far, in MB, where the system tells.
pub fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = line.trim().strip_suffix(" kB")?.parse().ok()?;
    Some(kilobytes / 1000)
}

/// Random numbers that are the same in every run.
#[derive(Debug, Clone)]
pub struct Random(fastrand::Rng);

impl Random {
    /// A sequence of its own for every seed.
    pub fn new(seed: u64) -> Self {
        Self(fastrand::Rng::with_seed(seed))
    }

    /// A sequence of its own for every text.
    pub fn of(text: &str) -> Self {
        let hash = |hash: u64, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        Self::new(text.bytes().fold(0xcbf2_9ce4_8422_2325, hash))
    }

    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0.u64(..)
    }

    /// A number below `n`; 0 where there is none.
    pub fn below(&mut self, n: usize) -> usize {
        self.0.usize(..n.max(1))
    }

    /// One of these.
    pub fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len())]
    }

    /// A number between two others.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.f64()
    }

    /// A standard normal number (Box and Muller, 1958).
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.0.f64()).ln()).sqrt();
        radius * self.between(0.0, std::f64::consts::TAU).cos()
    }
}
