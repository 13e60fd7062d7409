//! The Sobol sequence at any index, scrambled.

use crate::random::{Stream, uniform};

/// Bits of a coordinate that the sequence gives; those below are random.
const BITS: usize = 32;
/// A line for each dimension after the first one: its primitive polynomial, as bits with the leading and the last one,
/// and its initial values, by S. Joe and F. Y. Kuo, SIAM Journal on Scientific Computing 30 (2008), their set
/// new-joe-kuo-6.
const DIRECTIONS: &str = include_str!("directions.txt");
/// The most dimensions.
pub(crate) const MOST_DIMENSIONS: usize = 160;
/// The most points.
pub(crate) const MOST_POINTS: u64 = 1 << BITS;

/// One coordinate of the sequence.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Coordinate {
    directions: [u32; BITS],
    stream: Stream,
}

impl Coordinate {
    /// A dimension below [`MOST_DIMENSIONS`], scrambled by a stream.
    pub(crate) fn new(dimension: usize, stream: Stream) -> Self {
        Self {
            directions: directions(dimension),
            stream,
        }
    }

    /// The coordinate of a point: its leading bits are the sequence, scrambled as A. B. Owen proposes (here by
    /// the hash of B. Burley, *Practical hash-based Owen scrambling*, JCGT 9, 2020); those below are random.
    pub(crate) fn at(&self, index: u64) -> f64 {
        let [seed, ..] = self.stream.words(u64::MAX, 0);
        let scrambled = scrambled(self.plain(index), seed);
        let below = self.stream.bits(index, 1) >> BITS;
        uniform(u64::from(scrambled) << BITS | below)
    }

    /// The sequence itself, as a fraction of 2³².
    fn plain(&self, index: u64) -> u32 {
        let set = self.directions.iter().enumerate();
        set.filter(|(bit, _)| index >> bit & 1 == 1)
            .fold(0, |x, (_, direction)| x ^ direction)
    }
}

/// The direction numbers of a dimension, as fractions of 2³².
fn directions(dimension: usize) -> [u32; BITS] {
    let mut v = [0; BITS];
    let line = dimension
        .checked_sub(1)
        .and_then(|d| DIRECTIONS.lines().nth(d));
    let words = line.into_iter().flat_map(str::split_whitespace);
    let numbers: Vec<u32> = words.filter_map(|word| word.parse().ok()).collect();
    let Some((polynomial, initial)) = numbers.split_first() else {
        for (bit, v) in v.iter_mut().enumerate() {
            *v = 1 << (BITS - 1 - bit);
        }
        return v;
    };
    let degree = initial.len();
    for (bit, m) in initial.iter().enumerate() {
        v[bit] = m << (BITS - 1 - bit);
    }
    for bit in degree..BITS {
        let mut next = v[bit - degree] ^ (v[bit - degree] >> degree);
        for k in 1..degree {
            if polynomial >> (degree - k) & 1 == 1 {
                next ^= v[bit - k];
            }
        }
        v[bit] = next;
    }
    v
}

/// Owen scrambling: each bit is flipped at random, depending on the higher bits.
fn scrambled(x: u32, seed: u32) -> u32 {
    let mut x = x.reverse_bits();
    x = x.wrapping_add(seed);
    x ^= x.wrapping_mul(0x6c50_b47c);
    x ^= x.wrapping_mul(0xb82f_1e52);
    x ^= x.wrapping_mul(0xc7af_e638);
    x ^= x.wrapping_mul(0x8d22_f6e6);
    x.reverse_bits()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain(dimension: usize, index: u64) -> f64 {
        let coordinate = Coordinate::new(dimension, Stream::new(0, ""));
        f64::from(coordinate.plain(index)) / MOST_POINTS as f64
    }

    /// The points of the sequence in order of their index, which are those of other programs in another order.
    #[test]
    fn the_first_points_are_the_published_ones() {
        let point = |index| (0..4).map(|d| plain(d, index)).collect::<Vec<f64>>();
        assert_eq!(point(0), [0.0; 4]);
        assert_eq!(point(1), [0.5; 4]);
        assert_eq!(point(2), [0.25, 0.75, 0.75, 0.75]);
        assert_eq!(point(3), [0.75, 0.25, 0.25, 0.25]);
        assert_eq!(point(4), [0.125, 0.625, 0.375, 0.125]);
    }

    /// One number of each coordinate in each of 2^k equal parts, scrambled or not.
    #[test]
    fn every_coordinate_is_stratified() {
        assert_eq!(DIRECTIONS.lines().count() + 1, MOST_DIMENSIONS);
        for dimension in 0..MOST_DIMENSIONS {
            let coordinate = Coordinate::new(dimension, Stream::new(7, &dimension.to_string()));
            let mut seen = [false; 256];
            for index in 0..256 {
                // Below 256.
                #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
                let part = (coordinate.at(index) * 256.0) as usize;
                assert!(!seen[part], "dimension {dimension}");
                seen[part] = true;
            }
        }
    }
}
