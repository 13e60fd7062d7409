//! Sample recordings: simulated rigs with effects that are missing from their specs.

use std::fmt::Write as _;
use std::path::Path;

use appell_runtime::inputs::TabulatedInputs;
use appell_runtime::simulate::{Sampling, Simulation};
use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng as _, SeedableRng as _};

use crate::{Error, Model, files};

/// Time between two rows in s.
const STEP: f64 = 0.01;
/// Standard deviation of the noise of encoders, in m or rad.
const NOISE: f64 = 1e-3;

/// A rig: its spec and description, and the hidden effects.
struct Rig {
    /// Name and text of the spec.
    spec: (&'static str, &'static str),
    description: &'static str,
    hidden: &'static str,
    measured: &'static [&'static str],
    inputs: &'static [&'static str],
    /// The inputs at a time, by the two rates of a run.
    commands: fn(f64, [f64; 2]) -> Vec<f64>,
    rows: u32,
}

/// A cart on a rail; it has dry friction, and the rail a grain.
const CART: Rig = Rig {
    spec: ("my_rig.toml", include_str!("../rig/my_rig.toml")),
    description: include_str!("../rig/recording.toml"),
    hidden: include_str!("sample/cart.toml"),
    measured: &["x"],
    inputs: &["F"],
    commands: |t, [slow, fast]| vec![2.0 * (slow * t).sin() + 1.5 * (fast * t).cos()],
    rows: 800,
};

/// An arm of two links; it holds a tool, and its elbow has a stop.
const ARM: Rig = Rig {
    spec: ("arm.toml", include_str!("../arm/arm.toml")),
    description: include_str!("../arm/recording.toml"),
    hidden: include_str!("sample/arm.toml"),
    measured: &["q_1", "q_2"],
    inputs: &["tau_1", "tau_2"],
    commands: |t, [slow, fast]| {
        let shoulder = 1.8 * (slow * t).sin() + 0.8 * (fast * t).cos();
        vec![
            shoulder,
            0.5 * (0.7 * slow * t).sin() + 0.3 * (0.8 * fast * t).cos(),
        ]
    },
    rows: 600,
};

/// Writes a folder with the spec of a rig, three recordings and their description; returns the names of the files.
/// The rig has dry friction and a rail with a grain; its spec has neither. It is the same rig every time.
pub fn rig(folder: &Path) -> Result<Vec<&'static str>, Error> {
    CART.written(folder)
}

/// The same of an arm that holds a tool and has a stop at its elbow; its spec has neither.
pub fn arm(folder: &Path) -> Result<Vec<&'static str>, Error> {
    ARM.written(folder)
}

/// An arm with four joints, as URDF and as MJCF.
const ROBOT: [(&str, &str); 2] = [
    ("arm.urdf", include_str!("../robot/arm.urdf")),
    ("arm.xml", include_str!("../robot/arm.xml")),
];

/// Writes a folder with a small robot arm as URDF and as MJCF; returns the names of the files.
pub fn robot(folder: &Path) -> Result<Vec<&'static str>, Error> {
    write(folder, &ROBOT.map(|(name, text)| (name, text.to_owned())))?;
    Ok(ROBOT.map(|(name, _)| name).into())
}

/// Writes files by their names to a folder that has none of them.
pub fn write<S: AsRef<str>>(folder: &Path, texts: &[(S, String)]) -> Result<(), Error> {
    files::make_folder(folder)?;
    for (name, _) in texts {
        let name = name.as_ref();
        if folder.join(name).exists() {
            let message = format!("`{name}` is there already: choose an empty folder");
            return Err(Error::data(folder.display(), message));
        }
    }
    for (name, text) in texts {
        files::write(&folder.join(name.as_ref()), text)?;
    }
    Ok(())
}

impl Rig {
    fn written(&self, folder: &Path) -> Result<Vec<&'static str>, Error> {
        let (name, spec) = self.spec;
        let rig = Model::from_spec(&format!("{spec}{}", self.hidden))?;
        let mut written = vec![
            (name, spec.to_owned()),
            ("recording.toml", self.description.to_owned()),
        ];
        let runs = [
            ("run1.csv", [3.0, 7.1]),
            ("run2.csv", [2.3, 8.3]),
            ("run3.csv", [2.7, 6.2]),
        ];
        for (seed, (name, rates)) in (1..).zip(runs) {
            written.push((name, self.recording(&rig, rates, seed)?));
        }
        write(folder, &written)?;
        Ok(written.into_iter().map(|(name, _)| name).collect())
    }

    /// A run under commands that are held for a row each.
    fn recording(&self, rig: &Model, rates: [f64; 2], seed: u64) -> Result<String, Error> {
        let times: Vec<f64> = (0..self.rows).map(|row| f64::from(row) * STEP).collect();
        let commands: Vec<Vec<f64>> = (times.iter()).map(|t| (self.commands)(*t, rates)).collect();
        let of = |input| commands.iter().map(|row| row[input]).collect();
        let columns: Vec<Vec<f64>> = (0..self.inputs.len()).map(of).collect();
        let inputs = TabulatedInputs::held(&times, &columns)?;
        let simulation = Simulation {
            span: [0.0, times[times.len() - 1]],
            inputs: &inputs,
            sampling: Sampling::Every(STEP),
            ..Simulation::new(rig.equations())
        };
        let motion = simulation.run()?;
        let measured = self.measured.iter();
        let measured: Vec<Vec<f64>> = measured
            .map(|name| motion.column(name).unwrap_or_default())
            .collect();
        let mut random = SplitMix64::seed_from_u64(seed);
        let header = [&["t"], self.measured, self.inputs].concat().join(",");
        let mut text = header + "\n";
        for (row, (t, commands)) in times.iter().zip(&commands).enumerate() {
            // Writing to a string cannot fail.
            let _ = write!(text, "{t:.2}");
            for column in &measured {
                let value = column.get(row).copied().unwrap_or(f64::NAN);
                let _ = write!(text, ",{:.5}", value + NOISE * normal(&mut random));
            }
            for command in commands {
                let _ = write!(text, ",{command:.5}");
            }
            text.push('\n');
        }
        Ok(text)
    }
}

/// A normal number, nearly: the sum of twelve uniform ones.
fn normal(random: &mut SplitMix64) -> f64 {
    let uniform = |random: &mut SplitMix64| (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
    (0..12).map(|_| uniform(random)).sum::<f64>() - 6.0
}
