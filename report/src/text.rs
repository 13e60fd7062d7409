//! Tables as text, and readable numbers.

/// Rows with columns as wide as needed; the columns from `numbers` on are right-aligned.
pub fn table(rows: &[Vec<String>], numbers: std::ops::Range<usize>) -> String {
    let length = |cell: &str| cell.chars().count();
    let widths = widths(rows, length);
    let mut text = String::new();
    for row in rows {
        let mut line = String::new();
        for (column, cell) in row.iter().enumerate() {
            let padding = " ".repeat(widths[column] - length(cell));
            let [before, after] = if numbers.contains(&column) {
                [padding.as_str(), ""]
            } else {
                ["", padding.as_str()]
            };
            line.extend(["  ", before, cell, after]);
        }
        text += line.trim_end();
        text.push('\n');
    }
    text
}

/// Widths of the columns of some rows.
pub(crate) fn widths(rows: &[Vec<String>], width: impl Fn(&str) -> usize) -> Vec<usize> {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let widest = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column));
        cells.map(|cell| width(cell)).max().unwrap_or(0)
    };
    (0..columns).map(widest).collect()
}

/// A number with its unit; the unit 1 is omitted.
pub fn with_unit(number: &str, unit: &str) -> String {
    match unit {
        "" | "1" => number.to_owned(),
        unit => format!("{number} {unit}"),
    }
}

/// A number with six significant digits; a very small or large one has an exponent and four.
pub fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !(1e-4..1e6).contains(&value.abs()) {
        return format!("{value:.3e}");
    }
    let decimals = usize::try_from(5 - exponent(value)).unwrap_or(0);
    format!("{value:.decimals$}")
}

/// A number with three significant digits; a very small or large one has an exponent and two.
pub fn short(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if value.is_nan() {
        return "unknown".to_owned();
    }
    if value.is_infinite() {
        return if value > 0.0 { "∞" } else { "−∞" }.to_owned();
    }
    if !(1e-3..1e5).contains(&value.abs()) {
        return format!("{value:.1e}");
    }
    let decimals = usize::try_from(2 - exponent(value)).unwrap_or(0);
    format!("{value:.decimals$}")
}

/// A prediction horizon in s: 0 is one step, infinity the free run to the end.
pub fn horizon(seconds: f64) -> String {
    if seconds <= 0.0 {
        "one step".to_owned()
    } else if seconds.is_finite() {
        format!("{seconds} s")
    } else {
        "free run".to_owned()
    }
}

/// Decimal exponent of the first digit of a finite number other than 0.
#[expect(clippy::cast_possible_truncation, reason = "between -324 and 308")]
pub(crate) fn exponent(value: f64) -> i32 {
    value.abs().log10().floor() as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_has_six_significant_digits_on_both_sides_of_1() {
        for (value, text) in [
            (0.0, "0"),
            (1.0, "1.00000"),
            (-1.5, "-1.50000"),
            (123_456.7, "123457"),
            (0.980_931_4, "0.980931"),
            (0.05, "0.0500000"),
            (2.8e-4, "0.000280000"),
            (0.000_123_456, "0.000123456"),
            (-0.000_123_456, "-0.000123456"),
            (1e-4, "0.000100000"),
            (9.9e-5, "9.900e-5"),
            (2.5e6, "2.500e6"),
        ] {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn a_short_number_has_three_significant_digits() {
        for (value, text) in [
            (0.0, "0"),
            (0.41234, "0.412"),
            (-0.041_234, "-0.0412"),
            (1234.5, "1234"),
            (2.5e-7, "2.5e-7"),
            (f64::INFINITY, "∞"),
        ] {
            assert_eq!(short(value), text);
        }
    }

    #[test]
    fn a_horizon_is_a_step_a_time_or_the_whole_run() {
        let texts = [0.0, 0.1, 1.0, f64::INFINITY].map(horizon);
        assert_eq!(texts, ["one step", "0.1 s", "1 s", "free run"]);
    }
}
