//! The incomplete beta function, the distributions that follow from it, and probabilities from counts.

use crate::normal::WIDTH_95;

/// Terms of the continued fraction, which needs some √(a + b).
const MOST_TERMS: u32 = 1_000_000;
/// Halvings of an interval, down to neighbouring numbers.
const HALVINGS: usize = 200;

/// Iₓ(a, b), the part of the beta distribution below x (W. H. Press et al., *Numerical Recipes*, section 6.4).
pub fn beta(x: f64, a: f64, b: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    if x >= 1.0 {
        return 1.0;
    }
    let log = libm::lgamma(a + b) - libm::lgamma(a) - libm::lgamma(b)
        + a * libm::log(x)
        + b * libm::log1p(-x);
    let front = libm::exp(log);
    if x < (a + 1.0) / (a + b + 2.0) {
        front * fraction(x, a, b) / a
    } else {
        1.0 - front * fraction(1.0 - x, b, a) / b
    }
}

/// The continued fraction by the method of Lentz.
fn fraction(x: f64, a: f64, b: f64) -> f64 {
    const TINY: f64 = 1e-300;
    let safe = |value: f64| if value.abs() < TINY { TINY } else { value };
    let mut c = 1.0;
    let mut d = 1.0 / safe(1.0 - (a + b) * x / (a + 1.0));
    let mut product = d;
    for m in 1..=MOST_TERMS {
        let m = f64::from(m);
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        let mut change = 1.0;
        for term in [even, odd] {
            d = 1.0 / safe(1.0 + term * d);
            c = safe(1.0 + term / c);
            change = c * d;
            product *= change;
        }
        if (change - 1.0).abs() < 1e-15 {
            break;
        }
    }
    product
}

/// The x with Iₓ(a, b) = `part`.
pub fn beta_quantile(part: f64, a: f64, b: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if beta(middle, a, b) < part {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// The probability of at most `k` successes in `n` trials.
pub fn binomial(k: u64, n: u64, probability: f64) -> f64 {
    if k >= n {
        return 1.0;
    }
    beta(1.0 - probability, (n - k) as f64, k as f64 + 1.0)
}

/// Half the width of an interval of 95 % in standard errors, with these degrees of freedom (Student).
pub fn student_95(freedom: f64) -> f64 {
    // I(x; f/2, 1/2) is the part outside ±t for x = f / (f + t²).
    let x = beta_quantile(0.05, 0.5 * freedom, 0.5);
    (freedom * (1.0 - x) / x).sqrt()
}

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

    #[test]
    fn quantiles_of_student_are_those_of_the_tables() {
        for (freedom, t) in [
            (1.0, 12.706_204_736),
            (10.0, 2.228_138_852),
            (1e6, 1.959_966_4),
        ] {
            let found = student_95(freedom);
            assert!((found - t).abs() < 1e-6 * t, "{freedom}: {found}");
        }
    }

    #[test]
    fn binomial_probabilities_add_up() {
        // 1 + 10 + 45 of 1024.
        assert!((binomial(2, 10, 0.5) - 56.0 / 1024.0).abs() < 1e-14);
        assert!((binomial(0, 3, 0.1) - 0.729).abs() < 1e-14);
        assert!((binomial(3, 3, 0.1) - 1.0).abs() < 1e-14);
    }

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
