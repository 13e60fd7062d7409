//! Holonomic constraints stated as velocity constraints.
//!
//! Constraint rows are one-forms on positions and time. The admissible motions are spanned by vector fields,
//! one per pseudo-velocity and one for time; alternating between two of them gives a motion along their Lie
//! bracket. By the theorem of Frobenius, a linear combination of rows that vanishes on all iterated brackets is
//! integrable.

use appell_spec::Code;
use appell_spec::mechanism::CoordinateId;

use super::bench::Bench;
use crate::mechanics::algebra::scalar_product;
use crate::mechanics::finding::{Finding, Item, listed};
use crate::mechanics::rank::{Combination, LinearRow, Standing, standings};
use crate::mechanics::row::Row;
use crate::mechanics::symbols::ids;
use crate::symbolic::{Expr, Graph, Substitution};

/// Maximum number of fields whose brackets are formed.
const MOST_FIELDS: usize = 24;
/// Longer velocities are skipped: their brackets are more expensive than the equations.
const MOST_OPERATIONS: usize = 250;
/// Number of new expressions at which the search ends.
const MOST_EXPRESSIONS: usize = 20_000;

/// A motion that is admissible at every position.
#[derive(Clone)]
struct Field {
    rates: Vec<Expr>,
    /// Whether it includes the passage of time.
    in_time: bool,
}

/// One note per integrable combination of rows.
pub(super) fn findings(bench: &mut Bench) -> Vec<Finding> {
    let rows = &bench.derivation.constraints.rows;
    let rows: Vec<usize> = (0..rows.len()).filter(|&i| rows[i].is_active()).collect();
    if rows.is_empty() {
        return Vec::new();
    }
    let Some(reached) = velocities_of_brackets(bench, &rows) else {
        return Vec::new();
    };
    let by_row: Vec<LinearRow> = (0..rows.len())
        .map(|i| LinearRow::homogeneous(reached.iter().map(|velocities| velocities[i]).collect()))
        .collect();
    let standings = standings(&mut bench.algebra, &by_row);
    let sums = standings.into_iter().enumerate();
    sums.filter_map(|(i, standing)| match standing {
        Standing::Redundant(sum) if !bench.derivation.constraints.rows[rows[i]].of_position => {
            let sum = sum.into_iter().map(|(other, share)| (rows[other], share));
            integrable(bench, rows[i], &sum.collect())
        }
        _ => None,
    })
    .collect()
}

/// Values of the rows on independent brackets of admissible motions. `None` if no combination of rows vanishes
/// on all of them, or if the search grows too large.
fn velocities_of_brackets(bench: &mut Bench, rows: &[usize]) -> Option<Vec<Vec<Expr>>> {
    let limit = bench.algebra.graph.len() + MOST_EXPRESSIONS;
    let rates = &bench.derivation.velocities.rates;
    if bench.algebra.graph.operations(rates) > MOST_OPERATIONS {
        return None;
    }
    // Position constraints are integrable by definition.
    let all = &bench.derivation.constraints.rows;
    let hidden = rows.iter().filter(|&&row| !all[row].of_position).count();
    let mut fields = allowed(bench);
    let mut reached: Vec<LinearRow> = Vec::new();
    let mut done = 0;
    while done < fields.len() {
        let (mut brackets, known) = (Vec::new(), reached.len());
        for b in done..fields.len() {
            for a in 0..b {
                if fields.len() > MOST_FIELDS || bench.algebra.graph.len() > limit {
                    return None;
                }
                let bracket = bracket(bench, &fields[a], &fields[b]);
                let velocities = velocities(bench, rows, &bracket);
                if velocities.iter().any(|&v| v != Graph::ZERO) {
                    reached.push(LinearRow::homogeneous(velocities));
                    brackets.push(bracket);
                }
            }
        }
        done = fields.len();
        let standings = standings(&mut bench.algebra, &reached);
        let mut new = standings.iter().map(|s| *s == Standing::Independent);
        let mut brackets = brackets.into_iter();
        let mut index = 0;
        reached.retain(|_| {
            let keep = new.next().unwrap_or(false);
            if index >= known
                && let Some(bracket) = brackets.next()
                && keep
            {
                fields.push(bracket);
            }
            index += 1;
            keep
        });
        if reached.len() == hidden {
            return None;
        }
    }
    Some(reached.into_iter().map(|row| row.coefficients).collect())
}

/// The admissible motions: q̇ per pseudo-velocity, and q̇ at zero pseudo-velocities.
fn allowed(bench: &mut Bench) -> Vec<Field> {
    let (symbols, velocities) = (&bench.derivation.symbols, &bench.derivation.velocities);
    let algebra = &mut bench.algebra;
    let mut fields: Vec<Field> = Vec::new();
    for &speed in &symbols.speeds {
        let rates = velocities.rates.iter();
        let rates = rates.map(|&rate| algebra.derivative(rate, speed)).collect();
        let in_time = false;
        fields.push(Field { rates, in_time });
    }
    let mut at_rest = Substitution::by_zero(&algebra.graph, &symbols.speeds);
    let drift = velocities.rates.iter();
    let drift = drift.map(|&rate| at_rest.apply(&mut algebra.graph, rate));
    if let Some(rates) = drift.collect() {
        let in_time = true;
        fields.push(Field { rates, in_time });
    }
    fields
}

