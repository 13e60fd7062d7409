//! Order statistics of numbers that are shown several times, in memory that does not grow with their number: digits
//! of the sought numbers are found one after the other by counting, so that no order of the numbers matters.

use super::beta::binomial;

/// Bits of the digits, together those of a number.
const DIGITS: [u32; 6] = [11, 11, 11, 11, 11, 9];
/// How often the numbers are to be shown.
pub const PASSES: usize = DIGITS.len();

/// Numbers of given ranks.
#[derive(Debug, Clone)]
pub struct Selection {
    /// Digits already determined.
    pass: usize,
    sought: Vec<Sought>,
    /// Numbers with a prefix, by their next digit.
    counts: Vec<(u64, Vec<u64>)>,
}

#[derive(Debug, Clone)]
struct Sought {
    prefix: u64,
    /// Rank among the numbers with this prefix.
    rank: u64,
}

impl Selection {
    /// Seeks the numbers of these ranks, from 0.
    pub fn new(ranks: &[u64]) -> Self {
        let sought = ranks.iter().map(|&rank| Sought { prefix: 0, rank });
        let mut selection = Self {
            pass: 0,
            sought: sought.collect(),
            counts: Vec::new(),
        };
        selection.prepare();
        selection
    }

    fn prepare(&mut self) {
        let mut prefixes: Vec<u64> = self.sought.iter().map(|s| s.prefix).collect();
        prefixes.sort_unstable();
        prefixes.dedup();
        let bits = DIGITS.get(self.pass).copied().unwrap_or(0);
        let empty = |prefix| (prefix, vec![0; 1 << bits]);
        self.counts = prefixes.into_iter().map(empty).collect();
    }

    /// Shows a finite number.
    pub fn see(&mut self, value: f64) {
        let Some(bits) = DIGITS.get(self.pass) else {
            return;
        };
        let known: u32 = DIGITS[..self.pass].iter().sum();
        let key = key(value);
        let prefix = key.checked_shr(64 - known).unwrap_or(0);
        // A digit has few bits.
        #[allow(clippy::cast_possible_truncation)]
        let digit = (key >> (64 - known - bits)) as usize & ((1 << bits) - 1);
        if let Ok(place) = self.counts.binary_search_by_key(&prefix, |(p, _)| *p) {
            self.counts[place].1[digit] += 1;
        }
    }

    /// All numbers have been shown once more.
    pub fn advance(&mut self) {
        let Some(bits) = DIGITS.get(self.pass) else {
            return;
        };
        for sought in &mut self.sought {
            let place = self
                .counts
                .binary_search_by_key(&sought.prefix, |(p, _)| *p);
            let Some((_, counts)) = place.ok().and_then(|place| self.counts.get(place)) else {
                continue;
            };
            let mut digit = 0;
            for (place, count) in (0..).zip(counts) {
                digit = place;
                if sought.rank < *count {
                    break;
                }
                sought.rank -= count;
            }
            sought.prefix = sought.prefix << bits | digit;
        }
        self.pass += 1;
        self.prepare();
    }

    /// The numbers, in the order of their ranks as given.
    pub fn numbers(&self) -> Vec<f64> {
        self.sought.iter().map(|s| number(s.prefix)).collect()
    }
}

/// Bits that order as their numbers do; a negative zero is zero.
fn key(value: f64) -> u64 {
    let bits = (value + 0.0).to_bits();
    if bits >> 63 == 1 {
        !bits
    } else {
        bits | 1 << 63
    }
}

fn number(key: u64) -> f64 {
    f64::from_bits(if key >> 63 == 1 {
        key & !(1 << 63)
    } else {
        !key
    })
}

/// A quantile: the part of numbers below it, its value and an interval of 95 %, with an end missing where the numbers
/// are too few for one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantile {
    /// The part.
    pub part: f64,
    /// The value, between neighbouring numbers.
    pub value: f64,
    /// Ends of the interval.
    pub interval: [Option<f64>; 2],
}

/// Ranks that a quantile needs of `count` numbers: two for the value, two for the interval.
pub fn ranks(part: f64, count: u64) -> [Option<u64>; 4] {
    let Some(last) = count.checked_sub(1) else {
        return [None; 4];
    };
    // Below `count`.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let below = ((last as f64 * part).floor() as u64).min(last);
    // The first k with P(at most k smaller numbers) above a probability.
    let first = |probability: f64| {
        let (mut low, mut high) = (0, count);
        while low < high {
            let middle = low + (high - low) / 2;
            if binomial(middle, count, part) < probability {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        low
    };
    let (low, high) = (first(0.025), first(0.975));
    [
        Some(below),
        Some((below + 1).min(last)),
        low.checked_sub(1),
        Some(high).filter(|high| *high <= last),
    ]
}

impl Quantile {
    /// The quantile from the numbers of its [`ranks`], those that there are.
    pub fn new(part: f64, count: u64, ranks: [Option<u64>; 4], numbers: &[f64]) -> Option<Self> {
        let mut numbers = numbers.iter().copied();
        let [below, above, low, high] = ranks.map(|rank| rank.and_then(|_| numbers.next()));
        let (below, above) = below.zip(above)?;
        let place = (count.saturating_sub(1)) as f64 * part;
        let beyond = place - place.floor();
        let value = if beyond > 0.0 {
            below + (above - below) * beyond
        } else {
            below
        };
        Some(Self {
            part,
            value,
            interval: [low, high],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    #[test]
    fn numbers_of_all_ranks_are_those_of_the_sorted_list() {
        let stream = Stream::new(1, "x");
        let mut numbers: Vec<f64> = (0..500_u16)
            .map(|i| {
                let power = i32::from(i % 40) - 20;
                (stream.uniform(u64::from(i), 0) - 0.5) * 10f64.powi(power)
            })
            .collect();
        numbers.extend([0.0, -0.0, 1.0, 1.0, f64::MAX, f64::MIN]);
        let ranks: Vec<u64> = (0..numbers.len() as u64).collect();
        let mut selection = Selection::new(&ranks);
        for _ in 0..PASSES {
            for &number in &numbers {
                selection.see(number);
            }
            selection.advance();
        }
        numbers.sort_by(f64::total_cmp);
        let found = selection.numbers();
        assert_eq!(numbers, found);
    }

    /// The ranks of the tables: of 100 numbers the 40th and the 61st hold the median.
    #[test]
    fn intervals_of_the_median_are_those_of_the_tables() {
        assert_eq!(ranks(0.5, 100)[2..], [Some(39), Some(60)]);
        assert_eq!(ranks(0.5, 5)[2..], [None, None]);
    }
}
