//! Names: validity and meaning.

use crate::ast::{ItemAst, Spanned};
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::{Function, Quantity, Span};
use crate::ids::{BodyId, ConstraintId, CoordinateId, FrameId, Id, LoadId, PointId, SpeedId};
use crate::language::Target;
use crate::mechanism::{Interpolation, Label, Signal};
use crate::suggest::{did_you_mean, shown};
use crate::units::{Dimension, Unit};

use super::meaning::{Meaning, Named};
use super::resolver::Resolver;

/// An id of items that other items refer to.
pub(super) trait Referred: Id {
    /// Where the name is looked up.
    const TARGET: Target;
}

impl Referred for FrameId {
    const TARGET: Target = Target::Frame;
}

impl Referred for PointId {
    const TARGET: Target = Target::Point;
}

impl Referred for BodyId {
    const TARGET: Target = Target::Body;
}

impl Referred for CoordinateId {
    const TARGET: Target = Target::Coordinate;
}

impl Referred for ConstraintId {
    const TARGET: Target = Target::Constraint;
}

impl Referred for SpeedId {
    const TARGET: Target = Target::PseudoVelocity;
}

impl Referred for LoadId {
    const TARGET: Target = Target::Load;
}

/// Reserved names of the language.
pub fn is_reserved(name: &str) -> bool {
    matches!(name, "t" | "pi" | "dot" | "if") || Function::from_name(name).is_some()
}

/// The index of a coordinate or a pseudo-velocity, where a name means one.
fn state(target: Target, meaning: Meaning) -> Option<usize> {
    match (target, meaning) {
        (Target::Coordinate, Meaning::Quantity(Quantity::Coordinate(id))) => Some(id.index()),
        (Target::PseudoVelocity, Meaning::Quantity(Quantity::PseudoVelocity(id))) => {
            Some(id.index())
        }
        _ => None,
    }
}

impl<'a> Resolver<'a> {
    /// Declares a name; reports a name that is taken.
    pub(super) fn define(
        &mut self,
        name: &'a Spanned<String>,
        meaning: Meaning,
        dimension: Option<Dimension>,
    ) {
        let text = name.value.as_str();
        if is_reserved(text) {
            self.reserved.insert(text);
            let message = format!("`{text}` is reserved in expressions");
            let help = "choose another name";
            self.error(Code::ReservedName, name.span.clone(), message, help);
            return;
        }
        if let Some(first) = self.names.get(text) {
            let diagnostic = Diagnostic::error(
                Code::DuplicateName,
                format!("the name `{text}` is defined twice"),
            )
            .at(name.span.clone(), "again here")
            .at(first.span.clone(), "first here")
            .help("quantities share one namespace; rename one of them");
            self.tell(diagnostic);
            return;
        }
        let named = Named {
            meaning,
            dimension,
            span: name.span.clone(),
        };
        self.names.insert(text, named);
    }

    /// Declares the names of a section before its items are resolved.
    pub(super) fn announce(&mut self, section: &str) {
        let ast = self.ast;
        for (id, item) in ast.items(section).iter().enumerate() {
            let meaning = if section == "outputs" {
                Meaning::Output
            } else {
                Meaning::Quantity(Quantity::PseudoVelocity(SpeedId::new(id)))
            };
            self.define(&item.name, meaning, None);
        }
    }

    /// Reports a name that is also that of a signal's derivative: both are columns of results.
    pub(super) fn derivative_names(&mut self, signals: &[Signal]) {
        for signal in signals {
            let label = &signal.label;
            for order in 1..=signal.interpolation.derivatives() {
                let name = Interpolation::derivative_name(&label.name, order);
                let Some(own) = self.names.get(name.as_str()).map(|named| &named.span) else {
                    continue;
                };
                let named = (own.clone(), format!("called `{name}`"));
                let derived = (
                    label.span.clone(),
                    format!("defines its derivative `{name}`"),
                );
                let mut places = [named, derived];
                // The conflict is reported at the later definition.
                places.sort_by_key(|(span, _)| std::cmp::Reverse(span.start));
                let mut diagnostic = Diagnostic::error(
                    Code::DuplicateName,
                    format!(
                        "`{name}` is also a derivative of the signal `{}`",
                        label.name
                    ),
                )
                .help(format!("rename `{name}` or the signal `{}`", label.name));
                diagnostic.labels.extend(places);
                self.tell(diagnostic);
            }
        }
    }

