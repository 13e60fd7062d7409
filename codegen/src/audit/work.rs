//! Loads and inputs without work in any admissible motion.

use appell_spec::Code;
use appell_spec::mechanism::{InputId, LoadId, LoadKind};

use super::bench::{Audit, Bench};
use crate::mechanics::algebra::Algebra;
use crate::mechanics::finding::{Finding, Item, listed};
use crate::symbolic::{Expr, SymbolId};

pub(super) fn audit(bench: &mut Bench, told: &mut Audit) {
    let silent = silent_loads(bench);
    loads(bench, &silent, told);
    inputs(bench, &silent, told);
}

/// Loads with zero power.
pub(super) fn silent_loads(bench: &mut Bench) -> Vec<LoadId> {
    let Algebra { graph, test, .. } = &mut bench.algebra;
    let loads = bench.mechanism.loads.ids().zip(&bench.derivation.loads);
    loads
        .filter_map(|(index, load)| {
            let power = load.power(graph);
            test.is_zero(graph, power).then_some(index)
        })
        .collect()
}

fn loads(bench: &Bench, silent: &[LoadId], told: &mut Audit) {
    // A load without work still changes the reactions of constraints.
    let reacting = !bench.mechanism.constraints.is_empty();
    for &index in silent {
        let load = &bench.mechanism.loads[index];
        let names = listed(inputs_of(bench, index).iter().map(|&(_, name, _)| name));
        let subject = if names.is_empty() {
            format!("`{}`", load.name)
        } else {
            format!("`{}` with the input {names}", load.name)
        };
        let [reason, help] = explanation(&load.kind);
        let mut finding = Finding {
            code: Code::NoWork,
            message: format!("{subject} does no work: {reason}"),
            item: Item::Load(index),
            help: help.to_owned(),
        };
        if reacting && names.is_empty() {
            finding.help = format!(
                "no action is needed if only its effect on the reactions is wanted; otherwise {help}"
            );
            told.notes.push(finding);
        } else {
            told.warnings.push(finding);
        }
    }
}

/// Inputs that occur neither in Π nor in an output, except those of loads that are reported already.
fn inputs(bench: &mut Bench, silent: &[LoadId], told: &mut Audit) {
    let is_told: Vec<InputId> = silent
        .iter()
        .flat_map(|&load| inputs_of(bench, load))
        .map(|(input, ..)| input)
        .collect();
    let mut results = bench.derivation.forces.clone();
    results.extend(&bench.outputs);
    for (index, input) in bench.mechanism.inputs.entries() {
        let symbol = bench.derivation.symbols.inputs[index.index()];
        if !is_told.contains(&index) && bench.are_independent_of(&results, symbol) {
            let name = &input.label.name;
            told.warnings.push(Finding {
                code: Code::NoWork,
                message: format!(
                    "the input `{name}` does no work: its loads cancel in every admissible \
                     motion"
                ),
                item: Item::Input(index),
                help: format!("check the signs of `{name}` in its loads"),
            });
        }
    }
}

/// Ids, names and symbols of the inputs on which a load depends.
fn inputs_of<'a>(bench: &Bench<'a>, load: LoadId) -> Vec<(InputId, &'a str, SymbolId)> {
    let graph = &bench.algebra.graph;
    let symbols: &[Expr] = &bench.derivation.symbols.inputs;
    let inputs = bench.mechanism.inputs.entries().zip(symbols);
    inputs
        .filter_map(|((i, input), &symbol)| {
            Some((i, input.label.name.as_str(), graph.as_symbol(symbol)?))
        })
        .filter(|&(.., symbol)| bench.derivation.loads[load.index()].depends_on(graph, &[symbol]))
        .collect()
}

/// Why a load does no work, and the fix.
fn explanation(kind: &LoadKind) -> [&'static str; 2] {
    match kind {
        LoadKind::Gravity { .. } => [
            "no body can rise or fall",
            "check `down` against the axes in which the points are placed, or remove the load",
        ],
        LoadKind::Force { reaction_on, .. } => [
            if reaction_on.is_none() {
                "its point never moves along the force"
            } else {
                "its two points never move relative to each other along the force"
            },
            "check the components, the frame and the point of the force",
        ],
        LoadKind::Torque { reaction_on, .. } => [
            if reaction_on.is_none() {
                "its body never rotates about the axis of the torque"
            } else {
                "its two bodies never rotate relative to each other about the axis of the torque"
            },
            "check the components, the frame and the body of the torque",
        ],
        LoadKind::SpringDamper { .. } => [
            "its length or coordinate is constant",
            "connect points whose distance can change",
        ],
        LoadKind::Generalized { .. } => [
            "its coordinate or velocity is constant, or the force is zero",
            "name a coordinate or a velocity that can change",
        ],
    }
}
