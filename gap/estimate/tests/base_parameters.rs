//! Base parameters.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_estimate::BaseParameters;
use nalgebra::DMatrix;

/// Numbers that look random: the fractional parts of multiples of an irrational number.
fn scatter(i: i32, k: f64) -> f64 {
    (f64::from(i) * k).fract() - 0.5
}

#[test]
fn base_parameters_are_what_the_regressors_can_tell_apart() {
    // The third column is the first twice and the second thrice.
    let columns = DMatrix::from_fn(40, 4, |i, j| {
        let i = i32::try_from(i).unwrap();
        let [a, b, c] = [0.618, 0.414, 0.732].map(|k| scatter(i + 1, k));
        [a, 1e3 * b, 2.0 * a + 3e3 * b, c][j]
    });
    let base = BaseParameters::of(&columns, 1e-8);
    assert_eq!((base.independent.len(), base.dependent.len()), (3, 1));
    let basis = columns.select_columns(&base.independent);
    let off = columns.select_columns(&base.dependent) - basis * &base.combinations;
    assert!(off.amax() < 1e-9, "{off}");
}
