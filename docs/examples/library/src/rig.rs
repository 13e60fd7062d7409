//! A rig with a friction that the model lacks, recorded with noise on the angle.

use std::fmt::Write as _;
use std::path::PathBuf;

use appell::{Model, Motion};

/// Standard deviation of the angle's noise in rad.
const NOISE: f64 = 3e-4;

/// Writes three runs as CSV, with the commanded torque, and returns their files.
pub(crate) fn record(model: &Model) -> Result<Vec<PathBuf>, Box<dyn std::error::Error>> {
    let folder = std::env::temp_dir().join(format!("appell-rig-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let mut random = fastrand::Rng::with_seed(1);
    let mut files = Vec::new();
    for (frequency, name) in [(3.0, "slow.csv"), (5.0, "fast.csv"), (4.0, "test.csv")] {
        let torque = format!("2[N*m]*sin({frequency}[rad/s]*t)");
        let rig = Motion {
            interval: Some(0.01),
            ..Motion::new(4.0).input("tau", format!("{torque} - 0.1[N*m*s/rad]*omega"))
        };
        let motion = model.simulate(&rig)?.trajectory;
        let mut text = "t,theta,tau\n".to_owned();
        for (t, theta) in motion
            .times()
            .iter()
            .zip(motion.column("theta").unwrap_or_default())
        {
            // Twelve uniform numbers make a normal one, nearly.
            let noise = NOISE * ((0..12).map(|_| random.f64()).sum::<f64>() - 6.0);
            writeln!(
                text,
                "{t},{},{}",
                theta + noise,
                2.0 * (frequency * t).sin()
            )?;
        }
        let file = folder.join(name);
        std::fs::write(&file, text)?;
        files.push(file);
    }
    Ok(files)
}
