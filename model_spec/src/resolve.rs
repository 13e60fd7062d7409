//! Syntax tree to mechanism: names become references, and every unit is checked.

mod arithmetic;
mod bodies;
mod constraints;
mod definitions;
mod degrees;
mod dimensions;
mod expression;
mod formula;
mod load_order;
mod loads;
mod meaning;
mod mistaken;
mod named;
mod names;
mod nominal;
mod orientations;
mod place;
mod placement;
mod quantities;
mod relative_angle;
mod resolver;

use num_traits::ToPrimitive;

use crate::ast::{ItemAst, SpecAst};
use crate::diagnostic::{Code, Diagnostic};
use crate::mechanism::{Coordinate, Mechanism};

pub use formula::{Scope, Snippet, formula};
pub use names::is_reserved;

use resolver::Resolver;

/// Checks a spec without joints. The mechanism holds placeholders wherever a diagnostic reports an error.
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
    resolver.announce_definitions();
    resolver.derivative_names(&signals);
    let frames = resolver.frames();
    let points = resolver.points();
    // Pseudo-velocities may be velocities of points and frames.
    let mut pseudo_velocities = resolver.pseudo_velocities(&coordinates);
    resolver.given_rates(&mut pseudo_velocities);
    let bodies = resolver.bodies(&frames);
    let mut constraints = resolver.constraints(&bodies);
    constraints.extend(orientations::norms(&frames, &constraints));
    let loads = resolver.loads(&bodies, &frames);
    let outputs = resolver.outputs();
    let definitions = resolver.definitions(&coordinates);
    let mut mechanism = Mechanism {
        name,
        title,
        source,
        longest_step,
        file: file.to_owned(),
        parameters: parameters.into(),
        coordinates: coordinates.into(),
        inputs: inputs.into(),
        signals: signals.into(),
        frames: frames.into(),
        points: points.into(),
        bodies: bodies.into(),
        constraints: constraints.into(),
        pseudo_velocities: pseudo_velocities.into(),
        loads: loads.into(),
        outputs: outputs.into(),
        definitions,
    };
    resolver.initial(&mut mechanism);
    orientations::normalise(&mut mechanism);
    resolver.physical(&mechanism);
    resolver.doubtful_angles(&mechanism);
    resolver.mistaken(&mechanism);
    resolver.unused(&mechanism);
    (mechanism, resolver.findings)
}

impl Resolver<'_> {
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
            let message = "the longest step is not positive".to_owned();
            let help = "omit it unless the equations are stiff";
            let finding = Diagnostic::error(Code::NotPhysical, message);
            self.tell(finding.at(step.span.clone(), "in seconds").help(help));
        }
        seconds
    }

    /// Warns of unused quantities.
    fn unused(&mut self, mechanism: &Mechanism) {
        let mut idle = Vec::new();
        let parameters = mechanism.parameters.iter().map(|p| &p.label);
        let coordinates = mechanism.coordinates.iter().map(|c: &Coordinate| &c.label);
        let inputs = mechanism.inputs.iter().map(|i| &i.label);
        let signals = mechanism.signals.iter().map(|s| &s.label);
        let definitions = mechanism.definitions.iter().map(|d| &d.label);
        for (what, used, labels) in [
            (
                "parameter",
                &self.used.parameters,
                parameters.collect::<Vec<_>>(),
            ),
            ("coordinate", &self.used.coordinates, coordinates.collect()),
            ("input", &self.used.inputs, inputs.collect()),
            ("signal", &self.used.signals, signals.collect()),
            ("definition", &self.reading.used, definitions.collect()),
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
