//! Equations in mathematical notation, above the function that computes them.

use appell_spec::foreign::one_line;

use super::picture::ParametersFirst;
use super::types::Types;
use crate::program::{Array, Function, FunctionKind, Layout, Space};
use crate::symbolic::print::{Letter, Math, Setter, text};
use crate::symbolic::{Expr, Graph, Node};

/// Widest line, in characters.
const WIDEST: usize = 92;
/// Most lines of an equation; the paragraphs of the function document a longer one.
const LONGEST: usize = 5;
/// Most lines above a function.
const MOST: usize = 40;
/// Nodes of the largest expression that is tried.
const LARGEST: usize = 400;

/// The sufficiently short equations as rustdoc lines, and the names in them.
pub(super) fn equations(types: &Types<'_>, function: &Function) -> (Vec<String>, Vec<String>) {
    let graph = &*function.graph;
    let mut writer = Writer {
        graph,
        setter: Setter::new(ParametersFirst(&types.program.arguments.parameters)),
        names: Vec::new(),
    };
    let mut lines = Vec::new();
    for &[left, right] in &function.equations {
        let [left, right] = [left, right].map(|side| writer.terms(side));
        lines.extend(equation(left, right));
    }
    for array in &function.results {
        for (place, &entry) in array.entries.iter().enumerate() {
            let Some(left) = left_side(types, function, array, place) else {
                continue;
            };
            let right = writer.terms(writer.opened(entry));
            // A pseudo-velocity may equal the rate of a coordinate and have its name.
            if right.as_deref() != Some(std::slice::from_ref(&left)) {
                lines.extend(equation(Some(vec![left]), right));
            }
        }
    }
    if lines.len() > MOST {
        lines.clear();
    }
    if lines.is_empty() {
        writer.names.clear();
        lines.extend(in_general(function.kind).map(str::to_owned));
    }
    if lines.is_empty() {
        return (Vec::new(), Vec::new());
    }
    lines.insert(0, "```text".to_owned());
    lines.extend(["```".to_owned(), String::new()]);
    (lines, writer.names)
}

/// The general form of the equation, if the specific one is too long.
fn in_general(kind: FunctionKind) -> Option<&'static str> {
    match kind {
        FunctionKind::AccelerationEnergy => Some("S = Σ ½ m a² + ½ α·J α + α·(ω × J ω)"),
        FunctionKind::Jacobians => Some("M ∂ω̇/∂x = ∂(Π − b)/∂x − ∂M/∂x ω̇"),
        FunctionKind::ParameterJacobian => Some("M ∂ω̇/∂p = ∂(Π − b)/∂p − ∂M/∂p ω̇"),
        FunctionKind::Rates => Some("M ω̇ = Π − b"),
        _ => None,
    }
}

/// The left side of a result's equation; `None` if the equation adds nothing to the names of the code, or is
/// one of [`Function::equations`].
fn left_side(
    types: &Types<'_>,
    function: &Function,
    array: &Array,
    place: usize,
) -> Option<String> {
    let info = &types.program.info;
    let letter = |name: &str| Letter::of(name).to_string();
    let of_speed = |symbol: &str| {
        let speed = &info.states.get(place)?.name;
        let letter = Letter::plain(symbol).below_letter(&Letter::of(speed));
        Some(letter.to_string())
    };
    match (function.kind, array.layout) {
        (FunctionKind::Energies, _) => match &*array.name {
            "kinetic" => Some("T".to_owned()),
            "potential" => Some("V".to_owned()),
            _ => Some("P".to_owned()),
        },
        (FunctionKind::ConstraintResidual, _) => Some("0".to_owned()),
        (FunctionKind::Bias, _) => of_speed("b"),
        (FunctionKind::GeneralizedForces, _) => of_speed("Π"),
        // Pseudo-accelerations are displayed in the equations that determine them.
        (FunctionKind::Rates, Layout::Vector(Space::Rates)) => {
            let label = array.labels.get(place)?;
            (place >= info.speeds).then(|| letter(label))
        }
        (FunctionKind::Kinematics | FunctionKind::Outputs, Layout::Vector(_)) => {
            Some(letter(array.labels.get(place)?))
        }
        _ => None,
    }
}

struct Writer<'a> {
    graph: &'a Graph,
    setter: Setter<ParametersFirst<'a>>,
    /// Names used so far.
    names: Vec<String>,
}

impl Writer<'_> {
    /// The value of a named expression.
    fn opened(&self, expr: Expr) -> Expr {
        self.graph.named_value(expr).unwrap_or(expr)
    }

    /// The signed terms of a sum; `None` if they are too long to display.
    fn terms(&mut self, expr: Expr) -> Option<Vec<String>> {
        if self.graph.in_order(&[expr]).len() > LARGEST {
            return None;
        }
        let formula = self.setter.set(self.graph, expr);
        for &want in &formula.wants {
            // Letters introduced for large subexpressions are not defined in rustdoc.
            let &Node::Named(id) = self.graph.node(want) else {
                return None;
            };
            self.names.push(self.graph.definition(id).name.clone());
        }
        let terms = match formula.math {
            Math::Sum(terms) => terms,
            other => vec![(false, other)],
        };
        let write = |(place, (minus, term)): (usize, (bool, Math))| {
            // A sum of one term gets its brackets and its sign.
            let written = text(&Math::Sum(vec![(false, term)]));
            match (place, minus) {
                (0, false) => written,
                (0, true) => format!("−{written}"),
                (_, false) => format!("+ {written}"),
                (_, true) => format!("− {written}"),
            }
        };
        Some(terms.into_iter().enumerate().map(write).collect())
    }
}

/// Both sides on as many lines as needed, broken before signs; empty if that is too long.
fn equation(left: Option<Vec<String>>, right: Option<Vec<String>>) -> Vec<String> {
    let (Some(left), Some(mut right)) = (left, right) else {
        return Vec::new();
    };
    right[0].insert_str(0, "= ");
    let mut lines: Vec<String> = Vec::new();
    for piece in left.iter().chain(&right) {
        let piece = one_line(piece);
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + piece.chars().count() <= WIDEST => {
                line.push(' ');
                line.push_str(&piece);
            }
            Some(_) => lines.push(format!("    {piece}")),
            None => lines.push(piece),
        }
    }
    let fits = lines.len() <= LONGEST && lines.iter().all(|line| line.chars().count() <= WIDEST);
    if fits { lines } else { Vec::new() }
}
