//! Schedules compute what was derived, with few operations, under names that people can read.

#![allow(clippy::unwrap_used, reason = "tests may panic")]

mod emit_support;

use std::collections::BTreeSet;

use appell_codegen::program::{Function, FunctionKind, Layout, Program};
use appell_codegen::schedule::{
    OperationCount, Schedule, Step, Tuning, interpret, schedule, schedule_tuned,
};
use appell_codegen::symbolic::{Expr, Graph, evaluate};
use emit_support::{Numbers, Sketch, mixture, polynomial, quantity, unicycle};

fn of(program: &Program, kind: FunctionKind) -> Schedule {
    let function = program
        .functions
        .iter()
        .find(|function| function.kind == kind)
        .unwrap();
    schedule(program, function)
}

/// Largest difference between a schedule and its expressions, relative to the largest entry.
fn error(program: &Program, function: &Function, numbers: &mut Numbers) -> f64 {
    let schedule = schedule(program, function);
    let at = &program.arguments;
    let x = numbers.list(at.states.len());
    let u = numbers.list(at.inputs.len());
    let p = numbers.list(at.parameters.len());
    let t = numbers.next();
    let mut values = vec![f64::NAN; program.graph.symbol_count()];
    let lists = [(&at.states, &x), (&at.inputs, &u), (&at.parameters, &p)];
    for (symbols, list) in lists {
        for (symbol, value) in symbols.iter().zip(list) {
            values[symbol.0 as usize] = *value;
        }
    }
    values[at.time.0 as usize] = t;
    let roots: Vec<Expr> = function
        .results
        .iter()
        .flat_map(|array| array.entries.clone())
        .collect();
    let expected = evaluate(&program.graph, &values, &roots);
    let found = interpret(&schedule, t, &x, &u, &p).concat();
    assert_eq!(expected.len(), found.len());
    let scale = expected
        .iter()
        .fold(1.0_f64, |scale, value| scale.max(value.abs()));
    let pairs = expected.iter().zip(&found);
    pairs
        .map(|(expected, found)| (expected - found).abs() / scale)
        .fold(0.0, f64::max)
}

#[test]
fn a_schedule_computes_the_expressions() {
    // The order of operations differs; some digits cancel.
    const ROUNDING: f64 = 1e-11;
    for program in [unicycle(), mixture()] {
        let mut numbers = Numbers(1);
        for function in &program.functions {
            for _ in 0..10 {
                let error = error(&program, function, &mut numbers);
                assert!(error < ROUNDING, "{:?}: {error}", function.kind);
            }
        }
    }
}

#[test]
fn the_unicycle_obeys_the_published_equations() {
    const ROUNDING: f64 = 1e-12;
    let program = unicycle();
    let rates = of(&program, FunctionKind::Rates);
    let x = [0.3, 2.0, -0.4, 0.2, 0.15, 0.07, 0.6, 1.0, 2.0, 3.0];
    let [m, m0, radius, g] = [10.0, 5.0, 0.3, 9.81];
    let u = 1.7;
    let found = &interpret(&rates, 0.0, &x, &[u], &[m, m0, radius, g])[0];
    let [w1, w2, w3, s, theta, r, ..] = x;
    let (sin, cos, tan) = (theta.sin(), theta.cos(), theta.tan());
    let d1 = 5.0 * m * radius * radius + 4.0 * m0 * r * r;
    let w1_dot = (4.0 * m0 * radius * r * w1 * w1
        - (m * radius * radius + 4.0 * m0 * r * r) * tan * w3 * w3
        - 8.0 * m0 * r * w1 * s
        + 2.0 * radius * (3.0 * m * radius + 2.0 * m0 * r * tan) * w2 * w3
        - 4.0 * m0 * g * r * cos
        + 4.0 * m * g * radius * sin
        + 4.0 * radius * u)
        / d1;
    let s_dot = radius * w1_dot + r * w1 * w1 - radius * w2 * w3 + r * w3 * w3 - g * sin + u / m0;
    assert!((found[0] - w1_dot).abs() < ROUNDING);
    assert!((found[3] - s_dot).abs() < ROUNDING);
}

/// Counts may fall, and are then lowered here; they must not rise.
#[test]
fn operation_counts_do_not_rise() {
    let program = unicycle();
    let most = [
        (FunctionKind::Kinematics, 12),
        (FunctionKind::MassMatrix, 18),
        (FunctionKind::Bias, 49),
        (FunctionKind::GeneralizedForces, 10),
        (FunctionKind::Rates, 94),
        (FunctionKind::Jacobians, 278),
        (FunctionKind::AllJacobians, 454),
    ];
    for (kind, most) in most {
        let count = OperationCount::of(&of(&program, kind));
        assert!(count.total() <= most, "{kind:?}: {count}, at most {most}");
        assert!(count.divide <= 4, "{kind:?}: {count}");
        assert!(count.sin_cos <= 2, "{kind:?}: {count}");
    }
}

/// The schedule of one array of expressions in two states, two parameters.
fn small(build: impl FnOnce(&mut Sketch, [Expr; 4]) -> Vec<Expr>) -> (Program, Schedule) {
    let names = |names: [&str; 2]| {
        names
            .map(|name| quantity(name, "A number.", "", 0.0))
            .to_vec()
    };
    let mut sketch = Sketch::new("small", 0, names(["x", "y"]), vec![], names(["m", "R"]));
    let symbols = ["x", "y", "m", "R"].map(|name| sketch.symbol(name));
    let entries = build(&mut sketch, symbols);
    let layout = Layout::Vector(entries.len());
    sketch.function(
        FunctionKind::ConstraintResidual,
        vec![("residual", layout, entries)],
    );
    let schedule = schedule(&sketch.program, &sketch.program.functions[0]);
    (sketch.program, schedule)
}

