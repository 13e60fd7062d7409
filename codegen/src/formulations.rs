//! Verifies the derived equations against Kane's equations and Lagrange's equations with multipliers.
//!
//! Both are derived independently in the ground frame, following the textbook: rotation matrices are multiplied out,
//! positions are differentiated, nothing is simplified. They share with the derivation the lowering of expressions,
//! the graph, the [derivative along a motion](crate::mechanics::time), the [rank test](crate::mechanics::rank), and
//! q̇ as functions of the pseudo-velocities, which are first checked against the definitions and the constraints.
//!
//! Equality is decided by the [identity test](crate::symbolic::identity). If that is inconclusive, because it lacks a
//! theorem about a function, values at random points decide.

mod comparison;
mod inertial;
mod kane;
mod lagrange;
mod loads;
mod points;
mod typed;

use appell_spec::mechanism::{Constraint, ConstraintKind, Mechanism};

use crate::mechanics::algebra::Algebra;
use crate::mechanics::expressions::Setting;
use crate::mechanics::finding::Outcome;
use crate::mechanics::kinematics::root_of;
use crate::mechanics::row;
use crate::mechanics::{Derivation, reactions, seed};
use crate::symbolic::vector::Vec3;
use crate::symbolic::{Expr, Graph, IdentityTest};

use comparison::Pair;
use inertial::{Inertial, Row};
use lagrange::Lagrange;
use points::Points;

pub use comparison::{Against, Agreement, Comparison, FormulationComparison};
pub use typed::{Typed, compare_typed};

/// Largest admissible error probability of an identity proof.
const GREATEST_ERROR: f64 = 1e-9;
/// Maximum number of independent tests that together prove an identity.
const MOST_TESTS: i32 = 4;

/// Quantities compared with Kane's equations.
const BY_KANE: [&str; 4] = ["mass matrix", "bias", "forces", "accelerations"];
/// Quantities compared with Lagrange's equations.
const BY_LAGRANGE: [&str; 2] = ["accelerations", "constraint forces"];

/// A quantity by the derivation and by another formulation.
struct Claim {
    against: Against,
    quantity: &'static str,
    /// None if the time limit was reached before they were derived.
    pairs: Vec<Pair>,
}

impl Claim {
    fn new(against: Against, quantity: &'static str, pairs: Vec<Pair>) -> Self {
        Self {
            against,
            quantity,
            pairs,
        }
    }
}

/// Compares a derivation with the other formulations of the same mechanism. Fails if their equations exceed the limit
/// on the number of expressions.
pub fn compare(mechanism: &Mechanism, derivation: &Derivation) -> Outcome<FormulationComparison> {
    compare_while(mechanism, derivation, &|| true)
}

/// [`compare`] within a time limit: `is_time` is queried before every formulation and every entry.
pub fn compare_while(
    mechanism: &Mechanism,
    derivation: &Derivation,
    is_time: &dyn Fn() -> bool,
) -> Outcome<FormulationComparison> {
    let symbols = &derivation.symbols;
    // A separate graph: the emitted equations do not depend on the comparison.
    let graph = derivation.algebra.graph.clone();
    let mut algebra = Algebra::new(graph, mechanism, symbols);
    let mut judge = Judge::new(mechanism, derivation);
    let mut comparisons = Vec::new();
    for claim in claims(&mut algebra, mechanism, derivation, is_time)? {
        comparisons.push(Comparison {
            against: claim.against,
            quantity: claim.quantity,
            agreement: judge.agreement(&mut algebra, &claim.pairs, is_time),
        });
    }
    Ok(FormulationComparison {
        comparisons,
        error_bound: judge.error_bound,
    })
}

