//! Tapes written by hand, and their values by two routes.

#![expect(clippy::unwrap_used, reason = "a test may stop here")]

mod tree;

use appell_codegen::jit::{NativeFunction, Sizes};
use appell_codegen::symbolic::{Function, Rational};
use appell_codegen::tape::{Argument, Arithmetic, Tape, interpret};
use appell_runtime::model::At;

pub(crate) use tree::{Step, Tree, add_result, tape};

/// Arguments of all test tapes: three states, two inputs, two parameters.
pub(crate) const SIZES: Sizes = Sizes {
    states: 3,
    inputs: 2,
    parameters: 2,
};

/// Numbers for the arguments.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Point {
    pub(crate) t: f64,
    pub(crate) x: [f64; 3],
    pub(crate) u: [f64; 2],
    pub(crate) p: [f64; 2],
}

impl Point {
    pub(crate) const SOME: Self = Self {
        t: 0.7,
        x: [0.3, -1.2, 2.5],
        u: [-0.4, 1.9],
        p: [3.0, -0.125],
    };

    pub(crate) fn at(&self) -> At<'_> {
        At {
            t: self.t,
            x: &self.x,
            u: &self.u,
            p: &self.p,
        }
    }
}

pub(crate) fn value(index: u32) -> Tree {
    Tree::Value(index)
}

pub(crate) fn state(index: u32) -> Tree {
    Tree::Argument(Argument::State(index))
}

pub(crate) fn number(numerator: i64, denominator: i64) -> Tree {
    Tree::Constant(Rational::new(numerator, denominator))
}

pub(crate) fn binary(operation: Arithmetic, a: Tree, b: Tree) -> Tree {
    Tree::Binary(operation, Box::new(a), Box::new(b))
}

pub(crate) fn set(index: u32, tree: Tree) -> Step {
    Step::Let { value: index, tree }
}

/// The result of a tape in machine code. The buffer starts with numbers that must not survive.
pub(crate) fn compiled(tape: &Tape, point: &Point) -> Vec<f64> {
    let function = NativeFunction::compile(tape, SIZES).unwrap();
    let mut result = vec![1.0e300; tape.results[0].entries.len()];
    function.call(point.at(), [&mut result]);
    result
}

/// The result of a tape, step by step.
pub(crate) fn interpreted(tape: &Tape, point: &Point) -> Vec<f64> {
    let Point { t, x, u, p } = point;
    interpret(tape, *t, x, u, p).remove(0)
}

/// Equal bit for bit; the sign and payload of NaN are not part of a result.
pub(crate) fn same(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len()
        && a.iter()
            .zip(b)
            .all(|(a, b)| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan()))
}

/// Machine code gives the bits of the interpreter.
#[track_caller]
pub(crate) fn agrees(tape: &Tape, point: &Point) {
    let (found, expected) = (compiled(tape, point), interpreted(tape, point));
    assert!(
        same(&found, &expected),
        "{found:?}\n{expected:?}\nat {point:?}\n{tape:#?}"
    );
}

pub(crate) fn function(function: Function, argument: Tree) -> Tree {
    Tree::Function(function, Box::new(argument))
}

/// A system of so many rows whose matrix needs row exchanges, solved for two right-hand sides.
pub(crate) fn system(rows: u32) -> Tape {
    let entry = |i: u32, j: u32| {
        let weight = number(i64::from((i * 31 + j * 17 + 5) % 23) - 11, 7);
        let product = binary(Arithmetic::Multiply, state((i + j) % 3), state(j % 3));
        binary(Arithmetic::Add, weight, product)
    };
    let pairs = (0..rows).flat_map(|i| (0..rows).map(move |j| (i, j)));
    let matrix = pairs.map(|(i, j)| entry(i, j)).collect();
    let solve = |first: u32, right: Vec<Tree>| Step::Solve {
        factorisation: 0,
        values: (first..first + rows).collect(),
        right,
    };
    let steps = vec![
        Step::Factor {
            factorisation: 0,
            matrix,
        },
        solve(0, (0..rows).map(|i| state(i % 3)).collect()),
        // The second right-hand side contains the first unknowns.
        solve(rows, (0..rows).map(value).rev().collect()),
    ];
    tape(steps, (0..2 * rows).map(value).collect())
}
