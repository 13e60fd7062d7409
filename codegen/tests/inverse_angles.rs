//! Angles from inverse functions: a disc on a road whose tilt follows from its slope.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use appell_codegen::compile;
use appell_codegen::compile::audited;
use appell_codegen::interpreted::InterpretedModel;
use appell_codegen::program::FunctionKind;
use appell_runtime::model::{At, Model};

/// Digits of the references, and a step of the classical method that keeps as many.
const DIGITS: f64 = 2e-6;
const STEPS: usize = 2000;

/// A disc that rolls over z = a cos k s, with other lines about its tilt.
fn road(tilt: &str, more: &str) -> String {
    format!(
        "[mechanism]\nname = 'bumpy'\ntitle = 'Disc that rolls over a sinusoidal road'\n\
         [parameters]\nm = {{ value = 5, unit = 'kg' }}\nr = {{ value = 0.2, unit = 'm' }}\n\
         I = {{ value = 0.1, unit = 'kg*m^2' }}\na = {{ value = 0.05, unit = 'm' }}\n\
         k = {{ value = 3, unit = '1/m' }}\ng = {{ value = 9.81, unit = 'm/s^2' }}\n\
         [coordinates]\ns = {{ unit = 'm' }}\nphi = {{ unit = 'rad' }}\n{more}\n\
         [definitions]\nslope = '-a*k*sin(k*s)'\n\
         [frames]\nroad = {{ parent = 'ground', about_axis = '-y', by = '{tilt}' }}\n\
         disc = {{ parent = 'ground', about_axis = 'y', by = 'phi' }}\n\
         [points]\nP = {{ from = 'O', in = 'ground', at = ['s', 0, 'a*cos(k*s)'] }}\n\
         C = {{ from = 'P', in = 'road', at = [0, 0, 'r'] }}\n\
         [bodies]\ndisc = {{ frame = 'disc', centre = 'C', mass = 'm', inertia = {{ in = 'disc', \
         diagonal = ['I/2', 'I', 'I/2'] }} }}\n\
         [constraints]\nroll = {{ kind = 'rolling', body = 'disc', contact = 'P', in = 'road', \
         normal = 'z', friction = 0.6 }}\n[pseudo_velocities]\nw = 'dot(phi)'\n\
         [loads]\nweight = {{ kind = 'gravity', down = '-z', acceleration = 'g' }}\n"
    )
}

/// The tilt as a coordinate that a position constraint ties to the slope.
fn tied(zero: &str) -> String {
    let constraint = format!(
        "[constraints]\ntie = {{ kind = 'position', zero = '{zero}', dependent = 'tilt' }}\n"
    );
    road("tilt", "tilt = { unit = 'rad' }").replace("[constraints]\n", &constraint)
}

/// Speed and path after four seconds.
fn after_four_seconds(text: &str, speed: f64) -> [f64; 2] {
    let program = compile("a.toml", text, &FunctionKind::STANDARD);
    let model =
        InterpretedModel::new(program.unwrap_or_else(|report| panic!("{}", report.plain())));
    let info = model.info();
    let (n, p) = (info.state_len(), info.default_parameters());
    let rates = |x: &[f64]| {
        let mut rates = vec![f64::NAN; n];
        model.rates(
            At {
                t: 0.0,
                x,
                u: &[],
                p: &p,
            },
            &mut rates,
        );
        rates
    };
    let moved = |x: &[f64], h: f64, k: &[f64]| -> Vec<f64> {
        x.iter().zip(k).map(|(x, k)| x + h * k).collect()
    };
    let mut x = info.initial_state();
    let h = 4.0 / STEPS as f64;
    x[0] = speed;
    for _ in 0..STEPS {
        let a = rates(&x);
        let b = rates(&moved(&x, h / 2.0, &a));
        let c = rates(&moved(&x, h / 2.0, &b));
        let d = rates(&moved(&x, h, &c));
        let sum: Vec<f64> = (0..n)
            .map(|i| (a[i] + 2.0 * (b[i] + c[i]) + d[i]) / 6.0)
            .collect();
        x = moved(&x, h, &sum);
    }
    [x[0], x[info.state_index("s").unwrap()]]
}

/// From an integration of the remaining equation, derived by hand.
const REFERENCE: [(f64, [f64; 2]); 2] = [
    (5.0, [6.963_742, 4.849_430]),
    (20.0, [20.391_793, 16.256_953]),
];

#[test]
fn a_disc_rolls_over_a_road_however_its_tilt_is_written() {
    for text in [
        road("atan(slope)", ""),
        road("-atan(-slope)", ""),
        road("atan2(slope, 1)", ""),
        road("asin(slope/hypot(1, slope))", ""),
        road("2*atan(slope/(1 + hypot(1, slope)))", ""),
        tied("tilt - atan(slope)"),
        tied("tan(tilt) - slope"),
        tied("sin(tilt) - slope*cos(tilt)"),
    ] {
        let audited =
            audited("a.toml", &text).unwrap_or_else(|report| panic!("{}", report.plain()));
        let contacts = audited
            .warnings
            .iter()
            .filter(|w| w.code.text().contains("contact"));
        assert_eq!(contacts.count(), 0, "{text}");
        for (speed, expected) in REFERENCE {
            let reached = after_four_seconds(&text, speed);
            for (got, wanted) in reached.iter().zip(expected) {
                assert!(
                    (got - wanted).abs() < DIGITS * wanted,
                    "{got} {wanted}\n{text}"
                );
            }
        }
    }
}

#[test]
fn a_tilt_that_is_not_that_of_the_slope_is_told() {
    for text in [
        road("atan(2*slope)", ""),
        tied("tilt - 2*atan(slope)"),
        tied("tan(tilt) - 2*slope"),
    ] {
        let report = audited("a.toml", &text)
            .err()
            .map(|report| report.plain())
            .unwrap_or_default();
        assert!(report.contains("[contact-geometry]"), "{report}");
    }
}
