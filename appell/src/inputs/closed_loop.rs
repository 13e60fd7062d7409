//! Equations of motion with their inputs put in, for eight motions at once.

use appell_codegen::jit::{Elementary, Sizes, Target, VectorFunction};
use appell_codegen::operations::{Seen, closed_loop};
use appell_codegen::schedule::{Schedule, interpret};
use appell_runtime::lanes::{AtLanes, LANES, place_by_place};

/// What a disturbance of the law's view acts on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Onto {
    /// A state, as laws and inputs measure it: the disturbance is added.
    Measured(usize),
    /// A parameter of laws alone: the disturbance takes its place.
    Parameter(usize),
}

/// What drives a closed loop from outside.
#[derive(Debug, Clone, Copy)]
pub(super) struct Outside {
    /// How many inputs there are.
    pub(super) inputs: usize,
    /// Whether one of them is ever different from zero.
    pub(super) is_there: bool,
}

/// The rates under expressions and laws. They call the elementary functions of the runtime, so that they have the
/// same bits on every machine.
pub(crate) struct ClosedLoop {
    how: How,
    inputs: usize,
    is_driven: bool,
}

enum How {
    Vector(VectorFunction),
    /// What is too long to be compiled.
    Interpreted(Schedule),
}

impl ClosedLoop {
    pub(super) fn new(
        law: &Schedule,
        rates: &Schedule,
        sizes: Sizes,
        outside: Outside,
        seen: &[Onto],
    ) -> Self {
        let views = seen.iter().zip(outside.inputs..).map(|(onto, by)| {
            let by = index(by);
            match *onto {
                Onto::Measured(state) => Seen::Disturbed {
                    state: index(state),
                    by,
                },
                Onto::Parameter(parameter) => Seen::Replaced {
                    parameter: index(parameter),
                    by,
                },
            }
        });
        let schedule = closed_loop(law, rates, &views.collect::<Vec<_>>());
        let sizes = Sizes {
            inputs: outside.inputs + seen.len(),
            ..sizes
        };
        let target = Target {
            elementary: Elementary::Own,
            ..Target::default()
        };
        Self {
            how: match VectorFunction::compile_for(&schedule, sizes, target) {
                Ok(vector) => How::Vector(vector),
                Err(_) => How::Interpreted(schedule),
            },
            inputs: sizes.inputs,
            is_driven: outside.is_there || !seen.is_empty(),
        }
    }

    /// How many inputs it has: those from outside, then the disturbances of what laws see.
    pub(crate) fn inputs(&self) -> usize {
        self.inputs
    }

    /// Whether one of the inputs is ever different from zero.
    pub(crate) fn is_driven(&self) -> bool {
        self.is_driven
    }

    /// Rates at eight places.
    pub(crate) fn rates(&self, at: AtLanes<'_>, rates: &mut [[f64; LANES]]) {
        match &self.how {
            How::Vector(vector) => vector.call(at, [rates]),
            How::Interpreted(schedule) => {
                place_by_place(at, [rates], |t, [x, u, p], [rates]| {
                    rates.copy_from_slice(&interpret(schedule, t, x, u, p)[0]);
                });
            }
        }
    }
}

fn index(place: usize) -> u32 {
    u32::try_from(place).unwrap_or(u32::MAX)
}
