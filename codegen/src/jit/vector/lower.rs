//! Lowers a checked tape to straight-line code of vector operations.
//!
//! Operations and their association are those of the tape: each lane is bit-identical to the scalar code.
//! Only bit-identical rewritings are applied, such as `a + (-b)` to `a - b`. Common subexpressions and dead
//! code are eliminated.

use rustc_hash::FxHashMap;

use super::super::check::Checked;
use super::line::{Action, Array, Binary, Call, Id, Line, Node, Routine};
use super::order::order;
use crate::symbolic::{Function, Relation};
use crate::tape::{Argument, Arithmetic, Operation, Tape, Value};

/// Larger systems are solved by a routine, lane by lane.
const MOST_ROWS_IN_LINE: usize = 12;

/// All bits except the sign.
const MAGNITUDE: u64 = u64::MAX >> 1;

/// The line of a tape.
pub(super) fn lower(checked: &Checked<'_>) -> Line {
    let mut lowering = Lowering {
        nodes: Vec::new(),
        known: FxHashMap::default(),
        calls: Vec::new(),
        tape: checked.tape,
        values: vec![Id(0); checked.tape.operations.len()],
        parts: Vec::new(),
        systems: FxHashMap::default(),
    };
    for value in (0..).map(Value).take(checked.tape.operations.len()) {
        lowering.operation(value);
    }
    let mut stores = Vec::new();
    for (result, array) in (0..).zip(&checked.tape.results) {
        for (entry, &value) in (0..).zip(&array.entries) {
            stores.push(Action::Store(lowering.value(value), result, entry));
        }
    }
    let Lowering { nodes, calls, .. } = lowering;
    order(nodes, calls, stores)
}

struct Lowering<'a> {
    nodes: Vec<Node>,
    /// Values by definition, for hash consing.
    known: FxHashMap<Node, Id>,
    calls: Vec<Call>,
    tape: &'a Tape,
    /// Values computed so far. Arguments and numbers are not among them; see [`Self::value`].
    values: Vec<Id>,
    /// Parts of the latest operation with parts.
    parts: Vec<Id>,
    /// Matrices and factors, by factorisation.
    systems: FxHashMap<Value, System>,
}

enum System {
    /// Factorised inline.
    Factors(Factors),
    /// Passed to a routine.
    Matrix(Vec<Id>),
}

/// Factors of `appell_runtime::dense::Lu`.
struct Factors {
    rows: usize,
    /// U on and above the diagonal, the multipliers of L below it.
    entries: Vec<Id>,
    /// Entry (i, k) is 1 where rows k and i > k were exchanged in column k, and 0 elsewhere.
    exchanged: Vec<Id>,
}

