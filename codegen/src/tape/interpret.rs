//! Executes a tape operation by operation: the reference for emitted and compiled code.

use appell_runtime::dense::lu_solve_in_place;
use appell_runtime::model::{Along, At};
use appell_runtime::real::{Enclosure, Real};

use super::{Argument, Arithmetic, Operation, Tape, Value};
use crate::symbolic::{Function, Relation, applied};

/// The results of a tape at time `t`, state `x`, inputs `u` and parameters `p`, one list per result array.
///
/// # Panics
///
/// If `x`, `u` or `p` are shorter than the arguments that the tape uses.
pub fn interpret(tape: &Tape, t: f64, x: &[f64], u: &[f64], p: &[f64]) -> Vec<Vec<f64>> {
    interpret_weighted(tape, At { t, x, u, p }, &[])
}

/// [`interpret`] for an adjoint with its weights.
///
/// # Panics
///
/// As [`interpret`], and if there are fewer weights than the tape uses.
pub fn interpret_weighted(tape: &Tape, at: At<'_>, weights: &[f64]) -> Vec<Vec<f64>> {
    let At { t, x, u, p } = at;
    let solve = |matrix: &mut [f64], unknowns: &mut [f64]| {
        lu_solve_in_place(matrix, unknowns, unknowns.len());
    };
    results(tape, t, [x, u, p, weights], solve)
}

/// [`interpret_weighted`] into slices, one for each result.
///
/// # Panics
///
/// As [`interpret_weighted`], and if a slice has another length than its result.
pub fn interpret_into(tape: &Tape, at: At<'_>, weights: &[f64], out: &mut [&mut [f64]]) {
    for (out, result) in out.iter_mut().zip(interpret_weighted(tape, at, weights)) {
        out.copy_from_slice(&result);
    }
}

/// Bounds on the results over an interval of time, for functions of time and parameters, one array after the other.
pub fn enclose(tape: &Tape, time: Enclosure, p: &[f64], bounds: &mut [Enclosure]) {
    let along = Along {
        start: f64::NAN,
        t: time,
        x: &[],
        u: &[],
        p,
    };
    enclose_along(tape, &along, bounds);
}

/// Bounds on the results along a trajectory segment, one array after the other.
pub fn enclose_along(tape: &Tape, along: &Along<'_>, bounds: &mut [Enclosure]) {
    let p: Vec<Enclosure> = along.p.iter().map(|&p| Enclosure::constant(p)).collect();
    let unknown = |_: &mut [Enclosure], unknowns: &mut [Enclosure]| {
        unknowns.fill(Enclosure::UNKNOWN);
    };
    let results = results(tape, along.t, [along.x, along.u, &p, &[]], unknown);
    for (bound, found) in bounds.iter_mut().zip(results.iter().flatten()) {
        *bound = *found;
    }
}

/// The results for states, inputs, parameters and weights. `solve` solves a system in place.
fn results<T: Real>(
    tape: &Tape,
    t: T,
    [x, u, p, weights]: [&[T]; 4],
    solve: impl Fn(&mut [T], &mut [T]),
) -> Vec<Vec<T>> {
    let mut values: Vec<T> = Vec::with_capacity(tape.operations.len());
    // Of the latest operation with parts.
    let mut parts: Vec<T> = Vec::new();
    for operation in &tape.operations {
        let at = |value: Value| values[value.index()];
        let all = |list: &[Value]| list.iter().map(|&value| at(value)).collect::<Vec<T>>();
        let value = match operation {
            Operation::Argument(argument) => match *argument {
                Argument::Time => t,
                Argument::State(i) => x[i as usize],
                Argument::Input(i) => u[i as usize],
                Argument::Parameter(i) => p[i as usize],
                Argument::Weight(i) | Argument::OutputWeight(i) | Argument::Acceleration(i) => {
                    weights[i as usize]
                }
            },
            Operation::Constant(number) => T::constant(number.to_f64()),
            Operation::Negate(a) => -at(*a),
            Operation::Binary(operation, a, b) => match operation {
                Arithmetic::Add => at(*a) + at(*b),
                Arithmetic::Subtract => at(*a) - at(*b),
                Arithmetic::Multiply => at(*a) * at(*b),
                Arithmetic::Divide => at(*a) / at(*b),
            },
            Operation::Function(function, a) => applied!(function, at(*a)),
            Operation::Atan2(y, x) => Real::atan2(at(*y), at(*x)),
            Operation::Power(base, exponent) => Real::powf(at(*base), at(*exponent)),
            Operation::Choice {
                relation,
                compared,
                branches,
            } => {
                let [left, right] = compared.map(at);
                let [then, otherwise] = branches.map(at);
                match relation {
                    Relation::Less => Real::if_less(left, right, then, otherwise),
                    Relation::LessOrEqual => Real::if_less_or_equal(left, right, then, otherwise),
                }
            }
            Operation::SinCos(angle) => {
                let (sine, cosine) = Real::sin_cos(at(*angle));
                parts = vec![sine, cosine];
                T::constant(f64::NAN)
            }
            // The matrix is factorised again for every right-hand side, which gives bit-identical results.
            Operation::Factorise(_) => T::constant(f64::NAN),
            Operation::Solve {
                factorisation,
                right,
            } => {
                let mut matrix = all(&tape.operation(*factorisation).operands());
                parts = all(right);
                solve(&mut matrix, &mut parts);
                T::constant(f64::NAN)
            }
            Operation::Part(_, index) => parts[*index as usize],
        };
        values.push(value);
    }
    let entries = |entries: &[Value]| entries.iter().map(|value| values[value.index()]).collect();
    tape.results
        .iter()
        .map(|array| entries(&array.entries))
        .collect()
}
