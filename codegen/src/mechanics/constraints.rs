//! Constraints as rows that are linear in the generalised velocities.

use appell_spec::Code;
use appell_spec::mechanism::{ConstraintKind, FrameId, GROUND, Mechanism, PointId};

use super::algebra::Algebra;
use super::expressions::Lowering;
use super::finding::{Finding, Item, Outcome};
use super::frames::FrameVector;
use super::kinematics::{Carried, Effort, Kinematics, division_by_zero, root_of};
use super::redundancy::leave_out;
use super::symbols::Symbols;
use super::time::TimeDerivative;
use crate::symbolic::vector::{self, Vec3};
use crate::symbolic::{Expr, Graph, Intervals, Rational, Substitution};

/// One scalar constraint: `Σ coefficient · q̇ + rest = 0`.
#[derive(Debug, Clone)]
pub struct Row {
    /// Name for people, such as `rolling.x`.
    pub name: String,
    /// Index of the constraint in the mechanism.
    pub constraint: usize,
    /// The whole row, with symbols for the generalised velocities.
    pub value: Expr,
    /// Coefficients of the generalised velocities.
    pub coefficients: Vec<Expr>,
    /// What remains without generalised velocities.
    pub rest: Expr,
    /// Where its reaction is reported, and along which direction of the ground a unit of it acts.
    pub reaction: Reaction,
    /// Coefficients of the imagined motions, one per entry of [`Constraints::carried`].
    pub carried: Vec<Expr>,
    /// The imagined motion that stands in for the row where geometry already embeds it.
    pub stand_in: Option<StandIn>,
    /// Whether it is left out because it follows from the others.
    pub redundant: bool,
    /// The frame along whose axis it is written, for a row of a rolling contact.
    pub frame: FrameId,
    /// Whether it is the derivative of a position constraint.
    pub of_position: bool,
}

/// An imagined motion: a point and the axis along which it is carried.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Imagined {
    /// The point next to the origin that everything carried hangs from.
    pub root: PointId,
    /// Frame of the axis.
    pub frame: FrameId,
    /// The axis.
    pub axis: usize,
}

/// An imagined motion that violates an embedded row at `coefficient` times its rate.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StandIn {
    /// Index into [`Constraints::carried`].
    pub motion: usize,
    /// Rate of the row for a unit rate of the motion; not zero.
    pub coefficient: Rational,
}

/// How the reaction of a row is reported.
#[derive(Debug, Clone)]
pub struct Reaction {
    /// Index into [`Constraints::reactions`].
    pub place: usize,
    /// Direction in the ground; a row without a point reports its multiplier as first component.
    pub direction: Vec3,
}

/// All constraints of a mechanism.
#[derive(Debug, Clone)]
pub struct Constraints {
    /// Scalar rows in the order of the spec.
    pub rows: Vec<Row>,
    /// Names of the places with reactions.
    pub reactions: Vec<String>,
    /// Imagined motions.
    pub carried: Vec<Imagined>,
    /// Rows that were left out.
    pub warnings: Vec<Finding>,
}

impl Row {
    /// Whether the coordinates satisfy the row by themselves.
    pub fn is_embedded(&self) -> bool {
        self.coefficients.iter().all(|&c| c == Graph::ZERO)
    }

    /// Whether the row restricts the generalised velocities beyond what the others do.
    pub fn is_active(&self) -> bool {
        !self.redundant && !self.is_embedded()
    }
}

impl Constraints {
    /// The rows of a constraint.
    pub fn rows_of(&self, constraint: usize) -> impl Iterator<Item = &Row> {
        let rows = self.rows.iter();
        rows.filter(move |row| row.constraint == constraint)
    }
}

/// Constraint rows with symbols for q̇, tested for rows that geometry already embeds.
pub fn constraints(
    algebra: &mut Algebra,
    mechanism: &Mechanism,
    symbols: &Symbols,
    intervals: &mut Intervals,
) -> Outcome<Constraints> {
    let carried = imagined_motions(mechanism);
    let carried_rates: Vec<Expr> = carried
        .iter()
        .map(|motion| {
            let name = format!("carry_{}_{}", motion.root, motion.axis);
            algebra.graph.symbol(&name)
        })
        .collect();
    let motions = motions_along(&carried, &carried_rates);
    let kinematics = Kinematics::new(
        algebra,
        mechanism,
        symbols,
        &symbols.rates,
        &motions,
        Effort::Plain,
    )?;
    let mut places: Vec<Place> = Vec::new();
    let (mut rows, mut findings) = (Vec::new(), Vec::new());
    for index in positions_last(mechanism) {
        let scalars = scalar_rows(algebra, mechanism, symbols, &kinematics, index);
        let (place, scalars) = match scalars {
            Ok(scalars) => scalars,
            Err(finding) => {
                findings.push(finding);
                continue;
            }
        };
        let known = places.iter().position(|&other| other == place);
        let place = known.unwrap_or_else(|| {
            places.push(place);
            places.len() - 1
        });
        for scalar in scalars {
            match row(
                algebra,
                mechanism,
                symbols,
                &carried_rates,
                index,
                place,
                scalar,
            ) {
                Ok(row) => rows.push(row),
                Err(finding) => findings.push(finding),
            }
        }
    }
    let mut warnings = stand_ins(&algebra.graph, mechanism, &mut rows, &mut findings);
    match leave_out(algebra, mechanism, &kinematics.frames, intervals, &mut rows) {
        Ok(left_out) => warnings.extend(left_out),
        Err(refused) => findings.extend(refused),
    }
    if !findings.is_empty() {
        return Err(findings);
    }
    Ok(Constraints {
        rows,
        reactions: places
            .into_iter()
            .map(|place| place.name(mechanism))
            .collect(),
        carried,
        warnings,
    })
}

