//! Values with their uncertainty, and shares.

use appell_gap::diagnose::{QUANTILE, Value, Yardstick};

use crate::text::{exponent, short, with_unit};

/// Half of the last digit of a share.
const ROUNDING: f64 = 5e-4;

/// A value with two digits of its standard deviation.
pub(super) fn measured(value: f64, std: f64) -> String {
    if !(std.is_finite() && std > 0.0 && value.is_finite()) {
        return short(value);
    }
    let power = exponent(value.abs().max(std));
    if (-3..6).contains(&power) {
        let decimals = usize::try_from(1 - exponent(std)).unwrap_or(0);
        return format!("{value:.decimals$} ± {std:.decimals$}");
    }
    let unit = 10_f64.powi(power);
    let decimals = usize::try_from(1 - exponent(std / unit)).unwrap_or(0);
    let (value, std) = (value / unit, std / unit);
    format!("({value:.decimals$} ± {std:.decimals$})e{power}")
}

/// A value with half of its 95 % interval.
pub(super) fn bounded(value: f64, std: f64) -> String {
    measured(value, QUANTILE * std)
}

/// `0.412 ± 0.041 N`, or `not determined (-0.02 to 0.31 N)`.
pub(super) fn sized(value: &Value) -> String {
    if value.is_determined {
        return with_unit(&bounded(value.value, value.std), &value.unit);
    }
    let half = QUANTILE * value.std;
    let [low, high] = [value.value - half, value.value + half].map(short);
    format!(
        "not determined ({low} to {})",
        with_unit(&high, &value.unit)
    )
}

/// `36.1 × the stated inertia of omega`
pub(super) fn compared(known: &Yardstick) -> String {
    format!("{} × {}", short(known.ratio), known.of)
}

/// `97.6 % [94.0 %, 100.0 %]`: a share with its interval.
pub fn share(part: f64, interval: [f64; 2]) -> String {
    let [low, high] = interval.map(percent);
    format!("{} [{low}, {high}]", percent(part))
}

/// `97.6 %`, at most 100 %: predictions may end below the expected noise floor.
pub fn percent(part: f64) -> String {
    if part.is_nan() {
        return "an unknown part".to_owned();
    }
    let part = part.min(1.0);
    // No zero with a sign.
    let thousandths = (1000.0 * part).round() + 0.0;
    format!("{:.1} %", thousandths / 10.0)
}

/// Whether a share is determined by its interval.
pub fn is_determined(part: f64, [low, high]: [f64; 2]) -> bool {
    /// Twice the gap.
    const WIDEST: f64 = 2.0;
    (low..=high).contains(&part) && high - low <= WIDEST
}

/// The same as a sentence part, with `nothing` and `all` for shares within rounding of 0 and 1.
pub(super) fn part_of_all(part: f64) -> String {
    match part {
        part if part < ROUNDING => "nothing".to_owned(),
        part if part > 1.0 - ROUNDING => "all".to_owned(),
        part => percent(part),
    }
}

/// `12.7 %`, or `under 0.1 %` for a part that is small but there.
pub(super) fn small(part: f64) -> String {
    if part < ROUNDING {
        return "under 0.1 %".to_owned();
    }
    percent(part)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_has_the_digits_of_its_deviation() {
        assert_eq!(measured(0.41234, 0.0213), "0.412 ± 0.021");
        assert_eq!(measured(4.5e-4, 6.283e-5), "(4.50 ± 0.63)e-4");
        assert_eq!(measured(12.0, f64::NAN), "12.0");
        assert_eq!(bounded(0.41234, 0.0213), "0.412 ± 0.042");
    }

    #[test]
    fn a_part_that_rounds_to_nothing_has_no_sign() {
        assert_eq!(percent(-4e-4), "0.0 %");
        assert_eq!(percent(-0.976), "-97.6 %");
        assert_eq!(share(1.01, [0.9, 1.271]), "100.0 % [90.0 %, 100.0 %]");
        assert_eq!(part_of_all(-0.008), "nothing");
        assert_eq!(part_of_all(1.271), "all");
        assert_eq!(part_of_all(0.948), "94.8 %");
    }
}
