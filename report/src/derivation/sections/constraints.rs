//! Constraints, pseudo-velocities, the generalised velocities that solve both and where they do; constraint forces.

use appell_codegen::mechanics::expressions::Setting;
use appell_codegen::mechanics::finding::Outcome;
use appell_codegen::mechanics::reactions::reactions;
use appell_codegen::mechanics::{parameter_ranges, row};
use appell_codegen::symbolic::{Expr, Graph, Intervals, Node};
use appell_spec::mechanism::{ConstraintId, ConstraintKind, CoordinateId, GROUND};

use super::super::lexicon::AXES;
use super::super::{About, Block, Equation, Letter, Math, Row, Section, Span, Writer};
use super::phrases::{
    described, equality, headed, introduced, listed, math, sentence, table, with, words,
};
use super::placement::{from_to, lowered};
use super::quantities::{range, unit};

/// Constraints and pseudo-velocities.
pub(super) fn section(w: &mut Writer<'_>) -> Section {
    let mut blocks = Vec::new();
    for index in w.mechanism.constraints.ids() {
        blocks.extend(constraint(w, index));
    }
    blocks.push(sentence(
        "The pseudo-velocities are linear in the generalised velocities:",
    ));
    blocks.extend(table("", definitions(w)));
    blocks.push(sentence(
        "Below, ωᵢ is the i-th of them; rows and columns are in the same order.",
    ));
    let mut rows = w.derivation.constraints.rows.iter();
    let by = if rows.any(|row| !row.is_embedded()) {
        "With the constraints they determine the generalised velocities:"
    } else {
        "They determine the generalised velocities:"
    };
    let equations = rates(w);
    blocks.extend(with(w, by, equations));
    blocks.extend(conditions(w));
    if !w.derivation.velocities.solved_numerically.is_empty() {
        blocks.push(sentence(
            "No pivot of the linear system is nonzero in all declared ranges: it is solved with pivoting \
             at each evaluation.",
        ));
    }
    headed("Constraints and pseudo-velocities", blocks)
}

/// Generalised velocities in terms of the pseudo-velocities, without those that have the letter of
/// a pseudo-velocity.
pub(super) fn rates(w: &mut Writer<'_>) -> Vec<Equation> {
    let mut equations = Vec::new();
    for k in 0..w.mechanism.coordinates.len() {
        let left = w.symbol(w.derivation.symbols.rates[k]);
        let right = w.explicit(w.derivation.velocities.rates[k]);
        if left != right {
            let about = About::Rate(CoordinateId::new(k));
            equations.push(Equation::new(left, right).about(about));
        }
    }
    equations
}

fn constraint(w: &mut Writer<'_>, index: ConstraintId) -> Vec<Block> {
    let constraint = &w.mechanism.constraints[index];
    let mut what = vec![introduced(
        &constraint.name,
        &constraint.about,
        constraint.line,
    )];
    let rolling = rolling(w, &constraint.kind);
    let (mut open, mut held) = (Vec::new(), Vec::new());
    let mut axes = GROUND;
    for row in w.derivation.constraints.rows.clone() {
        if row.constraint != index {
            continue;
        }
        if row.is_embedded() {
            let component = row.name.rsplit('.').next().unwrap_or(&row.name);
            held.push(vec![words(component)]);
        } else {
            axes = row.along.frame;
            open.push(equation(w, &row));
        }
    }
    let is_rolling = rolling.is_some();
    if let Some(formula) = rolling {
        what.extend([words(": "), math(formula)]);
    }
    what.push(match (open.is_empty(), is_rolling, axes) {
        (true, ..) => words("."),
        (false, true, GROUND) => words(". In the ground:"),
        (false, true, axes) => words(&format!(". In {}:", w.frame(axes))),
        (false, false, _) => words(":"),
    });
    let mut blocks = vec![Block::Sentence(what)];
    blocks.extend(with(w, "", open));
    if !held.is_empty() {
        blocks.push(Block::Sentence(held_by_geometry(held)));
    }
    blocks
}

/// `v_P = v_G + ω × r_GP = 0` for a rolling body.
fn rolling(w: &Writer<'_>, kind: &ConstraintKind) -> Option<Math> {
    let (body, contact) = match *kind {
        ConstraintKind::Rolling { body, contact, .. } => (body, contact),
        // The rows suffice.
        ConstraintKind::Velocity { .. }
        | ConstraintKind::FixedVelocity { .. }
        | ConstraintKind::Position { .. } => return None,
    };
    let body = &w.mechanism.bodies[body];
    let (centre, contact) = (w.point(body.centre), w.point(contact));
    Some(Math::Row(vec![
        Math::Letter(Letter::bold("v").below(&contact)),
        Math::Sign("="),
        Math::Letter(Letter::bold("v").below(&centre)),
        Math::Sign("+"),
        Math::Letter(Letter::bold("ω").below(&body.name)),
        Math::Sign("×"),
        Math::Letter(Letter::bold("r").below(&from_to(&centre, &contact))),
        Math::Sign("="),
        Math::Words("0".to_owned()),
    ]))
}

