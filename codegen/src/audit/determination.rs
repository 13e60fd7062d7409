//! The pseudo-velocities and the constraints determine the generalised velocities except at the zeros of the
//! determinant of their coefficients.

use appell_spec::Code;
use appell_spec::mechanism::SpeedId;

use super::bench::{Audit, Bench};
use super::samples::takes_both_signs;
use crate::mechanics::algebra::Algebra;
use crate::mechanics::finding::{Finding, Item, listed};
use crate::mechanics::motions::motions;
use crate::symbolic::{Expr, Graph, Node, SymbolId};

/// Coefficients and determinants with more operations are not examined.
const MOST_OPERATIONS: usize = 300;
/// Maximum number of expanded minors.
const MOST_MINORS: usize = 500;

/// One finding per factor of the determinant that can vanish.
pub(super) fn audit(bench: &mut Bench, told: &mut Audit) {
    let singular = |f: &Finding| f.code == Code::SingularPseudoVelocities;
    if bench.derivation.warnings.iter().any(singular) {
        return;
    }
    let Some((speeds, factors)) = factors_of_determinant(bench) else {
        return;
    };
    for factor in factors {
        let positions = positions(bench, factor);
        if positions.is_empty() {
            continue;
        }
        let names = listed(positions.iter().map(|&(name, _)| name));
        let item = culprit(bench, &speeds, factor);
        let Some(factor_text) = bench.readable(factor) else {
            continue;
        };
        let away = format!(
            "the pseudo-velocities determine the generalised velocities only where \
             `{factor_text}` is not zero"
        );
        let code = Code::SingularPseudoVelocities;
        if bench.declared.cannot_vanish(&bench.algebra.graph, factor) {
            if !is_never_zero(bench, factor) {
                let message = format!("{away}; this holds in the declared ranges");
                let help = format!(
                    "no action is needed; to pass that configuration, choose pseudo-velocities \
                     and angles that are independent there, and widen the range of {names}"
                );
                told.notes.push(Finding {
                    code,
                    message,
                    item,
                    help,
                });
            }
            continue;
        }
        if bench
            .limits
            .as_ref()
            .is_some_and(|limits| limits.keep_off_zero(factor))
        {
            continue;
        }
        let mut excluding = format!("a `range` of {names} that excludes it");
        let is_of = |q| {
            let name = bench.mechanism.coordinates[q].label.name.as_str();
            positions.iter().all(|&(other, _)| other == name)
        };
        let mut proposals = bench.proposals.iter_mut();
        if let Some(proposal) = proposals.find(|proposal| is_of(proposal.coordinate)) {
            proposal.is_told = true;
            excluding = format!("{}, which excludes it", proposal.written(bench.mechanism));
        }
        let help =
            format!("declare {excluding}, or choose pseudo-velocities that are independent there");
        // Samples do not satisfy position constraints, which may exclude the zero.
        if bench.derivation.positions.names.is_empty() && takes_both_signs(bench, factor) {
            let message =
                format!("{away}; the declared ranges include configurations where it is zero");
            told.warnings.push(Finding {
                code,
                message,
                item,
                help,
            });
        } else {
            told.notes.push(Finding {
                code,
                message: away,
                item,
                help,
            });
        }
    }
}

type Matrix = Vec<Vec<Expr>>;

/// The coefficients in the definitions of the pseudo-velocities, and the factors of the determinant of these
/// and the constraints; `None` if they are too long to display.
fn factors_of_determinant(bench: &mut Bench) -> Option<(Matrix, Vec<Expr>)> {
    let (speeds, rows) = coefficients(bench)?;
    let all = [rows, speeds.clone()].concat();
    if bench.algebra.graph.operations(&all.concat()) > MOST_OPERATIONS {
        return None;
    }
    let mut minors = MOST_MINORS;
    let determinant = determinant(&mut bench.algebra, all, &mut minors)?;
    let factors = factors(&mut bench.algebra, determinant);
    Some((speeds, factors))
}

/// Factors of the determinant that may vanish in the declared ranges.
pub(super) fn divisors(bench: &mut Bench) -> Vec<Expr> {
    let factors = factors_of_determinant(bench).map(|(_, factors)| factors);
    let mut factors = factors.unwrap_or_default();
    factors.retain(|&factor| !bench.declared.cannot_vanish(&bench.algebra.graph, factor));
    factors
}

