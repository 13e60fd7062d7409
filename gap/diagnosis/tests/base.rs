//! Base parameters from noisy motions: unbiased, with intervals that hold what they promise.

#![expect(clippy::unwrap_used, reason = "a test may stop here")]

use std::fmt::Write as _;

use appell_codegen::compile;
use appell_codegen::jit::JitModel;
use appell_codegen::mechanics::Regressor;
use appell_codegen::program::FunctionKind;
use appell_gap::base::{self, Fit, Structure};
use appell_runtime::model::{At, Model};
use appell_test_kit::Random;

use crate::common::Folder;

/// A pole that hangs from a driven cart: the equation of the pole has no input.
const CART: &str = r#"
[mechanism]
name = "cart"
title = "Pendulum hanging from a driven cart"
[parameters]
M = { value = 1, unit = "kg", at_least = 0 }
m = { value = 0.5, unit = "kg", at_least = 0 }
a = { value = 0.25, unit = "m" }
I = { value = 0.006, unit = "kg*m^2", at_least = 0 }
b = { value = 0.005, unit = "N*m*s", at_least = 0 }
bc = { value = 5, unit = "N*s/m", at_least = 0 }
[coordinates]
s = { unit = "m" }
phi = { unit = "rad" }
[inputs]
u = { unit = "N" }
[frames]
rod = { parent = "ground", about_axis = "-y", by = "phi" }
[points]
C = { from = "O", in = "ground", at = ["s", 0, 0] }
G = { from = "C", in = "rod", at = [0, 0, "-a"] }
[bodies]
cart = { centre = "C", mass = "M" }
rod = { frame = "rod", centre = "G", mass = "m", inertia = { in = "rod", diagonal = ["I", "I", "I"] } }
[pseudo_velocities]
v = "dot(s)"
w = "dot(phi)"
[loads]
weight = { kind = "gravity", down = "-z", acceleration = "9.81 [m/s^2]" }
push = { kind = "generalized", coordinate = "s", force = "u" }
rail = { kind = "damper", coordinate = "s", damping = "bc" }
hinge = { kind = "damper", coordinate = "phi", damping = "b" }
"#;

const RECORDED: &str = r#"
mechanism = "cart.toml"
[channels]
s = { measures = "s", unit = "m" }
phi = { measures = "phi", unit = "rad" }
u = { input = "u", unit = "N", interpolation = "hold" }
[runs]
fit = ["run.csv"]
"#;

/// M, m, a, I, b, bc of the rig.
const TRUTH: [f64; 6] = [1.3, 0.4, 0.25, 0.009, 0.006, 7.0];
/// Names and true values of the base parameters.
const BASE: [(&str, f64); 6] = [
    ("m_cart", 1.7),
    ("mx_rod", 0.0),
    ("mz_rod", -0.1),
    ("Iyy_rod", 0.034),
    ("b", 0.006),
    ("bc", 7.0),
];
/// Noise of the encoders in m and rad; accelerations from neighbouring rows have some hundred times that of the motion.
const NOISE: [f64; 2] = [2e-4, 2e-3];
/// Between rows in s.
const STEP: f64 = 0.002;

/// A rig with what finds its base parameters.
struct Rig {
    model: JitModel,
    regressor: Regressor,
    structure: Structure,
}

impl Rig {
    fn new() -> Self {
        let program = appell_codegen::compile("cart.toml", CART, &FunctionKind::ALL).unwrap();
        let model = JitModel::new(&program).unwrap();
        let regressor = compile::regressor("cart.toml", CART).unwrap();
        let p: Vec<f64> = model
            .info()
            .parameters
            .iter()
            .map(|own| own.value)
            .collect();
        let structure = base::structure(&model, &regressor, &p).unwrap();
        Self {
            model,
            regressor,
            structure,
        }
    }

    /// The base parameters by a run of so many seconds, during which the command is held from row to row.
    fn fit(&self, seconds: f64, seed: u64) -> Fit {
        let mut dice = Random::new(seed);
        let phases = [0, 1, 2].map(|_| dice.between(0.0, std::f64::consts::TAU));
        let sines = [(14.0, 5.6), (12.0, 9.3), (4.0, 2.3)];
        let force = |t: f64| -> f64 {
            let parts = sines.iter().zip(phases);
            parts
                .map(|((size, rate), phase)| size * (rate * t + phase).sin())
                .sum()
        };
        let mut x = vec![0.0; 4];
        let mut text = "t,s,phi,u\n".to_owned();
        let mut t = 0.0;
        while t < seconds {
            let u = force(t);
            let [s, phi] = [
                x[2] + NOISE[0] * dice.normal(),
                x[3] + NOISE[1] * dice.normal(),
            ];
            writeln!(text, "{t:.4},{s:.7},{phi:.7},{u:.6}").unwrap();
            self.step(&mut x, u);
            t += STEP;
        }
        let folder = Folder::new();
        folder
            .write("cart.toml", CART)
            .write("recording.toml", RECORDED)
            .write("run.csv", text);
        let set = folder.read().unwrap();
        base::fit(&set, &self.model, &self.regressor, &self.structure).unwrap()
    }

