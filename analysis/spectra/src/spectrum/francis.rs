//! Eigenvalues by the QR iteration with implicit double shifts (J. G. F. Francis, 1961; the
//! deflation of Wilkinson and Reinsch, Handbook for Automatic Computation II/15).

use nalgebra::Complex;

use super::hessenberg::{balance, drop_negligible, reduce};
use super::{SpectrumError, finite};

/// Maximum number of steps for one eigenvalue; a handful is usual.
const MOST_STEPS: usize = 60;
/// Steps after which a subdiagonal entry that is small relative to the norm of the matrix counts as zero.
const CHAIN: usize = 2 * EXCEPTIONAL;
/// Steps after which an exceptional shift breaks a cycle.
const EXCEPTIONAL: usize = 10;

/// Eigenvalues of real matrices of one size, with work arrays.
#[derive(Debug, Clone)]
pub struct Eigenvalues {
    n: usize,
    h: Vec<f64>,
    reflector: Vec<f64>,
    values: Vec<Complex<f64>>,
}

impl Eigenvalues {
    /// For matrices of `n` rows.
    pub fn new(n: usize) -> Self {
        Self {
            n,
            h: vec![0.0; n * n],
            reflector: vec![0.0; n],
            values: Vec::with_capacity(n),
        }
    }

    /// Rows of the matrices.
    pub fn size(&self) -> usize {
        self.n
    }

    /// Of a matrix, row by row: largest real part first, of a pair the one with positive imaginary
    /// part first.
    pub fn of(&mut self, a: &[f64]) -> Result<&[Complex<f64>], SpectrumError> {
        let n = self.n;
        if a.len() != n * n {
            let columns = a.len() / n.max(1);
            return Err(SpectrumError::NotSquare { rows: n, columns });
        }
        finite(a, n)?;
        self.h.copy_from_slice(a);
        drop_negligible(&mut self.h);
        balance(&mut self.h, n);
        reduce(&mut self.h, n, &mut self.reflector);
        self.values.clear();
        self.iterate()?;
        // Rounding must not decide between equal real parts.
        self.values.sort_by(|a, b| {
            let real = b.re.total_cmp(&a.re);
            real.then(b.im.abs().total_cmp(&a.im.abs()))
                .then(b.im.total_cmp(&a.im))
        });
        Ok(&self.values)
    }

    /// Splits off one or two eigenvalues at the lower end until none is left.
    fn iterate(&mut self) -> Result<(), SpectrumError> {
        let n = self.n;
        let norm = self.h.iter().map(|entry| entry.abs()).fold(0.0, f64::max);
        let (mut size, mut shifted, mut steps) = (n, 0.0, 0);
        while size > 0 {
            let last = size - 1;
            let first = self.deflated(last, norm, steps);
            if first == last {
                let value = self.h[last * n + last] + shifted;
                self.values.push(Complex::new(value, 0.0));
                (size, steps) = (last, 0);
            } else if first + 1 == last {
                self.pair(last, shifted);
                (size, steps) = (last - 1, 0);
            } else if steps == MOST_STEPS {
                return Err(SpectrumError::NoConvergence {
                    found: self.values.len(),
                    wanted: n,
                    iterations: steps,
                });
            } else {
                let shift = self.shift(last, steps, &mut shifted);
                self.double_step(first, last, shift);
                steps += 1;
            }
        }
        Ok(())
    }

    fn entry(&self, i: usize, j: usize) -> f64 {
        self.h[i * self.n + j]
    }

    /// Where the block that ends at `last` begins: above it a subdiagonal entry is zero to rounding.
    fn deflated(&mut self, last: usize, norm: f64, steps: usize) -> usize {
        let mut first = last;
        while first > 0 {
            let beside = self.entry(first - 1, first - 1).abs() + self.entry(first, first).abs();
            // Where both diagonal entries are zero, the norm of the matrix is the reference; likewise after
            // many steps, as for a Jordan chain of zero eigenvalues that is perturbed by rounding.
            let chain = steps > CHAIN;
            let beside = if beside == 0.0 || chain { norm } else { beside };
            if self.entry(first, first - 1).abs() <= f64::EPSILON * beside {
                self.h[first * self.n + first - 1] = 0.0;
                break;
            }
            first -= 1;
        }
        first
    }

