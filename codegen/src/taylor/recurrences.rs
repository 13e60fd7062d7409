//! Coefficients of order k ≥ 1 of every operation, from those of its operands (Griewank and Walther,
//! *Evaluating Derivatives*, section 13.2; Jorba and Zou, *Experimental Mathematics* 14, 2005).
//!
//! Each is linear in what is new: for c = a b it reads cₖ = a₀ bₖ + b₀ aₖ + Σ aⱼ bₖ₋ⱼ, and the sum over
//! 1 ≤ j < k holds only what is known.

use super::coefficients::{Expansion, derived, plain};
use crate::operations::graph::{Id, Node, Solution};
use crate::schedule::Operation;
use crate::symbolic::{Function, Relation};
use appell_runtime::series::Guard;

impl Expansion {
    /// The coefficient of a node that is not known yet.
    pub(super) fn recurrence(&mut self, id: Id) -> Option<Id> {
        match *self.zero.node(id) {
            Node::Constant(_) => None,
            Node::Argument(argument) => self.of_argument(argument),
            Node::Negate(a) => {
                let a = self.coefficient(a)?;
                Some(self.sweep.negate(a))
            }
            Node::Binary(operation, a, b) => match operation {
                Operation::Add => {
                    let (a, b) = (self.coefficient(a), self.coefficient(b));
                    self.add(a, b)
                }
                Operation::Subtract => {
                    let (a, b) = (self.coefficient(a), self.coefficient(b));
                    self.subtract(a, b)
                }
                Operation::Multiply => self.product(a, b),
                Operation::Divide => self.quotient(id, a, b),
            },
            Node::Function(function, a) => self.function(id, function, a),
            Node::Atan2(y, x) => self.atan2(id, y, x),
            Node::Power(base, exponent) => self.power(id, base, exponent),
            Node::Choice {
                relation,
                compared,
                branches,
            } => self.choice(relation, compared, branches),
            Node::Unknown { solution, .. } => {
                self.system(solution);
                // Told by the system.
                self.coefficient(id)
            }
        }
    }

    /// cₖ = a₀ bₖ + b₀ aₖ + Σ aⱼ bₖ₋ⱼ.
    fn product(&mut self, a: Id, b: Id) -> Option<Id> {
        let (a_k, b_k) = (self.coefficient(a), self.coefficient(b));
        match (a_k, b_k) {
            (None, None) => None,
            (Some(a_k), None) => Some(self.scaled(b, a_k)),
            (None, Some(b_k)) => Some(self.scaled(a, b_k)),
            (Some(a_k), Some(b_k)) => {
                let first = if a == b {
                    let two = self.zero.number(2);
                    let twice = self.zero.multiply(two, a);
                    self.scaled(twice, a_k)
                } else {
                    let (left, right) = (self.scaled(a, b_k), self.scaled(b, a_k));
                    self.sweep.add(left, right)
                };
                let sum = self.sum(plain(a), plain(b));
                Some(self.sweep.add(first, sum))
            }
        }
    }

    /// cₖ = (aₖ − c₀ bₖ − Σ cⱼ bₖ₋ⱼ) / b₀.
    fn quotient(&mut self, c: Id, a: Id, b: Id) -> Option<Id> {
        let (a_k, b_k) = (self.coefficient(a), self.coefficient(b));
        let right = match b_k {
            None => a_k?,
            Some(b_k) => {
                let (first, sum) = (self.scaled(c, b_k), self.sum(plain(c), plain(b)));
                let known = self.sweep.add(first, sum);
                self.subtract(a_k, Some(known))?
            }
        };
        Some(self.over(right, b))
    }

    /// A coefficient over a value of order zero.
    fn over(&mut self, coefficient: Id, divisor: Id) -> Id {
        let inverse = match self.zero.constant(divisor).cloned() {
            Some(number) if !number.is_zero() => self.zero.intern(Node::Constant(number.recip())),
            _ => self.zero.reciprocal(divisor),
        };
        self.scaled(inverse, coefficient)
    }

