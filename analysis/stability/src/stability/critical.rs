//! Changes of stability: smooth test functions of the coefficients of the characteristic
//! polynomial.
//!
//! Eigenvalues are not smooth where they coincide, so their zeros cannot be found to rounding. The
//! coefficients are smooth. Without the zero eigenvalues of families,
//!
//! - a real eigenvalue passes through zero where the last coefficient does;
//! - a pair crosses the imaginary axis where the last but one Hurwitz determinant is zero (E. Routh
//!   and A. Hurwitz; L. Orlando, 1911);
//! - where the polynomial is even, as for time-reversible systems, pairs leave the axis where two
//!   of them coincide: where the discriminant in λ² is zero.

use nalgebra::DMatrix;

use appell_spectra::spectrum::Complex;

/// Odd coefficients below this, relative to the size of the even ones, are zero.
const EVEN: f64 = 1e-10;
/// Eigenvalues within this fraction of the largest lie on an axis, or coincide, where a criterion
/// is zero to rounding.
const NEAR: f64 = 1e-4;
/// Real parts below this fraction of the largest eigenvalue count as zero where the uncertainty is
/// unknown.
pub(crate) const REST: f64 = 1e-6;

/// What happens at a critical point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Change {
    /// A real eigenvalue passes through zero.
    RealZero,
    /// A pair of eigenvalues passes through the imaginary axis.
    Oscillation {
        /// Its imaginary part in rad/s.
        frequency: f64,
    },
    /// Two pairs of imaginary eigenvalues meet and leave the axis.
    Collision {
        /// Their imaginary part in rad/s.
        frequency: f64,
    },
}

/// Functions of the characteristic polynomial whose zeros are critical, for one family of matrices.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Criteria {
    /// Eigenvalues that are zero everywhere.
    pub(crate) zeros: usize,
    /// Whether all polynomials are even, apart from the zeros.
    pub(crate) even: bool,
    /// Unit of the eigenvalues, in 1/s.
    pub(crate) unit: f64,
}

impl Criteria {
    /// For the characteristic polynomials of a family, all of which have `zeros` zero roots.
    pub(crate) fn of(polynomials: &[Vec<f64>], zeros: usize) -> Self {
        // A typical eigenvalue: the largest estimate from any coefficient.
        let size = |(k, c): (usize, &f64)| c.abs().powf(1.0 / k.max(1) as f64);
        let each = polynomials
            .iter()
            .flat_map(|p| p.iter().enumerate().skip(1));
        let unit = each.map(size).fold(0.0, f64::max);
        let unit = if unit > 0.0 { unit } else { 1.0 };
        let mut criteria = Self {
            zeros,
            even: true,
            unit,
        };
        criteria.even = polynomials.iter().all(|coefficients| {
            let scaled = criteria.scaled(coefficients);
            let largest = scaled.iter().fold(0.0_f64, |max, c| max.max(c.abs()));
            let mut odd = scaled.iter().skip(1).step_by(2);
            odd.all(|c| c.abs() <= EVEN * largest)
        });
        criteria
    }

    /// The polynomial without its zeros, λ in the unit.
    fn scaled(&self, coefficients: &[f64]) -> Vec<f64> {
        let kept = coefficients.len().saturating_sub(self.zeros);
        let power = |k: usize| self.unit.powi(i32::try_from(k).unwrap_or(i32::MAX));
        let scaled = coefficients[..kept].iter().enumerate();
        scaled.map(|(k, c)| c / power(k)).collect()
    }

    /// The last coefficient, and the determinant or discriminant; 1 if there is none.
    pub(crate) fn values(&self, coefficients: &[f64]) -> [f64; 2] {
        let scaled = self.scaled(coefficients);
        let degree = scaled.len().saturating_sub(1);
        if degree == 0 {
            return [1.0; 2];
        }
        let pairs = if self.even {
            let in_square: Vec<f64> = scaled.iter().step_by(2).copied().collect();
            if in_square.len() > 2 {
                discriminant(&in_square)
            } else {
                1.0
            }
        } else if degree > 1 {
            hurwitz(&scaled)
        } else {
            1.0
        };
        [scaled[degree], pairs]
    }