    /// The two eigenvalues of the last 2 × 2 block.
    fn pair(&mut self, last: usize, shifted: f64) {
        let (x, y) = (self.entry(last, last), self.entry(last - 1, last - 1));
        let product = self.entry(last, last - 1) * self.entry(last - 1, last);
        let half = (y - x) / 2.0;
        let discriminant = half * half + product;
        let root = discriminant.abs().sqrt();
        if discriminant < 0.0 {
            let re = x + half + shifted;
            self.values.push(Complex::new(re, root));
            self.values.push(Complex::new(re, -root));
        } else {
            // The larger root first, the other from their product.
            let away = half + root.copysign(half);
            let near = if away == 0.0 { 0.0 } else { -product / away };
            self.values.push(Complex::new(x + away + shifted, 0.0));
            self.values.push(Complex::new(x + near + shifted, 0.0));
        }
    }

    /// From the last 2 × 2 block its diagonal, lower end first, and the product of the others, from
    /// which both shifts come.
    fn shift(&mut self, last: usize, steps: usize, shifted: &mut f64) -> [f64; 3] {
        if steps > 0 && steps.is_multiple_of(EXCEPTIONAL) {
            let x = self.entry(last, last);
            *shifted += x;
            for i in 0..=last {
                self.h[i * self.n + i] -= x;
            }
            let size = self.entry(last, last - 1).abs() + self.entry(last - 1, last - 2).abs();
            return [0.75 * size, 0.75 * size, -0.4375 * size * size];
        }
        [
            self.entry(last, last),
            self.entry(last - 1, last - 1),
            self.entry(last, last - 1) * self.entry(last - 1, last),
        ]
    }

    /// One step with two shifts on the block from `first` to `last`, at least three rows.
    fn double_step(&mut self, first: usize, last: usize, [x, y, product]: [f64; 3]) {
        let n = self.n;
        // Where two small subdiagonal entries follow each other, the step may begin below them.
        let mut start = last - 2;
        let mut column;
        loop {
            let z = self.entry(start, start);
            let (r, s) = (x - z, y - z);
            column = [
                (r * s - product) / self.entry(start + 1, start) + self.entry(start, start + 1),
                self.entry(start + 1, start + 1) - z - r - s,
                self.entry(start + 2, start + 1),
            ];
            let size: f64 = column.iter().map(|entry| entry.abs()).sum();
            column = column.map(|entry| entry / size);
            if start == first {
                break;
            }
            let above = self.entry(start, start - 1).abs() * (column[1].abs() + column[2].abs());
            let beside = self.entry(start - 1, start - 1).abs()
                + z.abs()
                + self.entry(start + 1, start + 1).abs();
            if above <= f64::EPSILON * column[0].abs() * beside {
                break;
            }
            start -= 1;
        }
        for i in start + 2..=last {
            self.h[i * n + i - 2] = 0.0;
            if i > start + 2 {
                self.h[i * n + i - 3] = 0.0;
            }
        }
        // The bulge moves down along the diagonal.
        for k in start..last {
            let rows = if k + 1 == last { 2 } else { 3 };
            let mut size = 1.0;
            if k > start {
                column = [0.0; 3];
                for i in 0..rows {
                    column[i] = self.entry(k + i, k - 1);
                }
                size = column.iter().map(|entry| entry.abs()).sum();
                if size == 0.0 {
                    continue;
                }
                column = column.map(|entry| entry / size);
            }
            let length = column.iter().map(|entry| entry * entry).sum::<f64>().sqrt();
            let length = length.copysign(column[0]);
            if k > start {
                self.h[k * n + k - 1] = -length * size;
            } else if first != start {
                self.h[k * n + k - 1] = -self.entry(k, k - 1);
            }
            let head = column[0] + length;
            // P = 1 - w vᵀ with v = (1, v₁, v₂).
            let v = [1.0, column[1] / head, column[2] / head];
            let w = [head / length, column[1] / length, column[2] / length];
            for j in k..=last {
                let along: f64 = (0..rows).map(|i| v[i] * self.entry(k + i, j)).sum();
                for i in 0..rows {
                    self.h[(k + i) * n + j] -= along * w[i];
                }
            }
            for i in first..=last.min(k + 3) {
                let along: f64 = (0..rows).map(|j| w[j] * self.entry(i, k + j)).sum();
                for j in 0..rows {
                    self.h[i * n + k + j] -= along * v[j];
                }
            }
        }
    }
}