    fn function(&mut self, id: Id, function: Function, a: Id) -> Option<Id> {
        let a_k = self.coefficient(a)?;
        Some(match function {
            // sin' = cos a'
            Function::Sin => {
                let cos = self.zero_function(Function::Cos, a);
                self.along(cos, a, a_k)
            }
            // cos' = −sin a'
            Function::Cos => {
                let sin = self.zero_function(Function::Sin, a);
                let along = self.along(sin, a, a_k);
                self.sweep.negate(along)
            }
            Function::Sinh => {
                let cosh = self.zero_function(Function::Cosh, a);
                self.along(cosh, a, a_k)
            }
            Function::Cosh => {
                let sinh = self.zero_function(Function::Sinh, a);
                self.along(sinh, a, a_k)
            }
            // exp' = exp a'
            Function::Exp => self.along(id, a, a_k),
            // tanh' = (1 − tanh²) a'
            Function::Tanh => {
                let (one, square) = (self.zero.number(1), self.zero.multiply(id, id));
                let slope = self.zero.subtract(one, square);
                self.along(slope, a, a_k)
            }
            // a ln' = a'
            Function::Ln => self.divided(id, a, a_k),
            // (1 + a²) atan' = a'
            Function::Atan => {
                let (one, square) = (self.zero.number(1), self.zero.multiply(a, a));
                let divisor = self.zero.add(one, square);
                self.divided(id, divisor, a_k)
            }
            // √(1 − a²) asin' = a'
            Function::Asin => {
                let divisor = self.cosine_of_arcsine(a);
                self.divided(id, divisor, a_k)
            }
            Function::Acos => {
                let divisor = self.cosine_of_arcsine(a);
                let minus = self.zero.negate(divisor);
                self.divided(id, minus, a_k)
            }
            // vₖ = (aₖ − Σ vⱼ vₖ₋ⱼ) / 2v₀
            Function::Sqrt => {
                let sum = self.sum(plain(id), plain(id));
                let right = self.sweep.subtract(a_k, sum);
                let two = self.zero.number(2);
                let twice = self.zero.multiply(two, id);
                self.over(right, twice)
            }
            Function::Abs => {
                self.guard(a, Guard::Negative);
                let [zero, one, minus_one] = [0, 1, -1].map(|n| self.zero.number(n));
                let sign = self.zero.intern(Node::Choice {
                    relation: Relation::Less,
                    compared: [a, zero],
                    branches: [minus_one, one],
                });
                self.scaled(sign, a_k)
            }
            Function::Sign => {
                self.guard(a, Guard::Sign);
                return None;
            }
        })
    }

    /// v' = w a': vₖ = w₀ aₖ + 1/k Σ (j aⱼ) wₖ₋ⱼ.
    fn along(&mut self, w: Id, a: Id, a_k: Id) -> Id {
        let (first, mean) = (self.scaled(w, a_k), self.mean(derived(a), plain(w)));
        self.sweep.add(first, mean)
    }

    /// d v' = a': vₖ = (aₖ − 1/k Σ (j vⱼ) dₖ₋ⱼ) / d₀.
    fn divided(&mut self, v: Id, d: Id, a_k: Id) -> Id {
        let mean = self.mean(derived(v), plain(d));
        let right = self.sweep.subtract(a_k, mean);
        self.over(right, d)
    }

    fn cosine_of_arcsine(&mut self, a: Id) -> Id {
        let (one, square) = (self.zero.number(1), self.zero.multiply(a, a));
        let rest = self.zero.subtract(one, square);
        self.zero_function(Function::Sqrt, rest)
    }

