//! Slopes of functions for which a model has no derivative.

/// In units in which the function is smooth: what is left out falls with the eighth power.
const STEP: f64 = 1e-2;
/// Central differences of order eight.
const WEIGHTS: [f64; 4] = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];

/// The derivative at zero, exact to some thirteen digits of the function.
pub(crate) fn slope(at: impl Fn(f64) -> f64) -> f64 {
    let mut slope = 0.0;
    let mut by = 0.0;
    for weight in WEIGHTS {
        by += STEP;
        slope += weight * (at(by) - at(-by)) / STEP;
    }
    slope
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
