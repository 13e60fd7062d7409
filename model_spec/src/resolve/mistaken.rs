//! Items that are valid but probably a mistake: a force at the material point of another body,
//! gravity along the ground or twice, a wheel whose axle is not its axis of symmetry.

use super::nominal::value;
use super::resolver::Resolver;
use crate::axis::Axis;
use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::expr::{Expr, ExprKind, Quantity, Span};
use crate::mechanism::{
    Body, BodyId, ConstraintKind, FrameId, Inertia, LoadKind, Mechanism, PointId,
};

/// Relative difference of equal values.
const ROUNDING: f64 = 1e-9;

impl Resolver<'_> {
    /// Notes on forces, blades, weight and wheels.
    pub(super) fn mistaken(&mut self, mechanism: &Mechanism) {
        // Invalid references are placeholders.
        if self.ast.broken || self.findings.iter().any(|f| f.severity == Severity::Error) {
            return;
        }
        let mut notes = material_points(mechanism);
        notes.extend(sideways(mechanism));
        notes.extend(twice(mechanism));
        notes.extend(repeated(mechanism));
        notes.extend(mechanism.constraints.iter().filter_map(|constraint| {
            let ConstraintKind::Rolling { body, contact, .. } = constraint.kind else {
                return None;
            };
            axle(mechanism, &mechanism.bodies[body], contact)
        }));
        for note in notes {
            self.tell(note);
        }
    }
}

fn note(message: String, span: &Span, help: String) -> Diagnostic {
    let note = Diagnostic::note(Code::DoubtfulItem, message);
    note.at(span.clone(), "").help(help)
}

/// Material points of a body at the centre of mass of another one, which is not fixed in that body.
fn material_points(mechanism: &Mechanism) -> Vec<Diagnostic> {
    let of_loads = mechanism.loads.iter().filter_map(|load| match load.kind {
        LoadKind::Force {
            on,
            body: Some(body),
            ..
        } => Some((&load.name, &load.span, on, body)),
        _ => None,
    });
    let of_constraints = mechanism.constraints.iter();
    let of_constraints = of_constraints.filter_map(|constraint| match constraint.kind {
        ConstraintKind::FixedVelocity {
            point,
            body: Some(body),
            ..
        } => Some((&constraint.name, &constraint.span, point, body)),
        _ => None,
    });
    let stranger = |point: PointId, body: BodyId| {
        let named = &mechanism.bodies[body];
        let is_placed = Some(mechanism.points[point].frame) == named.frame;
        let mut others = mechanism.bodies.entries();
        let other = others.find(|(other, own)| *other != body && own.centre == point);
        other.filter(|_| named.centre != point && !is_placed)
    };
    let told = |(name, span, point, body): (&String, &Span, PointId, BodyId)| {
        let (_, other) = stranger(point, body)?;
        let (point, own) = (&mechanism.points[point].name, &mechanism.bodies[body].name);
        Some(note(
            format!(
                "`{name}` acts on the material point of `{own}` at `{point}`, the centre of mass of `{}`",
                other.name
            ),
            span,
            format!(
                "write `body = \"{}\"`, or omit `body`, unless the point moves with `{own}`",
                other.name
            ),
        ))
    };
    of_loads.chain(of_constraints).filter_map(told).collect()
}

/// Gravity parallel to the ground on which a body rolls, if no normal is given.
fn sideways(mechanism: &Mechanism) -> Vec<Diagnostic> {
    let mut notes = Vec::new();
    for (load, down) in weights(mechanism) {
        let along = down.iter().position(|&part| part != 0).unwrap_or(2);
        let rolls = mechanism.constraints.iter().find(|constraint| {
            let ConstraintKind::Rolling {
                contact,
                normal: None,
                ..
            } = constraint.kind
            else {
                return false;
            };
            moves_alone(mechanism, contact, along)
        });
        if let Some(constraint) = rolls {
            notes.push(note(
                format!(
                    "`{}` acts along the ground: the contact of `{}` moves along it",
                    load.0, constraint.name
                ),
                load.1,
                "write `down = \"-z\"`, or the `normal` of a wall on which the body rolls"
                    .to_owned(),
            ));
        }
    }
    notes
}

/// Whether a point of the ground moves freely along an axis and another one, and not along the third.
fn moves_alone(mechanism: &Mechanism, point: PointId, along: usize) -> bool {
    let point = &mechanism.points[point];
    let from_origin = point
        .from
        .is_some_and(|from| mechanism.points[from].from.is_none());
    let in_ground = mechanism.frames[point.frame].parent.is_none();
    let is_free = |part: &Expr| matches!(part.kind, ExprKind::Quantity(Quantity::Coordinate(_)));
    let free = point.at.iter().filter(|part| is_free(part)).count();
    let fixed = point.at.iter().filter(|part| is_constant(part)).count();
    from_origin && in_ground && is_free(&point.at[along]) && free == 2 && fixed == 1
}

