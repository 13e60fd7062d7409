//! The spec of a study: that of the mechanism, with the quantities defined by the study as parameters and the kept
//! expressions as outputs.

use std::sync::Arc;

use appell_ensemble::study::{Keep, Kept, Text};
use appell_spec::compose::Composition;
use appell_spec::expr::{BinaryOp, Expr, ExprKind, Function, Quantity as Named, Span};
use appell_spec::units;
use appell_spec::{Code, Diagnostic, Mechanism, Reading as Read, Severity};

use super::reading::Reading;
use crate::engine::Engine;
use crate::source::Source;
use crate::{Error, Model};

/// Source of a kept quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quantity {
    State(usize),
    Input(usize),
    /// Its index, and whether it may vary faster than the state.
    Output(usize, bool),
}

/// The model of a spec with the quantities of a study.
pub(super) struct Extended {
    pub(super) model: Arc<Model>,
    /// One for each kept quantity.
    pub(super) kept: Arc<Vec<Quantity>>,
}

/// Extends a spec; nothing if the study is invalid, which is reported.
pub(super) fn extended(
    reading: &mut Reading<'_>,
    source: &Source,
) -> Result<Option<Extended>, Error> {
    let base = appell_spec::load(&source.file, &source.text)?.mechanism;
    let mut composition = Composition::new(&source.text).map_err(Error::computation)?;
    let before = reading.findings.len();
    // Quantities that the study defines are those with a unit.
    let study = reading.study;
    let varied = study.vary.iter().map(|vary| (&vary.name, &vary.unit));
    let noises = study.noise.iter().map(|noise| (&noise.name, &noise.unit));
    for (name, unit) in varied.chain(noises) {
        let Some(unit) = unit else { continue };
        if let Err(error) = units::parse(&unit.text) {
            reading.tell(Code::UnknownUnit, error.to_string(), unit, "");
            continue;
        }
        let fragment = format!(
            "[parameters]\n{} = {{ value = 1, unit = {}, at_least = -1e300, at_most = 1e300, about = \"of the study\" }}\n",
            quoted(&name.text),
            quoted(&unit.text)
        );
        let together = extend(&composition, &fragment)?;
        if take(reading, &together, name, None) {
            composition.add(&fragment).map_err(Error::computation)?;
        }
    }
    let mut kept = Vec::new();
    let mut count = base.outputs.len();
    for (index, keep) in reading.study.keep.iter().enumerate() {
        let text = keep.of.text.trim();
        if let (Some(known), false) = (named(&base, text), matches!(keep.kept, Kept::When { .. })) {
            kept.push(known);
            continue;
        }
        let Some(expression) = expression(reading, keep) else {
            continue;
        };
        let name = format!("kept_{index}_of_the_study");
        let fragment = format!(
            "[outputs]\n{name} = {{ value = {}, about = \"kept\" }}\n",
            quoted(&expression.text)
        );
        let together = extend(&composition, &fragment)?;
        if take(reading, &together, &keep.of, Some((&name, &expression))) {
            composition.add(&fragment).map_err(Error::computation)?;
        }
        kept.push(Quantity::Output(count, true));
        count += 1;
    }
    if reading.findings.len() > before {
        return Ok(None);
    }
    let source = Source {
        robot: source.robot.clone(),
        ..Source::of(source.file.as_str(), composition.text())
    };
    let model = Model::of(source, Some(Engine::Jit))?;
    let outputs = model.setup()?.mechanism.outputs;
    for kept in &mut kept {
        if let Quantity::Output(place, is_fast) = kept {
            *is_fast = outputs
                .iter()
                .as_slice()
                .get(*place)
                .is_none_or(|own| is_fast_of(&own.value));
        }
    }
    Ok(Some(Extended {
        model: Arc::new(model),
        kept: Arc::new(kept),
    }))
}

/// A quantity of a mechanism.
fn named(mechanism: &Mechanism, name: &str) -> Option<Quantity> {
    let speeds = mechanism.pseudo_velocities.iter().map(|w| &w.label);
    let states = speeds.chain(mechanism.coordinates.iter().map(|q| &q.label));
    let states = (0..).map(Quantity::State).zip(states);
    let inputs = mechanism.inputs.iter().map(|u| &u.label);
    let inputs = (0..).map(Quantity::Input).zip(inputs);
    let outputs = mechanism.outputs.iter().map(|y| &y.label);
    let outputs = (0..).map(|y| Quantity::Output(y, true)).zip(outputs);
    let mut all = states.chain(inputs).chain(outputs);
    all.find(|(_, label)| label.name == name)
        .map(|(quantity, _)| quantity)
}

