//! Eight places at once.

/// Places of a block.
pub const LANES: usize = 8;
