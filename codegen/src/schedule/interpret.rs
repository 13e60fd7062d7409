//! Interprets a schedule step by step: the reference for emitted and compiled code.

use appell_runtime::dense::lu_solve_in_place;
use appell_runtime::model::{Along, At};
use appell_runtime::real::{Enclosure, Real};

use super::steps::{Argument, Operation, Schedule, Step, Tree, Value};
use crate::symbolic::{Function, Relation};

/// The results of a schedule at time `t`, state `x`, inputs `u` and parameters `p`, one list per
/// result array. Operations and their order are those of the schedule.
///
/// # Panics
///
/// If `x`, `u` or `p` are shorter than the arguments that the schedule uses.
pub fn interpret(schedule: &Schedule, t: f64, x: &[f64], u: &[f64], p: &[f64]) -> Vec<Vec<f64>> {
    interpret_weighted(schedule, At { t, x, u, p }, &[])
}

/// [`interpret`] for an adjoint with its weights.
///
/// # Panics
///
/// As [`interpret`], and if there are fewer weights than the schedule uses.
pub fn interpret_weighted(schedule: &Schedule, at: At<'_>, weights: &[f64]) -> Vec<Vec<f64>> {
    let At { t, x, u, p } = at;
    let solve = |matrix: &mut [f64], unknowns: &mut [f64]| {
        lu_solve_in_place(matrix, unknowns, unknowns.len());
    };
    Machine::new(schedule, t, [x, u, p, weights], solve).results(schedule)
}

/// Bounds on the results over an interval of time, for functions of time and parameters, one array after the other.
pub fn enclose(schedule: &Schedule, time: Enclosure, p: &[f64], bounds: &mut [Enclosure]) {
    let along = Along {
        start: f64::NAN,
        t: time,
        x: &[],
        u: &[],
        p,
    };
    enclose_along(schedule, &along, bounds);
}

/// Bounds on the results along a trajectory segment, one array after the other.
pub fn enclose_along(schedule: &Schedule, along: &Along<'_>, bounds: &mut [Enclosure]) {
    let p: Vec<Enclosure> = along.p.iter().map(|&p| Enclosure::constant(p)).collect();
    let unknown = |_: &mut [Enclosure], unknowns: &mut [Enclosure]| {
        unknowns.fill(Enclosure::UNKNOWN);
    };
    let arguments = [along.x, along.u, &p, &[]];
    let results = Machine::new(schedule, along.t, arguments, unknown).results(schedule);
    for (bound, found) in bounds.iter_mut().zip(results.iter().flatten()) {
        *bound = *found;
    }
}

struct Machine<'a, T, S> {
    t: T,
    /// States, inputs, parameters, weights.
    arguments: [&'a [T]; 4],
    values: Vec<T>,
    /// Matrices by factorisation. They are factorised again for every right-hand side, which gives
    /// bit-identical results.
    matrices: Vec<Vec<T>>,
    /// Solves a system in place.
    solve: S,
}

impl<'a, T: Real, S: Fn(&mut [T], &mut [T])> Machine<'a, T, S> {
    fn new(schedule: &Schedule, t: T, arguments: [&'a [T]; 4], solve: S) -> Self {
        Self {
            t,
            arguments,
            values: vec![T::constant(f64::NAN); schedule.names.len()],
            matrices: Vec::new(),
            solve,
        }
    }

    fn results(mut self, schedule: &Schedule) -> Vec<Vec<T>> {
        for step in &schedule.steps {
            self.step(step);
        }
        let arrays = schedule.results.iter();
        arrays.map(|array| self.all(&array.entries)).collect()
    }

    fn set(&mut self, value: Value, number: T) {
        self.values[value.0 as usize] = number;
    }

    fn all(&self, trees: &[Tree]) -> Vec<T> {
        trees.iter().map(|tree| self.tree(tree)).collect()
    }

    fn step(&mut self, step: &Step) {
        match step {
            Step::Let { value, tree } => self.set(*value, self.tree(tree)),
            Step::SinCos { sin, cos, angle } => {
                let (sine, cosine) = Real::sin_cos(self.tree(angle));
                self.set(*sin, sine);
                self.set(*cos, cosine);
            }
            Step::Factor {
                factorisation,
                matrix,
                ..
            } => {
                let place = *factorisation as usize;
                if self.matrices.len() <= place {
                    self.matrices.resize(place + 1, Vec::new());
                }
                self.matrices[place] = self.all(matrix);
            }
            Step::Solve {
                factorisation,
                values,
                right,
            } => {
                let mut matrix = self.matrices[*factorisation as usize].clone();
                let mut unknowns = self.all(right);
                (self.solve)(&mut matrix, &mut unknowns);
                for (value, number) in values.iter().zip(unknowns) {
                    self.set(*value, number);
                }
            }
            Step::Paragraph { .. } => {}
        }
    }

    // Trees are at most one printed line deep.
    fn tree(&self, tree: &Tree) -> T {
        let [x, u, p, weights] = self.arguments;
        match tree {
            Tree::Value(value) => self.values[value.0 as usize],
            Tree::Argument(Argument::Time) => self.t,
            Tree::Argument(Argument::State(i)) => x[*i as usize],
            Tree::Argument(Argument::Input(i)) => u[*i as usize],
            Tree::Argument(Argument::Parameter(i)) => p[*i as usize],
            Tree::Argument(
                Argument::Weight(i) | Argument::OutputWeight(i) | Argument::Acceleration(i),
            ) => weights[*i as usize],
            Tree::Constant(value) => T::constant(value.to_f64()),
            Tree::Negate(a) => -self.tree(a),
            Tree::Binary(operation, a, b) => {
                let (a, b) = (self.tree(a), self.tree(b));
                match operation {
                    Operation::Add => a + b,
                    Operation::Subtract => a - b,
                    Operation::Multiply => a * b,
                    Operation::Divide => a / b,
                }
            }
            Tree::Function(function, a) => apply(*function, self.tree(a)),
            Tree::Atan2(y, x) => Real::atan2(self.tree(y), self.tree(x)),
            Tree::Power(base, exponent) => Real::powf(self.tree(base), self.tree(exponent)),
            Tree::Choice {
                relation,
                compared,
                branches,
            } => {
                let [left, right] = [&compared[0], &compared[1]].map(|tree| self.tree(tree));
                let [then, otherwise] = [&branches[0], &branches[1]].map(|tree| self.tree(tree));
                match relation {
                    Relation::Less => Real::if_less(left, right, then, otherwise),
                    Relation::LessOrEqual => Real::if_less_or_equal(left, right, then, otherwise),
                }
            }
        }
    }
}

fn apply<T: Real>(function: Function, x: T) -> T {
    match function {
        Function::Sin => Real::sin(x),
        Function::Cos => Real::cos(x),
        Function::Asin => Real::asin(x),
        Function::Acos => Real::acos(x),
        Function::Atan => Real::atan(x),
        Function::Sinh => Real::sinh(x),
        Function::Cosh => Real::cosh(x),
        Function::Tanh => Real::tanh(x),
        Function::Exp => Real::exp(x),
        Function::Ln => Real::ln(x),
        Function::Sqrt => Real::sqrt(x),
        Function::Abs => Real::abs(x),
        Function::Sign => Real::sign(x),
    }
}
