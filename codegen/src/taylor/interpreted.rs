//! Series executed step by step.

use appell_runtime::model::At;
use appell_runtime::series::{Series, Shape, Sweep, Swept};

use super::SeriesProgram;
use crate::schedule::{Schedule, interpret_weighted};

/// Series that interpret their schedules: slow, and without requirements.
#[derive(Debug, Clone)]
pub struct InterpretedSeries(pub SeriesProgram);

impl Series for InterpretedSeries {
    fn shape(&self) -> &Shape {
        &self.0.shape
    }

    fn start(&self, at: At<'_>, next: &mut [f64], kept: &mut [f64], guards: &mut [f64]) {
        write(&self.0.start, at, &[], [next, kept, guards]);
    }

    fn sweep(&self, from: Sweep<'_>, to: Swept<'_>) {
        let results = [to.next, to.left, to.right, to.guards];
        write(&self.0.sweep, from.at, from.sums, results);
    }
}

fn write<const N: usize>(schedule: &Schedule, at: At<'_>, sums: &[f64], to: [&mut [f64]; N]) {
    for (to, values) in to.into_iter().zip(interpret_weighted(schedule, at, sums)) {
        to.copy_from_slice(&values);
    }
}
