//! Expressions mean what a mathematician reads.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

use appell_spec::expr::{BinaryOp, Expr, ExprKind, Function, Quantity, Relation};
use appell_spec::load;
use num_traits::ToPrimitive;

const X: f64 = 0.75;
const THETA: f64 = -0.4;

fn spec(output: &str) -> String {
    format!(
        r#"
[mechanism]
name = "probe"
title = "probe"
[parameters]
L = {{ value = 30, unit = "cm" }}
[coordinates]
x = {{ unit = "m" }}
theta = {{ unit = "deg" }}
[frames]
a = {{ parent = "ground", about_axis = "x", by = "theta" }}
[points]
C = {{ from = "O", in = "a", at = ["x", "L", 0] }}
[bodies]
b = {{ centre = "C", mass = "2 [kg]" }}
[outputs]
out = {{ value = {output} }}
"#
    )
}

fn evaluate(expr: &Expr) -> f64 {
    match &expr.kind {
        ExprKind::Number(value) => value.to_f64().unwrap(),
        ExprKind::Quantity(Quantity::Coordinate(q)) if q.index() == 0 => X,
        ExprKind::Quantity(Quantity::Coordinate(_)) => THETA,
        ExprKind::Quantity(Quantity::Parameter(_)) => 0.3,
        ExprKind::Quantity(Quantity::Pi) => std::f64::consts::PI,
        ExprKind::Quantity(other) => panic!("{other:?}"),
        ExprKind::Negate(a) => -evaluate(a),
        ExprKind::Binary(op, a, b) => {
            let (a, b) = (evaluate(a), evaluate(b));
            match op {
                BinaryOp::Add => a + b,
                BinaryOp::Subtract => a - b,
                BinaryOp::Multiply => a * b,
                BinaryOp::Divide => a / b,
                BinaryOp::Power => a.powf(b),
            }
        }
        ExprKind::Call(Function::Sin, a) => evaluate(&a[0]).sin(),
        ExprKind::Call(Function::Atan2, a) => evaluate(&a[0]).atan2(evaluate(&a[1])),
        ExprKind::Call(function, _) => panic!("{function:?}"),
        ExprKind::Choice {
            relation,
            compared,
            branches,
        } => {
            let [a, b] = compared.each_ref().map(evaluate);
            let holds = match relation {
                Relation::Less => a < b,
                Relation::LessOrEqual => a <= b,
                Relation::Greater => a > b,
                Relation::GreaterOrEqual => a >= b,
            };
            evaluate(&branches[usize::from(!holds)])
        }
    }
}

fn value(output: &str) -> f64 {
    let text = spec(&format!("\"{output}\""));
    let checked = load("probe.toml", &text).unwrap_or_else(|report| panic!("{report}"));
    evaluate(&checked.mechanism.outputs.first().unwrap().value)
}

#[test]
fn operators_bind_as_in_mathematics() {
    for (text, expected) in [
        ("1 - 2 - 3", -4.0),
        ("8/2/2", 2.0),
        ("2 + 3*4", 14.0),
        ("-2^2", -4.0),
        ("(-2)^2", 4.0),
        ("2^3^2", 512.0),
        ("2^-1*3", 1.5),
        ("2*-3 + 1", -5.0),
        ("-3*2 - -1", -5.0),
        ("6/-(1 + 2)", -2.0),
        ("--2", 2.0),
        ("1.5e1 + .5", 15.5),
        ("if(1 < 2, 3, 4)", 3.0),
        ("if(2 <= 1, 3, 4)", 4.0),
        ("if(x > L, if(x >= 1 [m], 1, 2), 3)", 2.0),
        ("sin(pi/2)", 1.0),
        ("atan2(x, x)*4/pi", 1.0),
        ("(x^2)^(1/2)/x", 1.0),
    ] {
        assert!(
            (value(text) - expected).abs() < 1e-15,
            "{text} = {}",
            value(text)
        );
    }
}

#[test]
fn numbers_with_units_are_in_si() {
    for (text, expected) in [
        ("x + 20 [cm]", X + 0.2),
        ("theta + 180 [deg]", THETA + std::f64::consts::PI),
        ("30 [rpm]/(1 [1/s])", std::f64::consts::PI),
        ("36 [km/h]/(1 [m/s])", 10.0),
    ] {
        assert!((value(text) - expected).abs() < 1e-12, "{text}");
    }
}

