//! The angle between two frames that turn relative to each other about one axis.

use crate::ast::Spanned;
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::{BinaryOp, Expr, ExprKind, Quantity};
use crate::ids::FrameId;
use crate::mechanism::{Axis, Frame};

use super::resolver::Resolver;

/// A rotation on the way from one frame to another.
struct Step<'a> {
    axis: Axis,
    negative: bool,
    angle: &'a Expr,
}

impl Resolver<'_> {
    /// The sum of the turns from the first frame to the second about their common axis. Constant turns about other
    /// axes may precede and follow.
    pub(super) fn relative_angle(&mut self, ends: [&Spanned<String>; 2], frames: &[Frame]) -> Expr {
        let [first, second] = ends;
        let span = first.span.start..second.span.end;
        let ids = ends.map(|end| self.find::<FrameId>(&end.value, &end.span));
        let [Some(from), Some(to)] = ids else {
            return Expr::integer(0, span);
        };
        match common_turn(frames, from, to) {
            Ok(steps) => sum(&steps).unwrap_or_else(|| Expr::integer(0, span)),
            Err(reason) => {
                let message = format!(
                    "`{}` and `{}` do not turn relative to each other about one axis",
                    first.value, second.value
                );
                let finding = Diagnostic::error(Code::NoCommonAxis, message);
                self.tell(finding.at(span.clone(), reason).help(
                    "name two frames with one joint between them, or apply a `torque` to their bodies",
                ));
                Expr::integer(0, span)
            }
        }
    }
}

/// The consecutive turns about one axis among which all are that depend on the motion.
fn common_turn(frames: &[Frame], from: FrameId, to: FrameId) -> Result<Vec<Step<'_>>, String> {
    let path = path(frames, from, to)?;
    let varies = |step: &Step<'_>| varies(step.angle);
    let (Some(first), Some(last)) = (path.iter().position(varies), path.iter().rposition(varies))
    else {
        return Err("the angle between them is constant".to_owned());
    };
    let axis = path[first].axis;
    if let Some(other) = path[first..=last].iter().find(|step| step.axis != axis) {
        let (axis, other) = (axis.letter(), other.axis.letter());
        return Err(format!("they turn about {axis} and about {other}"));
    }
    let is_other = |step: &&Step<'_>| step.axis != axis;
    let before = path[..first]
        .iter()
        .rev()
        .take_while(|s| !is_other(s))
        .count();
    let after = path[last + 1..].iter().take_while(|s| !is_other(s)).count();
    let mut path = path;
    path.truncate(last + 1 + after);
    Ok(path.split_off(first - before))
}

/// All turns: from the first frame up to the common ancestor, reversed, and down to the second.
fn path(frames: &[Frame], from: FrameId, to: FrameId) -> Result<Vec<Step<'_>>, String> {
    let ancestry = |frame: FrameId| -> Vec<FrameId> {
        std::iter::successors(Some(frame), |id| frames[id.index()].parent)
            .take(frames.len())
            .collect()
    };
    let (mut up, mut down) = (ancestry(from), ancestry(to));
    while up.last().is_some() && up.last() == down.last() {
        up.pop();
        down.pop();
    }
    let mut steps = Vec::new();
    for (ids, backwards) in [(up, true), (down, false)] {
        let ids = ids.into_iter();
        let ids: Vec<FrameId> = if backwards {
            ids.collect()
        } else {
            ids.rev().collect()
        };
        for id in ids {
            let frame = &frames[id.index()];
            if frame.quaternion.is_some() {
                return Err(format!("`{}` is oriented by a quaternion", frame.name));
            }
            let turns = frame.turns.iter().map(|turn| Step {
                axis: turn.axis,
                negative: turn.negative != backwards,
                angle: &turn.angle,
            });
            if backwards {
                steps.extend(turns.rev());
            } else {
                steps.extend(turns);
            }
        }
    }
    Ok(steps)
}

/// Whether an angle depends on the motion or on time.
fn varies(angle: &Expr) -> bool {
    let mut varies = false;
    angle.visit(&mut |quantity| {
        varies |= !matches!(quantity, Quantity::Parameter(_) | Quantity::Pi);
    });
    varies
}

fn sum(steps: &[Step<'_>]) -> Option<Expr> {
    let mut terms = steps.iter();
    let first = terms.next()?;
    let span = first.angle.span.clone();
    let mut total = first.angle.clone();
    if first.negative {
        total = Expr {
            kind: ExprKind::Negate(Box::new(total)),
            span: span.clone(),
        };
    }
    for step in terms {
        let operation = if step.negative {
            BinaryOp::Subtract
        } else {
            BinaryOp::Add
        };
        total = Expr {
            kind: ExprKind::Binary(operation, Box::new(total), Box::new(step.angle.clone())),
            span: span.clone(),
        };
    }
    Some(total)
}
