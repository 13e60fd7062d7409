//! Explicit Runge–Kutta steps of one motion, or of eight at once: the arrays they work on.
//!
//! Sums use vectorised fused multiply-adds; without hardware support they are slower, with the same bits. Their order does
//! not depend on the number of motions, so that a motion in a block agrees bit for bit with one integrated alone.

// Only inlined functions are compiled for the vector instructions of the processor.
#![allow(clippy::inline_always)]

use super::dense_output::Ends;
use super::options::Options;
use super::tableau::{Row, Tableau};
use crate::lanes::{LANES, dispatch};

/// One number for each motion of a block.
pub(super) type Block<const L: usize> = [f64; L];

/// Evaluation points of the motions of a block, one in each lane: state i of the motion in lane l is `x[i][l]`.
#[derive(Debug, Clone, Copy)]
pub struct Places<'a, const L: usize = LANES> {
    /// Times in s.
    pub t: &'a [f64; L],
    /// States.
    pub x: &'a [[f64; L]],
    /// Parameters.
    pub p: &'a [[f64; L]],
}

/// Number of accumulators of a mean square.
const SUMS: usize = 4;

/// States and stage rates of one step of the motions of a block, allocated once.
#[derive(Debug, Clone, Default)]
pub(super) struct BlockStages<const L: usize> {
    /// Number of states.
    n: usize,
    /// Parameters.
    p: Vec<Block<L>>,
    /// States at the start of the step.
    pub(super) x: Vec<Block<L>>,
    /// States at the end of the step.
    pub(super) x_new: Vec<Block<L>>,
    /// States at which a stage is evaluated.
    x_stage: Vec<Block<L>>,
    /// Stage rates one after the other.
    rates: Vec<Block<L>>,
    /// The error scales.
    scale: Vec<Block<L>>,
}

impl<const L: usize> BlockStages<L> {
    /// Sizes the arrays for `n` states and `stages` stages.
    pub(super) fn prepare(&mut self, n: usize, stages: usize) {
        self.n = n;
        for (blocks, count) in [
            (&mut self.x, n),
            (&mut self.x_new, n),
            (&mut self.x_stage, n),
            (&mut self.scale, n),
            (&mut self.rates, stages * n),
        ] {
            blocks.clear();
            blocks.resize(count, [0.0; L]);
        }
        self.p.clear();
    }

    /// Rates of a stage.
    pub(super) fn rates(&self, stage: usize) -> &[Block<L>] {
        &self.rates[stage * self.n..][..self.n]
    }

