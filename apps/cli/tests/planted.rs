//! Every shipped mechanism with one effect that its spec does not have, recorded and diagnosed.

use std::fmt::Write as _;
use std::fs;

use appell_test_kit::is_full;
use serde_json::Value;
use toml_edit::{DocumentMut, Item, TableLike};

use crate::rig::Noise;
use crate::support::{Folder, repository};

/// Standard deviation of the readings in their unit.
const NOISE: f64 = 1e-4;
/// Part of the parameters that is their tolerance.
const TOLERANCE: f64 = 0.01;
/// Time between two rows in s.
const STEP: f64 = 0.01;
/// Runs; the last two are held out.
const RUNS: usize = 6;
/// Mechanisms of which the planted effect has to lead or be tied with what leads.
const FOUND: usize = 24;

/// A mechanism with a viscous friction.
struct Planted {
    mechanism: &'static str,
    coordinate: &'static str,
    /// Coefficient in SI.
    size: f64,
    /// Amplitude of the inputs.
    drive: f64,
    /// Duration of a run in s.
    seconds: f64,
    /// Standard deviation of the pseudo-velocities at the start.
    spread: f64,
    /// Initial values about which they are spread.
    initial: &'static [(&'static str, f64)],
}

const fn planted(
    mechanism: &'static str,
    coordinate: &'static str,
    [size, drive, seconds, spread]: [f64; 4],
    initial: &'static [(&'static str, f64)],
) -> Planted {
    Planted {
        mechanism,
        coordinate,
        size,
        drive,
        seconds,
        spread,
        initial,
    }
}

const ROLLING: &[(&str, f64)] = &[("omega_2", 5.0)];
const UPRIGHT: [f64; 4] = [0.5, 1.0, 0.8, 0.2];

const ALL: [Planted; 26] = [
    planted("pendulum", "theta", [0.03, 0.5, 2.0, 0.5], &[]),
    planted("four_bar", "theta1", [0.02, 0.5, 2.0, 0.5], &[]),
    planted(
        "chaplygin_sleigh",
        "psi",
        [0.05, 0.0, 2.0, 0.7],
        &[("v", 1.0), ("omega", 2.0)],
    ),
    planted("carriage", "x", [0.5, 3.0, 2.0, 0.5], &[]),
    planted("cart_pole", "theta", [0.003, 3.0, 2.0, 0.5], &[]),
    planted("cart_double_pendulum", "theta1", [0.01, 3.0, 2.0, 0.5], &[]),
    planted("double_pendulum", "theta2", [0.02, 0.5, 2.0, 0.5], &[]),
    planted("furuta_pendulum", "theta2", [5e-4, 0.02, 2.0, 0.5], &[]),
    planted(
        "axisymmetric_wheel",
        "phi",
        [0.02, 0.0, 2.0, 0.5],
        &[("omega_2", 6.0), ("theta", 0.1)],
    ),
    planted(
        "rolling_wheel",
        "phi",
        [0.05, 0.0, 2.0, 0.5],
        &[("omega_2", 6.0), ("theta", 0.1)],
    ),
    planted("ball_on_ball", "theta", [0.02, 0.0, 1.0, 0.3], &[]),
    planted(
        "bicycle",
        "delta",
        [1.0, 1.0, 1.0, 0.15],
        &[("omega_R", -15.0)],
    ),
    planted("euc_2dof", "phi", [5.0, 20.0, 1.5, 0.3], &[]),
    planted("euc_3dof", "gamma", [2.0, 20.0, 1.0, 0.3], &[]),
    planted("euc_spatial", "phi", [5.0, 10.0, 0.8, 0.2], &[("v", 3.0)]),
    planted("rolling_ball", "theta", [0.05, 1.0, 2.0, 0.5], &[]),
    planted("two_wheeled_pendulum", "theta", [0.2, 0.5, 1.0, 0.3], &[]),
    planted("unicycle", "r", [4.0, 5.0, 1.0, 0.2], &[("omega_2", 10.0)]),
    planted(
        "unicycle_gyroscope",
        "gamma",
        [0.3, 0.5, 0.8, 0.2],
        &[("omega_2", 5.0), ("nu", 200.0)],
    ),
    planted("unicycle_lateral_flywheel", "gamma", UPRIGHT, ROLLING),
    planted("unicycle_lateral_pendulum", "beta", UPRIGHT, ROLLING),
    planted(
        "unicycle_linkage_rider",
        "delta",
        [0.5, 3.0, 0.8, 0.2],
        ROLLING,
    ),
    planted("unicycle_overhead_flywheel", "gamma", UPRIGHT, ROLLING),
    planted("unicycle_slider", "r", [4.0, 3.0, 0.8, 0.2], ROLLING),
    planted("unicycle_two_flywheels", "gamma", UPRIGHT, ROLLING),
    planted("wheelbot", "gamma", [0.05, 0.1, 0.8, 0.2], ROLLING),
];

