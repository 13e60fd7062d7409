//! Limits on work, memory and files of a study, which may come from an untrusted source.

/// Most cases of a study.
pub const MAX_CASES: u64 = 1_000_000_000;
/// Most chunks of a study, each of them a file.
pub const MAX_CHUNKS: u64 = 100_000;
/// Most numbers of a chunk, which is held in memory while it is computed or read.
pub const MAX_NUMBERS: u64 = 1 << 23;
/// Most columns of a row.
pub const MAX_COLUMNS: usize = 50_000;
/// Most entries of a section.
pub const MAX_ENTRIES: usize = 256;
/// Most specs and laws, together, between which a study chooses.
pub const MAX_VARIANTS: usize = 64;
/// Most values of a list that is written out.
pub const MAX_LIST: usize = 4096;
/// Most values of a range.
pub const MAX_VALUES: u64 = 1_000_000;
/// Most times of a course.
pub const MAX_TIMES: f64 = 20_000.0;
/// Most values of noise in one motion, for all its noises together.
pub const MAX_HELD: f64 = 1_000_000.0;
/// Most particles of a rare event.
pub const MAX_PARTICLES: u64 = 1_000_000;
/// Most normal numbers of all particles together.
pub const MAX_SCORES: u64 = 1 << 24;
/// Most steps of a motion.
pub const MAX_STEPS: u64 = 1_000_000_000;
/// Longest and shortest motion, in s.
pub const DURATIONS: [f64; 2] = [1e-9, 1e9];
/// Coarsest tolerance: beyond it, motions are wrong in the second digit and their statistics meaningless.
pub const MAX_TOLERANCE: f64 = 1e-2;
/// Most threads of a run.
pub const MAX_JOBS: usize = 1024;
/// Largest table, in bytes.
pub const MAX_TABLE: u64 = 1 << 28;
/// Largest file of a chunk, in bytes: its numbers and metadata.
pub const MAX_CHUNK_BYTES: u64 = 1 << 28;
