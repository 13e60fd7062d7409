//! A simulated rig: a carriage of 1 kg with a friction that its model does not have.
#![allow(dead_code, reason = "every test file uses a part of it")]

use std::fmt::Write as _;

use super::support::{Folder, Noise};

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

/// A recording under forces that are held for 10 ms, with noise of 1 mm. `friction` is a force by
/// velocity.
fn recording(friction: &dyn Fn(f64) -> f64, forces: &[f64], noise: &mut Noise) -> String {
    let mut text = "t,x,F\n".to_owned();
    let (mut x, mut v) = (0.0, 0.0);
    let h = 0.01 / f64::from(STEPS);
    for (row, force) in forces.iter().enumerate() {
        let t = row as f64 / 100.0;
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

/// A rig with a friction.
pub(crate) struct Rig<F> {
    pub(crate) folder: Folder,
    friction: F,
    noise: Noise,
}

impl<F: Fn(f64) -> f64> Rig<F> {
    /// With a data set of three runs.
    pub(crate) fn new(friction: F) -> Self {
        let mut rig = Self {
            folder: Folder::new(),
            friction,
            noise: Noise(7),
        };
        rig.folder.write("recording.toml", DESCRIPTION);
        let force = |t: f64| 2.0 * (3.0 * t).sin() + 1.5 * (7.1 * t).cos();
        let forces: Vec<f64> = (0..ROWS).map(|row| force(f64::from(row) / 100.0)).collect();
        for name in ["a.csv", "b.csv", "c.csv"] {
            rig.record(name, &forces);
        }
        rig
    }

    /// Records a run that may be fitted.
    pub(crate) fn record_to_fit(&mut self, name: &str, forces: &[f64]) {
        self.record(name, forces);
        let named = format!("fit  = [\"{name}\", ");
        let description = self.folder.read("recording.toml");
        let description = description.replace("fit  = [", &named);
        self.folder.write("recording.toml", &description);
    }

    fn record(&mut self, name: &str, forces: &[f64]) {
        let text = recording(&self.friction, forces, &mut self.noise);
        self.folder.write(name, &text);
    }
}

/// With viscous friction.
pub(crate) fn viscous(coefficient: f64) -> Folder {
    Rig::new(move |v| coefficient * v).folder
}

/// With dry friction, its sign rounded as filters have to round it.
pub(crate) fn dry(force: f64) -> Folder {
    Rig::new(move |v| force * (v / 0.02).tanh()).folder
}
