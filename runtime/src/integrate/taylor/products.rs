//! Sums over products of coefficients, for all products at once, of one motion or of the motions of a block.

// What is not inlined is not compiled for the vectors of the processor.
#![allow(clippy::inline_always)]

use crate::lanes::dispatch;

/// Products that are summed side by side.
const BLOCK: usize = 8;
/// So many numbers are a line of the cache, which vectors should not cross.
const LINE: usize = 8;
/// Blocks whose sums are carried along together: as many as the registers of AVX2 hold beside the factors.
const PANEL: usize = 6;

/// The factors of all products by order, and the sums over them. Operations and their order are the same for
/// vectors of any width.
#[derive(Debug, Clone, Default)]
pub(super) struct Products {
    count: usize,
    /// Blocks of one order.
    blocks: usize,
    left: Aligned,
    right: Aligned,
    sums: Aligned,
}

impl Products {
    /// Sizes the arrays for so many products up to an order.
    pub(super) fn prepare(&mut self, count: usize, order: usize) {
        self.count = count;
        self.blocks = count.div_ceil(BLOCK);
        for (factors, orders) in [
            (&mut self.left, order + 1),
            (&mut self.right, order + 1),
            (&mut self.sums, 1),
        ] {
            factors.prepare(self.blocks * BLOCK * orders);
        }
    }

    /// Σ aⱼ bₖ₋ⱼ over 1 ≤ j < k for all products, and the places of their factors of order k.
    #[inline]
    pub(super) fn summed(&mut self, k: usize) -> (&[f64], [&mut [f64]; 2]) {
        let Self { count, blocks, .. } = *self;
        let sums = self.sums.numbers();
        if k == 1 {
            // Nothing is left of the expansion before.
            sums.fill(0.0);
        } else {
            let mut sum = Sum {
                k,
                blocks,
                left: self.left.numbers().as_chunks().0,
                right: self.right.numbers().as_chunks().0,
                sums: sums.as_chunks_mut().0,
            };
            dispatch(
                #[inline(always)]
                || sum.all(),
            );
        }
        let order = k * blocks * BLOCK..;
        let factors = [&mut self.left, &mut self.right];
        let factors = factors.map(|of| &mut of.numbers()[order.clone()][..count]);
        (&self.sums.numbers()[..count], factors)
    }
}

/// Numbers that begin with a line of the cache.
#[derive(Debug, Clone, Default)]
struct Aligned {
    all: Vec<f64>,
    start: usize,
}

impl Aligned {
    /// So many zeros.
    fn prepare(&mut self, count: usize) {
        self.all.clear();
        self.all.resize(count + LINE, 0.0);
        let start = self.all.as_ptr().align_offset(LINE * size_of::<f64>());
        self.start = start.min(LINE);
    }

    #[inline]
    fn numbers(&mut self) -> &mut [f64] {
        &mut self.all[self.start..]
    }
}

struct Sum<'a> {
    k: usize,
    blocks: usize,
    left: &'a [[f64; BLOCK]],
    right: &'a [[f64; BLOCK]],
    sums: &'a mut [[f64; BLOCK]],
}

impl Sum<'_> {
    #[inline(always)]
    fn all(&mut self) {
        let mut start = 0;
        while start < self.blocks {
            let blocks = (self.blocks - start).min(PANEL);
            match blocks {
                1 => self.panel::<1>(start),
                2 => self.panel::<2>(start),
                3 => self.panel::<3>(start),
                4 => self.panel::<4>(start),
                5 => self.panel::<5>(start),
                _ => self.panel::<PANEL>(start),
            }
            start += blocks;
        }
    }

    /// The sums of `N` blocks.
    #[inline(always)]
    fn panel<const N: usize>(&mut self, start: usize) {
        let mut sums = [[0.0_f64; BLOCK]; N];
        let (left, right) = (&self.left[start..], &self.right[start..]);
        for j in 1..self.k {
            let left = &left[j * self.blocks..][..N];
            let right = &right[(self.k - j) * self.blocks..][..N];
            for block in 0..N {
                for lane in 0..BLOCK {
                    sums[block][lane] =
                        left[block][lane].mul_add(right[block][lane], sums[block][lane]);
                }
            }
        }
        self.sums[start..start + N].copy_from_slice(&sums);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_run_over_all_pairs_of_lower_orders() {
        for count in [1, 8, 37, 64] {
            let mut products = Products::default();
            products.prepare(count, 6);
            for k in (1..6).chain(1..6) {
                let (sums, [left, right]) = products.summed(k);
                for (i, (left, right)) in left.iter_mut().zip(right).enumerate() {
                    // aⱼ = i + j, bⱼ = j.
                    let expected: usize = (1..k).map(|j| (i + j) * (k - j)).sum();
                    assert!((sums[i] - expected as f64).abs() < 1e-12, "{count} {k} {i}");
                    *left = (i + k) as f64;
                    *right = k as f64;
                }
            }
        }
    }
}
