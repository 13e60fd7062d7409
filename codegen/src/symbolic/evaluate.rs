//! Reference evaluation in double precision.

use rustc_hash::FxHashMap;

use super::{Expr, Function, Graph, Node, Relation, applied};
use appell_runtime::real::Real as _;

/// Values of `roots` where the symbol with id `i` has the value `values[i]`. A symbol without a value is NaN.
pub fn evaluate(g: &Graph, values: &[f64], roots: &[Expr]) -> Vec<f64> {
    let mut evaluation = Evaluation::new(g, roots);
    evaluation.compute(values);
    roots.iter().map(|&root| evaluation.of(root)).collect()
}

/// Repeated evaluation of the same expressions at different points.
pub struct Evaluation<'g> {
    graph: &'g Graph,
    /// Operands before users.
    order: Vec<Expr>,
    /// Values by expression.
    known: Vec<f64>,
}

impl<'g> Evaluation<'g> {
    /// Prepares the evaluation of these expressions and their operands.
    pub fn new(graph: &'g Graph, roots: &[Expr]) -> Self {
        let newest = roots.iter().max().map_or(0, |root| root.0 as usize + 1);
        Self {
            graph,
            order: graph.in_order(roots),
            known: vec![f64::NAN; newest],
        }
    }

    /// The last computed value of an expression.
    pub fn of(&self, expr: Expr) -> f64 {
        self.known[expr.0 as usize]
    }

    /// Evaluates all expressions where the symbol with id `i` has the value `values[i]`; a symbol without a
    /// value is NaN.
    pub fn compute(&mut self, values: &[f64]) {
        let Self {
            graph: g,
            order,
            known,
        } = self;
        let mut solutions: FxHashMap<u32, Vec<f64>> = FxHashMap::default();
        for &expr in &*order {
            let of = |e: Expr| known[e.0 as usize];
            let value = match g.node(expr) {
                Node::Number(n) => n.to_f64(),
                Node::Symbol(symbol) => values.get(symbol.0 as usize).copied().unwrap_or(f64::NAN),
                Node::Named(id) => of(g.definition(*id).value),
                Node::Sum(terms) => terms
                    .iter()
                    .map(|t| t.coefficient.to_f64() * of(t.expr))
                    .sum(),
                Node::Product(factors) => factors
                    .iter()
                    .map(|f| of(f.base).powi(f.exponent))
                    .product(),
                Node::Function(function, x) => apply(*function, of(*x)),
                Node::Atan2(y, x) => of(*y).atan2(of(*x)),
                Node::Power(base, exponent) => of(*base).powf(of(*exponent)),
                Node::Choice {
                    relation,
                    compared,
                    branches,
                } => {
                    let [left, right] = compared.map(of);
                    let holds = match relation {
                        Relation::Less => left < right,
                        Relation::LessOrEqual => left <= right,
                    };
                    of(branches[usize::from(!holds)])
                }
                Node::Solution { system, row } => {
                    if !solutions.contains_key(system) {
                        let equations = g.system(*system);
                        let matrix = equations.matrix.iter().map(|&e| of(e)).collect();
                        let right = equations.right.iter().map(|&e| of(e)).collect();
                        solutions.insert(*system, solve(matrix, right));
                    }
                    solutions[system][*row as usize]
                }
            };
            known[expr.0 as usize] = value;
        }
    }
}

fn apply(function: Function, x: f64) -> f64 {
    match function {
        Function::Sign if x == 0.0 => 0.0,
        other => applied!(other, x),
    }
}

/// Gaussian elimination with partial pivoting. A singular matrix gives non-finite values.
fn solve(mut a: Vec<f64>, mut b: Vec<f64>) -> Vec<f64> {
    let n = b.len();
    for k in 0..n {
        let pivot = (k..n)
            .max_by(|&i, &j| a[i * n + k].abs().total_cmp(&a[j * n + k].abs()))
            .unwrap_or(k);
        for j in 0..n {
            a.swap(k * n + j, pivot * n + j);
        }
        b.swap(k, pivot);
        for i in k + 1..n {
            let factor = a[i * n + k] / a[k * n + k];
            for j in k..n {
                a[i * n + j] -= factor * a[k * n + j];
            }
            b[i] -= factor * b[k];
        }
    }
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| a[k * n + j] * b[j]).sum();
        b[k] = (b[k] - known) / a[k * n + k];
    }
    b
}
