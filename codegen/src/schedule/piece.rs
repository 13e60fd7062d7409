//! Expression trees under construction, with their printed width.

use super::monomial::Monomial;
use super::names::{ArgumentNames, joined};
use super::steps::{Operation, Schedule, Tree, Value};
use crate::symbolic::{Function, Relation};

/// Precedence of the outermost operation of a tree.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Level {
    Sum,
    Product,
    Sign,
    Atom,
}

/// A tree with its printed width and precedence.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    pub(super) tree: Tree,
    pub(super) width: usize,
    pub(super) level: Level,
}

impl Piece {
    /// A tree that prints as a name.
    pub(super) fn name(tree: Tree, name: &str) -> Self {
        Self {
            tree,
            width: name.len(),
            level: Level::Atom,
        }
    }

    /// Width including the parentheses required at precedence `level`.
    fn width_at(&self, level: Level) -> usize {
        self.width + if self.level < level { 2 } else { 0 }
    }

    /// Width of `self ∘ right`.
    pub(super) fn width_of_binary(&self, operation: Operation, right: &Self) -> usize {
        let (level, right_level) = levels(operation);
        self.width_at(level) + 3 + right.width_at(right_level)
    }

    /// `self ∘ right`
    pub(super) fn binary(self, operation: Operation, right: Self) -> Self {
        Self {
            width: self.width_of_binary(operation, &right),
            tree: Tree::Binary(operation, Box::new(self.tree), Box::new(right.tree)),
            level: levels(operation).0,
        }
    }

    /// `-self`
    pub(super) fn negated(self) -> Self {
        Self {
            width: 1 + self.width_at(Level::Atom),
            tree: Tree::Negate(Box::new(self.tree)),
            level: Level::Sign,
        }
    }

    /// Whether the tree starts with a negative number.
    pub(super) fn starts_negative(&self) -> bool {
        let mut first = &self.tree;
        while let Tree::Binary(Operation::Multiply | Operation::Divide, a, _) = first {
            first = a;
        }
        matches!(first, Tree::Constant(value) if value.is_negative())
    }

    /// Minus the value, with the sign moved inwards as far as rounding is unaffected.
    pub(super) fn opposite(self) -> Self {
        let width = self.width;
        match self.tree {
            Tree::Constant(value) => Self {
                tree: Tree::Constant(-&value),
                ..self
            },
            Tree::Negate(inner) => Self {
                tree: *inner,
                level: Level::Atom,
                width,
            },
            Tree::Binary(Operation::Subtract, a, b) => {
                let first = Self {
                    tree: *a,
                    width,
                    level: Level::Product,
                };
                let tree = if first.starts_negative() {
                    Tree::Binary(Operation::Add, b, Box::new(first.opposite().tree))
                } else {
                    Tree::Binary(Operation::Subtract, b, Box::new(first.tree))
                };
                Self {
                    tree,
                    width,
                    level: Level::Sum,
                }
            }
            Tree::Binary(operation @ (Operation::Multiply | Operation::Divide), a, b) => {
                let first = Self {
                    tree: *a,
                    width,
                    level: Level::Atom,
                };
                Self {
                    tree: Tree::Binary(operation, Box::new(first.opposite().tree), b),
                    width: width + 1,
                    level: Level::Product,
                }
            }
            tree => Self { tree, ..self }.negated(),
        }
    }

    /// `self.function()`
    pub(super) fn function(self, function: Function) -> Self {
        Self {
            width: self.width_at(Level::Atom) + method(function).len() + 3,
            tree: Tree::Function(function, Box::new(self.tree)),
            level: Level::Atom,
        }
    }

    /// `self.atan2(x)`
    pub(super) fn atan2(self, x: Self) -> Self {
        Self {
            width: self.width_at(Level::Atom) + x.width + ".atan2()".len(),
            tree: Tree::Atan2(Box::new(self.tree), Box::new(x.tree)),
            level: Level::Atom,
        }
    }

    /// `self.powf(exponent)`
    pub(super) fn power(self, exponent: Self) -> Self {
        Self {
            width: self.width_at(Level::Atom) + exponent.width + ".powf()".len(),
            tree: Tree::Power(Box::new(self.tree), Box::new(exponent.tree)),
            level: Level::Atom,
        }
    }

    /// Compared left and right sides, value if the relation holds, value otherwise.
    pub(super) fn choice(relation: Relation, operands: [Self; 4]) -> Self {
        let width: usize = operands.iter().map(|operand| operand.width).sum();
        let [left, right, then, otherwise] = operands.map(|operand| operand.tree);
        Self {
            tree: Tree::Choice {
                relation,
                compared: Box::new([left, right]),
                branches: Box::new([then, otherwise]),
            },
            width: width + "T::if_less_or_equal(, , , )".len(),
            level: Level::Atom,
        }
    }
}

/// Precedences that an operation requires of its left and right operand.
fn levels(operation: Operation) -> (Level, Level) {
    match operation {
        Operation::Add | Operation::Subtract => (Level::Sum, Level::Product),
        Operation::Multiply | Operation::Divide => (Level::Product, Level::Sign),
    }
}

/// Method name of a function.
pub(crate) fn method(function: Function) -> &'static str {
    match function {
        Function::Sin => "sin",
        Function::Cos => "cos",
        Function::Asin => "asin",
        Function::Acos => "acos",
        Function::Atan => "atan",
        Function::Sinh => "sinh",
        Function::Cosh => "cosh",
        Function::Tanh => "tanh",
        Function::Exp => "exp",
        Function::Ln => "ln",
        Function::Sqrt => "sqrt",
        Function::Abs => "abs",
        Function::Sign => "sign",
    }
}

