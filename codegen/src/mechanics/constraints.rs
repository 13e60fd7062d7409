//! Constraints as rows that are linear in the generalised velocities.

use appell_runtime::model::Reaction as Reported;
use appell_spec::Code;
use appell_spec::mechanism::{BodyId, ConstraintId, ConstraintKind, GROUND, Mechanism, PointId};
use appell_spec::units::{Dimension, Unit};

use super::algebra::Algebra;
use super::auxiliary::AuxiliaryMotions;
use super::expressions::Setting;
use super::finding::{Finding, Item, Outcome, defined, unless_any};
use super::frames::FrameVector;
use super::kinematics::{Kinematics, root_of};
use super::motions::told;
use super::quaternion::is_norm;
use super::redundancy::leave_out;
use super::row::{Reaction, Row};
use crate::symbolic::vector::Vec3;
use crate::symbolic::{Expr, Graph, Intervals, Substitution};

/// All constraints of a mechanism.
#[derive(Debug, Clone)]
pub struct Constraints {
    /// Scalar rows in the order of the spec.
    pub rows: Vec<Row>,
    /// The reported reactions.
    pub reactions: Vec<Reported>,
    /// For each place of a reaction its index into [`Constraints::reactions`]; `None` if the reaction is
    /// indeterminate.
    pub reported: Vec<Option<usize>>,
    /// Auxiliary motions that violate the rows implied by geometry or by other rows.
    pub auxiliary: AuxiliaryMotions,
    /// Omitted rows and indeterminate reactions.
    pub warnings: Vec<Finding>,
}

impl Constraints {
    /// The rows of a constraint.
    pub fn rows_of(&self, constraint: ConstraintId) -> impl Iterator<Item = &Row> {
        let rows = self.rows.iter();
        rows.filter(move |row| row.constraint == constraint)
    }

    /// Index of a row's reaction among the reported ones.
    pub fn reported(&self, row: &Row) -> Option<usize> {
        self.reported.get(row.reaction.place).copied().flatten()
    }
}

/// Constraint rows with symbols for q̇, tested for rows that geometry already embeds.
pub fn constraints(
    algebra: &mut Algebra,
    setting: Setting<'_>,
    kinematics: &Kinematics,
    intervals: &mut Intervals,
) -> Outcome<Constraints> {
    let mechanism = setting.mechanism;
    let mut places: Vec<Place> = Vec::new();
    let (mut rows, mut findings) = (Vec::new(), Vec::new());
    for index in by_precedence(mechanism) {
        let (place, scalars) = match scalar_rows(algebra, setting, kinematics, index) {
            Ok(scalars) => scalars,
            Err(undefined) => {
                findings.extend(undefined);
                continue;
            }
        };
        let known = places.iter().position(|&other| other == place);
        let place = known.unwrap_or_else(|| {
            places.push(place);
            places.len() - 1
        });
        for scalar in scalars {
            match row(algebra, setting, index, place, scalar) {
                Ok(row) => rows.push(row),
                Err(undefined) => findings.extend(undefined),
            }
        }
    }
    let mut warnings = without_motion(mechanism, &rows, &mut findings);
    match leave_out(algebra, mechanism, &kinematics.frames, intervals, &mut rows) {
        Ok(left_out) => warnings.extend(left_out),
        Err(refused) => findings.extend(refused),
    }
    unless_any(findings)?;
    let auxiliary = AuxiliaryMotions::new(algebra, mechanism, &kinematics.frames, intervals, &rows);
    let names: Vec<String> = places.iter().map(|place| place.name(mechanism)).collect();
    warnings.extend(auxiliary.findings(mechanism, &rows, &names));
    let (mut reactions, mut reported) = (Vec::new(), Vec::new());
    for (index, (place, name)) in places.into_iter().zip(names).enumerate() {
        let is_norm = matches!(place, Place::Constraint(id) if is_norm(mechanism, id));
        let told = auxiliary.tells(index) && !is_norm;
        reported.push(told.then_some(reactions.len()));
        reactions.extend(told.then(|| place.reaction(mechanism, name)));
    }
    Ok(Constraints {
        rows,
        reactions,
        reported,
        auxiliary,
        warnings,
    })
}

