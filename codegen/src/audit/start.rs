//! Whether a configuration near the initial one satisfies the position constraints.

use appell_runtime::dense::lu_solve_in_place;
use appell_spec::Code;
use appell_spec::mechanism::CoordinateId;

use super::bench::{Audit, Bench};
use crate::mechanics::finding::{Finding, Item};
use crate::mechanics::symbols::ids;
use crate::symbolic::{Expr, evaluate};

/// Maximum Newton steps; each is halved until the residual decreases.
const STEPS: usize = 50;
const HALVINGS: i32 = 30;
/// Relative tolerance for the residual, and for steps without effect.
const SOLVED: f64 = 1e-9;
/// Relative change of a coordinate that is not reported: initial values are guesses.
const GUESSED: f64 = 0.25;

pub(super) fn audit(bench: &mut Bench, told: &mut Audit) {
    let positions = &bench.derivation.positions;
    let graph = &bench.algebra.graph;
    let first = bench.state.values();
    let errors = evaluate(graph, first, &positions.residual);
    // A non-finite residual cannot be solved; the derivation reports singular states.
    if errors.is_empty() || !size(&errors).is_finite() {
        return;
    }
    let places: Vec<usize> = (positions.dependent.iter())
        .map(|&q| bench.derivation.symbols.coordinates[q])
        .flat_map(|symbol| ids(graph, &[symbol]))
        .map(|id| id.0 as usize)
        .collect();
    match assembled(bench, &places) {
        None => {
            let broken = (0..errors.len()).filter(|&index| errors[index] != 0.0);
            told.warnings
                .extend(broken.map(|index| unsatisfied(bench, index)));
        }
        Some(values) => {
            for (index, (&q, &place)) in positions.dependent.iter().zip(&places).enumerate() {
                let (stated, start) = (first[place], values[place]);
                let far = GUESSED * stated.abs().max(start.abs());
                if stated != 0.0 && (start - stated).abs() > far {
                    told.notes.push(moved(bench, index, q, start));
                }
            }
        }
    }
}

/// Newton's method for the dependent coordinates, at the indices `places` of the symbols. The run-time solver
/// does the same, but needs a compiled model. `None` without convergence.
fn assembled(bench: &Bench, places: &[usize]) -> Option<Vec<f64>> {
    let positions = &bench.derivation.positions;
    let graph = &bench.algebra.graph;
    let columns = |row: &Vec<Expr>| -> Vec<Expr> {
        let dependent = positions.dependent.iter();
        dependent.map(|&q| row[q]).collect()
    };
    let slopes: Vec<Expr> = positions.jacobian.iter().flat_map(columns).collect();
    let residual = |values: &[f64]| evaluate(graph, values, &positions.residual);
    let mut values = bench.state.values().to_vec();
    let mut errors = residual(&values);
    let least = SOLVED * SOLVED * size(&errors);
    for _ in 0..STEPS {
        if size(&errors) <= least {
            return Some(values);
        }
        let mut matrix = evaluate(graph, &values, &slopes);
        let mut step = errors.clone();
        lu_solve_in_place(&mut matrix, &mut step, places.len());
        let moves_little =
            |(step, &place): (&f64, &usize)| step.abs() <= SOLVED * values[place].abs().max(SOLVED);
        let is_small = step.iter().zip(places).all(moves_little);
        let mut shorter = (0..HALVINGS).map(|halved| {
            let mut there = values.clone();
            for (&place, step) in places.iter().zip(&step) {
                there[place] -= step * 0.5_f64.powi(halved);
            }
            let errors = residual(&there);
            (there, errors)
        });
        let better = shorter.find(|(_, there)| size(there) < size(&errors));
        if let Some(better) = better {
            (values, errors) = better;
        } else if !is_small {
            return None;
        }
        if is_small {
            return Some(values);
        }
    }
    None
}

/// Norm of a residual.
fn size(errors: &[f64]) -> f64 {
    errors.iter().map(|error| error * error).sum::<f64>().sqrt()
}

fn unsatisfied(bench: &Bench, index: usize) -> Finding {
    let positions = &bench.derivation.positions;
    let dependent = CoordinateId::new(positions.dependent[index]);
    Finding {
        code: Code::InitialState,
        message: format!(
            "no value of `{}` near the initial one satisfies `{}`: the mechanism cannot be assembled there",
            bench.mechanism.coordinates[dependent].label.name, positions.names[index],
        ),
        item: Item::Constraint(positions.constraints[index]),
        help: "correct the lengths, or the initial values of the other coordinates".to_owned(),
    }
}

fn moved(bench: &Bench, index: usize, q: usize, start: f64) -> Finding {
    let coordinate = &bench.mechanism.coordinates[CoordinateId::new(q)];
    let label = &coordinate.label;
    let shown = |value: f64| format!("{} {}", short(value / label.unit.scale), label.unit.text);
    Finding {
        code: Code::InitialState,
        message: format!(
            "`{}` starts at {}: its initial value, {}, does not satisfy `{}`",
            label.name,
            shown(start),
            shown(coordinate.initial),
            bench.derivation.positions.names[index],
        ),
        item: Item::Constraint(bench.derivation.positions.constraints[index]),
        help: "no action is needed; a dependent coordinate needs an initial value only to choose between solutions"
            .to_owned(),
    }
}

/// A number with four significant digits.
fn short(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    rounded.to_string()
}