    /// A step of the classical Runge–Kutta method.
    fn step(&self, x: &mut [f64], u: f64) {
        let rates = |x: &[f64]| {
            let mut rates = vec![0.0; 4];
            let u = &[u];
            self.model.rates(
                At {
                    t: 0.0,
                    x,
                    u,
                    p: &TRUTH,
                },
                &mut rates,
            );
            rates
        };
        let moved =
            |by: &[f64], h: f64| -> Vec<f64> { x.iter().zip(by).map(|(x, k)| x + h * k).collect() };
        let k1 = rates(x);
        let k2 = rates(&moved(&k1, 0.5 * STEP));
        let k3 = rates(&moved(&k2, 0.5 * STEP));
        let k4 = rates(&moved(&k3, STEP));
        for (i, x) in x.iter_mut().enumerate() {
            *x += STEP / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
        }
    }
}

#[test]
fn noise_shrinks_no_parameter_and_intervals_cover_the_truth() {
    let rig = Rig::new();
    let found = rig.structure.base.iter();
    let names = found.map(|own| &*rig.structure.parameters[own.leading].name);
    let expected: Vec<&str> = BASE.iter().map(|(name, _)| *name).collect();
    assert_eq!(names.collect::<Vec<_>>(), expected);
    let (mut covered, mut all) = (0, 0);
    let mut squares = 0.0;
    for seed in 0..8 {
        let fit = rig.fit(3.0, seed);
        for (estimate, (name, truth)) in fit.estimates.iter().zip(BASE) {
            let off = (estimate.value - truth) / estimate.std;
            let size = truth.abs().max(0.1);
            // Least squares miss the first three by a tenth and more.
            assert!(
                (estimate.value - truth).abs() < 0.01 * size,
                "{name}: {}",
                estimate.value
            );
            assert!(
                estimate.std > 1e-6 * size && estimate.std < 0.01 * size,
                "{name}"
            );
            let [low, high] = estimate.interval95;
            covered += u32::from(low <= truth && truth <= high);
            all += 1;
            squares += off * off;
        }
    }
    // Of 48 intervals 45.6 are expected to cover, ± 1.5 if they were independent; they may be wider, not narrower.
    assert!(covered >= 42, "{covered} of {all}");
    let spread = (squares / f64::from(all)).sqrt();
    assert!((0.4..1.4).contains(&spread), "{spread}");
}

#[test]
fn one_short_run_has_intervals_as_wide_as_its_errors() {
    let rig = Rig::new();
    let mut covered = 0;
    for seed in 0..4 {
        let fit = rig.fit(0.6, seed);
        for (estimate, (_, truth)) in fit.estimates.iter().zip(BASE) {
            let [low, high] = estimate.interval95;
            assert!(high - low > 1e-5);
            covered += u32::from(low <= truth && truth <= high);
        }
    }
    assert!(covered >= 20, "{covered} of 24");
}

#[test]
fn a_gain_of_the_inputs_that_is_estimated_leaves_no_scale() {
    let spec = CART
        .replace(
            "[coordinates]",
            "K = { value = 1, unit = \"1\" }\n[coordinates]",
        )
        .replace("force = \"u\"", "force = \"K*u\"");
    let mut text = "t,s,phi,u\n".to_owned();
    for row in 0..500 {
        let t = f64::from(row) * STEP;
        let [s, phi, u] = [(7.0 * t).sin(), (9.0 * t).cos(), (5.0 * t).sin()];
        writeln!(text, "{t:.4},{s:.7},{phi:.7},{u:.6}").unwrap();
    }
    let folder = Folder::new();
    folder
        .write("cart.toml", spec.as_str())
        .write("recording.toml", RECORDED)
        .write("run.csv", text);
    let set = folder.read().unwrap();
    let program = appell_codegen::compile("cart.toml", &spec, &FunctionKind::ALL).unwrap();
    let model = JitModel::new(&program).unwrap();
    let regressor = compile::regressor("cart.toml", &spec).unwrap();
    let p: Vec<f64> = set.parameters.iter().map(|own| own.value).collect();
    let structure = base::structure(&model, &regressor, &p).unwrap();
    let told = base::fit(&set, &model, &regressor, &structure).unwrap_err();
    assert!(
        told.to_string()
            .contains("as a number of the spec instead: K"),
        "{told}"
    );
}
