//! Compiled tapes are bit-identical to the interpreter.
#![allow(clippy::float_cmp, reason = "agreement is bit for bit")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use appell_codegen::jit::NativeFunction;
use appell_codegen::symbolic::{Function, Relation};
use appell_codegen::tape::{Argument, Arithmetic, Tape};

use crate::jit_support::{
    Point, SIZES, Step, Tree, add_result, agrees, binary, compiled, function, interpreted, number,
    same, set, state, system, tape, value,
};

const FUNCTIONS: [Function; 13] = [
    Function::Sin,
    Function::Cos,
    Function::Asin,
    Function::Acos,
    Function::Atan,
    Function::Sinh,
    Function::Cosh,
    Function::Tanh,
    Function::Exp,
    Function::Ln,
    Function::Sqrt,
    Function::Abs,
    Function::Sign,
];

/// Arguments at which functions change branches.
const SPECIAL: [f64; 14] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    -2.5,
    1.0e-310,
    -1.0e308,
    710.0,
    1.0e22,
    std::f64::consts::FRAC_PI_2,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::NAN,
];

/// A point whose first states are these numbers.
fn with_states(a: f64, b: f64) -> Point {
    Point {
        x: [a, b, 0.25],
        ..Point::SOME
    }
}

/// One of every kind of tree, in the first two states.
fn all_trees() -> Vec<Tree> {
    let (x, y) = (state(0), state(1));
    let negative = Tree::Negate(Box::new(x.clone()));
    let mut trees = vec![x.clone(), negative.clone(), number(0, 1), number(-22, 7)];
    let operations = [
        Arithmetic::Add,
        Arithmetic::Subtract,
        Arithmetic::Multiply,
        Arithmetic::Divide,
    ];
    for operation in operations {
        trees.push(binary(operation, x.clone(), y.clone()));
        trees.push(binary(operation, negative.clone(), number(1, 3)));
    }
    trees.extend(FUNCTIONS.map(|name| function(name, x.clone())));
    trees.push(Tree::Atan2(Box::new(x.clone()), Box::new(y.clone())));
    trees.push(Tree::Power(Box::new(x.clone()), Box::new(y.clone())));
    for relation in [Relation::Less, Relation::LessOrEqual] {
        trees.push(Tree::Choice {
            relation,
            compared: Box::new([x.clone(), y.clone()]),
            branches: Box::new([number(1, 1), negative.clone()]),
        });
    }
    trees
}

#[test]
fn every_tree_agrees_with_the_interpreter_at_special_numbers() {
    let tape = tape(vec![], all_trees());
    let function = NativeFunction::compile(&tape, SIZES).unwrap();
    for a in SPECIAL {
        for b in SPECIAL {
            let point = with_states(a, b);
            let mut found = vec![1.0e300; tape.results[0].entries.len()];
            function.call(point.at(), [&mut found]);
            let expected = interpreted(&tape, &point);
            assert!(
                same(&found, &expected),
                "{found:?}\n{expected:?}\nat {point:?}"
            );
        }
    }
}

#[test]
fn all_arguments_are_read_from_their_places() {
    let arguments = [
        Argument::Time,
        Argument::State(0),
        Argument::State(2),
        Argument::Input(0),
        Argument::Input(1),
        Argument::Parameter(0),
        Argument::Parameter(1),
    ];
    let tape = tape(vec![], arguments.map(Tree::Argument).to_vec());
    let Point { t, x, u, p } = Point::SOME;
    let expected = [t, x[0], x[2], u[0], u[1], p[0], p[1]];
    assert_eq!(compiled(&tape, &Point::SOME), expected);
}

#[test]
fn products_and_sums_are_not_fused() {
    // A product that is rounded once more by its sum would leave the rounding error of the first.
    let square = || binary(Arithmetic::Multiply, state(0), state(0));
    let difference = binary(Arithmetic::Subtract, square(), value(0));
    let tape = tape(vec![set(0, square())], vec![difference]);
    assert_eq!(compiled(&tape, &with_states(0.1, 0.0)), [0.0]);
}

#[test]
fn sums_are_evaluated_from_left_to_right() {
    let sum = |a, b| binary(Arithmetic::Add, a, b);
    let (x, y, z) = (state(0), state(1), state(2));
    let left = sum(sum(x.clone(), y.clone()), z.clone());
    let right = sum(x, sum(y, z));
    let point = Point {
        x: [1.0e16, -1.0e16, 1.0],
        ..Point::SOME
    };
    assert_eq!(
        compiled(&tape(vec![], vec![left, right]), &point),
        [1.0, 0.0]
    );
}

