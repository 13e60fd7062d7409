//! Orientations by unit quaternions: the four coordinates of a frame, and the constraint that keeps their norm.

use crate::ast::ItemAst;
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::{BinaryOp, Expr, ExprKind, Quantity, Span};
use crate::ids::CoordinateId;
use crate::mechanism::{Constraint, ConstraintKind, Frame, Mechanism};
use crate::units::Dimension;

use super::resolver::Resolver;

impl Resolver<'_> {
    /// The coordinates of a frame's quaternion, scalar part first; none if the frame is rotated by angles.
    pub(super) fn quaternion(&mut self, item: &ItemAst) -> Option<[CoordinateId; 4]> {
        let names = item.names("quaternion")?;
        let mut taken = [CoordinateId::new(0); 4];
        for (target, name) in taken.iter_mut().zip(names.iter()) {
            *target = self.find(&name.value, &name.span)?;
        }
        if self
            .in_quaternions
            .chunks_exact(4)
            .any(|other| other == taken)
        {
            return Some(taken);
        }
        for (name, id) in names.iter().zip(taken) {
            if self.in_quaternions.contains(&id) {
                let message = format!("`{}` is a component of a quaternion twice", name.value);
                let help = "each quaternion has four coordinates of its own; frames that turn alike have all four in common";
                let finding = Diagnostic::error(Code::ConflictingKeys, message);
                self.tell(finding.at(name.span.clone(), "here again").help(help));
                return None;
            }
            let dimension = self.names.get(name.value.as_str())?.dimension;
            if dimension.is_some_and(|dimension| dimension != Dimension::NONE) {
                self.tell(
                    Diagnostic::error(Code::UnitMismatch, format!("`{}` is no number", name.value))
                        .at(name.span.clone(), "component of a quaternion")
                        .help("declare the coordinate with `unit = \"1\"`"),
                );
                return None;
            }
            self.in_quaternions.push(id);
            self.used.add(Quantity::Coordinate(id));
        }
        Some(taken)
    }
}

/// The constraints w² + x² + y² + z² = 1 of all quaternions.
pub(super) fn norms(frames: &[Frame], taken: &[Constraint]) -> Vec<Constraint> {
    let mut told = Vec::new();
    let quaternions = frames
        .iter()
        .filter_map(|frame| Some((frame, frame.quaternion?)));
    // Several frames may share a quaternion.
    let quaternions = quaternions.filter(|(_, quaternion)| {
        let is_new = !told.contains(quaternion);
        told.push(*quaternion);
        is_new
    });
    let norms = quaternions.map(|(frame, [w, x, y, z])| {
        let mut name = format!("norm_{}", frame.name);
        while taken.iter().any(|constraint| constraint.name == name) {
            name.push('_');
        }
        Constraint {
            name,
            about: format!("the quaternion of {} has norm 1", frame.name),
            kind: ConstraintKind::Position {
                zero: norm(&[w, x, y, z], &frame.span),
                dimension: Dimension::NONE,
                dependent: Some(w),
                one_sided: false,
            },
            line: frame.line,
            span: frame.span.clone(),
        }
    });
    norms.collect()
}

/// Σ q² − 1.
fn norm(coordinates: &[CoordinateId], span: &Span) -> Expr {
    let expr = |kind| Expr {
        kind,
        span: span.clone(),
    };
    let one = Expr::integer(1, span.clone());
    let negative = expr(ExprKind::Negate(Box::new(one)));
    coordinates.iter().fold(negative, |sum, &id| {
        let q = Box::new(expr(ExprKind::Quantity(Quantity::Coordinate(id))));
        let square = expr(ExprKind::Binary(BinaryOp::Multiply, q.clone(), q));
        expr(ExprKind::Binary(
            BinaryOp::Add,
            Box::new(sum),
            Box::new(square),
        ))
    })
}

/// Normalises initial quaternions; those without initial values become the identity.
pub(super) fn normalise(mechanism: &mut Mechanism) {
    for frame in &mechanism.frames {
        let Some(quaternion) = frame.quaternion else {
            continue;
        };
        let square: f64 = quaternion
            .iter()
            .map(|&id| mechanism.coordinates[id].initial.powi(2))
            .sum();
        if square == 0.0 {
            mechanism.coordinates[quaternion[0]].initial = 1.0;
        } else {
            for id in quaternion {
                mechanism.coordinates[id].initial /= square.sqrt();
            }
        }
    }
}
