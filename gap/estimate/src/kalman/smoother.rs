//! The square-root form of the smoother of Rauch, Tung and Striebel: the state at every row given
//! the whole recording (P. Park and T. Kailath, *New square-root smoothing algorithms*, 1996;
//! Särkkä 2013, section 9.1).
//!
//! The state before a step, given the one after it, is a regression: z + G (z⁺ − ẑ⁺) with a
//! covariance that does not depend on z⁺. One triangularisation of the joint root gives both.

use super::filter::Pass;
use super::square_root::triangularise;
use super::tape::{Record, StepTape};
use crate::EstimateError;
use crate::data::unknown::Unknown;
use crate::estimation::Estimation;
use crate::matrix::{add, multiply};
use crate::motion::timeline::Advance;

/// Pivots of a root below this, relative to their row, are rounding: there is no variance in that
/// direction.
const ROUNDING: f64 = 1e-13;

/// The state at a row given all measurements.
#[derive(Debug, Clone, PartialEq)]
pub struct Smoothed {
    /// Time in s.
    pub t: f64,
    /// Expected state; states of lags and drifting parameters come last.
    pub state: Vec<f64>,
    /// Root S of its covariance S Sᵀ, row by row.
    pub root: Vec<f64>,
}

impl Smoothed {
    /// Covariance of two states.
    pub fn covariance(&self, i: usize, j: usize) -> f64 {
        let n = self.state.len();
        let [a, b] = [i, j].map(|i| &self.root[i * n..(i + 1) * n]);
        crate::matrix::dot(a, b)
    }

    /// Standard deviation of a state.
    pub fn deviation(&self, i: usize) -> f64 {
        self.covariance(i, i).sqrt()
    }
}

impl Estimation<'_> {
    /// The states at all rows of a run, given all of its measurements.
    pub fn smoothed(&self, values: &[f64], run: usize) -> Result<Vec<Smoothed>, EstimateError> {
        self.check(values)?;
        self.layout().place(Unknown::Initial { run, state: 0 })?;
        let mut pass = self.pass(run, values, true, &[])?;
        let mut tape = std::mem::take(&mut pass.tape);
        let mut last = Smoothed {
            t: 0.0,
            state: pass.z.clone(),
            root: pass.root.clone(),
        };
        let mut scratch = pass.system.plant.scratch();
        let mut closure = pass.closure.clone();
        let mut rows = Vec::with_capacity(self.recordings()[run].times().len());
        pass.walk_back(&mut tape, |record, tape| match record {
            Record::Advance { advance, tape: at } => {
                let on = pass.sizes.step(&mut tape[*at..]);
                // Dependent coordinates carry no further information.
                let independent: Vec<usize> = match &mut closure {
                    Some(closure) => {
                        let t = advance.t + advance.h;
                        let place = pass.place(t, on.after, on.held);
                        closure.choose(pass.system.plant, place, &mut scratch);
                        closure.independent().collect()
                    }
                    None => (0..pass.sizes.n).collect(),
                };
                step_back(&pass, *advance, &on, &independent, &mut last);
            }
            Record::Measure { row: Some(row), .. } => {
                last.t = self.recordings()[run].times()[*row];
                rows.push(last.clone());
            }
            Record::Measure { row: None, .. } | Record::Close { .. } | Record::Parts { .. } => {}
        });
        if let Some(closure) = &mut closure {
            for row in &mut rows {
                let (t, open) = (row.t, row.state.clone());
                let place = pass.place(t, &open, &pass.held);
                closure
                    .close(pass.system.plant, place, &mut scratch, &mut row.state)
                    .map_err(|source| EstimateError::Open { run, t, source })?;
                closure.follow(&mut row.root);
            }
        }
        rows.reverse();
        Ok(rows)
    }
}

/// From the smoothed state after a step to the one before it.
fn step_back(
    pass: &Pass<'_>,
    advance: Advance,
    on: &StepTape<'_>,
    independent: &[usize],
    last: &mut Smoothed,
) {
    let (n, d, r) = (pass.sizes.n, pass.sizes.disturbances, independent.len());
    // Roots of state after and state before, jointly: [F S, F N½, N½; S, 0, 0].
    let width = (n + 2 * d).max(r + n);
    let mut sources = vec![0.0; n * (n + d)];
    let mut moved = vec![0.0; n * (n + d)];
    for i in 0..n {
        let row = &mut sources[i * (n + d)..(i + 1) * (n + d)];
        row[..n].copy_from_slice(&on.root[i * n..(i + 1) * n]);
        for j in 0..d {
            let level = pass.values[pass.system.layout.disturbance(j)];
            row[n + j] = level * (0.5 * advance.h).sqrt() * on.columns[i * d + j];
        }
    }
    multiply(on.f, &sources, n, &mut moved);
    let mut joint = vec![0.0; (r + n) * width];
    let (after, before) = joint.split_at_mut(r * width);
    for (row, &i) in after.chunks_exact_mut(width).zip(independent) {
        let (moved, source) = (&moved[i * (n + d)..], &sources[i * (n + d)..]);
        row[..n + d].copy_from_slice(&moved[..n + d]);
        row[n + d..n + 2 * d].copy_from_slice(&source[n..n + d]);
    }
    for (row, source) in before
        .chunks_exact_mut(width)
        .zip(sources.chunks_exact(n + d))
    {
        row[..n].copy_from_slice(&source[..n]);
    }
    let mut roots = vec![0.0; (r + n) * (r + n)];
    triangularise(&mut joint, r + n, &mut roots);
    let root = |i: usize, j: usize| roots[i * (r + n) + j];

    // G L₁₁ = L₂₁, row by row from the last column on.
    let mut gain = vec![0.0; n * r];
    for i in 0..n {
        for j in (0..r).rev() {
            let known: f64 = (j + 1..r).map(|k| gain[i * r + k] * root(k, j)).sum();
            let size = (0..=j).fold(0.0, |size: f64, k| size.max(root(j, k).abs()));
            if root(j, j).abs() > ROUNDING * size {
                gain[i * r + j] = (root(r + i, j) - known) / root(j, j);
            }
        }
    }
    let mut change = vec![0.0; n];
    let off: Vec<f64> = independent
        .iter()
        .map(|&i| last.state[i] - on.after[i])
        .collect();
    multiply(&gain, &off, r, &mut change);
    let rows = independent
        .iter()
        .flat_map(|&i| &last.root[i * n..(i + 1) * n]);
    let rows: Vec<f64> = rows.copied().collect();
    let mut spread = vec![0.0; n * n];
    multiply(&gain, &rows, r, &mut spread);
    let mut wide = vec![0.0; 2 * n * n];
    for (i, wide) in wide.chunks_exact_mut(2 * n).enumerate() {
        for j in 0..n {
            wide[j] = root(r + i, r + j);
            wide[n + j] = spread[i * n + j];
        }
    }
    triangularise(&mut wide, n, &mut last.root);
    last.state.copy_from_slice(&on.stages.z[..n]);
    add(&change, &mut last.state);
}
