//! Random numbers by their place: case and index, whatever was drawn before.
//!
//! Philox 4x32 with ten rounds (Salmon, Moraes, Dror and Shaw, *Parallel random numbers: as easy as 1, 2, 3*, SC11).

/// Multipliers of a round.
const MULTIPLIERS: [u32; 2] = [0xd251_1f53, 0xcd9e_8d57];
/// Increments of the key per round.
const WEYL: [u32; 2] = [0x9e37_79b9, 0xbb67_ae85];
const ROUNDS: u32 = 10;

/// Four words for a counter under a key.
pub fn philox(mut counter: [u32; 4], mut key: [u32; 2]) -> [u32; 4] {
    for _ in 0..ROUNDS {
        let [low, high] = [counter[0], counter[2]].map(u64::from);
        let low = low * u64::from(MULTIPLIERS[0]);
        let high = high * u64::from(MULTIPLIERS[1]);
        let [low_words, high_words] = [words(low), words(high)];
        counter = [
            high_words[1] ^ counter[1] ^ key[0],
            high_words[0],
            low_words[1] ^ counter[3] ^ key[1],
            low_words[0],
        ];
        key = [key[0].wrapping_add(WEYL[0]), key[1].wrapping_add(WEYL[1])];
    }
    counter
}

/// The low and the high half.
fn words(number: u64) -> [u32; 2] {
    // Halves by intent.
    #[allow(clippy::cast_possible_truncation)]
    [number as u32, (number >> 32) as u32]
}

/// Numbers of a stream: those of a seed and a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stream {
    key: [u32; 2],
}

impl Stream {
    /// The stream of a name. The same name has the same numbers in every study with this seed.
    pub fn new(seed: u64, name: &str) -> Self {
        // FNV-1a, then the mixing of SplitMix64.
        let hash = name.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        });
        Self {
            key: words(mixed(
                hash ^ mixed(seed.wrapping_add(0x9e37_79b9_7f4a_7c15)),
            )),
        }
    }

    /// Four random words.
    pub fn words(self, case: u64, index: u64) -> [u32; 4] {
        let ([a, b], [c, d]) = (words(case), words(index));
        philox([a, b, c, d], self.key)
    }

    /// 64 random bits.
    pub fn bits(self, case: u64, index: u64) -> u64 {
        let [low, high, ..] = self.words(case, index);
        u64::from(low) | u64::from(high) << 32
    }

    /// A uniform number between 0 and 1, never one of them.
    pub fn uniform(self, case: u64, index: u64) -> f64 {
        uniform(self.bits(case, index))
    }

    /// An integer below `count`, which is not zero.
    pub fn below(self, count: u64, case: u64, index: u64) -> u64 {
        let product = u128::from(self.bits(case, index)) * u128::from(count);
        // Below `count`.
        #[allow(clippy::cast_possible_truncation)]
        let below = (product >> 64) as u64;
        below
    }
}

/// The middle of one of 2⁵² equal parts of the unit interval, from the leading bits.
pub(crate) fn uniform(bits: u64) -> f64 {
    const PARTS: f64 = 1.0 / (1_u64 << 52) as f64;
    ((bits >> 12) as f64 + 0.5) * PARTS
}

/// The finaliser of `SplitMix64`.
pub(crate) fn mixed(mut bits: u64) -> u64 {
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}

const SWAPS: usize = 6;

/// A permutation of the numbers below its length: a Feistel network on enough bits, applied until the number is
/// below the length (J. Black and P. Rogaway, *Ciphers with arbitrary finite domains*, 2002).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Permutation {
    length: u64,
    /// Bits of each half.
    half: u32,
    keys: [u64; SWAPS],
}

impl Permutation {
    /// Of the numbers below `length`.
    pub(crate) fn new(length: u64, stream: Stream) -> Self {
        let bits = 64 - length.saturating_sub(1).leading_zeros();
        let mut keys = [0; SWAPS];
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

    /// The vectors that its authors give.
    #[test]
    fn philox_gives_the_published_numbers() {
        let all = u32::MAX;
        for (counter, key, expected) in [
            (
                [0; 4],
                [0; 2],
                [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8],
            ),
            (
                [all; 4],
                [all; 2],
                [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd],
            ),
            (
                [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344],
                [0xa409_3822, 0x299f_31d0],
                [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1],
            ),
        ] {
            assert_eq!(philox(counter, key), expected);
        }
    }

    #[test]
    fn uniform_numbers_stay_inside() {
        assert!(uniform(0) > 0.0);
        assert!(uniform(u64::MAX) < 1.0);
    }

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