/// The constraints, those of positions last: where a contact and a position constraint say the same,
/// the contact is kept, because its reaction has a point.
fn positions_last(mechanism: &Mechanism) -> Vec<usize> {
    let mut order: Vec<usize> = (0..mechanism.constraints.len()).collect();
    let position = |&i: &usize| {
        matches!(
            mechanism.constraints[i].kind,
            ConstraintKind::Position { .. }
        )
    };
    order.sort_by_key(position);
    order
}

/// Where a reaction acts.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Place {
    /// At a point.
    Point(PointId),
    /// Along a combination of velocities that has no point: a multiplier.
    Constraint(usize),
}

impl Place {
    /// Its name in results. A constraint that is called like a point says that it is none.
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
}

/// A scalar row before it is split into its coefficients.
struct Scalar {
    name: String,
    value: Expr,
    direction: Vec3,
    frame: FrameId,
}

/// What one constraint demands, row by row, and where its reaction acts.
fn scalar_rows(
    algebra: &mut Algebra,
    mechanism: &Mechanism,
    symbols: &Symbols,
    kinematics: &Kinematics,
    index: usize,
) -> Result<(Place, Vec<Scalar>), Finding> {
    let constraint = &mechanism.constraints[index];
    let item = Item::Constraint(index);
    let lowering = Lowering {
        symbols,
        rates: &symbols.rates,
    };
    let zero = |_| division_by_zero(item);
    let single = |value: Expr, direction: Vec3| {
        let name = constraint.name.clone();
        vec![Scalar {
            name,
            value,
            direction,
            frame: GROUND,
        }]
    };
    Ok(match &constraint.kind {
        ConstraintKind::Rolling {
            body,
            contact,
            normal,
            ..
        } => {
            let frame = normal.map_or(GROUND, |normal| normal.frame);
            let graph = &mut algebra.graph;
            let v = kinematics.material_velocity(graph, mechanism, *body, *contact, frame);
            let scalars = ["x", "y", "z"].iter().enumerate().map(|(k, axis)| {
                let unit = FrameVector {
                    frame,
                    v: vector::IDENTITY[k],
                };
                Scalar {
                    name: format!("{}.{axis}", constraint.name),
                    value: v[k],
                    direction: kinematics.frames.express(graph, unit, GROUND),
                    frame,
                }
            });
            (Place::Point(*contact), scalars.collect())
        }
        ConstraintKind::Velocity {
            zero: left, equals, ..
        } => {
            let left = lowering.lower(&mut algebra.graph, left).map_err(zero)?;
            let right = lowering.lower(&mut algebra.graph, equals).map_err(zero)?;
            let value = algebra.graph.sub(left, right);
            (Place::Constraint(index), single(value, vector::IDENTITY[0]))
        }
        ConstraintKind::FixedVelocity {
            point,
            body,
            frame,
            direction,
            equals,
            ..
        } => {
            let along = lowering
                .lower_all(&mut algebra.graph, direction)
                .map_err(zero)?;
            let right = lowering.lower(&mut algebra.graph, equals).map_err(zero)?;
            let v = match body {
                Some(body) => kinematics.material_velocity(
                    &mut algebra.graph,
                    mechanism,
                    *body,
                    *point,
                    *frame,
                ),
                None => kinematics.frames.express(
                    &mut algebra.graph,
                    kinematics.velocity(*point),
                    *frame,
                ),
            };
            let left = algebra.graph.dot(along, v);
            let value = algebra.graph.sub(left, right);
            let along = FrameVector {
                frame: *frame,
                v: along,
            };
            let direction = kinematics.frames.express(&mut algebra.graph, along, GROUND);
            (Place::Point(*point), single(value, direction))
        }
        ConstraintKind::Position { zero: position, .. } => {
            let position = lowering.lower(&mut algebra.graph, position).map_err(zero)?;
            let along = TimeDerivative {
                symbols,
                rates: &symbols.rates,
            };
            let value = along.of(algebra, position);
            (Place::Constraint(index), single(value, vector::IDENTITY[0]))
        }
    })
}

