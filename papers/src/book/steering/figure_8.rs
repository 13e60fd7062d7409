//! Figure 8: lane change and right turn, below and above the critical speed.

use appell_report::figure::{Figure, Panel, Series};
use appell_runtime::Trajectory;

use super::manoeuvres::{Path, Run, largest};
use crate::book::claim::{Claim, Picture, Section, Statement};
use crate::book::failed;
use appell::Error;

/// A run: manoeuvre, name of its law, final place and yaw angle to nine digits, largest force.
struct Wanted {
    name: &'static str,
    run: Run,
    law: &'static str,
    end: [f64; 3],
    force: f64,
}

const RUNS: [Wanted; 4] = [
    Wanted {
        name: "lane change at 1 m/s",
        run: Run::new(Path::lane(2.5), 1.0),
        law: "lane_change_1_m_s.toml",
        end: [9.187_490_87, -2.500_027_77, 8.8e-8],
        force: 3.015_02,
    },
    Wanted {
        name: "lane change at 5 m/s",
        run: Run::new(Path::lane(10.0), 5.0),
        law: "lane_change_5_m_s.toml",
        end: [47.511_097_4, -10.000_050_3, 2.5e-7],
        force: 10.350_25,
    },
    Wanted {
        name: "right turn at 1 m/s",
        run: Run::new(Path::TURN, 1.0),
        law: "right_turn_1_m_s.toml",
        end: [5.666_071_75, -5.408_815_31, -1.570_795_88],
        force: 1.158_82,
    },
    Wanted {
        name: "right turn at 5 m/s",
        run: Run::new(Path::TURN, 5.0),
        law: "right_turn_5_m_s.toml",
        end: [28.332_414_4, -27.113_357_3, -1.570_799_39],
        force: 16.7912,
    },
];

/// The four runs.
pub(super) fn section() -> Result<Section, Error> {
    let mut claims = Vec::new();
    let mut motions = Vec::new();
    for wanted in &RUNS {
        let (motion, ending) = wanted.run.motion(0.001)?;
        if let Some(reason) = ending {
            return Err(failed(&reason));
        }
        let command = format!(
            "appell simulate unicycle --feedback docs/examples/feedback/{} --reactions",
            wanted.law
        );
        follow(&mut claims, wanted, &motion, &command);
        motions.push(motion);
    }
    let pictures = [("Lane change", 0), ("Right turn by 90°", 2)].map(|(title, at)| {
        let [slow, fast] = [&motions[at], &motions[at + 1]];
        let path = RUNS[at].run.path;
        [
            Picture {
                svg: over_time(title, [slow, fast], path).to_svg(),
                caption: format!(
                    "{title}: tilt, place of the mass, yaw, force.{}",
                    if path.turn {
                        " Third line of the yaw: the desired one."
                    } else {
                        ""
                    }
                ),
            },
            Picture {
                svg: from_above(title, [slow, fast], RUNS[at].run).to_svg(),
                caption: format!("{title}: the wheel centre from above."),
            },
        ]
    });
    Ok(Section {
        title: "Figure 8: manoeuvres".to_owned(),
        about: "The nonlinear unicycle under u = −K (y − y_des) with the gains of tables II and III to all \
                digits, along the corrected paths (66) and (71), with an integrator of order eight."
            .to_owned(),
        claims,
        pictures: pictures.into_iter().flatten().collect(),
    })
}

