//! Forces that nobody has named: functions of one position or rate in one equation.
//!
//! Each function is one wave, a sine and a cosine of the variable. A wave that gains more than any
//! effect of the library speaks for something that the library lacks, and tells what it depends on.
//! Waves of time are left out: what does not return with the state is a disturbance, and the filter
//! has levels for these. A wave has to predict runs that it was not found in.

use appell_runtime::estimate::{Disturbance, Estimation, Shapes};
use appell_runtime::model::At;
use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

use super::DiagnoseError;
use super::bench::Bench;
use super::hypothesis::Fitted;
use super::screen::{Projected, moving};

/// Waves of a variable.
const WAVES: usize = 24;
/// Range of a rate in typical rates.
const REACH: f64 = 2.5;

/// A force as a wave.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Wave {
    /// Index of the pseudo-velocity whose equation has it.
    pub(super) equation: usize,
    /// Name of the variable.
    pub(super) variable: String,
    /// Length of the wave in SI units of the variable.
    pub(super) length: f64,
    /// Gain in log-likelihood.
    pub(super) gain: f64,
    /// Gain on runs that it was not found in.
    pub(super) predicted: f64,
}

/// How a variable is cut into waves.
struct Variable {
    state: usize,
    /// Angle of the first wave per unit.
    first: f64,
    /// The waves also grow with time: a friction that changes.
    drifts: bool,
}

/// The waves about a fit, the greatest gain first, and how many were tried.
pub(super) fn waves(
    bench: &Bench<'_>,
    fitted: &Fitted,
) -> Result<(Vec<Wave>, usize), DiagnoseError> {
    let setup = bench.setup(&fitted.members);
    let estimation = Estimation::new(&setup, &bench.recordings)?;
    let free = moving(fitted);
    let info = bench.effects.info();
    let mut found = Vec::new();
    for variable in variables(bench) {
        let write = |_run: usize, at: At<'_>, values: &mut [f64]| {
            let x = at.x[variable.state];
            let grown = if variable.drifts { at.t } else { 1.0 };
            for (wave, pair) in values.chunks_exact_mut(2).enumerate() {
                let (sin, cos) = ((wave + 1) as f64 * variable.first * x).sin_cos();
                pair.copy_from_slice(&[grown * sin, grown * cos]);
            }
        };
        let shapes = Shapes {
            count: 2 * WAVES,
            values: &write,
        };
        let tangent = estimation.tangent(&fitted.fit.values, &free, Some(shapes))?;
        let projected = Projected::new(&tangent, fitted, free.len(), 0..0);
        for (place, disturbance) in setup.disturbances.iter().enumerate() {
            let Disturbance::Force(equation) = *disturbance else {
                continue;
            };
            for wave in 0..WAVES {
                let column = free.len() + 2 * (place * WAVES + wave);
                let slopes = projected.slopes(&[column, column + 1]);
                let Some((gain, predicted)) = gains(&projected, &slopes) else {
                    continue;
                };
                let name = &info.states[variable.state].name;
                found.push(Wave {
                    equation,
                    variable: if variable.drifts {
                        format!("{name} and time")
                    } else {
                        name.to_string()
                    },
                    length: std::f64::consts::TAU / ((wave + 1) as f64 * variable.first),
                    gain,
                    predicted,
                });
            }
        }
    }
    found.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    let tried = found.len();
    Ok((found, tried))
}

/// Positions and rates that return: over whole turns where an angle makes several.
fn variables(bench: &Bench<'_>) -> Vec<Variable> {
    let info = bench.effects.info();
    let mut variables = Vec::new();
    for state in 0..info.state_len() {
        let Some((low, high)) = bench.range(state) else {
            continue;
        };
        let range = high - low;
        let turns = info.states[state].unit.as_ref() == "rad" && range > std::f64::consts::TAU;
        let first = if turns {
            1.0
        } else {
            std::f64::consts::PI / range
        };
        variables.push(Variable {
            state,
            first,
            drifts: false,
        });
        if state < info.speeds {
            variables.push(Variable {
                state,
                first,
                drifts: true,
            });
        }
    }
    variables
}

impl Bench<'_> {
    /// Range of a state along the recordings: measured, or typical rates of what is measured.
    fn range(&self, state: usize) -> Option<(f64, f64)> {
        let shown = self.measured.iter().position(
            |shown| matches!(shown, appell_runtime::estimate::Measured::State(s) if *s == state),
        );
        if let Some(channel) = shown {
            let rows = self
                .recordings
                .iter()
                .flat_map(|run| (0..run.times().len()).map(move |row| run.measured(row)[channel]));
            let seen = rows.filter(|value| !value.is_nan());
            let (low, high) = seen.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
                (low.min(x), high.max(x))
            });
            return (high > low).then_some((low, high));
        }
        let size = self.sizes.get(state).copied()?;
        (size > 0.0).then_some((-REACH * size, REACH * size))
    }
}

/// What two columns gain, and what they gain on each run with the coefficients of the others.
fn gains(projected: &Projected<'_>, slopes: &DMatrix<f64>) -> Option<(f64, f64)> {
    let samples = &projected.tangent.samples;
    let runs = samples.last().map_or(0, |(run, _)| run + 1);
    let mut squares = vec![Matrix2::zeros(); runs];
    let mut scores = vec![Vector2::zeros(); runs];
    for (row, (run, _)) in samples.iter().enumerate() {
        let slope = Vector2::new(slopes[(row, 0)], slopes[(row, 1)]);
        squares[*run] += slope * slope.transpose();
        scores[*run] -= slope * projected.rest[row];
    }
    let all: Matrix2<f64> = squares.iter().sum();
    let score: Vector2<f64> = scores.iter().sum();
    let step = solved(&all, &score)?;
    let gain = 0.5 * score.dot(&step);
    if runs < 2 {
        return Some((gain, gain));
    }
    let mut predicted = 0.0;
    for run in 0..runs {
        let step = solved(&(all - squares[run]), &(score - scores[run]))?;
        predicted += step.dot(&scores[run]) - 0.5 * step.dot(&(squares[run] * step));
    }
    Some((gain, predicted))
}

fn solved(squares: &Matrix2<f64>, score: &Vector2<f64>) -> Option<Vector2<f64>> {
    /// A little of the larger diagonal keeps a wave that is hardly there in place.
    const FLOOR: f64 = 1e-9;
    let size = squares.diagonal().max();
    if size.is_nan() || size <= 0.0 {
        return None;
    }
    let squares = squares + Matrix2::identity() * (FLOOR * size);
    let factor = squares.cholesky()?;
    let step: DVector<f64> = DVector::from_column_slice(factor.solve(score).as_slice());
    Some(Vector2::new(step[0], step[1]))
}
