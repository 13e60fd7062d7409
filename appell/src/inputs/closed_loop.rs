//! Equations of motion with their inputs substituted, for eight motions at once.

use appell_codegen::jit::{Elementary, Sizes};
use appell_codegen::tape::{Seen, Tape, closed_loop};
use appell_vector::{Target, VectorError, VectorFunction};

/// Target of a disturbance in the measurements of laws.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Onto {
    /// A measured state: the disturbance is added.
    Measured(usize),
    /// A parameter of laws alone: the disturbance replaces it.
    Parameter(usize),
}

/// External inputs of a closed loop.
#[derive(Debug, Clone, Copy)]
pub(super) struct Outside {
    /// Number of inputs.
    pub(super) inputs: usize,
    /// Whether any of them is ever nonzero.
    pub(super) is_there: bool,
}

/// The equations with expressions and laws. They call the elementary functions of the runtime, so that results agree
/// bit by bit on every machine.
pub(crate) struct ClosedLoop {
    pub(crate) rates: VectorFunction,
    inputs: usize,
    is_driven: bool,
}

impl ClosedLoop {
    pub(super) fn new(
        law: &Tape,
        rates: &Tape,
        sizes: Sizes,
        outside: Outside,
        seen: &[Onto],
    ) -> Result<Self, VectorError> {
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

    /// Number of its inputs: external ones, then disturbances of the measurements.
    pub(crate) fn inputs(&self) -> usize {
        self.inputs
    }

    /// Whether any of the inputs is ever nonzero.
    pub(crate) fn is_driven(&self) -> bool {
        self.is_driven
    }
}

impl Onto {
    /// The disturbance as an input of the closed loop.
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
