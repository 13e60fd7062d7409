//! Eight points at once: every lane is bit-identical to scalar code.
#![allow(clippy::float_cmp, reason = "agreement is bit for bit")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::thread;

use appell_codegen::jit::{Elementary, Sizes};
use appell_codegen::symbolic::{Function, Relation};
use appell_codegen::tape::{Argument, Arithmetic, Tape, interpret_weighted};
use appell_runtime::elementary;
use appell_runtime::lanes::{AtLanes, LANES};
use appell_runtime::model::At;
use appell_vector::{Instructions, Target, VectorFunction};

use crate::jit_support::{
    Point, SIZES, Tree, add_result, agrees, agrees_in_lanes, around, binary, evaluated, function,
    in_lanes, interpreted, lane, number, same, set, state, system, tape, targets, value,
};

/// A point with these first states.
fn with_states(a: f64, b: f64) -> Point {
    Point {
        x: [a, b, 0.25],
        ..Point::SOME
    }
}

/// Eight points with these first states.
fn first_states(numbers: [f64; LANES]) -> [Point; LANES] {
    numbers.map(|number| with_states(number, 1.0))
}

#[test]
fn nan_takes_the_other_branch_in_its_lane_alone() {
    let choice = |relation, swapped| Tree::Choice {
        relation,
        compared: Box::new(if swapped {
            [number(0, 1), state(0)]
        } else {
            [state(0), number(0, 1)]
        }),
        branches: Box::new([number(1, 1), state(1)]),
    };
    let relations = [Relation::Less, Relation::LessOrEqual];
    let trees = relations.map(|r| [choice(r, false), choice(r, true)]);
    let tape = tape(vec![], trees.concat());
    let numbers = [
        -1.0,
        f64::NAN,
        0.0,
        1.0,
        -0.0,
        f64::NEG_INFINITY,
        f64::INFINITY,
        -f64::NAN,
    ];
    agrees_in_lanes(&tape, &first_states(numbers));
}

#[test]
fn signs_and_magnitudes_keep_zeros_and_infinities() {
    let names = [Function::Sign, Function::Abs, Function::Sqrt];
    let mut trees = names.map(|name| function(name, state(0))).to_vec();
    trees.push(Tree::Negate(Box::new(state(0))));
    let numbers = [
        0.0,
        -0.0,
        5e-324,
        -5e-324,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NAN,
        -2.0,
    ];
    agrees_in_lanes(&tape(vec![], trees), &first_states(numbers));
}

#[test]
fn negatives_take_the_bits_of_scalar_code_along() {
    let negative = |index| Tree::Negate(Box::new(state(index)));
    let operations = [
        Arithmetic::Add,
        Arithmetic::Subtract,
        Arithmetic::Multiply,
        Arithmetic::Divide,
    ];
    let mut trees = Vec::new();
    for operation in operations {
        trees.push(binary(operation, state(0), negative(1)));
        trees.push(binary(operation, negative(0), state(1)));
        trees.push(binary(operation, negative(0), negative(1)));
        trees.push(Tree::Negate(Box::new(trees[trees.len() - 1].clone())));
    }
    let tape = tape(vec![], trees);
    let numbers = [0.0, -0.0, 1.0, -1.0, 0.1, f64::INFINITY, -1e-310, 3.0];
    for b in numbers {
        agrees_in_lanes(&tape, &numbers.map(|a| with_states(a, b)));
    }
}

/// Sums of products of all pairs of values: most have to be spilled.
fn pairs(count: u32, call_between: bool) -> Tape {
    let mut steps: Vec<_> = (0..count)
        .map(|k| {
            let weight = binary(Arithmetic::Multiply, state(k % 3), number(k.into(), 7));
            set(k, binary(Arithmetic::Add, weight, state((k + 1) % 3)))
        })
        .collect();
    let mut last = count;
    steps.push(set(last, state(0)));
    for i in 0..count {
        for j in 0..count {
            let product = binary(Arithmetic::Multiply, value(i), value((i * 5 + j) % count));
            steps.push(set(last + 1, binary(Arithmetic::Add, value(last), product)));
            last += 1;
        }
        if call_between {
            steps.push(set(last + 1, function(Function::Sin, value(last))));
            last += 1;
        }
    }
    tape(steps, (0..=last).step_by(17).map(value).collect())
}

#[test]
fn values_survive_in_the_frame() {
    for count in [14, 15, 16, 31, 32, 33, 60] {
        agrees(&pairs(count, false), &Point::SOME);
    }
}

#[test]
fn values_survive_calls() {
    for count in [3, 16, 40] {
        agrees(&pairs(count, true), &Point::SOME);
    }
}

