//! Linear creep of rolling contacts.
//!
//! A wheel of rubber or steel creeps under load. In the range where the creep velocity is linear in the force,
//! it is
//!
//! `s = -|v| (κₗ Fₗ eₗ + κₜ Fₜ eₜ) / N`,
//!
//! with v the velocity of the contact along the surface, eₗ its direction and eₜ across it, F the force on the
//! wheel and N its normal part (J. J. Kalker, *Three-Dimensional Elastic Bodies in Rolling Contact*, 1990,
//! linear theory). The constraint rows of the contact equal s instead of zero. F is the force of pure rolling:
//! its change due to creep is of second order in κ.
//!
//! Creep couples inertially. With the creep velocities s as additional pseudo-velocities and `[M m]` the rows of the
//! mass matrix for ω, Appell's equations are `M ω̇ + m ṡ + b(q, ω, s) = Π(q, ω, s)`. The state is `w = ω + M⁻¹ m s`,
//! and
//!
//! `M ẇ = Π - b + (ṁ - Ṁ M⁻¹ m) s`,
//!
//! which does not contain ṡ. Changes of s act without delay.

use appell_spec::Code;
use appell_spec::mechanism::{ConstraintId, ConstraintKind, Creep, GROUND, Mechanism, PointId};

use super::Derivation;
use super::contacts::Contact;
use super::expressions::Setting;
use super::finding::{Finding, Item, Outcome};
use super::gibbs_appell::{GibbsForm, body_motions, gibbs_form};
use super::kinematics::{Effort, Kinematics};
use super::loads::{applied_loads, generalized_forces, settle};
use super::motion::{self, Way};
use super::named_rates;
use crate::symbolic::vector::{self, Vec3};
use crate::symbolic::{Expr, Graph, Rational, Substitution};

/// Below this velocity of travel, in mm/s, creep tends to zero.
const SLOW: i64 = 1;

/// A contact with creep.
struct Creeping<'m> {
    constraint: ConstraintId,
    point: PointId,
    creep: &'m Creep,
    contact: Contact,
}

/// Applies the first-order changes due to creep in all contacts that have it to q̇, b, Π and ω̇.
pub fn let_contacts_creep(derivation: &mut Derivation, mechanism: &Mechanism) -> Outcome<()> {
    let creeping = creeping(derivation, mechanism)?;
    if creeping.is_empty() {
        return Ok(());
    }
    let slides = sliding(derivation, mechanism, &creeping)?;
    let violated = derivation.velocities.violating.clone();
    let symbols = derivation.symbols.clone();
    let algebra = &mut derivation.algebra;

    // Appell's equations with creep velocities as speeds.
    let (free, held): (Vec<Expr>, Vec<Expr>) = violated
        .rates
        .iter()
        .partition(|rate| slides.iter().any(|(own, _)| own == *rate));
    let mut held = Substitution::by_zero(&algebra.graph, &held);
    let rates = algebra.apply(&mut held, &violated.coordinate_rates)?;
    let setting = Setting::new(mechanism, &symbols, &rates);
    let kinematics = Kinematics::new(algebra, setting, &[], Effort::Plain)?;
    let directions = [symbols.speeds.as_slice(), &free].concat();
    let bodies = body_motions(algebra, setting, &kinematics, &directions)?;
    let sliding = gibbs_form(algebra, &bodies, directions.len());
    let mut loads = applied_loads(algebra, setting, &kinematics)?;
    let reactions = &derivation.reactions_in_loads;
    settle(&mut loads, &mut algebra.graph, mechanism, reactions)?;
    let forces = generalized_forces(algebra, &loads, &symbols.speeds);

    // m s, and the term of its rate.
    let rolling = derivation.velocities.rates.clone();
    let rolling = Setting::new(mechanism, &symbols, &rolling);
    let mut momenta = Vec::with_capacity(symbols.speeds.len());
    let mut changes = Vec::with_capacity(symbols.speeds.len());
    for row in &sliding.mass_matrix[..symbols.speeds.len()] {
        let (mut momentum, mut change) = (Vec::new(), Vec::new());
        for (rate, &mass) in free.iter().zip(&row[symbols.speeds.len()..]) {
            let slide = slides
                .iter()
                .find(|(own, _)| own == rate)
                .map_or(Graph::ZERO, |own| own.1);
            momentum.push(algebra.graph.mul(mass, slide));
            let rate = rolling.rate(algebra, mass);
            change.push(algebra.graph.mul(rate, slide));
        }
        momenta.push(algebra.graph.sum(&momentum));
        changes.push(change);
    }
    let shares = per_mass(derivation, mechanism, &momenta)?;
    let algebra = &mut derivation.algebra;
    for (change, row) in changes.iter_mut().zip(&derivation.gibbs.mass_matrix) {
        for (&mass, &share) in row.iter().zip(&shares) {
            let rate = rolling.rate(algebra, mass);
            let part = algebra.graph.mul(rate, share);
            change.push(algebra.graph.neg(part));
        }
    }

    let mut actual = Substitution::of_parts(&algebra.graph, &slides);
    for (&speed, &share) in symbols.speeds.iter().zip(&shares) {
        let left = algebra.graph.sub(speed, share);
        actual.replace(&algebra.graph, speed, left);
    }
    let bias = algebra.apply(&mut actual, &sliding.bias[..symbols.speeds.len()])?;
    let mut forces = algebra.apply(&mut actual, &forces)?;
    let coordinate_rates = algebra.apply(&mut actual, &rates)?;
    let graph = &mut algebra.graph;
    for (force, change) in forces.iter_mut().zip(changes) {
        let change = graph.sum(&change);
        *force = graph.add(*force, change);
    }
    derivation.given.refuse_beside("contacts that creep")?;
    derivation.gibbs.bias = bias;
    let (gibbs, way) = (&derivation.gibbs, Way::Shortest);
    derivation.motion = motion::solve(algebra, mechanism, gibbs, &forces, &[], way)?;
    derivation.forces = forces;
    derivation.recursion = None;
    derivation.coordinate_rates = named_rates(&mut algebra.graph, mechanism, &coordinate_rates);
    Ok(())
}

