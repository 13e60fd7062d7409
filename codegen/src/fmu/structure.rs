//! Dependencies between variables: by the zeros of the Jacobians, and by the conditions of discontinuous
//! expressions.

use super::variables::Variables;
use super::xml::Element;
use crate::program::{FunctionKind, Program};
use crate::symbolic::{Expr, Function, Node, SymbolId};

/// The dependencies of a variable.
#[derive(Debug, Default)]
struct Dependencies {
    on: Vec<(usize, &'static str)>,
}

impl Dependencies {
    fn add(&mut self, reference: usize, kind: &'static str) {
        self.on.push((reference, kind));
    }

    fn element(mut self, name: &'static str, reference: usize) -> Element {
        self.on.sort_unstable();
        let list = |texts: Vec<String>| texts.join(" ");
        let on = self.on.iter().map(|(on, _)| on.to_string()).collect();
        let kinds = self.on.iter().map(|(_, kind)| (*kind).to_owned()).collect();
        unknown(name, reference)
            .with("dependencies", list(on))
            .with("dependenciesKind", list(kinds))
    }
}

fn unknown(name: &'static str, reference: usize) -> Element {
    Element::new(name).with("valueReference", reference)
}

/// Rows of the unknowns: value references, expressions, derivatives with respect to states and inputs.
struct Rows<'a> {
    first: usize,
    entries: &'a [Expr],
    by_state: &'a [Expr],
    by_input: &'a [Expr],
}

struct Structure<'a> {
    program: &'a Program,
    variables: &'a Variables,
}

impl Structure<'_> {
    /// Whether an expression is discontinuous: it then depends on its conditions, which derivatives do not
    /// show.
    fn jumps(&self, expr: Expr) -> bool {
        let graph = &self.program.graph;
        let all = graph.in_order(&[expr]);
        all.into_iter().any(|part| {
            matches!(
                graph.node(part),
                Node::Choice { .. } | Node::Function(Function::Sign, _)
            )
        })
    }

    /// The kind of an expression's dependency on a symbol, given the derivative.
    fn kind(&self, expr: Expr, by: SymbolId, derivative: Option<&Expr>) -> Option<&'static str> {
        let graph = &self.program.graph;
        let number = derivative.and_then(|&derivative| graph.as_number(derivative));
        if self.jumps(expr) || derivative.is_none() {
            return graph.mentions(expr, &[by]).then_some("dependent");
        }
        match number {
            Some(zero) if zero.is_zero() => None,
            Some(_) => Some("constant"),
            None => Some("dependent"),
        }
    }

    fn of(&self, rows: &Rows<'_>, index: usize) -> Dependencies {
        let (program, variables) = (self.program, self.variables);
        let (arguments, expr) = (&program.arguments, rows.entries[index]);
        let mut found = Dependencies::default();
        for (first, symbols, derivatives) in [
            (variables.states, arguments.states.as_slice(), rows.by_state),
            (variables.inputs, arguments.inputs.as_slice(), rows.by_input),
        ] {
            let row = derivatives.get(index * symbols.len()..).unwrap_or_default();
            for (k, &symbol) in symbols.iter().enumerate() {
                let is_input = first == variables.inputs;
                if is_input && k >= program.info.declared_inputs {
                    break;
                }
                if let Some(kind) = self.kind(expr, symbol, row.get(k)) {
                    found.add(first + k, kind);
                }
            }
        }
        let signals = &arguments.inputs[program.info.declared_inputs..];
        let of_time = [signals, &[arguments.time]].concat();
        if program.graph.mentions(expr, &of_time) {
            found.add(Variables::TIME, "dependent");
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
            let expr = rows.entries[index];
            if self.program.graph.mentions(expr, &[parameter]) {
                found.add(self.variables.parameters + k, "dependent");
            }
        }
        found.element("InitialUnknown", reference)
    }
}

/// The element `ModelStructure`.
pub(super) fn structure(program: &Program, variables: &Variables) -> Element {
    let entries = |kind: FunctionKind, array: usize| {
        let results = program.function(kind).map(|function| &function.results);
        let array = results.and_then(|results| results.get(array));
        array.map_or(&[][..], |array| array.entries.as_slice())
    };
    let structure = Structure { program, variables };
    let rates = Rows {
        first: variables.rates,
        entries: entries(FunctionKind::Rates, 0),
        by_state: entries(FunctionKind::Jacobians, 1),
        by_input: entries(FunctionKind::Jacobians, 2),
    };
    let outputs = Rows {
        first: variables.outputs,
        entries: entries(FunctionKind::Outputs, 0),
        by_state: entries(FunctionKind::OutputJacobians, 1),
        by_input: entries(FunctionKind::OutputJacobians, 2),
    };
    let all = |rows: &Rows<'_>| 0..rows.entries.len();
    let states = (variables.states..variables.rates).map(|state| {
        let mut itself = Dependencies::default();
        itself.add(state, "constant");
        itself.element("Output", state)
    });
    let now = |name: &'static str, rows: &Rows<'_>, k: usize| {
        structure.of(rows, k).element(name, rows.first + k)
    };
    let speeds = program.info.speeds;
    let dependent = program.dependent.iter();
    let dependent = dependent.map(|q| unknown("InitialUnknown", variables.states + speeds + q));
    let switches = (variables.switches..variables.end).map(|switch| {
        let mut of_time = Dependencies::default();
        of_time.add(Variables::TIME, "dependent");
        of_time.element("EventIndicator", switch)
    });
    Element::new("ModelStructure")
        .holding(states)
        .holding(all(&outputs).map(|k| now("Output", &outputs, k)))
        .holding(all(&rates).map(|k| now("ContinuousStateDerivative", &rates, k)))
        .holding(dependent)
        .holding(all(&rates).map(|k| structure.at_start(&rates, k)))
        .holding(all(&outputs).map(|k| structure.at_start(&outputs, k)))
        .holding(switches)
}
