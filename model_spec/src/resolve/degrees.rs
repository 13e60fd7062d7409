//! Angles and rates that are probably stated in another unit: 25 rad for a slope, Hz for an angular rate.

use std::f64::consts::TAU;

use num_traits::ToPrimitive;

use super::resolver::Resolver;
use crate::ast::{ExprAst, ExprAstKind, ItemAst};
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::{BinaryOp, Expr, ExprKind, Function, Quantity, Span};
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
            // Angles that grow without bound have no range.
            let most = coordinate
                .range
                .map_or(0.0, |ends| ends[0].abs().max(ends[1].abs()));
            if is_in_radians(label) && most > TAU && coordinate.initial.abs() > TAU {
                let what = format!("the initial value of `{}`", label.name);
                notes.push(in_degrees(&what, coordinate.initial, &label.span));
            } else if is_in_radians(label) && coordinate.range.is_some_and(is_sector_in_degrees) {
                let what = format!("the range of `{}`", label.name);
                notes.push(in_degrees(&what, most, &label.span));
            }
        }
        notes.extend(self.numbers_beside_angles());
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

impl Resolver<'_> {
    /// Plain numbers of more than a revolution in angles of frames and in arguments of `sin`, `cos`, `tan`.
    fn numbers_beside_angles(&self) -> Vec<Diagnostic> {
        let sections = self.ast.sections.iter();
        let items = sections.flat_map(|section| &section.items);
        let mut sums = Vec::new();
        for item in items {
            collect_angles(item, &mut sums);
        }
        let note = |(sum, of): (&ExprAst, &str)| {
            let (angle, span) = large_term(sum)?;
            let note = in_degrees(&format!("a number in {of}"), angle, span);
            Some(note.help(format!("if it is in degrees, write `{angle} [deg]`")))
        };
        sums.into_iter().filter_map(note).collect()
    }
}

/// The expressions of an item that are angles, with a description of each.
fn collect_angles<'a>(item: &'a ItemAst, angles: &mut Vec<(&'a ExprAst, &'static str)>) {
    for entry in &item.entries {
        for item in entry.value.tables() {
            collect_angles(item, angles);
        }
        for expression in entry.value.expressions() {
            // A constant angle is reported elsewhere.
            let is_number = matches!(expression.kind, ExprAstKind::Number(..));
            if entry.key.name == "by" && !is_number {
                angles.push((expression, "the turn"));
            }
            arguments(expression, angles);
        }
    }
}

/// The arguments of trigonometric functions.
fn arguments<'a>(expression: &'a ExprAst, angles: &mut Vec<(&'a ExprAst, &'static str)>) {
    if let ExprAstKind::Call(function, inner) = &expression.kind {
        let of = match function {
            Function::Sin => Some("the argument of `sin`"),
            Function::Cos => Some("the argument of `cos`"),
            Function::Tan => Some("the argument of `tan`"),
            _ => None,
        };
        angles.extend(inner.first().zip(of));
    }
    for part in expression.parts() {
        arguments(part, angles);
    }
}

/// The first term of a sum that is a plain number of more than a revolution.
fn large_term(sum: &ExprAst) -> Option<(f64, &Span)> {
    match &sum.kind {
        ExprAstKind::Number(value, None) => {
            let angle = value.to_f64().filter(|angle| angle.abs() > TAU)?;
            Some((angle, &sum.span))
        }
        ExprAstKind::Negate(inner) => large_term(inner),
        ExprAstKind::Binary(BinaryOp::Add | BinaryOp::Subtract, a, b) => {
            large_term(a).or_else(|| large_term(b))
        }
        _ => None,
    }
}

/// Whether a range looks like one in degrees: at most a revolution to either side, in multiples of five.
fn is_sector_in_degrees(ends: [f64; 2]) -> bool {
    let most = ends[0].abs().max(ends[1].abs());
    most > TAU && most <= 360.0 && ends.iter().all(|end| (end / 5.0).fract() == 0.0)
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

/// Whether an expression contains the rate of an angle.
fn turns(expr: &Expr, mechanism: &Mechanism) -> bool {
    let mut found = false;
    expr.visit(&mut |quantity| {
        if let Quantity::Rate(q) = quantity {
            found |= mechanism.coordinates[q].label.unit.is_angle();
        }
    });
    found
}
