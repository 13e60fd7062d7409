//! Residuals of the equations when the channels of recordings are scaled by factors: the motion is
//! smoothed; the equations are compared with the accelerations, rates and outputs with those that follow from the
//! coordinates.

use appell_estimate::inverse::{Record, Track};
use appell_estimate::smoothing::angle::unwrap;
use appell_recordings::{DataSet, Measured, Part, Role, Run};
use appell_runtime::model::{At, Model};
use nalgebra::{DMatrix, DVector};

/// Largest number of runs, and of rows of each.
const MOST: [usize; 2] = [6, 2500];
/// Relative step of the derivative of q̇ along the motion.
const STEP: f64 = 1e-6;
/// Singular values below this fraction of the largest are zero.
const SINGULAR: f64 = 1e-6;
/// Distance from a declared range, in its width, that is far outside.
const FAR: f64 = 2.0;

/// Measured values and their first two derivatives.
type Derivatives = [DVector<f64>; 3];
/// ω and ω̇, where the measurements determine them.
type Speeds = Option<[DVector<f64>; 2]>;

/// Recordings and equations.
pub(super) struct Balance<'a> {
    pub(super) set: &'a DataSet,
    model: &'a dyn Model,
    p: Vec<f64>,
    /// Measured channels with their quantities.
    measured: Vec<(usize, Measured)>,
    /// The channel of each declared input.
    inputs: Vec<Option<usize>>,
}

/// Sums of magnitudes over a motion: of the residual, and of the measured value.
#[derive(Clone, Copy, Default)]
struct Miss {
    error: f64,
    size: f64,
}

impl Miss {
    fn add(&mut self, measured: f64, expected: f64) {
        self.error += (measured - expected).abs();
        self.size += measured.abs();
    }
}

impl<'a> Balance<'a> {
    pub(super) fn new(set: &'a DataSet, model: &'a dyn Model) -> Self {
        let channels = set.channels.iter().enumerate();
        let measured = channels.filter_map(|(index, channel)| match channel.role {
            Role::Measures(measured) => Some((index, measured)),
            _ => None,
        });
        let input = |input| {
            let is_it = |channel: &appell_recordings::Channel| channel.role == Role::Input(input);
            set.channels.iter().position(is_it)
        };
        Self {
            set,
            model,
            p: set.parameters.iter().map(|own| own.value).collect(),
            measured: measured.collect(),
            inputs: (0..model.info().declared_inputs).map(input).collect(),
        }
    }

