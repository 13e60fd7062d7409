//! One pass of the filter over all recordings from which both its gradient and the information of the means come.

use nalgebra::{DMatrix, DMatrixView};

use super::adjoint::adjoint;
use super::direction::Direction;
use super::tangent::Forward;
use crate::EstimateError;
use crate::estimation::Estimation;
use crate::kalman::filter::Pass;
use crate::matrix::add;
use crate::parallel::in_parallel;

/// Filters at their ends with tapes of all steps.
pub(crate) struct Kept<'e, 'a> {
    estimation: &'e Estimation<'a>,
    passes: Vec<Pass<'e>>,
    means: DMatrix<f64>,
}

/// Derivatives of the log-likelihood.
pub(crate) struct Slopes {
    /// With respect to all values.
    pub(crate) gradient: Vec<f64>,
    /// Fisher information of the means along the directions.
    pub(crate) means: DMatrix<f64>,
}

impl<'a> Estimation<'a> {
    /// The pass at some values, with a largest number of steps for each run; with directions it takes three times as long.
    pub(crate) fn kept<'e>(
        &'e self,
        values: &'e [f64],
        directions: &[Direction],
        most_steps: &[usize],
    ) -> Result<Kept<'e, 'a>, EstimateError> {
        self.check(values)?;
        let of_run = |run| match directions {
            [] => Ok((
                self.pass(run, values, true, most_steps)?,
                DMatrix::zeros(0, 0),
            )),
            some => self.with_information(run, values, some, most_steps),
        };
        let (passes, means): (_, Vec<_>) = self.over_runs(of_run)?.into_iter().unzip();
        Ok(Kept {
            estimation: self,
            passes,
            means: means.into_iter().sum(),
        })
    }

    /// The pass of a run and the Fisher information of its means.
    fn with_information<'e>(
        &'e self,
        run: usize,
        values: &'e [f64],
        directions: &[Direction],
        most_steps: &[usize],
    ) -> Result<(Pass<'e>, DMatrix<f64>), EstimateError> {
        let actions = self.actions(run, values);
        let pass = self.fresh(run, values, &actions, Some(self.blank_tape()), most_steps);
        let columns = directions.len();
        let mut forward = Forward::new(self, pass, directions, None, columns);
        forward.over(&actions)?;
        let samples = forward.pass.samples.len();
        let slopes = DMatrixView::from_slice(&forward.rows, columns, samples);
        Ok((forward.pass, slopes * slopes.transpose()))
    }
}

impl Kept<'_, '_> {
    pub(crate) fn log_likelihood(&self) -> f64 {
        self.passes.iter().map(Pass::log_likelihood).sum()
    }

    /// Number of steps of each run.
    pub(crate) fn steps(&self) -> Vec<usize> {
        self.passes.iter().map(|pass| pass.steps).collect()
    }

    /// Its derivatives, by a reverse sweep that takes twice as long as a filter alone.
    pub(crate) fn slopes(mut self) -> Slopes {
        let values = self.estimation.layout().len();
        let own = in_parallel(self.passes.iter_mut(), |pass| {
            let mut gradient = vec![0.0; values];
            adjoint(pass, &mut gradient);
            gradient
        });
        let mut gradient = vec![0.0; values];
        for own in &own {
            add(own, &mut gradient);
        }
        Slopes {
            gradient,
            means: std::mem::take(&mut self.means),
        }
    }
}

/// Tapes are used again.
impl Drop for Kept<'_, '_> {
    fn drop(&mut self) {
        let tapes = self.passes.drain(..).map(|pass| pass.tape);
        self.estimation.tapes().extend(tapes);
    }
}
