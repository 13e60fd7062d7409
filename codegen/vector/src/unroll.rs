//! Unrolls the linear systems of a tape and eliminates common subexpressions.
//!
//! Operations and their association are those of the tape: each lane is bit-identical to the scalar code.
//! Only bit-identical rewritings are applied, such as `a + (-b)` to `a - b`.

use appell_codegen::symbolic::{Function, Rational, Relation};
use appell_codegen::tape::{Arithmetic, Operation, Tape, Unique, Value};
use rustc_hash::FxHashMap;

/// Larger systems are solved by a routine, lane by lane.
const MOST_ROWS_UNROLLED: usize = 12;

/// A checked tape without small systems and without signs, which are choices.
pub(crate) fn unrolled(tape: &Tape) -> Tape {
    let mut unrolling = Unrolling {
        to: Unique::default(),
        values: vec![Value(0); tape.operations.len()],
        parts: Vec::new(),
        systems: FxHashMap::default(),
    };
    for (value, operation) in (0..).map(Value).zip(&tape.operations) {
        unrolling.operation(value, operation);
    }
    let Unrolling { to, values, .. } = unrolling;
    let results = tape.results.iter();
    let results = results.map(|result| result.map(|entry| values[entry.index()]));
    to.finish(results.collect())
}

struct Unrolling {
    to: Unique,
    /// The new values.
    values: Vec<Value>,
    /// Parts of the latest operation with parts.
    parts: Vec<Value>,
    /// Unrolled factorisations.
    systems: FxHashMap<Value, Factors>,
}

/// Factors of `appell_runtime::dense::Lu`.
struct Factors {
    rows: usize,
    /// U on and above the diagonal, the multipliers of L below it.
    entries: Vec<Value>,
    /// Entry (i, k) is 1 where rows k and i > k were exchanged in column k, and 0 elsewhere.
    exchanged: Vec<Value>,
}

impl Unrolling {
    fn operation(&mut self, value: Value, operation: &Operation) {
        let of = |value: Value| self.values[value.index()];
        self.values[value.index()] = match operation {
            Operation::Negate(a) => self.negate(of(*a)),
            Operation::Binary(operation, a, b) => self.arithmetic(*operation, of(*a), of(*b)),
            Operation::Function(Function::Sign, a) => self.sign(of(*a)),
            Operation::Choice {
                relation,
                compared,
                branches,
            } => self.choice(*relation, compared.map(of), branches.map(of)),
            Operation::Factorise(matrix) if matrix.len().isqrt() <= MOST_ROWS_UNROLLED => {
                let factors = self.factor(matrix.iter().map(|&entry| of(entry)).collect());
                self.systems.insert(value, factors);
                return;
            }
            Operation::Solve {
                factorisation,
                right,
            } if let Some(factors) = self.systems.remove(factorisation) => {
                let right = right.iter().map(|&entry| of(entry)).collect();
                self.parts = self.substitute(&factors, right);
                self.systems.insert(*factorisation, factors);
                return;
            }
            Operation::Part(_, index) => self.parts[*index as usize],
            _ => {
                let new = self.to.push(operation.map_operands(of));
                self.parts = (0..).take(operation.parts()).map(|i| new.part(i)).collect();
                new
            }
        };
    }

    fn constant(&mut self, number: Rational) -> Value {
        self.to.push(Operation::Constant(number))
    }

    fn arithmetic(&mut self, operation: Arithmetic, a: Value, b: Value) -> Value {
        // Subtraction equals addition of the negative bit by bit, except for the sign of NaN.
        let (operation, a, b) = match (operation, self.negated(a), self.negated(b)) {
            (Arithmetic::Add, _, Some(b)) => (Arithmetic::Subtract, a, b),
            (Arithmetic::Add, Some(a), _) => (Arithmetic::Subtract, b, a),
            (Arithmetic::Subtract, _, Some(b)) => (Arithmetic::Add, a, b),
            (Arithmetic::Multiply | Arithmetic::Divide, Some(a), Some(b)) => (operation, a, b),
            _ => (operation, a, b),
        };
        let (a, b) = if is_commutative(operation) && b < a {
            (b, a)
        } else {
            (a, b)
        };
        self.to.push(Operation::Binary(operation, a, b))
    }

