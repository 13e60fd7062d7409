//! Schedules reproduce the derivation with few operations and readable names.

#![allow(clippy::unwrap_used, reason = "tests may panic")]
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "random numbers are small"
)]

use std::collections::BTreeSet;

use appell_codegen::program::{Function, FunctionKind, Layout, Program};
use appell_codegen::schedule::schedule;
use appell_codegen::symbolic::{Expr, Graph, Rational, Relation, evaluate};
use appell_codegen::tape::{Operation, OperationCount, Tape, interpret};

use crate::emit_support::{Numbers, Sketch, mixture, polynomial, quantity, unicycle};

fn of(program: &Program, kind: FunctionKind) -> Tape {
    let function = program
        .functions
        .iter()
        .find(|function| function.kind == kind)
        .unwrap();
    schedule(program, function)
}

/// Largest difference between an entry of a schedule and its expression, relative to what
/// rounding explains.
fn error(program: &Program, function: &Function, numbers: &mut Numbers) -> f64 {
    let schedule = schedule(program, function);
    let at = &program.arguments;
    let x = numbers.list(at.states.len());
    let u = numbers.list(at.inputs.len());
    let p = numbers.list(at.parameters.len());
    let t = numbers.next();
    let mut values = vec![f64::NAN; function.graph.symbol_count()];
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
    let expected = evaluate(&function.graph, &values, &roots);
    let found = interpret(&schedule, t, &x, &u, &p).concat();
    assert_eq!(expected.len(), found.len());
    // Where large terms cancel, digits are lost in any order of operations. Arguments that are
    // changed in their last digits show how many.
    for (place, value) in values.iter_mut().enumerate() {
        *value *= 1.0 + 1e-12 * (place % 3) as f64;
    }
    let moved = evaluate(&function.graph, &values, &roots);
    let all = expected.iter().zip(&found).zip(&moved);
    all.map(|((expected, found), moved)| {
        let lost = 1e10 * (moved - expected).abs();
        (expected - found).abs() / (1.0 + expected.abs() + lost)
    })
    .fold(0.0, f64::max)
}

#[test]
fn a_schedule_computes_the_expressions() {
    // The order of operations differs; some digits cancel.
    const ROUNDING: f64 = 1e-11;
    for program in [unicycle(), mixture()] {
        let mut numbers = Numbers::new(1);
        for function in &program.functions {
            for _ in 0..10 {
                let error = error(&program, function, &mut numbers);
                assert!(error < ROUNDING, "{:?}: {error}", function.kind);
            }
        }
    }
}

/// A program of random sums, products, quotients, functions, names, choices and linear systems.
fn random_program(numbers: &mut Numbers) -> Program {
    let mut pick = |count: usize| (numbers.next() * 1e6) as usize % count;
    let list = |names: &[&str]| {
        names
            .iter()
            .map(|name| quantity(name, "", "", 0.0))
            .collect()
    };
    let mut sketch = Sketch::new(
        "random",
        0,
        list(&["x", "y", "z"]),
        list(&["u"]),
        list(&["m", "R"]),
    );
    let mut known: Vec<Expr> = ["x", "y", "z", "u", "m", "R"]
        .map(|name| sketch.symbol(name))
        .to_vec();
    let mut kept = Vec::new();
    let g = sketch.graph();
    for step in 0..40 {
        // Recent nodes are taken more often: the graph gets deep.
        let mut part = || known[known.len() - 1 - pick(known.len().min(12))];
        let [a, b, c, d] = [part(), part(), part(), part()];
        let fraction = |n: usize| Rational::new(n as i64 % 7 - 3, 1 + n as i64 % 4);
        let coefficients = [pick(100), pick(100), pick(100)].map(fraction);
        let one_and_square = |g: &mut Graph, a: Expr| {
            let square = g.square(a);
            g.add(Graph::ONE, square)
        };
        let new = match pick(12) {
            0..=3 => {
                let [i, j, k] = coefficients;
                let product = g.mul(c, d);
                g.linear_combination(&[(i, a), (j, b), (k, product)])
            }
            4..=6 => g.product(&[a, b, c]),
            7 => {
                let denominator = one_and_square(g, b);
                g.div(a, denominator)
            }
            8 => {
                let sine = g.sin(a);
                let cosine = g.cos(a);
                g.linear_combination(&[(Rational::ONE, sine), (coefficients[0].clone(), cosine)])
            }
            9 => {
                let value = g.name(&format!("value_{step}"), a);
                // Half of the named values are displayed stages.
                if pick(2) == 0 {
                    kept.push(value);
                }
                value
            }
            10 => {
                // Against a number nothing ties, however sums are ordered.
                let limit = g.fraction(pick(1000) as i64, 997);
                g.choice(Relation::Less, [a, limit], [c, d])
            }
            _ => {
                let [p, q] = [one_and_square(g, a), one_and_square(g, b)];
                let half = g.fraction(1, 2);
                g.solve_numerically(vec![p, half, half, q], vec![c, d])[0]
            }
        };
        known.push(new);
    }
    let entries: Vec<Expr> = known[known.len() - 10..].to_vec();
    sketch.function(
        FunctionKind::ConstraintResidual,
        vec![("residual", Layout::List(10), entries)],
    );
    let function = sketch.program.functions.remove(0);
    sketch
        .program
        .functions
        .push(function.by_way_of("Wanted.", kept));
    sketch.program
}