/// In an ordinary run a plain mechanism, a closed loop and a nonholonomic one; in a full run all.
#[test]
fn a_planted_effect_is_found_in_every_shipped_mechanism() {
    let (tried, least) = if is_full() {
        (ALL.as_slice(), FOUND)
    } else {
        (&ALL[..3], 3)
    };
    let missed: Vec<String> = tried.iter().filter_map(|one| one.missed().err()).collect();
    let found = tried.len() - missed.len();
    assert!(
        found >= least,
        "{found} of {}:\n{}",
        tried.len(),
        missed.join("\n")
    );
}

/// The names and tables of a part of a spec.
fn part<'s>(spec: &'s DocumentMut, name: &str) -> Vec<(&'s str, &'s dyn TableLike)> {
    let part = spec.get(name).and_then(Item::as_table_like);
    let entries = part.into_iter().flat_map(TableLike::iter);
    entries
        .filter_map(|(name, entry)| Some((name, entry.as_table_like()?)))
        .collect()
}

fn unit(entry: &dyn TableLike) -> &str {
    entry.get("unit").and_then(Item::as_str).unwrap_or("1")
}

impl Planted {
    /// Why the planted effect neither leads nor is tied with what leads.
    fn missed(&self) -> Result<(), String> {
        let folder = Folder::new();
        self.record(&folder);
        folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
        let report = folder.json("report.json");
        let wanted = format!("viscous_friction@{}", self.coordinate);
        let first = &report["which"][0]["effects"];
        let leads = *first == serde_json::json!([wanted]);
        let tied = report["tied"].pointer("/0").and_then(Value::as_array);
        let is_tied = tied.is_some_and(|group| group.iter().any(|one| *one == wanted));
        if leads || is_tied {
            Ok(())
        } else {
            Err(format!(
                "{}: {wanted} wanted, {first} found",
                self.mechanism
            ))
        }
    }

    /// Simulates the runs, and describes them for the spec without the effect.
    fn record(&self, folder: &Folder) {
        let path = repository(&format!("generated/mechanisms/{}.toml", self.mechanism));
        let text = fs::read_to_string(path).expect("a shipped spec");
        let spec: DocumentMut = text.parse().expect("TOML");
        folder.write("planted.toml", &self.with_friction(&text, &spec));
        let mut noise = Noise::seeded(1);
        let mut files = Vec::new();
        for run in 0..RUNS {
            let file = format!("run{run}.csv");
            folder.write(&file, &self.run(folder, &spec, &mut noise));
            files.push(format!("\"{file}\""));
        }
        let mut description = format!("mechanism = \"{}\"\n[parameters]\n", self.mechanism);
        for (name, parameter) in part(&spec, "parameters") {
            let value = parameter.get("value").expect("a value");
            let whole = || value.as_integer().map(|own| own as f64);
            let size = value.as_float().or_else(whole);
            let size = size.filter(|size| *size != 0.0 && name != "g");
            if let Some(size) = size {
                let (unit, deviation) = (unit(parameter), TOLERANCE * size.abs());
                let _ = writeln!(
                    description,
                    "{name} = {{ value = {size:?}, unit = \"{unit}\", std = {deviation:?} }}"
                );
            }
        }
        description += "[channels]\n";
        for (name, coordinate) in part(&spec, "coordinates") {
            let unit = unit(coordinate);
            let _ = writeln!(
                description,
                "{name} = {{ measures = \"{name}\", unit = \"{unit}\", noise_std = {NOISE:?} }}"
            );
        }
        for (name, input) in part(&spec, "inputs") {
            let _ = writeln!(
                description,
                "{name} = {{ input = \"{name}\", unit = \"{}\" }}",
                unit(input)
            );
        }
        let (fit, test) = files.split_at(RUNS - 2);
        let _ = writeln!(
            description,
            "[runs]\nfit = [{}]\ntest = [{}]",
            fit.join(", "),
            test.join(", ")
        );
        folder.write("recording.toml", &description);
    }

