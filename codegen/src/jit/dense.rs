//! Linear solvers called by machine code.
//!
//! Small systems use the factorisation of emitted code, monomorphised for each size. Larger ones, rare in
//! mechanisms, are factorised again for each right-hand side; the operations and their order are the same.

use std::slice;

use appell_runtime::dense::{Lu, lu_factor, lu_solve, lu_solve_in_place};

/// Factors the matrix at the first address into the second; the third is the number of rows.
pub(super) type Factor = unsafe extern "C" fn(*const f64, *mut f64, usize);
/// Replaces the right-hand side at the second address by the solution, given the output of [`Factor`].
pub(super) type Solve = unsafe extern "C" fn(*const f64, *mut f64, usize);

/// Solver routines for one size.
#[derive(Debug, Clone, Copy)]
pub(super) struct Routines {
    /// Factorisation.
    pub(super) factor: Factor,
    /// Solution.
    pub(super) solve: Solve,
    /// Size of the output of `factor`.
    pub(super) bytes: usize,
}

impl Routines {
    /// Routines for `rows` unknowns.
    pub(super) fn new(rows: usize) -> Self {
        macro_rules! by_size {
            ($($n:literal)+) => {
                match rows {
                    $($n => Self::sized::<$n>(),)+
                    _ => Self {
                        factor: keep,
                        solve: factor_and_solve,
                        bytes: rows * rows * size_of::<f64>(),
                    },
                }
            };
        }
        by_size!(1 2 3 4 5 6 7 8 9 10 11 12)
    }

    fn sized<const N: usize>() -> Self {
        const { assert!(align_of::<Lu<f64, N>>() <= align_of::<f64>()) };
        Self {
            factor: factor::<N>,
            solve: solve::<N>,
            bytes: size_of::<Lu<f64, N>>(),
        }
    }
}

/// # Safety
///
/// `matrix` points to `N * N` numbers, `lu` to room for an `Lu<f64, N>`.
unsafe extern "C" fn factor<const N: usize>(matrix: *const f64, lu: *mut f64, _rows: usize) {
    // SAFETY: the caller's promise; arrays of arrays of f64 have the layout of plain numbers, and
    // the alignment of the factors is that of f64.
    unsafe {
        let matrix = matrix.cast::<[[f64; N]; N]>().read();
        lu.cast::<Lu<f64, N>>().write(lu_factor(matrix));
    }
}

/// # Safety
///
/// `lu` points to what `factor::<N>` wrote, `right` to `N` numbers that nothing else uses.
unsafe extern "C" fn solve<const N: usize>(lu: *const f64, right: *mut f64, _rows: usize) {
    // SAFETY: the caller's promise.
    unsafe {
        let right = right.cast::<[f64; N]>();
        right.write(lu_solve(&*lu.cast::<Lu<f64, N>>(), right.read()));
    }
}

/// # Safety
///
/// `matrix` and `copy` point to `rows * rows` numbers each, which do not overlap.
unsafe extern "C" fn keep(matrix: *const f64, copy: *mut f64, rows: usize) {
    // SAFETY: the caller's promise.
    unsafe { copy.copy_from_nonoverlapping(matrix, rows * rows) }
}

/// # Safety
///
/// `matrix` points to `rows * rows` numbers, `right` to `rows` numbers that nothing else uses.
unsafe extern "C" fn factor_and_solve(matrix: *const f64, right: *mut f64, rows: usize) {
    // SAFETY: the caller's promise.
    let (matrix, right) = unsafe {
        (
            slice::from_raw_parts(matrix, rows * rows),
            slice::from_raw_parts_mut(right, rows),
        )
    };
    lu_solve_in_place(&mut matrix.to_vec(), right, rows);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A matrix without symmetry whose rows have to be exchanged.
    fn system(rows: usize) -> (Vec<f64>, Vec<f64>) {
        let entry = |i: usize, j: usize| ((i * 31 + j * 17 + 7) as f64 * 0.73).sin();
        let matrix = (0..rows * rows)
            .map(|k| entry(k / rows, k % rows))
            .collect();
        (matrix, (0..rows).map(|i| entry(i, rows)).collect())
    }

    #[test]
    fn every_size_solves_like_the_runtime() {
        for rows in 1..=20 {
            let (matrix, right) = system(rows);
            let routines = Routines::new(rows);
            let mut lu = vec![0.0; routines.bytes / size_of::<f64>()];
            let mut found = right.clone();
            // SAFETY: the buffers have the sizes that the routines require.
            unsafe {
                (routines.factor)(matrix.as_ptr(), lu.as_mut_ptr(), rows);
                (routines.solve)(lu.as_ptr(), found.as_mut_ptr(), rows);
            }
            let mut expected = right;
            lu_solve_in_place(&mut matrix.clone(), &mut expected, rows);
            assert_eq!(found, expected, "{rows} rows");
        }
    }
}
