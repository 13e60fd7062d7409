//! Probabilities from counts.

use super::beta::beta_quantile;
use crate::normal::WIDTH_95;

/// The interval of 95 % of E. B. Wilson (1927), which covers the probability on average as often as it says.
pub fn wilson(happened: u64, of: u64) -> [f64; 2] {
    if of == 0 {
        return [0.0, 1.0];
    }
    let (n, p) = (of as f64, happened as f64 / of as f64);
    let square = WIDTH_95 * WIDTH_95 / n;
    let middle = (p + 0.5 * square) / (1.0 + square);
    let half = (square * (p * (1.0 - p) + 0.25 * square)).sqrt() / (1.0 + square);
    let low = if happened == 0 { 0.0 } else { middle - half };
    let high = if happened == of { 1.0 } else { middle + half };
    [low.max(0.0), high.min(1.0)]
}

/// The interval of C. J. Clopper and E. S. Pearson (1934), which covers it at least as often as it says.
pub fn exact(happened: u64, of: u64) -> [f64; 2] {
    let (k, n) = (happened as f64, of as f64);
    let low = if happened == 0 {
        0.0
    } else {
        beta_quantile(0.025, k, n - k + 1.0)
    };
    let high = if happened >= of {
        1.0
    } else {
        beta_quantile(0.975, k + 1.0, n - k)
    };
    [low, high]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(found: [f64; 2], expected: [f64; 2]) -> bool {
        found
            .iter()
            .zip(expected)
            .all(|(a, b)| (a - b).abs() < 5e-8)
    }

    #[test]
    fn the_intervals_are_those_of_other_programs() {
        assert!(
            near(wilson(8, 20), [0.218_806_532_4, 0.613_418_499_2]),
            "{:?}",
            wilson(8, 20)
        );
        assert!(
            near(exact(8, 20), [0.191_190_060_7, 0.639_457_412_7]),
            "{:?}",
            exact(8, 20)
        );
        assert!(
            near(exact(0, 10), [0.0, 0.308_497_107_8]),
            "{:?}",
            exact(0, 10)
        );
    }
}
