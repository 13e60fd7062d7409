//! The context shared by all checks of the equations, and their results.

use appell_spec::mechanism::{Mechanism, ParameterId};

use super::ranges::Proposal;
use crate::mechanics::algebra::Algebra;
use crate::mechanics::elimination::eliminate;
use crate::mechanics::explicit::given_coordinates;
use crate::mechanics::expressions::Setting;
use crate::mechanics::finding::Finding;
use crate::mechanics::initial::InitialState;
use crate::mechanics::kinematics::{Effort, Kinematics};
use crate::mechanics::motions::motions;
use crate::mechanics::{Derivation, declared_ranges};
use crate::symbolic::print::{Setter, Spelled, text};
use crate::symbolic::{Expr, Graph, Intervals, Substitution};

/// Formulas with more operations are not shown in messages.
const MOST_OPERATIONS: usize = 16;

/// The results of an audit.
#[derive(Debug, Clone, Default)]
pub struct Audit {
    /// Warnings and notes.
    pub warnings: Vec<Finding>,
    /// Notes.
    pub notes: Vec<Finding>,
}

/// The context shared by all checks of the equations.
pub(super) struct Bench<'a> {
    pub(super) mechanism: &'a Mechanism,
    pub(super) derivation: &'a Derivation,
    /// A separate graph, so that the emitted equations do not depend on the audit.
    pub(super) algebra: Algebra,
    pub(super) declared: Intervals,
    pub(super) state: InitialState,
    /// Velocities with symbols for q̇.
    pub(super) unconstrained: Kinematics,
    /// Outputs in terms of coordinates and pseudo-velocities.
    pub(super) outputs: Vec<Expr>,
    /// Parameter limits that would make pivoting unnecessary.
    pub(super) limits: Option<Limits>,
    /// Coordinate ranges that would make pivoting unnecessary.
    pub(super) proposals: Vec<Proposal>,
}

impl<'a> Bench<'a> {
    /// `None` if an expression divides by zero, which the derivation reports.
    pub(super) fn new(mechanism: &'a Mechanism, derivation: &'a Derivation) -> Option<Self> {
        let symbols = &derivation.symbols;
        let graph = derivation.algebra.graph.clone();
        let mut algebra = Algebra::new(graph, mechanism, symbols);
        let free = Setting::free(mechanism, symbols);
        algebra.given = given_coordinates(&mut algebra, free);
        let unconstrained = Kinematics::new(&mut algebra, free, &[], Effort::Plain).ok()?;
        let outputs = outputs(&mut algebra, mechanism, derivation)?;
        Some(Self {
            mechanism,
            derivation,
            declared: declared_ranges(&algebra.graph, mechanism, symbols),
            state: InitialState::new(&algebra.graph, mechanism, symbols),
            algebra,
            unconstrained,
            outputs,
            limits: None,
            proposals: Vec::new(),
        })
    }

    /// The motion in terms of the pseudo-velocities.
    pub(super) fn setting(&self) -> Setting<'a> {
        let Derivation {
            symbols,
            velocities,
            ..
        } = self.derivation;
        Setting::new(self.mechanism, symbols, &velocities.rates)
    }

    /// The motion with symbols for the generalised velocities.
    pub(super) fn free(&self) -> Setting<'a> {
        Setting::free(self.mechanism, &self.derivation.symbols)
    }

    /// Coordinates whose rates need a pivoted solve in a mechanism with other ranges or limits; `None` without a
    /// solution.
    pub(super) fn pivoted(&mut self, other: &Mechanism) -> Option<Vec<usize>> {
        let Derivation {
            symbols,
            constraints,
            ..
        } = self.derivation;
        let mut ranges = declared_ranges(&self.algebra.graph, other, symbols);
        let free = Setting::free(other, symbols);
        let solved = eliminate(&mut self.algebra, free, constraints, &mut ranges).ok()?;
        Some(solved.open.coordinates)
    }

    /// An expression as displayed text, if it is short enough.
    pub(super) fn readable(&self, expr: Expr) -> Option<String> {
        let graph = &self.algebra.graph;
        (graph.operations(&[expr]) <= MOST_OPERATIONS).then(|| shown(graph, expr))
    }

    /// An expression as displayed text.
    pub(super) fn shown(&self, expr: Expr) -> String {
        shown(&self.algebra.graph, expr)
    }

    /// All expressions of the motion and its results, without reactions but with friction and position
    /// constraints.
    pub(super) fn equations(&self) -> Vec<Expr> {
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
        all.extend(&self.derivation.positions.residual);
        all
    }

    /// Whether all expressions are independent of a symbol.
    pub(super) fn are_independent_of(&mut self, exprs: &[Expr], symbol: Expr) -> bool {
        let Algebra { graph, test, .. } = &mut self.algebra;
        graph.as_symbol(symbol).is_some_and(|symbol| {
            let mut exprs = exprs.iter();
            exprs.all(|&expr| test.independent_of(graph, expr, symbol))
        })
    }
}

/// Outputs in terms of coordinates and pseudo-velocities.
fn outputs(
    algebra: &mut Algebra,
    mechanism: &Mechanism,
    derivation: &Derivation,
) -> Option<Vec<Expr>> {
    let symbols = &derivation.symbols;
    let setting = Setting::new(mechanism, symbols, &derivation.velocities.rates);
    let mut told = motions(algebra, symbols, &derivation.kinematics);
    // With symbols for ω̇, whose value follows from the equations alone.
    let named = &derivation.responses_in_outputs;
    let mut named = Substitution::of_parts(&algebra.graph, named);
    let mut outputs = Vec::with_capacity(mechanism.outputs.len());
    for output in &mechanism.outputs {
        let graph = &mut algebra.graph;
        let value = setting.lower(graph, &output.value).ok()?;
        let value = told.apply(graph, value)?;
        outputs.push(named.apply(graph, value)?);
    }
    Some(outputs)
}

pub(super) fn shown(graph: &Graph, expr: Expr) -> String {
    let mut setter = Setter::new(Spelled).with_definitions_inline();
    text(&setter.set(graph, expr).math)
}

/// Parameter limits with which the rates have an explicit formula instead of a pivoted solve.
#[derive(Debug, Clone)]
pub(super) struct Limits {
    /// Expressions that they keep nonzero.
    pub(super) divisors: Vec<Expr>,
    /// Parameters with their missing limits, in their units.
    pub(super) parameters: Vec<(ParameterId, [Option<f64>; 2])>,
}

impl Limits {
    /// Whether they keep an expression nonzero.
    pub(super) fn keep_off_zero(&self, expr: Expr) -> bool {
        self.divisors.contains(&expr)
    }
}
