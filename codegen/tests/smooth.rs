//! Rounded corners keep their digits, as do their derivatives, in every execution.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use appell_codegen::compile;
use appell_codegen::interpreted::InterpretedModel;
use appell_codegen::jit::JitModel;
use appell_codegen::program::FunctionKind;
use appell_runtime::model::{At, Model};

/// A few roundings.
const ROUNDING: f64 = 1e-15;

const SPEC: &str = "
[mechanism]
name = 'corner'
title = 'a corner'
[parameters]
m = { value = 1, unit = 'kg' }
b = { value = 1, unit = 'm' }
w = { value = 1, unit = 'm' }
[coordinates]
x = { unit = 'm' }
[points]
P = { from = 'O', in = 'ground', at = ['x', 0, 0] }
[bodies]
p = { centre = 'P', mass = 'm' }
[pseudo_velocities]
v = 'dot(x)'
[outputs]
least = { value = 'smooth_min(x, b, w)', unit = 'm' }
most = { value = 'smooth_max(x, b, w)', unit = 'm' }
";

/// `w²/(2(d + √(d² + w²)))` and its derivative by d, without a difference; d is not negative.
fn share(d: f64, w: f64) -> [f64; 2] {
    let root = d.hypot(w);
    let share = w * (w / (2.0 * (d + root)));
    [share, -share / root]
}

#[test]
fn a_smooth_corner_keeps_its_digits() {
    let program = compile("a.toml", SPEC, &FunctionKind::ALL).unwrap();
    let compiled = JitModel::new(&program).unwrap();
    let interpreted = InterpretedModel::new(program);
    let models: [&dyn Model; 2] = [&compiled, &interpreted];
    for model in models {
        for (x, b, w) in [
            (0.0, 0.0, 1.0),
            (1e9, 1.0, 1e-3),
            (1.0, 1e9, 1e-3),
            (-1e9, 1.0, 1e-3),
            (3e7, -2e7, 5e-4),
            (2.0, 2.0, 1e-8),
            (1.0, 1.0 + 1e-9, 1e-9),
            (-4.0, 3.0, 2.0),
        ] {
            let at = At {
                t: 0.0,
                x: &[0.0, x],
                u: &[],
                p: &[1.0, b, w],
            };
            let [mut y, mut c, mut d] = [vec![f64::NAN; 2], vec![f64::NAN; 4], Vec::new()];
            model.output_jacobians(at, &mut y, &mut c, &mut d);
            let [share, slope] = share((x - b).abs(), w);
            // The derivative of the larger side by x, and of the distance of both.
            let larger = f64::from(u8::from(x >= b));
            let outwards = if x >= b { slope } else { -slope };
            let expected = [x.min(b) - share, x.max(b) + share];
            let slopes = [1.0 - larger - outwards, larger + outwards];
            for k in 0..2 {
                let size = expected[k].abs().max(share);
                assert!(
                    (y[k] - expected[k]).abs() <= ROUNDING * size,
                    "{x} {b} {w}: {y:?} {expected:?}"
                );
                let (got, wanted) = (c[2 * k + 1], slopes[k]);
                // The effect of rounding both sides, by the curvature of the corner.
                let bend = w * w / (2.0 * (x - b).hypot(w).powi(3));
                let felt = wanted.abs().max(1e-3) + (x.abs() + b.abs()) * bend;
                assert!(
                    (got - wanted).abs() <= 4.0 * ROUNDING * felt,
                    "{x} {b} {w}: {got} {wanted}"
                );
            }
        }
    }
}