#[test]
fn frames_of_many_pages_are_made() {
    // All are live until the last: 2000 blocks are 31 pages.
    let steps = (0..2000).map(|k| {
        let last = if k == 0 { state(0) } else { value(k - 1) };
        set(k, binary(Arithmetic::Add, last, number(k.into(), 3)))
    });
    let mut steps: Vec<_> = steps.collect();
    for k in 0..2000 {
        let product = binary(Arithmetic::Multiply, value(1999 - k), value(2000 + k - 1));
        steps.push(set(2000 + k, product));
    }
    let tape = tape(steps, vec![value(3999), value(2500)]);
    let run = move || agrees(&tape, &Point::SOME);
    thread::Builder::new()
        .stack_size(1 << 20)
        .spawn(run)
        .unwrap()
        .join()
        .unwrap();
}

#[test]
fn systems_exchange_rows_lane_by_lane() {
    for rows in [1, 2, 3, 5, 12, 13, 20] {
        agrees_in_lanes(&system(rows), &around(&Point::SOME));
    }
}

#[test]
fn the_largest_system_is_solved() {
    agrees_in_lanes(&system(64), &around(&Point::SOME));
}

#[test]
fn each_result_goes_to_its_own_slice() {
    let mut tape = tape(vec![], vec![state(0), number(0, 1)]);
    for entries in [
        vec![],
        vec![state(1), state(0)],
        vec![Tree::Argument(Argument::Time)],
        vec![function(Function::Cos, state(2)), state(2)],
    ] {
        add_result(&mut tape, entries);
    }
    for target in targets() {
        let function = VectorFunction::compile_for(&tape, SIZES, target).unwrap();
        let [t, x0, x1, x2] =
            [1.0, 2.0, 3.0, 4.0].map(|first: f64| std::array::from_fn(|l| first + l as f64 / 8.0));
        let at = AtLanes {
            t: &t,
            x: &[x0, x1, x2],
            u: &[[0.0; LANES]; 2],
            p: &[[0.0; LANES]; 2],
        };
        let (mut a, mut b, mut c) = ([[9.0; LANES]; 2], [], [[9.0; LANES]; 2]);
        let (mut d, mut e) = ([[9.0; LANES]; 1], [[9.0; LANES]; 2]);
        function.call(at, [&mut a, &mut b, &mut c, &mut d, &mut e]);
        assert_eq!(a, [x0, [0.0; LANES]]);
        assert_eq!(c, [x1, x0]);
        assert_eq!(d, [t]);
        let cos = match target.elementary {
            Elementary::Standard => f64::cos,
            Elementary::Own => elementary::cos,
        };
        assert_eq!(e, [x2.map(cos), x2]);
    }
}

#[test]
fn weights_are_blocks_as_well() {
    let weight = |index| Tree::Argument(Argument::Weight(index));
    let product = binary(Arithmetic::Multiply, weight(0), state(0));
    let sum = binary(Arithmetic::Add, product, weight(2));
    let tape = tape(vec![], vec![sum]);
    let (x, u, p) = ([0.3, -1.2, 2.5], [0.0; 2], [0.0; 2]);
    let spread = |numbers: &[f64]| -> Vec<[f64; LANES]> {
        let block = |&number: &f64| std::array::from_fn(|l| number * (1.0 + l as f64));
        numbers.iter().map(block).collect()
    };
    let weights = spread(&[1.7, 0.0, -0.3]);
    for target in targets() {
        let function = VectorFunction::compile_for(&tape, SIZES, target).unwrap();
        let (states, inputs) = (spread(&x), spread(&u));
        let at = AtLanes {
            t: &[0.0; LANES],
            x: &states,
            u: &inputs,
            p: &inputs,
        };
        let mut found = [[9.0; LANES]];
        function.call_weighted(at, &weights, [&mut found]);
        for l in 0..LANES {
            let x = lane(&states, l);
            let at = At {
                t: 0.0,
                x: &x,
                u: &u,
                p: &p,
            };
            let expected = interpret_weighted(&tape, at, &lane(&weights, l));
            assert!(same(&[found[0][l]], &expected[0]), "{target:?}");
        }
        let short = AssertUnwindSafe(|| {
            let mut found = [[9.0; LANES]];
            function.call_weighted(at, &weights[..2], [&mut found]);
        });
        assert!(catch_unwind(short).is_err());
    }
}