    /// The signs of the two values for these eigenvalues, zeros excluded; 0 where rounding decides.
    pub(crate) fn signs(&self, values: &[Complex<f64>]) -> [f64; 2] {
        let sign = |factors: &mut dyn Iterator<Item = Complex<f64>>| {
            let product = factors.fold(Complex::from(1.0), |product, factor| {
                product * factor / factor.norm()
            });
            if product.re.is_nan() { 0.0 } else { product.re }
        };
        let last = sign(&mut values.iter().copied());
        if !self.even {
            let pairs = values.iter().enumerate();
            let mut sums = pairs.flat_map(|(i, a)| values[..i].iter().map(move |b| a + b));
            return [last, sign(&mut sums)];
        }
        // Each pair of complex squares makes one factor negative; it has two eigenvalues above the
        // real axis.
        let largest = values.iter().map(|value| value.norm()).fold(0.0, f64::max);
        let beside =
            |value: &&Complex<f64>| value.re.abs() > REST * largest && value.im > REST * largest;
        let above = values.iter().filter(beside).count();
        [last, if above / 2 % 2 == 0 { 1.0 } else { -1.0 }]
    }

    /// The change where one of the two values is zero, if the eigenvalues confirm that stability
    /// changes there.
    pub(crate) fn change(&self, which: usize, values: &[Complex<f64>]) -> Option<Change> {
        if which == 0 {
            return Some(Change::RealZero);
        }
        let largest = values.iter().map(|value| value.norm()).fold(0.0, f64::max);
        let small = NEAR * largest;
        let mut on_axis: Vec<f64> = values
            .iter()
            .filter(|value| value.re.abs() <= small && value.im > small)
            .map(|value| value.im)
            .collect();
        on_axis.sort_by(f64::total_cmp);
        if !self.even {
            // The pair nearest to the axis.
            let near = values.iter().filter(|value| value.im > small);
            let nearest = near.min_by(|a, b| a.re.abs().total_cmp(&b.re.abs()))?;
            let crosses = nearest.re.abs() <= small;
            return crosses.then_some(Change::Oscillation {
                frequency: nearest.im,
            });
        }
        let meeting = on_axis
            .windows(2)
            .min_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])))?;
        let frequency = f64::midpoint(meeting[0], meeting[1]);
        (meeting[1] - meeting[0] <= small).then_some(Change::Collision { frequency })
    }
}

/// The Hurwitz determinant of order n − 1: the product of the sums of all pairs of roots, up to
/// sign.
fn hurwitz(coefficients: &[f64]) -> f64 {
    let order = coefficients.len() - 2;
    let entry = |i: usize, j: usize| {
        let place = (2 * j + 1).checked_sub(i);
        place
            .and_then(|place| coefficients.get(place))
            .copied()
            .unwrap_or(0.0)
    };
    DMatrix::from_fn(order, order, entry).determinant()
}

/// The product of the squared differences of all pairs of roots, up to sign: the resultant with the
/// derivative (J. J. Sylvester, 1840).
fn discriminant(coefficients: &[f64]) -> f64 {
    let degree = coefficients.len() - 1;
    let slope: Vec<f64> = coefficients[..degree]
        .iter()
        .enumerate()
        .map(|(k, c)| c * (degree - k) as f64)
        .collect();
    let size = 2 * degree - 1;
    let shifted = |list: &[f64], by: usize, column: usize| {
        let place = column.checked_sub(by);
        place
            .and_then(|place| list.get(place))
            .copied()
            .unwrap_or(0.0)
    };
    let entry = |row: usize, column: usize| {
        if row < degree - 1 {
            shifted(coefficients, row, column)
        } else {
            shifted(&slope, row - (degree - 1), column)
        }
    };
    DMatrix::from_fn(size, size, entry).determinant()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polynomial(roots: &[Complex<f64>]) -> Vec<f64> {
        let mut coefficients = vec![Complex::new(1.0, 0.0)];
        for root in roots {
            let mut next = coefficients.clone();
            next.push(Complex::new(0.0, 0.0));
            for (k, c) in coefficients.iter().enumerate() {
                next[k + 1] -= root * c;
            }
            coefficients = next;
        }
        coefficients.iter().map(|c| c.re).collect()
    }

    #[test]
    fn the_determinant_of_hurwitz_is_the_product_of_sums_of_roots() {
        let roots = [(-1.0, 2.0), (-1.0, -2.0), (0.5, 0.0), (-3.0, 0.0)];
        let roots = roots.map(|(re, im)| Complex::new(re, im));
        let mut product = Complex::new(1.0, 0.0);
        for i in 0..4 {
            for j in i + 1..4 {
                product *= roots[i] + roots[j];
            }
        }
        let found = hurwitz(&polynomial(&roots));
        assert!((found - product.re).abs() < 1e-12 * product.re.abs());
    }

    #[test]
    fn the_discriminant_of_a_double_root_is_zero() {
        let found = discriminant(&[1.0, -3.0, 2.0]);
        // The resultant has the opposite sign of b² − 4ac.
        assert!((found + 1.0).abs() < 1e-15, "{found}");
        assert!(discriminant(&[1.0, -4.0, 5.0, -2.0]).abs() < 1e-14);
    }
}
