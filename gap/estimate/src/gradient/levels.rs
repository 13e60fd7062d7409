//! Fisher information of levels of disturbances and noise along a recording, by one pass of the filter.
//!
//! They change covariances: dP⁺ = F (dP + dN) Fᵀ + dN over a step; at a scalar with a = P c, s = cᵀ P c + r
//! and residual e, da = dP c and ds = cᵀ da + dr give dP⁺ = dP − d(a aᵀ/s), dz⁺ = dz + d(a e/s). The motion about
//! which F and c are linearised is held: its changes multiply innovations, which have zero mean.

use nalgebra::DMatrix;

use crate::EstimateError;
use crate::data::unknown::Unknown;
use crate::estimation::Estimation;
use crate::kalman::filter::Pass;
use crate::kalman::tape::{Record, SampleTape};
use crate::matrix::{add_scaled, multiply};
use crate::motion::timeline::{Action, Advance};

/// Fisher information of some levels, in SI, from the innovations of a recording; none counts as larger than `largest`
/// standard deviations.
pub(crate) fn information(
    estimation: &Estimation<'_>,
    run: usize,
    values: &[f64],
    levels: &[Unknown],
    largest: f64,
) -> Result<DMatrix<f64>, EstimateError> {
    let count = levels.len();
    let actions = estimation.actions(run, values);
    let pass = estimation.fresh(run, values, &actions, None, &[]);
    let n = pass.sizes.n;
    let zeros = |len| vec![0.0; len];
    let mut forward = Forward {
        z: zeros(n * count),
        p: zeros(n * n * count),
        moved: zeros(n * n * count),
        by_a: zeros(n * count),
        by_s: zeros(count),
        by_e: zeros(count),
        information: zeros(count * count),
        largest,
        levels,
        pass,
    };
    forward.start();
    for &action in &actions {
        forward.act(&estimation.recordings()[run], action)?;
    }
    Ok(DMatrix::from_row_slice(count, count, &forward.information))
}

/// Derivatives along a run; each entry has a lane for each level.
struct Forward<'p> {
    pass: Pass<'p>,
    levels: &'p [Unknown],
    /// Of the state, n rows.
    z: Vec<f64>,
    /// Of P, n × n.
    p: Vec<f64>,
    moved: Vec<f64>,
    /// Of P c, n rows, and of the variance and residual of a scalar.
    by_a: Vec<f64>,
    by_s: Vec<f64>,
    by_e: Vec<f64>,
    information: Vec<f64>,
    /// Largest residual, in standard deviations.
    largest: f64,
}

