//! Recordings to try things with: those of a simulated rig whose spec lacks what moves it.

use std::fmt::Write as _;
use std::path::Path;

use appell_runtime::inputs::TabulatedInputs;
use appell_runtime::simulate::{Sampling, Simulation};
use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng as _, SeedableRng as _};

use crate::{Error, Model, files};

/// Time between two rows in s, and rows of a run.
const STEP: f64 = 0.01;
const ROWS: u32 = 800;
/// Standard deviation of the encoder's noise in m.
const NOISE: f64 = 1e-3;
/// Spec and description as their owner has them.
const SPEC: &str = include_str!("../rig/my_rig.toml");
const DESCRIPTION: &str = include_str!("../rig/recording.toml");
/// What nobody told the owner: dry friction, and a rail with a grain.
const HIDDEN: &str = r#"
[loads.rubbing]
kind     = "generalized"
velocity = "v"
force    = "-0.4 [N]*tanh(v/(0.02 [m/s]))"

[loads.grain]
kind     = "generalized"
velocity = "v"
force    = "-0.3 [N]*sin(20 [1/m]*x)"
"#;

/// Writes a folder with the spec of a rig, three recordings and their description; returns the names of the files.
/// The rig has dry friction and a rail with a grain; its spec has neither. It is the same rig every time.
pub fn rig(folder: &Path) -> Result<Vec<&'static str>, Error> {
    let rig = Model::from_spec(&format!("{SPEC}{HIDDEN}"))?;
    let mut written = vec![
        ("my_rig.toml", SPEC.to_owned()),
        ("recording.toml", DESCRIPTION.to_owned()),
    ];
    let runs = [
        ("run1.csv", [3.0, 7.1]),
        ("run2.csv", [2.3, 8.3]),
        ("run3.csv", [2.7, 6.2]),
    ];
    for (seed, (name, rates)) in (1..).zip(runs) {
        written.push((name, recording(&rig, rates, seed)?));
    }
    write(folder, &written)?;
    Ok(written.into_iter().map(|(name, _)| name).collect())
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

/// A run under two sines of force, each value held for a row.
fn recording(rig: &Model, [slow, fast]: [f64; 2], seed: u64) -> Result<String, Error> {
    let times: Vec<f64> = (0..ROWS).map(|row| f64::from(row) * STEP).collect();
    let force = |t: &f64| 2.0 * (slow * t).sin() + 1.5 * (fast * t).cos();
    let forces: Vec<f64> = times.iter().map(force).collect();
    let inputs = TabulatedInputs::held(&times, std::slice::from_ref(&forces))?;
    let simulation = Simulation {
        span: [0.0, times[times.len() - 1]],
        inputs: &inputs,
        sampling: Sampling::Every(STEP),
        ..Simulation::new(rig.equations())
    };
    let motion = simulation.run()?;
    let mut random = SplitMix64::seed_from_u64(seed);
    let mut text = "t,x,F\n".to_owned();
    let rows = times.iter().zip(&forces);
    for ((t, force), x) in rows.zip(motion.column("x").unwrap_or_default()) {
        let x = x + NOISE * normal(&mut random);
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{t:.2},{x:.5},{force:.5}");
    }
    Ok(text)
}

/// A normal number, nearly: the sum of twelve uniform ones.
fn normal(random: &mut SplitMix64) -> f64 {
    let uniform = |random: &mut SplitMix64| (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
    (0..12).map(|_| uniform(random)).sum::<f64>() - 6.0
}
