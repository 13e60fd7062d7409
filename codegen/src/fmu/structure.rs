//! Dependencies between variables: by the zeros of the Jacobians, and by the conditions of discontinuous
//! expressions.

use super::variables::Variables;
use super::xml::Element;
use crate::program::{Function, FunctionKind, Program};
use crate::symbolic::{self, Expr, Graph, Node, SymbolId};

/// The dependencies of a variable: value references and kinds.
type Dependencies = Vec<(usize, &'static str)>;

fn element(name: &'static str, reference: usize, mut on: Dependencies) -> Element {
    on.sort_unstable();
    let list = |texts: Vec<String>| texts.join(" ");
    let references = on.iter().map(|(on, _)| on.to_string()).collect();
    let kinds = on.iter().map(|(_, kind)| (*kind).to_owned()).collect();
    unknown(name, reference)
        .with("dependencies", list(references))
        .with("dependenciesKind", list(kinds))
}

fn unknown(name: &'static str, reference: usize) -> Element {
    Element::new(name).with("valueReference", reference)
}

/// Rows of the unknowns: value references, expressions, derivatives with respect to states and inputs.
struct Rows<'a> {
    first: usize,
    values: Entries<'a>,
    by_state: Entries<'a>,
    by_input: Entries<'a>,
}

/// Entries of an array of a function.
#[derive(Clone, Copy)]
struct Entries<'a>(Option<(&'a Function, &'a [Expr])>);

impl<'a> Entries<'a> {
    fn of(program: &'a Program, kind: FunctionKind, array: usize) -> Self {
        let function = program.function(kind);
        Self(function.and_then(|function| {
            let array = function.results.get(array)?;
            Some((function, array.entries.as_slice()))
        }))
    }

    fn len(self) -> usize {
        self.0.map_or(0, |(_, entries)| entries.len())
    }

    /// An entry with its graph.
    fn get(self, index: usize) -> Option<(&'a Graph, Expr)> {
        let (function, entries) = self.0?;
        Some((&function.graph, *entries.get(index)?))
    }
}

struct Structure<'a> {
    program: &'a Program,
    variables: &'a Variables,
}

/// Whether an expression is discontinuous: it then depends on its conditions, which derivatives do not show.
fn jumps(graph: &Graph, expr: Expr) -> bool {
    let all = graph.in_order(&[expr]);
    all.into_iter().any(|part| {
        matches!(
            graph.node(part),
            Node::Choice { .. } | Node::Function(symbolic::Function::Sign, _)
        )
    })
}

/// The kind of a value's dependency on a symbol, given the derivative.
fn kind(
    (graph, value): (&Graph, Expr),
    by: SymbolId,
    derivative: Option<(&Graph, Expr)>,
) -> Option<&'static str> {
    match derivative {
        Some((of, derivative)) if !jumps(graph, value) => match of.as_number(derivative) {
            Some(zero) if zero.is_zero() => None,
            Some(_) => Some("constant"),
            None => Some("dependent"),
        },
        _ => graph.mentions(value, &[by]).then_some("dependent"),
    }
}

impl Structure<'_> {
    fn of(&self, rows: &Rows<'_>, index: usize) -> Dependencies {
        let (program, variables) = (self.program, self.variables);
        let arguments = &program.arguments;
        let mut found = Dependencies::new();
        let Some(value) = rows.values.get(index) else {
            return found;
        };
        for (first, symbols, derivatives) in [
            (variables.states, arguments.states.as_slice(), rows.by_state),
            (variables.inputs, arguments.inputs.as_slice(), rows.by_input),
        ] {
            for (k, &symbol) in symbols.iter().enumerate() {
                let is_input = first == variables.inputs;
                if is_input && k >= program.info.declared_inputs {
                    break;
                }
                let derivative = derivatives.get(index * symbols.len() + k);
                if let Some(kind) = kind(value, symbol, derivative) {
                    found.push((first + k, kind));
                }
            }
        }
        let signals = &arguments.inputs[program.info.declared_inputs..];
        let of_time = [signals, &[arguments.time]].concat();
        let (graph, value) = value;
        if graph.mentions(value, &of_time) {
            found.push((Variables::TIME, "dependent"));
        }
        found
    }

    /// The dependencies at initialisation, where parameters are known as well.
    fn at_start(&self, rows: &Rows<'_>, index: usize) -> Element {
        let reference = rows.first + index;
        // Dependent coordinates are unknown at initialisation, and all variables depend on them.
        if !self.program.dependent.is_empty() {
            return unknown("InitialUnknown", reference);
        }
        let mut found = self.of(rows, index);
        for (k, &parameter) in self.program.arguments.parameters.iter().enumerate() {
            let value = rows.values.get(index);
            if value.is_some_and(|(graph, value)| graph.mentions(value, &[parameter])) {
                found.push((self.variables.parameters + k, "dependent"));
            }
        }
        element("InitialUnknown", reference, found)
    }
}

/// The element `ModelStructure`.
pub(super) fn structure(program: &Program, variables: &Variables) -> Element {
    let entries = |kind, array| Entries::of(program, kind, array);
    let structure = Structure { program, variables };
    let rates = Rows {
        first: variables.rates,
        values: entries(FunctionKind::Rates, 0),
        by_state: entries(FunctionKind::Jacobians, 1),
        by_input: entries(FunctionKind::Jacobians, 2),
    };
    let outputs = Rows {
        first: variables.outputs,
        values: entries(FunctionKind::Outputs, 0),
        by_state: entries(FunctionKind::OutputJacobians, 1),
        by_input: entries(FunctionKind::OutputJacobians, 2),
    };
    let all = |rows: &Rows<'_>| 0..rows.values.len();
    let states = (variables.states..variables.rates)
        .map(|state| element("Output", state, vec![(state, "constant")]));
    let now = |name: &'static str, rows: &Rows<'_>, k: usize| {
        element(name, rows.first + k, structure.of(rows, k))
    };
    let speeds = program.info.speeds;
    let dependent = program.dependent.iter();
    let dependent = dependent.map(|q| unknown("InitialUnknown", variables.states + speeds + q));
    let of_time = vec![(Variables::TIME, "dependent")];
    let switches = (variables.switches..variables.end)
        .map(|switch| element("EventIndicator", switch, of_time.clone()));
    Element::new("ModelStructure")
        .holding(states)
        .holding(all(&outputs).map(|k| now("Output", &outputs, k)))
        .holding(all(&rates).map(|k| now("ContinuousStateDerivative", &rates, k)))
        .holding(dependent)
        .holding(all(&rates).map(|k| structure.at_start(&rates, k)))
        .holding(all(&outputs).map(|k| structure.at_start(&outputs, k)))
        .holding(switches)
}