impl Forward<'_> {
    /// Spreads of the initial state.
    fn start(&mut self) {
        let (n, lanes) = (self.pass.sizes.n, self.levels.len());
        for (lane, level) in self.levels.iter().enumerate() {
            if let Unknown::Spread { run, state } = *level
                && run == self.pass.run
            {
                let place = self.pass.system.layout.spread(run) + state;
                self.p[state * (n + 1) * lanes + lane] = 2.0 * self.pass.values[place];
            }
        }
    }

    fn act(&mut self, recording: &crate::Recording, action: Action) -> Result<(), EstimateError> {
        let (records, samples) = (self.pass.records.len(), self.pass.samples.len());
        self.pass.act(recording, action)?;
        for record in records..self.pass.records.len() {
            if let Record::Advance { advance, tape } = self.pass.records[record] {
                self.advance(advance, tape);
            }
        }
        for sample in samples..self.pass.samples.len() {
            self.measure(sample);
        }
        self.close();
        Ok(())
    }

    /// Projects onto the dependent coordinates.
    fn close(&mut self) {
        let Some(closure) = &self.pass.closure else {
            return;
        };
        let (n, lanes) = (self.pass.sizes.n, self.levels.len());
        closure.follow(&mut self.z);
        for _ in 0..2 {
            closure.follow(&mut self.p);
            for i in 0..n {
                for j in 0..n {
                    let from = &self.p[(i * n + j) * lanes..][..lanes];
                    self.moved[(j * n + i) * lanes..][..lanes].copy_from_slice(from);
                }
            }
            std::mem::swap(&mut self.p, &mut self.moved);
        }
    }

    fn advance(&mut self, advance: Advance, tape: usize) {
        let (n, lanes) = (self.pass.sizes.n, self.levels.len());
        self.disturb(advance.h, tape);
        let on = self.pass.sizes.step(&mut self.pass.tape[tape..]);
        multiply(on.f, &self.z, n, &mut self.by_a);
        std::mem::swap(&mut self.z, &mut self.by_a);
        multiply(on.f, &self.p, n, &mut self.moved);
        for i in 0..n {
            let row = &self.moved[i * n * lanes..(i + 1) * n * lanes];
            for k in 0..=i {
                let entry = &mut self.p[(i * n + k) * lanes..][..lanes];
                entry.fill(0.0);
                for (&f, moved) in on.f[k * n..].iter().zip(row.chunks_exact(lanes)) {
                    if f != 0.0 {
                        add_scaled(f, moved, entry);
                    }
                }
            }
        }
        mirror(&mut self.p, n, lanes);
        self.disturb(advance.h, tape);
    }

    /// Adds the derivative of half of the noise of a step of length `h`.
    fn disturb(&mut self, h: f64, tape: usize) {
        let (n, d, lanes) = (
            self.pass.sizes.n,
            self.pass.sizes.disturbances,
            self.levels.len(),
        );
        let on = self.pass.sizes.step(&mut self.pass.tape[tape..]);
        for (lane, level) in self.levels.iter().enumerate() {
            let Unknown::Disturbance(j) = *level else {
                continue;
            };
            let size = h * self.pass.values[self.pass.system.layout.disturbance(j)];
            for i in 0..n {
                let along = size * on.columns[i * d + j];
                for k in 0..n {
                    self.p[(i * n + k) * lanes + lane] += along * on.columns[k * d + j];
                }
            }
        }
    }

    fn measure(&mut self, index: usize) {
        let (n, lanes) = (self.pass.sizes.n, self.levels.len());
        let sample = self.pass.samples[index];
        let (channel, s) = (sample.innovation.channel, sample.innovation.white_variance);
        let most = self.largest * s.sqrt();
        let e = sample.innovation.white_residual.clamp(-most, most);
        let SampleTape { c, a, .. } = self.pass.sizes.sample(&mut self.pass.tape[sample.tape..]);
        self.by_a.fill(0.0);
        self.by_s.fill(0.0);
        self.by_e.fill(0.0);
        for (k, &slope) in c.iter().enumerate().filter(|(_, slope)| **slope != 0.0) {
            let row = &self.p[k * n * lanes..(k + 1) * n * lanes];
            add_scaled(slope, row, &mut self.by_a);
            add_scaled(-slope, &self.z[k * lanes..(k + 1) * lanes], &mut self.by_e);
        }
        for (&slope, by_a) in c.iter().zip(self.by_a.chunks_exact(lanes)) {
            add_scaled(slope, by_a, &mut self.by_s);
        }
        if let Some(lane) = (self.levels.iter()).position(|level| *level == Unknown::Noise(channel))
        {
            self.by_s[lane] += 2.0 * self.pass.values[self.pass.system.layout.noise(channel)];
        }
        for (l, row) in self.information.chunks_exact_mut(lanes).enumerate() {
            add_scaled(self.by_e[l] / s, &self.by_e, row);
            add_scaled(0.5 * self.by_s[l] / (s * s), &self.by_s, row);
        }
        let rows = self.by_a.chunks_exact_mut(lanes).zip(a.iter());
        for ((by_a, &a), z) in rows.zip(self.z.chunks_exact_mut(lanes)) {
            add_scaled(e / s, by_a, z);
            add_scaled(-a * e / (s * s), &self.by_s, z);
            add_scaled(a / s, &self.by_e, z);
            // Half of the change of a aᵀ/s is this times aᵀ.
            for (by_a, by_s) in by_a.iter_mut().zip(&self.by_s) {
                *by_a = (*by_a - 0.5 * a * by_s / s) / s;
            }
        }
        for i in 0..n {
            let own = &self.by_a[i * lanes..(i + 1) * lanes];
            for k in 0..=i {
                let other = &self.by_a[k * lanes..(k + 1) * lanes];
                let entry = &mut self.p[(i * n + k) * lanes..][..lanes];
                for ((entry, own), other) in entry.iter_mut().zip(own).zip(other) {
                    *entry -= a[k] * own + a[i] * other;
                }
            }
        }
        mirror(&mut self.p, n, lanes);
    }
}

/// Copies the entries below the diagonal above it.
fn mirror(matrix: &mut [f64], n: usize, lanes: usize) {
    for i in 0..n {
        for k in 0..i {
            let below = (i * n + k) * lanes;
            matrix.copy_within(below..below + lanes, (k * n + i) * lanes);
        }
    }
}
