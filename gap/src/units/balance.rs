//! How far recordings miss the equations when their channels are read with factors: the motion is
//! smoothed, and each equation is balanced with the accelerations, each rate and output with what the
//! coordinates say.

use std::ops::Range;

use appell_estimate::inverse::{Record, Track};
use appell_estimate::smoothing::angle::unwrap;
use appell_recordings::{DataSet, Measured, Part, Role, Run};
use appell_runtime::model::{At, Model};
use nalgebra::{DMatrix, DVector};

/// Runs and rows of each that are looked at.
const MOST: [usize; 2] = [6, 2500];
/// Relative step of the derivative of q̇ along the motion.
const STEP: f64 = 1e-6;
/// Singular values below this fraction of the largest are zero.
const SINGULAR: f64 = 1e-6;
/// Distance from a declared range, in its width, that is far outside.
const FAR: f64 = 2.0;

/// Recordings and equations.
pub(super) struct Balance<'a> {
    set: &'a DataSet,
    model: &'a dyn Model,
    p: Vec<f64>,
    /// Measured channels with their quantities.
    measured: Vec<(usize, Measured)>,
    /// The channel of each declared input.
    inputs: Vec<Option<usize>>,
}

/// What is missed in relation to what is measured, summed over a motion.
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

    fn runs(&self) -> impl Iterator<Item = &'a Run> {
        let runs = self.set.runs.iter();
        runs.filter(|run| run.part == Part::Fit).take(MOST[0])
    }

    /// The part that is missed of each equation, rate and output, where the recordings tell it; above one
    /// where the model expects more than is measured.
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
        let missed = |miss: &Miss| {
            let part = miss.error / miss.size;
            part.is_finite().then_some(part)
        };
        let mut missed: Vec<Option<f64>> = misses.iter().map(missed).collect();
        missed.extend(self.measured.iter().map(|own| self.outside(*own, factors)));
        missed
    }

    /// How many of the statistics of [`missed`](Self::missed) vary with the size of a channel; whether a
    /// value is inside its range does not.
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
                    if factors[*index] != 1.0 && self.set.channels[*index].is_angle() {
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

    /// Means of the inputs over a time.
    fn inputs(&self, run: &Run, [from, to]: [f64; 2], factors: &[f64]) -> Vec<f64> {
        let rows: Range<usize> =
            run.times.partition_point(|t| *t < from)..run.times.partition_point(|t| *t < to);
        let mean = |channel: &Option<usize>| {
            let Some(channel) = *channel else { return 0.0 };
            let values = run.values[channel].get(rows.clone()).unwrap_or_default();
            let sum: f64 = values.iter().sum();
            factors[channel] * sum / values.len().max(1) as f64
        };
        self.inputs.iter().map(mean).collect()
    }

    /// Adds what a motion misses.
    fn add(&self, misses: &mut [Miss], t: f64, derivatives: &[DVector<f64>; 3], u: &[f64]) {
        let info = self.model.info();
        let (n, speeds) = (info.state_len(), info.speeds);
        let mut x = info.initial_state();
        for (row, (_, measured)) in self.measured.iter().enumerate() {
            match measured {
                Measured::Coordinate(i) => x[speeds + i] = derivatives[0][row],
                Measured::PseudoVelocity(i) => x[*i] = derivatives[0][row],
                Measured::Output(_) => {}
            }
        }
        let rates = |x: &[f64]| {
            let mut rates = vec![0.0; n];
            self.model.rates(
                At {
                    t,
                    x,
                    u,
                    p: &self.p,
                },
                &mut rates,
            );
            rates
        };
        let with = |q: &[f64], w: &DVector<f64>| [w.as_slice(), q].concat();
        let q = x[speeds..].to_vec();
        // q̇ = T ω + τ in the rows of measured coordinates.
        let resting = rates(&with(&q, &DVector::zeros(speeds)));
        let coordinates: Vec<(usize, usize)> = (self.measured.iter().enumerate())
            .filter_map(|(row, (_, measured))| match measured {
                Measured::Coordinate(i) => Some((row, speeds + i)),
                _ => None,
            })
            .collect();
        let columns: Vec<Vec<f64>> = (0..speeds)
            .map(|j| {
                let mut unit = DVector::zeros(speeds);
                unit[j] = 1.0;
                rates(&with(&q, &unit))
            })
            .collect();
        let slopes = DMatrix::from_fn(coordinates.len(), speeds, |i, j| {
            columns[j][coordinates[i].1] - resting[coordinates[i].1]
        });
        let own = (0..speeds).map(|j| {
            let mut measured = self.measured.iter();
            measured.position(|(_, own)| *own == Measured::PseudoVelocity(j))
        });
        let own: Option<Vec<usize>> = own.collect();
        let by_coordinates = (coordinates.len() >= speeds)
            .then(|| slopes.svd(true, true))
            .filter(|svd| {
                let sizes = &svd.singular_values;
                sizes.iter().all(|size| size.is_finite()) && sizes.min() > SINGULAR * sizes.max()
            });
        let (w, w_dot) = if let Some(svd) = &by_coordinates {
            let solve = |order: usize, less: &[f64]| {
                let known = coordinates.iter();
                let known = known.map(|(row, i)| derivatives[order][*row] - less[*i]);
                let known = DVector::from_iterator(coordinates.len(), known);
                svd.solve(&known, 0.0).ok()
            };
            let Some(w) = solve(1, &resting) else { return };
            // d/dt(T ω + τ) with ω held.
            let held = with(&q, &w);
            let flow = rates(&held);
            let size = flow[speeds..]
                .iter()
                .fold(1.0, |most: f64, rate| most.max(rate.abs()));
            let along = |side: f64| {
                let moved = q.iter().zip(&flow[speeds..]);
                let moved: Vec<f64> = moved
                    .map(|(q, rate)| q + side * STEP * rate / size)
                    .collect();
                rates(&with(&moved, &w))
            };
            let (ahead, behind) = (along(1.0), along(-1.0));
            let carried: Vec<f64> = (ahead.iter().zip(&behind))
                .map(|(a, b)| (a - b) * size / (2.0 * STEP))
                .collect();
            let Some(w_dot) = solve(2, &carried) else {
                return;
            };
            (w, w_dot)
        } else if let Some(own) = own {
            let read = |order: usize| {
                let values = own.iter().map(|row| derivatives[order][*row]);
                DVector::from_iterator(speeds, values)
            };
            (read(0), read(1))
        } else {
            return;
        };
        let x = with(&q, &w);
        let expected = rates(&x);
        let mut outputs = vec![0.0; info.output_len()];
        self.model.outputs(
            At {
                t,
                x: &x,
                u,
                p: &self.p,
            },
            &mut outputs,
        );
        if expected
            .iter()
            .chain(&outputs)
            .chain(&w_dot)
            .any(|value| !value.is_finite())
        {
            return;
        }
        for i in 0..speeds {
            misses[i].add(w_dot[i], expected[i]);
        }
        // More coordinates than speeds: constraints tie their rates.
        if by_coordinates.is_some() && coordinates.len() > speeds {
            for (row, i) in coordinates {
                misses[speeds + self.measured.len() + row].add(derivatives[1][row], expected[i]);
            }
        }
        for (row, (_, measured)) in self.measured.iter().enumerate() {
            let value = derivatives[0][row];
            match measured {
                Measured::PseudoVelocity(i) if by_coordinates.is_some() => {
                    misses[speeds + row].add(value, w[*i])
                }
                Measured::Output(i) => misses[speeds + row].add(value, outputs[*i]),
                _ => {}
            }
        }
    }

    /// Whether a coordinate is far outside its declared range, as a part that is missed.
    fn outside(&self, (index, measured): (usize, Measured), factors: &[f64]) -> Option<f64> {
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
        if values().any(|value| distance(value) > FAR * width) {
            return Some(FAR);
        }
        Some(
            if values().all(|value| value.is_nan() || distance(value) <= 0.0) {
                0.0
            } else {
                0.5
            },
        )
    }
}

/// Fills missing values on straight lines.
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