    /// d v' = x y' − y x' with d = x² + y².
    fn atan2(&mut self, v: Id, y: Id, x: Id) -> Option<Id> {
        let (y_k, x_k) = (self.coefficient(y), self.coefficient(x));
        let mut right = None;
        if let Some(y_k) = y_k {
            right = Some(self.scaled(x, y_k));
            if x_k.is_some() {
                let mean = self.mean(derived(y), plain(x));
                right = self.add(right, Some(mean));
            }
        }
        if let Some(x_k) = x_k {
            let first = self.scaled(y, x_k);
            right = self.subtract(right, Some(first));
            if y_k.is_some() {
                let mean = self.mean(derived(x), plain(y));
                right = self.subtract(right, Some(mean));
            }
        }
        let (x_square, y_square) = (self.zero.multiply(x, x), self.zero.multiply(y, y));
        let d = self.zero.add(x_square, y_square);
        Some(self.divided(v, d, right?))
    }

    /// a v' = α v a', and exp(α ln a) where the exponent varies.
    fn power(&mut self, v: Id, a: Id, exponent: Id) -> Option<Id> {
        if self.coefficient(exponent).is_some() {
            let ln = self.zero_function(Function::Ln, a);
            let product = self.zero.multiply(exponent, ln);
            let product_k = self.coefficient(product)?;
            return Some(self.along(v, product, product_k));
        }
        let a_k = self.coefficient(a)?;
        let slope = self.zero.multiply(exponent, v);
        let first = self.scaled(slope, a_k);
        let ahead = self.mean(derived(a), plain(v));
        let ahead = self.scaled(exponent, ahead);
        let back = self.mean(derived(v), plain(a));
        let right = self.sweep.add(first, ahead);
        let right = self.sweep.subtract(right, back);
        Some(self.over(right, a))
    }

    /// The coefficient of the branch that holds at order zero.
    fn choice(&mut self, relation: Relation, compared: [Id; 2], branches: [Id; 2]) -> Option<Id> {
        let difference = self.zero.subtract(compared[0], compared[1]);
        self.guard(
            difference,
            match relation {
                Relation::Less => Guard::Negative,
                Relation::LessOrEqual => Guard::NotPositive,
            },
        );
        let branches = branches.map(|branch| self.coefficient(branch));
        if branches == [None, None] {
            return None;
        }
        let zero = self.sweep.number(0);
        let branches = branches.map(|branch| branch.unwrap_or(zero));
        let compared = compared.map(|side| self.kept(side));
        Some(self.sweep.intern(Node::Choice {
            relation,
            compared,
            branches,
        }))
    }

    /// M₀ xₖ = bₖ − Mₖ x₀ − Σ Mⱼ xₖ₋ⱼ, with the inverse of M₀.
    fn system(&mut self, solution: u32) {
        let Solution { matrix, right } = self.zero.solution(solution).clone();
        let (size, entries) = {
            let matrix = self.zero.matrix(matrix);
            (matrix.size, matrix.entries.clone())
        };
        let unknowns = self.zero.solve(matrix, right.clone());
        let mut rows = Vec::new();
        for (row, &b) in entries.chunks(size.max(1)).zip(&right) {
            let mut rest = self.coefficient(b);
            for (&entry, &x) in row.iter().zip(&unknowns) {
                let Some(entry_k) = self.coefficient(entry) else {
                    continue;
                };
                let (first, sum) = (self.scaled(x, entry_k), self.sum(plain(entry), plain(x)));
                let known = self.sweep.add(first, sum);
                rest = self.subtract(rest, Some(known));
            }
            rows.push(rest);
        }
        let columns: Vec<Vec<Id>> = (0..size).map(|column| self.unit(matrix, column)).collect();
        for (i, &unknown) in unknowns.iter().enumerate() {
            let mut coefficient = None;
            for (column, row) in columns.iter().zip(&rows) {
                let term = row.map(|row| self.scaled(column[i], row));
                coefficient = self.add(coefficient, term);
            }
            self.know(unknown, coefficient);
        }
    }

    /// A column of the inverse of a matrix.
    fn unit(&mut self, matrix: u32, column: usize) -> Vec<Id> {
        let size = self.zero.matrix(matrix).size;
        let right = (0..size).map(|row| self.zero.number(i64::from(row == column)));
        let right = right.collect();
        self.zero.solve(matrix, right)
    }
}
