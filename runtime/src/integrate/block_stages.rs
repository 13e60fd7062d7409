//! Explicit Runge–Kutta steps of eight motions at once: the arrays they work on.
//!
//! Every sum is formed in the order of [`super::tableau::Stages`], so that a motion has the same bits in
//! a block as alone.

use super::tableau::{Row, Tableau};
use crate::lanes::{LANES, dispatch};

/// One number for each of eight motions.
pub(super) type Block = [f64; LANES];

/// Accumulators of a mean square, as of a motion alone.
const SUMS: usize = 4;

/// States and stage rates of one step of eight motions, allocated once.
#[derive(Debug, Clone, Default)]
pub(super) struct BlockStages {
    /// Number of states.
    n: usize,
    /// States at the start of the step.
    pub(super) x: Vec<Block>,
    /// States at the end of the step.
    pub(super) x_new: Vec<Block>,
    /// States at which a stage is evaluated.
    x_stage: Vec<Block>,
    /// Stage rates one after the other.
    rates: Vec<Block>,
}

impl BlockStages {
    /// Sizes the arrays for `n` states and `stages` stages.
    pub(super) fn prepare(&mut self, n: usize, stages: usize) {
        self.n = n;
        for (blocks, count) in [
            (&mut self.x, n),
            (&mut self.x_new, n),
            (&mut self.x_stage, n),
            (&mut self.rates, stages * n),
        ] {
            blocks.clear();
            blocks.resize(count, [0.0; LANES]);
        }
    }

    /// Rates of a stage.
    pub(super) fn rates(&self, stage: usize) -> &[Block] {
        &self.rates[stage * self.n..][..self.n]
    }

    /// Rates of a stage at the states at the start of the step.
    pub(super) fn evaluate_at_start<F>(&mut self, f: &mut F, stage: usize, t: &Block)
    where
        F: FnMut(&Block, &[Block], &mut [Block]),
    {
        f(t, &self.x, &mut self.rates[stage * self.n..][..self.n]);
    }

    /// Rates of a stage at the states at the end of the step.
    pub(super) fn evaluate_at_end<F>(&mut self, f: &mut F, stage: usize, t: &Block)
    where
        F: FnMut(&Block, &[Block], &mut [Block]),
    {
        f(t, &self.x_new, &mut self.rates[stage * self.n..][..self.n]);
    }

    /// Takes over the rates of one motion in a stage as those of another stage.
    pub(super) fn copy_rates(&mut self, lane: usize, from: usize, to: usize) {
        for i in 0..self.n {
            self.rates[to * self.n + i][lane] = self.rates[from * self.n + i][lane];
        }
    }

    /// Rates of a stage at x + h Σ a k.
    #[inline]
    pub(super) fn evaluate<F>(&mut self, f: &mut F, stage: usize, t: &Block, h: &Block, row: Row)
    where
        F: FnMut(&Block, &[Block], &mut [Block]),
    {
        combine(&self.x, h, row, &self.rates, &mut self.x_stage);
        f(
            t,
            &self.x_stage,
            &mut self.rates[stage * self.n..][..self.n],
        );
    }

    /// All stages after the first, and the new states x + h Σ b k. `time` tells the times of a node.
    #[inline]
    pub(super) fn step<F>(
        &mut self,
        f: &mut F,
        tableau: &Tableau,
        h: &Block,
        time: impl Fn(f64) -> Block,
    ) where
        F: FnMut(&Block, &[Block], &mut [Block]),
    {
        for (i, (&node, &row)) in tableau.nodes.iter().zip(tableau.rows).enumerate() {
            self.evaluate(f, i + 1, &time(node), h, row);
        }
        combine(&self.x, h, tableau.weights, &self.rates, &mut self.x_new);
    }

    /// The new state x + h k₀ of one motion.
    pub(super) fn euler_step(&mut self, lane: usize, h: f64) {
        for i in 0..self.n {
            self.x_new[i][lane] = self.x[i][lane] + h * self.rates[i][lane];
        }
    }

    /// The new state of one motion and its rates become the start of its next step.
    pub(super) fn advance(&mut self, lane: usize, new_rates: usize) {
        for i in 0..self.n {
            self.x[i][lane] = self.x_new[i][lane];
        }
        self.copy_rates(lane, new_rates, 0);
    }

    /// h Σ w k of one motion.
    pub(super) fn combination(&self, lane: usize, h: f64, row: Row, out: &mut [f64]) {
        for (i, out) in out.iter_mut().enumerate() {
            *out = h * self.sum(lane, i, row);
        }
    }

    /// Mean square of Σ w k over `scale`, of all motions.
    pub(super) fn mean_squares(&self, row: Row, scale: &[Block]) -> Block {
        let mut sums = [[0.0; LANES]; SUMS];
        dispatch(
            #[inline(always)]
            || {
                for (i, scale) in scale.iter().enumerate() {
                    let combination = combination(row, &self.rates, self.n, i);
                    let sums = &mut sums[i % SUMS];
                    for lane in 0..LANES {
                        let part = combination[lane] / scale[lane];
                        sums[lane] += part * part;
                    }
                }
            },
        );
        std::array::from_fn(|lane| {
            sums.iter().map(|sum| sum[lane]).sum::<f64>() / self.n.max(1) as f64
        })
    }

    /// The first state of a motion whose rate in a stage is infinite or not a number.
    pub(super) fn rate_not_finite(&self, lane: usize, stage: usize) -> Option<usize> {
        position_not_finite(self.rates(stage), lane)
    }

    /// The first state of a motion that is infinite or not a number at the end of the step.
    pub(super) fn state_not_finite(&self, lane: usize) -> Option<usize> {
        position_not_finite(&self.x_new, lane)
    }

    fn sum(&self, lane: usize, i: usize, row: Row) -> f64 {
        let mut sum = 0.0;
        for &(stage, weight) in row {
            sum += weight * self.rates[stage * self.n + i][lane];
        }
        sum
    }
}

fn position_not_finite(blocks: &[Block], lane: usize) -> Option<usize> {
    blocks.iter().position(|block| !block[lane].is_finite())
}

/// `out` = x + h Σ w k.
fn combine(x: &[Block], h: &Block, row: Row, rates: &[Block], out: &mut [Block]) {
    dispatch(
        #[inline(always)]
        || {
            let n = x.len();
            for (i, (x, out)) in x.iter().zip(&mut *out).enumerate() {
                let sum = combination(row, rates, n, i);
                for lane in 0..LANES {
                    out[lane] = x[lane] + h[lane] * sum[lane];
                }
            }
        },
    );
}

/// Σ w k of a component.
#[inline(always)]
fn combination(row: Row, rates: &[Block], n: usize, i: usize) -> Block {
    let mut sum = [0.0; LANES];
    for &(stage, weight) in row {
        let rate = &rates[stage * n + i];
        for lane in 0..LANES {
            sum[lane] += weight * rate[lane];
        }
    }
    sum
}
