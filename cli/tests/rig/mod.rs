//! A simulated rig: a carriage of 1 kg with a friction that its model does not have.
#![allow(dead_code, reason = "every test file uses a part of it")]

use std::fmt::Write as _;

use super::support::Folder;

const DESCRIPTION: &str = r#"
mechanism   = "carriage"
description = "simulated rig"
[parameters]
m = { value = 1.0, unit = "kg", std = 0.02 }
[channels]
x = { measures = "x", unit = "m", noise_std = 1e-3 }
F = { input = "F", unit = "N" }
[runs]
fit  = ["a.csv", "b.csv"]
test = ["c.csv"]
"#;

/// Rows of a recording, a hundred in a second.
const ROWS: u32 = 800;
/// Steps of the simulation in a row.
const STEPS: u32 = 10;

/// Noise of variance 1: the sum of twelve uniform numbers (P. L'Ecuyer's 64-bit congruences).
struct Noise(u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn next(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

/// A recording under held forces, with noise of 1 mm. `friction` is a force by velocity.
fn run(friction: impl Fn(f64) -> f64, noise: &mut Noise) -> String {
    let mut text = "t,x,F\n".to_owned();
    let (mut x, mut v) = (0.0, 0.0);
    let h = 0.01 / f64::from(STEPS);
    for row in 0..ROWS {
        let t = f64::from(row) / 100.0;
        let force = 2.0 * (3.0 * t).sin() + 1.5 * (7.1 * t).cos();
        let _ = writeln!(text, "{t},{},{force}", x + 1e-3 * noise.next());
        for _ in 0..STEPS {
            // The middle of the step, so that the error is of its third order.
            let half = v + 0.5 * h * (force - friction(v));
            x += h * half;
            v += h * (force - friction(half));
        }
    }
    text
}

/// A data set of three runs.
pub(crate) fn data_set(friction: impl Fn(f64) -> f64) -> Folder {
    let folder = Folder::new();
    folder.write("recording.toml", DESCRIPTION);
    let mut noise = Noise(7);
    for name in ["a.csv", "b.csv", "c.csv"] {
        folder.write(name, &run(&friction, &mut noise));
    }
    folder
}

/// With viscous friction.
pub(crate) fn viscous(coefficient: f64) -> Folder {
    data_set(move |v| coefficient * v)
}

/// With dry friction, its sign rounded as filters have to round it.
pub(crate) fn dry(force: f64) -> Folder {
    data_set(move |v| force * (v / 0.02).tanh())
}
