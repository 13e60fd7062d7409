//! Lowers spec expressions to expressions of the graph.

use appell_spec::expr::{
    BinaryOp, Expr as Spec, ExprKind, Function as SpecFunction, Quantity, Relation as SpecRelation,
};

use super::symbols::Symbols;
use crate::symbolic::{Expr, Function, Graph, Rational, Relation};

/// A division by the number zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DivisionByZero;

/// The meaning of the names of spec expressions.
pub struct Lowering<'a> {
    /// Symbols of all quantities except the generalised velocities.
    pub symbols: &'a Symbols,
    /// Generalised velocities: symbols while unknown, expressions once solved.
    pub rates: &'a [Expr],
}

impl Lowering<'_> {
    /// The expression in the graph.
    pub fn lower(&self, graph: &mut Graph, expr: &Spec) -> Result<Expr, DivisionByZero> {
        Ok(match &expr.kind {
            ExprKind::Number(value) => graph.number(Rational::from_big(value.clone())),
            ExprKind::Quantity(quantity) => self.quantity(*quantity),
            ExprKind::Negate(a) => {
                let a = self.lower(graph, a)?;
                graph.neg(a)
            }
            ExprKind::Binary(op, a, b) => {
                let (a, b) = (self.lower(graph, a)?, self.lower(graph, b)?);
                match op {
                    BinaryOp::Add => graph.add(a, b),
                    BinaryOp::Subtract => graph.sub(a, b),
                    BinaryOp::Multiply => graph.mul(a, b),
                    BinaryOp::Divide if b == Graph::ZERO => return Err(DivisionByZero),
                    BinaryOp::Divide => graph.div(a, b),
                    BinaryOp::Power => {
                        let negative = graph.as_number(b).is_some_and(Rational::is_negative);
                        if a == Graph::ZERO && negative {
                            return Err(DivisionByZero);
                        }
                        graph.power(a, b)
                    }
                }
            }
            ExprKind::Call(function, arguments) => {
                let mut lowered = Vec::with_capacity(arguments.len());
                for argument in arguments {
                    lowered.push(self.lower(graph, argument)?);
                }
                call(graph, *function, &lowered)?
            }
            ExprKind::Choice {
                relation,
                compared,
                branches,
            } => {
                let [left, right] = self.lower_all(graph, compared)?;
                let branches = self.lower_all(graph, branches)?;
                let (relation, compared) = match relation {
                    SpecRelation::Less => (Relation::Less, [left, right]),
                    SpecRelation::LessOrEqual => (Relation::LessOrEqual, [left, right]),
                    SpecRelation::Greater => (Relation::Less, [right, left]),
                    SpecRelation::GreaterOrEqual => (Relation::LessOrEqual, [right, left]),
                };
                graph.choice(relation, compared, branches)
            }
        })
    }

    /// Several expressions, such as the components of a vector.
    pub fn lower_all<const N: usize>(
        &self,
        graph: &mut Graph,
        exprs: &[Spec; N],
    ) -> Result<[Expr; N], DivisionByZero> {
        let mut lowered = [Graph::ZERO; N];
        for (target, expr) in lowered.iter_mut().zip(exprs) {
            *target = self.lower(graph, expr)?;
        }
        Ok(lowered)
    }

    fn quantity(&self, quantity: Quantity) -> Expr {
        let s = self.symbols;
        match quantity {
            Quantity::Parameter(i) => s.parameters[i.index()],
            Quantity::Coordinate(i) => s.coordinates[i.index()],
            Quantity::Rate(i) => self.rates[i.index()],
            Quantity::PseudoVelocity(i) => s.speeds[i.index()],
            Quantity::Input(i) => s.inputs[i.index()],
            Quantity::Signal(i) => s.signals[i.index()][0],
            // All quantities that a spec names have a symbol.
            Quantity::Motion(_) | Quantity::Response(_) => s.named(quantity).unwrap_or(Graph::ZERO),
            Quantity::Time => s.time,
            Quantity::Pi => s.pi,
        }
    }
}

/// Maps the functions of the language to those of the graph.
fn call(
    graph: &mut Graph,
    function: SpecFunction,
    arguments: &[Expr],
) -> Result<Expr, DivisionByZero> {
    use SpecFunction as F;
    let a = arguments[0];
    let b = arguments.get(1).copied().unwrap_or(Graph::ZERO);
    let unary = |f: Function, graph: &mut Graph| graph.function(f, a);
    Ok(match function {
        F::Sin => unary(Function::Sin, graph),
        F::Cos => unary(Function::Cos, graph),
        F::Tan => graph.tan(a),
        F::Asin => unary(Function::Asin, graph),
        F::Acos => unary(Function::Acos, graph),
        F::Atan => unary(Function::Atan, graph),
        F::Sinh => unary(Function::Sinh, graph),
        F::Cosh => unary(Function::Cosh, graph),
        F::Tanh => unary(Function::Tanh, graph),
        F::Exp => unary(Function::Exp, graph),
        F::Ln => unary(Function::Ln, graph),
        F::Sqrt => unary(Function::Sqrt, graph),
        F::Abs => unary(Function::Abs, graph),
        F::Sign => unary(Function::Sign, graph),
        F::Atan2 => graph.atan2(a, b),
        F::Hypot | F::SmoothAbs => hypot(graph, a, b),
        F::Min => graph.choice(Relation::Less, [a, b], [a, b]),
        F::Max => graph.choice(Relation::Less, [a, b], [b, a]),
        F::SmoothSign if b == Graph::ZERO => return Err(DivisionByZero),
        F::SmoothSign => {
            let ratio = graph.div(a, b);
            graph.function(Function::Tanh, ratio)
        }
        F::SmoothMin | F::SmoothMax => {
            // The smoothed value differs from the sharp one by w²/(2(d + √(d² + w²))), d ≥ 0 being the
            // difference. This avoids cancellation, also in the derivatives, whose branches are those of the
            // choice.
            let [less, more] =
                [[a, b], [b, a]].map(|sides| graph.choice(Relation::Less, [a, b], sides));
            let (difference, signed) = (graph.sub(more, less), graph.sub(a, b));
            let root = hypot(graph, signed, arguments[2]);
            let sum = graph.add(difference, root);
            let square = graph.square(arguments[2]);
            if sum == Graph::ZERO && square != Graph::ZERO {
                return Err(DivisionByZero);
            }
            let sum = graph.scale(&Rational::from(2), sum);
            let share = if square == Graph::ZERO {
                Graph::ZERO
            } else {
                graph.div(square, sum)
            };
            if function == F::SmoothMin {
                graph.sub(less, share)
            } else {
                graph.add(more, share)
            }
        }
    })
}

/// √(a² + b²)
fn hypot(graph: &mut Graph, a: Expr, b: Expr) -> Expr {
    let squares = [graph.square(a), graph.square(b)];
    let sum = graph.sum(&squares);
    graph.sqrt(sum)
}
