//! Residual forces of recorded motions, and what each size would add to them.

use appell_estimate::Moment;
use appell_recordings::{DataSet, Part as OfSet};
use appell_runtime::model::{At, Model};
use nalgebra::{DMatrix, DVector};

use super::super::DiagnoseError;
use crate::base::recorded;
use crate::effects::{EffectModel, Part};

/// Most motions that are evaluated, spread over the recordings.
const MOST: usize = 3000;
/// Step of a size in SI; forces are linear in sizes, and what is quadratic cancels.
const STEP: f64 = 1e-2;
/// The same of a parameter, as a part of its value.
const PART: f64 = 1e-4;

/// A lever below this is rounding.
const NO_LEVER: f64 = 1e-6;

/// A recorded motion.
pub(super) struct Motion {
    /// Time in s.
    pub(super) t: f64,
    /// States.
    pub(super) x: Vec<f64>,
    /// Inputs.
    pub(super) u: Vec<f64>,
    /// What inputs do in each equation.
    pub(super) driven: DVector<f64>,
    /// M ω̇ + b − Π with the parameters of the data set.
    pub(super) residual: DVector<f64>,
    /// Its derivatives by the parameters that vary.
    pub(super) slopes: DMatrix<f64>,
}

impl Motion {
    /// Of a model with the parameters `p`, some of which vary.
    fn of(model: &dyn Model, moment: Moment, p: &[f64], parameters: &[usize]) -> Self {
        let info = model.info();
        let demand = |u: &[f64], p: &[f64]| {
            let (t, x) = (moment.t, moment.x.as_slice());
            let mut demand = DVector::zeros(info.speeds);
            let at = At { t, x, u, p };
            model.inverse_dynamics(at, &moment.accelerations, demand.as_mut_slice());
            demand
        };
        let residual = demand(&moment.u, p);
        let mut without = moment.u.clone();
        without[..info.declared_inputs].fill(0.0);
        let driven = demand(&without, p) - &residual;
        let mut slopes = DMatrix::zeros(info.speeds, parameters.len());
        let mut moved = p.to_vec();
        for (mut slope, &parameter) in slopes.column_iter_mut().zip(parameters) {
            let step = match p[parameter] {
                0.0 => STEP,
                value => PART * value.abs(),
            };
            let mut at = |side: f64| {
                moved[parameter] = p[parameter] + side * step;
                demand(&moment.u, &moved)
            };
            slope.copy_from(&((at(1.0) - at(-1.0)) / (2.0 * step)));
            moved[parameter] = p[parameter];
        }
        Self {
            t: moment.t,
            driven,
            residual,
            slopes,
            x: moment.x,
            u: moment.u,
        }
    }

    /// The residual where parameters differ by so much from those of the data set.
    pub(super) fn left(&self, changes: &DVector<f64>) -> DVector<f64> {
        &self.residual + &self.slopes * changes
    }
}

/// The recorded motions of some runs.
pub(super) struct Motions {
    /// The parameters that vary: those of the mechanism with a tolerance, sizes of effects.
    pub(super) parameters: Vec<usize>,
    /// E⁻¹ ∂E/∂p where Π = E u + …, by the column of the parameter; without those that are zero.
    pub(super) levers: Vec<(usize, DMatrix<f64>)>,
    /// Stretches without a gap, each with the name of its run.
    pub(super) stretches: Vec<(String, Vec<Motion>)>,
}

impl Motions {
    /// Of all runs of a data set, which are of one part.
    pub(super) fn of(set: &DataSet, effects: &EffectModel) -> Result<Self, DiagnoseError> {
        let model = effects.beside(&[]);
        let p: Vec<f64> = set.parameters.iter().map(|own| own.value).collect();
        let parameters = varying(set, effects);
        let runs = set.all(OfSet::Fit);
        let stretches = recorded(&runs, model, &p)?;
        let first = stretches.iter().find_map(|one| one.moments.first());
        let levers = first.map_or_else(Vec::new, |first| levers(model, first, &p, &parameters));
        let count: usize = stretches.iter().map(|one| one.moments.len()).sum();
        let stride = count.div_ceil(MOST).max(1);
        let stretches = stretches.into_iter().map(|stretch| {
            let moments = stretch.moments.into_iter().step_by(stride);
            let motions = moments.map(|moment| Motion::of(model, moment, &p, &parameters));
            (set.runs[stretch.run].name.clone(), motions.collect())
        });
        Ok(Self {
            stretches: stretches.collect(),
            parameters,
            levers,
        })
    }

    pub(super) fn all(&self) -> impl Iterator<Item = &Motion> {
        self.stretches.iter().flat_map(|(_, motions)| motions)
    }

    /// Noise of each equation's force: what changes from one motion to the next (J. von Neumann, *Distribution of
    /// the ratio of the mean square successive difference to the variance*, 1941).
    pub(super) fn noise(&self, changes: &DVector<f64>) -> DVector<f64> {
        let (mut sum, mut count) = (DVector::zeros(0), 0.0_f64);
        for (_, motions) in &self.stretches {
            let left: Vec<DVector<f64>> = motions.iter().map(|own| own.left(changes)).collect();
            for pair in left.windows(2) {
                let square = (&pair[1] - &pair[0]).map(|change| 0.5 * change * change);
                sum = if count > 0.0 { sum + square } else { square };
                count += 1.0;
            }
        }
        sum.map(|sum: f64| (sum / count.max(1.0)).sqrt().max(f64::MIN_POSITIVE))
    }
}

/// How parameters change the forces of unit inputs, in parts of these. Each input drives a coordinate, so that these
/// depend on no motion.
fn levers(
    model: &dyn Model,
    first: &Moment,
    p: &[f64],
    parameters: &[usize],
) -> Vec<(usize, DMatrix<f64>)> {
    let inputs = model.info().declared_inputs;
    let of = |input: Option<usize>| {
        let mut moment = first.clone();
        moment.u[..inputs].fill(0.0);
        if let Some(input) = input {
            moment.u[input] = 1.0;
        }
        Motion::of(model, moment, p, parameters)
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
    (0..parameters.len()).filter_map(lever).collect()
}

/// Parameters with a tolerance, and sizes of the effects.
fn varying(set: &DataSet, effects: &EffectModel) -> Vec<usize> {
    let info = effects.info();
    let mut varying: Vec<usize> = (0..set.parameters.len())
        .filter(|&index| set.parameters[index].std.is_some_and(|std| std > 0.0))
        .collect();
    for candidate in &effects.candidates {
        let sizes = candidate.parameters.iter();
        let sizes = sizes.filter(|(_, part)| *part == Part::Size);
        varying.extend(sizes.filter_map(|(name, _)| info.parameter_index(name)));
    }
    varying
}