#[test]
fn common_factors_leave_a_sum() {
    let (_, schedule) = small(|sketch, [x, y, m, radius]| {
        let g = sketch.graph();
        vec![polynomial(
            g,
            &[(1, 1, &[m, radius, x]), (1, 1, &[m, radius, y])],
        )]
    });
    assert_eq!(OperationCount::of(&schedule).total(), 3);
}

#[test]
fn common_terms_are_added_once_whatever_their_sign() {
    let (_, schedule) = small(|sketch, [x, y, m, radius]| {
        let g = sketch.graph();
        let difference = polynomial(g, &[(1, 1, &[x]), (-1, 1, &[y]), (1, 1, &[m])]);
        let opposite = polynomial(g, &[(1, 1, &[y]), (-1, 1, &[x]), (1, 1, &[radius])]);
        vec![difference, opposite]
    });
    assert_eq!(OperationCount::of(&schedule).total(), 3);
}

#[test]
fn one_denominator_is_one_division() {
    let (_, schedule) = small(|sketch, [x, y, m, radius]| {
        let g = sketch.graph();
        let denominator = g.add(m, radius);
        [x, y, radius]
            .map(|numerator| g.div(numerator, denominator))
            .to_vec()
    });
    let count = OperationCount::of(&schedule);
    assert_eq!((count.add, count.multiply, count.divide), (1, 3, 1));
}

#[test]
fn denominators_cancel() {
    let (_, schedule) = small(|sketch, [x, y, m, radius]| {
        let g = sketch.graph();
        let denominator = g.add(m, radius);
        let denominator = g.name("D", denominator);
        let whole = g.mul(x, denominator);
        let sum = g.add(whole, y);
        vec![g.div(sum, denominator)]
    });
    let count = OperationCount::of(&schedule);
    assert_eq!((count.add, count.multiply, count.divide), (2, 0, 1));
}

#[test]
fn independent_denominators_share_a_division_where_divisions_are_dear() {
    let program = unicycle();
    let rates = program
        .functions
        .iter()
        .find(|f| f.kind == FunctionKind::Rates)
        .unwrap();
    let tuning = Tuning {
        division: 10,
        ..Tuning::default()
    };
    let joint = schedule_tuned(&program, rates, tuning);
    assert_eq!(OperationCount::of(&joint).divide, 2);
    let separate = schedule(&program, rates);
    let mut numbers = Numbers(5);
    let (x, u, p) = (numbers.list(10), numbers.list(1), numbers.list(4));
    let [joint, separate] = [joint, separate].map(|s| interpret(&s, 0.0, &x, &u, &p).concat());
    for (joint, separate) in joint.iter().zip(&separate) {
        assert!((joint - separate).abs() < 1e-12 * (1.0 + separate.abs()));
    }
}

#[test]
fn a_lone_sine_brings_no_cosine() {
    let (_, schedule) = small(|sketch, [x, ..]| vec![sketch.graph().sin(x)]);
    assert!(
        !schedule
            .steps
            .iter()
            .any(|step| matches!(step, Step::SinCos { .. }))
    );
    let (_, schedule) = small(|sketch, [x, ..]| {
        let g = sketch.graph();
        vec![g.sin(x), g.cos(x)]
    });
    assert!(
        schedule
            .steps
            .iter()
            .any(|step| matches!(step, Step::SinCos { .. }))
    );
}

#[test]
fn large_powers_are_squares_of_squares() {
    let (_, schedule) = small(|sketch, [x, ..]| vec![sketch.graph().pow(x, 1_000_000)]);
    assert!(OperationCount::of(&schedule).total() <= 40);
}

#[test]
fn a_difference_is_written_the_way_it_is_wanted() {
    let (_, schedule) = small(|sketch, [x, y, m, _]| {
        let g = sketch.graph();
        let difference = g.sub(x, y);
        let product = g.mul(m, difference);
        vec![g.neg(product)]
    });
    assert_eq!(OperationCount::of(&schedule).negate, 0);
}

#[test]
fn two_runs_give_the_same_schedule() {
    for program in [unicycle(), mixture()] {
        for function in &program.functions {
            let [first, second] = [(), ()].map(|()| schedule(&program, function).dump(&program));
            assert_eq!(first, second);
        }
    }
}

#[test]
fn names_are_unique_identifiers() {
    for program in [unicycle(), mixture()] {
        for function in &program.functions {
            let schedule = schedule(&program, function);
            let names: BTreeSet<&String> = schedule.names.iter().collect();
            assert_eq!(names.len(), schedule.names.len());
            for name in names {
                let first = name.chars().next().unwrap();
                assert!(first.is_ascii_alphabetic() || first == '_', "{name}");
                assert!(
                    name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_'),
                    "{name}"
                );
            }
        }
    }
}

#[test]
fn a_deep_expression_does_not_overflow_the_stack() {
    let (_, schedule) = small(|sketch, [x, ..]| {
        let g = sketch.graph();
        let mut deep = x;
        for _ in 0..20_000 {
            let sine = g.sin(deep);
            deep = g.add(sine, Graph::ONE);
        }
        vec![deep]
    });
    assert_eq!(OperationCount::of(&schedule).add, 20_000);
}