    /// The spec with the friction.
    fn with_friction(&self, text: &str, spec: &DocumentMut) -> String {
        let coordinate = spec["coordinates"][self.coordinate]
            .as_table_like()
            .expect("a coordinate");
        let unit = match unit(coordinate) {
            "m" => "N*s/m",
            _ => "N*m*s/rad",
        };
        let (name, size) = (self.coordinate, self.size);
        format!(
            "{text}\n[parameters.planted]\nvalue = {size:?}\nunit = \"{unit}\"\n[loads.planted]\n\
             kind = \"generalized\"\ncoordinate = \"{name}\"\nforce = \"-planted*dot({name})\"\n"
        )
    }

    /// A recording of the coordinates and inputs of a run.
    fn run(&self, folder: &Folder, spec: &DocumentMut, noise: &mut Noise) -> String {
        let about = |name: &str| {
            let given = self.initial.iter().find(|(own, _)| *own == name);
            given.map(|(_, value)| *value)
        };
        let rates = part(spec, "pseudo_velocities").into_iter();
        let rates = rates.map(|(name, _)| (name, about(name).unwrap_or(0.0), noise.next()));
        let rates: Vec<(&str, f64, f64)> = rates.collect();
        let inputs = part(spec, "inputs");
        let waves: Vec<[[f64; 3]; 3]> = (inputs.iter())
            .map(|_| {
                [(); 3].map(|()| {
                    let size = self.drive * (0.5 + 0.5 * noise.uniform());
                    [size, 1.0 + 11.0 * noise.uniform(), 6.0 * noise.uniform()]
                })
            })
            .collect();
        // A shorter and weaker motion where the mechanism falls over.
        let stands = [1.0, 0.5, 0.25].into_iter().find(|calm| {
            let mut asked: Vec<String> = ["simulate", "planted.toml", "--csv", "full.csv"]
                .map(str::to_owned)
                .to_vec();
            let seconds = (calm * self.seconds).to_string();
            asked.extend([
                "--t-end-s".to_owned(),
                seconds,
                "--dt-s".to_owned(),
                STEP.to_string(),
            ]);
            for (name, mean, deviate) in &rates {
                let start = mean + calm * self.spread * deviate;
                asked.extend(["--initial".to_owned(), format!("{name}={start}")]);
            }
            for (name, _) in part(spec, "coordinates") {
                if let Some(start) = about(name) {
                    asked.extend(["--initial".to_owned(), format!("{name}={start}")]);
                }
            }
            for ((name, _), wave) in inputs.iter().zip(&waves) {
                let told = wave
                    .map(|[size, rate, phase]| format!("{}*sin({rate}*t + {phase})", calm * size));
                asked.extend(["--input".to_owned(), format!("{name}={}", told.join(" + "))]);
            }
            let asked: Vec<&str> = asked.iter().map(String::as_str).collect();
            folder.run(&asked).status == 0
        });
        let calm = stands.unwrap_or_else(|| panic!("{} falls over at once", self.mechanism));
        let full = folder.read("full.csv");
        let mut lines = full.lines().filter(|line| !line.starts_with('#'));
        let header: Vec<&str> = lines.next().expect("a header").split(',').collect();
        let column = |name: &str| {
            let of = |column: &&str| column.split(" [").next() == Some(name);
            header.iter().position(of).expect("a column")
        };
        let names: Vec<&str> = part(spec, "coordinates")
            .iter()
            .map(|(name, _)| *name)
            .collect();
        let columns: Vec<usize> = names.iter().map(|name| column(name)).collect();
        let time = column("t");
        let shown = names
            .iter()
            .copied()
            .chain(inputs.iter().map(|(name, _)| *name));
        let mut text = format!("t,{}\n", shown.collect::<Vec<_>>().join(","));
        for line in lines {
            let cells: Vec<f64> = line
                .split(',')
                .map(|cell| cell.parse().expect("a number"))
                .collect();
            let _ = write!(text, "{}", cells[time]);
            for &column in &columns {
                let _ = write!(text, ",{}", cells[column] + NOISE * noise.next());
            }
            // An input is held from row to row: as it is in the middle.
            let t = cells[time] + 0.5 * STEP;
            for wave in &waves {
                let value: f64 = wave
                    .iter()
                    .map(|[size, rate, phase]| calm * size * (rate * t + phase).sin())
                    .sum();
                let _ = write!(text, ",{value}");
            }
            text.push('\n');
        }
        text
    }
}
