//! Residual forces of recorded motions, and their derivatives by the sizes of effects.

use appell_estimate::inverse::Moment;
use appell_recordings::{DataSet, Part as OfSet};
use appell_runtime::model::{At, Model};
use appell_spec::mechanism::CoordinateId;
use nalgebra::{DMatrix, DVector};

use super::super::Result;
use crate::base::recorded;
use crate::effects::{EffectModel, Part};
use crate::inverse::coordinates;

/// Largest number of motions that are evaluated, spread over the recordings.
const MOST: usize = 3000;
/// Step of a size in SI; forces are linear in sizes, and quadratic terms cancel in central differences.
const STEP: f64 = 1e-2;
/// The same for a parameter, relative to its value.
const PART: f64 = 1e-4;

/// Step of coordinates, rates, accelerations and inputs in SI.
const NEAR: f64 = 1e-5;
/// A lever below this is rounding.
const NO_LEVER: f64 = 1e-6;

/// A parameter that a hypothesis may change.
#[derive(Debug, Clone, Copy)]
pub(super) struct Variable {
    /// Its index.
    pub(super) parameter: usize,
    /// The size beside which it shapes an effect.
    pub(super) shapes: Option<Shaped>,
}

/// Forces are bilinear in a size s and a shape z, as in the mass of a payload and its place: s f(z) = s f(z₀) + s (z −
/// z₀) f′. The variable of a shape is the product s (z − z₀).
#[derive(Debug, Clone, Copy)]
pub(super) struct Shaped {
    /// Index of the size.
    pub(super) size: usize,
    /// Prior standard deviation of the shape.
    pub(super) std: f64,
}

/// A recorded motion.
pub(super) struct Motion {
    /// Time in s.
    pub(super) t: f64,
    /// States.
    pub(super) x: Vec<f64>,
    /// Inputs.
    pub(super) u: Vec<f64>,
    /// Generalised force of the inputs in each equation.
    pub(super) driven: DVector<f64>,
    /// M ω̇ + b − Π with the parameters of the data set.
    pub(super) residual: DVector<f64>,
    /// Its derivatives by the variables.
    pub(super) slopes: DMatrix<f64>,
    /// Its variances due to the noise of the channels.
    pub(super) noise: DVector<f64>,
}

impl Motion {
    /// For a model with the parameters `p`.
    fn of(model: &dyn Model, moment: Moment, p: &[f64], variables: &[Variable]) -> Self {
        let info = model.info();
        let residual = demand(model, &moment, p);
        let mut without = moment.clone();
        without.u[..info.declared_inputs].fill(0.0);
        let mut slopes = DMatrix::zeros(info.speeds, variables.len());
        let mut moved = p.to_vec();
        for (mut slope, variable) in slopes.column_iter_mut().zip(variables) {
            slope.copy_from(&derivative(model, &moment, &mut moved, *variable));
        }
        Self {
            t: moment.t,
            driven: demand(model, &without, p) - &residual,
            noise: DVector::zeros(info.speeds),
            residual,
            slopes,
            x: moment.x,
            u: moment.u,
        }
    }

    /// The same with noise of the channels: `spread` is the covariance of the coordinates, each with the index of its
    /// rate among the states, and of the inputs, all with their derivatives.
    fn noisy(
        self,
        model: &dyn Model,
        moment: &Moment,
        spread: &DMatrix<f64>,
        p: &[f64],
        coordinates: &[[usize; 2]],
    ) -> Self {
        let inputs = model.info().declared_inputs;
        let mut slopes = DMatrix::zeros(self.residual.len(), spread.ncols());
        let mut slope = |column: usize, of: fn(&mut Moment) -> &mut [f64], index: usize| {
            let at = |side: f64| {
                let mut moved = moment.clone();
                of(&mut moved)[index] += side * NEAR;
                demand(model, &moved, p)
            };
            slopes.set_column(column, &((at(1.0) - at(-1.0)) / (2.0 * NEAR)));
        };
        for (channel, &[coordinate, speed]) in coordinates.iter().enumerate() {
            slope(3 * channel, |moment| &mut moment.x, coordinate);
            slope(3 * channel + 1, |moment| &mut moment.x, speed);
            slope(3 * channel + 2, |moment| &mut moment.accelerations, speed);
        }
        for input in 0..inputs {
            let channel = coordinates.len() + input;
            slope(3 * channel, |moment| &mut moment.u, input);
        }
        let noise = (&slopes * spread * slopes.transpose()).diagonal();
        Self { noise, ..self }
    }