impl Lowering<'_> {
    fn operation(&mut self, value: Value) {
        let computed = match self.tape.operation(value) {
            // Made at their first use.
            Operation::Argument(_) | Operation::Constant(_) => return,
            Operation::Negate(a) => {
                let a = self.value(*a);
                self.negate(a)
            }
            Operation::Binary(operation, a, b) => {
                let (a, b) = (self.value(*a), self.value(*b));
                self.arithmetic(*operation, a, b)
            }
            Operation::Function(function, a) => {
                let a = self.value(*a);
                self.function(*function, a)
            }
            Operation::Atan2(y, x) => {
                let given = self.all(&[*y, *x]);
                self.call(Routine::Atan2, given, 1)[0]
            }
            Operation::Power(base, exponent) => {
                let given = self.all(&[*base, *exponent]);
                self.call(Routine::Power, given, 1)[0]
            }
            Operation::Choice {
                relation,
                compared,
                branches,
            } => {
                let compared = compared.map(|value| self.value(value));
                let branches = branches.map(|value| self.value(value));
                self.choice(*relation, compared, branches)
            }
            Operation::SinCos(angle) => {
                let angle = self.value(*angle);
                self.parts = self.call(Routine::SinCos, vec![angle], 2);
                return;
            }
            Operation::Factorise(matrix) => {
                let (rows, matrix) = (matrix.len().isqrt(), self.all(matrix));
                let system = if rows <= MOST_ROWS_IN_LINE {
                    System::Factors(self.factor(matrix, rows))
                } else {
                    System::Matrix(matrix)
                };
                self.systems.insert(value, system);
                return;
            }
            Operation::Solve {
                factorisation,
                right,
            } => {
                let right = self.all(right);
                self.parts = self.solve(*factorisation, right);
                return;
            }
            Operation::Part(_, index) => self.parts[*index as usize],
        };
        self.values[value.index()] = computed;
    }

    fn all(&mut self, values: &[Value]) -> Vec<Id> {
        values.iter().map(|&value| self.value(value)).collect()
    }

    /// A value that an operation uses.
    fn value(&mut self, value: Value) -> Id {
        match self.tape.operation(value) {
            Operation::Argument(argument) => self.argument(*argument),
            Operation::Constant(number) => self.constant(number.to_f64()),
            _ => self.values[value.index()],
        }
    }

    fn argument(&mut self, argument: Argument) -> Id {
        let (array, index) = match argument {
            Argument::Time => (Array::Time, 0),
            Argument::State(index) => (Array::States, index),
            Argument::Input(index) => (Array::Inputs, index),
            Argument::Parameter(index) => (Array::Parameters, index),
            Argument::Weight(index)
            | Argument::OutputWeight(index)
            | Argument::Acceleration(index) => (Array::Weights, index),
        };
        self.node(Node::Argument(array, index))
    }

    fn constant(&mut self, number: f64) -> Id {
        self.node(Node::Constant(number.to_bits()))
    }

    fn node(&mut self, node: Node) -> Id {
        let nodes = &mut self.nodes;
        *self.known.entry(node).or_insert_with(|| push(nodes, node))
    }

    fn arithmetic(&mut self, operation: Arithmetic, a: Id, b: Id) -> Id {
        // Subtraction equals addition of the negative bit by bit, except for the sign of NaN.
        let (operation, a, b) = match (operation, self.negated(a), self.negated(b)) {
            (Arithmetic::Add, _, Some(b)) => (Arithmetic::Subtract, a, b),
            (Arithmetic::Add, Some(a), _) => (Arithmetic::Subtract, b, a),
            (Arithmetic::Subtract, _, Some(b)) => (Arithmetic::Add, a, b),
            (Arithmetic::Multiply | Arithmetic::Divide, Some(a), Some(b)) => (operation, a, b),
            _ => (operation, a, b),
        };
        self.binary(Binary::Arithmetic(operation), a, b)
    }

    fn binary(&mut self, operation: Binary, a: Id, b: Id) -> Id {
        let (a, b) = if operation.is_commutative() && b < a {
            (b, a)
        } else {
            (a, b)
        };
        self.node(Node::Binary(operation, a, b))
    }

    fn negate(&mut self, a: Id) -> Id {
        if let Some(positive) = self.negated(a) {
            return positive;
        }
        if let Node::Constant(bits) = self.nodes[a.index()] {
            return self.constant(-f64::from_bits(bits));
        }
        let sign = self.constant(-0.0);
        self.binary(Binary::Xor, a, sign)
    }

    /// The operand of an explicit negation.
    fn negated(&self, a: Id) -> Option<Id> {
        let is_sign = |id: Id| self.nodes[id.index()] == Node::Constant((-0.0_f64).to_bits());
        match self.nodes[a.index()] {
            Node::Binary(Binary::Xor, positive, sign) if is_sign(sign) => Some(positive),
            Node::Binary(Binary::Xor, sign, positive) if is_sign(sign) => Some(positive),
            _ => None,
        }
    }

    fn absolute(&mut self, a: Id) -> Id {
        let magnitude = self.node(Node::Constant(MAGNITUDE));
        self.binary(Binary::And, a, magnitude)
    }

    fn choice(&mut self, relation: Relation, compared: [Id; 2], branches: [Id; 2]) -> Id {
        if branches[0] == branches[1] {
            return branches[0];
        }
        self.node(Node::Choice {
            relation,
            compared,
            branches,
        })
    }

    fn function(&mut self, function: Function, a: Id) -> Id {
        match function {
            Function::Sqrt => self.node(Node::Sqrt(a)),
            Function::Abs => self.absolute(a),
            // Zero and NaN are preserved, as in the runtime.
            Function::Sign => {
                let [zero, one, minus_one] = [0.0, 1.0, -1.0].map(|number| self.constant(number));
                let below = self.choice(Relation::Less, [a, zero], [minus_one, a]);
                self.choice(Relation::Less, [zero, a], [one, below])
            }
            _ => self.call(Routine::Unary(function), vec![a], 1)[0],
        }
    }

    fn call(&mut self, routine: Routine, given: Vec<Id>, results: usize) -> Vec<Id> {
        let number = u32::try_from(self.calls.len()).unwrap_or(u32::MAX);
        let result = |index| push(&mut self.nodes, Node::Result(number, index));
        let results: Vec<Id> = (0..).take(results).map(result).collect();
        self.calls.push(Call {
            routine,
            given,
            results: results.clone(),
        });
        results
    }

    /// `appell_runtime::dense::lu_factor`, operation by operation.
    fn factor(&mut self, matrix: Vec<Id>, rows: usize) -> Factors {
        let [zero, one] = [0.0, 1.0].map(|number| self.constant(number));
        let at = |i: usize, j: usize| i * rows + j;
        let mut a = matrix;
        let mut exchanged = vec![zero; rows * rows];
        for k in 0..rows {
            for i in k + 1..rows {
                let compared = [a[at(k, k)], a[at(i, k)]].map(|entry| self.absolute(entry));
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

    fn solve(&mut self, factorisation: Value, right: Vec<Id>) -> Vec<Id> {
        // A checked tape factorises before it solves.
        match self.systems.remove(&factorisation) {
            Some(System::Factors(lu)) => {
                let unknowns = self.substitute(&lu, right);
                self.systems.insert(factorisation, System::Factors(lu));
                unknowns
            }
            Some(System::Matrix(matrix)) => {
                let rows = right.len();
                let given = [&matrix[..], &right[..]].concat();
                self.systems.insert(factorisation, System::Matrix(matrix));
                let number = u32::try_from(rows).unwrap_or(u32::MAX);
                self.call(Routine::System(number), given, rows)
            }
            None => right,
        }
    }

    /// `appell_runtime::dense::lu_solve`, operation by operation.
    fn substitute(&mut self, lu: &Factors, right: Vec<Id>) -> Vec<Id> {
        let rows = lu.rows;
        let at = |i: usize, j: usize| i * rows + j;
        let zero = self.constant(0.0);
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
    fn reduced(&mut self, a: Id, b: Id, c: Id) -> Id {
        let product = self.arithmetic(Arithmetic::Multiply, b, c);
        self.arithmetic(Arithmetic::Subtract, a, product)
    }
}

fn push(nodes: &mut Vec<Node>, node: Node) -> Id {
    nodes.push(node);
    // The checked limits keep the number of values far below this.
    Id(u32::try_from(nodes.len() - 1).unwrap_or(u32::MAX))
}
