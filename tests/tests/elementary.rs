//! The elementary functions of lanes against values with fifty digits.

use appell_runtime::elementary as own;
use appell_tests::reference;
use std::collections::BTreeMap;

/// Most units in the last place that a value may be off.
const ULPS: f64 = 1.0;

fn value(function: &str, x: f64, y: f64) -> f64 {
    match function {
        "sin" => own::sin(x),
        "cos" => own::cos(x),
        "tan" => own::tan(x),
        "asin" => own::asin(x),
        "acos" => own::acos(x),
        "atan" => own::atan(x),
        "atan2" => own::atan2(x, y),
        "sinh" => own::sinh(x),
        "cosh" => own::cosh(x),
        "tanh" => own::tanh(x),
        "exp" => own::exp(x),
        "ln" => own::ln(x),
        "powf" => own::powf(x, y),
        other => panic!("no function {other}"),
    }
}

/// Distance to the next double away from zero.
fn ulp(x: f64) -> f64 {
    f64::from_bits(x.abs().to_bits() + 1) - x.abs()
}

#[test]
fn elementary_functions_are_within_one_unit_in_the_last_place() {
    let table = reference::text("elementary.csv");
    let mut worst: BTreeMap<&str, (f64, &str)> = BTreeMap::default();
    for row in table.lines().skip(1) {
        let cells: Vec<&str> = row.split(',').collect();
        let number = |cell: &str| cell.parse::<f64>().unwrap_or(f64::NAN);
        let (x, y, nearest, above) = (
            number(cells[1]),
            number(cells[2]),
            number(cells[3]),
            number(cells[4]),
        );
        let off = ((value(cells[0], x, y) - nearest) / ulp(nearest) - above).abs();
        assert!(off <= ULPS, "{row}: {off} units off");
        let most = worst.entry(cells[0]).or_default();
        if off > most.0 {
            *most = (off, row);
        }
    }
    for (function, (off, row)) in &worst {
        println!("{function:6} {off:.3}  {row}");
    }
    assert_eq!(worst.len(), 13, "every function has rows");
}

/// What IEEE 754 says of the ends of the ranges, and the bits it says it in.
#[test]
fn elementary_functions_have_the_special_values_of_the_standard() {
    const INFINITY: f64 = f64::INFINITY;
    const TINY: f64 = f64::MIN_POSITIVE / 3.0;
    let unary = [
        ("sin", vec![-0.0, 0.0, TINY, -TINY]),
        ("tan", vec![-0.0, 0.0, TINY, -TINY]),
        ("asin", vec![-0.0, 0.0, 1.0, -1.0, TINY]),
        ("atan", vec![-0.0, 0.0, INFINITY, -INFINITY, -TINY]),
        ("sinh", vec![-0.0, 0.0, INFINITY, -INFINITY, 711.0, TINY]),
        ("tanh", vec![-0.0, 0.0, INFINITY, -INFINITY, 30.0, TINY]),
        ("cos", vec![-0.0, 0.0, TINY]),
        ("acos", vec![1.0, 0.0, -0.0, -1.0]),
        ("cosh", vec![0.0, INFINITY, -INFINITY, 711.0]),
        (
            "exp",
            vec![-0.0, 0.0, INFINITY, -INFINITY, 710.0, -746.0, 1e300, -1e300],
        ),
        ("ln", vec![0.0, -0.0, 1.0, INFINITY]),
    ];
    let standard = |function: &str, x: f64| match function {
        "sin" => x.sin(),
        "tan" => x.tan(),
        "asin" => x.asin(),
        "atan" => x.atan(),
        "sinh" => x.sinh(),
        "tanh" => x.tanh(),
        "cos" => x.cos(),
        "acos" => x.acos(),
        "cosh" => x.cosh(),
        "exp" => x.exp(),
        _ => x.ln(),
    };
    for (function, arguments) in &unary {
        for &x in arguments {
            let (found, expected) = (value(function, x, 0.0), standard(function, x));
            assert_eq!(
                found.to_bits(),
                expected.to_bits(),
                "{function}({x}): {found}"
            );
        }
        assert!(value(function, f64::NAN, 0.0).is_nan(), "{function}(NaN)");
    }
    let outside = [
        ("sin", INFINITY),
        ("cos", -INFINITY),
        ("tan", INFINITY),
        ("asin", 1.0 + f64::EPSILON),
        ("asin", -INFINITY),
        ("acos", -1.0 - f64::EPSILON),
        ("ln", -TINY),
        ("ln", -INFINITY),
    ];
    for (function, x) in outside {
        assert!(value(function, x, 0.0).is_nan(), "{function}({x})");
    }
}

#[test]
fn elementary_functions_of_two_numbers_have_the_special_values_of_the_standard() {
    let numbers = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        2.0,
        3.0,
        -3.0,
        0.5,
        -0.5,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NAN,
        f64::MAX,
        -f64::MIN_POSITIVE,
        4_503_599_627_370_497.0,
        9_007_199_254_740_993.0,
    ];
    let same = |a: f64, b: f64| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
    for x in numbers {
        for y in numbers {
            let (power, angle) = (own::powf(x, y), own::atan2(x, y));
            let close = (power - x.powf(y)).abs() <= ulp(power);
            assert!(same(power, x.powf(y)) || close, "{x} to the {y}: {power}");
            let close = (angle - x.atan2(y)).abs() <= ulp(angle);
            assert!(same(angle, x.atan2(y)) || close, "atan2({x}, {y}): {angle}");
        }
    }
}
