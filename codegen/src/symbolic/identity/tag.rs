//! Domains of the pseudo-random values.

pub(super) const SYMBOL: u64 = 1;
pub(super) const REDRAWN: u64 = 2;
pub(super) const ANGLE: u64 = 3;
pub(super) const EXPONENT: u64 = 4;
pub(super) const CONDITION: u64 = 5;
pub(super) const ATAN2: u64 = 6;
pub(super) const ROOT: u64 = 7;
pub(super) const ROOT_OF_NUMBER: u64 = 8;
pub(super) const FUNCTION: u64 = 64;