/// The constraints in order of precedence. If a contact and a position constraint are equivalent, the contact
/// has precedence, because its reaction has a point; a position constraint implies its derivative.
fn by_precedence(mechanism: &Mechanism) -> Vec<ConstraintId> {
    let kind = |i: ConstraintId| &mechanism.constraints[i].kind;
    let is_position = |i| matches!(kind(i), ConstraintKind::Position { .. });
    let mut order: Vec<ConstraintId> = mechanism.constraints.ids().collect();
    let has_positions = order.iter().any(|&i| is_position(i));
    let is_derivative = |i| has_positions && matches!(kind(i), ConstraintKind::Velocity { .. });
    order.sort_by_key(|&i| (is_derivative(i), is_position(i)));
    order
}

/// Where a reaction acts.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Place {
    /// At a point.
    Point(PointId),
    /// Along a combination of velocities without a point: a multiplier.
    Constraint(ConstraintId),
}

impl Place {
    /// Its name in results, made unique if a constraint has the name of a point.
    fn name(self, mechanism: &Mechanism) -> String {
        match self {
            Self::Point(point) => mechanism.points[point].name.clone(),
            Self::Constraint(index) => {
                let name = &mechanism.constraints[index].name;
                if mechanism.points.iter().any(|point| point.name == *name) {
                    format!("constraint_{name}")
                } else {
                    name.clone()
                }
            }
        }
    }

    /// Its reaction under this name. The unit of a multiplier is power per constrained rate.
    fn reaction(self, mechanism: &Mechanism, name: String) -> Reported {
        match self {
            Self::Point(_) => Reported::on_point(name.into()),
            Self::Constraint(index) => {
                let rate = mechanism.constraints[index].kind.rate_dimension();
                let unit = rate.and_then(|rate| Dimension::POWER.over(&rate).ok());
                let unit = unit.map_or_else(String::new, |unit| Unit::si(unit).text);
                Reported::multiplier(name.into(), unit.into())
            }
        }
    }
}

/// A scalar row before it is split into its coefficients.
struct Scalar {
    name: String,
    value: Expr,
    along: FrameVector,
    direction: Vec3,
    root: Option<PointId>,
}

impl Scalar {
    /// The row of a constraint without a point.
    fn without_point(name: &str, value: Expr) -> Self {
        let along = FrameVector::unit(GROUND, 0);
        Self {
            name: name.to_owned(),
            value,
            along,
            direction: along.v,
            root: None,
        }
    }
}