    /// The label of a quantity. The unit falls back to `1` where an error was reported.
    pub(super) fn label(&self, item: &ItemAst, unit: Option<&Unit>) -> Label {
        Label {
            name: item.name.value.clone(),
            about: Self::about(item),
            unit: unit.cloned().unwrap_or_else(|| Unit::si(Dimension::NONE)),
            line: self.line(&item.name.span),
            span: item.name.span.clone(),
        }
    }

    /// Reports an unknown name once; further uses become labels of the same message.
    pub(super) fn unknown(
        &mut self,
        kind: &'static str,
        name: &str,
        span: &Span,
        diagnostic: impl FnOnce(&Self) -> Diagnostic,
    ) {
        // Its definition may be in a part that could not be parsed.
        if self.ast.broken {
            return;
        }
        let key = (kind, name.to_owned());
        if let Some(index) = self.told.get(&key) {
            if let Some(first) = self.findings.get_mut(*index)
                && first.labels.len() < 4
            {
                first.labels.push((span.clone(), "and here".to_owned()));
            }
            return;
        }
        let diagnostic = diagnostic(self);
        self.told.insert(key, self.findings.len());
        self.tell(diagnostic);
    }

    /// The item to which a key refers; the first item for an invalid reference, which is
    /// reported.
    pub(super) fn reference<I: Referred>(&mut self, item: &ItemAst, key: &str) -> I {
        self.optional_reference(item, key).unwrap_or(I::new(0))
    }

    /// Like [`Self::reference`], for a key that may be left out.
    pub(super) fn optional_reference<I: Referred>(
        &mut self,
        item: &ItemAst,
        key: &str,
    ) -> Option<I> {
        let name = item.text(key)?;
        self.find(name.value, &name.span)
    }

    pub(super) fn find<I: Referred>(&mut self, name: &str, span: &Span) -> Option<I> {
        let target = I::TARGET;
        let found = match target {
            Target::Frame => self.frames.get(name).copied(),
            Target::Point => self.points.get(name).copied(),
            Target::Body => self.bodies.get(name).copied(),
            Target::Constraint => self.constraints.get(name).copied(),
            Target::Load => self.loads.get(name).copied(),
            Target::Coordinate | Target::PseudoVelocity => {
                let named = self.names.get(name);
                named.and_then(|named| state(target, named.meaning))
            }
        };
        if found.is_none() {
            self.unknown(target.word(), name, span, |this| {
                this.unknown_reference(target, name, span)
            });
        }
        found.map(I::new)
    }

    fn unknown_reference(&self, target: Target, name: &str, span: &Span) -> Diagnostic {
        let word = target.word();
        let mut items = self.ast.items(target.section()).iter();
        if items.any(|item| item.name.value == name) {
            let message = format!("the {word} `{}` cannot be named here", shown(name));
            let help =
                "it depends on the item defined here: write the coordinates that it depends on";
            return Diagnostic::error(Code::UnknownReference, message)
                .at(span.clone(), "")
                .help(help);
        }
        let known: Vec<&str> = match target {
            Target::Frame => self.frames.keys().copied().collect(),
            Target::Point => self.points.keys().copied().collect(),
            Target::Body => self.bodies.keys().copied().collect(),
            Target::Constraint => self.constraints.keys().copied().collect(),
            Target::Load => self.loads.keys().copied().collect(),
            Target::Coordinate | Target::PseudoVelocity => self
                .names
                .iter()
                .filter(|(_, named)| state(target, named.meaning).is_some())
                .map(|(name, _)| *name)
                .collect(),
        };
        let help = did_you_mean(name, known.iter().copied(), || {
            if !known.is_empty() && known.len() <= 12 {
                format!("`[{}]` knows {}", target.section(), known.join(", "))
            } else {
                format!("define it in `[{}]`", target.section())
            }
        });
        Diagnostic::error(
            Code::UnknownReference,
            format!("there is no {word} `{}`", shown(name)),
        )
        .at(span.clone(), "")
        .help(help)
    }
}
