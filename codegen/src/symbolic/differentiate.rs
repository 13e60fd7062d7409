//! Differentiation on the graph.

use rustc_hash::FxHashMap;

use super::node::{Expr, Function, Node, SymbolId};
use super::{Graph, Rational};

/// Partial derivatives with respect to one symbol, memoised.
#[derive(Debug, Clone)]
pub struct Derivatives {
    symbol: SymbolId,
    known: FxHashMap<Expr, Expr>,
}

impl Derivatives {
    /// Derivatives with respect to `symbol`.
    pub fn with_respect_to(symbol: SymbolId) -> Self {
        Self {
            symbol,
            known: FxHashMap::default(),
        }
    }

    /// `∂expr/∂symbol`
    pub fn of(&mut self, graph: &mut Graph, expr: Expr) -> Expr {
        let unknown = |e: Expr| graph.mentions(e, &[self.symbol]) && !self.known.contains_key(&e);
        for part in graph.in_order_where(&[expr], unknown) {
            let derivative = self.step(graph, part);
            self.known.insert(part, derivative);
        }
        self.get(expr)
    }

    /// A memoised derivative; zero for expressions that do not contain the symbol.
    fn get(&self, expr: Expr) -> Expr {
        self.known.get(&expr).copied().unwrap_or(Graph::ZERO)
    }

    /// Derivative of one node; those of its operands are known.
    fn step(&mut self, graph: &mut Graph, expr: Expr) -> Expr {
        match graph.node(expr).clone() {
            Node::Number(_) => Graph::ZERO,
            Node::Symbol(symbol) => {
                if symbol == self.symbol {
                    Graph::ONE
                } else {
                    Graph::ZERO
                }
            }
            Node::Named(id) => {
                let value = graph.definition(id).value;
                let derivative = self.get(value);
                self.name_derivative(graph, id, derivative)
            }
            Node::Sum(terms) => {
                let parts: Vec<(Rational, Expr)> = terms
                    .iter()
                    .map(|t| (t.coefficient.clone(), self.get(t.expr)))
                    .collect();
                graph.linear_combination(&parts)
            }
            Node::Product(factors) => {
                // Σ n · base' · (product / base)
                let mut sum = Vec::new();
                for factor in &factors {
                    let inner = self.get(factor.base);
                    if inner != Graph::ZERO {
                        let without = graph.div(expr, factor.base);
                        sum.push((i64::from(factor.exponent).into(), graph.mul(inner, without)));
                    }
                }
                graph.linear_combination(&sum)
            }
            Node::Function(function, argument) => {
                let inner = self.get(argument);
                if inner == Graph::ZERO {
                    return Graph::ZERO;
                }
                let outer = outer_derivative(graph, function, argument, expr);
                graph.mul(outer, inner)
            }
            Node::Atan2(y, x) => {
                let (dy, dx) = (self.get(y), self.get(x));
                let squares = [graph.square(x), graph.square(y)];
                let radius_squared = graph.sum(&squares);
                let (x_dy, y_dx) = (graph.mul(x, dy), graph.mul(y, dx));
                let numerator = graph.sub(x_dy, y_dx);
                graph.div(numerator, radius_squared)
            }
            Node::Power(base, exponent) => {
                // a^b (b' ln a + b a'/a)
                let (da, db) = (self.get(base), self.get(exponent));
                let growth = if db == Graph::ZERO {
                    Graph::ZERO
                } else {
                    let logarithm = graph.function(Function::Ln, base);
                    graph.mul(db, logarithm)
                };
                let quotient = graph.div(da, base);
                let scaled = graph.mul(exponent, quotient);
                let sum = graph.add(growth, scaled);
                graph.mul(expr, sum)
            }
            Node::Choice {
                relation,
                compared,
                branches,
            } => graph.choice(relation, compared, branches.map(|b| self.get(b))),
            Node::Solution { system, row } => {
                // A x = b gives A x' = b' - A' x.
                let system_now = graph.system(system).clone();
                let size = system_now.right.len();
                let unknowns = graph.unknowns(system);
                let right = (0..size)
                    .map(|i| {
                        let mut parts = vec![self.get(system_now.right[i])];
                        for j in 0..size {
                            let entry = self.get(system_now.matrix[i * size + j]);
                            let product = graph.mul(entry, unknowns[j]);
                            parts.push(graph.neg(product));
                        }
                        graph.sum(&parts)
                    })
                    .collect();
                graph.solve_numerically(system_now.matrix.to_vec(), right)[row as usize]
            }
        }
    }

    /// Names the derivative of a named quantity if it is worth a name.
    fn name_derivative(&self, graph: &mut Graph, id: u32, derivative: Expr) -> Expr {
        if !matches!(graph.node(derivative), Node::Sum(terms) if terms.len() > 1) {
            return derivative;
        }
        let name = format!(
            "d_{}_d_{}",
            graph.definition(id).name,
            graph.symbol_name(self.symbol)
        );
        graph.name_automatically(&name, derivative)
    }
}

/// Derivative of a function with respect to its argument; `value` is the function's node.
pub(super) fn outer_derivative(
    graph: &mut Graph,
    function: Function,
    x: Expr,
    value: Expr,
) -> Expr {
    let one = Graph::ONE;
    match function {
        Function::Sin => graph.cos(x),
        Function::Cos => {
            let sin = graph.sin(x);
            graph.neg(sin)
        }
        Function::Asin | Function::Acos => {
            let square = graph.square(x);
            let rest = graph.sub(one, square);
            let root = graph.sqrt(rest);
            let derivative = graph.pow(root, -1);
            if function == Function::Asin {
                derivative
            } else {
                graph.neg(derivative)
            }
        }
        Function::Atan => {
            let square = graph.square(x);
            let sum = graph.add(one, square);
            graph.pow(sum, -1)
        }
        Function::Sinh => graph.function(Function::Cosh, x),
        Function::Cosh => graph.function(Function::Sinh, x),
        Function::Tanh => {
            let square = graph.square(value);
            graph.sub(one, square)
        }
        Function::Exp => value,
        Function::Ln => graph.pow(x, -1),
        Function::Sqrt => {
            let reciprocal = graph.pow(value, -1);
            graph.scale(&Rational::new(1, 2), reciprocal)
        }
        Function::Abs => graph.function(Function::Sign, x),
        // The derivative is zero except at the jump, where it is undefined.
        Function::Sign => Graph::ZERO,
    }
}
