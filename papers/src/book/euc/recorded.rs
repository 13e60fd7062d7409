//! Rides as data sets for `appell diagnose`: channels of the planar model, and those of the spatial
//! one only.

use std::fmt::Write as _;
use std::path::Path;

use appell_models::Shipped;

use super::laboratory::{Laboratory, Session};
use super::random::Random;
use super::rider::{RATE, TWIST};
use crate::book::{failed, replaced};
use appell::Error;
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

/// Kind of a column.
#[derive(Clone, Copy)]
enum Kind {
    Way,
    Angle,
    Torque,
    /// An angle or torque that the planar model does not have.
    Beside,
    Unknown,
}

/// Columns with their units.
const COLUMNS: [(&str, Kind, &str); 10] = [
    ("x", Kind::Way, "m"),
    ("gamma", Kind::Angle, "rad"),
    ("phi", Kind::Angle, "rad"),
    ("M_d", Kind::Torque, "N*m"),
    ("M_h", Kind::Torque, "N*m"),
    ("psi", Kind::Beside, "rad"),
    ("theta", Kind::Beside, "rad"),
    ("beta", Kind::Beside, "rad"),
    ("M_r", Kind::Unknown, "N*m"),
    ("M_z", Kind::Unknown, "N*m"),
];

/// Writes all rides, a folder for each manoeuvre, and the spatial model as `spatial.toml`.
pub(super) fn write(laboratory: &Laboratory, folder: &Path) -> Result<(), Error> {
    files::make_folder(folder)?;
    files::write(&folder.join("spatial.toml"), &spatial()?)?;
    let mut sessions = laboratory.sessions.iter();
    sessions.try_for_each(|session| data_set(laboratory, session, folder))
}

/// The spatial model that can be compared with the planar one.
fn spatial() -> Result<String, Error> {
    let shipped = Shipped::find("euc_spatial");
    let shipped = shipped.ok_or_else(|| failed("the spatial model is not shipped"))?;
    let edits = TWIST.iter().chain(&WAY);
    edits
        .copied()
        .try_fold(shipped.spec.to_owned(), |text, (before, with)| {
            replaced(&text, before, with)
        })
}

/// Writes the rides of a manoeuvre; the last ones are held out.
fn data_set(laboratory: &Laboratory, session: &Session, folder: &Path) -> Result<(), Error> {
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
    for (name, kind, unit) in COLUMNS {
        let role = match kind {
            Kind::Way | Kind::Angle => format!("measures = {name:?}, "),
            Kind::Torque => format!("input = {name:?}, "),
            Kind::Beside | Kind::Unknown => String::new(),
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
    let truth = COLUMNS.map(|(name, _, _)| match name {
        "x" => way(&column("v")),
        name => column(name),
    });
    let mut text = String::from("t");
    for (name, _, _) in COLUMNS {
        let _ = write!(text, ",{name}");
    }
    text.push('\n');
    let rows = session.manoeuvre.steady_from()..motion.len() - EVERY;
    for row in rows.step_by(EVERY) {
        // Writing to a string cannot fail.
        let _ = write!(text, "{:.6}", motion.times()[row]);
        for ((_, kind, _), values) in COLUMNS.iter().zip(&truth) {
            let value = match kind {
                Kind::Torque | Kind::Unknown => mean(&values[row..=row + EVERY]),
                Kind::Way => values[row] + WAY_NOISE * random.normal(),
                Kind::Angle | Kind::Beside => values[row] + ANGLE_NOISE * random.normal(),
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