/// Whether an expression may vary faster than its operands.
fn is_fast_of(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Number(_) => false,
        ExprKind::Quantity(quantity) => matches!(quantity, Named::Response(_)),
        ExprKind::Negate(a) => is_fast_of(a),
        ExprKind::Binary(operation, a, b) => {
            let is_smooth = match operation {
                BinaryOp::Add | BinaryOp::Subtract | BinaryOp::Multiply => true,
                BinaryOp::Divide => is_constant(b),
                BinaryOp::Power => matches!(b.kind, ExprKind::Number(_)),
            };
            !is_smooth || is_fast_of(a) || is_fast_of(b)
        }
        ExprKind::Call(Function::Abs, arguments) => arguments.iter().any(is_fast_of),
        ExprKind::Call(..) | ExprKind::Choice { .. } => true,
    }
}

/// Whether an expression is constant in a motion.
fn is_constant(expr: &Expr) -> bool {
    let mut is_constant = true;
    expr.visit(&mut |quantity| is_constant &= matches!(quantity, Named::Parameter(_)));
    is_constant
}

fn extend(composition: &Composition, fragment: &str) -> Result<String, Error> {
    let mut next = composition.clone();
    next.add(fragment).map_err(Error::computation)?;
    Ok(next.text())
}

/// An expression with the positions of its parts in the study file.
struct Expression {
    text: String,
    /// Offsets in the text and in the value of the study file from which on the characters agree.
    parts: Vec<(usize, usize)>,
}

/// The expression of a kept quantity; a comparison becomes a difference that is positive where it is true.
fn expression(reading: &mut Reading<'_>, keep: &Keep) -> Option<Expression> {
    let text = keep.of.text.as_str();
    if !matches!(keep.kept, Kept::When { .. }) {
        return Some(Expression {
            text: text.to_owned(),
            parts: vec![(0, 0)],
        });
    }
    let mut depth = 0_usize;
    let mut signs = text.char_indices().filter(|(_, c)| {
        match c {
            '(' | '[' => depth += 1,
            ')' | ']' => depth = depth.saturating_sub(1),
            _ => {}
        }
        depth == 0 && matches!(c, '<' | '>')
    });
    let (Some((at, sign)), None) = (signs.next(), signs.next()) else {
        let message = "an event is a comparison";
        let help = "write it as in `abs(theta) > 20[deg]`, with `>` or `<`";
        reading.tell(Code::ExpressionSyntax, message, &keep.of, help);
        return None;
    };
    let after = at + 1 + usize::from(text[at + 1..].starts_with('='));
    let (left, right) = (&text[..at], &text[after..]);
    let (first, second) = if sign == '>' {
        ((left, 0), (right, after))
    } else {
        ((right, after), (left, 0))
    };
    Some(Expression {
        text: format!("({}) - ({})", first.0, second.0),
        parts: vec![(1, first.1), (first.0.len() + 5, second.1)],
    })
}

/// Whether an extended spec is valid; errors are reported at their positions in the study file.
fn take(
    reading: &mut Reading<'_>,
    spec: &str,
    at: &Text,
    value: Option<(&str, &Expression)>,
) -> bool {
    let read = Read::new("", spec);
    let errors: Vec<&Diagnostic> = read
        .findings
        .iter()
        .filter(|finding| finding.severity == Severity::Error)
        .collect();
    let start = value.and_then(|(name, _)| {
        let item = spec.rfind(name)?;
        Some(item + spec[item..].find('"')? + 1)
    });
    // Between the quotes, unless there are escapes.
    let inner = at.at.start + 1;
    let same = reading.study.text.get(inner..inner + at.text.len()) == Some(at.text.as_str());
    let place = |span: &Span| -> Span {
        let mapped = start
            .zip(value)
            .filter(|_| same)
            .and_then(|(start, (_, expression))| {
                let within = |byte: usize| {
                    let byte = byte.checked_sub(start)?;
                    let mut parts = expression.parts.iter().rev();
                    let (from, to) = parts.find(|(from, _)| *from <= byte)?;
                    Some(inner + (byte - from + to).min(at.text.len()))
                };
                Some(within(span.start)?..within(span.end)?)
            });
        mapped
            .filter(|span| span.start <= span.end)
            .unwrap_or(at.at.clone())
    };
    let is_right = errors.is_empty();
    for error in errors {
        let mut told = error.clone();
        told.labels = vec![(
            error
                .labels
                .first()
                .map_or(at.at.clone(), |(span, _)| place(span)),
            String::new(),
        )];
        reading.add(told);
    }
    is_right
}

/// A text of a study, which has no control characters, as a string of TOML.
fn quoted(text: &str) -> String {
    let escaped = text.replace('\\', "\\\\").replace('"', "\\\"");
    format!("\"{escaped}\"")
}
