//! Coefficients of the characteristic polynomial.

use nalgebra::DMatrix;

use super::hessenberg::{balance, drop_negligible, reduce};
use super::{SpectrumError, finite, row_by_row, square};

/// The coefficients of `det(λ 1 − A) = λⁿ + c₁ λⁿ⁻¹ + … + cₙ`, from 1 to cₙ.
///
/// From the Hessenberg form by the recursion of La Budde (Rehman and Ipsen, *Computing
/// characteristic polynomials from eigenvalues*, 2011), which divides by nothing. The coefficients
/// are smooth functions of the matrix where eigenvalues are not: where they meet.
pub fn characteristic_polynomial(a: &DMatrix<f64>) -> Result<Vec<f64>, SpectrumError> {
    let n = square(a)?;
    let mut h = row_by_row(a);
    finite(&h, n)?;
    drop_negligible(&mut h);
    balance(&mut h, n);
    reduce(&mut h, n, &mut vec![0.0; n]);
    // det(λ 1 − H) of the leading blocks, highest power first.
    let mut leading: Vec<Vec<f64>> = vec![vec![1.0]];
    for i in 0..n {
        let mut next = vec![0.0; i + 2];
        let mut subtract = |factor: f64, block: &[f64]| {
            let lower = next.len() - block.len();
            for (next, coefficient) in next[lower..].iter_mut().zip(block) {
                *next -= factor * coefficient;
            }
        };
        let mut below = 1.0;
        for j in (0..=i).rev() {
            subtract(h[j * n + i] * below, &leading[j]);
            below *= if j > 0 { h[j * n + j - 1] } else { 0.0 };
        }
        for (next, coefficient) in next.iter_mut().zip(&leading[i]) {
            *next += coefficient;
        }
        leading.push(next);
    }
    Ok(leading.pop().unwrap_or_default())
}