/// The scalar rows of one constraint, and where its reaction acts.
fn scalar_rows(
    algebra: &mut Algebra,
    setting: Setting<'_>,
    kinematics: &Kinematics,
    index: ConstraintId,
) -> Outcome<(Place, Vec<Scalar>)> {
    let (mechanism, symbols) = (setting.mechanism, setting.symbols);
    let constraint = &mechanism.constraints[index];
    let item = Item::Constraint(index);
    let single = |value| Scalar::without_point(&constraint.name, value);
    Ok(match &constraint.kind {
        ConstraintKind::Rolling {
            body,
            contact,
            on,
            normal,
            ..
        } => {
            let frame = normal.map_or(GROUND, |normal| normal.frame);
            let graph = &mut algebra.graph;
            let mut v = kinematics.material_velocity(graph, Some(*body), *contact, frame);
            if on.is_some() {
                let carried = kinematics.material_velocity(graph, *on, *contact, frame);
                v = graph.sub3(v, carried);
            }
            let root = |body: BodyId| root_of(mechanism, mechanism.bodies[body].centre);
            // A motion that carries both bodies does not change their relative velocity.
            let own = Some(root(*body)).filter(|own| on.is_none_or(|on| root(on) != *own));
            let rows = ["x", "y", "z"].iter().enumerate().map(|(k, axis)| {
                let unit = FrameVector::unit(frame, k);
                Scalar {
                    name: format!("{}.{axis}", constraint.name),
                    value: v[k],
                    along: unit,
                    direction: kinematics.frames.express(graph, unit, GROUND),
                    root: own,
                }
            });
            (Place::Point(*contact), rows.collect())
        }
        ConstraintKind::Velocity {
            zero: left, equals, ..
        } => {
            let left = setting.lower_in(&mut algebra.graph, item, left)?;
            let left = defined(told(algebra, symbols, kinematics, left), item)?;
            let right = setting.lower_in(&mut algebra.graph, item, equals)?;
            let value = algebra.graph.sub(left, right);
            (Place::Constraint(index), vec![single(value)])
        }
        ConstraintKind::FixedVelocity {
            point,
            body,
            frame,
            direction,
            equals,
            ..
        } => {
            let graph = &mut algebra.graph;
            let along = setting.lower_all_in(graph, item, direction)?;
            let right = setting.lower_in(graph, item, equals)?;
            let v = kinematics.material_velocity(graph, *body, *point, *frame);
            let left = graph.dot(along, v);
            let value = graph.sub(left, right);
            let along = FrameVector::new(*frame, along);
            let direction = kinematics.frames.express(graph, along, GROUND);
            let carrier = body.map_or(*point, |body| mechanism.bodies[body].centre);
            let scalar = Scalar {
                along,
                direction,
                root: Some(root_of(mechanism, carrier)),
                ..single(value)
            };
            (Place::Point(*point), vec![scalar])
        }
        ConstraintKind::Position { zero: position, .. } => {
            let position = setting.lower_in(&mut algebra.graph, item, position)?;
            let position = defined(told(algebra, symbols, kinematics, position), item)?;
            let value = setting.rate(algebra, position);
            (Place::Constraint(index), vec![single(value)])
        }
    })
}

/// Splits a row into its coefficients.
fn row(
    algebra: &mut Algebra,
    setting: Setting<'_>,
    constraint: ConstraintId,
    place: usize,
    scalar: Scalar,
) -> Outcome<Row> {
    let (mechanism, symbols) = (setting.mechanism, setting.symbols);
    let Scalar {
        name,
        value,
        along,
        direction,
        root,
    } = scalar;
    let kind = &mechanism.constraints[constraint].kind;
    let of_position = matches!(kind, ConstraintKind::Position { .. });
    let mut coefficients = Vec::with_capacity(symbols.rates.len());
    for &rate in &symbols.rates {
        let coefficient = algebra.derivative(value, rate);
        let coefficient = algebra.shortest(coefficient);
        let vanishes = !of_position && algebra.vanishes(coefficient);
        coefficients.push(if vanishes { Graph::ZERO } else { coefficient });
    }
    let mut at_rest = Substitution::by_zero(&algebra.graph, &symbols.rates);
    let rest = at_rest.apply(&mut algebra.graph, value);
    let rest = defined(rest, Item::Constraint(constraint))?;
    let rest = algebra.shortest(rest);
    Ok(Row {
        name,
        constraint,
        value,
        coefficients,
        rest,
        reaction: Reaction { place, direction },
        along,
        root,
        redundant: false,
        of_position,
    })
}

/// Checks rows without generalised velocities: those of a point hold by geometry, others contradict the spec or
/// are trivial. Returns the warnings.
fn without_motion(
    mechanism: &Mechanism,
    rows: &[Row],
    findings: &mut Vec<Finding>,
) -> Vec<Finding> {
    let mut warnings = Vec::new();
    for row in rows.iter().filter(|row| row.is_embedded()) {
        let item = Item::Constraint(row.constraint);
        if row.rest != Graph::ZERO {
            findings.push(Finding {
                code: Code::DependentConstraints,
                message: format!(
                    "`{}` cannot be satisfied: no generalised velocity appears in it",
                    row.name
                ),
                item,
                help: "make a coordinate take part in the motion that the constraint prescribes"
                    .to_owned(),
            });
        } else if row.root.is_none() {
            let name = &mechanism.constraints[row.constraint].name;
            warnings.push(Finding {
                code: Code::RedundantConstraint,
                message: format!("`{name}` always holds: no generalised velocity appears in it"),
                item,
                help: "remove the constraint".to_owned(),
            });
        }
    }
    warnings
}
