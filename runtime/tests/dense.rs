//! Small factorisations against nalgebra.

use appell_runtime::dense::{lu_factor, lu_solve, lu_solve_in_place, solve};
use appell_runtime::{Dual, Lanes, Real};
use nalgebra::{SMatrix, SVector};

/// Numbers in −1 … 1 from a linear congruential generator (Knuth's MMIX constants).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn matrix<const N: usize>(&mut self) -> [[f64; N]; N] {
        std::array::from_fn(|_| self.vector())
    }

    fn vector<const N: usize>(&mut self) -> [f64; N] {
        std::array::from_fn(|_| self.next())
    }
}

/// Solutions lose the digits of the condition number; random matrices of size 6 lose four.
const SOLVE_TOLERANCE: f64 = 1e-11;

fn agrees_with_nalgebra<const N: usize>(numbers: &mut Numbers) {
    for _ in 0..200 {
        let (a, b) = (numbers.matrix::<N>(), numbers.vector::<N>());
        let matrix = SMatrix::<f64, N, N>::from_fn(|i, j| a[i][j]);
        let right = SVector::<f64, N>::from_fn(|i, _| b[i]);
        let x = SVector::<f64, N>::from(solve(a, b));
        let residual = (matrix * x - right).amax();
        assert!(residual < SOLVE_TOLERANCE * x.amax(), "{residual:e}");
    }
}

#[test]
fn solutions_agree_with_nalgebra() {
    let mut numbers = Numbers(1);
    agrees_with_nalgebra::<1>(&mut numbers);
    agrees_with_nalgebra::<2>(&mut numbers);
    agrees_with_nalgebra::<3>(&mut numbers);
    agrees_with_nalgebra::<6>(&mut numbers);
}

#[test]
fn the_slice_version_agrees_bit_by_bit() {
    let mut numbers = Numbers(2);
    for _ in 0..100 {
        let (a, b, c) = (
            numbers.matrix::<5>(),
            numbers.vector::<5>(),
            numbers.vector::<5>(),
        );
        let lu = lu_factor(a);
        let (x, y) = (lu_solve(&lu, b), lu_solve(&lu, c));
        let mut matrix: Vec<f64> = a.concat();
        let mut right: Vec<f64> = b.iter().zip(&c).flat_map(|(b, c)| [*b, *c]).collect();
        lu_solve_in_place(&mut matrix, &mut right, 5);
        let expected: Vec<f64> = x.iter().zip(&y).flat_map(|(x, y)| [*x, *y]).collect();
        let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&right), bits(&expected));
    }
}

#[test]
fn duals_differentiate_through_the_factorisation() {
    // ẋ = −A⁻¹ Ȧ x + A⁻¹ ḃ.
    let mut numbers = Numbers(3);
    for _ in 0..50 {
        let (a, a_dot) = (numbers.matrix::<4>(), numbers.matrix::<4>());
        let (b, b_dot) = (numbers.vector::<4>(), numbers.vector::<4>());
        let dual = |value, partial| Dual {
            value,
            partials: [partial],
        };
        let x: [Dual<f64, 1>; 4] = solve(
            std::array::from_fn(|i| std::array::from_fn(|j| dual(a[i][j], a_dot[i][j]))),
            std::array::from_fn(|i| dual(b[i], b_dot[i])),
        );
        let value = x.map(|x| x.value);
        let right: [f64; 4] =
            std::array::from_fn(|i| b_dot[i] - (0..4).map(|j| a_dot[i][j] * value[j]).sum::<f64>());
        let expected = solve(a, right);
        for i in 0..4 {
            assert_eq!(value[i].to_bits(), solve(a, b)[i].to_bits());
            let gap = (x[i].partials[0] - expected[i]).abs();
            assert!(gap < 1e-9 * (1.0 + expected[i].abs()), "{gap:e}");
        }
    }
}

#[test]
fn each_lane_has_its_own_row_order() {
    let mut numbers = Numbers(4);
    let matrices = [numbers.matrix::<4>(), numbers.matrix(), numbers.matrix()];
    let right = [numbers.vector::<4>(), numbers.vector(), numbers.vector()];
    let lanes: [Lanes<3>; 4] = solve(
        std::array::from_fn(|i| {
            std::array::from_fn(|j| Lanes::standard(matrices.map(|a| a[i][j])))
        }),
        std::array::from_fn(|i| Lanes::standard(right.map(|b| b[i]))),
    );
    for lane in 0..3 {
        let scalar = solve(matrices[lane], right[lane]);
        for i in 0..4 {
            assert_eq!(lanes[i].0[lane].to_bits(), scalar[i].to_bits());
        }
    }
}

#[test]
fn a_zero_on_the_diagonal_is_no_obstacle() {
    let x = solve([[0.0, 2.0], [4.0, 0.0]], [6.0, 8.0]);
    assert_eq!(x.map(|x| x.to_string()), ["2", "3"]);
}

#[test]
fn singular_matrices_give_numbers_that_are_not_finite() {
    let singular: [[[f64; 3]; 3]; 4] = [
        [[0.0; 3]; 3],
        [[1.0, 2.0, 3.0], [2.0, 4.0, 6.0], [1.0, 0.0, 1.0]],
        [[1.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
        [[f64::NAN, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    ];
    for a in singular {
        let lu = lu_factor(a);
        let x = lu_solve(&lu, [1.0, 2.0, 3.0]);
        assert!(x.iter().any(|x| !x.is_finite()), "{a:?}: {x:?}");
        let dual = solve(
            a.map(|row| row.map(Dual::<f64, 2>::constant)),
            [Dual::constant(1.0); 3],
        );
        assert!(dual.iter().any(|x| !x.value.is_finite()));
        let (mut matrix, mut right) = (a.concat(), vec![1.0, 2.0, 3.0]);
        assert!(lu_solve_in_place(&mut matrix, &mut right, 3).abs() == 0.0);
        assert!(right.iter().any(|x| !x.is_finite()));
    }
}

#[test]
fn slices_of_the_wrong_length_are_left_alone() {
    let (mut matrix, mut right) = (vec![1.0; 3], vec![1.0; 2]);
    assert!(lu_solve_in_place(&mut matrix, &mut right, 2).is_nan());
    assert!(lu_solve_in_place(&mut [], &mut [], 0).is_nan());
    assert_eq!(matrix.len(), 3);
}
