//! Tapes written by hand, and their values by two routes.

#![expect(clippy::unwrap_used, reason = "a test may stop here")]

mod tree;

use appell_codegen::jit::{
    Elementary, Instructions, NativeFunction, Sizes, Target, VectorFunction,
};
use appell_codegen::symbolic::{Function, Rational};
use appell_codegen::tape::{Argument, Arithmetic, Tape, interpret};
use appell_runtime::lanes::{AtLanes, LANES};
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

/// All routes give the same bits.
#[track_caller]
pub(crate) fn agrees(tape: &Tape, point: &Point) {
    let (found, expected) = (compiled(tape, point), interpreted(tape, point));
    assert!(
        same(&found, &expected),
        "{found:?}\n{expected:?}\nat {point:?}\n{tape:#?}"
    );
    agrees_in_lanes(tape, &around(point));
}

/// Code for every kind of vector instructions that this processor has, and scalar code, each with
/// both kinds of elementary functions.
pub(crate) fn targets() -> impl Iterator<Item = Target> {
    let all = [
        Instructions::Avx512,
        Instructions::Avx2,
        Instructions::Scalar,
    ];
    let exist = all.into_iter().filter(|instructions| instructions.exist());
    exist.flat_map(|instructions| {
        [Elementary::Standard, Elementary::Own].map(|elementary| Target {
            instructions,
            elementary,
        })
    })
}

/// Every lane is bit-identical to scalar code, for all instruction sets.
#[track_caller]
pub(crate) fn agrees_in_lanes(tape: &Tape, points: &[Point; LANES]) {
    let standard = points.each_ref().map(|point| interpreted(tape, point));
    let own = NativeFunction::compile_with(tape, SIZES, Elementary::Own).unwrap();
    let own = points.each_ref().map(|point| {
        let mut result = vec![1.0e300; tape.results[0].entries.len()];
        own.call(point.at(), [&mut result]);
        result
    });
    for target in targets() {
        let expected = match target.elementary {
            Elementary::Standard => &standard,
            Elementary::Own => &own,
        };
        let found = in_lanes(tape, points, target);
        for (l, expected) in expected.iter().enumerate() {
            let found = lane(&found, l);
            assert!(
                same(&found, expected),
                "{found:?}\n{expected:?}\nin lane {l} at {:?}\n{target:?}\n{tape:#?}",
                points[l]
            );
        }
    }
}

/// The numbers of one point.
pub(crate) fn lane(blocks: &[[f64; LANES]], lane: usize) -> Vec<f64> {
    blocks.iter().map(|block| block[lane]).collect()
}

/// The result of a tape at eight points. The buffer starts with numbers that must not survive.
pub(crate) fn in_lanes(tape: &Tape, points: &[Point; LANES], target: Target) -> Vec<[f64; LANES]> {
    let function = VectorFunction::compile_for(tape, SIZES, target).unwrap();
    assert_eq!(
        function.is_vector(),
        target.instructions != Instructions::Scalar,
        "{target:?}"
    );
    evaluated(&function, points, tape.results[0].entries.len())
}

/// The result of a function, of so many numbers, at eight points.
pub(crate) fn evaluated(
    function: &VectorFunction,
    points: &[Point; LANES],
    count: usize,
) -> Vec<[f64; LANES]> {
    let block = |number: &dyn Fn(&Point) -> f64| points.each_ref().map(number);
    let blocks = |numbers: &dyn Fn(&Point) -> Vec<f64>| -> Vec<[f64; LANES]> {
        let len = numbers(&points[0]).len();
        (0..len)
            .map(|i| points.each_ref().map(|point| numbers(point)[i]))
            .collect()
    };
    let at = AtLanes {
        t: &block(&|point| point.t),
        x: &blocks(&|point| point.x.to_vec()),
        u: &blocks(&|point| point.u.to_vec()),
        p: &blocks(&|point| point.p.to_vec()),
    };
    let mut result = vec![[1.0e300; LANES]; count];
    function.call(at, [&mut result]);
    result
}

/// A point, and seven others made of its numbers.
pub(crate) fn around(point: &Point) -> [Point; LANES] {
    std::array::from_fn(|l| {
        let Point {
            mut t,
            mut x,
            mut u,
            mut p,
        } = *point;
        x.rotate_left(l % 3);
        if l % 2 == 1 {
            u.reverse();
            t = -t;
        }
        if l / 2 == 1 {
            p.reverse();
        }
        if l > 3 {
            x[0] = -x[0];
        }
        Point { t, x, u, p }
    })
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
