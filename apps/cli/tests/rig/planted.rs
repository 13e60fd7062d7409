//! Rigs whose spec lacks a part: the spec with that part is simulated, and its readings have noise.

use std::fmt::Write as _;

use super::Noise;
use crate::support::{Folder, repository};

/// Standard deviation of the readings in their unit.
const NOISE: f64 = 1e-3;
/// Part of the parameters that is their tolerance.
const TOLERANCE: f64 = 0.01;
/// Time between two rows in s, for which an input is held.
const STEP: f64 = 0.01;
/// Runs; the last one is held out.
const RUNS: [&str; 3] = ["a.csv", "b.csv", "c.csv"];
/// Waves of an input.
const WAVES: usize = 3;

/// A rig; parameters, coordinates and inputs with their units.
pub(crate) struct Planted<'r> {
    pub(crate) spec: &'r str,
    pub(crate) parameters: &'r [(&'r str, f64, &'r str)],
    pub(crate) coordinates: &'r [&'r str],
    /// With amplitudes.
    pub(crate) inputs: &'r [(&'r str, &'r str, f64)],
    /// Values of the first coordinate where the runs begin.
    pub(crate) begins: [f64; 3],
    pub(crate) seconds: u32,
}

/// The text of a shipped spec.
pub(crate) fn shipped(mechanism: &str) -> String {
    let path = repository(&format!("generated/mechanisms/{mechanism}.toml"));
    std::fs::read_to_string(path).expect("a shipped spec")
}

impl Planted<'_> {
    /// The data set of the rig with some more items of a spec, or with other ones.
    pub(crate) fn with(&self, part: &str) -> Folder {
        self.of(&format!("{}\n{part}", self.spec))
    }

    /// The same of a rig that moves by another spec.
    pub(crate) fn of(&self, truth: &str) -> Folder {
        let folder = Folder::new();
        folder.write("spec.toml", self.spec);
        folder.write("truth.toml", truth);
        folder.write("recording.toml", &self.description());
        let mut noise = Noise::seeded(7);
        for (name, begins) in RUNS.into_iter().zip(self.begins) {
            let text = self.run(&folder, begins, &mut noise);
            folder.write(name, &text);
        }
        folder
    }

    fn description(&self) -> String {
        let mut text = "mechanism = \"spec.toml\"\n[parameters]\n".to_owned();
        for (name, value, unit) in self.parameters {
            let std = TOLERANCE * value;
            let _ = writeln!(
                text,
                "{name} = {{ value = {value:?}, unit = \"{unit}\", std = {std:?} }}"
            );
        }
        text += "[channels]\n";
        for name in self.coordinates {
            let unit = if *name == "x" { "m" } else { "rad" };
            let _ = writeln!(
                text,
                "{name} = {{ measures = \"{name}\", unit = \"{unit}\", noise_std = {NOISE:?} }}"
            );
        }
        for (name, unit, _) in self.inputs {
            let _ = writeln!(text, "{name} = {{ input = \"{name}\", unit = \"{unit}\" }}");
        }
        let [first, second, last] = RUNS;
        text + &format!("[runs]\nfit = [\"{first}\", \"{second}\"]\ntest = [\"{last}\"]\n")
    }

    fn run(&self, folder: &Folder, begins: f64, noise: &mut Noise) -> String {
        let rows = 100 * self.seconds;
        let waves: Vec<[[f64; 3]; WAVES]> = (self.inputs.iter())
            .map(|(_, _, size)| {
                [(); WAVES].map(|()| {
                    let size = size * (0.5 + 0.5 * noise.uniform());
                    [size, 1.0 + 9.0 * noise.uniform(), 6.0 * noise.uniform()]
                })
            })
            .collect();
        let input = |waves: &[[f64; 3]], t: f64| -> f64 {
            let wave = |[size, rate, phase]: &[f64; 3]| size * (rate * t + phase).sin();
            waves.iter().map(wave).sum()
        };
        let names: Vec<&str> = self.inputs.iter().map(|(name, ..)| *name).collect();
        let at = |row: u32| f64::from(row) * STEP;
        let inputs = |row: u32| -> String {
            let values = waves
                .iter()
                .map(|waves| format!(",{}", input(waves, at(row))));
            values.collect()
        };
        let mut held = format!("t,{}\n", names.join(","));
        for row in 0..=rows {
            let _ = writeln!(held, "{}{}", at(row), inputs(row));
        }
        folder.write("held.csv", &held);
        let (seconds, begins) = (
            self.seconds.to_string(),
            format!("{}={begins}", self.coordinates[0]),
        );
        let mut asked = vec![
            "simulate",
            "truth.toml",
            "--csv",
            "full.csv",
            "--dt-s",
            "0.01",
        ];
        asked.extend([
            "--rtol",
            "1e-8",
            "--t-end-s",
            &seconds,
            "--initial",
            &begins,
        ]);
        if !names.is_empty() {
            asked.extend(["--inputs", "held.csv"]);
        }
        folder.done(&asked);
        let full = folder.read("full.csv");
        let mut lines = full.lines().filter(|line| !line.starts_with('#'));
        let header: Vec<&str> = lines.next().expect("a header").split(',').collect();
        let column = |name: &&str| {
            let of = |column: &&str| column.split(" [").next() == Some(*name);
            header.iter().position(of).expect("a column")
        };
        let columns: Vec<usize> = self.coordinates.iter().map(column).collect();
        let shown = self.coordinates.iter().chain(&names).copied();
        let mut text = format!("t,{}\n", shown.collect::<Vec<_>>().join(","));
        for (row, line) in (0..).zip(lines) {
            let cells: Vec<&str> = line.split(',').collect();
            let _ = write!(text, "{:.2}", at(row));
            for &column in &columns {
                let cell: f64 = cells[column].parse().expect("a number");
                let _ = write!(text, ",{}", cell + NOISE * noise.next());
            }
            let _ = writeln!(text, "{}", inputs(row));
        }
        text
    }
}
