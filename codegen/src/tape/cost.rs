//! Operation counts of a tape.

use std::fmt;

use super::{Arithmetic, Operation, Tape};
use crate::symbolic::Function;

/// Operation counts of a tape.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct OperationCount {
    /// Additions and subtractions.
    pub add: usize,
    /// Multiplications.
    pub multiply: usize,
    /// Divisions.
    pub divide: usize,
    /// Sign changes that no other operation absorbs.
    pub negate: usize,
    /// Pairs of sine and cosine; a lone sine or cosine counts as a pair.
    pub sin_cos: usize,
    /// Other functions.
    pub functions: usize,
    /// Selects between two values.
    pub selects: usize,
    /// Solutions of linear systems; their inner operations are not counted.
    pub solves: usize,
}

impl OperationCount {
    /// Counts the operations of a tape.
    pub fn of(tape: &Tape) -> Self {
        let mut count = Self::default();
        for operation in &tape.operations {
            let counted = match operation {
                Operation::Argument(_)
                | Operation::Constant(_)
                | Operation::Factorise(_)
                | Operation::Part(..) => continue,
                Operation::Negate(_) => &mut count.negate,
                Operation::Binary(Arithmetic::Add | Arithmetic::Subtract, ..) => &mut count.add,
                Operation::Binary(Arithmetic::Multiply, ..) => &mut count.multiply,
                Operation::Binary(Arithmetic::Divide, ..) => &mut count.divide,
                Operation::SinCos(_) | Operation::Function(Function::Sin | Function::Cos, _) => {
                    &mut count.sin_cos
                }
                Operation::Function(..) | Operation::Atan2(..) | Operation::Power(..) => {
                    &mut count.functions
                }
                Operation::Choice { .. } => &mut count.selects,
                Operation::Solve { .. } => &mut count.solves,
            };
            *counted += 1;
        }
        count
    }

    /// `+`, `-`, `*`, `/` and changes of sign, one each.
    pub fn total(&self) -> usize {
        self.add + self.multiply + self.divide + self.negate
    }
}

impl fmt::Display for OperationCount {
    /// `98 (41 +, 53 ×, 4 ÷), sine or cosine of 2 angles`
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.total())?;
        let mut separator = " (";
        for (count, sign) in [
            (self.add, "+"),
            (self.multiply, "×"),
            (self.divide, "÷"),
            (self.negate, "sign"),
        ] {
            if count > 0 {
                write!(f, "{separator}{count} {sign}")?;
                separator = ", ";
            }
        }
        if self.total() > 0 {
            f.write_str(")")?;
        }
        if self.sin_cos > 0 {
            let angles = if self.sin_cos == 1 { "angle" } else { "angles" };
            write!(f, ", sine or cosine of {} {angles}", self.sin_cos)?;
        }
        for (count, one, many) in [
            (self.functions, "function", "functions"),
            (self.selects, "choice", "choices"),
            (self.solves, "linear system", "linear systems"),
        ] {
            if count > 0 {
                write!(f, ", {count} {}", if count == 1 { one } else { many })?;
            }
        }
        Ok(())
    }
}