#[test]
fn zero_has_the_sign_zero() {
    let tape = tape(vec![], vec![function(Function::Sign, state(0))]);
    for (x, sign) in [(0.0, 0.0), (-0.0, -0.0), (3.0, 1.0), (-1.0e-310, -1.0)] {
        assert!(same(&compiled(&tape, &with_states(x, 0.0)), &[sign]));
    }
}

#[test]
fn nan_takes_the_other_branch() {
    let choice = |relation| Tree::Choice {
        relation,
        compared: Box::new([state(0), number(0, 1)]),
        branches: Box::new([number(1, 1), number(2, 1)]),
    };
    let tape = tape(
        vec![],
        vec![choice(Relation::Less), choice(Relation::LessOrEqual)],
    );
    let cases = [
        (-1.0, [1.0, 1.0]),
        (0.0, [2.0, 1.0]),
        (1.0, [2.0, 2.0]),
        (f64::NAN, [2.0, 2.0]),
    ];
    for (x, expected) in cases {
        assert_eq!(compiled(&tape, &with_states(x, 0.0)), expected);
    }
}

#[test]
fn sines_and_cosines_go_to_their_values() {
    let angles = [
        state(0),
        state(1),
        binary(Arithmetic::Multiply, value(0), value(3)),
    ];
    let mut steps = Vec::new();
    for (index, angle) in (0..).zip(angles) {
        let (sin, cos) = (2 * index, 2 * index + 1);
        steps.push(Step::SinCos { sin, cos, angle });
    }
    let tape = tape(steps, (0..6).map(value).collect());
    let (sin, cos) = Point::SOME.x[0].sin_cos();
    assert_eq!(compiled(&tape, &Point::SOME)[..2], [sin, cos]);
    agrees(&tape, &Point::SOME);
}

/// A system of constants; the unknowns are the values from 0.
fn constant_system(matrix: &[i64], right: &[i64]) -> Tape {
    let numbers = |numbers: &[i64]| numbers.iter().map(|&n| number(n, 1)).collect();
    let values: Vec<u32> = (0..).take(right.len()).collect();
    let entries = values.iter().map(|&index| value(index)).collect();
    let matrix = numbers(matrix);
    let steps = vec![
        Step::Factor {
            factorisation: 0,
            matrix,
        },
        Step::Solve {
            factorisation: 0,
            values,
            right: numbers(right),
        },
    ];
    tape(steps, entries)
}

#[test]
fn systems_of_every_size_agree_with_the_interpreter() {
    for rows in (1..=14).chain([20, 33, 64]) {
        agrees(&system(rows), &Point::SOME);
    }
}

#[test]
fn systems_that_need_an_exchange_are_solved() {
    let tape = constant_system(&[0, 2, 4, 1], &[6, 11]);
    assert_eq!(compiled(&tape, &Point::SOME), [2.0, 3.0]);
}

#[test]
fn singular_systems_give_no_finite_number() {
    let tape = constant_system(&[1, 1, 1, 1], &[1, 2]);
    assert!(compiled(&tape, &Point::SOME).iter().all(|x| !x.is_finite()));
    agrees(&tape, &Point::SOME);
}

#[test]
fn several_systems_live_side_by_side() {
    let factor = |factorisation, scale| Step::Factor {
        factorisation,
        matrix: vec![number(scale, 1)],
    };
    let solve = |factorisation, unknown| Step::Solve {
        factorisation,
        values: vec![unknown],
        right: vec![number(12, 1)],
    };
    let steps = vec![
        factor(0, 2),
        factor(1, 3),
        solve(0, 0),
        solve(1, 1),
        solve(0, 2),
    ];
    let tape = tape(steps, (0..3).map(value).collect());
    assert_eq!(compiled(&tape, &Point::SOME), [6.0, 4.0, 6.0]);
}

#[test]
fn each_result_goes_to_its_own_slice() {
    let mut tape = tape(vec![], vec![state(0), number(0, 1)]);
    for entries in [vec![], vec![state(1)]] {
        add_result(&mut tape, entries);
    }
    let function = NativeFunction::compile(&tape, SIZES).unwrap();
    let (mut a, mut b, mut c) = ([9.0; 2], [9.0; 0], [9.0; 1]);
    function.call(Point::SOME.at(), [&mut a, &mut b, &mut c]);
    assert_eq!((a, c), ([Point::SOME.x[0], 0.0], [Point::SOME.x[1]]));
}
