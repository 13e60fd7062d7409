//! Machine code rejects unsupported schedules, is shared between threads, and is freed.
#![allow(clippy::float_cmp, reason = "agreement is bit for bit")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::thread;

use appell_codegen::jit::{JitError, MOST_DEPTH, MOST_OPERATIONS, NativeFunction, Sizes};
use appell_codegen::schedule::{Operation, Schedule, Step, Tree, Value};
use appell_runtime::model::At;

use crate::jit_support::{
    Point, SIZES, agrees, binary, interpreted, number, same, schedule, set, state, system, value,
};

#[test]
fn slices_of_wrong_length_are_refused() {
    let schedule = schedule(vec![], vec![state(2), number(0, 1)]);
    let function = NativeFunction::compile(&schedule, SIZES).unwrap();
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
    let schedule = system(3);
    let function = NativeFunction::compile(&schedule, SIZES).unwrap();
    thread::scope(|scope| {
        for worker in 0..4_i32 {
            let (function, schedule) = (&function, &schedule);
            scope.spawn(move || {
                for k in 0..500_i32 {
                    let x = [f64::from(worker) + 0.1, f64::from(k) * 0.01, 0.25];
                    let point = Point { x, ..Point::SOME };
                    let mut found = [0.0; 6];
                    function.call(point.at(), [&mut found]);
                    assert!(same(&found, &interpreted(schedule, &point)));
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
    let schedule = system(2);
    let before = executable_bytes();
    for _ in 0..FUNCTIONS {
        drop(NativeFunction::compile(&schedule, SIZES).unwrap());
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
    NativeFunction::compile(&schedule(steps, entries), SIZES).unwrap_err()
}

#[test]
fn undefined_values_are_refused() {
    let undefined = refusal(vec![], vec![value(0)]);
    assert!(matches!(undefined, JitError::UndefinedValue { value: 0 }));
    let unnamed = refusal(vec![set(u32::MAX, number(1, 1))], vec![]);
    assert!(matches!(
        unnamed,
        JitError::UndefinedValue { value: u32::MAX }
    ));
    let itself = refusal(vec![set(0, value(0))], vec![]);
    assert!(matches!(itself, JitError::UndefinedValue { value: 0 }));
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
    let factor = |size: usize, entries: usize| Step::Factor {
        factorisation: 0,
        size,
        matrix: vec![number(1, 1); entries],
    };
    let solve = |unknowns: u32, entries: usize| Step::Solve {
        factorisation: 0,
        values: (0..unknowns).map(Value).collect(),
        right: vec![number(1, 1); entries],
    };
    let early = refusal(vec![solve(1, 1), factor(1, 1)], vec![]);
    assert!(matches!(
        early,
        JitError::UndefinedFactorisation { factorisation: 0 }
    ));
    let misfits = [
        vec![factor(2, 3)],
        vec![factor(2, 4), solve(2, 1)],
        vec![factor(2, 4), solve(3, 2)],
    ];
    for steps in misfits {
        assert!(matches!(
            refusal(steps, vec![]),
            JitError::SystemShape { .. }
        ));
    }
    let large = refusal(vec![factor(65, 65 * 65)], vec![]);
    assert!(matches!(
        large,
        JitError::TooManyRows { rows: 65, most: 64 }
    ));
}

#[test]
fn deep_trees_are_refused() {
    let nested = |depth| (0..depth).fold(state(0), |tree, _| Tree::Negate(Box::new(tree)));
    assert!(matches!(
        refusal(vec![], vec![nested(MOST_DEPTH + 1)]),
        JitError::TooDeep { .. }
    ));
    agrees(&schedule(vec![], vec![nested(MOST_DEPTH)]), &Point::SOME);
}

#[test]
fn an_empty_function_does_nothing() {
    let none = Sizes {
        states: 0,
        inputs: 0,
        parameters: 0,
    };
    let function = NativeFunction::compile(&schedule(vec![], vec![]), none).unwrap();
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
fn chain(operations: u32) -> Schedule {
    let step = |k: u32| {
        let other = if k < 9 { state(k % 3) } else { value(k / 2) };
        let last = if k == 0 { state(0) } else { value(k - 1) };
        let operation = if k.is_multiple_of(3) {
            Operation::Multiply
        } else {
            Operation::Subtract
        };
        set(k, binary(operation, last, other))
    };
    let entries = (0..operations / 9)
        .map(|k| value(operations - 1 - 5 * k))
        .collect();
    schedule((0..operations).map(step).collect(), entries)
}

#[test]
fn long_functions_run_on_the_stack_of_a_thread() {
    let schedule = chain(8_000);
    let run = move || agrees(&schedule, &Point::SOME);
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