#[test]
fn numbers_stay_exact() {
    let checked = load("probe.toml", &spec("\"0.1 [mm]\"")).unwrap();
    let ExprKind::Number(number) = &checked.mechanism.outputs.first().unwrap().value.kind else {
        panic!("not a number");
    };
    assert_eq!(number.to_string(), "1/10000");
}

#[test]
fn places_point_into_strings_of_every_kind() {
    for quoted in [
        "\"x + theat\"",
        "'x + theat'",
        "\"\"\"x + theat\"\"\"",
        "\"\"\"\nx + theat\"\"\"",
        "'''\nx + theat'''",
    ] {
        let text = spec(quoted);
        let report = load("probe.toml", &text).unwrap_err();
        let (place, _) = &report.diagnostics()[0].labels[0];
        assert_eq!(&text[place.clone()], "theat", "{quoted}");
    }
    // With an escape the file does not hold the expression as it is: the string is the place.
    let text = spec("\"x + \\u0074heat\"");
    let report = load("probe.toml", &text).unwrap_err();
    let (place, _) = &report.diagnostics()[0].labels[0];
    assert_eq!(&text[place.clone()], "\"x + \\u0074heat\"");
}

#[test]
fn a_literal_zero_fits_every_unit() {
    for text in ["x + 0", "0 - theta", "x*0 + theta", "if(x < 0, x, 0)"] {
        let text = spec(&format!("\"{text}\""));
        assert!(load("probe.toml", &text).is_ok(), "{text}");
    }
}

/// What is told of an output; empty where it is accepted.
fn finding(output: &str) -> String {
    match load("probe.toml", &spec(output)) {
        Ok(_) => String::new(),
        Err(report) => {
            let found = report.diagnostics();
            assert_eq!(found.len(), 1, "{report}");
            let help = found[0].help.as_deref();
            format!("{}; {}", found[0].message, help.unwrap_or("-"))
        }
    }
}

#[test]
fn units_are_checked_through_every_function() {
    let number = "a pure number or an angle";
    let metres = "write the unit after the number: `[m]`";
    for (text, expected) in [
        ("hypot(0, x) + L", String::new()),
        ("sqrt(x^3)*x^0.5/x", String::new()),
        ("(x^3)^(1/3) + L", String::new()),
        ("smooth_min(x, L, 1 [mm]) + max(x, 0)", String::new()),
        ("sign(x)*L + abs(x)", String::new()),
        ("ln(x/L) + theta", String::new()),
        (
            "x + 1",
            format!("cannot add a length and {number}; {metres}"),
        ),
        (
            "if(x < 1, x, L)",
            format!("cannot compare a length and {number}; {metres}"),
        ),
        (
            "if(x < L, x, theta)",
            format!("cannot choose between a length and {number}; -"),
        ),
        (
            "hypot(x, theta)",
            format!("cannot combine a length and {number}; -"),
        ),
        (
            "atan2(x, theta)",
            format!("cannot compare a length and {number}; -"),
        ),
        (
            "smooth_max(x, L, 1)",
            format!("cannot combine a length and {number}; {metres}"),
        ),
        (
            "smooth_sign(x, 0.1)",
            format!("cannot compare a length and {number}; {metres}"),
        ),
        ("exp(x)", format!("`exp` takes {number}, found a length; -")),
        (
            "2^x",
            format!("an exponent must be {number}, found a length; -"),
        ),
        (
            "x^0.333333",
            "the unit of this expression has too large an exponent; write the exponent as a \
             fraction, such as `1/3`"
                .to_owned(),
        ),
        (
            "x^pi",
            "the exponent of a quantity with a unit must be a number; divide the base by a \
             reference value of the same unit first"
                .to_owned(),
        ),
        (
            "dot(L)",
            "`L` is not a coordinate; `dot` takes the name of one; a parameter is constant"
                .to_owned(),
        ),
    ] {
        assert_eq!(finding(&format!("\"{text}\"")), expected, "{text}");
    }
    assert_eq!(
        finding("\"x*L\", unit = \"m\""),
        "`out` is declared as a length, its value is an area; write `unit = \"m^2\"`"
    );
}
