//! Redundant constraint rows: two wheels on one axle cannot slip sideways independently.
//!
//! Such a row is omitted, which does not change the motion.

use appell_spec::Code;
use appell_spec::mechanism::{ConstraintId, ConstraintKind, FrameId, GROUND, Mechanism};

use super::algebra::Algebra;
use super::finding::{Finding, Item, Outcome, listed, unless_any};
use super::frames::{FrameVector, Frames};
use super::rank::{Combination, LinearRow, Standing, is_finite, standings};
use super::row::Row;
use crate::symbolic::vector;
use crate::symbolic::{Expr, Intervals};

/// Marks the redundant rows, so that the others are independent. Returns the warnings.
///
/// A row is omitted only if it is a combination of others in *every* configuration: `dot(x) = 0` does not
/// follow from `x*dot(x) = 0`. If the rows of a rolling contact do not allow this in the axes of the ground,
/// they are resolved in the axes of another frame.
pub fn leave_out(
    algebra: &mut Algebra,
    mechanism: &Mechanism,
    frames: &Frames,
    intervals: &mut Intervals,
    rows: &mut [Row],
) -> Outcome<Vec<Finding>> {
    let (mut warnings, mut errors) = (Vec::new(), Vec::new());
    // Rows with an error, which are excluded from further comparisons.
    let mut refused: Vec<usize> = Vec::new();
    let mut turned: Vec<ConstraintId> = Vec::new();
    loop {
        let open: Vec<usize> = (0..rows.len())
            .filter(|row| rows[*row].is_active() && !refused.contains(row))
            .collect();
        let Some((row, standing)) = first_dependent(algebra, rows, &open) else {
            break;
        };
        let Standing::Redundant(combination) = standing else {
            errors.push(contradiction(&rows[row]));
            refused.push(row);
            continue;
        };
        let constraint = rows[row].constraint;
        if let Some(spare) = spare_row(algebra, intervals, row, &combination) {
            warnings.extend(redundancy(rows, spare, row, &combination));
            rows[spare].redundant = true;
        } else if !turned.contains(&constraint)
            && let Some(resolved) =
                resolved_elsewhere(algebra, mechanism, frames, intervals, rows, constraint)
        {
            for (place, row) in resolved {
                rows[place] = row;
            }
            turned.push(constraint);
        } else {
            errors.push(singular(mechanism, &rows[row]));
            refused.push(row);
        }
    }
    unless_any(errors)?;
    Ok(warnings)
}

/// The first of the rows `open` that depends on those before, by its index among all rows.
fn first_dependent(
    algebra: &mut Algebra,
    rows: &[Row],
    open: &[usize],
) -> Option<(usize, Standing)> {
    let standings = standings(algebra, &linear(rows, open));
    let dependent = open.iter().zip(standings);
    let (&row, standing) = dependent
        .into_iter()
        .find(|(_, standing)| *standing != Standing::Independent)?;
    Some(match standing {
        Standing::Redundant(combination) => {
            let among_all = combination.into_iter().map(|(i, c)| (open[i], c)).collect();
            (row, Standing::Redundant(among_all))
        }
        other => (row, other),
    })
}

fn linear(rows: &[Row], places: &[usize]) -> Vec<LinearRow> {
    places.iter().map(|&place| rows[place].linear()).collect()
}

/// A row that follows from the others in every configuration, where `row = Σ factor · other`: the row itself,
/// or another one for which that equation can be solved.
fn spare_row(
    algebra: &mut Algebra,
    intervals: &mut Intervals,
    row: usize,
    combination: &Combination,
) -> Option<usize> {
    let factors: Vec<Expr> = combination.iter().map(|&(_, factor)| factor).collect();
    let finite = |algebra: &Algebra, intervals: &mut Intervals, factors: &[Expr]| {
        let mut factors = factors.iter();
        factors.all(|&factor| is_finite(&algebra.graph, intervals, factor))
    };
    if finite(algebra, intervals, &factors) {
        return Some(row);
    }
    // Later rows first, so that the first constraint of the spec on a motion is retained.
    let mut others = combination.clone();
    others.sort_unstable_by_key(|&(other, _)| std::cmp::Reverse(other));
    others.into_iter().find_map(|(other, share)| {
        let mut solved = vec![algebra.graph.pow(share, -1)];
        for &factor in factors.iter().filter(|&&factor| factor != share) {
            let ratio = algebra.graph.div(factor, share);
            solved.push(algebra.shortest(ratio));
        }
        finite(algebra, intervals, &solved).then_some(other)
    })
}

