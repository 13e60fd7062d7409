//! Switching functions of inputs that are expressions.

use appell_codegen::mechanics::switches::{Switches, switches};
use appell_codegen::symbolic::Expr;
use appell_codegen::tape::{Tape, enclose};
use appell_runtime::model::{Along, At, ModelInfo, Switching};
use appell_runtime::real::Enclosure;
use appell_runtime::signal::SignalError;
use appell_runtime::switching::Counts;

use crate::formula::{StateFunction, Workbench};

/// The switching functions of expressions.
pub(super) struct InputSwitches {
    counts: Counts,
    answers: StateFunction,
    /// Functions of time: those whose signs are the answers, then those that rise and fall.
    of_time: StateFunction,
    crossings: StateFunction,
}

impl InputSwitches {
    /// Those of some expressions, if these have any.
    pub(super) fn new(
        bench: &Workbench,
        info: &ModelInfo,
        exprs: &[Expr],
    ) -> Result<Option<Self>, SignalError> {
        let mut bench = bench.clone();
        let symbols = bench.symbols.clone();
        let found = switches(&mut bench.graph, &symbols, exprs);
        if found.is_empty() {
            return Ok(None);
        }
        let Switches {
            answers,
            functions,
            shapes,
            crossings,
            pulses,
        } = found;
        Ok(Some(Self {
            counts: Counts {
                answers: answers.len(),
                shapes: shapes.len(),
                crossings: crossings.len(),
                pulses: pulses.len(),
            },
            answers: bench.clone().function(info, answers)?,
            of_time: bench.clone().function(info, [functions, shapes].concat())?,
            crossings: bench.function(info, [crossings, pulses].concat())?,
        }))
    }

    /// The functions of the state whose zeros switch.
    pub(super) fn crossing_tape(&self) -> Tape {
        let mut tape = self.crossings.tape().clone();
        for result in &mut tape.results {
            result.entries.truncate(self.counts.crossings);
        }
        tape
    }
}

/// The switches at the parameters of a motion.
impl Switching for InputSwitches {
    fn counts(&self) -> Counts {
        self.counts
    }

    fn is_of_time_alone(&self) -> bool {
        !self.of_time.tape().has_parameters()
    }

    fn answers(&self, at: At<'_>, answers: &mut [f64]) {
        self.answers.values(at.t, at.x, at.p, answers);
    }

    fn within(&self, time: Enclosure, p: &[f64], functions: &mut [Enclosure]) {
        enclose(self.of_time.tape(), time, p, functions);
    }

    fn crossings(&self, at: At<'_>, crossings: &mut [f64]) {
        self.crossings.values(at.t, at.x, at.p, crossings);
    }

    fn crossings_within(&self, along: &Along<'_>, crossings: &mut [Enclosure]) {
        self.crossings.bounds(along, crossings);
    }
}