/// All quantities to be compared.
fn claims(
    algebra: &mut Algebra,
    mechanism: &Mechanism,
    derivation: &Derivation,
    is_time: &dyn Fn() -> bool,
) -> Outcome<Vec<Claim>> {
    let Derivation {
        symbols,
        gibbs,
        motion,
        ..
    } = derivation;
    let rates = &derivation.velocities.rates;
    let speeds = mechanism.pseudo_velocities.iter();
    let speeds: Vec<&str> = speeds.map(|w| w.label.name.as_str()).collect();
    let by_speed = |derived: &[Expr], other: &[Expr]| named(&speeds, derived, other);

    let reactions = &derivation.reactions_in_loads;
    let setting = Setting::new(mechanism, symbols, rates);
    let allowed = Inertial::new(algebra, setting, reactions)?;
    let definitions = allowed.definitions(algebra)?;
    let rows = allowed.rows(algebra)?;
    let violated = rows.iter().map(|row| Pair {
        entry: mechanism.constraints[row.constraint].name.clone(),
        derived: row.value,
        other: Graph::ZERO,
    });
    let defined = by_speed(&symbols.speeds, &definitions);
    let mut claims = vec![
        Claim::new(Against::Spec, "pseudo-velocities", defined),
        Claim::new(Against::Spec, "constraints", violated.collect()),
    ];
    if !is_time() {
        claims.extend(not_reached(Against::Kane, &BY_KANE));
        claims.extend(not_reached(Against::Lagrange, &BY_LAGRANGE));
        return Ok(claims);
    }

    let given: Vec<(usize, Expr)> = derivation.given.rates().collect();
    let kane = kane::kane(algebra, &allowed, &motion.accelerations, &given)?;
    let entries = speeds
        .iter()
        .flat_map(|row| speeds.iter().map(move |column| format!("{row}, {column}")));
    let entries: Vec<String> = entries.collect();
    let entries: Vec<&str> = entries.iter().map(String::as_str).collect();
    let (mass, other) = (gibbs.mass_matrix.concat(), kane.mass_matrix.concat());
    let by_kane = [
        named(&entries, &mass, &other),
        by_speed(&gibbs.bias, &kane.bias),
        by_speed(&derivation.forces, &kane.forces),
        by_speed(&motion.accelerations, &kane.accelerations),
    ];
    let by_kane = BY_KANE.into_iter().zip(by_kane);
    claims.extend(by_kane.map(|(quantity, pairs)| Claim::new(Against::Kane, quantity, pairs)));
    if !is_time() {
        claims.extend(not_reached(Against::Lagrange, &BY_LAGRANGE));
        return Ok(claims);
    }

    let unconstrained = Inertial::new(algebra, Setting::free(mechanism, symbols), reactions)?;
    let lagrange = lagrange::lagrange(algebra, &unconstrained, rates, &given)?;
    let coordinates = mechanism.coordinates.iter();
    let coordinates: Vec<&str> = coordinates.map(|q| q.label.name.as_str()).collect();
    let accelerations = generalized_accelerations(algebra, &allowed, &motion.accelerations)?;
    let pairs = named(&coordinates, &accelerations, &lagrange.accelerations);
    claims.push(Claim::new(Against::Lagrange, BY_LAGRANGE[0], pairs));
    claims.extend(reaction_claims(
        algebra,
        derivation,
        mechanism,
        &rows,
        &lagrange,
        kane.total_reaction,
    )?);
    claims.retain(|claim| !claim.pairs.is_empty());
    Ok(claims)
}

/// Quantities not compared because the time limit was reached.
fn not_reached(against: Against, quantities: &[&'static str]) -> impl Iterator<Item = Claim> {
    let quantities = quantities.iter();
    quantities.map(move |&quantity| Claim::new(against, quantity, Vec::new()))
}

/// Constraint forces against Lagrange's multipliers, and their sum against Newton's law.
fn reaction_claims(
    algebra: &mut Algebra,
    derivation: &Derivation,
    mechanism: &Mechanism,
    rows: &[Row],
    lagrange: &Lagrange,
    total: Vec3,
) -> Outcome<Vec<Claim>> {
    let constraints = &derivation.constraints;
    let forces = reactions::reactions(
        algebra,
        Setting::free(mechanism, &derivation.symbols),
        constraints,
        &derivation.velocities.violating,
        &derivation.bodies,
        &derivation.motion.accelerations,
        &derivation.reactions_in_loads,
    )?;
    // Reactions at each site from the multipliers, which do not include those of geometry.
    let mut known = vec![[Some(Graph::ZERO); 3]; forces.len()];
    let graph = &mut algebra.graph;
    for (row, &multiplier) in rows.iter().zip(&lagrange.multipliers) {
        let reported = constraints.rows_of(row.constraint).next();
        let Some(place) = reported.and_then(|row| constraints.reported(row)) else {
            continue;
        };
        let place = &mut known[place];
        for (component, &direction) in place.iter_mut().zip(&row.direction) {
            if direction == Graph::ZERO {
                continue;
            }
            *component = component.zip(multiplier).map(|(sum, multiplier)| {
                let part = graph.mul(multiplier, direction);
                graph.add(sum, part)
            });
        }
    }
    let axes = ["x", "y", "z"];
    let mut pairs = Vec::new();
    for ((place, force), known) in constraints.reactions.iter().zip(&forces).zip(&known) {
        for ((axis, &derived), known) in axes.iter().zip(force).zip(known) {
            if let (Some(other), false) = (*known, lagrange.redundant) {
                let entry = format!("{}, {axis}", place.name);
                pairs.push(Pair {
                    entry,
                    derived,
                    other,
                });
            }
        }
    }
    let mut claims = vec![Claim::new(Against::Lagrange, BY_LAGRANGE[1], pairs)];
    // The actuators of prescribed motions also have reactions.
    let is_driven = !derivation.given.is_empty();
    if !rows.is_empty() && !is_driven && rests_on_contacts(derivation, mechanism) {
        let mut sum = [Graph::ZERO; 3];
        for &force in &forces {
            sum = algebra.graph.add3(sum, force);
        }
        let (quantity, pairs) = ("sum of the constraint forces", named(&axes, &sum, &total));
        claims.push(Claim::new(Against::Newton, quantity, pairs));
    }
    Ok(claims)
}

/// Whether the mechanism is supported only by contacts with reported reactions: all bodies are connected to one
/// point, and geometry transmits no other external force.
fn rests_on_contacts(derivation: &Derivation, mechanism: &Mechanism) -> bool {
    let constraints = &derivation.constraints;
    let mut rows = constraints.rows.iter();
    // A position constraint maintained by a contact has no separate reaction.
    let told = |row: &row::Row| match constraints.reported(row) {
        Some(_) => row.root.is_some(),
        None => row.of_position && row.redundant,
    };
    let rolls = |c: &Constraint| matches!(c.kind, ConstraintKind::Rolling { .. });
    let mut roots = mechanism
        .bodies
        .iter()
        .map(|body| root_of(mechanism, body.centre));
    let first = roots.next();
    mechanism.constraints.iter().any(rolls)
        && rows.all(told)
        && roots.all(|root| Some(root) == first)
}

/// q̈ = d/dt q̇(ω, q, t)
fn generalized_accelerations(
    algebra: &mut Algebra,
    allowed: &Inertial<'_>,
    accelerations: &[Expr],
) -> Outcome<Vec<Expr>> {
    let Setting { symbols, rates, .. } = allowed.setting;
    let mut all = Vec::with_capacity(rates.len());
    for &rate in rates {
        let mut parts = vec![allowed.setting.rate(algebra, rate)];
        for (&speed, &acceleration) in symbols.speeds.iter().zip(accelerations) {
            let partial = algebra.derivative(rate, speed);
            parts.push(algebra.graph.mul(partial, acceleration));
        }
        all.push(algebra.graph.sum(&parts));
        algebra.check_size()?;
    }
    Ok(all)
}

/// Decides whether expressions agree, and sums the error probabilities of its proofs.
struct Judge<'a> {
    mechanism: &'a Mechanism,
    derivation: &'a Derivation,
    points: Option<Points>,
    error_bound: f64,
}

