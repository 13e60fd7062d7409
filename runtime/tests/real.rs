//! Scalars: duals against finite differences, lanes against scalars.

use appell_runtime::{Dual, Lanes, Real};

/// Every function of the trait, at arguments inside its domain.
fn functions<T: Real>(x: T) -> Vec<(&'static str, T)> {
    let c = T::constant;
    let inside = x.sin() * c(0.7);
    let positive = x * x + c(0.5);
    vec![
        ("sin", x.sin()),
        ("cos", x.cos()),
        ("sin_cos", x.sin_cos().0 * x.sin_cos().1),
        ("tan", x.tan()),
        ("asin", inside.asin()),
        ("acos", inside.acos()),
        ("atan", x.atan()),
        ("atan2", x.sin().atan2(x - c(2.0))),
        ("sinh", x.sinh()),
        ("cosh", x.cosh()),
        ("tanh", x.tanh()),
        ("exp", x.exp()),
        ("ln", positive.ln()),
        ("sqrt", positive.sqrt()),
        ("abs", x.abs()),
        ("sign", x.sign() * x),
        ("powf of the base", positive.powf(c(-1.7))),
        ("powf of both", positive.powf(x)),
        ("square of any sign", x.powf(c(2.0))),
        ("quotient", x / (c(2.0) + x.cos())),
        ("difference", -x - c(3.0) * x * x),
        ("if_less", T::if_less(x, c(0.2), x * x, c(2.0) * x)),
        (
            "if_less_or_equal",
            T::if_less_or_equal(x, c(0.2), x * x, c(2.0) * x),
        ),
    ]
}

const ARGUMENTS: [f64; 6] = [-2.9, -1.1, -0.3, 0.1, 0.7, 1.3];

/// Central differences of step 1e-5 err by some 1e-10 times the third derivative.
const DIFFERENCE_TOLERANCE: f64 = 1e-7;

#[test]
fn duals_agree_with_finite_differences() {
    let h = 1e-5;
    for x in ARGUMENTS {
        let exact = functions(Dual::<f64, 1>::variable(x, 0));
        let (plus, minus) = (functions(x + h), functions(x - h));
        for ((dual, plus), minus) in exact.iter().zip(&plus).zip(&minus) {
            let difference = (plus.1 - minus.1) / (2.0 * h);
            let slope = dual.1.partials[0];
            let gap = (slope - difference).abs() / (1.0 + slope.abs());
            assert!(
                gap < DIFFERENCE_TOLERANCE,
                "{} at {x}: {slope} {difference}",
                dual.0
            );
        }
    }
}

#[test]
fn nested_duals_agree_with_differences_of_duals() {
    let h = 1e-5;
    for x in ARGUMENTS {
        let inner = Dual::<f64, 1>::variable(x, 0);
        let second = functions(Dual::<Dual<f64, 1>, 1>::variable(inner, 0));
        let plus = functions(Dual::<f64, 1>::variable(x + h, 0));
        let minus = functions(Dual::<f64, 1>::variable(x - h, 0));
        for ((nested, plus), minus) in second.iter().zip(&plus).zip(&minus) {
            let difference = (plus.1.partials[0] - minus.1.partials[0]) / (2.0 * h);
            let curvature = nested.1.partials[0].partials[0];
            let gap = (curvature - difference).abs() / (1.0 + curvature.abs());
            assert!(
                gap < 10.0 * DIFFERENCE_TOLERANCE,
                "{} at {x}: {gap:e}",
                nested.0
            );
        }
    }
}

#[test]
fn the_value_of_a_dual_is_the_scalar_result() {
    for x in ARGUMENTS {
        for (dual, scalar) in functions(Dual::<f64, 2>::fixed(x)).iter().zip(functions(x)) {
            assert_eq!(
                dual.1.value.to_bits(),
                scalar.1.to_bits(),
                "{} at {x}",
                scalar.0
            );
        }
    }
}

#[test]
fn lanes_equal_scalars_bit_by_bit() {
    let lanes = functions(Lanes::standard(ARGUMENTS));
    for (lane, x) in ARGUMENTS.into_iter().enumerate() {
        for (lanes, scalar) in lanes.iter().zip(functions(x)) {
            assert_eq!(
                lanes.1.0[lane].to_bits(),
                scalar.1.to_bits(),
                "{} at {x}",
                scalar.0
            );
        }
    }
}

#[cfg(feature = "std")]
#[test]
fn sine_and_cosine_are_those_of_the_standard_library() {
    for x in ARGUMENTS {
        let (sin, cos) = x.sin_cos();
        let (real_sin, real_cos) = Real::sin_cos(x);
        assert_eq!(
            (sin.to_bits(), cos.to_bits()),
            (real_sin.to_bits(), real_cos.to_bits())
        );
    }
}

#[test]
fn the_sign_of_zero_is_zero_and_of_nan_is_nan() {
    let sign = |x: f64| Real::sign(x).to_string();
    assert_eq!(
        [-3.0, 0.0, 1e-300, f64::NAN].map(sign),
        ["-1", "0", "1", "NaN"]
    );
    let sign = |x: f32| Real::sign(x).to_string();
    assert_eq!(
        [-3.0, 0.0, 1e-30, f32::NAN].map(sign),
        ["-1", "0", "1", "NaN"]
    );
}

#[test]
fn powers_at_zero_have_finite_slopes() {
    let power = |exponent| {
        let x = Dual::<f64, 1>::variable(0.0, 0);
        x.powf(Dual::fixed(exponent)).partials[0].to_string()
    };
    assert_eq!([0.0, 1.0, 2.0, 3.5].map(power), ["0", "1", "0", "0"]);
}

#[test]
fn single_precision_computes_in_single_precision() {
    for x in [-1.1f32, 0.3, 1.3] {
        for (single, double) in functions(x).iter().zip(functions(f64::from(x))) {
            let gap = (f64::from(single.1) - double.1).abs() / (1.0 + double.1.abs());
            assert!(gap < 1e-5, "{} at {x}: {gap:e}", double.0);
        }
    }
}
