//! Tables 1 to 3, and every numbered equation.

use appell_recordings::motion_capture::Axes;

use super::laboratory::Laboratory;
use super::rider::Manoeuvre;
use crate::book::equations::{misprint, typed};
use crate::book::{Part, Result, Section, shipped};
use crate::errata::{ERRATA, Source};
use crate::euc::EQUATIONS;

/// Abbreviations of table 2.
const BODIES: [&str; 14] = [
    "H", "CHR", "CHL", "UAR", "UAL", "LAR", "LAL", "HR", "HL", "TR", "TL", "LR", "LL", "E",
];

pub(super) fn section(laboratory: &Laboratory) -> Result<Section> {
    let mut part = Part::read(include_str!("tables.toml"))?;
    let runs = |manoeuvre: &Manoeuvre| format!("{} {}", manoeuvre.name(), manoeuvre.runs());
    let runs: Vec<String> = Manoeuvre::ALL.iter().map(runs).collect();
    let ours = format!("simulated runs: {}", runs.join(", "));
    part.found("recordings", ours, true)?;

    let skeleton = &laboratory.skeleton;
    let count = skeleton.bodies.len();
    let all = BODIES.iter().all(|body| skeleton.body(body).is_some());
    let ours = format!("the skeleton has the same {count} bodies");
    part.found("bodies", ours, all && count == BODIES.len())?;

    let rider = &skeleton.rider;
    let ours = format!(
        "another published table: {}; the rider weighs {} kg",
        rider.table.source, rider.mass
    );
    part.found("mass", ours, true)?;

    part.parameters(shipped("euc_3dof")?.model.info())?;
    Ok(part.section())
}

/// Rounding of products of sines and cosines.
const ROUNDING: f64 = 1e-14;

pub(super) fn equations(_: &Laboratory) -> Result<Section> {
    let mut part = Part::read(include_str!("equations.toml"))?;
    let off = transformations();
    let ours = format!("the axes of the moving frame differ by {off:.0e}");
    part.found("transformations", ours, off < ROUNDING)?;
    part.define("put to use in");
    part.claims.extend(EQUATIONS.iter().map(typed));
    let errata = ERRATA
        .iter()
        .filter(|erratum| erratum.source == Source::Euc);
    part.claims.extend(errata.map(misprint));
    Ok(part.section())
}

/// (1) and (2), compared with the axes that the pipeline uses.
fn transformations() -> f64 {
    let (psi, theta): (f64, f64) = (0.7, -0.3);
    let (s, c, u, d) = (psi.sin(), psi.cos(), theta.sin(), theta.cos());
    // T_ψ T_ϑ, column by column.
    let typed = [[c, s, 0.0], [-s * d, c * d, u], [s * u, -c * u, d]];
    let axes = Axes::turned([psi, theta, 0.0]);
    let used = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|unit| axes.to_ground(unit));
    let pairs = used.as_flattened().iter().zip(typed.as_flattened());
    pairs
        .map(|(used, typed)| (used - typed).abs())
        .fold(0.0, f64::max)
}
