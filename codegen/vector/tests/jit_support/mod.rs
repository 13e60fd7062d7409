//! Tapes written by hand at eight points, and their values by three routes.

#![expect(clippy::unwrap_used, reason = "a test may stop here")]

#[path = "../../../tests/jit_support/mod.rs"]
mod tapes;

use appell_codegen::jit::{Elementary, NativeFunction};
use appell_codegen::tape::Tape;
use appell_runtime::lanes::{AtLanes, LANES};
use appell_vector::{Instructions, Target, VectorFunction};

pub(crate) use tapes::*;

/// All routes give the same bits.
#[track_caller]
pub(crate) fn agrees(tape: &Tape, point: &Point) {
    tapes::agrees(tape, point);
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