/// `Σ coefficient · q̇ + rest = 0`
fn equation(w: &mut Writer<'_>, row: &row::Row) -> Equation {
    let mut parts = vec![row.rest];
    let rates = w.derivation.symbols.rates.clone();
    for (&coefficient, rate) in row.coefficients.iter().zip(rates) {
        parts.push(w.graph().mul(coefficient, rate));
    }
    let left = w.graph().sum(&parts);
    Equation::new(w.explicit(left), Math::zero()).about(About::Constraint(row.constraint))
}

fn held_by_geometry(components: Vec<Vec<Span>>) -> Vec<Span> {
    let [noun, verb] = if components.len() == 1 {
        [
            "Its component along ",
            " holds by geometry: the coordinates satisfy it identically.",
        ]
    } else {
        [
            "Its components along ",
            " hold by geometry: the coordinates satisfy them identically.",
        ]
    };
    [vec![words(noun)], listed(components), vec![words(verb)]].concat()
}

fn definitions(w: &mut Writer<'_>) -> Vec<Row> {
    let speeds = w.mechanism.pseudo_velocities.iter().enumerate();
    let rows = speeds.map(|(index, speed)| {
        let value = lowered(w, &speed.definition);
        let left = Math::Letter(w.speed(index));
        let mut right = w.set(value);
        // A pseudo-velocity with the letter of a generalised velocity: γ̇ = dγ/dt.
        let mut rates = w.derivation.symbols.rates.iter();
        if left == right
            && let Some(place) = rates.position(|&rate| rate == value)
        {
            let coordinate = w.letter(w.derivation.symbols.coordinates[place]);
            right = Math::fraction(
                Math::Letter(coordinate.before('d')),
                Math::Letter(Letter::plain("t").before('d')),
            );
        }
        described(&speed.label, equality(left, right), unit(&speed.label))
    });
    rows.collect()
}

/// `They are valid where cos θ ≠ 0; the spec declares θ from -1.5 to 1.5 rad.`
pub(super) fn conditions(w: &mut Writer<'_>) -> Option<Block> {
    let divisors = divisors(w);
    if divisors.is_empty() {
        return None;
    }
    let conditions = divisors.iter().map(|&divisor| {
        let condition = [w.set(divisor), Math::Sign("≠"), Math::zero()];
        vec![math(Math::Row(condition.into()))]
    });
    let mut what = vec![words("They are valid where ")];
    what.extend(listed(conditions.collect()));
    let declared = declared(w, &divisors);
    if !declared.is_empty() {
        what.push(words("; the spec declares "));
        what.extend(listed(declared));
    }
    what.push(words("."));
    Some(Block::Sentence(what))
}

/// Divisors that have zeros.
fn divisors(w: &Writer<'_>) -> Vec<Expr> {
    let graph = &w.derivation.algebra.graph;
    let parameters = parameter_ranges(graph, w.mechanism, &w.derivation.symbols);
    let mut anywhere = Intervals::new(graph, parameters);
    let mut divisors = Vec::new();
    for part in graph.in_order(&w.derivation.velocities.rates) {
        let Node::Product(factors) = graph.node(part) else {
            continue;
        };
        for factor in factors.iter().filter(|f| f.exponent < 0) {
            if !anywhere.cannot_vanish(graph, factor.base) && !divisors.contains(&factor.base) {
                divisors.push(factor.base);
            }
        }
    }
    divisors
}

/// Declared ranges of the coordinates in the divisors.
fn declared(w: &Writer<'_>, divisors: &[Expr]) -> Vec<Vec<Span>> {
    let graph = &w.derivation.algebra.graph;
    let coordinates = w.derivation.symbols.coordinates.iter();
    let mut declared = Vec::new();
    for (&symbol, q) in coordinates.zip(&w.mechanism.coordinates) {
        let (Some(id), Some(ends)) = (graph.as_symbol(symbol), q.range) else {
            continue;
        };
        if divisors.iter().any(|&d| graph.mentions(d, &[id])) {
            let letter = Math::Letter(Letter::of(&q.label.name));
            let ends = words(&format!(" from {}", range(&q.label, ends)));
            declared.push(vec![math(letter), ends]);
        }
    }
    declared
}

/// The reaction of every constraint; none without constraints.
pub(super) fn forces(w: &mut Writer<'_>) -> Outcome<Option<Section>> {
    let d = &mut *w.derivation;
    let forces = reactions(
        &mut d.algebra,
        Setting::free(w.mechanism, &d.symbols),
        &d.constraints,
        &d.velocities.violating,
        &d.bodies,
        &d.motion.accelerations,
        &d.reactions_in_loads,
    )?;
    if forces.is_empty() {
        return Ok(None);
    }
    let mut equations = Vec::new();
    let places = w.derivation.constraints.reactions.clone();
    for (place, force) in places.iter().zip(forces) {
        for (component, axis) in force.into_iter().zip(AXES) {
            let component = w.derivation.algebra.shortest(component);
            if component == Graph::ZERO {
                continue;
            }
            let left = Letter::plain("F").below(&place.name).below(axis);
            let right = w.explicit(component);
            equations.push(Equation::new(Math::Letter(left), right));
        }
    }
    let blocks = with(
        w,
        "Each constraint row gets an auxiliary speed that violates it; Appell's equation for that \
         speed gives its reaction. Components are in the ground; accelerations are those solved above:",
        equations,
    );
    Ok(Some(headed("Constraint forces", blocks)))
}