#[test]
fn random_programs_keep_their_values() {
    const ROUNDING: f64 = 1e-8;
    let mut numbers = Numbers::new(2024);
    for number in 0..500 {
        let program = random_program(&mut numbers);
        let error = error(&program, &program.functions[0], &mut numbers);
        assert!(
            error < ROUNDING || error.is_nan(),
            "program {number}: {error}"
        );
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
        (FunctionKind::Rates, 101),
        (FunctionKind::Jacobians, 288),
        (FunctionKind::ParameterJacobian, 263),
    ];
    for (kind, most) in most {
        let count = OperationCount::of(&of(&program, kind));
        assert!(count.total() <= most, "{kind:?}: {count}, at most {most}");
        assert!(count.divide <= 4, "{kind:?}: {count}");
        assert!(count.sin_cos <= 2, "{kind:?}: {count}");
    }
}

/// The schedule of one array of expressions in two states, two parameters.
fn small(build: impl FnOnce(&mut Sketch, [Expr; 4]) -> Vec<Expr>) -> (Program, Tape) {
    let names = |names: [&str; 2]| {
        names
            .map(|name| quantity(name, "A number.", "", 0.0))
            .to_vec()
    };
    let mut sketch = Sketch::new("small", 0, names(["x", "y"]), vec![], names(["m", "R"]));
    let symbols = ["x", "y", "m", "R"].map(|name| sketch.symbol(name));
    let entries = build(&mut sketch, symbols);
    let layout = Layout::List(entries.len());
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
fn a_lone_sine_brings_no_cosine() {
    let (_, schedule) = small(|sketch, [x, ..]| vec![sketch.graph().sin(x)]);
    assert!(
        !schedule
            .operations
            .iter()
            .any(|operation| matches!(operation, Operation::SinCos(_)))
    );
    let (_, schedule) = small(|sketch, [x, ..]| {
        let g = sketch.graph();
        vec![g.sin(x), g.cos(x)]
    });
    assert!(
        schedule
            .operations
            .iter()
            .any(|operation| matches!(operation, Operation::SinCos(_)))
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
            let [first, second] = [(), ()].map(|()| format!("{:?}", schedule(&program, function)));
            assert_eq!(first, second);
        }
    }
}

#[test]
fn names_are_unique_identifiers() {
    for program in [unicycle(), mixture()] {
        for function in &program.functions {
            let schedule = schedule(&program, function);
            let names: BTreeSet<&String> = schedule.names.iter().flatten().collect();
            assert_eq!(names.len(), schedule.names.iter().flatten().count());
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