    /// Training runs, those of the mechanism as stated where there are any.
    fn runs(&self) -> impl Iterator<Item = &'a Run> {
        let runs = self.set.runs.iter().filter(|run| run.part == Part::Fit);
        let is_as_stated = |run: &Run| run.differences.is_empty();
        let any = runs.clone().any(is_as_stated);
        runs.filter(move |run| !any || is_as_stated(run))
            .take(MOST[0])
    }

    /// The relative residual of each equation, rate and output, where the recordings determine it; above one
    /// where the model predicts more than is measured.
    pub(super) fn missed(&self, factors: &[f64]) -> Vec<Option<f64>> {
        let info = self.model.info();
        let mut misses = vec![Miss::default(); self.varying()];
        let is_told = info.signals.is_empty() && self.p.len() == info.parameter_len();
        if let Some(track) = self.track(factors).filter(|_| is_told) {
            let runs: Vec<&Run> = self.runs().collect();
            for stretch in &track.stretches {
                for motion in &stretch.motions {
                    let half = 0.5 * track.spacing;
                    let u = self.inputs(
                        runs[stretch.run],
                        [motion.t - half, motion.t + half],
                        factors,
                    );
                    self.add(&mut misses, motion.t, &motion.derivatives, &u);
                }
            }
        }
        let missed = |miss: &Miss| Some(miss.error / miss.size).filter(|part| part.is_finite());
        let mut missed: Vec<Option<f64>> = misses.iter().map(missed).collect();
        let measured = self.measured.iter();
        missed.extend(measured.map(|&(index, own)| self.outside(index, own, factors)));
        missed
    }

    /// How many of the statistics of [`missed`](Self::missed) vary continuously with the factor of a channel; the
    /// test of a declared range does not.
    pub(super) fn varying(&self) -> usize {
        self.model.info().speeds + 2 * self.measured.len()
    }

    fn track(&self, factors: &[f64]) -> Option<Track> {
        let records: Vec<Record> = self
            .runs()
            .map(|run| {
                let rows = run.times.len().min(MOST[1]);
                let column = |(index, _): &(usize, Measured)| {
                    let values = run.values[*index][..rows].iter();
                    let mut values: Vec<f64> =
                        values.map(|value| value * factors[*index]).collect();
                    if rescaled(factors[*index]) && self.set.channels[*index].is_angle() {
                        unwrap(&mut values);
                    }
                    bridge(&run.times[..rows], &mut values);
                    DVector::from_vec(values)
                };
                let columns: Vec<DVector<f64>> = self.measured.iter().map(column).collect();
                Record {
                    times: run.times[..rows].to_vec(),
                    values: DMatrix::from_columns(&columns),
                }
            })
            .collect();
        Track::of(&records).ok()
    }

    /// Means of the inputs over an interval of time.
    fn inputs(&self, run: &Run, [from, to]: [f64; 2], factors: &[f64]) -> Vec<f64> {
        let rows = [from, to].map(|end| run.times.partition_point(|t| *t < end));
        let mean = |channel: &Option<usize>| {
            let Some(channel) = *channel else { return 0.0 };
            let values = run.values[channel]
                .get(rows[0]..rows[1])
                .unwrap_or_default();
            let sum: f64 = values.iter().sum();
            factors[channel] * sum / values.len().max(1) as f64
        };
        self.inputs.iter().map(mean).collect()
    }

    /// Rates at a state.
    fn rates(&self, t: f64, q: &[f64], w: &DVector<f64>, u: &[f64]) -> Vec<f64> {
        let x = [w.as_slice(), q].concat();
        let mut rates = vec![0.0; x.len()];
        let p = &self.p;
        self.model.rates(At { t, x: &x, u, p }, &mut rates);
        rates
    }

    /// Measured coordinates: the row of each and its index.
    fn coordinates(&self) -> Vec<(usize, usize)> {
        let rows = self.measured.iter().enumerate();
        rows.filter_map(|(row, (_, measured))| match measured {
            Measured::Coordinate(i) => Some((row, *i)),
            _ => None,
        })
        .collect()
    }

    /// ω and ω̇ from q̇ = T ω + τ and its derivative, in the rows of measured coordinates.
    fn by_coordinates(&self, t: f64, q: &[f64], u: &[f64], derivatives: &Derivatives) -> Speeds {
        let speeds = self.model.info().speeds;
        let coordinates = self.coordinates();
        if speeds == 0 || coordinates.len() < speeds {
            return None;
        }
        let of = |value: &dyn Fn(&(usize, usize)) -> f64| {
            DVector::from_iterator(coordinates.len(), coordinates.iter().map(value))
        };
        let q_dot = |q: &[f64], w: &DVector<f64>| {
            let rates = self.rates(t, q, w, u);
            of(&|(_, i)| rates[speeds + i])
        };
        let tau = q_dot(q, &DVector::zeros(speeds));
        let columns: Vec<DVector<f64>> = (0..speeds)
            .map(|j| {
                let unit = DVector::from_fn(speeds, |i, _| f64::from(u8::from(i == j)));
                q_dot(q, &unit) - &tau
            })
            .collect();
        let svd = DMatrix::from_columns(&columns).svd(true, true);
        let sizes = &svd.singular_values;
        let is_finite = sizes.iter().all(|size| size.is_finite());
        if !is_finite || sizes.min() <= SINGULAR * sizes.max() {
            return None;
        }
        let solve = |order: usize, less: &DVector<f64>| {
            let known = of(&|(row, _)| derivatives[order][*row]) - less;
            svd.solve(&known, 0.0).ok()
        };
        let w = solve(1, &tau)?;
        // d/dt (T ω + τ) with ω held.
        let flow = self.rates(t, q, &w, u).split_off(speeds);
        let size = flow
            .iter()
            .fold(1.0, |most: f64, rate| most.max(rate.abs()));
        let along = |side: f64| {
            let moved = q.iter().zip(&flow);
            let moved: Vec<f64> = moved
                .map(|(q, rate)| q + side * STEP * rate / size)
                .collect();
            q_dot(&moved, &w)
        };
        let carried = (along(1.0) - along(-1.0)) * (size / (2.0 * STEP));
        let w_dot = solve(2, &carried)?;
        Some([w, w_dot])
    }

    /// ω and ω̇ where all pseudo-velocities are measured.
    fn as_measured(&self, derivatives: &Derivatives) -> Speeds {
        let own = (0..self.model.info().speeds).map(|j| {
            let mut measured = self.measured.iter();
            measured.position(|(_, own)| *own == Measured::PseudoVelocity(j))
        });
        let own: Vec<usize> = own.collect::<Option<_>>()?;
        let read = |order: usize| {
            let values = own.iter().map(|row| derivatives[order][*row]);
            DVector::from_iterator(own.len(), values)
        };
        Some([read(0), read(1)])
    }

    /// Adds the residuals of a motion.
    fn add(&self, misses: &mut [Miss], t: f64, derivatives: &Derivatives, u: &[f64]) {
        let info = self.model.info();
        let speeds = info.speeds;
        let mut q = info.initial_state().split_off(speeds);
        for (row, i) in self.coordinates() {
            q[i] = derivatives[0][row];
        }
        let by_coordinates = self.by_coordinates(t, &q, u, derivatives);
        let is_told = by_coordinates.is_some();
        let Some([w, w_dot]) = by_coordinates.or_else(|| self.as_measured(derivatives)) else {
            return;
        };
        let expected = self.rates(t, &q, &w, u);
        let x = [w.as_slice(), &q].concat();
        let mut outputs = vec![0.0; info.output_len()];
        let p = &self.p;
        self.model.outputs(At { t, x: &x, u, p }, &mut outputs);
        let mut all = expected.iter().chain(&outputs).chain(&w_dot);
        if all.any(|value| !value.is_finite()) {
            return;
        }
        for i in 0..speeds {
            misses[i].add(w_dot[i], expected[i]);
        }
        let (of_values, of_rates) = (speeds, speeds + self.measured.len());
        for (row, (_, measured)) in self.measured.iter().enumerate() {
            let value = derivatives[0][row];
            match measured {
                Measured::PseudoVelocity(i) if is_told => misses[of_values + row].add(value, w[*i]),
                Measured::Output(i) => misses[of_values + row].add(value, outputs[*i]),
                // More coordinates than speeds: constraints tie their rates.
                Measured::Coordinate(i) if is_told && self.coordinates().len() > speeds => {
                    misses[of_rates + row].add(derivatives[1][row], expected[speeds + i]);
                }
                _ => {}
            }
        }
    }

    /// Whether a coordinate is far outside its declared range, on the scale of relative residuals.
    fn outside(&self, index: usize, measured: Measured, factors: &[f64]) -> Option<f64> {
        let Measured::Coordinate(i) = measured else {
            return None;
        };
        let [low, high] = self.model.info().coordinate_quantities()[i].range;
        let width = high - low;
        if !width.is_finite() {
            return None;
        }
        let values = || self.runs().flat_map(|run| &run.values[index]);
        let distance = |value: &f64| {
            let value = value * factors[index];
            (low - value).max(value - high)
        };
        let farthest = values().map(distance).fold(0.0, f64::max);
        Some(if farthest > FAR * width {
            FAR
        } else if farthest > 0.0 {
            0.5
        } else {
            0.0
        })
    }
}

/// Whether a channel is read in another unit than its own.
fn rescaled(factor: f64) -> bool {
    (factor - 1.0).abs() > f64::EPSILON
}

/// Fills missing values by linear interpolation.
fn bridge(times: &[f64], values: &mut [f64]) {
    let present: Vec<usize> = (0..values.len())
        .filter(|row| values[*row].is_finite())
        .collect();
    let (Some(&first), Some(&last)) = (present.first(), present.last()) else {
        return;
    };
    let ends = [values[first], values[last]];
    values[..first].fill(ends[0]);
    values[last..].fill(ends[1]);
    for pair in present.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        let slope = (values[b] - values[a]) / (times[b] - times[a]);
        for row in a + 1..b {
            values[row] = values[a] + slope * (times[row] - times[a]);
        }
    }
}