#[test]
fn slices_of_wrong_length_are_refused() {
    let tape = tape(vec![], vec![state(2), number(0, 1)]);
    for target in targets() {
        let function = VectorFunction::compile_for(&tape, SIZES, target).unwrap();
        let blocks = [[1.0; LANES]; 3];
        let at = AtLanes {
            t: &[0.0; LANES],
            x: &blocks,
            u: &blocks[..2],
            p: &blocks[..2],
        };
        let refused = |at: AtLanes<'_>, len: usize| {
            let mut result = vec![[9.0; LANES]; len];
            let outcome = catch_unwind(AssertUnwindSafe(|| function.call(at, [&mut result])));
            assert_eq!(result, vec![[9.0; LANES]; len], "nothing is written");
            outcome.is_err()
        };
        assert!(refused(
            AtLanes {
                x: &blocks[..2],
                ..at
            },
            2
        ));
        assert!(refused(AtLanes { u: &blocks, ..at }, 2));
        assert!(refused(AtLanes { p: &[], ..at }, 2));
        assert!(refused(at, 1));
        assert!(refused(at, 3));
    }
}

#[test]
fn an_empty_function_does_nothing() {
    let none = Sizes {
        states: 0,
        inputs: 0,
        parameters: 0,
    };
    for target in targets() {
        let function = VectorFunction::compile_for(&tape(vec![], vec![]), none, target).unwrap();
        let at = AtLanes {
            t: &[0.0; LANES],
            x: &[],
            u: &[],
            p: &[],
        };
        function.call(at, [&mut []]);
    }
}

#[test]
fn threads_share_one_function() {
    let tape = system(3);
    let points = around(&Point::SOME);
    let expected = in_lanes(&tape, &points, Target::default());
    thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                for _ in 0..20 {
                    let found = in_lanes(&tape, &points, Target::default());
                    assert_eq!(found, expected);
                }
            });
        }
    });
}

#[test]
fn what_a_processor_lacks_is_done_place_by_place() {
    assert!(Instructions::Scalar.exist());
    assert!(Instructions::best().exist());
    let function = VectorFunction::compile(&system(2), SIZES).unwrap();
    assert_eq!(
        function.is_vector(),
        Instructions::best() != Instructions::Scalar
    );
}

#[test]
fn what_cannot_be_compiled_is_interpreted_in_every_lane() {
    // More unknowns than machine code takes.
    let (tape, points) = (system(65), around(&Point::SOME));
    let target = Target::default();
    let function = VectorFunction::compile_or_interpret(&tape, SIZES, target).unwrap();
    assert!(!function.is_vector());
    let found = evaluated(&function, &points, 2 * 65);
    for (l, point) in points.iter().enumerate() {
        assert!(same(&lane(&found, l), &interpreted(&tape, point)));
    }
}

/// A function of the first two states, and its reference implementation.
type Known = (Tree, fn(f64, f64) -> f64);

#[test]
fn own_functions_are_those_of_the_runtime() {
    let unary = |name| function(name, state(0));
    let pair = || [Box::new(state(0)), Box::new(state(1))];
    let [y, x] = pair();
    let [base, exponent] = pair();
    let known: [Known; 12] = [
        (unary(Function::Sin), |x, _| elementary::sin(x)),
        (unary(Function::Cos), |x, _| elementary::cos(x)),
        (unary(Function::Asin), |x, _| elementary::asin(x)),
        (unary(Function::Acos), |x, _| elementary::acos(x)),
        (unary(Function::Atan), |x, _| elementary::atan(x)),
        (unary(Function::Sinh), |x, _| elementary::sinh(x)),
        (unary(Function::Cosh), |x, _| elementary::cosh(x)),
        (unary(Function::Tanh), |x, _| elementary::tanh(x)),
        (unary(Function::Exp), |x, _| elementary::exp(x)),
        (unary(Function::Ln), |x, _| elementary::ln(x)),
        (Tree::Atan2(y, x), elementary::atan2),
        (Tree::Power(base, exponent), elementary::powf),
    ];
    let tape = tape(vec![], known.iter().map(|(tree, _)| tree.clone()).collect());
    // Angles that need extended reduction together with ordinary ones.
    let numbers = [0.3, -1e22, 710.0, f64::NAN, -0.0, 0.99, f64::INFINITY, 1e9];
    let second = [2.5, -0.7, 0.0, 1.0, -2.0, f64::NAN, 3.0, -1e-300];
    let points = std::array::from_fn(|l| with_states(numbers[l], second[l]));
    agrees_in_lanes(&tape, &points);
    for target in targets().filter(|target| target.elementary == Elementary::Own) {
        let found = in_lanes(&tape, &points, target);
        for l in 0..LANES {
            let expected: Vec<f64> = known
                .iter()
                .map(|(_, f)| f(numbers[l], second[l]))
                .collect();
            assert!(same(&lane(&found, l), &expected), "{target:?}, lane {l}");
        }
    }
}