/// Splits a row into its coefficients.
fn row(
    algebra: &mut Algebra,
    mechanism: &Mechanism,
    symbols: &Symbols,
    carried_rates: &[Expr],
    constraint: usize,
    place: usize,
    scalar: Scalar,
) -> Result<Row, Finding> {
    let Scalar {
        name,
        value,
        direction,
        frame,
    } = scalar;
    let kind = &mechanism.constraints[constraint].kind;
    let of_position = matches!(kind, ConstraintKind::Position { .. });
    let mut coefficients_of = |unknowns: &[Expr]| -> Vec<Expr> {
        unknowns
            .iter()
            .map(|&unknown| {
                let coefficient = algebra.derivative(value, unknown);
                algebra.shortest(coefficient)
            })
            .collect()
    };
    let coefficients = coefficients_of(&symbols.rates);
    let carried = coefficients_of(carried_rates);
    let unknowns = [&symbols.rates, carried_rates].concat();
    let rest = Substitution::by_zero(&algebra.graph, &unknowns)
        .apply(&mut algebra.graph, value)
        .ok_or_else(|| division_by_zero(Item::Constraint(constraint)))?;
    let rest = algebra.shortest(rest);
    Ok(Row {
        name,
        constraint,
        value,
        coefficients,
        rest,
        reaction: Reaction { place, direction },
        carried,
        stand_in: None,
        redundant: false,
        frame,
        of_position,
    })
}

/// Three motions per point from which a constrained point hangs, along the axes of the ground or of
/// the first surface that the spec tells the normal of.
fn imagined_motions(mechanism: &Mechanism) -> Vec<Imagined> {
    let mut roots: Vec<(PointId, Option<FrameId>)> = Vec::new();
    for constraint in &mechanism.constraints {
        let (carrier, surface) = match &constraint.kind {
            ConstraintKind::Rolling { body, normal, .. } => (
                mechanism.bodies[*body].centre,
                normal.map(|normal| normal.frame),
            ),
            ConstraintKind::FixedVelocity {
                body: Some(body), ..
            } => (mechanism.bodies[*body].centre, None),
            ConstraintKind::FixedVelocity {
                point, body: None, ..
            } => (*point, None),
            ConstraintKind::Velocity { .. } | ConstraintKind::Position { .. } => continue,
        };
        let root = root_of(mechanism, carrier);
        match roots.iter_mut().find(|(known, _)| *known == root) {
            Some((_, frame)) => *frame = frame.or(surface),
            None => roots.push((root, surface)),
        }
    }
    let along = |(root, frame): (PointId, Option<FrameId>)| {
        (0..3).map(move |axis| Imagined {
            root,
            frame: frame.unwrap_or(GROUND),
            axis,
        })
    };
    roots.into_iter().flat_map(along).collect()
}

/// The imagined motions with given velocities.
pub fn motions_along(carried: &[Imagined], rates: &[Expr]) -> Vec<Carried> {
    carried
        .iter()
        .zip(rates)
        .map(|(&Imagined { root, frame, axis }, &rate)| {
            let mut v = vector::ZERO;
            v[axis] = rate;
            let v = FrameVector { frame, v };
            Carried { root, v }
        })
        .collect()
}

/// Finds the rows without any generalised velocity. Those of a rolling contact hold by geometry and
/// get an imagined motion; others contradict the spec or say nothing. Returns what to warn of.
fn stand_ins(
    graph: &Graph,
    mechanism: &Mechanism,
    rows: &mut [Row],
    findings: &mut Vec<Finding>,
) -> Vec<Finding> {
    let mut warnings = Vec::new();
    let mut taken: Vec<usize> = Vec::new();
    for row in rows.iter_mut().filter(|row| row.is_embedded()) {
        let item = Item::Constraint(row.constraint);
        if row.rest != Graph::ZERO {
            findings.push(Finding {
                code: Code::DependentConstraints,
                message: format!(
                    "`{}` cannot hold: no generalised velocity appears in it",
                    row.name
                ),
                item,
                help: "let a coordinate take part in the motion that the constraint prescribes"
                    .to_owned(),
            });
            continue;
        }
        let fitting: Vec<StandIn> = row
            .carried
            .iter()
            .enumerate()
            .filter_map(|(motion, &c)| Some((motion, graph.as_number(c)?)))
            .filter(|(_, coefficient)| !coefficient.is_zero())
            .map(|(motion, coefficient)| StandIn {
                motion,
                coefficient: coefficient.clone(),
            })
            .collect();
        row.stand_in = fitting
            .iter()
            .find(|fit| !taken.contains(&fit.motion))
            .cloned();
        taken.extend(row.stand_in.iter().map(|fit| fit.motion));
        if row.stand_in.is_some() {
            continue;
        }
        row.redundant = true;
        let name = &mechanism.constraints[row.constraint].name;
        let (message, help) = if fitting.is_empty() {
            (
                format!("`{name}` always holds: no generalised velocity appears in it"),
                "remove the constraint",
            )
        } else {
            (
                format!(
                    "`{}` holds by geometry, and so does another constraint in the same direction: \
                     how the two share their reaction cannot be told; the other is reported with \
                     the sum",
                    row.name
                ),
                "remove one of the two constraints, or read their reactions as one",
            )
        };
        warnings.push(Finding {
            code: Code::RedundantConstraint,
            message,
            item,
            help: help.to_owned(),
        });
    }
    warnings
}
