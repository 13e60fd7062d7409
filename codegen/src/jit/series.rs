//! The two programs of Taylor series in machine code.

use std::fmt;

use appell_runtime::model::At;
use appell_runtime::series::{OrderNumber, Series, Shape, Start, Started, Sweep, Swept};

use super::Sizes;
use super::on_demand::Ready;
use crate::taylor::SeriesProgram;

/// Series compiled in this process; interpreted where they are too long.
pub struct JitSeries {
    shape: Shape,
    start: Ready,
    sweep: Ready,
}

impl JitSeries {
    /// Compiles both programs.
    pub fn new(program: SeriesProgram) -> Self {
        let SeriesProgram {
            shape,
            start,
            sweep,
        } = program;
        let at_start = Sizes {
            states: shape.states,
            inputs: shape.inputs,
            parameters: shape.parameters,
        };
        let at_order = Sizes {
            states: shape.states,
            inputs: shape.inputs + OrderNumber::COUNT,
            parameters: shape.kept,
        };
        Self {
            start: Ready::new(start, at_start),
            sweep: Ready::new(sweep, at_order),
            shape,
        }
    }
}

impl Series for JitSeries {
    fn shape(&self) -> &Shape {
        &self.shape
    }

    fn start(&self, from: Start<'_>, to: Started<'_>) {
        let Start { t, x, u, p } = from;
        let results = [to.next, to.kept, to.guards];
        self.start.call(At { t, x, u, p }, &[], results);
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
        let results = [to.next, to.left, to.right, to.guards];
        self.sweep.call(at, sums, results);
    }
}

impl fmt::Debug for JitSeries {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("JitSeries")
            .field("shape", &self.shape)
            .finish_non_exhaustive()
    }
}
