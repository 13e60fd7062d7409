//! Products of small matrices, stored row by row.

use std::slice::ChunksExact;

use nalgebra::{DMatrixView, DMatrixViewMut, Dyn, Matrix, Storage};

/// Number of products of numbers from which the packing of a blocked product is worth its time.
const LARGE: usize = 4096;

/// `c += a b`: `a` has `inner` columns, `b` as many rows.
pub(super) fn multiply_add(a: &[f64], b: &[f64], inner: usize, c: &mut [f64]) {
    let columns = b.len() / inner;
    if a.len() * columns >= LARGE {
        return add_product(&turned(b, columns), &turned(a, inner), c);
    }
    let rows = b.chunks_exact(columns);
    for (a, c) in a.chunks_exact(inner).zip(c.chunks_exact_mut(columns)) {
        add_row(a.iter(), &rows, c);
    }
}

/// `c += a b` for a row `c` and the rows of `b`, by pieces that stay in registers.
fn add_row<'a>(a: impl Iterator<Item = &'a f64> + Clone, b: &ChunksExact<'_, f64>, c: &mut [f64]) {
    let columns = c.len();
    let mut first = 0;
    while first + 8 <= columns {
        add_piece::<8>(a.clone(), b, first, c);
        first += 8;
    }
    if first + 4 <= columns {
        add_piece::<4>(a.clone(), b, first, c);
        first += 4;
    }
    if first + 2 <= columns {
        add_piece::<2>(a.clone(), b, first, c);
        first += 2;
    }
    if first < columns {
        add_piece::<1>(a, b, first, c);
    }
}

/// The same for some of its columns.
#[inline]
fn add_piece<'a, const WIDTH: usize>(
    a: impl Iterator<Item = &'a f64>,
    b: &ChunksExact<'_, f64>,
    first: usize,
    c: &mut [f64],
) {
    let Some(c) = c[first..].first_chunk_mut::<WIDTH>() else {
        return;
    };
    let mut sums = *c;
    for (&factor, b) in a.zip(b.clone()) {
        // Most gradients of coordinates and outputs have one or two nonzero entries.
        if factor != 0.0
            && let Some(b) = b[first..].first_chunk::<WIDTH>()
        {
            for (sum, b) in sums.iter_mut().zip(b) {
                *sum += factor * b;
            }
        }
    }
    *c = sums;
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
        return add_product(&turned(b, columns), &turned(a, rows).transpose(), c);
    }
    let of_b = b.chunks_exact(columns);
    let of_a = a.chunks_exact(rows);
    for (row, c) in c.chunks_exact_mut(columns).enumerate() {
        add_row(of_a.clone().map(|a| &a[row]), &of_b, c);
    }
}

/// `c += a bᵀ`: both have `inner` columns.
pub(super) fn multiply_transposed_add(a: &[f64], b: &[f64], inner: usize, c: &mut [f64]) {
    let columns = b.len() / inner;
    if a.len() * columns >= LARGE {
        return add_product(&turned(b, inner).transpose(), &turned(a, inner), c);
    }
    let rows = b.chunks_exact(inner);
    for (a, c) in a.chunks_exact(inner).zip(c.chunks_exact_mut(columns)) {
        for (b, c) in rows.clone().zip(c) {
            *c += dot(a, b);
        }
    }
}

/// `c = a bᵀ`
pub(super) fn multiply_transposed(a: &[f64], b: &[f64], inner: usize, c: &mut [f64]) {
    c.fill(0.0);
    multiply_transposed_add(a, b, inner, c);
}

/// A matrix with so many columns, transposed: by columns.
fn turned(matrix: &[f64], columns: usize) -> DMatrixView<'_, f64> {
    DMatrixView::from_slice(matrix, columns, matrix.len() / columns)
}

/// `cᵀ += bᵀ aᵀ` of transposed matrices, by blocks.
fn add_product<B, A>(b: &Matrix<f64, Dyn, Dyn, B>, a: &Matrix<f64, Dyn, Dyn, A>, c: &mut [f64])
where
    B: Storage<f64, Dyn, Dyn>,
    A: Storage<f64, Dyn, Dyn>,
{
    DMatrixViewMut::from_slice(c, b.nrows(), a.ncols()).gemm(1.0, b, a, 1.0);
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
