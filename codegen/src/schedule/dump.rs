//! Textual dump of a schedule, for debugging and snapshots.

use std::fmt::Write;

use super::names::ArgumentNames;
use super::piece::text;
use super::steps::{Schedule, Step, Tree, Value};
use crate::program::Program;

impl Schedule {
    /// The steps and the results as text, one per line.
    pub fn dump(&self, program: &Program) -> String {
        dump(self, &ArgumentNames::of(program))
    }
}

fn dump(schedule: &Schedule, arguments: &ArgumentNames) -> String {
    let one = |tree: &Tree| text(tree, schedule, arguments);
    let all = |trees: &[Tree]| trees.iter().map(one).collect::<Vec<_>>().join(", ");
    let name = |value: &Value| schedule.names[value.0 as usize].as_str();
    let mut out = String::new();
    for step in &schedule.steps {
        let line = match step {
            Step::Let { value, tree } => format!("{} = {}", name(value), one(tree)),
            Step::SinCos { sin, cos, angle } => {
                format!("{}, {} = sin_cos({})", name(sin), name(cos), one(angle))
            }
            Step::Factor {
                factorisation,
                matrix,
                ..
            } => {
                format!("lu_{factorisation} = factor({})", all(matrix))
            }
            Step::Solve {
                factorisation,
                values,
                right,
            } => {
                let unknowns: Vec<&str> = values.iter().map(name).collect();
                format!(
                    "{} = lu_{factorisation} \\ ({})",
                    unknowns.join(", "),
                    all(right)
                )
            }
            Step::Paragraph { title } => format!("\n# {title}"),
        };
        let _ = writeln!(out, "{line}");
    }
    for array in &schedule.results {
        let _ = writeln!(out, "\n{} = [{}]", array.name, all(&array.entries));
    }
    out
}
