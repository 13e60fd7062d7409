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
    /// A step in parts, `parts` or more. Only its start is kept at `tape`, to save memory; sweeps recompute the parts.
    Parts {
        advance: Advance,
        parts: u32,
        tape: usize,
    },
    /// Scalars that were measured at one time, and the inputs then, where outputs were.
    Measure {
        /// The row, unless it was a delayed channel alone.
        row: Option<usize>,
        samples: Range<usize>,
        held: Vec<f64>,
        /// Inputs that lag, with the derivatives by their time constants, where those of outputs are not those of the motion.
        lags: Vec<[f64; 2]>,
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
        for record in self.records.iter().rev() {
            if let Some(mut parts) = self.in_parts(record, tape) {
                for part in parts.records.iter().rev() {
                    visit(part, &mut parts.tape);
                }
            } else {
                visit(record, tape);
            }
        }
    }

    /// The parts of a step of which the tape has the start only.
    pub(crate) fn in_parts(&self, record: &Record, tape: &mut [f64]) -> Option<Self> {
        let Record::Parts {
            advance,
            parts,
            tape: at,
        } = *record
        else {
            return None;
        };
        let mut again = Self::blank(self.system, self.values, self.run);
        again.is_disturbed = self.is_disturbed;
        let Sizes { n, commands, .. } = self.sizes;
        let [held, z, root] = pieces(&mut tape[at..], [commands, n, n * n]);
        again.held.copy_from_slice(held);
        again.z.copy_from_slice(z);
        again.root.copy_from_slice(root);
        // The forward pass succeeded.
        let _ = again.advance_in_parts(advance, 1, parts);
        Some(again)
    }
}
