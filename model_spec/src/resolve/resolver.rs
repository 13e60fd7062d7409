//! State shared by the resolution of all sections.

use std::collections::{BTreeMap, BTreeSet};

use crate::ast::{ExprAst, ItemAst, SpecAst};
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::{Expr, Span};
use crate::mechanism::Interpolation;
use crate::parse::zero;

use super::dimensions::Dim;
use super::meaning::{Acting, Named, Reading, Used};
use super::place::Place;

/// Maximum number of diagnostics collected.
const MAX_FINDINGS: usize = 1000;

/// A spec during its resolution to a mechanism, with findings.
pub(super) struct Resolver<'a> {
    pub(super) ast: &'a SpecAst,
    pub(super) findings: Vec<Diagnostic>,
    /// Where each line of the text starts.
    pub(super) line_starts: Vec<usize>,
    /// Meanings of names in expressions.
    pub(super) names: BTreeMap<&'a str, Named>,
    /// Defined names that cannot be used in expressions; each is reported at its definition.
    pub(super) reserved: BTreeSet<&'a str>,
    /// Names of frames, points and bodies, each with its index.
    pub(super) frames: BTreeMap<&'a str, usize>,
    pub(super) points: BTreeMap<&'a str, usize>,
    pub(super) bodies: BTreeMap<&'a str, usize>,
    pub(super) constraints: BTreeMap<&'a str, usize>,
    pub(super) loads: BTreeMap<&'a str, usize>,
    /// The forces of constraints and loads, by index; `None` until they are known.
    pub(super) reacting: Vec<Option<Acting>>,
    /// Coordinates that are components of quaternions.
    pub(super) in_quaternions: Vec<crate::ids::CoordinateId>,
    pub(super) acting: Vec<Option<Acting>>,
    /// Largest polynomial degree since it was last set to zero.
    pub(super) largest_size: u32,
    /// Unknown names already reported, each with the index of its finding.
    pub(super) told: BTreeMap<(&'static str, String), usize>,
    /// How smooth each signal is, and its name.
    pub(super) interpolation: Vec<(Interpolation, &'a str)>,
    /// Quantities that occur in expressions.
    pub(super) used: Used,
    /// The definitions that are being expanded.
    pub(super) reading: Reading,
}

impl<'a> Resolver<'a> {
    pub(super) fn new(ast: &'a SpecAst, text: &str) -> Self {
        let breaks = text.bytes().enumerate().filter(|(_, b)| *b == b'\n');
        Self {
            ast,
            findings: Vec::new(),
            line_starts: std::iter::once(0)
                .chain(breaks.map(|(i, _)| i + 1))
                .collect(),
            names: BTreeMap::new(),
            reserved: BTreeSet::new(),
            frames: BTreeMap::from([("ground", 0)]),
            points: BTreeMap::from([("O", 0)]),
            bodies: BTreeMap::new(),
            constraints: BTreeMap::new(),
            loads: BTreeMap::new(),
            reacting: Vec::new(),
            in_quaternions: Vec::new(),
            acting: Vec::new(),
            largest_size: 0,
            told: BTreeMap::new(),
            interpolation: Vec::new(),
            used: Used::default(),
            reading: Reading::default(),
        }
    }

    pub(super) fn tell(&mut self, diagnostic: Diagnostic) {
        if self.findings.len() < MAX_FINDINGS {
            self.findings.push(diagnostic);
        }
    }

    /// An error at a place, with a remedy.
    pub(super) fn error(
        &mut self,
        code: Code,
        at: Span,
        message: impl Into<String>,
        help: impl Into<String>,
    ) {
        self.tell(Diagnostic::error(code, message).at(at, "").help(help));
    }

    /// Line of a position, from 1.
    pub(super) fn line(&self, span: &Span) -> usize {
        self.line_starts
            .partition_point(|start| *start <= span.start)
    }

    /// The expression under a key, of the dimension that its place requires.
    pub(super) fn expression_of(
        &mut self,
        item: &ItemAst,
        key: &str,
        place: &Place,
        dimension: Dim,
    ) -> Expr {
        let missing = || zero(item.name.span.clone());
        let ast = item.expression(key).cloned().unwrap_or_else(missing);
        self.expression(&ast, place, dimension)
    }

    pub(super) fn expression(&mut self, ast: &ExprAst, place: &Place, dimension: Dim) -> Expr {
        let typed = self.elaborate(ast, place);
        self.expect(&typed, dimension, place);
        self.largest_size = self.largest_size.max(typed.size);
        typed.expr
    }

    /// The components under a key, all of one dimension.
    pub(super) fn components_of(
        &mut self,
        item: &ItemAst,
        key: &str,
        place: &Place,
        dimension: Dim,
    ) -> [Expr; 3] {
        let missing = || std::array::from_fn(|_| zero(item.name.span.clone()));
        let components = item.components(key).cloned().unwrap_or_else(missing);
        components.map(|c| self.expression(&c, place, dimension))
    }

    /// The item's sentence.
    pub(super) fn about(item: &ItemAst) -> String {
        item.text("about")
            .map(|t| t.value.to_owned())
            .unwrap_or_default()
    }
}
