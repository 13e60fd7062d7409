//! Explicit Runge–Kutta steps given by a tableau, and their work arrays.
//!
//! Sums use vectorised fused multiply-adds; without hardware support they are slower, with the same bits.

// Only inlined functions are compiled for the vector instructions of the processor.
#![allow(clippy::inline_always)]

use super::dense_output::Ends;
use crate::lanes::dispatch;

/// Pairs of a stage and its weight; stages that are not listed have weight zero.
pub type Row = &'static [(usize, f64)];

/// A Butcher tableau without the embedded solutions. Stages count from 0.
pub(super) struct Tableau {
    /// Nodes c of stages 1, 2, …
    pub(super) nodes: &'static [f64],
    /// Rows a of stages 1, 2, …
    pub(super) rows: &'static [Row],
    /// Weights b of the new state.
    pub(super) weights: Row,
}

impl Tableau {
    /// Index of the stage that holds the rates at the new state.
    pub(super) const fn new_rates(&self) -> usize {
        self.rows.len() + 1
    }
}

/// Width of the blocks in which linear combinations are summed.
const BLOCK: usize = 4;

/// States and stage rates of one step, allocated once.
///
/// Every vector is padded with zeros to whole blocks, so that sums run over blocks of a fixed
/// width, which the compiler keeps in vector registers.
#[derive(Debug, Clone, Default)]
pub(super) struct Stages {
    /// Number of states.
    n: usize,
    /// Number of states rounded up to whole blocks.
    stride: usize,
    /// State at the start of the step.
    x: Vec<f64>,
    /// State at the end of the step.
    x_new: Vec<f64>,
    /// State at which a stage is evaluated.
    x_stage: Vec<f64>,
    /// Stage rates one after the other.
    rates: Vec<f64>,
}

impl Stages {
    /// Allocates the arrays for `n` states and `stages` stages and copies the initial state.
    pub(super) fn prepare(&mut self, x: &[f64], stages: usize) {
        self.n = x.len();
        self.stride = self.n.next_multiple_of(BLOCK);
        for (vector, count) in [
            (&mut self.x, 1),
            (&mut self.x_new, 1),
            (&mut self.x_stage, 1),
            (&mut self.rates, stages),
        ] {
            vector.clear();
            vector.resize(count * self.stride, 0.0);
        }
        self.x[..self.n].copy_from_slice(x);
    }

    /// State at the start of the step.
    pub(super) fn x(&self) -> &[f64] {
        &self.x[..self.n]
    }

    /// State at the end of the step, to be projected.
    pub(super) fn x_new_mut(&mut self) -> &mut [f64] {
        &mut self.x_new[..self.n]
    }

    /// State at the end of the step.
    pub(super) fn x_new(&self) -> &[f64] {
        &self.x_new[..self.n]
    }

    /// Rates of a stage.
    pub(super) fn rates(&self, stage: usize) -> &[f64] {
        &self.rates[stage * self.stride..][..self.n]
    }

    /// Rates of a stage at the state at the start of the step.
    pub(super) fn evaluate_at_start<F>(&mut self, f: &mut F, stage: usize, t: f64)
    where
        F: FnMut(f64, &[f64], &mut [f64]),
    {
        let rates = &mut self.rates[stage * self.stride..][..self.n];
        f(t, &self.x[..self.n], rates);
    }

    /// Rates of a stage at the state at the end of the step.
    pub(super) fn evaluate_at_end<F>(&mut self, f: &mut F, stage: usize, t: f64)
    where
        F: FnMut(f64, &[f64], &mut [f64]),
    {
        let rates = &mut self.rates[stage * self.stride..][..self.n];
        f(t, &self.x_new[..self.n], rates);
    }

    /// Rates of a stage at x + h Σ a k.
    #[inline]
    pub(super) fn evaluate<F>(&mut self, f: &mut F, stage: usize, t: f64, h: f64, row: Row)
    where
        F: FnMut(f64, &[f64], &mut [f64]),
    {
        combine(&self.x, h, row, &self.rates, self.stride, &mut self.x_stage);
        let rates = &mut self.rates[stage * self.stride..][..self.n];
        f(t, &self.x_stage[..self.n], rates);
    }

