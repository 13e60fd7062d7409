//! What is legal in a mechanism, and yet hardly meant: seen in its equations, told in terms of
//! physics.
//!
//! The derivation refuses what has no equations of motion. The audit reads the equations of what it
//! accepts; each file is one question about them. Whatever cannot be proven or shown is not told.

mod contact;
mod determination;
mod idle;
mod integrability;
mod passivity;
mod reaction;
mod samples;
mod work;

use appell_spec::Code;
use appell_spec::mechanism::Mechanism;

use crate::mechanics::algebra::Algebra;
use crate::mechanics::expressions::Lowering;
use crate::mechanics::finding::Finding;
use crate::mechanics::initial::InitialState;
use crate::mechanics::kinematics::{Effort, Kinematics};
use crate::mechanics::symbols::Symbols;
use crate::mechanics::{Derivation, declared_ranges, seed};
use crate::symbolic::print::{Setter, Spelled, text};
use crate::symbolic::{Expr, Graph, Intervals};

/// Nobody reads a formula with more operations in a message.
const MOST_OPERATIONS: usize = 16;

/// What an audit tells.
#[derive(Debug, Clone, Default)]
pub struct Audit {
    /// What looks unintended.
    pub warnings: Vec<Finding>,
    /// What is worth knowing.
    pub notes: Vec<Finding>,
}

/// What every question about the equations needs.
struct Bench<'a> {
    mechanism: &'a Mechanism,
    derivation: &'a Derivation,
    /// A graph of its own: the emitted equations do not depend on the audit.
    algebra: Algebra,
    declared: Intervals,
    state: InitialState,
    /// Velocities with symbols for q̇.
    unconstrained: Kinematics,
    /// Outputs in terms of coordinates and pseudo-velocities.
    outputs: Vec<Expr>,
}

/// Audits a mechanism whose equations of motion have been derived.
pub fn audit(mechanism: &Mechanism, derivation: &Derivation) -> Audit {
    let Some(mut bench) = Bench::new(mechanism, derivation) else {
        return Audit::default();
    };
    let mut told = Audit::default();
    let contacts = contact::findings(&mut bench.algebra, mechanism, &derivation.symbols);
    let is_told = |item| contacts.iter().any(|finding| finding.item == item);
    told.notes = integrability::findings(&mut bench);
    told.notes.retain(|note| !is_told(note.item));
    told.warnings = contacts;
    for question in [
        determination::audit,
        idle::audit,
        work::audit,
        passivity::audit,
        reaction::audit,
    ] {
        question(&mut bench, &mut told);
    }
    told
}

/// What may be the reason why a mechanism has no equations of motion: contacts that take a velocity
/// more than their author thought.
pub fn reasons(mechanism: &Mechanism, refused: &[Finding]) -> Vec<Finding> {
    let counted = [
        Code::MissingPseudoVelocities,
        Code::SingularPseudoVelocities,
        Code::DependentConstraints,
        Code::RedundantConstraint,
    ];
    if !refused
        .iter()
        .any(|finding| counted.contains(&finding.code))
    {
        return Vec::new();
    }
    let mut graph = Graph::new();
    let symbols = Symbols::new(&mut graph, mechanism);
    let mut algebra = Algebra::new(graph, &symbols, seed(mechanism));
    contact::findings(&mut algebra, mechanism, &symbols)
}

impl<'a> Bench<'a> {
    /// `None` where an expression divides by zero, which the derivation tells.
    fn new(mechanism: &'a Mechanism, derivation: &'a Derivation) -> Option<Self> {
        let symbols = &derivation.symbols;
        let graph = derivation.algebra.graph.clone();
        let mut algebra = Algebra::new(graph, symbols, seed(mechanism));
        let unconstrained = unconstrained(&mut algebra, mechanism, symbols)?;
        let lowering = Lowering {
            symbols,
            rates: &derivation.velocities.rates,
        };
        let outputs = mechanism.outputs.iter();
        let outputs = outputs.map(|output| lowering.lower(&mut algebra.graph, &output.value));
        let outputs = outputs.collect::<Result<_, _>>().ok()?;
        Some(Self {
            mechanism,
            derivation,
            declared: declared_ranges(&algebra.graph, mechanism, symbols),
            state: InitialState::new(&algebra.graph, mechanism, symbols),
            algebra,
            unconstrained,
            outputs,
        })
    }

    /// An expression as people read it, where they would.
    fn readable(&self, expr: Expr) -> Option<String> {
        let graph = &self.algebra.graph;
        (graph.operations(&[expr]) <= MOST_OPERATIONS).then(|| shown(graph, expr))
    }

    /// An expression as people read it.
    fn shown(&self, expr: Expr) -> String {
        shown(&self.algebra.graph, expr)
    }

    /// Everything that the motion and its results consist of, without reactions but with friction.
    fn equations(&self) -> Vec<Expr> {
        let Derivation {
            contacts,
            coordinate_rates,
            gibbs,
            forces,
            loads,
            ..
        } = self.derivation;
        let mut all: Vec<Expr> = gibbs.mass_matrix.iter().flatten().copied().collect();
        all.extend(&gibbs.bias);
        all.extend(forces);
        all.extend(coordinate_rates);
        all.extend(loads.iter().filter_map(|load| load.potential));
        all.extend(&self.outputs);
        all.extend(contacts.iter().filter_map(|contact| contact.friction));
        all
    }

    /// Whether none of the expressions changes with a symbol.
    fn are_independent_of(&mut self, exprs: &[Expr], symbol: Expr) -> bool {
        let Algebra { graph, test, .. } = &mut self.algebra;
        graph.as_symbol(symbol).is_some_and(|symbol| {
            let mut exprs = exprs.iter();
            exprs.all(|&expr| test.independent_of(graph, expr, symbol))
        })
    }
}

/// Velocities with symbols for q̇.
fn unconstrained(
    algebra: &mut Algebra,
    mechanism: &Mechanism,
    symbols: &Symbols,
) -> Option<Kinematics> {
    let rates = &symbols.rates;
    Kinematics::new(algebra, mechanism, symbols, rates, &[], Effort::Plain).ok()
}

/// An expression that only its zeros matter of.
fn zero_or(algebra: &mut Algebra, expr: Expr) -> Expr {
    if algebra.test.is_zero(&algebra.graph, expr) {
        Graph::ZERO
    } else {
        expr
    }
}

fn shown(graph: &Graph, expr: Expr) -> String {
    let mut setter = Setter::new(Spelled).with_definitions_inline();
    text(&setter.set(graph, expr).math)
}

/// Names in a sentence: `` `a`, `b` ``.
fn listed<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    let names: Vec<String> = names.into_iter().map(|name| format!("`{name}`")).collect();
    names.join(", ")
}
