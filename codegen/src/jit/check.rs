//! Checks the assumptions of the translation before it starts.

use appell_runtime::model::ModelInfo;

use super::JitError;
use crate::tape::{Argument, Operation, Tape, Value};

/// The longest function that is compiled. Beyond it compilation takes more than a second, and the frame may
/// need most of a thread's stack.
pub const MOST_OPERATIONS: usize = 100_000;
/// The largest linear system; its factors live on the stack.
pub const MOST_ROWS: usize = 64;

/// Arguments beyond it cannot be addressed by a load with a constant offset.
const MOST_ARGUMENTS: usize = 1 << 24;

/// A tape that can be translated: operands come before their users, parts directly after the operation that
/// computes them, systems have consistent sizes, and the limits hold.
#[derive(Debug)]
pub struct Checked<'a> {
    pub(super) tape: &'a Tape,
    sizes: Sizes,
    /// Operations, without arguments, numbers and parts.
    pub(super) operations: usize,
    /// Rows of the largest system.
    pub(super) rows: usize,
    /// The number of weights used, counted from the first.
    pub(super) weights: usize,
}

impl Checked<'_> {
    /// The tape.
    pub fn tape(&self) -> &Tape {
        self.tape
    }

    /// The number of weights used, counted from the first.
    pub fn weights(&self) -> usize {
        self.weights
    }
}

/// Lengths of the arguments of a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sizes {
    /// States.
    pub states: usize,
    /// Inputs with the signals.
    pub inputs: usize,
    /// Parameters.
    pub parameters: usize,
}

impl From<&ModelInfo> for Sizes {
    fn from(info: &ModelInfo) -> Self {
        Self {
            states: info.state_len(),
            inputs: info.input_len(),
            parameters: info.parameter_len(),
        }
    }
}

/// Checks a tape of a model with arguments of these sizes.
pub fn check(tape: &Tape, sizes: Sizes) -> Result<Checked<'_>, JitError> {
    let mut checked = Checked {
        tape,
        sizes,
        operations: 0,
        rows: 0,
        weights: 0,
    };
    for (place, operation) in (0..).map(Value).zip(&tape.operations) {
        checked.operation(place, operation)?;
    }
    let end = Value(u32::try_from(tape.operations.len()).unwrap_or(u32::MAX));
    for result in &tape.results {
        checked.count(result.entries.len())?;
        checked.numbers(&result.entries, end)?;
    }
    Ok(checked)
}

impl Checked<'_> {
    fn operation(&mut self, place: Value, operation: &Operation) -> Result<(), JitError> {
        match operation {
            Operation::Argument(argument) => self.argument(*argument),
            Operation::Constant(_) => Ok(()),
            Operation::Negate(_)
            | Operation::Binary(..)
            | Operation::Function(..)
            | Operation::Atan2(..)
            | Operation::Power(..) => {
                self.count(1)?;
                self.numbers(&operation.operands(), place)
            }
            Operation::Choice { .. } => {
                self.count(2)?;
                self.numbers(&operation.operands(), place)
            }
            Operation::SinCos(_) => {
                self.count(2)?;
                self.numbers(&operation.operands(), place)?;
                self.parts(place, 2)
            }
            Operation::Factorise(matrix) => self.factorise(place, matrix),
            Operation::Solve {
                factorisation,
                right,
            } => self.solve(place, *factorisation, right),
            Operation::Part(whole, index) => {
                let is_part = *whole < place
                    && whole.part(*index) == place
                    && (*index as usize) < self.tape.operation(*whole).parts();
                ensure(is_part, || JitError::MisplacedPart { value: place.0 })
            }
        }
    }

    fn factorise(&mut self, place: Value, matrix: &[Value]) -> Result<(), JitError> {
        let rows = matrix.len().isqrt();
        let most = MOST_ROWS;
        ensure(rows <= most, || JitError::TooManyRows { rows, most })?;
        shape(place, (rows * rows).max(1), matrix.len())?;
        // Includes the factors: each factorisation has its own on the stack.
        self.count(3 * matrix.len())?;
        self.rows = self.rows.max(rows);
        self.numbers(matrix, place)
    }

    fn solve(
        &mut self,
        place: Value,
        factorisation: Value,
        right: &[Value],
    ) -> Result<(), JitError> {
        let earlier = (factorisation < place).then(|| self.tape.operation(factorisation));
        let Some(Operation::Factorise(matrix)) = earlier else {
            return Err(JitError::NotAFactorisation {
                value: factorisation.0,
            });
        };
        shape(place, matrix.len().isqrt(), right.len())?;
        self.count(right.len())?;
        self.numbers(right, place)?;
        self.parts(place, right.len())
    }

    /// All parts of an operation follow it.
    fn parts(&self, whole: Value, count: usize) -> Result<(), JitError> {
        let next = self.tape.operations.iter().skip(whole.index() + 1);
        let found = next.zip(0..).take(count);
        let found = found.filter(|&(part, index)| *part == Operation::Part(whole, index));
        ensure(found.count() == count, || JitError::MisplacedPart {
            value: whole.0,
        })
    }

    fn count(&mut self, operations: usize) -> Result<(), JitError> {
        self.operations += operations;
        let (operations, most) = (self.operations, MOST_OPERATIONS);
        ensure(operations <= most, || JitError::TooManyOperations {
            operations,
            most,
        })
    }

    /// Operands are numbers computed before `place`.
    fn numbers(&self, operands: &[Value], place: Value) -> Result<(), JitError> {
        let is_number = |value: Value| self.tape.operation(value).is_number();
        match operands
            .iter()
            .find(|&&value| value >= place || !is_number(value))
        {
            Some(value) => Err(JitError::UndefinedValue { value: value.0 }),
            None => Ok(()),
        }
    }

    fn argument(&mut self, argument: Argument) -> Result<(), JitError> {
        let (what, index, len) = match argument {
            Argument::Time => return Ok(()),
            Argument::State(index) => ("state", index, self.sizes.states),
            Argument::Input(index) => ("input", index, self.sizes.inputs),
            Argument::Parameter(index) => ("parameter", index, self.sizes.parameters),
            Argument::Weight(index)
            | Argument::OutputWeight(index)
            | Argument::Acceleration(index) => {
                // Every call must supply as many weights.
                self.weights = self.weights.max(index as usize + 1);
                ("weight", index, MOST_ARGUMENTS)
            }
        };
        let index = index as usize;
        let exists = index < len.min(MOST_ARGUMENTS);
        ensure(exists, || JitError::UnknownArgument { what, index, len })
    }
}

fn shape(place: Value, expected: usize, found: usize) -> Result<(), JitError> {
    ensure(expected == found, || JitError::SystemShape {
        value: place.0,
        expected,
        found,
    })
}

fn ensure(holds: bool, error: impl FnOnce() -> JitError) -> Result<(), JitError> {
    if holds { Ok(()) } else { Err(error()) }
}
