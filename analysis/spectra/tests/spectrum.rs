//! Eigenvalues, eigenvectors and coefficients of matrices whose spectrum is known.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use appell_spectra::singular::Singular;
use appell_spectra::spectrum::{
    Complex, Spectrum, SpectrumError, characteristic_polynomial, eigenvalues,
};
use nalgebra::{DMatrix, DVector};

/// Rounding of an orthogonal reduction, relative to the matrix.
const ROUNDING: f64 = 1e-13;

/// Numbers between -1 and 1 that are the same in every run.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// Entries of mechanics: half of them zero, in every other matrix all of the diagonal.
fn sparse(random: &mut Random, n: usize, no_diagonal: bool) -> DMatrix<f64> {
    DMatrix::from_fn(n, n, |i, j| {
        let value = random.next();
        if value < 0.0 || (no_diagonal && (i + j) % 2 == 0) {
            0.0
        } else {
            10.0 * random.next()
        }
    })
}

#[test]
fn every_sparse_matrix_has_eigenvalues_whose_powers_sum_to_the_traces() {
    let mut random = Random(1);
    for number in 0..20_000 {
        let n = 1 + number % 9;
        let a = sparse(&mut random, n, number % 2 == 0);
        let values = eigenvalues(&a).unwrap_or_else(|error| panic!("{a}{error}"));
        assert_eq!(values.len(), n);
        let mut power = a.clone();
        for k in 1..=3 {
            let sum: Complex<f64> = values.iter().map(|z| z.powi(k)).sum();
            let size = a.norm().max(1.0).powi(k);
            let error = (sum - Complex::new(power.trace(), 0.0)).norm();
            assert!(
                error < ROUNDING * size,
                "{a}traces of power {k} differ by {error:e}"
            );
            power *= &a;
        }
    }
}

#[test]
fn entries_that_are_hardly_numbers_do_no_harm() {
    let mut random = Random(6);
    for _ in 0..500 {
        let a = sparse(&mut random, 6, true);
        let exact = eigenvalues(&a).unwrap();
        let dusty = a.map(|entry| {
            if entry == 0.0 {
                1e-310 * random.next()
            } else {
                entry
            }
        });
        assert_eq!(eigenvalues(&dusty).unwrap(), exact);
    }
}

#[test]
fn simple_modes_solve_their_equations_and_their_vectors_belong_to_them_alone() {
    let mut random = Random(2);
    for n in 1..=20 {
        let a = DMatrix::from_fn(n, n, |_, _| random.next());
        let spectrum = Spectrum::of(&a).unwrap();
        for (i, mode) in spectrum.modes.iter().enumerate() {
            assert!(mode.residual < ROUNDING * a.norm(), "{:e}", mode.residual);
            for (j, other) in spectrum.modes.iter().enumerate() {
                let along = mode.left.dotc(&other.right).norm();
                if i == j {
                    assert!((along * mode.condition - 1.0).abs() < 1e-10);
                } else {
                    assert!(
                        along < 1e-10 * mode.condition.max(1.0),
                        "{i} {j}: {along:e}"
                    );
                }
            }
        }
    }
}

#[test]
fn the_order_is_fixed_and_pairs_stand_together() {
    let a = DMatrix::from_row_slice(
        5,
        5,
        &[
            0.0, 2.0, 0.0, 0.0, 0.0, //
            -2.0, 0.0, 0.0, 0.0, 0.0, //
            0.0, 0.0, -1.0, 0.0, 0.0, //
            0.0, 0.0, 0.0, 3.0, 0.0, //
            0.0, 0.0, 0.0, 0.0, 0.0,
        ],
    );
    let values = eigenvalues(&a).unwrap();
    let expected = [(3.0, 0.0), (0.0, 2.0), (0.0, -2.0), (0.0, 0.0), (-1.0, 0.0)];
    for (value, (re, im)) in values.iter().zip(expected) {
        assert!(
            (value - Complex::new(re, im)).norm() < ROUNDING,
            "{values:?}"
        );
    }
}

