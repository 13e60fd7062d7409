//! Operation counts of a schedule.

use std::fmt;

use super::steps::{Operation, Schedule, Step, Tree};
use crate::symbolic::Function;

/// Operation counts of a schedule.
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
    /// Counts the operations of a schedule.
    pub fn of(schedule: &Schedule) -> Self {
        let mut count = Self::default();
        for step in &schedule.steps {
            match step {
                Step::Let { tree, .. } => count.tree(tree),
                Step::SinCos { angle, .. } => {
                    count.sin_cos += 1;
                    count.tree(angle);
                }
                Step::Factor { matrix, .. } => {
                    for tree in matrix {
                        count.tree(tree);
                    }
                }
                Step::Solve { right, .. } => {
                    count.solves += 1;
                    for tree in right {
                        count.tree(tree);
                    }
                }
                Step::Paragraph { .. } => {}
            }
        }
        for tree in schedule.results.iter().flat_map(|array| &array.entries) {
            count.tree(tree);
        }
        count
    }

    /// `+`, `-`, `*`, `/` and changes of sign, one each.
    pub fn total(&self) -> usize {
        self.add + self.multiply + self.divide + self.negate
    }

    fn tree(&mut self, tree: &Tree) {
        let mut rest = vec![tree];
        while let Some(tree) = rest.pop() {
            match tree {
                Tree::Value(_) | Tree::Argument(_) | Tree::Constant(_) => {}
                Tree::Negate(a) => {
                    self.negate += 1;
                    rest.push(a);
                }
                Tree::Binary(operation, a, b) => {
                    match operation {
                        Operation::Add | Operation::Subtract => self.add += 1,
                        Operation::Multiply => self.multiply += 1,
                        Operation::Divide => self.divide += 1,
                    }
                    rest.extend([&**a, &**b]);
                }
                Tree::Function(function, a) => {
                    match function {
                        Function::Sin | Function::Cos => self.sin_cos += 1,
                        _ => self.functions += 1,
                    }
                    rest.push(a);
                }
                Tree::Atan2(a, b) | Tree::Power(a, b) => {
                    self.functions += 1;
                    rest.extend([&**a, &**b]);
                }
                Tree::Choice {
                    compared, branches, ..
                } => {
                    self.selects += 1;
                    rest.extend(compared.iter().chain(branches.iter()));
                }
            }
        }
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
