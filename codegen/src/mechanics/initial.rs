//! Checks the equations at the initial state, where singularities are most likely: arms stretched out, angles
//! at zero, springs of zero length.

use appell_spec::Code;
use appell_spec::mechanism::{Connection, GROUND, Mechanism, Signal, SpeedId};

use super::algebra::Algebra;
use super::finding::{Finding, Item};
use super::kinematics::Kinematics;
use super::motion::Motion;
use super::symbols::{Symbols, ids, speed_name};
use crate::symbolic::{Expr, Graph, SymbolId, evaluate};

/// Values of all symbols at the initial state, without inputs.
pub struct InitialState {
    /// By symbol.
    values: Vec<f64>,
    /// Coordinates with a declared range.
    ranges: Vec<(SymbolId, [f64; 2])>,
}

impl InitialState {
    /// From the initial values and the parameters of a spec.
    pub fn new(graph: &Graph, mechanism: &Mechanism, symbols: &Symbols) -> Self {
        let mut values = vec![0.0; graph.symbol_count()];
        let parameters = symbols.parameters.iter().copied();
        let coordinates = symbols.coordinates.iter().copied();
        let speeds = symbols.speeds.iter().copied();
        let signals = symbols.signals.iter().map(|orders| orders[0]);
        let first = |signal: &Signal| signal.values.first().copied().unwrap_or(0.0);
        let known = parameters
            .zip(mechanism.parameters.iter().map(|p| p.value))
            .chain(coordinates.zip(mechanism.coordinates.iter().map(|q| q.initial)))
            .chain(speeds.zip(mechanism.pseudo_velocities.iter().map(|w| w.initial)))
            .chain(signals.zip(mechanism.signals.iter().map(first)))
            .chain([(symbols.pi, std::f64::consts::PI)]);
        for (symbol, number) in known {
            if let Some(symbol) = graph.as_symbol(symbol) {
                values[symbol.0 as usize] = number;
            }
        }
        let ranges = ids(graph, &symbols.coordinates)
            .into_iter()
            .zip(&mechanism.coordinates)
            .filter_map(|(symbol, q)| Some((symbol, q.range?)))
            .collect();
        Self { values, ranges }
    }

    /// Values by symbol.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Values of expressions.
    pub fn of(&self, graph: &Graph, exprs: &[Expr]) -> Vec<f64> {
        evaluate(graph, &self.values, exprs)
    }

    /// Whether an expression is zero at the initial state or changes sign between it and an end of a
    /// coordinate's range.
    fn vanishes(&self, graph: &Graph, expr: Expr) -> bool {
        let here = self.of(graph, &[expr])[0];
        here == 0.0
            || self.ranges.iter().any(|&(symbol, ends)| {
                graph.mentions(expr, &[symbol])
                    && ends.iter().any(|&end| {
                        let mut values = self.values.clone();
                        values[symbol.0 as usize] = end;
                        evaluate(graph, &values, &[expr])[0] * here < 0.0
                    })
            })
    }
}

/// Springs and dampers with undefined direction: those of zero length at the initial state, or aligned with an
/// axis and reversing direction inside the declared ranges.
pub fn vanishing_lengths(
    algebra: &mut Algebra,
    mechanism: &Mechanism,
    kinematics: &Kinematics,
    state: &InitialState,
) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (index, load) in mechanism.loads.entries() {
        let Some(&Connection::Points(a, b)) = load.kind.between() else {
            continue;
        };
        let graph = &mut algebra.graph;
        let d = kinematics.between(graph, a, b, GROUND);
        let lasting: Vec<Expr> = d.into_iter().filter(|&c| c != Graph::ZERO).collect();
        let vanishes = match *lasting {
            [component] => state.vanishes(graph, component),
            _ => state.of(graph, &lasting).iter().all(|&c| c == 0.0),
        };
        if vanishes {
            let [a, b] = [a, b].map(|point| &mechanism.points[point].name);
            findings.push(Finding {
                code: Code::VanishingLength,
                message: format!(
                    "the distance between `{a}` and `{b}` can be zero in the declared ranges: the \
                     load has no direction there"
                ),
                item: Item::Load(index),
                help:
                    "connect other points, start elsewhere, or declare ranges of the coordinates \
                       that keep the points apart; a spring on a coordinate needs no direction"
                        .to_owned(),
            });
        }
    }
    findings
}

/// A rate larger than every pseudo-velocity by this factor results from division by a rounded zero.
const LOST: f64 = 1e13;

/// Singular equations at the initial state.
pub fn singularities(
    graph: &Graph,
    mechanism: &Mechanism,
    rates: &[Expr],
    motion: &Motion,
    state: &InitialState,
) -> Vec<Finding> {
    let mut findings = Vec::new();
    let speeds = mechanism.pseudo_velocities.iter();
    let fastest = speeds.fold(0.0, |most: f64, speed| most.max(speed.initial.abs()));
    for (q, rate) in mechanism.coordinates.iter().zip(state.of(graph, rates)) {
        // A right angle in degrees is exact only up to rounding.
        let is_lost = fastest > 0.0 && rate.abs() > LOST * fastest;
        if is_lost || !rate.is_finite() {
            findings.push(Finding {
                code: Code::SingularPseudoVelocities,
                message: format!(
                    "pseudo-velocities and constraints do not determine `dot({})` at the initial \
                     state",
                    q.label.name
                ),
                item: Item::Mechanism,
                help: "start elsewhere, or choose pseudo-velocities that are independent there"
                    .to_owned(),
            });
        }
    }
    if !findings.is_empty() {
        return findings;
    }
    let (speeds, pivots): (Vec<usize>, Vec<Expr>) = motion.pivots().into_iter().unzip();
    for (speed, value) in speeds.into_iter().zip(state.of(graph, &pivots)) {
        if value == 0.0 || !value.is_finite() {
            let name = speed_name(mechanism, speed);
            findings.push(Finding {
                code: Code::SingularMassMatrix,
                message: format!("the mass matrix is singular for `{name}` at the initial state"),
                item: Item::PseudoVelocity(SpeedId::new(speed)),
                help: "give mass or inertia to what it moves, or start elsewhere".to_owned(),
            });
        }
    }
    findings
}
