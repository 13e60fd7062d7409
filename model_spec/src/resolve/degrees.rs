//! Angles and rates that are probably stated in another unit: 25 rad for a slope, Hz for an angular rate.

use std::f64::consts::TAU;

use num_traits::ToPrimitive;

use super::resolver::Resolver;
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::{Expr, ExprKind, Quantity, Span};
use crate::mechanism::{Label, Mechanism};

impl Resolver<'_> {
    /// Notes on parameters, ranges, turns and pseudo-velocities.
    pub(super) fn doubtful_angles(&mut self, mechanism: &Mechanism) {
        let mut notes = Vec::new();
        for parameter in &mechanism.parameters {
            let label = &parameter.label;
            if is_in_radians(label) && parameter.value.abs() > TAU {
                notes.push(in_degrees(
                    &format!("`{}`", label.name),
                    parameter.value,
                    &label.span,
                ));
            }
        }
        for coordinate in &mechanism.coordinates {
            let label = &coordinate.label;
            // What turns round and round has no range.
            let most = coordinate
                .range
                .map_or(0.0, |ends| ends[0].abs().max(ends[1].abs()));
            if is_in_radians(label) && most > TAU && coordinate.initial.abs() > TAU {
                let what = format!("the initial value of `{}`", label.name);
                notes.push(in_degrees(&what, coordinate.initial, &label.span));
            }
        }
        for turn in mechanism.frames.iter().flat_map(|frame| &frame.turns) {
            if let ExprKind::Number(angle) = &turn.angle.kind {
                let angle = angle.to_f64().unwrap_or(0.0);
                if angle.abs() > TAU {
                    notes.push(in_degrees("the turn", angle, &turn.angle.span));
                }
            }
        }
        for speed in &mechanism.pseudo_velocities {
            let label = &speed.label;
            if label.unit.text == "Hz" && turns(&speed.definition, mechanism) {
                let message = format!(
                    "`{}` is an angular rate: 1 Hz counts as 1 rad/s",
                    label.name
                );
                notes.push(
                    Diagnostic::note(Code::DoubtfulUnit, message)
                        .at(label.span.clone(), "")
                        .help("write `unit = \"rad/s\"`, or `rpm` for revolutions per minute"),
                );
            }
        }
        for note in notes {
            self.tell(note);
        }
    }
}

fn is_in_radians(label: &Label) -> bool {
    label.unit.text == "rad"
}

fn in_degrees(what: &str, angle: f64, span: &Span) -> Diagnostic {
    let message = format!(
        "{what} is {angle} rad, which is {:.0} deg",
        angle.to_degrees()
    );
    Diagnostic::note(Code::DoubtfulUnit, message)
        .at(span.clone(), "")
        .help("if it is in degrees, write the unit `deg`")
}

/// Whether an expression has the rate of an angle.
fn turns(expr: &Expr, mechanism: &Mechanism) -> bool {
    let mut found = false;
    expr.visit(&mut |quantity| {
        if let Quantity::Rate(q) = quantity {
            found |= mechanism.coordinates[q].label.unit.is_angle();
        }
    });
    found
}