/// A short name that describes the operation of a value, if there is one: `R_squared`, `m_R`,
/// `inv_D`, `tan_theta`, `a_minus_b`. `products` marks the values that are products.
pub(super) fn describe(
    tree: &Tree,
    values: &[String],
    products: &[Option<Monomial>],
    arguments: &ArgumentNames,
) -> Option<String> {
    if let Some(monomial) = Monomial::of(tree, products) {
        return monomial.name(values, arguments);
    }
    if let Some(name) = angle_sum(tree, values) {
        return joined(&[&name]);
    }
    let inner = |tree: &Tree| describe(tree, values, products, arguments);
    match tree {
        Tree::Negate(a) => joined(&["minus", &inner(a)?]),
        Tree::Function(function, a) => joined(&[method(*function), &inner(a)?]),
        Tree::Binary(operation, a, b) => {
            let (left, right) = (inner(a)?, inner(b)?);
            match operation {
                Operation::Add => joined(&[&left, "plus", &right]),
                Operation::Subtract => joined(&[&left, "minus", &right]),
                Operation::Multiply => joined(&[&left, &right]),
                Operation::Divide => joined(&[&left, "over", &right]),
            }
        }
        _ => None,
    }
}

/// `sin_a_minus_b` and the like for a tree expanded by an addition theorem.
fn angle_sum(tree: &Tree, values: &[String]) -> Option<String> {
    let Tree::Binary(operation @ (Operation::Add | Operation::Subtract), left, right) = tree else {
        return None;
    };
    // Function and angle of both factors.
    let factors = |tree: &Tree| {
        let Tree::Binary(Operation::Multiply, a, b) = tree else {
            return None;
        };
        let factor = |tree: &Tree| {
            let Tree::Value(Value(value)) = tree else {
                return None;
            };
            values.get(*value as usize)?.split_once('_')
        };
        Some([factor(a)?, factor(b)?])
    };
    let ([(f, a), (g, b)], right) = (factors(left)?, factors(right)?);
    let swapped = [right[1], right[0]];
    let opposite = |function: &str| if function == "sin" { "cos" } else { "sin" };
    let partner = [(opposite(f), a), (opposite(g), b)];
    if a == b || (right != partner && swapped != partner) {
        return None;
    }
    let plus = *operation == Operation::Add;
    match (f, g, plus) {
        ("sin", "cos", true) | ("cos", "sin", true) => Some(format!("sin_{a}_plus_{b}")),
        ("sin", "cos", false) => Some(format!("sin_{a}_minus_{b}")),
        ("cos", "sin", false) => Some(format!("sin_{b}_minus_{a}")),
        ("cos", "cos", false) => Some(format!("cos_{a}_plus_{b}")),
        ("cos", "cos", true) | ("sin", "sin", true) => {
            Some(format!("cos_{}_minus_{}", a.min(b), a.max(b)))
        }
        _ => None,
    }
}

/// A tree as text, for comments and dumps.
pub(crate) fn text(tree: &Tree, schedule: &Schedule, arguments: &ArgumentNames) -> String {
    let mut out = String::new();
    write(&mut out, tree, Level::Sum, &schedule.names, arguments);
    out
}

fn write(
    out: &mut String,
    tree: &Tree,
    least: Level,
    values: &[String],
    arguments: &ArgumentNames,
) {
    let level = match tree {
        Tree::Binary(Operation::Add | Operation::Subtract, ..) => Level::Sum,
        Tree::Binary(..) => Level::Product,
        Tree::Negate(_) => Level::Sign,
        _ => Level::Atom,
    };
    let parentheses = level < least;
    if parentheses {
        out.push('(');
    }
    match tree {
        Tree::Value(Value(value)) => out.push_str(&values[*value as usize]),
        Tree::Argument(argument) => out.push_str(arguments.get(*argument)),
        Tree::Constant(value) => out.push_str(&value.to_string()),
        Tree::Negate(a) => {
            out.push('-');
            write(out, a, Level::Atom, values, arguments);
        }
        Tree::Binary(operation, a, b) => {
            let (sign, right) = match operation {
                Operation::Add => (" + ", Level::Product),
                Operation::Subtract => (" - ", Level::Product),
                Operation::Multiply => (" ", Level::Sign),
                Operation::Divide => ("/", Level::Sign),
            };
            write(out, a, level, values, arguments);
            out.push_str(sign);
            write(out, b, right, values, arguments);
        }
        Tree::Function(function, a) => call(out, method(*function), &[a], values, arguments),
        Tree::Atan2(y, x) => call(out, "atan2", &[y, x], values, arguments),
        Tree::Power(base, exponent) => call(out, "pow", &[base, exponent], values, arguments),
        Tree::Choice {
            compared, branches, ..
        } => {
            let all = [&compared[0], &compared[1], &branches[0], &branches[1]];
            call(out, "if_less", &all, values, arguments);
        }
    }
    if parentheses {
        out.push(')');
    }
}

fn call(out: &mut String, name: &str, of: &[&Tree], values: &[String], arguments: &ArgumentNames) {
    out.push_str(name);
    out.push('(');
    for (i, tree) in of.iter().enumerate() {
        if i > 0 {
            out.push_str(", ");
        }
        write(out, tree, Level::Sum, values, arguments);
    }
    out.push(')');
}
