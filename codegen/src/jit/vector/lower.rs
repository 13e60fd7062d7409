//! Lowers a checked schedule to straight-line code of vector operations.
//!
//! Operations and their association are those of the schedule: each lane is bit-identical to the scalar code.
//! Only bit-identical rewritings are applied, such as `a + (-b)` to `a - b`. Common subexpressions and dead
//! code are eliminated.

use rustc_hash::FxHashMap;

use super::super::check::Checked;
use super::line::{Action, Array, Binary, Call, Id, Line, Node, Routine};
use super::order::order;
use crate::schedule::{Argument, Operation, Step, Tree, Value};
use crate::symbolic::{Function, Relation};

/// Larger systems are solved by a routine, lane by lane.
const MOST_ROWS_IN_LINE: usize = 12;

/// All bits except the sign.
const MAGNITUDE: u64 = u64::MAX >> 1;

/// The line of a schedule.
pub(super) fn lower(checked: &Checked<'_>) -> Line {
    let mut lowering = Lowering {
        nodes: Vec::new(),
        known: FxHashMap::default(),
        calls: Vec::new(),
        values: vec![Id(0); checked.schedule.names.len()],
        systems: FxHashMap::default(),
    };
    for step in &checked.schedule.steps {
        lowering.step(step);
    }
    let mut stores = Vec::new();
    for (result, array) in (0..).zip(&checked.schedule.results) {
        for (entry, tree) in (0..).zip(&array.entries) {
            stores.push(Action::Store(lowering.tree(tree), result, entry));
        }
    }
    let Lowering { nodes, calls, .. } = lowering;
    order(nodes, calls, stores)
}

struct Lowering {
    nodes: Vec<Node>,
    /// Values by definition, for hash consing.
    known: FxHashMap<Node, Id>,
    calls: Vec<Call>,
    /// Results of the steps.
    values: Vec<Id>,
    /// Matrices and factors by the number of the factorisation.
    systems: FxHashMap<u32, System>,
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

impl Lowering {
    fn step(&mut self, step: &Step) {
        match step {
            Step::Let { value, tree } => {
                let computed = self.tree(tree);
                self.define(*value, computed);
            }
            Step::SinCos { sin, cos, angle } => {
                let angle = self.tree(angle);
                let pair = self.call(Routine::SinCos, vec![angle], 2);
                self.define(*sin, pair[0]);
                self.define(*cos, pair[1]);
            }
            Step::Factor {
                factorisation,
                size,
                matrix,
            } => {
                let matrix = self.trees(matrix);
                let system = if *size <= MOST_ROWS_IN_LINE {
                    System::Factors(self.factor(matrix, *size))
                } else {
                    System::Matrix(matrix)
                };
                self.systems.insert(*factorisation, system);
            }
            Step::Solve {
                factorisation,
                values,
                right,
            } => {
                let right = self.trees(right);
                for (value, unknown) in values.iter().zip(self.solve(*factorisation, right)) {
                    self.define(*value, unknown);
                }
            }
            Step::Paragraph { .. } => {}
        }
    }

    fn define(&mut self, value: Value, computed: Id) {
        self.values[value.0 as usize] = computed;
    }

    fn trees(&mut self, trees: &[Tree]) -> Vec<Id> {
        trees.iter().map(|tree| self.tree(tree)).collect()
    }

    fn tree(&mut self, tree: &Tree) -> Id {
        match tree {
            Tree::Value(value) => self.values[value.0 as usize],
            Tree::Argument(argument) => self.argument(*argument),
            Tree::Constant(number) => self.constant(number.to_f64()),
            Tree::Negate(a) => {
                let a = self.tree(a);
                self.negate(a)
            }
            Tree::Binary(operation, a, b) => {
                let (a, b) = (self.tree(a), self.tree(b));
                self.arithmetic(*operation, a, b)
            }
            Tree::Function(function, a) => {
                let a = self.tree(a);
                self.function(*function, a)
            }
            Tree::Atan2(y, x) => {
                let given = vec![self.tree(y), self.tree(x)];
                self.call(Routine::Atan2, given, 1)[0]
            }
            Tree::Power(base, exponent) => {
                let given = vec![self.tree(base), self.tree(exponent)];
                self.call(Routine::Power, given, 1)[0]
            }
            Tree::Choice {
                relation,
                compared,
                branches,
            } => {
                let compared = compared.each_ref().map(|tree| self.tree(tree));
                let branches = branches.each_ref().map(|tree| self.tree(tree));
                self.choice(*relation, compared, branches)
            }
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

    fn arithmetic(&mut self, operation: Operation, a: Id, b: Id) -> Id {
        // Subtraction equals addition of the negative bit by bit, except for the sign of NaN.
        let (operation, a, b) = match (operation, self.negated(a), self.negated(b)) {
            (Operation::Add, _, Some(b)) => (Operation::Subtract, a, b),
            (Operation::Add, Some(a), _) => (Operation::Subtract, b, a),
            (Operation::Subtract, _, Some(b)) => (Operation::Add, a, b),
            (Operation::Multiply | Operation::Divide, Some(a), Some(b)) => (operation, a, b),
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
                a[at(i, k)] = self.arithmetic(Operation::Divide, a[at(i, k)], a[at(k, k)]);
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

    fn solve(&mut self, factorisation: u32, right: Vec<Id>) -> Vec<Id> {
        // A checked schedule factorises before it solves.
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
            x[i] = self.arithmetic(Operation::Divide, x[i], lu.entries[at(i, i)]);
        }
        x
    }

    /// `a - b * c`
    fn reduced(&mut self, a: Id, b: Id, c: Id) -> Id {
        let product = self.arithmetic(Operation::Multiply, b, c);
        self.arithmetic(Operation::Subtract, a, product)
    }
}

fn push(nodes: &mut Vec<Node>, node: Node) -> Id {
    nodes.push(node);
    // The checked limits keep the number of values far below this.
    Id(u32::try_from(nodes.len() - 1).unwrap_or(u32::MAX))
}