    /// The residual with parameters that differ from those of the data set by `changes`.
    pub(super) fn left(&self, changes: &DVector<f64>) -> DVector<f64> {
        &self.residual + &self.slopes * changes
    }
}

/// The recorded motions of some runs.
pub(super) struct Motions {
    /// Parameters of the mechanism with a tolerance, sizes and shapes of effects.
    pub(super) variables: Vec<Variable>,
    /// E⁻¹ ∂E/∂p where Π = E u + …, by the column of the variable; without those that are zero.
    pub(super) levers: Vec<(usize, DMatrix<f64>)>,
    /// Segments without missing samples, each with the name of its run.
    pub(super) stretches: Vec<(String, Vec<Motion>)>,
}

impl Motions {
    /// The motions of all runs of a data set, which are all training or all test runs.
    pub(super) fn of(set: &DataSet, effects: &EffectModel) -> Result<Self> {
        let model = effects.beside(&[]);
        let info = model.info();
        let p: Vec<f64> = set.parameters.iter().map(|own| own.value).collect();
        let of_runs: Vec<Vec<f64>> = set.runs.iter().map(|run| set.parameters_in(run)).collect();
        let variables = variables(set, effects);
        let runs = set.all(OfSet::Fit);
        let stretches = recorded(&runs, model, &p)?.stretches;
        let coordinates: Vec<[usize; 2]> = (coordinates(set).into_iter())
            .filter_map(|(_, coordinate)| {
                let speed = set.mechanism.speed_of(CoordinateId::new(coordinate))?;
                Some([info.speeds + coordinate, speed.index()])
            })
            .collect();
        let first = stretches.iter().find_map(|one| one.moments.first());
        let levers = first.map_or_else(Vec::new, |first| levers(model, first, &p, &variables));
        let count: usize = stretches.iter().map(|one| one.moments.len()).sum();
        let stride = count.div_ceil(MOST).max(1);
        let stretches = stretches.into_iter().map(|stretch| {
            let moments = stretch.moments.into_iter().zip(&stretch.spreads);
            let p = &of_runs[stretch.run];
            let motions = moments.step_by(stride).map(|(moment, spread)| {
                let motion = Motion::of(model, moment.clone(), p, &variables);
                motion.noisy(model, &moment, spread, p, &coordinates)
            });
            (set.runs[stretch.run].name.clone(), motions.collect())
        });
        Ok(Self {
            stretches: stretches.collect(),
            variables,
            levers,
        })
    }

    /// The column of a parameter.
    pub(super) fn column(&self, parameter: usize) -> Option<usize> {
        let mut variables = self.variables.iter();
        variables.position(|own| own.parameter == parameter)
    }

    pub(super) fn all(&self) -> impl Iterator<Item = &Motion> {
        self.stretches.iter().flat_map(|(_, motions)| motions)
    }

    /// The motions of each run, over its missing samples.
    pub(super) fn runs(&self) -> Vec<(&str, Vec<&Motion>)> {
        let mut runs: Vec<(&str, Vec<&Motion>)> = Vec::new();
        for (run, own) in &self.stretches {
            match runs.last_mut() {
                Some((last, all)) if last == run => all.extend(own),
                _ => runs.push((run, own.iter().collect())),
            }
        }
        runs
    }

    /// Standard deviation of the noise of each equation's force: the smaller of two upper bounds. One propagates the
    /// residuals of the channels about their splines, which include fast variations of inputs; the other is the mean
    /// square successive difference of the residual of a hypothesis (J. von Neumann, *Distribution of the ratio of the
    /// mean square successive difference to the variance*, 1941).
    pub(super) fn noise(&self, changes: &DVector<f64>) -> DVector<f64> {
        let equations = self.all().next().map_or(0, |motion| motion.noise.len());
        let of_channels = mean(equations, self.all().map(|motion| motion.noise.clone()));
        let pairs = self.stretches.iter().flat_map(|(_, own)| own.windows(2));
        let half_squares = pairs.map(|pair| {
            let change = pair[1].left(changes) - pair[0].left(changes);
            0.5 * change.component_mul(&change)
        });
        let successive = mean(equations, half_squares);
        let least = of_channels.zip_map(&successive, f64::min);
        least.map(|variance| variance.sqrt().max(f64::MIN_POSITIVE))
    }
}