    /// All stages after the first, and the new state x + h Σ b k.
    #[inline]
    pub(super) fn step<F>(&mut self, f: &mut F, tableau: &Tableau, t: f64, h: f64)
    where
        F: FnMut(f64, &[f64], &mut [f64]),
    {
        for (i, (&node, &row)) in tableau.nodes.iter().zip(tableau.rows).enumerate() {
            self.evaluate(f, i + 1, t + node * h, h, row);
        }
        combine(
            &self.x,
            h,
            tableau.weights,
            &self.rates,
            self.stride,
            &mut self.x_new,
        );
    }

    /// The new state x + h k₀, for the choice of the first step.
    pub(super) fn euler_step(&mut self, h: f64) {
        combine(
            &self.x,
            h,
            &[(0, 1.0)],
            &self.rates,
            self.stride,
            &mut self.x_new,
        );
    }

    /// The new state and its rates become the start of the next step.
    pub(super) fn advance(&mut self, new_rates: usize) {
        self.x.copy_from_slice(&self.x_new);
        let start = new_rates * self.stride;
        self.rates.copy_within(start..start + self.stride, 0);
    }

    /// `out` = h Σ w k, one number per state.
    pub(super) fn combination(&self, h: f64, row: Row, out: &mut [f64]) {
        dispatch(
            #[inline(always)]
            || {
                for (block, out) in out.chunks_mut(BLOCK).enumerate() {
                    let sum = block_combination(row, &self.rates, self.stride, block * BLOCK);
                    for (out, sum) in out.iter_mut().zip(sum) {
                        *out = h * sum;
                    }
                }
            },
        );
    }

    /// Mean square of Σ w k over `scale`.
    #[inline]
    pub(super) fn mean_square(&self, row: Row, scale: &[f64]) -> f64 {
        let mut sums = [0.0_f64; BLOCK];
        dispatch(
            #[inline(always)]
            || {
                for start in (0..self.stride).step_by(BLOCK) {
                    let combination = block_combination(row, &self.rates, self.stride, start);
                    for lane in 0..BLOCK {
                        if let Some(scale) = scale.get(start + lane) {
                            let part = combination[lane] / scale;
                            sums[lane] = part.mul_add(part, sums[lane]);
                        }
                    }
                }
            },
        );
        sums.iter().sum::<f64>() / self.n.max(1) as f64
    }

    /// Both ends of a step whose new rates are known.
    pub(super) fn ends(&self, t: [f64; 2], new_rates: usize) -> Ends<'_> {
        Ends {
            t,
            x: [self.x(), self.x_new()],
            rates: [self.rates(0), self.rates(new_rates)],
        }
    }

    /// The first state whose rate in a stage is infinite or not a number.
    pub(super) fn rate_not_finite(&self, stage: usize) -> Option<usize> {
        position_not_finite(self.rates(stage))
    }

    /// The first state that is infinite or not a number at the end of the step.
    pub(super) fn state_not_finite(&self) -> Option<usize> {
        position_not_finite(self.x_new())
    }
}

fn position_not_finite(values: &[f64]) -> Option<usize> {
    values.iter().position(|value| !value.is_finite())
}

/// `out` = x + h Σ w k for whole vectors.
fn combine(x: &[f64], h: f64, row: Row, rates: &[f64], stride: usize, out: &mut [f64]) {
    dispatch(
        #[inline(always)]
        || {
            for start in (0..stride).step_by(BLOCK) {
                let sum = block_combination(row, rates, stride, start);
                let (x, out) = (&x[start..][..BLOCK], &mut out[start..][..BLOCK]);
                for lane in 0..BLOCK {
                    out[lane] = h.mul_add(sum[lane], x[lane]);
                }
            }
        },
    );
}

/// Σ w k for the block of components that begins at `start`.
#[inline(always)]
fn block_combination(row: Row, rates: &[f64], stride: usize, start: usize) -> [f64; BLOCK] {
    let mut sum = [0.0; BLOCK];
    for &(stage, weight) in row {
        let rates = &rates[stage * stride + start..][..BLOCK];
        for lane in 0..BLOCK {
            sum[lane] = weight.mul_add(rates[lane], sum[lane]);
        }
    }
    sum
}
