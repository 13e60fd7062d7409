//! Tables 1 to 3.

use super::laboratory::Laboratory;
use super::rider::Manoeuvre;
use crate::book::{Part, Result, Section, shipped};

/// Abbreviations of table 2.
const BODIES: [&str; 14] = [
    "H", "CHR", "CHL", "UAR", "UAL", "LAR", "LAL", "HR", "HL", "TR", "TL", "LR", "LL", "E",
];

/// Values of table 3 in SI. The height is to be identified.
const PARAMETERS: [(&str, &str, f64); 9] = [
    ("R", "", 0.2),
    ("m", "", 65.0),
    ("m_0", "", 13.0),
    ("m_w", "", 3.0),
    ("J", "", 16.6),
    ("J_w", "", 0.12),
    ("J_0", "", 0.5),
    ("h_0", "", 0.075),
    ("l_0", "", 0.05),
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

    part.parameters(shipped("euc_3dof")?.model.info(), &PARAMETERS)?;
    Ok(part.section())
}
