//! Numbers of a report, with significant digits only.

/// Three digits.
pub fn short(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !value.is_finite() {
        return "∞".to_owned();
    }
    if !(1e-3..1e5).contains(&value.abs()) {
        return format!("{value:.1e}");
    }
    let decimals = usize::try_from(2 - exponent(value)).unwrap_or(0);
    format!("{value:.decimals$}")
}

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

/// `97.6 %`
pub(super) fn percent(part: f64) -> String {
    if part.is_nan() {
        return "nothing".to_owned();
    }
    format!("{:.1} %", 100.0 * part)
}

/// Decimal exponent of the first digit.
#[expect(clippy::cast_possible_truncation, reason = "between -308 and 308")]
fn exponent(value: f64) -> i32 {
    value.abs().log10().floor() as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_those_that_mean_something() {
        let pairs = [
            (0.41234, "0.412"),
            (0.0, "0"),
            (1234.5, "1234"),
            (2.5e-7, "2.5e-7"),
        ];
        assert_eq!(
            pairs.map(|(value, _)| short(value)),
            pairs.map(|(_, text)| text)
        );
        assert_eq!(measured(0.41234, 0.0213), "0.412 ± 0.021");
        assert_eq!(measured(4.5e-4, 6.283e-5), "(4.50 ± 0.63)e-4");
        assert_eq!(measured(12.0, f64::NAN), "12.0");
    }
}