/// The rate at which each row of a creeping contact is violated: its symbol and its value.
fn sliding(
    derivation: &mut Derivation,
    mechanism: &Mechanism,
    creeping: &[Creeping<'_>],
) -> Outcome<Vec<(Expr, Expr)>> {
    let forces = derivation.reactions(mechanism)?;
    let mut sliding = Vec::new();
    for one in creeping {
        let slides = one.slides(derivation, mechanism, forces[one.contact.place])?;
        let rates = &derivation.velocities.violating.rates;
        for (row, &rate) in derivation.constraints.rows.iter().zip(rates) {
            if row.constraint == one.constraint && !row.is_embedded() {
                let graph = &mut derivation.algebra.graph;
                sliding.push((rate, graph.dot(row.reaction.direction, slides)));
            }
        }
    }
    Ok(sliding)
}

/// The contacts with creep.
fn creeping<'m>(derivation: &Derivation, mechanism: &'m Mechanism) -> Outcome<Vec<Creeping<'m>>> {
    let mut creeping = Vec::new();
    for (constraint, item) in mechanism.constraints.entries() {
        let ConstraintKind::Rolling {
            contact: point,
            creep: Some(creep),
            ..
        } = &item.kind
        else {
            continue;
        };
        let mut contacts = derivation.contacts.iter();
        let contact = contacts
            .find(|contact| contact.constraint == constraint)
            .filter(|_| derivation.dependent.values.is_empty())
            .ok_or_else(|| vec![not_judged(&item.name, constraint)])?;
        creeping.push(Creeping {
            constraint,
            point: *point,
            creep,
            contact: contact.clone(),
        });
    }
    Ok(creeping)
}

impl Creeping<'_> {
    /// Creep velocity, in the ground.
    fn slides(
        &self,
        derivation: &mut Derivation,
        mechanism: &Mechanism,
        force: Vec3,
    ) -> Outcome<Vec3> {
        let rates = &derivation.velocities.rates;
        let setting = Setting::new(mechanism, &derivation.symbols, rates);
        let graph = &mut derivation.algebra.graph;
        let item = Item::Constraint(self.constraint);
        let longitudinal = setting.lower_in(graph, item, &self.creep.longitudinal)?;
        let lateral = setting.lower_in(graph, item, &self.creep.lateral)?;
        let travel = (derivation.kinematics).velocity_in(graph, self.point, GROUND);
        let across = graph.cross(self.contact.normal, travel);
        let square = graph.dot(travel, travel);
        let slow = graph.number(Rational::new(SLOW * SLOW, 1_000_000));
        let square = graph.add(square, slow);
        let speed = graph.sqrt(square);
        let normal = graph.dot(force, self.contact.normal);
        let divisor = graph.mul(normal, speed);
        let mut slides = vector::ZERO;
        for (kappa, direction) in [(longitudinal, travel), (lateral, across)] {
            let along = graph.dot(force, direction);
            let along = graph.mul(kappa, along);
            let along = graph.div(along, divisor);
            let part = graph.scale3(along, direction);
            slides = graph.sub3(slides, part);
        }
        Ok(slides)
    }
}

/// Multiplies a vector by M⁻¹.
pub(super) fn per_mass(
    derivation: &mut Derivation,
    mechanism: &Mechanism,
    momenta: &[Expr],
) -> Outcome<Vec<Expr>> {
    let algebra = &mut derivation.algebra;
    // Solved with symbols, so that no intermediate quantity is named an acceleration.
    let kicks: Vec<Expr> = (0..momenta.len())
        .map(|i| algebra.graph.symbol(&format!("kick_{i}")))
        .collect();
    let without_bias = GibbsForm {
        bias: vec![Graph::ZERO; momenta.len()],
        ..derivation.gibbs.clone()
    };
    let way = derivation.dependent.way();
    let solved = motion::solve(algebra, mechanism, &without_bias, &kicks, &[], way)?;
    let mut all = Vec::with_capacity(momenta.len());
    for &solved in &solved.accelerations {
        let mut parts = Vec::with_capacity(momenta.len());
        for (&kick, &momentum) in kicks.iter().zip(momenta) {
            let mobility = algebra.derivative(solved, kick);
            parts.push(algebra.graph.mul(mobility, momentum));
        }
        all.push(algebra.graph.sum(&parts));
    }
    Ok(all)
}

fn not_judged(name: &str, constraint: ConstraintId) -> Finding {
    Finding {
        code: Code::CreepNotJudged,
        message: format!("the creep of `{name}` cannot be computed: its forces are undetermined"),
        item: Item::Constraint(constraint),
        help:
            "creep requires the normal of the surface, a determinate reaction of this contact alone, \
               and generalised velocities in closed form"
                .to_owned(),
    }
}
