//! Checks the assumptions of the translation before it starts.

use appell_runtime::model::ModelInfo;
use rustc_hash::FxHashMap;

use super::JitError;
use crate::schedule::{Argument, ResultArray, Schedule, Step, Tree, Value};

/// The longest function that is compiled. Beyond it compilation takes more than a second, and the frame may
/// need most of a thread's stack.
pub const MOST_OPERATIONS: usize = 100_000;
/// The deepest nesting of an expression.
pub const MOST_DEPTH: usize = 500;
/// The largest linear system; its factors live on the stack.
pub const MOST_ROWS: usize = 64;

/// Arguments beyond it cannot be addressed by a load with a constant offset.
const MOST_ARGUMENTS: usize = 1 << 24;

/// A schedule that can be translated: values and factorisations are defined before they are used, systems have
/// consistent sizes, and the limits hold.
#[derive(Debug)]
pub(super) struct Checked<'a> {
    pub(super) schedule: &'a Schedule,
    /// Rows of the factorisations, by their number.
    pub(super) rows: FxHashMap<u32, usize>,
    /// The number of weights used, counted from the first.
    pub(super) weights: usize,
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

/// Checks a schedule of a model with arguments of these sizes.
pub(super) fn check(schedule: &Schedule, sizes: Sizes) -> Result<Checked<'_>, JitError> {
    let mut checker = Checker {
        sizes,
        defined: vec![false; schedule.names.len()],
        operations: 0,
        rows: FxHashMap::default(),
        weights: 0,
    };
    for step in &schedule.steps {
        checker.step(step)?;
    }
    for ResultArray { entries, .. } in &schedule.results {
        checker.trees(entries)?;
    }
    Ok(Checked {
        schedule,
        rows: checker.rows,
        weights: checker.weights,
    })
}

/// Lengths of the results of a schedule.
pub(super) fn lengths(schedule: &Schedule) -> Vec<usize> {
    schedule
        .results
        .iter()
        .map(|result| result.entries.len())
        .collect()
}

struct Checker {
    sizes: Sizes,
    defined: Vec<bool>,
    operations: usize,
    rows: FxHashMap<u32, usize>,
    weights: usize,
}

impl Checker {
    fn step(&mut self, step: &Step) -> Result<(), JitError> {
        match step {
            Step::Let { value, tree } => {
                self.tree(tree, 0)?;
                self.define(*value)
            }
            Step::SinCos { sin, cos, angle } => {
                self.count(2)?;
                self.tree(angle, 0)?;
                self.define(*sin)?;
                self.define(*cos)
            }
            Step::Factor {
                factorisation,
                size,
                matrix,
            } => self.factor(*factorisation, *size, matrix),
            Step::Solve {
                factorisation,
                values,
                right,
            } => self.solve(*factorisation, values, right),
            Step::Paragraph { .. } => Ok(()),
        }
    }

    fn factor(&mut self, factorisation: u32, rows: usize, matrix: &[Tree]) -> Result<(), JitError> {
        if rows > MOST_ROWS {
            return Err(JitError::TooManyRows {
                rows,
                most: MOST_ROWS,
            });
        }
        shape(factorisation, rows * rows, matrix.len())?;
        // Includes the factors: each factorisation has its own on the stack.
        self.count(2 * rows * rows)?;
        self.trees(matrix)?;
        self.rows.insert(factorisation, rows);
        Ok(())
    }

    fn solve(
        &mut self,
        factorisation: u32,
        values: &[Value],
        right: &[Tree],
    ) -> Result<(), JitError> {
        let Some(&rows) = self.rows.get(&factorisation) else {
            return Err(JitError::UndefinedFactorisation { factorisation });
        };
        shape(factorisation, rows, right.len())?;
        shape(factorisation, rows, values.len())?;
        self.trees(right)?;
        values.iter().try_for_each(|&value| self.define(value))
    }

    fn define(&mut self, Value(value): Value) -> Result<(), JitError> {
        match self.defined.get_mut(value as usize) {
            Some(defined) => {
                *defined = true;
                Ok(())
            }
            None => Err(JitError::UndefinedValue { value }),
        }
    }

    fn count(&mut self, operations: usize) -> Result<(), JitError> {
        self.operations += operations;
        if self.operations > MOST_OPERATIONS {
            return Err(JitError::TooManyOperations {
                operations: self.operations,
                most: MOST_OPERATIONS,
            });
        }
        Ok(())
    }

    /// Trees that are stored in memory.
    fn trees(&mut self, trees: &[Tree]) -> Result<(), JitError> {
        self.count(trees.len())?;
        trees.iter().try_for_each(|tree| self.tree(tree, 0))
    }

    fn tree(&mut self, tree: &Tree, depth: usize) -> Result<(), JitError> {
        if depth > MOST_DEPTH {
            return Err(JitError::TooDeep { most: MOST_DEPTH });
        }
        let below = depth + 1;
        match tree {
            Tree::Constant(_) => Ok(()),
            Tree::Value(Value(value)) => match self.defined.get(*value as usize) {
                Some(true) => Ok(()),
                _ => Err(JitError::UndefinedValue { value: *value }),
            },
            Tree::Argument(argument) => self.argument(*argument),
            Tree::Negate(a) | Tree::Function(_, a) => {
                self.count(1)?;
                self.tree(a, below)
            }
            Tree::Binary(_, a, b) | Tree::Atan2(a, b) | Tree::Power(a, b) => {
                self.count(1)?;
                self.tree(a, below)?;
                self.tree(b, below)
            }
            Tree::Choice {
                compared, branches, ..
            } => {
                self.count(2)?;
                compared
                    .iter()
                    .chain(branches.iter())
                    .try_for_each(|tree| self.tree(tree, below))
            }
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
        if index < len.min(MOST_ARGUMENTS) {
            Ok(())
        } else {
            Err(JitError::UnknownArgument { what, index, len })
        }
    }
}

fn shape(factorisation: u32, expected: usize, found: usize) -> Result<(), JitError> {
    if expected == found {
        Ok(())
    } else {
        Err(JitError::SystemShape {
            factorisation,
            expected,
            found,
        })
    }
}
