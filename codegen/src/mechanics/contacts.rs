//! Unilateral contacts: places and normals of their reactions.

use std::mem;

use appell_spec::Code;
use appell_spec::mechanism::{ConstraintId, ConstraintKind, Mechanism};

use super::algebra::Algebra;
use super::constraints::Constraints;
use super::expressions::Setting;
use super::finding::{Finding, Item, Outcome};
use super::rank::{LinearRow, Standing, standings};
use super::row::Row;
use crate::symbolic::vector::{self, Vec3};
use crate::symbolic::{Expr, Graph};

/// A contact.
#[derive(Debug, Clone)]
pub struct Contact {
    /// Its constraint.
    pub constraint: ConstraintId,
    /// Index into [`Constraints::reactions`].
    pub place: usize,
    /// Direction of the normal force on the body, in the ground.
    pub normal: Vec3,
    /// Whether friction prevents sliding.
    pub grips: bool,
    /// Coefficient of friction, if the spec gives it.
    pub friction: Option<Expr>,
}

/// The contacts of a mechanism, at most one per place of a reaction, and warnings.
///
/// Contacts whose reactions are indeterminate are not monitored. Of several contacts at one place one is
/// monitored, by the total reaction: the first with friction.
pub fn contacts(
    algebra: &mut Algebra,
    setting: Setting<'_>,
    constraints: &Constraints,
) -> Outcome<(Vec<Contact>, Vec<Finding>)> {
    let mechanism = setting.mechanism;
    let (mut contacts, mut warnings) = (Vec::<Contact>::new(), Vec::new());
    for (index, constraint) in mechanism.constraints.entries() {
        let rows: Vec<&Row> = constraints.rows_of(index).collect();
        let (normal, grips, friction) = match &constraint.kind {
            ConstraintKind::Rolling {
                normal, friction, ..
            } => {
                let normal = match normal {
                    Some(normal) => Some((normal.axis.index(), normal.negative)),
                    None => against_the_weight(algebra, mechanism, constraints, &rows),
                };
                (normal, true, friction.as_ref())
            }
            ConstraintKind::FixedVelocity { one_sided, .. }
            | ConstraintKind::Position { one_sided, .. } => {
                (one_sided.then_some((0, false)), false, None)
            }
            ConstraintKind::Velocity { .. } => (None, false, None),
        };
        let unknown = normal.is_none();
        let found = normal.and_then(|(axis, negative)| {
            let row = rows.get(axis)?;
            let graph = &mut algebra.graph;
            let normal = if negative {
                graph.neg3(row.reaction.direction)
            } else {
                row.reaction.direction
            };
            Some((constraints.reported(row)?, normal))
        });
        let Some((place, normal)) = found else {
            if friction.is_some() {
                warnings.push(idle_friction(&constraint.name, index, unknown));
            }
            continue;
        };
        let item = Item::Constraint(index);
        let friction = friction
            .map(|friction| setting.lower_in(&mut algebra.graph, item, friction))
            .transpose()?;
        let contact = Contact {
            constraint: index,
            place,
            normal,
            grips,
            friction,
        };
        let known = contacts.iter_mut().find(|known| known.place == place);
        match known {
            None => contacts.push(contact),
            Some(known) => warnings.extend(merge(mechanism, known, contact)),
        }
    }
    Ok((contacts, warnings))
}

/// Selects the monitored one of two contacts at one place, and warns if the other is more restrictive.
fn merge(mechanism: &Mechanism, known: &mut Contact, contact: Contact) -> Option<Finding> {
    let other = if contact.grips && !known.grips {
        mem::replace(known, contact)
    } else {
        contact
    };
    let rubs_otherwise = other.friction.is_some() && other.friction != known.friction;
    let says_more = other.normal != known.normal || rubs_otherwise;
    let name = |contact: &Contact| &mechanism.constraints[contact.constraint].name;
    says_more.then(|| Finding {
        code: Code::ContactNotJudged,
        message: format!(
            "the contact `{}` is not checked: `{}` is at the same point and shares its reaction",
            name(&other),
            name(known)
        ),
        item: Item::Constraint(other.constraint),
        help: "give each contact a point of its own".to_owned(),
    })
}

/// The axis of the ground opposite to gravity, if the coordinates prevent motion of the contact along it.
fn against_the_weight(
    algebra: &mut Algebra,
    mechanism: &Mechanism,
    constraints: &Constraints,
    rows: &[&Row],
) -> Option<(usize, bool)> {
    let down = mechanism.down()?;
    let axis = down.iter().position(|&c| c != 0)?;
    let row = rows.get(axis)?;
    let lasts = row.reaction.direction == vector::IDENTITY[axis]
        && (row.is_embedded() || follows_from_positions(algebra, constraints, row));
    lasts.then_some((axis, down[axis] > 0))
}

/// Whether the position constraints imply a row.
fn follows_from_positions(algebra: &mut Algebra, constraints: &Constraints, row: &Row) -> bool {
    let positions = constraints.rows.iter().filter(|row| row.of_position);
    let rows: Vec<LinearRow> = positions.chain([row]).map(Row::linear).collect();
    let standings = standings(algebra, &rows);
    matches!(standings.last(), Some(Standing::Redundant(_)))
}

fn idle_friction(name: &str, constraint: ConstraintId, unknown: bool) -> Finding {
    let (reason, help) = if unknown {
        (
            "the normal of its surface is not known",
            "name a frame that follows the surface and its normal axis, such as `in = \
             \"slope\", normal = \"z\"`",
        )
    } else {
        (
            "the reactions of the constraints are statically indeterminate",
            "omit `friction`, or model the mechanism so that each contact has a determinate \
             reaction",
        )
    };
    Finding {
        code: Code::ContactNotJudged,
        message: format!("the friction of `{name}` cannot be checked: {reason}"),
        item: Item::Constraint(constraint),
        help: help.to_owned(),
    }
}

impl Contact {
    /// Whether normal and friction are independent of the state and of parameters.
    pub fn is_constant(&self, graph: &Graph) -> bool {
        let mut exprs = self.normal.iter().chain(&self.friction);
        exprs.all(|&expr| graph.as_number(expr).is_some())
    }
}
