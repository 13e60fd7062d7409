//! Equations of motion with their inputs put in, for eight motions at once.

use appell_codegen::jit::{Elementary, JitError, Sizes, Target, VectorFunction};
use appell_codegen::operations::{Seen, closed_loop};
use appell_codegen::schedule::Schedule;

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

/// The equations under expressions and laws. They call the elementary functions of the runtime, so that they have the
/// same bits on every machine.
pub(crate) struct ClosedLoop {
    pub(crate) rates: VectorFunction,
    inputs: usize,
    is_driven: bool,
}

impl ClosedLoop {
    pub(super) fn new(
        law: &Schedule,
        rates: &Schedule,
        sizes: Sizes,
        (outside, seen): (Outside, &[Onto]),
    ) -> Result<Self, JitError> {
        let views = seen.iter().zip(outside.inputs..);
        let views: Vec<Seen> = views.map(|(onto, by)| onto.seen(by)).collect();
        let sizes = Sizes {
            inputs: outside.inputs + seen.len(),
            ..sizes
        };
        let target = Target {
            elementary: Elementary::Own,
            ..Target::default()
        };
        let rates = closed_loop(law, rates, &views);
        Ok(Self {
            rates: VectorFunction::compile_or_interpret(&rates, sizes, target)?,
            inputs: sizes.inputs,
            is_driven: outside.is_there || !seen.is_empty(),
        })
    }

    /// How many inputs it has: those from outside, then the disturbances of what laws see.
    pub(crate) fn inputs(&self) -> usize {
        self.inputs
    }

    /// Whether one of the inputs is ever different from zero.
    pub(crate) fn is_driven(&self) -> bool {
        self.is_driven
    }
}

impl Onto {
    /// The disturbance as an input of the whole.
    fn seen(self, by: usize) -> Seen {
        let by = index(by);
        match self {
            Self::Measured(state) => Seen::Disturbed {
                state: index(state),
                by,
            },
            Self::Parameter(parameter) => Seen::Replaced {
                parameter: index(parameter),
                by,
            },
        }
    }
}

fn index(place: usize) -> u32 {
    u32::try_from(place).unwrap_or(u32::MAX)
}
