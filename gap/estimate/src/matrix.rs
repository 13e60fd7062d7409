//! Products of small matrices, stored row by row.

use nalgebra::{DMatrixView, DMatrixViewMut};

/// Number of products of numbers from which the packing of a blocked product is worth its time.
const LARGE: usize = 4096;

/// `c += a b`: `a` has `inner` columns, `b` as many rows.
pub(super) fn multiply_add(a: &[f64], b: &[f64], inner: usize, c: &mut [f64]) {
    let columns = b.len() / inner;
    if a.len() * columns >= LARGE {
        // By columns they are the transposed matrices: cᵀ += bᵀ aᵀ.
        let rows = a.len() / inner;
        let [a, b] = [
            DMatrixView::from_slice(a, inner, rows),
            DMatrixView::from_slice(b, columns, inner),
        ];
        DMatrixViewMut::from_slice(c, columns, rows).gemm(1.0, &b, &a, 1.0);
        return;
    }
    for (a, c) in a.chunks_exact(inner).zip(c.chunks_exact_mut(columns)) {
        for (&factor, b) in a.iter().zip(b.chunks_exact(columns)) {
            // Most gradients of coordinates and outputs have one or two nonzero entries.
            if factor != 0.0 {
                add_scaled(factor, b, c);
            }
        }
    }
}

/// `c = a b`
pub(super) fn multiply(a: &[f64], b: &[f64], inner: usize, c: &mut [f64]) {
    c.fill(0.0);
    multiply_add(a, b, inner, c);
}

/// `c = aᵀ b`: both have `inner` rows.
pub(super) fn transposed_multiply(a: &[f64], b: &[f64], inner: usize, c: &mut [f64]) {
    let (rows, columns) = (a.len() / inner, b.len() / inner);
    c.fill(0.0);
    if a.len() * columns >= LARGE {
        let a = DMatrixView::from_slice(a, rows, inner).transpose();
        let b = DMatrixView::from_slice(b, columns, inner);
        DMatrixViewMut::from_slice(c, columns, rows).gemm(1.0, &b, &a, 1.0);
        return;
    }
    for (a, b) in a.chunks_exact(rows).zip(b.chunks_exact(columns)) {
        for (&factor, c) in a.iter().zip(c.chunks_exact_mut(columns)) {
            if factor != 0.0 {
                add_scaled(factor, b, c);
            }
        }
    }
}

/// `c += a bᵀ`: both have `inner` columns.
pub(super) fn multiply_transposed_add(a: &[f64], b: &[f64], inner: usize, c: &mut [f64]) {
    let columns = b.len() / inner;
    if a.len() * columns >= LARGE {
        let rows = a.len() / inner;
        let a = DMatrixView::from_slice(a, inner, rows);
        let b = DMatrixView::from_slice(b, inner, columns).transpose();
        DMatrixViewMut::from_slice(c, columns, rows).gemm(1.0, &b, &a, 1.0);
        return;
    }
    for (a, c) in a.chunks_exact(inner).zip(c.chunks_exact_mut(columns)) {
        for (b, c) in b.chunks_exact(inner).zip(c) {
            *c += dot(a, b);
        }
    }
}

/// `c = a bᵀ`
pub(super) fn multiply_transposed(a: &[f64], b: &[f64], inner: usize, c: &mut [f64]) {
    c.fill(0.0);
    multiply_transposed_add(a, b, inner, c);
}

/// `y += factor x`
pub(super) fn add_scaled(factor: f64, x: &[f64], y: &mut [f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += factor * x;
    }
}

/// `y += x`
pub(super) fn add(x: &[f64], y: &mut [f64]) {
    add_scaled(1.0, x, y);
}

/// `x = factor x`
pub(super) fn scale(factor: f64, x: &mut [f64]) {
    for x in x {
        *x *= factor;
    }
}

/// `xᵀ y`, for matrices the sum over all entries: four sums, none of which waits for another.
pub(super) fn dot(x: &[f64], y: &[f64]) -> f64 {
    const SUMS: usize = 4;
    let length = x.len().min(y.len());
    let (x, y) = (
        x[..length].chunks_exact(SUMS),
        y[..length].chunks_exact(SUMS),
    );
    let rest = x.remainder().iter().zip(y.remainder());
    let rest: f64 = rest.map(|(x, y)| x * y).sum();
    let mut sums = [0.0; SUMS];
    for (x, y) in x.zip(y) {
        for (sum, (x, y)) in sums.iter_mut().zip(x.iter().zip(y)) {
            *sum += x * y;
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

/// The unit matrix, n × n.
pub(super) fn set_identity(matrix: &mut [f64], n: usize) {
    matrix.fill(0.0);
    matrix
        .iter_mut()
        .step_by(n + 1)
        .for_each(|entry| *entry = 1.0);
}

/// The symmetric part of a matrix, n × n.
pub(super) fn symmetrise(matrix: &mut [f64], n: usize) {
    for i in 0..n {
        for j in 0..i {
            let mean = 0.5 * (matrix[i * n + j] + matrix[j * n + i]);
            matrix[i * n + j] = mean;
            matrix[j * n + i] = mean;
        }
    }
}

/// Cuts a slice into pieces of the given lengths; what remains is dropped.
pub(super) fn pieces<const N: usize>(
    mut slice: &mut [f64],
    lengths: [usize; N],
) -> [&mut [f64]; N] {
    lengths.map(|length| {
        let (piece, rest) = std::mem::take(&mut slice).split_at_mut(length);
        slice = rest;
        piece
    })
}