    /// Rates of a stage at the states at the start of the step.
    pub(super) fn evaluate_at_start<F>(&mut self, f: &mut F, stage: usize, t: &Block<L>)
    where
        F: FnMut(Places<'_, L>, &mut [Block<L>]),
    {
        let (x, p) = (&self.x, &self.p);
        f(
            Places { t, x, p },
            &mut self.rates[stage * self.n..][..self.n],
        );
    }

    /// Rates of a stage at the states at the end of the step.
    pub(super) fn evaluate_at_end<F>(&mut self, f: &mut F, stage: usize, t: &Block<L>)
    where
        F: FnMut(Places<'_, L>, &mut [Block<L>]),
    {
        let (x, p) = (&self.x_new, &self.p);
        f(
            Places { t, x, p },
            &mut self.rates[stage * self.n..][..self.n],
        );
    }

    /// Copies the rates of one motion from one stage to another.
    pub(super) fn copy_rates(&mut self, lane: usize, from: usize, to: usize) {
        for i in 0..self.n {
            self.rates[to * self.n + i][lane] = self.rates[from * self.n + i][lane];
        }
    }

    /// Rates of a stage at x + h Σ a k.
    #[inline]
    pub(super) fn evaluate<F>(
        &mut self,
        f: &mut F,
        stage: usize,
        t: &Block<L>,
        h: &Block<L>,
        row: Row,
    ) where
        F: FnMut(Places<'_, L>, &mut [Block<L>]),
    {
        combine(&self.x, h, row, &self.rates, &mut self.x_stage);
        let (x, p) = (&self.x_stage, &self.p);
        f(
            Places { t, x, p },
            &mut self.rates[stage * self.n..][..self.n],
        );
    }

    /// All stages after the first, and the new states x + h Σ b k. `time` returns the times of a node.
    #[inline]
    pub(super) fn step<F>(
        &mut self,
        f: &mut F,
        tableau: &Tableau,
        h: &Block<L>,
        time: impl Fn(f64) -> Block<L>,
    ) where
        F: FnMut(Places<'_, L>, &mut [Block<L>]),
    {
        for (i, (&node, &row)) in tableau.nodes.iter().zip(tableau.rows).enumerate() {
            self.evaluate(f, i + 1, &time(node), h, row);
        }
        combine(&self.x, h, tableau.weights, &self.rates, &mut self.x_new);
    }

    /// The new state x + h k₀ of one motion.
    pub(super) fn euler_step(&mut self, lane: usize, h: f64) {
        for i in 0..self.n {
            self.x_new[i][lane] = h.mul_add(self.rates[i][lane], self.x[i][lane]);
        }
    }

    /// The new states of the selected motions and their rates become the start of their next steps.
    pub(super) fn advance(&mut self, which: [bool; L], new_rates: usize) {
        let (rates, new_rates) = self.rates.split_at_mut(new_rates * self.n);
        for (old, new) in [(&mut self.x[..], &self.x_new[..]), (rates, new_rates)] {
            for (old, new) in old.iter_mut().zip(new).take(self.n) {
                for lane in 0..L {
                    old[lane] = if which[lane] { new[lane] } else { old[lane] };
                }
            }
        }
    }

    /// h Σ w k of one motion.
    pub(super) fn combination(&self, lane: usize, h: f64, row: Row, out: &mut [f64]) {
        dispatch(
            #[inline(always)]
            || {
                for (i, out) in out.iter_mut().enumerate() {
                    *out = h * self.sum(lane, i, row);
                }
            },
        );
    }

    /// Sets the initial state and parameters of a lane.
    pub(super) fn begin(&mut self, lane: usize, x: &[f64], p: &[f64]) {
        self.p.resize(p.len(), [0.0; L]);
        let blocks = self.x.iter_mut().chain(&mut self.p);
        for (block, number) in blocks.zip(x.iter().chain(p)) {
            block[lane] = *number;
        }
    }

    /// Copies parameters, state and rates to another lane.
    pub(super) fn copy(&mut self, from: usize, to: usize) {
        let blocks = self.x.iter_mut().chain(&mut self.rates[..self.n]);
        for block in blocks.chain(&mut self.p) {
            block[to] = block[from];
        }
    }

    /// Sets the error scales from the states at both ends; returns which new states are finite.
    pub(super) fn scale_by(&mut self, options: &Options) -> [bool; L] {
        let mut finite = [true; L];
        dispatch(
            #[inline(always)]
            || {
                // Zero unless an entry is infinite or NaN.
                let mut zero = [0.0; L];
                let ends = self.x.iter().zip(&self.x_new);
                for (scale, (x, x_new)) in self.scale.iter_mut().zip(ends) {
                    for lane in 0..L {
                        zero[lane] += x_new[lane] * 0.0;
                        scale[lane] = options.scale(x[lane].abs().max(x_new[lane].abs()));
                    }
                }
                for (finite, zero) in finite.iter_mut().zip(zero) {
                    *finite = zero == 0.0;
                }
            },
        );
        finite
    }

    /// Mean square of Σ w k over the error scales, of all motions.
    pub(super) fn mean_squares(&self, row: Row) -> Block<L> {
        let mut squares = [0.0; L];
        dispatch(
            #[inline(always)]
            || squares = self.squares(row),
        );
        let count = self.n.max(1) as f64;
        for square in &mut squares {
            *square /= count;
        }
        squares
    }

    #[inline(always)]
    fn squares(&self, row: Row) -> Block<L> {
        let mut sums = [[0.0; L]; SUMS];
        let (panels, rest) = self.scale.as_chunks::<SUMS>();
        for (panel, scale) in panels.iter().enumerate() {
            let combinations = combinations::<SUMS, L>(row, &self.rates, self.n, panel * SUMS);
            for (sums, (combination, scale)) in sums.iter_mut().zip(combinations.iter().zip(scale))
            {
                add_squares(sums, combination, scale);
            }
        }
        let first = panels.len() * SUMS;
        for (i, (sums, scale)) in sums.iter_mut().zip(rest).enumerate() {
            let [combination] = combinations::<1, L>(row, &self.rates, self.n, first + i);
            add_squares(sums, &combination, scale);
        }
        let mut all = [0.0; L];
        for sums in &sums {
            for lane in 0..L {
                all[lane] += sums[lane];
            }
        }
        all
    }

    /// The first state of a motion whose rate in a stage is infinite or not a number.
    pub(super) fn rate_not_finite(&self, lane: usize, stage: usize) -> Option<usize> {
        position_not_finite(self.rates(stage), lane)
    }

    /// The first state of a motion that is infinite or not a number at the end of the step.
    pub(super) fn state_not_finite(&self, lane: usize) -> Option<usize> {
        position_not_finite(&self.x_new, lane)
    }

    #[inline(always)]
    fn sum(&self, lane: usize, i: usize, row: Row) -> f64 {
        let mut sum = 0.0;
        for &(stage, weight) in row {
            sum = weight.mul_add(self.rates[stage * self.n + i][lane], sum);
        }
        sum
    }
}

/// One motion.
impl BlockStages<1> {
    /// State at the end of the step, to be projected.
    pub(super) fn new_state_mut(&mut self) -> &mut [f64] {
        self.x_new.as_flattened_mut()
    }

    /// Both ends of a step whose new rates are known.
    pub(super) fn ends(&self, t: [f64; 2], new_rates: usize) -> Ends<'_> {
        Ends {
            t,
            x: [self.x.as_flattened(), self.x_new.as_flattened()],
            rates: [0, new_rates].map(|stage| self.rates(stage).as_flattened()),
        }
    }
}

fn position_not_finite<const L: usize>(blocks: &[Block<L>], lane: usize) -> Option<usize> {
    blocks.iter().position(|block| !block[lane].is_finite())
}

#[inline(always)]
fn add_squares<const L: usize>(sums: &mut Block<L>, combination: &Block<L>, scale: &Block<L>) {
    for lane in 0..L {
        let part = combination[lane] / scale[lane];
        sums[lane] = part.mul_add(part, sums[lane]);
    }
}

/// Components that are summed in parallel, to hide the latency of the additions.
const PANEL: usize = 4;

/// `out` = x + h Σ w k.
fn combine<const L: usize>(
    x: &[Block<L>],
    h: &Block<L>,
    row: Row,
    rates: &[Block<L>],
    out: &mut [Block<L>],
) {
    dispatch(
        #[inline(always)]
        || {
            let n = x.len();
            let (panels, rest) = x.as_chunks::<PANEL>();
            let (out_panels, out_rest) = out.as_chunks_mut::<PANEL>();
            for (panel, (x, out)) in panels.iter().zip(out_panels).enumerate() {
                let sums = combinations::<PANEL, L>(row, rates, n, panel * PANEL);
                for i in 0..PANEL {
                    out[i] = moved(&x[i], h, &sums[i]);
                }
            }
            for (i, (x, out)) in rest.iter().zip(out_rest).enumerate() {
                let [sum] = combinations::<1, L>(row, rates, n, panels.len() * PANEL + i);
                *out = moved(x, h, &sum);
            }
        },
    );
}

/// x + h k
#[inline(always)]
fn moved<const L: usize>(x: &Block<L>, h: &Block<L>, k: &Block<L>) -> Block<L> {
    let mut moved = [0.0; L];
    for lane in 0..L {
        moved[lane] = h[lane].mul_add(k[lane], x[lane]);
    }
    moved
}

/// Σ w k of some components.
#[inline(always)]
fn combinations<const N: usize, const L: usize>(
    row: Row,
    rates: &[Block<L>],
    n: usize,
    first: usize,
) -> [Block<L>; N] {
    let mut sums = [[0.0; L]; N];
    for &(stage, weight) in row {
        let rates = &rates[stage * n + first..][..N];
        for (sum, rate) in sums.iter_mut().zip(rates) {
            for lane in 0..L {
                sum[lane] = weight.mul_add(rate[lane], sum[lane]);
            }
        }
    }
    sums
}
