//! Condition numbers against eigenvalues by nalgebra.

use appell_runtime::condition::condition_number;
use nalgebra::DMatrix;

/// Power iterations end at about this accuracy for matrices without close eigenvalues.
const DIGITS: f64 = 1e-6;

/// ρ(|A⁻¹| |A|) by eigenvalues.
fn by_eigenvalues(matrix: &[f64], n: usize) -> f64 {
    let a = DMatrix::from_row_slice(n, n, matrix);
    let inverse = a.clone().try_inverse().expect("a regular matrix");
    let product = inverse.abs() * a.abs();
    let eigenvalues = product.complex_eigenvalues();
    eigenvalues.iter().map(|z| z.norm()).fold(0.0, f64::max)
}

const MATRIX: [f64; 9] = [4.0, -1.0, 0.5, 2.0, 3.0, -2.5, -0.5, 1.5, 2.0];

#[test]
fn the_condition_number_is_the_spectral_radius() {
    let found = condition_number(&MATRIX, 3);
    let expected = by_eigenvalues(&MATRIX, 3);
    assert!(
        (found / expected - 1.0).abs() < DIGITS,
        "{found}, {expected}"
    );
    // [1 a; a 1]: (1 + a)/(1 - a).
    for a in [0.0, 0.5, 0.999_999] {
        let found = condition_number(&[1.0, a, a, 1.0], 2);
        assert!(
            (found / ((1.0 + a) / (1.0 - a)) - 1.0).abs() < DIGITS,
            "{a}: {found}"
        );
    }
}

#[test]
fn units_of_rows_and_columns_do_not_matter() {
    let expected = condition_number(&MATRIX, 3);
    let (rows, columns) = ([1e-6, 1.0, 1e3], [1e2, 1e-4, 1.0]);
    let scaled: Vec<f64> = (0..9)
        .map(|k| rows[k / 3] * MATRIX[k] * columns[k % 3])
        .collect();
    let found = condition_number(&scaled, 3);
    assert!(
        (found / expected - 1.0).abs() < DIGITS,
        "{found}, {expected}"
    );
}

#[test]
fn singular_matrices_have_no_finite_condition_number() {
    assert!(condition_number(&[1.0, 2.0, 2.0, 4.0], 2).is_infinite());
    assert!(condition_number(&[0.0], 1).is_infinite());
    assert!(condition_number(&[1.0, f64::NAN, 0.0, 1.0], 2).is_nan());
    assert!(condition_number(&[1.0], 2).is_nan());
    let nearly = condition_number(&[1.0, 1.0, 1.0, 1.0 + 1e-13], 2);
    assert!(nearly > 1e12, "{nearly}");
}

#[test]
fn a_model_without_speeds_is_perfectly_conditioned() {
    assert!((condition_number(&[], 0) - 1.0).abs() < DIGITS);
}
