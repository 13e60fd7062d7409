//! Series executed step by step.

use appell_runtime::model::At;
use appell_runtime::series::{Series, Shape, Start, Started, Sweep, Swept};

use super::SeriesProgram;
use crate::schedule::{Schedule, interpret_weighted};

/// Series that interpret their schedules: slow, and without requirements.
#[derive(Debug, Clone)]
pub struct InterpretedSeries(pub SeriesProgram);

impl Series for InterpretedSeries {
    fn shape(&self) -> &Shape {
        &self.0.shape
    }

    fn start(&self, from: Start<'_>, to: Started<'_>) {
        let Start { t, x, u, p } = from;
        let results = [to.next, to.kept, to.guards];
        write(&self.0.start, At { t, x, u, p }, &[], results);
    }

    fn sweep(&self, from: Sweep<'_>, to: Swept<'_>) {
        let Sweep {
            k,
            x,
            u,
            kept,
            sums,
        } = from;
        let at = At {
            t: k,
            x,
            u,
            p: kept,
        };
        write(
            &self.0.sweep,
            at,
            sums,
            [to.next, to.left, to.right, to.guards],
        );
    }
}

fn write<const N: usize>(schedule: &Schedule, at: At<'_>, sums: &[f64], to: [&mut [f64]; N]) {
    for (to, values) in to.into_iter().zip(interpret_weighted(schedule, at, sums)) {
        to.copy_from_slice(&values);
    }
}
