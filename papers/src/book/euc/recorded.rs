//! Rides as data sets for `appell diagnose`: channels of the planar model, and those of the spatial
//! one only.

use std::fmt::Write as _;
use std::path::Path;

use super::capture::Random;
use super::laboratory::{Laboratory, Session};
use super::rider::{RATE, SPATIAL, TWIST};
use crate::book::{Result, edited, shipped};
use appell::files;

/// Frames between rows.
const EVERY: usize = 3;
/// The distance x is a quantity of the planar model, added to the spatial one for the comparison.
const WAY: [(&str, &str); 3] = [
    ("name   = \"euc_spatial\"", "name   = \"spatial\""),
    (
        "[inputs]",
        "x     = { unit = \"m\",   about = \"way of the wheel centre\" }\n\n[inputs]",
    ),
    (
        "[pseudo_velocities]",
        "way = { kind = \"velocity\", zero = \"dot(x) - R*(dot(psi)*sin(theta) + dot(chi))\", about = \"the way grows with the forward velocity\" }\n\n[pseudo_velocities]",
    ),
];
/// Priors of the rider: name, standard deviation.
const TOLERANCES: [(&str, f64); 4] = [("m", 0.5), ("m_0", 0.1), ("J", 0.5), ("h", 0.01)];
/// Noise of the odometer in m, of the inertial units in rad.
const WAY_NOISE: f64 = 1e-3;
const ANGLE_NOISE: f64 = 2e-3;

/// Columns: name, key of its role in the planar model, noise, and unit. Torques have none.
const COLUMNS: [(&str, &str, Option<f64>, &str); 10] = [
    ("x", "measures", Some(WAY_NOISE), "m"),
    ("gamma", "measures", Some(ANGLE_NOISE), "rad"),
    ("phi", "measures", Some(ANGLE_NOISE), "rad"),
    ("M_d", "input", None, "N*m"),
    ("M_h", "input", None, "N*m"),
    ("psi", "", Some(ANGLE_NOISE), "rad"),
    ("theta", "", Some(ANGLE_NOISE), "rad"),
    ("beta", "", Some(ANGLE_NOISE), "rad"),
    ("M_r", "", None, "N*m"),
    ("M_z", "", None, "N*m"),
];

/// Writes all rides, a folder for each manoeuvre, and the spatial model as `spatial.toml`.
pub(super) fn write(laboratory: &Laboratory, folder: &Path) -> Result<()> {
    files::make_folder(folder)?;
    // The spatial model that can be compared with the planar one.
    let spatial = edited(shipped(SPATIAL)?.spec, TWIST.iter().chain(&WAY))?;
    files::write(&folder.join("spatial.toml"), &spatial)?;
    let mut sessions = laboratory.sessions.iter();
    sessions.try_for_each(|session| data_set(laboratory, session, folder))
}

/// Writes the rides of a manoeuvre; the last ones are held out.
fn data_set(laboratory: &Laboratory, session: &Session, folder: &Path) -> Result<()> {
    let name = session.manoeuvre.name();
    let folder = folder.join(name.replace([' ', '-'], "_"));
    files::make_folder(&folder)?;
    let mut runs = Vec::new();
    for number in 0..session.motions.len() {
        let file = format!("ride_{}.csv", number + 1);
        files::write(&folder.join(&file), &table(session, number))?;
        runs.push(file);
    }
    let test = runs.split_off(runs.len() - (runs.len() / 3).max(1));
    let mut text = format!(
        "mechanism   = \"euc_3dof\"\ndescription = \"simulated rides, {name}\"\n\n[parameters]\n"
    );
    // Writing to a string cannot fail.
    for (name, std) in TOLERANCES {
        let (value, unit) = laboratory.stated(name)?;
        let _ = writeln!(
            text,
            "{name} = {{ value = {value}, unit = {unit:?}, std = {std} }}"
        );
    }
    text.push_str("\n[channels]\n");
    for (name, key, _, unit) in COLUMNS {
        let role = match key {
            "" => String::new(),
            key => format!("{key} = {name:?}, "),
        };
        let _ = writeln!(text, "{name} = {{ {role}unit = {unit:?} }}");
    }
    let _ = write!(text, "\n[runs]\nfit = {runs:?}\ntest = {test:?}\n");
    files::write(&folder.join("recording.toml"), &text)
}

/// A run: distance from an odometer, angles from inertial units, torques averaged from row to row.
fn table(session: &Session, number: usize) -> String {
    let motion = &session.motions[number];
    let mut random = Random::of(&format!("recording {} {number}", session.manoeuvre.name()));
    let column = |name: &str| motion.column(name).unwrap_or_default();
    let truth = COLUMNS.map(|(name, ..)| match name {
        "x" => way(&column("v")),
        name => column(name),
    });
    let mut text = format!("t,{}\n", COLUMNS.map(|(name, ..)| name).join(","));
    let rows = session.manoeuvre.steady_from()..motion.len() - EVERY;
    for row in rows.step_by(EVERY) {
        // Writing to a string cannot fail.
        let _ = write!(text, "{:.6}", motion.times()[row]);
        for ((_, _, noise, _), values) in COLUMNS.iter().zip(&truth) {
            let value = match noise {
                None => mean(&values[row..=row + EVERY]),
                Some(noise) => values[row] + noise * random.normal(),
            };
            let _ = write!(text, ",{value:.6}");
        }
        text.push('\n');
    }
    text
}

/// The mean between the first and the last of some samples.
fn mean(samples: &[f64]) -> f64 {
    let ends = 0.5 * (samples[0] + samples[samples.len() - 1]);
    (samples.iter().sum::<f64>() - ends) / (samples.len() - 1) as f64
}

/// The integral of a velocity.
fn way(velocity: &[f64]) -> Vec<f64> {
    let mut way = vec![0.0];
    for pair in velocity.windows(2) {
        way.push(way[way.len() - 1] + 0.5 * (pair[0] + pair[1]) / RATE);
    }
    way
}