/// `[a, b]`: the net motion along a, b, -a, -b in turn.
fn bracket(bench: &mut Bench, a: &Field, b: &Field) -> Field {
    let rates = (0..a.rates.len()).map(|k| {
        let along_a = derivative_along(bench, b.rates[k], a);
        let along_b = derivative_along(bench, a.rates[k], b);
        let difference = bench.algebra.graph.sub(along_a, along_b);
        bench.algebra.unless_zero(difference)
    });
    let rates = rates.collect();
    let in_time = false;
    Field { rates, in_time }
}

fn derivative_along(bench: &mut Bench, expr: Expr, field: &Field) -> Expr {
    let symbols = &bench.derivation.symbols;
    let algebra = &mut bench.algebra;
    let mut parts = Vec::new();
    for (&coordinate, &rate) in symbols.coordinates.iter().zip(&field.rates) {
        if rate != Graph::ZERO {
            let partial = algebra.derivative(expr, coordinate);
            parts.push(algebra.graph.mul(partial, rate));
        }
    }
    if field.in_time {
        parts.push(algebra.derivative(expr, symbols.time));
        for [value, first, second] in &symbols.signals {
            for (symbol, rate) in [(value, first), (first, second)] {
                let partial = algebra.derivative(expr, *symbol);
                parts.push(algebra.graph.mul(partial, *rate));
            }
        }
    }
    algebra.graph.sum(&parts)
}

/// Values of the rows on a bracket, which has no time component.
fn velocities(bench: &mut Bench, rows: &[usize], bracket: &Field) -> Vec<Expr> {
    let all = &bench.derivation.constraints.rows;
    let algebra = &mut bench.algebra;
    rows.iter()
        .map(|&row| {
            let coefficients = &all[row].coefficients;
            let velocity = scalar_product(&mut algebra.graph, coefficients, &bracket.rates);
            algebra.unless_zero(velocity)
        })
        .collect()
}

/// The note for the integrable combination `row - Σ share · other`; `None` if a position constraint states it.
fn integrable(bench: &mut Bench, row: usize, sum: &Combination) -> Option<Finding> {
    let rows = &bench.derivation.constraints.rows;
    let algebra = &mut bench.algebra;
    let mut total = |part: &dyn Fn(usize) -> Expr| {
        let mut parts = vec![part(row)];
        for &(other, share) in sum {
            let share = algebra.graph.mul(share, part(other));
            parts.push(algebra.graph.neg(share));
        }
        let total = algebra.graph.sum(&parts);
        algebra.shortest(total)
    };
    let count = bench.mechanism.coordinates.len();
    let form: Vec<Expr> = (0..count)
        .map(|q| total(&|row| rows[row].coefficients[q]))
        .collect();
    let rest = total(&|row| rows[row].rest);
    if is_stated(bench, &form, rest) {
        return None;
    }
    let tied: Vec<&str> = (0..count)
        .filter(|&q| form[q] != Graph::ZERO)
        .map(|q| &*bench.mechanism.coordinates[CoordinateId::new(q)].label.name)
        .collect();
    let mut names: Vec<&str> = sum.iter().map(|&(r, _)| rows[r].name.as_str()).collect();
    names.push(&rows[row].name);
    let subject = match names.as_slice() {
        [one] => format!("`{one}` is integrable: it"),
        several => format!("{} are integrable together: they", listed(several.to_vec())),
    };
    let verb = if names.len() == 1 {
        ["keeps", "relates"]
    } else {
        ["keep", "relate"]
    };
    let relation = relation(bench, &form).map(|relation| bench.shown(relation));
    let what = match relation {
        Some(relation) if rest == Graph::ZERO => {
            format!("{} `{relation}` at its initial value", verb[0])
        }
        _ => format!("{} the positions {}", verb[1], listed(tied.clone())),
    };
    let help = if let [only] = tied.as_slice() {
        format!("remove the constraint and the coordinate `{only}`, and use its value instead")
    } else {
        format!(
            "express one of {} in terms of the others and remove the constraint, or state \
             the relation as a constraint of kind `position`; now the initial state decides its value",
            listed(tied)
        )
    };
    Some(Finding {
        code: Code::IntegrableConstraint,
        message: format!("{subject} {what}"),
        item: Item::Constraint(rows[row].constraint),
        help,
    })
}

/// Whether a form follows from the position constraints, including those whose rows contacts repeat.
fn is_stated(bench: &mut Bench, form: &[Expr], rest: Expr) -> bool {
    let rows = bench.derivation.constraints.rows.iter();
    let rows = rows.filter(|row| row.of_position).map(Row::linear);
    let mut rows: Vec<LinearRow> = rows.collect();
    rows.push(LinearRow {
        coefficients: form.to_vec(),
        rest,
    });
    let standing = standings(&mut bench.algebra, &rows).pop();
    matches!(standing, Some(Standing::Redundant(_)))
}

/// The potential of a form with constant coefficients.
fn relation(bench: &mut Bench, form: &[Expr]) -> Option<Expr> {
    let symbols = &bench.derivation.symbols;
    let graph = &mut bench.algebra.graph;
    let signals = symbols.signals.concat();
    let varying = [&symbols.coordinates[..], &signals, &[symbols.time]].concat();
    let varying = ids(graph, &varying);
    if form.iter().any(|&c| graph.mentions(c, &varying)) {
        return None;
    }
    Some(scalar_product(graph, form, &symbols.coordinates))
}