    fn negate(&mut self, a: Value) -> Value {
        match self.negated(a) {
            Some(positive) => positive,
            None => self.to.push(Operation::Negate(a)),
        }
    }

    /// The operand of a negation.
    fn negated(&self, a: Value) -> Option<Value> {
        match self.to.tape().operation(a) {
            Operation::Negate(positive) => Some(*positive),
            _ => None,
        }
    }

    fn choice(&mut self, relation: Relation, compared: [Value; 2], branches: [Value; 2]) -> Value {
        if branches[0] == branches[1] {
            return branches[0];
        }
        self.to.push(Operation::Choice {
            relation,
            compared,
            branches,
        })
    }

    /// Zero and NaN are preserved, as in the runtime.
    fn sign(&mut self, a: Value) -> Value {
        let numbers = [Rational::ZERO, Rational::ONE, -&Rational::ONE];
        let [zero, one, minus_one] = numbers.map(|number| self.constant(number));
        let below = self.choice(Relation::Less, [a, zero], [minus_one, a]);
        self.choice(Relation::Less, [zero, a], [one, below])
    }

    /// `appell_runtime::dense::lu_factor`, operation by operation.
    fn factor(&mut self, matrix: Vec<Value>) -> Factors {
        let rows = matrix.len().isqrt();
        let [zero, one] = [Rational::ZERO, Rational::ONE].map(|number| self.constant(number));
        let at = |i: usize, j: usize| i * rows + j;
        let mut a = matrix;
        let mut exchanged = vec![zero; rows * rows];
        for k in 0..rows {
            for i in k + 1..rows {
                let compared = [a[at(k, k)], a[at(i, k)]];
                let compared =
                    compared.map(|entry| self.to.push(Operation::Function(Function::Abs, entry)));
                exchanged[at(i, k)] = self.choice(Relation::Less, compared, [one, zero]);
                for j in 0..rows {
                    let (upper, lower) = (a[at(k, j)], a[at(i, j)]);
                    a[at(k, j)] = self.choice(Relation::Less, compared, [lower, upper]);
                    a[at(i, j)] = self.choice(Relation::Less, compared, [upper, lower]);
                }
            }
            for i in k + 1..rows {
                a[at(i, k)] = self.arithmetic(Arithmetic::Divide, a[at(i, k)], a[at(k, k)]);
                for j in k + 1..rows {
                    a[at(i, j)] = self.reduced(a[at(i, j)], a[at(i, k)], a[at(k, j)]);
                }
            }
        }
        Factors {
            rows,
            entries: a,
            exchanged,
        }
    }

    /// `appell_runtime::dense::lu_solve`, operation by operation.
    fn substitute(&mut self, lu: &Factors, right: Vec<Value>) -> Vec<Value> {
        let rows = lu.rows;
        let at = |i: usize, j: usize| i * rows + j;
        let zero = self.constant(Rational::ZERO);
        let mut x = right;
        for k in 0..rows {
            for i in k + 1..rows {
                let compared = [zero, lu.exchanged[at(i, k)]];
                let (upper, lower) = (x[k], x[i]);
                x[k] = self.choice(Relation::Less, compared, [lower, upper]);
                x[i] = self.choice(Relation::Less, compared, [upper, lower]);
            }
        }
        for i in 1..rows {
            for k in 0..i {
                x[i] = self.reduced(x[i], lu.entries[at(i, k)], x[k]);
            }
        }
        for i in (0..rows).rev() {
            for k in i + 1..rows {
                x[i] = self.reduced(x[i], lu.entries[at(i, k)], x[k]);
            }
            x[i] = self.arithmetic(Arithmetic::Divide, x[i], lu.entries[at(i, i)]);
        }
        x
    }

    /// `a - b * c`
    fn reduced(&mut self, a: Value, b: Value, c: Value) -> Value {
        let product = self.arithmetic(Arithmetic::Multiply, b, c);
        self.arithmetic(Arithmetic::Subtract, a, product)
    }
}

/// Whether exchanging the operands leaves the result bit-identical.
pub(crate) fn is_commutative(operation: Arithmetic) -> bool {
    matches!(operation, Arithmetic::Add | Arithmetic::Multiply)
}
