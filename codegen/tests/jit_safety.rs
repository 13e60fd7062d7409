//! Machine code rejects unsupported tapes, is shared between threads, and is freed.
#![allow(clippy::float_cmp, reason = "agreement is bit for bit")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::thread;

use appell_codegen::jit::{JitError, MOST_OPERATIONS, NativeFunction, Sizes};
use appell_codegen::symbolic::Rational;
use appell_codegen::tape::{Arithmetic, Operation, ResultArray, Tape, Value};
use appell_runtime::model::At;

use crate::jit_support::{
    Point, SIZES, Step, Tree, agrees, binary, interpreted, number, same, set, state, system, tape,
    value,
};

#[test]
fn slices_of_wrong_length_are_refused() {
    let tape = tape(vec![], vec![state(2), number(0, 1)]);
    let function = NativeFunction::compile(&tape, SIZES).unwrap();
    let Point { t, x, u, p } = Point::SOME;
    let refused = |at: At<'_>, len: usize| {
        let mut result = vec![9.0; len];
        let outcome = catch_unwind(AssertUnwindSafe(|| function.call(at, [&mut result])));
        assert_eq!(result, vec![9.0; len], "nothing is written");
        outcome.is_err()
    };
    let at = At {
        t,
        x: &x,
        u: &u,
        p: &p,
    };
    assert!(refused(At { x: &x[..2], ..at }, 2));
    assert!(refused(At { u: &[], ..at }, 2));
    assert!(refused(At { p: &[1.0; 3], ..at }, 2));
    assert!(refused(at, 1));
    assert!(refused(at, 3));
    let call = AssertUnwindSafe(|| function.call(at, []));
    assert!(catch_unwind(call).is_err());
    let call = AssertUnwindSafe(|| function.call(at, [&mut [0.0; 2], &mut []]));
    assert!(catch_unwind(call).is_err());
    let mut result = [9.0; 2];
    function.call(at, [&mut result]);
    assert_eq!(result, [x[2], 0.0]);
}

#[test]
fn threads_share_one_function() {
    let tape = system(3);
    let function = NativeFunction::compile(&tape, SIZES).unwrap();
    thread::scope(|scope| {
        for worker in 0..4_i32 {
            let (function, tape) = (&function, &tape);
            scope.spawn(move || {
                for k in 0..500_i32 {
                    let x = [f64::from(worker) + 0.1, f64::from(k) * 0.01, 0.25];
                    let point = Point { x, ..Point::SOME };
                    let mut found = [0.0; 6];
                    function.call(point.at(), [&mut found]);
                    assert!(same(&found, &interpreted(tape, &point)));
                }
            });
        }
    });
}

#[test]
fn code_moves_between_threads_and_is_freed_there() {
    for _ in 0..50 {
        let function = NativeFunction::compile(&system(2), SIZES).unwrap();
        let moved = thread::spawn(move || {
            let mut found = [0.0; 4];
            function.call(Point::SOME.at(), [&mut found]);
            (function, found)
        });
        let (function, first) = moved.join().unwrap();
        let mut second = [0.0; 4];
        function.call(Point::SOME.at(), [&mut second]);
        assert_eq!(first, second);
        thread::spawn(move || drop(function)).join().unwrap();
    }
}

#[cfg(target_os = "linux")]
#[test]
fn dropped_functions_leave_no_code_behind() {
    const FUNCTIONS: usize = 200;
    const PAGE: usize = 4096;
    let tape = system(2);
    let before = executable_bytes();
    for _ in 0..FUNCTIONS {
        drop(NativeFunction::compile(&tape, SIZES).unwrap());
    }
    // Each needs at least one page. Tests that run concurrently own a few.
    assert!(executable_bytes() < before + FUNCTIONS / 2 * PAGE);
}

/// Size of all executable mappings of this process that belong to no file.
#[cfg(target_os = "linux")]
fn executable_bytes() -> usize {
    let maps = std::fs::read_to_string("/proc/self/maps").unwrap();
    let address = |text: &str| usize::from_str_radix(text, 16).unwrap();
    let sizes = maps.lines().filter_map(|line| {
        let fields: Vec<_> = line.split_whitespace().collect();
        let (start, end) = fields[0].split_once('-')?;
        (fields[1] == "r-xp" && fields.len() == 5).then(|| address(end) - address(start))
    });
    sizes.sum()
}

fn refusal(steps: Vec<Step>, entries: Vec<Tree>) -> JitError {
    NativeFunction::compile(&tape(steps, entries), SIZES).unwrap_err()
}

/// A tape of these operations whose result is the last of them.
fn refused(operations: Vec<Operation>) -> JitError {
    let mut tape = Tape::default();
    for operation in operations {
        tape.push_alone(operation);
    }
    let last = Value(u32::try_from(tape.operations.len() - 1).unwrap());
    tape.results.push(ResultArray {
        name: "result".to_owned(),
        entries: vec![last],
    });
    NativeFunction::compile(&tape, SIZES).unwrap_err()
}

