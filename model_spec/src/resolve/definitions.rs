//! Definitions: named expressions, elaborated anew at each use.
//!
//! A name can replace its expression wherever that is valid: a definition of parameters may be a mass, one of
//! coordinates cannot. Therefore the expression is elaborated in the context of each use, and once by itself to
//! report errors that do not depend on the context.

use crate::ast::{ItemAst, Spanned};
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::Span;
use crate::limits::{MAX_DEFINED, MAX_DEPTH};
use crate::mechanism::{Coordinate, Definition};

use super::dimensions::Typed;
use super::meaning::Meaning;
use super::place::Place;
use super::resolver::Resolver;

/// Findings that depend on the context of a use; the others are reported at the definition.
const BY_PLACE: &[Code] = &[
    Code::MotionMayJump,
    Code::NotAllowedHere,
    Code::NotLinear,
    Code::SignalTooRough,
];

impl Resolver<'_> {
    /// Declares the names of definitions before their uses.
    pub(super) fn announce_definitions(&mut self) {
        let ast = self.ast;
        for (id, item) in ast.items("definitions").iter().enumerate() {
            self.define(&item.name, Meaning::Definition(id), None);
        }
    }

    /// Every definition, checked by itself.
    pub(super) fn definitions(&mut self, coordinates: &[Coordinate]) -> Vec<Definition> {
        let ast = self.ast;
        let items = ast.items("definitions").iter().enumerate();
        let definitions = items.map(|(id, item)| self.definition(id, item, coordinates));
        let definitions = definitions.collect();
        self.settle();
        definitions
    }

    /// Reports errors of definitions that do not depend on their uses.
    pub(super) fn settle(&mut self) {
        for finding in std::mem::take(&mut self.reading.findings) {
            self.tell(finding);
        }
    }

    fn definition(&mut self, id: usize, item: &ItemAst, coordinates: &[Coordinate]) -> Definition {
        // Quantities that occur only in unused definitions count as unused.
        let used = (self.used.clone(), self.reading.used.clone());
        self.reading.open.push(id);
        let typed = self.value_of(item, &Place::DEFINITION);
        self.reading.open.pop();
        (self.used, self.reading.used) = used;
        let (unit, value) = self.checked_unit(item, typed, coordinates);
        Definition {
            label: self.label(item, unit.as_ref()),
            value,
        }
    }

    /// The expression of a definition, in the context of a use.
    pub(super) fn defined(&mut self, id: usize, name: &str, span: Span, place: &Place) -> Typed {
        let ast = self.ast;
        self.reading.used.insert(id);
        let item = &ast.items("definitions")[id];
        let Some(value) = item.expression("value") else {
            return Typed::poisoned(span);
        };
        if let Some(first) = self.reading.open.iter().position(|open| *open == id) {
            self.circle(first);
            return Typed::poisoned(span);
        }
        let before = self.findings.len();
        self.reading.open.push(id);
        let mut typed = self.elaborate(value, place);
        self.reading.open.pop();
        self.findings_through(before, name, &span);
        typed.expr.span = span;
        typed
    }

    /// Reports a cycle of definitions, once.
    fn circle(&mut self, first: usize) {
        let ast = self.ast;
        let items = ast.items("definitions");
        let circle = self.reading.open[first..].to_vec();
        let is_told = circle.iter().any(|id| self.reading.circular.contains(id));
        if is_told {
            return;
        }
        let names: Vec<&Spanned<String>> = circle.iter().map(|id| &items[*id].name).collect();
        let mut told = Diagnostic::error(
            Code::ReferenceCycle,
            format!("the definition `{}` leads back to itself", names[0].value),
        )
        .help("a definition uses others, but never itself");
        for name in names {
            told = told.at(name.span.clone(), "");
        }
        self.reading.findings.push(told);
        self.reading.circular.extend(circle);
    }

    /// Retains the context-dependent findings in a definition, and moves them to the use.
    fn findings_through(&mut self, before: usize, name: &str, span: &Span) {
        let within = self.findings.split_off(before.min(self.findings.len()));
        self.told.retain(|_, index| *index < before);
        for mut finding in within {
            if BY_PLACE.contains(&finding.code) {
                finding.labels = vec![(span.clone(), format!("through `{name}`"))];
                self.tell(finding);
            }
        }
    }

    /// Reports, once, that definitions make expressions too large.
    fn too_much_defined(&mut self, span: Span) {
        if std::mem::replace(&mut self.reading.exceeded, true) {
            return;
        }
        self.reading.findings.push(
            Diagnostic::error(
                Code::LimitExceeded,
                format!(
                    "definitions make the expressions too large: there may be {MAX_DEPTH} nested operations, and {MAX_DEFINED} terms from expanded names"
                ),
            )
            .at(span, "")
            .help("let fewer definitions use others"),
        );
    }

    /// Enters a nested operation; false if expanded definitions exceed the limits of depth or size.
    pub(super) fn enter(&mut self, span: &Span) -> bool {
        self.reading.depth += 1;
        if self.reading.open.is_empty() {
            return true;
        }
        self.reading.count += 1;
        if self.reading.depth > MAX_DEPTH || self.reading.count > MAX_DEFINED {
            self.too_much_defined(span.clone());
        }
        !self.reading.exceeded
    }

    pub(super) fn leave(&mut self) {
        self.reading.depth -= 1;
    }
}