fn follow(claims: &mut Vec<Claim>, wanted: &Wanted, motion: &Trajectory, command: &str) {
    let place = format!("figure 8, {}", wanted.name);
    let end = motion.last_state();
    let value = |name: &str| motion.info().state_index(name).map_or(f64::NAN, |i| end[i]);
    let found = [value("x_G"), value("y_G"), value("psi")];
    let off = found
        .iter()
        .zip(wanted.end)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max);
    let published = "the manoeuvre is carried out";
    let ours = format!(
        "after 10 s x_G = {:.8} m, y_G = {:.8} m, ψ = {:.8} rad; an independent computation differs by {off:.0e}",
        found[0], found[1], found[2]
    );
    claims.push(
        Statement {
            place: &place,
            published,
            command,
        }
        .found(ours, off < 1e-6),
    );
    let force = largest(motion, "u");
    let ours = format!("{force:.5} N");
    let as_known = (force - wanted.force).abs() < 1e-3;
    let claim = match (wanted.run.path.turn, force < 10.0) {
        (false, true) => Statement {
            place: &place,
            published: "|u| < 10 N",
            command,
        }
        .found(ours, as_known),
        (false, false) => Statement {
            place: &place,
            published: "|u| < 10 N",
            command,
        }
        .found(ours, as_known)
        .erratum("over-claim"),
        (true, _) => Statement {
            place: &place,
            published: "nothing on the force",
            command,
        }
        .found(ours, as_known)
        .added(),
    };
    claims.push(claim);
    let ours = format!(
        "the contact needs a coefficient of friction of {:.4}",
        largest(motion, "friction_demand_P")
    );
    let demand = largest(motion, "friction_demand_P");
    let claim = Statement {
        place: &place,
        published: "nothing on friction: the wheel rolls",
        command,
    }
    .found(ours, demand > 0.0 && demand < 0.3);
    claims.push(claim.added());
}

fn line(motion: &Trajectory, name: &str, label: String) -> Series {
    let y = motion.column_in_unit(name).unwrap_or_default();
    let y = if matches!(name, "theta" | "psi") {
        y.into_iter().map(f64::to_degrees).collect()
    } else {
        y
    };
    Series {
        label,
        x: motion.times().to_vec(),
        y,
    }
}

fn over_time(title: &str, [slow, fast]: [&Trajectory; 2], path: Path) -> Figure {
    let panel = |name: &str, letter: &str, unit: &str| {
        let mut series = vec![
            line(slow, name, format!("{letter} at 1 m/s")),
            line(fast, name, format!("{letter} at 5 m/s")),
        ];
        if path.turn && name == "psi" {
            series.push(Series {
                label: "desired".to_owned(),
                x: slow.times().to_vec(),
                y: slow
                    .times()
                    .iter()
                    .map(|t| path.at(*t).to_degrees())
                    .collect(),
            });
        }
        Panel {
            unit: unit.to_owned(),
            series,
        }
    };
    Figure {
        title: title.to_owned(),
        x_label: "t [s]".to_owned(),
        panels: vec![
            panel("theta", "ϑ", "deg"),
            panel("r", "r", "m"),
            panel("psi", "ψ", "deg"),
            panel("u", "u", "N"),
        ],
        marks: Vec::new(),
        equal_axes: false,
    }
}

fn from_above(title: &str, motions: [&Trajectory; 2], run: Run) -> Figure {
    let column = |motion: &Trajectory, name: &str| motion.column(name).unwrap_or_default();
    let mut series: Vec<Series> = motions
        .into_iter()
        .zip(["1 m/s", "5 m/s"])
        .map(|(motion, speed)| Series {
            label: format!("y_G at {speed}"),
            x: column(motion, "x_G"),
            y: column(motion, "y_G"),
        })
        .collect();
    if !run.path.turn {
        for ((motion, width), speed) in motions.into_iter().zip([2.5, 10.0]).zip(["1 m/s", "5 m/s"])
        {
            let path = Path::lane(width);
            series.push(Series {
                label: format!("desired at {speed}"),
                x: column(motion, "x_G"),
                y: motion.times().iter().map(|t| path.at(*t)).collect(),
            });
        }
    }
    Figure {
        title: title.to_owned(),
        x_label: "x_G [m]".to_owned(),
        panels: vec![Panel {
            unit: "m".to_owned(),
            series,
        }],
        marks: Vec::new(),
        equal_axes: true,
    }
}
