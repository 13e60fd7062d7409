//! A random permutation of any length, without a table.

use crate::random::{Stream, mixed};

const ROUNDS: usize = 6;

/// A permutation of the numbers below its length: a Feistel network on enough bits, applied until the number is
/// below the length (J. Black and P. Rogaway, *Ciphers with arbitrary finite domains*, 2002).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Permutation {
    length: u64,
    /// Bits of each half.
    half: u32,
    keys: [u64; ROUNDS],
}

impl Permutation {
    /// Of the numbers below `length`.
    pub(crate) fn new(length: u64, stream: Stream) -> Self {
        let bits = 64 - length.saturating_sub(1).leading_zeros();
        let mut keys = [0; ROUNDS];
        for (round, key) in (0..).zip(&mut keys) {
            *key = stream.bits(u64::MAX, 2 + round);
        }
        Self {
            length,
            half: bits.div_ceil(2).clamp(1, 32),
            keys,
        }
    }

    /// Where a number below the length goes.
    pub(crate) fn of(&self, number: u64) -> u64 {
        let mut place = number;
        loop {
            place = self.round_trip(place);
            if place < self.length {
                return place;
            }
        }
    }

    fn round_trip(&self, number: u64) -> u64 {
        let mask = (1_u64 << self.half) - 1;
        let (mut left, mut right) = (number >> self.half, number & mask);
        for key in self.keys {
            (left, right) = (right, left ^ (mixed(right ^ key) & mask));
        }
        left << self.half | right
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_comes_once() {
        for length in [1, 2, 3, 10, 1000, 4097] {
            let permutation = Permutation::new(length, Stream::new(3, "m"));
            let mut places: Vec<u64> = (0..length).map(|i| permutation.of(i)).collect();
            places.sort_unstable();
            assert_eq!(places, (0..length).collect::<Vec<_>>());
        }
    }
}
