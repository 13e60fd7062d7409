//! Tables 1 to 3.

use appell_models::Shipped;

use super::laboratory::Laboratory;
use super::rider::Manoeuvre;
use crate::book::claim::{NOT_PUBLIC, Section, Statement};
use crate::book::failed;
use appell::Error;

/// Abbreviations of table 2.
const BODIES: [&str; 14] = [
    "H", "CHR", "CHL", "UAR", "UAL", "LAR", "LAL", "HR", "HL", "TR", "TL", "LR", "LL", "E",
];

/// Values of table 3 in SI. The height is to be identified.
const PARAMETERS: [(&str, f64); 9] = [
    ("R", 0.2),
    ("m", 65.0),
    ("m_0", 13.0),
    ("m_w", 3.0),
    ("J", 16.6),
    ("J_w", 0.12),
    ("J_0", 0.5),
    ("h_0", 0.075),
    ("l_0", 0.05),
];

pub(super) fn section(laboratory: &Laboratory) -> Result<Section, Error> {
    let runs: Vec<String> = Manoeuvre::ALL
        .iter()
        .map(|manoeuvre| format!("{} {}", manoeuvre.name(), manoeuvre.runs()))
        .collect();
    let recordings = Statement {
        place: "table 1",
        published: "34 recordings of 8 manoeuvres by two riders",
        command: "appell reproduce euc",
    }
    .found(format!("simulated runs: {}", runs.join(", ")), true);
    let skeleton = &laboratory.skeleton;
    let all = BODIES.iter().all(|body| skeleton.body(body).is_some());
    let bodies = Statement {
        place: "table 2",
        published: "rigid bodies with pivots: head, chest, arms, hips, legs, EUC",
        command: "appell motion docs/examples/euc/skeleton.toml ride.csv",
    }
    .found(
        format!("the skeleton has the same {} bodies", skeleton.bodies.len()),
        all && skeleton.bodies.len() == BODIES.len(),
    );
    let mass = Statement {
        place: "section 2",
        published: "segment masses by Ramachandran et al. (2016), scaled to the rider's mass",
        command: "appell motion docs/examples/euc/skeleton.toml ride.csv",
    }
    .found(
        format!(
            "another published table: {}; the rider weighs {} kg",
            skeleton.rider.table.source, skeleton.rider.mass
        ),
        true,
    );
    let shipped = Shipped::find("euc_3dof");
    let info = shipped
        .ok_or_else(|| failed("the planar model is not shipped"))?
        .model
        .info();
    let mut claims = vec![
        recordings.unchecked(NOT_PUBLIC),
        bodies.exactly(),
        mass.added(),
    ];
    for (name, printed) in PARAMETERS {
        let index = info.parameter_index(name);
        let value = index.map_or(f64::NAN, |index| info.parameters[index].value);
        let published = format!("{name} = {printed}");
        let command = "appell check euc_3dof";
        claims.push(
            Statement {
                place: "table 3",
                published: &published,
                command,
            }
            .number([printed, value], 15),
        );
    }
    Ok(Section {
        title: "Tables".to_owned(),
        about: "What was recorded, what was captured, and the parameters that the paper takes as known.".to_owned(),
        claims,
        pictures: Vec::new(),
    })
}
