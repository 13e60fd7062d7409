//! Record of a pass of the filter for the reverse sweep: actions, with their numbers on a tape.

use std::ops::Range;

use super::filter::{Innovation, Pass};
use crate::matrix::pieces;
use crate::motion::timeline::Advance;
use crate::motion::transition::{Stages, stages_len};

/// An action of the filter.
#[derive(Debug, Clone)]
pub(crate) enum Record {
    /// A step; its numbers start at `tape`.
    Advance { advance: Advance, tape: usize },
    /// A step in parts, two to the power of `halvings` or more. To save memory only the start of
    /// the step is kept at `tape`; the reverse sweep recomputes the parts.
    Parts {
        advance: Advance,
        halvings: u32,
        tape: usize,
    },
    /// Scalars that were measured at one time, and the inputs then, where outputs were.
    Measure {
        /// The row, unless it was a delayed channel alone.
        row: Option<usize>,
        samples: Range<usize>,
        held: Vec<f64>,
    },
    /// Loops were closed; the closed state and the root of P before start at `tape`.
    Close { t: f64, held: Vec<f64>, tape: usize },
}

/// A scalar with the numbers for the reverse sweep.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sample {
    pub(crate) innovation: Innovation,
    /// The quantity without scale and bias.
    pub(crate) quantity: f64,
    /// Offset of its numbers.
    pub(crate) tape: usize,
}

/// Numbers of a step on the tape.
pub(crate) struct StepTape<'a> {
    pub(crate) held: &'a mut [f64],
    pub(crate) stages: Stages<'a>,
    /// F.
    pub(crate) f: &'a mut [f64],
    /// Root of P before the step.
    pub(crate) root: &'a mut [f64],
    /// Directions in which the disturbances act, n rows.
    pub(crate) columns: &'a mut [f64],
    /// State after the step.
    pub(crate) after: &'a mut [f64],
}

/// Numbers of a scalar on the tape.
pub(crate) struct SampleTape<'a> {
    /// Gradient of the scalar with respect to the states.
    pub(crate) c: &'a mut [f64],
    /// P c.
    pub(crate) a: &'a mut [f64],
    /// State before the update.
    pub(crate) z: &'a mut [f64],
    /// Root of P before the update.
    pub(crate) root: &'a mut [f64],
}

/// Sizes of the parts of a tape.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sizes {
    pub(crate) n: usize,
    /// Numbers of the declared inputs.
    pub(crate) commands: usize,
    pub(crate) disturbances: usize,
}

impl Sizes {
    pub(crate) fn step_len(self) -> usize {
        let Self { n, .. } = self;
        self.commands + stages_len(n) + 2 * n * n + n * self.disturbances + n
    }

    pub(crate) fn sample_len(self) -> usize {
        3 * self.n + self.n * self.n
    }

    pub(crate) fn step(self, tape: &mut [f64]) -> StepTape<'_> {
        let n = self.n;
        let (nn, columns) = (n * n, n * self.disturbances);
        let lengths = [self.commands, stages_len(n), nn, nn, columns, n];
        let [held, stages, f, root, columns, after] = pieces(tape, lengths);
        StepTape {
            held,
            stages: Stages::cut(stages, n),
            f,
            root,
            columns,
            after,
        }
    }

    pub(crate) fn sample(self, tape: &mut [f64]) -> SampleTape<'_> {
        let [c, a, z, root] = pieces(tape, [self.n, self.n, self.n, self.n * self.n]);
        SampleTape { c, a, z, root }
    }
}

impl Pass<'_> {
    /// Visits the records in reverse order, each with the tape of its numbers. A step in parts is
    /// replaced by its parts.
    pub(crate) fn walk_back(&self, tape: &mut [f64], mut visit: impl FnMut(&Record, &mut [f64])) {
        let mut again = Self::blank(self.system, self.values, self.run);
        for record in self.records.iter().rev() {
            match record {
                Record::Parts {
                    advance,
                    halvings,
                    tape: at,
                } => {
                    again.begin_at(&mut tape[*at..]);
                    // The forward pass succeeded.
                    let _ = again.advance_in_parts(*advance, 0, *halvings);
                    for part in again.records.iter().rev() {
                        visit(part, &mut again.tape);
                    }
                }
                whole => visit(whole, tape),
            }
        }
    }

    /// Restarts with the inputs, state and root of P on a tape.
    fn begin_at(&mut self, start: &mut [f64]) {
        let Sizes { n, commands, .. } = self.sizes;
        let [held, z, root] = pieces(start, [commands, n, n * n]);
        self.held.copy_from_slice(held);
        self.z.copy_from_slice(z);
        self.root.copy_from_slice(root);
        self.tape.clear();
        self.records.clear();
    }
}
