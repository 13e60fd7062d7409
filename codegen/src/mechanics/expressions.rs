//! Lowers spec expressions to expressions of the graph.

use appell_spec::expr::{
    BinaryOp, Expr as Spec, ExprKind, Function as SpecFunction, Quantity, Relation as SpecRelation,
};
use appell_spec::mechanism::Mechanism;

use super::finding::{Item, Outcome, defined};
use super::symbols::Symbols;
use crate::symbolic::{Expr, Function, Graph, Rational, Relation};

/// A division by the number zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DivisionByZero;

/// A mechanism in a motion: the meaning of the names in its expressions, and their rates.
#[derive(Clone, Copy)]
pub struct Setting<'a> {
    /// The mechanism.
    pub mechanism: &'a Mechanism,
    /// Symbols of all quantities except the generalised velocities.
    pub symbols: &'a Symbols,
    /// Generalised velocities, one per coordinate: symbols while unknown, expressions once solved.
    pub rates: &'a [Expr],
}

impl<'a> Setting<'a> {
    /// With given generalised velocities.
    pub fn new(mechanism: &'a Mechanism, symbols: &'a Symbols, rates: &'a [Expr]) -> Self {
        Self {
            mechanism,
            symbols,
            rates,
        }
    }

    /// With symbols for the generalised velocities.
    pub fn free(mechanism: &'a Mechanism, symbols: &'a Symbols) -> Self {
        Self::new(mechanism, symbols, &symbols.rates)
    }

    /// An expression in the graph.
    pub fn lower(self, graph: &mut Graph, expr: &Spec) -> Result<Expr, DivisionByZero> {
        lower(self.symbols, self.rates, graph, expr)
    }

    /// Several expressions, such as the components of a vector.
    pub fn lower_all<const N: usize>(
        self,
        graph: &mut Graph,
        exprs: &[Spec; N],
    ) -> Result<[Expr; N], DivisionByZero> {
        let mut lowered = [Graph::ZERO; N];
        for (target, expr) in lowered.iter_mut().zip(exprs) {
            *target = self.lower(graph, expr)?;
        }
        Ok(lowered)
    }

    /// [`Setting::lower`] for an expression of `item`.
    pub fn lower_in(self, graph: &mut Graph, item: Item, expr: &Spec) -> Outcome<Expr> {
        defined(self.lower(graph, expr).ok(), item)
    }

    /// [`Setting::lower_all`] for expressions of `item`.
    pub fn lower_all_in<const N: usize>(
        self,
        graph: &mut Graph,
        item: Item,
        exprs: &[Spec; N],
    ) -> Outcome<[Expr; N]> {
        defined(self.lower_all(graph, exprs).ok(), item)
    }
}

impl Symbols {
    /// An expression in the graph, with symbols for the generalised velocities.
    pub fn lower(&self, graph: &mut Graph, expr: &Spec) -> Result<Expr, DivisionByZero> {
        lower(self, &self.rates, graph, expr)
    }
}

fn lower(
    symbols: &Symbols,
    rates: &[Expr],
    graph: &mut Graph,
    expr: &Spec,
) -> Result<Expr, DivisionByZero> {
    let lower = |graph: &mut Graph, expr: &Spec| lower(symbols, rates, graph, expr);
    Ok(match &expr.kind {
        ExprKind::Number(value) => graph.number(Rational::from_big(value.clone())),
        ExprKind::Quantity(quantity) => meaning(symbols, rates, *quantity),
        ExprKind::Negate(a) => {
            let a = lower(graph, a)?;
            graph.neg(a)
        }
        ExprKind::Binary(op, a, b) => {
            let (a, b) = (lower(graph, a)?, lower(graph, b)?);
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
                lowered.push(lower(graph, argument)?);
            }
            call(graph, *function, &lowered)?
        }
        ExprKind::Choice {
            relation,
            compared,
            branches,
        } => {
            let [left, right] = &**compared;
            let (left, right) = (lower(graph, left)?, lower(graph, right)?);
            let [first, second] = &**branches;
            let branches = [lower(graph, first)?, lower(graph, second)?];
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

fn meaning(symbols: &Symbols, rates: &[Expr], quantity: Quantity) -> Expr {
    match quantity {
        Quantity::Parameter(i) => symbols.parameters[i.index()],
        Quantity::Coordinate(i) => symbols.coordinates[i.index()],
        Quantity::Rate(i) => rates[i.index()],
        Quantity::PseudoVelocity(i) => symbols.speeds[i.index()],
        Quantity::Input(i) => symbols.inputs[i.index()],
        Quantity::Signal(i) => symbols.signals[i.index()][0],
        // All quantities that a spec names have a symbol.
        Quantity::Motion(_) | Quantity::Response(_) => {
            symbols.named(quantity).unwrap_or(Graph::ZERO)
        }
        Quantity::Time => symbols.time,
        Quantity::Pi => symbols.pi,
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
