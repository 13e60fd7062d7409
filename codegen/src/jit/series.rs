//! The two programs of Taylor series in machine code.

use std::fmt;

use appell_runtime::lanes::{AtLanes, LANES};
use appell_runtime::model::At;
use appell_runtime::series::{
    OrderNumber, Series, SeriesInLanes, Shape, Start, Started, Sweep, Swept,
};

use super::on_demand::Ready;
use super::{JitError, Sizes, Target, VectorFunction};
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
        let [at_start, at_order] = sizes(&program.shape);
        let SeriesProgram {
            shape,
            start,
            sweep,
        } = program;
        Self {
            start: Ready::new(start, at_start),
            sweep: Ready::new(sweep, at_order),
            shape,
        }
    }
}

/// Lengths of the arguments of both programs.
fn sizes(shape: &Shape) -> [Sizes; 2] {
    let start = Sizes {
        states: shape.states,
        inputs: shape.inputs,
        parameters: shape.parameters,
    };
    let sweep = Sizes {
        states: shape.states,
        inputs: shape.inputs + OrderNumber::COUNT,
        parameters: shape.kept,
    };
    [start, sweep]
}

/// The same for eight motions at once.
#[derive(Debug)]
pub struct JitSeriesInLanes {
    shape: Shape,
    start: VectorFunction,
    sweep: VectorFunction,
}

impl JitSeriesInLanes {
    /// Compiles both programs.
    pub fn new(program: SeriesProgram, target: Target) -> Result<Self, JitError> {
        let [at_start, at_order] = sizes(&program.shape);
        let compile = VectorFunction::compile_or_interpret;
        Ok(Self {
            start: compile(&program.start, at_start, target)?,
            sweep: compile(&program.sweep, at_order, target)?,
            shape: program.shape,
        })
    }
}

impl SeriesInLanes for JitSeriesInLanes {
    fn shape(&self) -> &Shape {
        &self.shape
    }

    fn start(&self, at: AtLanes<'_>, to: [&mut [[f64; LANES]]; 3]) {
        self.start.call(at, to);
    }

    fn sweep(&self, at: AtLanes<'_>, sums: &[[f64; LANES]], to: [&mut [[f64; LANES]]; 4]) {
        self.sweep.call_weighted(at, sums, to);
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
