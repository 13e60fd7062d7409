//! Partial evaluation of a tape for parameters that are zero.
//!
//! Adding zero and multiplying by one are exact, so the results are those of the full tape except for the sign of
//! zero, products of zero with a non-finite value, zero over zero, and singular systems whose right-hand side is zero.

use super::{Argument, Arithmetic, Operation, Tape, Value};
use crate::symbolic::{Function, Rational};

impl Tape {
    /// The residual tape where the parameters for which `is_zero` holds are zero.
    #[must_use]
    pub fn without(&self, is_zero: impl Fn(usize) -> bool) -> Self {
        let mut folded = Folded {
            tape: Self::default(),
            values: Vec::with_capacity(self.operations.len()),
        };
        for (operation, name) in self.operations.iter().zip(&self.names) {
            let before = folded.tape.operations.len();
            let value = folded.value(operation, &is_zero);
            if value.index() >= before {
                folded.tape.names[value.index()].clone_from(name);
            }
            folded.values.push(value);
        }
        let Folded { mut tape, values } = folded;
        let results = self.results.iter();
        let results = results.map(|result| result.map(|entry| values[entry.index()]));
        tape.results = results.collect();
        tape.live()
    }
}

/// Constant and copy propagation.
struct Folded {
    tape: Tape,
    /// The new values.
    values: Vec<Value>,
}

impl Folded {
    /// The value of an operation of the full tape.
    fn value(&mut self, operation: &Operation, is_zero: impl Fn(usize) -> bool) -> Value {
        let operation = operation.map_operands(|operand| self.values[operand.index()]);
        match operation {
            Operation::Argument(Argument::Parameter(index)) if is_zero(index as usize) => {
                self.number(0)
            }
            Operation::Negate(a) => self.negated(a),
            Operation::Binary(operation, a, b) => self.binary(operation, a, b),
            Operation::Function(function, a) if self.is(a, 0) => self.at_zero(function, a),
            Operation::Choice {
                branches: [then, otherwise],
                ..
            } if then == otherwise || self.are_equal_leaves(then, otherwise) => then,
            Operation::Part(whole, index) => self.part(whole, index),
            other => self.tape.push_alone(other),
        }
    }

    fn negated(&mut self, a: Value) -> Value {
        match *self.tape.operation(a) {
            Operation::Negate(inner) => inner,
            _ if self.is(a, 0) => a,
            _ => self.tape.push(Operation::Negate(a)),
        }
    }

    fn binary(&mut self, operation: Arithmetic, a: Value, b: Value) -> Value {
        let zeros = [self.is(a, 0), self.is(b, 0)];
        match (operation, zeros) {
            (Arithmetic::Add, [true, _]) => b,
            (Arithmetic::Add | Arithmetic::Subtract, [_, true]) => a,
            (Arithmetic::Subtract, [true, _]) => self.negated(b),
            (Arithmetic::Multiply, [true, _] | [_, true]) | (Arithmetic::Divide, [true, false]) => {
                self.number(0)
            }
            (Arithmetic::Multiply, _) if self.is(a, 1) => b,
            (Arithmetic::Multiply | Arithmetic::Divide, _) if self.is(b, 1) => a,
            _ => self.tape.binary(operation, a, b),
        }
    }

    /// A function of a value that is zero.
    fn at_zero(&mut self, function: Function, zero: Value) -> Value {
        match function {
            Function::Sin
            | Function::Asin
            | Function::Atan
            | Function::Sinh
            | Function::Tanh
            | Function::Sqrt
            | Function::Abs
            | Function::Sign => zero,
            Function::Cos | Function::Cosh | Function::Exp => self.number(1),
            _ => self.tape.push(Operation::Function(function, zero)),
        }
    }

    /// A part of a sine and cosine, or of the solution of a system.
    fn part(&mut self, whole: Value, index: u32) -> Value {
        match self.tape.operation(whole) {
            Operation::SinCos(angle) if self.is(*angle, 0) => self.number(index.into()),
            Operation::Solve { right, .. } if right.iter().all(|&entry| self.is(entry, 0)) => {
                self.number(0)
            }
            _ => self.tape.push(Operation::Part(whole, index)),
        }
    }

    fn number(&mut self, number: i64) -> Value {
        self.tape.constant(Rational::from(number))
    }

    fn is(&self, value: Value, number: i64) -> bool {
        match (self.tape.operation(value), number) {
            (Operation::Constant(constant), 0) => constant.is_zero(),
            (Operation::Constant(constant), 1) => constant.is_one(),
            _ => false,
        }
    }

    fn are_equal_leaves(&self, a: Value, b: Value) -> bool {
        let a = self.tape.operation(a);
        a.is_leaf() && a == self.tape.operation(b)
    }
}
