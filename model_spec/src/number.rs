//! Exact numbers from decimal text.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Pow, Zero};

use crate::limits::{MAX_DIGITS, MAX_TEN};

/// Why a number was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum NumberError {
    /// `inf` or `nan`.
    NotFinite,
    /// Too many digits or too large an exponent.
    TooLarge,
    /// Not a decimal number.
    Syntax,
}

/// The exact value of a decimal such as `-0.25e3`.
pub(crate) fn exact(text: &str) -> Result<BigRational, NumberError> {
    let (negative, text) = match text.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, text.strip_prefix('+').unwrap_or(text)),
    };
    if matches!(text, "inf" | "nan") {
        return Err(NumberError::NotFinite);
    }
    let (mantissa, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits = || whole.bytes().chain(fraction.bytes());
    if digits().count() > MAX_DIGITS {
        return Err(NumberError::TooLarge);
    }
    if digits().next().is_none() || !digits().all(|b| b.is_ascii_digit()) {
        return Err(NumberError::Syntax);
    }
    let ten = exponent_value(exponent)?;
    let mut value = BigInt::zero();
    for digit in digits() {
        value = value * 10 + (digit - b'0');
    }
    // The fraction has at most MAX_DIGITS digits.
    let shift = ten - i32::try_from(fraction.len()).unwrap_or(0);
    let value = BigRational::from_integer(if negative { -value } else { value });
    Ok(value * Pow::pow(BigRational::from_integer(BigInt::from(10)), shift))
}

fn exponent_value(text: &str) -> Result<i32, NumberError> {
    let digits = text.strip_prefix(['-', '+']).unwrap_or(text);
    if digits.is_empty() || !digits.bytes().all(|b| b.is_ascii_digit()) {
        return Err(NumberError::Syntax);
    }
    match text.parse::<i32>() {
        Ok(n) if n.abs() <= MAX_TEN => Ok(n),
        _ => Err(NumberError::TooLarge),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_traits::ToPrimitive;

    #[test]
    fn decimals_are_exact_and_round_like_the_standard_library() {
        let tenth = BigRational::new(BigInt::from(1), BigInt::from(10));
        assert_eq!(exact("0.1"), Ok(tenth));
        for text in [
            "0.1",
            "-9.81",
            "1e-300",
            "123456789.123456789",
            "5e3",
            "+2.5E-3",
        ] {
            let value = exact(text).ok().and_then(|v| v.to_f64());
            assert_eq!(value, text.parse().ok(), "{text}");
        }
    }

    #[test]
    fn hostile_numbers_are_refused() {
        for text in ["1e999999999", "1e99999999999999999999", &"9".repeat(1000)] {
            assert_eq!(exact(text), Err(NumberError::TooLarge));
        }
        assert_eq!(exact("inf"), Err(NumberError::NotFinite));
        for text in ["", ".", "1e", "e5", "1.2.3", "--1", "1_000"] {
            assert_eq!(exact(text), Err(NumberError::Syntax), "{text}");
        }
    }
}