impl<'a> Judge<'a> {
    fn new(mechanism: &'a Mechanism, derivation: &'a Derivation) -> Self {
        Self {
            mechanism,
            derivation,
            points: None,
            error_bound: 0.0,
        }
    }

    /// A proof if possible, otherwise a comparison at points.
    fn agreement(
        &mut self,
        algebra: &mut Algebra,
        pairs: &[Pair],
        is_time: &dyn Fn() -> bool,
    ) -> Agreement {
        if let Some(error) = proof(algebra, pairs, seed(self.mechanism), is_time) {
            self.error_bound += error;
            return Agreement::Identical;
        }
        if pairs.is_empty() || !is_time() {
            return Agreement::NotReached;
        }
        let symbols = &self.derivation.symbols;
        let new = || Points::new(&algebra.graph, self.mechanism, symbols);
        let points = self.points.get_or_insert_with(new);
        points.compare(&algebra.graph, pairs)
    }
}

/// Bound on the error probability of a proof that all pairs are the same functions. `None` if there is no proof, or
/// no time for one.
fn proof(
    algebra: &mut Algebra,
    pairs: &[Pair],
    seed: u64,
    is_time: &dyn Fn() -> bool,
) -> Option<f64> {
    if pairs.is_empty() {
        return None;
    }
    let Algebra { graph, test, .. } = algebra;
    let differences = pairs.iter();
    let differences = differences.map(|pair| graph.sub(pair.derived, pair.other));
    let differences: Vec<Expr> = differences.collect();
    let all = graph.sum(&differences);
    let each = test.error_bound(graph, all);
    let error = |tests: i32| each.powi(tests) * differences.len() as f64;
    let tests = (1..=MOST_TESTS).find(|&tests| error(tests) <= GREATEST_ERROR)?;
    let holds = |test: &mut IdentityTest| {
        let mut differences = differences.iter();
        differences.all(|&d| is_time() && test.is_zero(graph, d))
    };
    // Every test draws its own random points.
    let more =
        (1..tests).map(|number| test.reseeded(seed.wrapping_add(number.unsigned_abs().into())));
    let more: Vec<IdentityTest> = more.collect();
    (holds(test) && more.into_iter().all(|mut test| holds(&mut test))).then(|| error(tests))
}

fn named(names: &[&str], derived: &[Expr], other: &[Expr]) -> Vec<Pair> {
    let both = derived.iter().zip(other);
    let pair = |(name, (&derived, &other)): (&&str, (&Expr, &Expr))| Pair {
        entry: (*name).to_owned(),
        derived,
        other,
    };
    names.iter().zip(both).map(pair).collect()
}