fn mean(length: usize, all: impl Iterator<Item = DVector<f64>>) -> DVector<f64> {
    let (sum, count) = all.fold((DVector::zeros(length), 0.0), |(sum, count), own| {
        (sum + own, count + 1.0)
    });
    sum / f64::max(count, 1.0)
}

/// Derivative of M ω̇ + b − Π by a variable.
fn derivative(
    model: &dyn Model,
    moment: &Moment,
    p: &mut [f64],
    variable: Variable,
) -> DVector<f64> {
    let index = variable.parameter;
    let value = p[index];
    let step = match variable.shapes {
        Some(shaped) => shaped.std,
        None if value == 0.0 => STEP,
        None => PART * value.abs(),
    };
    let mut at = |side: f64| {
        p[index] = value + side * step;
        match variable.shapes {
            None => demand(model, moment, p),
            Some(Shaped { size, .. }) => {
                let size = Variable {
                    parameter: size,
                    shapes: None,
                };
                derivative(model, moment, p, size)
            }
        }
    };
    let slope = (at(1.0) - at(-1.0)) / (2.0 * step);
    p[index] = value;
    slope
}

/// M ω̇ + b − Π.
fn demand(model: &dyn Model, moment: &Moment, p: &[f64]) -> DVector<f64> {
    let (t, x, u) = (moment.t, moment.x.as_slice(), moment.u.as_slice());
    let mut demand = DVector::zeros(model.info().speeds);
    let at = At { t, x, u, p };
    model.inverse_dynamics(at, &moment.accelerations, demand.as_mut_slice());
    demand
}

/// Relative change of the forces of unit inputs by the variables. Each input drives a coordinate, so that these forces
/// do not depend on the motion.
fn levers(
    model: &dyn Model,
    first: &Moment,
    p: &[f64],
    variables: &[Variable],
) -> Vec<(usize, DMatrix<f64>)> {
    let inputs = model.info().declared_inputs;
    let of = |input: Option<usize>| {
        let mut moment = first.clone();
        moment.u[..inputs].fill(0.0);
        if let Some(input) = input {
            moment.u[input] = 1.0;
        }
        Motion::of(model, moment, p, variables)
    };
    let without = of(None);
    let unit: Vec<Motion> = (0..inputs).map(|input| of(Some(input))).collect();
    let driven: Vec<_> = unit.iter().map(|own| own.driven.clone()).collect();
    let Some(inverse) = DMatrix::from_columns(&driven).try_inverse() else {
        return Vec::new();
    };
    let lever = |column: usize| {
        let slope = |own: &Motion| own.slopes.column(column) - without.slopes.column(column);
        // Forces of inputs are subtracted.
        let slopes: Vec<DVector<f64>> = unit.iter().map(|own| -slope(own)).collect();
        let lever = &inverse * DMatrix::from_columns(&slopes);
        (lever.amax() > NO_LEVER).then_some((column, lever))
    };
    (0..variables.len()).filter_map(lever).collect()
}

/// Parameters with a tolerance, sizes of the effects, and shapes of effects of one size.
fn variables(set: &DataSet, effects: &EffectModel) -> Vec<Variable> {
    let plain = |parameter: usize| Variable {
        parameter,
        shapes: None,
    };
    let mut variables: Vec<Variable> = (0..set.parameters.len())
        .filter(|&index| set.parameters[index].std.is_some_and(|std| std > 0.0))
        .map(plain)
        .collect();
    for candidate in &effects.candidates {
        let own = effects.own(candidate);
        let sizes = own.iter().filter(|(_, part)| *part == Part::Size);
        let sizes: Vec<usize> = sizes.map(|(index, _)| *index).collect();
        variables.extend(sizes.iter().copied().map(plain));
        let [size] = sizes[..] else { continue };
        variables.extend(own.iter().filter_map(|&(parameter, part)| match part {
            Part::Shape(Some(std)) => Some(Variable {
                parameter,
                shapes: Some(Shaped { size, std }),
            }),
            _ => None,
        }));
    }
    variables
}
