//! Derivatives of functions for which a model has no formula, by central differences of order eight.

/// In units in which the function is smooth: the truncation error falls with the eighth power.
const STEP: f64 = 1e-2;
/// Weights of the first derivative.
const FIRST: [f64; 4] = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
/// Weights of the second derivative.
const SECOND: [f64; 4] = [8.0 / 5.0, -1.0 / 5.0, 8.0 / 315.0, -1.0 / 560.0];

/// The derivative at zero, exact to some thirteen digits of the function.
pub(crate) fn slope(at: impl Fn(f64) -> f64) -> f64 {
    let mut slope = 0.0;
    let mut by = 0.0;
    for weight in FIRST {
        by += STEP;
        slope += weight * (at(by) - at(-by)) / STEP;
    }
    slope
}

/// Value, first and second derivative at zero.
pub(crate) fn derivatives(at: impl Fn(f64) -> [f64; 2], step: f64) -> [[f64; 2]; 3] {
    let here = at(0.0);
    let (mut first, mut second) = ([0.0; 2], [0.0; 2]);
    for k in 0..4 {
        let away = step * (k + 1) as f64;
        let (before, after) = (at(-away), at(away));
        for i in 0..2 {
            first[i] += FIRST[k] * (after[i] - before[i]) / step;
            second[i] += SECOND[k] * (after[i] - here[i] + (before[i] - here[i])) / (step * step);
        }
    }
    [here, first, second]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_have_thirteen_digits() {
        let wanted = 0.7_f64.cos();
        let found = slope(|by| (0.7 + by).sin());
        assert!((found - wanted).abs() < 1e-13, "{found}");
    }
}
