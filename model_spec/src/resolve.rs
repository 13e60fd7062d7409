//! Syntax tree to mechanism: names become references, and every unit is checked.

mod arithmetic;
mod bodies;
mod constraints;
mod dimensions;
mod expression;
mod formula;
mod loads;
mod names;
mod nominal;
mod place;
mod placement;
mod quantities;

use std::collections::BTreeMap;

use num_traits::ToPrimitive;

use crate::ast::{ExprAst, ItemAst, SpecAst};
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::{Expr, Span};
use crate::mechanism::{Coordinate, Interpolation, Mechanism};
use crate::parse::zero;

pub use formula::{Scope, Snippet, formula};

use dimensions::Dim;
use names::{Named, Used};
use place::Place;

/// Maximum number of diagnostics collected.
const MAX_FINDINGS: usize = 1000;

/// Checks a spec. The mechanism holds placeholders wherever a diagnostic reports an error.
pub fn resolve(ast: &SpecAst, file: &str, text: &str) -> (Mechanism, Vec<Diagnostic>) {
    let mut resolver = Resolver::new(ast, text);
    let (name, title, source) = resolver.heading();
    let longest_step = resolver.longest_step();
    let parameters = resolver.parameters();
    let coordinates = resolver.coordinates();
    let inputs = resolver.inputs();
    let signals = resolver.signals();
    resolver.announce("pseudo_velocities");
    resolver.announce("outputs");
    resolver.derivative_names(&signals);
    let pseudo_velocities = resolver.pseudo_velocities(&coordinates);
    let frames = resolver.frames();
    let points = resolver.points();
    let bodies = resolver.bodies();
    let constraints = resolver.constraints(&bodies);
    let loads = resolver.loads(&bodies);
    let outputs = resolver.outputs();
    let mut mechanism = Mechanism {
        name,
        title,
        source,
        longest_step,
        file: file.to_owned(),
        parameters,
        coordinates,
        inputs,
        signals,
        frames,
        points,
        bodies,
        constraints,
        pseudo_velocities,
        loads,
        outputs,
    };
    resolver.initial(&mut mechanism);
    resolver.physical(&mechanism);
    resolver.unused(&mechanism);
    (mechanism, resolver.findings)
}

struct Resolver<'a> {
    ast: &'a SpecAst,
    findings: Vec<Diagnostic>,
    /// Where each line of the text starts.
    line_starts: Vec<usize>,
    /// What the names in expressions mean.
    names: BTreeMap<&'a str, Named>,
    /// Names of frames, points and bodies, each with its index.
    frames: BTreeMap<&'a str, usize>,
    points: BTreeMap<&'a str, usize>,
    bodies: BTreeMap<&'a str, usize>,
    /// Unknown names already reported, each with its place in the findings.
    told: BTreeMap<(&'static str, String), usize>,
    /// How smooth each signal is, and its name.
    interpolation: Vec<(Interpolation, &'a str)>,
    /// What occurs in some expression.
    used: Used,
}

impl<'a> Resolver<'a> {
    fn new(ast: &'a SpecAst, text: &str) -> Self {
        let breaks = text.bytes().enumerate().filter(|(_, b)| *b == b'\n');
        Self {
            ast,
            findings: Vec::new(),
            line_starts: std::iter::once(0)
                .chain(breaks.map(|(i, _)| i + 1))
                .collect(),
            names: BTreeMap::new(),
            frames: BTreeMap::from([("ground", 0)]),
            points: BTreeMap::from([("O", 0)]),
            bodies: BTreeMap::new(),
            told: BTreeMap::new(),
            interpolation: Vec::new(),
            used: Used::default(),
        }
    }

    fn tell(&mut self, diagnostic: Diagnostic) {
        if self.findings.len() < MAX_FINDINGS {
            self.findings.push(diagnostic);
        }
    }

    /// Line of a place, from 1.
    fn line(&self, span: &Span) -> usize {
        self.line_starts
            .partition_point(|start| *start <= span.start)
    }

    fn heading(&self) -> (String, String, Option<String>) {
        let item = self.ast.items("mechanism").first();
        let text = |key| {
            item.and_then(|i: &ItemAst| i.text(key))
                .map(|t| t.value.to_owned())
        };
        (
            text("name").unwrap_or_default(),
            text("title").unwrap_or_default(),
            text("source"),
        )
    }

    fn longest_step(&mut self) -> Option<f64> {
        let item = self.ast.items("mechanism").first();
        let step = item.and_then(|item: &ItemAst| item.number("longest_step"))?;
        let seconds = step
            .value
            .to_f64()
            .filter(|step| step.is_finite() && *step > 0.0);
        if seconds.is_none() {
            self.tell(
                Diagnostic::error(
                    Code::NotPhysical,
                    "the longest step is not positive".to_owned(),
                )
                .at(step.span.clone(), "in seconds")
                .help("omit it unless the equations are stiff"),
            );
        }
        seconds
    }

    /// The expression under a key, of the dimension that its place requires.
    fn expression_of(&mut self, item: &ItemAst, key: &str, place: &Place, dimension: Dim) -> Expr {
        let missing = || zero(item.name.span.clone());
        let ast = item.expression(key).cloned().unwrap_or_else(missing);
        self.expression(&ast, place, dimension)
    }

    fn expression(&mut self, ast: &ExprAst, place: &Place, dimension: Dim) -> Expr {
        let typed = self.elaborate(ast, place);
        self.expect(&typed, dimension, place);
        typed.expr
    }

    /// The components under a key, all of one dimension.
    fn components_of(
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
    fn about(item: &ItemAst) -> String {
        item.text("about")
            .map(|t| t.value.to_owned())
            .unwrap_or_default()
    }

    /// Warns of quantities that nothing uses.
    fn unused(&mut self, mechanism: &Mechanism) {
        let mut idle = Vec::new();
        let parameters = mechanism.parameters.iter().map(|p| &p.label);
        let coordinates = mechanism.coordinates.iter().map(|c: &Coordinate| &c.label);
        let inputs = mechanism.inputs.iter().map(|i| &i.label);
        let signals = mechanism.signals.iter().map(|s| &s.label);
        for (what, used, labels) in [
            (
                "parameter",
                &self.used.parameters,
                parameters.collect::<Vec<_>>(),
            ),
            ("coordinate", &self.used.coordinates, coordinates.collect()),
            ("input", &self.used.inputs, inputs.collect()),
            ("signal", &self.used.signals, signals.collect()),
        ] {
            for (id, label) in labels.into_iter().enumerate() {
                if !used.contains(&id) {
                    idle.push(
                        Diagnostic::warning(
                            Code::UnusedName,
                            format!("the {what} `{}` is never used", label.name),
                        )
                        .at(label.span.clone(), "")
                        .help("use it in an expression, or remove it"),
                    );
                }
            }
        }
        for warning in idle {
            self.tell(warning);
        }
    }
}
