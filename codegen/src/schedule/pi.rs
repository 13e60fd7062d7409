//! The circle constant on tapes: the machine's number, as an exact fraction.

use crate::symbolic::Rational;

/// `f64::consts::PI`, exactly.
pub fn pi() -> Rational {
    Rational::new(884_279_719_003_555, 281_474_976_710_656)
}

/// Numerator and denominator of a number that is a simple part or multiple of π.
pub(crate) fn parts_of_pi(value: &Rational) -> Option<(i64, i64)> {
    const SIMPLE: i64 = 100_000;
    if value.is_zero() {
        return None;
    }
    let quotient = value * &pi().recip();
    let simple = |n: i64| n.abs() < SIMPLE;
    quotient.as_small().filter(|&(n, d)| simple(n) && simple(d))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fraction_is_the_number_of_the_machine() {
        assert_eq!(pi().to_f64().to_bits(), std::f64::consts::PI.to_bits());
        assert_eq!(parts_of_pi(&pi()), Some((1, 1)));
        assert_eq!(
            parts_of_pi(&(&pi() * &Rational::new(-5, 36))),
            Some((-5, 36))
        );
        assert_eq!(parts_of_pi(&Rational::new(22, 7)), None);
        assert_eq!(parts_of_pi(&Rational::ZERO), None);
    }
}