/// The rows of a rolling contact in the axes of the first frame in which the redundant ones can be omitted in
/// every configuration.
fn resolved_elsewhere(
    algebra: &mut Algebra,
    mechanism: &Mechanism,
    frames: &Frames,
    intervals: &mut Intervals,
    rows: &[Row],
    constraint: ConstraintId,
) -> Option<Vec<(usize, Row)>> {
    // A single row has no choice of axes; a surface determines them.
    if !has_free_axes(mechanism, constraint) {
        return None;
    }
    let mut frames_but_ground = mechanism.frames.ids().skip(1);
    frames_but_ground.find_map(|frame| {
        let resolved = resolved_in(algebra, mechanism, frames, rows, constraint, frame)?;
        let mut all = rows.to_vec();
        for (place, row) in &resolved {
            all[*place] = row.clone();
        }
        let before: Vec<usize> = (0..all.len())
            .filter(|&row| all[row].is_active() && all[row].constraint <= constraint)
            .collect();
        let standings = standings(algebra, &linear(&all, &before));
        let serves = before.iter().zip(standings).all(|(&row, standing)| {
            all[row].constraint < constraint
                || match standing {
                    Standing::Independent => true,
                    Standing::Inconsistent => false,
                    Standing::Redundant(sum) => sum
                        .iter()
                        .all(|&(_, factor)| is_finite(&algebra.graph, intervals, factor)),
                }
        });
        serves.then_some(resolved)
    })
}

/// The rows of a rolling contact as components along the axes of a frame. Rows embedded by geometry are
/// unchanged; `None` if the frame lacks their axes.
fn resolved_in(
    algebra: &mut Algebra,
    mechanism: &Mechanism,
    frames: &Frames,
    rows: &[Row],
    constraint: ConstraintId,
    frame: FrameId,
) -> Option<Vec<(usize, Row)>> {
    let places: Vec<usize> = (0..rows.len())
        .filter(|&row| rows[row].constraint == constraint)
        .collect();
    let mut resolved = Vec::with_capacity(places.len());
    for (axis, (&place, letter)) in places.iter().zip(["x", "y", "z"]).enumerate() {
        let unit = FrameVector::unit(frame, axis);
        let along = frames.express(&mut algebra.graph, unit, GROUND);
        if !rows[place].is_active() {
            if along != vector::IDENTITY[axis] {
                return None;
            }
            continue;
        }
        let mut sum = |part: &dyn Fn(&Row) -> Expr| {
            let terms: Vec<Expr> = along
                .iter()
                .zip(&places)
                .map(|(&c, &place)| algebra.graph.mul(c, part(&rows[place])))
                .collect();
            let total = algebra.graph.sum(&terms);
            algebra.shortest(total)
        };
        let mut row = rows[place].clone();
        row.value = sum(&|row| row.value);
        row.rest = sum(&|row| row.rest);
        row.coefficients = (0..row.coefficients.len())
            .map(|k| sum(&|row| row.coefficients[k]))
            .collect();
        if row.is_embedded() {
            return None;
        }
        let (constraint, frame_name) = (
            &mechanism.constraints[constraint].name,
            &mechanism.frames[frame].name,
        );
        row.name = format!("{constraint}.{frame_name}_{letter}");
        row.along = unit;
        row.reaction.direction = along;
        resolved.push((place, row));
    }
    Some(resolved)
}

/// Whether the rows of a constraint may be resolved in any axes: those of a contact without a given normal.
fn has_free_axes(mechanism: &Mechanism, constraint: ConstraintId) -> bool {
    let kind = &mechanism.constraints[constraint].kind;
    matches!(kind, ConstraintKind::Rolling { normal: None, .. })
}

fn contradiction(row: &Row) -> Finding {
    Finding {
        code: Code::DependentConstraints,
        message: format!("`{}` contradicts the other constraints", row.name),
        item: Item::Constraint(row.constraint),
        help: "remove one of them".to_owned(),
    }
}

fn singular(mechanism: &Mechanism, row: &Row) -> Finding {
    let help = if has_free_axes(mechanism, row.constraint) {
        "on a surface that is not normal to an axis of the ground, name a frame that follows it and \
         its normal axis, such as `in = \"slope\", normal = \"z\"`; otherwise remove the \
         constraint, or declare ranges in which it is always redundant"
    } else {
        "remove it, or declare ranges in which it is always redundant"
    };
    Finding {
        code: Code::RedundantConstraint,
        message: format!(
            "`{}` follows from the other constraints, but not in every configuration",
            row.name
        ),
        item: Item::Constraint(row.constraint),
        help: help.to_owned(),
    }
}

/// The warning for an omitted row, where `row = Σ factor · other`. `None` if it depends only on rows of the
/// same contact, which geometry keeps on its surface, or is the derivative of a position constraint.
fn redundancy(
    rows: &[Row],
    spare: usize,
    row: usize,
    combination: &Combination,
) -> Option<Finding> {
    let mut others: Vec<usize> = combination.iter().map(|&(other, _)| other).collect();
    others.push(row);
    others.sort_unstable();
    others.retain(|&other| other != spare);
    let own = |&other: &usize| rows[other].constraint == rows[spare].constraint;
    if rows[spare].of_position || !others.is_empty() && others.iter().all(own) {
        return None;
    }
    let reason = if others.is_empty() {
        "always holds".to_owned()
    } else {
        let names = others.into_iter().map(|other| rows[other].name.as_str());
        format!("follows from {}", listed(names))
    };
    Some(omission(&rows[spare].name, rows[spare].constraint, &reason))
}

/// The warning for an omitted row or constraint that `reason`, such as `follows from ...`.
pub(super) fn omission(name: &str, constraint: ConstraintId, reason: &str) -> Finding {
    Finding {
        code: Code::RedundantConstraint,
        message: format!("`{name}` {reason} and is left out: the motion is the same without it"),
        item: Item::Constraint(constraint),
        help: "remove it".to_owned(),
    }
}