/// Forces that repeat the weight of a body.
fn twice(mechanism: &Mechanism) -> Vec<Diagnostic> {
    let mut notes = Vec::new();
    for load in &mechanism.loads {
        let LoadKind::Force {
            on,
            reaction_on: None,
            frame,
            vector,
            ..
        } = &load.kind
        else {
            continue;
        };
        if mechanism.frames[*frame].parent.is_some() {
            continue;
        }
        let of = |expr: &Expr| value(expr, &mechanism.parameters);
        let force = vector.each_ref().map(of);
        let mut bodies = mechanism.bodies.iter();
        let own = bodies.find(|body| body.centre == *on);
        for (weight, down, acceleration) in accelerations(mechanism) {
            let Some(body) = own else { continue };
            let size = of(&body.mass) * of(acceleration);
            let repeats = (0..3).all(|axis| {
                (force[axis] - f64::from(down[axis]) * size).abs() <= ROUNDING * size.abs()
            });
            if repeats && size != 0.0 {
                notes.push(note(
                    format!(
                        "`{}` is the weight of `{}`, which `{weight}` has too",
                        load.name, body.name
                    ),
                    &load.span,
                    "a load of kind `gravity` acts on every body: omit one of the two".to_owned(),
                ));
            }
        }
    }
    notes
}

/// Loads of kind `gravity` along the axis of another one.
fn repeated(mechanism: &Mechanism) -> Vec<Diagnostic> {
    let all: Vec<_> = weights(mechanism).collect();
    let repeats = all.iter().enumerate().filter_map(|(place, (load, down))| {
        let mut before = all[..place].iter();
        let (first, _) = before.find(|(_, other)| other == down)?;
        Some(note(
            format!("`{}` acts on every body, as `{}` does", load.0, first.0),
            load.1,
            "omit one of the two: together they double the weight of each body".to_owned(),
        ))
    });
    repeats.collect()
}

/// A wheel with equal moments about its axle and a transverse axis, so that its transverse moments differ.
fn axle(mechanism: &Mechanism, body: &Body, contact: PointId) -> Option<Diagnostic> {
    let frame = body.frame?;
    let Inertia {
        frame: own,
        matrix,
        span,
        ..
    } = body.inertia.as_ref()?;
    if *own != frame || is_placed_in(mechanism, contact, frame) {
        return None;
    }
    let turn = mechanism.frames[frame].turns.last()?;
    let axis = turn.axis as usize;
    let moments = [0, 1, 2].map(|i| value(&matrix[i][i], &mechanism.parameters));
    let near = |a: f64, b: f64| (a - b).abs() <= ROUNDING * a.abs().max(b.abs());
    let across: Vec<usize> = (0..3).filter(|&i| i != axis).collect();
    let [first, second] = [across[0], across[1]];
    let like_axle = |i: usize| near(moments[i], moments[axis]);
    if near(moments[first], moments[second]) || !(like_axle(first) || like_axle(second)) {
        return None;
    }
    let name = |i: usize| Axis::LETTERS[i];
    let odd = if like_axle(first) { second } else { first };
    Some(note(
        format!(
            "`{}` turns about {}, but is symmetric about {}: its moments about {} and {} differ",
            body.name,
            name(axis),
            name(odd),
            name(first),
            name(second)
        ),
        span,
        format!(
            "the moments of a wheel across its axle, {}, are equal",
            name(axis)
        ),
    ))
}

/// Whether the position of a point depends on a frame.
fn is_placed_in(mechanism: &Mechanism, point: PointId, frame: FrameId) -> bool {
    let mut place = Some(point);
    while let Some(point) = place {
        let point = &mechanism.points[point];
        if point.frame == frame && point.from.is_some() {
            return true;
        }
        place = point.from;
    }
    false
}

fn weights(mechanism: &Mechanism) -> impl Iterator<Item = ((&String, &Span), [i8; 3])> {
    let loads = mechanism.loads.iter();
    loads.filter_map(|load| match load.kind {
        LoadKind::Gravity { down, .. } => Some(((&load.name, &load.span), down)),
        _ => None,
    })
}

fn accelerations(mechanism: &Mechanism) -> impl Iterator<Item = (&String, [i8; 3], &Expr)> {
    let loads = mechanism.loads.iter();
    loads.filter_map(|load| match &load.kind {
        LoadKind::Gravity { down, acceleration } => Some((&load.name, *down, acceleration)),
        _ => None,
    })
}

fn is_constant(expr: &Expr) -> bool {
    let mut is_constant = true;
    expr.visit(&mut |quantity| {
        is_constant &= matches!(quantity, Quantity::Parameter(_) | Quantity::Pi);
    });
    is_constant
}
