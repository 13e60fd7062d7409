//! Velocities of points and bodies as expressions of the spec language, in coordinates and their
//! rates: for loads that are written by a program.

use std::fmt::Write as _;

use appell_spec::mechanism::{FrameId, GROUND, List, Mechanism, PointId};

use crate::mechanics::algebra::Algebra;
use crate::mechanics::finding::Outcome;
use crate::mechanics::frames::FrameVector;
use crate::mechanics::kinematics::{Effort, Kinematics};
use crate::mechanics::seed;
use crate::mechanics::symbols::Symbols;
use crate::schedule::piece::method;
use crate::symbolic::{Expr, Graph, Node, Rational, Relation};

/// Components in the ground.
pub type Components = [String; 3];

/// Velocities of a mechanism, whether or not its constraints allow them.
#[derive(Debug, Clone)]
pub struct Velocities {
    /// Of each point.
    pub points: List<PointId, Components>,
    /// Angular velocity of each frame.
    pub frames: List<FrameId, Components>,
}

impl Velocities {
    /// Of a checked mechanism.
    pub fn of(mechanism: &Mechanism) -> Outcome<Self> {
        let mut graph = Graph::new();
        let symbols = Symbols::new(&mut graph, mechanism);
        let mut algebra = Algebra::new(graph, &symbols, seed(mechanism));
        let rates = symbols.rates.clone();
        let kinematics = Kinematics::new(
            &mut algebra,
            mechanism,
            &symbols,
            &rates,
            &[],
            Effort::Plain,
        )?;
        let mut written = |vector: FrameVector| {
            let v = kinematics
                .frames
                .express(&mut algebra.graph, vector, GROUND);
            let v = algebra.shortest3(v);
            v.map(|component| written(&algebra.graph, &symbols, mechanism, component))
        };
        Ok(Self {
            points: mechanism
                .points
                .ids()
                .map(|point| written(kinematics.velocity(point)))
                .collect(),
            frames: mechanism
                .frames
                .ids()
                .map(|frame| written(kinematics.frames.angular_velocity(frame)))
                .collect(),
        })
    }
}

/// An expression in the spec language, definitions of names in their places.
fn written(graph: &Graph, symbols: &Symbols, mechanism: &Mechanism, expr: Expr) -> String {
    let of = |part: Expr| written(graph, symbols, mechanism, part);
    match graph.node(expr) {
        Node::Number(number) => literal(number),
        Node::Symbol(id) => {
            let rate = symbols.rates.iter().position(|&rate| rate == expr);
            match rate.and_then(|index| mechanism.coordinates.get(index)) {
                Some(coordinate) => format!("dot({})", coordinate.label.name),
                None => graph.symbol_name(*id).to_owned(),
            }
        }
        Node::Named(id) => of(graph.definition(*id).value),
        Node::Sum(terms) => {
            let terms = terms
                .iter()
                .map(|term| format!("{}*{}", literal(&term.coefficient), of(term.expr)));
            format!("({})", terms.collect::<Vec<_>>().join(" + "))
        }
        Node::Product(factors) => {
            let mut text = String::new();
            for factor in factors {
                if !text.is_empty() {
                    text += "*";
                }
                text += &of(factor.base);
                if factor.exponent != 1 {
                    // Writing to a string cannot fail.
                    let _ = write!(text, "^({})", factor.exponent);
                }
            }
            format!("({text})")
        }
        Node::Function(function, argument) => format!("{}({})", method(*function), of(*argument)),
        Node::Atan2(y, x) => format!("atan2({}, {})", of(*y), of(*x)),
        Node::Power(base, exponent) => format!("({})^({})", of(*base), of(*exponent)),
        Node::Choice {
            relation,
            compared: [left, right],
            branches: [then, otherwise],
        } => {
            let sign = match relation {
                Relation::Less => "<",
                Relation::LessOrEqual => "<=",
            };
            let (left, right) = (of(*left), of(*right));
            format!(
                "if({left} {sign} {right}, {}, {})",
                of(*then),
                of(*otherwise)
            )
        }
        // Velocities for given generalised velocities take no linear system.
        Node::Solution { .. } => "0".to_owned(),
    }
}

fn literal(number: &Rational) -> String {
    let exact = number.to_big();
    format!("({exact})")
}
