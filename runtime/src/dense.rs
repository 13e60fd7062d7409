//! Factorisation of small dense matrices.
//!
//! Emitted equations call these where a pivot may be zero. Pivots are selected by [`Real::if_less`] instead of
//! branches, so dual numbers differentiate through the factorisation and each lane of a batch has its own row order.
//! Nothing panics: a singular matrix gives non-finite numbers.

use crate::Real;

/// P A = L U with partial pivoting, `N` rows and columns (Golub and Van Loan, *Matrix
/// Computations*, 4th edition, algorithm 3.4.1).
#[derive(Debug, Clone, Copy)]
pub struct Lu<T, const N: usize> {
    /// U on and above the diagonal, the multipliers of L below it.
    factors: [[T; N]; N],
    /// Entry (i, k) is 1 where rows k and i > k were exchanged in column k, and 0 elsewhere.
    exchanged: [[T; N]; N],
}

/// Factors `matrix`, `N` × `N`, row by row.
///
/// In column k each lower row in turn is exchanged with the pivot row if its entry is larger. The final pivot is the
/// largest entry, as in the textbook; only the order of the other rows differs.
#[inline]
pub fn lu_factor<T: Real, const N: usize>(matrix: [[T; N]; N]) -> Lu<T, N> {
    let (zero, one) = (T::constant(0.0), T::constant(1.0));
    let mut a = matrix;
    let mut exchanged = [[zero; N]; N];
    for k in 0..N {
        for i in k + 1..N {
            let exchange = T::if_less(a[k][k].abs(), a[i][k].abs(), one, zero);
            for j in 0..N {
                (a[k][j], a[i][j]) = exchange_if(exchange, a[k][j], a[i][j]);
            }
            exchanged[i][k] = exchange;
        }
        for i in k + 1..N {
            a[i][k] = a[i][k] / a[k][k];
            for j in k + 1..N {
                a[i][j] = a[i][j] - a[i][k] * a[k][j];
            }
        }
    }
    Lu {
        factors: a,
        exchanged,
    }
}

/// Solves A x = `right`, `N` numbers, given the factors of A. Singular A gives non-finite x.
#[inline]
pub fn lu_solve<T: Real, const N: usize>(lu: &Lu<T, N>, right: [T; N]) -> [T; N] {
    let mut x = right;
    // Exchanges of later columns also moved the multipliers, so all of them come first.
    for k in 0..N {
        for i in k + 1..N {
            (x[k], x[i]) = exchange_if(lu.exchanged[i][k], x[k], x[i]);
        }
    }
    // L y = P b.
    for i in 1..N {
        for k in 0..i {
            x[i] = x[i] - lu.factors[i][k] * x[k];
        }
    }
    // U x = y.
    for i in (0..N).rev() {
        for k in i + 1..N {
            x[i] = x[i] - lu.factors[i][k] * x[k];
        }
        x[i] = x[i] / lu.factors[i][i];
    }
    x
}

/// Solves `matrix` x = `right` once. Singular matrices give non-finite x.
#[inline]
pub fn solve<T: Real, const N: usize>(matrix: [[T; N]; N], right: [T; N]) -> [T; N] {
    lu_solve(&lu_factor(matrix), right)
}

/// (`lower`, `upper`) where `exchange` is 1, (`upper`, `lower`) where it is 0.
#[inline]
fn exchange_if<T: Real>(exchange: T, upper: T, lower: T) -> (T, T) {
    let zero = T::constant(0.0);
    (
        T::if_less(zero, exchange, lower, upper),
        T::if_less(zero, exchange, upper, lower),
    )
}

/// Solves A X = B in place for sizes known at run time and returns the smallest absolute pivot.
///
/// `matrix` holds A, n × n row by row, and is overwritten with its factors; `right` holds B, n × c row by row, and is
/// overwritten with X. The operations and their order are those of [`lu_factor`] and [`lu_solve`], so the results
/// agree bit for bit. A singular A gives non-finite X. If the lengths of the slices do not match n they are left
/// unchanged and the result is NaN.
pub fn lu_solve_in_place(matrix: &mut [f64], right: &mut [f64], n: usize) -> f64 {
    if n == 0 || matrix.len() != n * n || !right.len().is_multiple_of(n) {
        return f64::NAN;
    }
    let c = right.len() / n;
    let mut smallest_pivot = f64::INFINITY;
    for k in 0..n {
        for i in k + 1..n {
            if magnitude(matrix[k * n + k]) < magnitude(matrix[i * n + k]) {
                exchange_rows(matrix, n, k, i);
                exchange_rows(right, c, k, i);
            }
        }
        let pivot = magnitude(matrix[k * n + k]);
        smallest_pivot = if pivot.is_nan() {
            0.0
        } else {
            smallest_pivot.min(pivot)
        };
        for i in k + 1..n {
            matrix[i * n + k] /= matrix[k * n + k];
            for j in k + 1..n {
                matrix[i * n + j] -= matrix[i * n + k] * matrix[k * n + j];
            }
        }
    }
    for i in 1..n {
        for k in 0..i {
            for j in 0..c {
                right[i * c + j] -= matrix[i * n + k] * right[k * c + j];
            }
        }
    }
    for i in (0..n).rev() {
        for k in i + 1..n {
            for j in 0..c {
                right[i * c + j] -= matrix[i * n + k] * right[k * c + j];
            }
        }
        for j in 0..c {
            right[i * c + j] /= matrix[i * n + i];
        }
    }
    smallest_pivot
}

/// The same without the pivot: X replaces B. False for a matrix that is singular up to rounding or not finite;
/// `right` is then invalid.
pub fn solved_in_place(matrix: &mut [f64], right: &mut [f64], n: usize) -> bool {
    let pivot = lu_solve_in_place(matrix, right, n);
    pivot > 0.0 && right.iter().all(|entry| entry.is_finite())
}

/// |x| by clearing the sign bit; `f64::abs` is not available in every feature set.
#[inline]
fn magnitude(x: f64) -> f64 {
    f64::from_bits(x.to_bits() & (u64::MAX >> 1))
}

#[inline]
fn exchange_rows(matrix: &mut [f64], columns: usize, upper: usize, lower: usize) {
    for j in 0..columns {
        matrix.swap(upper * columns + j, lower * columns + j);
    }
}