#[test]
fn a_repeated_eigenvalue_has_as_many_vectors_as_exist() {
    // Three zeros: one of its own, two that share a vector.
    let mut a = DMatrix::zeros(4, 4);
    a[(1, 2)] = 1.0;
    a[(3, 3)] = -2.0;
    let spectrum = Spectrum::of(&a).unwrap();
    let zeros: Vec<_> = spectrum
        .modes
        .iter()
        .filter(|m| m.value.norm() < 1e-6)
        .collect();
    assert_eq!(zeros.len(), 3);
    let vectors = DMatrix::from_columns(
        &zeros
            .iter()
            .map(|m| m.right.map(|c| c.re))
            .collect::<Vec<DVector<f64>>>(),
    );
    assert_eq!(vectors.rank(1e-6), 2);
    assert!(zeros.iter().all(|mode| mode.condition > 1e6));
    // All of a unit matrix.
    let spectrum = Spectrum::of(&DMatrix::identity(5, 5)).unwrap();
    let columns: Vec<_> = spectrum.modes.iter().map(|m| m.right.clone()).collect();
    assert_eq!(DMatrix::from_columns(&columns).map(|c| c.re).rank(1e-6), 5);
    assert!(
        spectrum
            .modes
            .iter()
            .all(|mode| mode.condition < 1.0 + 1e-9)
    );
}

#[test]
fn coefficients_are_those_of_the_product_of_the_roots() {
    // A companion matrix, hidden behind a similarity.
    let coefficients = [1.0, -3.0, 2.5, 0.0, 7.0, -11.0];
    let n = coefficients.len() - 1;
    let companion = DMatrix::from_fn(n, n, |i, j| match (i, j) {
        (0, j) => -coefficients[j + 1],
        (i, j) if i == j + 1 => 1.0,
        _ => 0.0,
    });
    let mut random = Random(3);
    let turn = DMatrix::from_fn(n, n, |_, _| random.next()).qr().q();
    let a = &turn * companion * turn.transpose();
    let found = characteristic_polynomial(&a).unwrap();
    for (found, wanted) in found.iter().zip(coefficients) {
        assert!(
            (found - wanted).abs() < 1e-12 * 11.0,
            "{found} against {wanted}"
        );
    }
    assert_eq!(
        characteristic_polynomial(&DMatrix::zeros(0, 0)).unwrap(),
        [1.0]
    );
}

#[test]
fn coefficients_do_not_feel_that_zeros_share_a_vector() {
    // λ³ (λ² + 4): a chain of three for zero.
    let mut a = DMatrix::zeros(5, 5);
    (a[(0, 1)], a[(1, 2)], a[(3, 4)], a[(4, 3)]) = (1.0, 1.0, 2.0, -2.0);
    let mut random = Random(4);
    let turn = DMatrix::from_fn(5, 5, |_, _| random.next()).qr().q();
    let found = characteristic_polynomial(&(&turn * a * turn.transpose())).unwrap();
    for (found, wanted) in found.iter().zip([1.0, 0.0, 4.0, 0.0, 0.0, 0.0]) {
        assert!(
            (found - wanted).abs() < 1e-14 * 4.0,
            "{found} against {wanted}"
        );
    }
}

#[test]
fn singular_values_are_right_where_a_matrix_is_singular() {
    let mut random = Random(5);
    for number in 0..500 {
        let (rows, columns, rank) = (1 + number % 8, 1 + number % 7, 1 + number % 4);
        let a = DMatrix::from_fn(rows, rank, |_, _| random.next())
            * DMatrix::from_fn(rank, columns, |_, _| random.next());
        let singular = Singular::of(&a);
        let error = (&singular.images * singular.right.transpose() - &a).norm();
        assert!(error < ROUNDING * a.norm(), "{error:e}");
        assert!(singular.rank(1e-12) <= rank.min(rows).min(columns));
        // The shortest solution: A x reaches what can be reached, and x has no part that A loses.
        let wanted = &a * DVector::from_fn(columns, |_, _| random.next());
        let kept = singular.rank(1e-9);
        let x = singular.solve(&wanted, kept);
        assert!((&a * &x - &wanted).norm() < 1e-6 * wanted.norm());
        let lost = singular.right.columns(kept, columns - kept).transpose() * &x;
        assert!(lost.norm() < ROUNDING * x.norm());
    }
}

#[test]
fn what_is_no_square_of_numbers_is_told() {
    let error = eigenvalues(&DMatrix::zeros(2, 3)).unwrap_err();
    assert_eq!(
        error,
        SpectrumError::NotSquare {
            rows: 2,
            columns: 3
        }
    );
    let mut a = DMatrix::zeros(3, 3);
    a[(1, 2)] = f64::NAN;
    assert!(matches!(
        eigenvalues(&a),
        Err(SpectrumError::NotFinite {
            row: 1,
            column: 2,
            ..
        })
    ));
    assert!(eigenvalues(&DMatrix::zeros(0, 0)).unwrap().is_empty());
}