#[test]
fn undefined_values_are_refused() {
    let undefined = refusal(vec![], vec![value(0)]);
    assert!(matches!(undefined, JitError::UndefinedValue { .. }));
    let itself = refused(vec![Operation::Negate(Value(0))]);
    assert!(matches!(itself, JitError::UndefinedValue { value: 0 }));
    let later = refused(vec![
        Operation::Negate(Value(1)),
        Operation::Constant(Rational::ONE),
    ]);
    assert!(matches!(later, JitError::UndefinedValue { value: 1 }));
}

#[test]
fn parts_that_do_not_follow_their_operation_are_refused() {
    let angle = Operation::Constant(Rational::ONE);
    let pair = Operation::SinCos(Value(0));
    let part = |index| Operation::Part(Value(1), index);
    let tapes = [
        // Without parts.
        vec![angle.clone(), pair.clone()],
        vec![angle.clone(), pair.clone(), part(0), angle.clone()],
        // The cosine without the sine before it.
        vec![angle.clone(), pair.clone(), part(1)],
        vec![angle.clone(), pair.clone(), pair.clone(), part(1)],
        // More parts than there are.
        vec![angle.clone(), pair.clone(), part(0), part(1), part(2)],
        // A part of a number.
        vec![angle, Operation::Part(Value(0), 0)],
        vec![part(u32::MAX)],
    ];
    for operations in tapes {
        let error = refused(operations.clone());
        assert!(
            matches!(error, JitError::MisplacedPart { .. }),
            "{operations:?}"
        );
    }
}

#[test]
fn arguments_beyond_the_model_are_refused() {
    let refused = refusal(vec![], vec![state(3)]);
    assert!(matches!(
        refused,
        JitError::UnknownArgument {
            what: "state",
            index: 3,
            len: 3
        }
    ));
}

#[test]
fn systems_without_sense_are_refused() {
    let factor = |entries: usize| Step::Factor {
        factorisation: 0,
        matrix: vec![number(1, 1); entries],
    };
    let solve = |entries: usize| Step::Solve {
        factorisation: 0,
        values: Vec::new(),
        right: vec![number(1, 1); entries],
    };
    let early = refusal(vec![solve(1), factor(1)], vec![]);
    assert!(matches!(early, JitError::NotAFactorisation { .. }));
    for steps in [vec![factor(0)], vec![factor(3)], vec![factor(4), solve(1)]] {
        assert!(matches!(
            refusal(steps, vec![]),
            JitError::SystemShape { .. }
        ));
    }
    let large = refusal(vec![factor(65 * 65)], vec![]);
    assert!(matches!(
        large,
        JitError::TooManyRows { rows: 65, most: 64 }
    ));
}

#[test]
fn deep_expressions_are_compiled() {
    let nested = |depth| (0..depth).fold(state(0), |tree, _| Tree::Negate(Box::new(tree)));
    agrees(&tape(vec![], vec![nested(2000)]), &Point::SOME);
}

#[test]
fn an_empty_function_does_nothing() {
    let none = Sizes {
        states: 0,
        inputs: 0,
        parameters: 0,
    };
    let function = NativeFunction::compile(&tape(vec![], vec![]), none).unwrap();
    function.call(
        At {
            t: 0.0,
            x: &[],
            u: &[],
            p: &[],
        },
        [&mut []],
    );
}

/// A chain of operations with many live values.
fn chain(operations: u32) -> Tape {
    let step = |k: u32| {
        let other = if k < 9 { state(k % 3) } else { value(k / 2) };
        let last = if k == 0 { state(0) } else { value(k - 1) };
        let operation = if k.is_multiple_of(3) {
            Arithmetic::Multiply
        } else {
            Arithmetic::Subtract
        };
        set(k, binary(operation, last, other))
    };
    let entries = (0..operations / 9)
        .map(|k| value(operations - 1 - 5 * k))
        .collect();
    tape((0..operations).map(step).collect(), entries)
}

#[test]
fn long_functions_run_on_the_stack_of_a_thread() {
    let tape = chain(8_000);
    let run = move || agrees(&tape, &Point::SOME);
    thread::Builder::new()
        .stack_size(2 << 20)
        .spawn(run)
        .unwrap()
        .join()
        .unwrap();
}

#[test]
fn longer_functions_are_refused() {
    let most = u32::try_from(MOST_OPERATIONS).unwrap();
    let refused = NativeFunction::compile(&chain(most), SIZES).unwrap_err();
    assert!(matches!(
        refused,
        JitError::TooManyOperations {
            most: MOST_OPERATIONS,
            ..
        }
    ));
}