/// Coefficients of q̇ in the definitions of the pseudo-velocities, and in the constraints.
fn coefficients(bench: &mut Bench) -> Option<(Matrix, Matrix)> {
    let free = bench.free();
    let algebra = &mut bench.algebra;
    let mut told = motions(algebra, free.symbols, &bench.unconstrained);
    let mut speeds = Matrix::new();
    for speed in &bench.mechanism.pseudo_velocities {
        let value = free.lower(&mut algebra.graph, &speed.definition).ok()?;
        let value = told.apply(&mut algebra.graph, value)?;
        let row = free.rates.iter().map(|&rate| {
            let coefficient = algebra.derivative(value, rate);
            algebra.shortest(coefficient)
        });
        speeds.push(row.collect());
    }
    let rows = bench.derivation.constraints.rows.iter();
    let rows = rows.filter(|row| row.is_active());
    let rows = rows.map(|row| row.coefficients.clone()).collect();
    Some((speeds, rows))
}

/// Laplace expansion along the row or column with the fewest entries. `None` if it has too many terms.
fn determinant(algebra: &mut Algebra, rows: Matrix, minors: &mut usize) -> Option<Expr> {
    *minors = minors.checked_sub(1)?;
    let n = rows.len();
    if n == 0 {
        return Some(Graph::ONE);
    }
    if rows.iter().any(|row| row.len() != n) {
        return None;
    }
    let transposed = (0..n).map(|c| rows.iter().map(|row| row[c]).collect());
    let transposed: Matrix = transposed.collect();
    let filled = |line: &[Expr]| line.iter().filter(|&&c| c != Graph::ZERO).count();
    let shortest = |lines: &Matrix| (0..n).min_by_key(|&i| filled(&lines[i]));
    let (row, column) = (shortest(&rows)?, shortest(&transposed)?);
    let (lines, line) = if filled(&transposed[column]) < filled(&rows[row]) {
        (transposed, column)
    } else {
        (rows, row)
    };
    let mut terms = Vec::new();
    for place in 0..n {
        let entry = lines[line][place];
        if entry == Graph::ZERO {
            continue;
        }
        let minor = (0..n).filter(|&i| i != line).map(|i| {
            let kept = lines[i].iter().enumerate().filter(|&(c, _)| c != place);
            kept.map(|(_, &entry)| entry).collect()
        });
        let minor = determinant(algebra, minor.collect(), minors)?;
        let term = algebra.graph.mul(entry, minor);
        terms.push(if (line + place) % 2 == 0 {
            term
        } else {
            algebra.graph.neg(term)
        });
    }
    let sum = algebra.graph.sum(&terms);
    if algebra.graph.operations(&[sum]) > MOST_OPERATIONS {
        return None;
    }
    Some(algebra.shortest(sum))
}

/// The distinct factors of a product that can vanish.
fn factors(algebra: &mut Algebra, product: Expr) -> Vec<Expr> {
    let (_, product) = algebra.graph.split_coefficient(product);
    let factors = match algebra.graph.node(product) {
        Node::Product(factors) => factors
            .iter()
            .filter(|factor| factor.exponent > 0)
            .map(|factor| factor.base)
            .collect(),
        _ => vec![product],
    };
    factors.into_iter().map(|f| algebra.shortest(f)).collect()
}

/// Names and symbols of the coordinates in an expression.
fn positions<'a>(bench: &Bench<'a>, expr: Expr) -> Vec<(&'a str, SymbolId)> {
    let graph = &bench.algebra.graph;
    let coordinates = bench.mechanism.coordinates.iter();
    coordinates
        .zip(&bench.derivation.symbols.coordinates)
        .filter_map(|(q, &symbol)| Some((q.label.name.as_str(), graph.as_symbol(symbol)?)))
        .filter(|&(_, symbol)| graph.mentions(expr, &[symbol]))
        .collect()
}

/// Whether a factor has constant sign even without the declared coordinate ranges.
fn is_never_zero(bench: &Bench, factor: Expr) -> bool {
    let mut unbounded = bench.mechanism.clone();
    for q in &mut unbounded.coordinates {
        q.range = None;
    }
    let graph = &bench.algebra.graph;
    let symbols = &bench.derivation.symbols;
    crate::mechanics::declared_ranges(graph, &unbounded, symbols).cannot_vanish(graph, factor)
}

/// The pseudo-velocity to report: the last one with the factor as a coefficient, else as a part of one, else
/// one that depends on the same coordinates.
fn culprit(bench: &mut Bench, speeds: &Matrix, factor: Expr) -> Item {
    let minus = bench.algebra.graph.neg(factor);
    let graph = &bench.algebra.graph;
    let symbols: Vec<SymbolId> = positions(bench, factor).iter().map(|&(_, s)| s).collect();
    let last =
        |holds: &dyn Fn(Expr) -> bool| speeds.iter().rposition(|row| row.iter().any(|&c| holds(c)));
    last(&|coefficient| coefficient == factor || coefficient == minus)
        .or_else(|| last(&|coefficient| graph.in_order(&[coefficient]).contains(&factor)))
        .or_else(|| last(&|coefficient| graph.mentions(coefficient, &symbols)))
        .map_or(Item::Mechanism, |speed| {
            Item::PseudoVelocity(SpeedId::new(speed))
        })
}
