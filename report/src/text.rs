//! Tables as text, and readable numbers.

/// Rows with columns as wide as needed; the columns from `numbers` on are right-aligned.
pub fn table(rows: &[Vec<String>], numbers: std::ops::Range<usize>) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        rows.iter()
            .filter_map(|row| row.get(column))
            .map(|cell| cell.chars().count())
            .max()
            .unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut text = String::new();
    for row in rows {
        let mut line = String::new();
        for (column, cell) in row.iter().enumerate() {
            let padding = " ".repeat(widths[column] - cell.chars().count());
            let right = numbers.contains(&column);
            let (before, after) = if right {
                (padding.as_str(), "")
            } else {
                ("", padding.as_str())
            };
            line.extend(["  ", before, cell, after]);
        }
        text += line.trim_end();
        text.push('\n');
    }
    text
}

/// A number with its unit; the unit 1 is omitted.
pub fn with_unit(number: &str, unit: &str) -> String {
    match unit {
        "" | "1" => number.to_owned(),
        unit => format!("{number} {unit}"),
    }
}

/// A number with six digits.
pub fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let size = value.abs();
    if !(1e-4..1e6).contains(&size) {
        return format!("{value:.3e}");
    }
    #[expect(clippy::cast_possible_truncation, reason = "between -4 and 5")]
    let before = size.log10().floor() as i32 + 1;
    let decimals = usize::try_from(6 - before.max(1)).unwrap_or(0);
    format!("{value:.decimals$}")
}
