//! Figure 8: lane change and right turn, below and above the critical speed.

use appell_report::figure::{Figure, Panel, Series};
use appell_runtime::Trajectory;

use super::manoeuvres::{Path, Run, largest};
use crate::book::steady_motions::degrees;
use crate::book::{Part, Result, Section, failed, line, paths};

/// A run: manoeuvre, final place and yaw angle to nine digits, largest force.
struct Wanted {
    run: Run,
    end: [f64; 3],
    force: f64,
}

const RUNS: [Wanted; 4] = [
    Wanted {
        run: Run::new(Path::lane(2.5), 1.0),
        end: [9.187_490_87, -2.500_027_77, 8.8e-8],
        force: 3.015_02,
    },
    Wanted {
        run: Run::new(Path::lane(10.0), 5.0),
        end: [47.511_097_4, -10.000_050_3, 2.5e-7],
        force: 10.350_25,
    },
    Wanted {
        run: Run::new(Path::TURN, 1.0),
        end: [5.666_071_75, -5.408_815_31, -1.570_795_88],
        force: 1.158_82,
    },
    Wanted {
        run: Run::new(Path::TURN, 5.0),
        end: [28.332_414_4, -27.113_357_3, -1.570_799_39],
        force: 16.7912,
    },
];

/// A run with its motion.
type Ridden = (&'static Run, Trajectory);

/// The four runs.
pub(super) fn section(_: usize) -> Result<Section> {
    let mut part = Part::read(include_str!("figure_8.toml"))?;
    let mut ridden: Vec<Ridden> = Vec::new();
    for wanted in &RUNS {
        let (motion, ending) = wanted.run.motion(0.001)?;
        if let Some(reason) = ending {
            return Err(failed(&reason));
        }
        let names = if wanted.run.path.turn {
            ["right turn", "right_turn"]
        } else {
            ["lane change", "lane_change"]
        };
        part.set("manoeuvre", names[0]);
        part.set("law", names[1]);
        part.set("speed", wanted.run.speed);
        follow(&mut part, wanted, &motion)?;
        ridden.push((&wanted.run, motion));
    }
    let titles = ["Lane change", "Right turn by 90°"];
    for (title, pair) in titles.into_iter().zip(ridden.chunks(2)) {
        part.set("title", title);
        let caption = if pair.iter().any(|(run, _)| run.path.turn) {
            "over_time_of_turn"
        } else {
            "over_time"
        };
        part.picture(caption, over_time(title, pair).to_svg())?;
        part.picture("from_above", from_above(title, pair).to_svg())?;
    }
    Ok(part.section())
}

fn follow(part: &mut Part, wanted: &Wanted, motion: &Trajectory) -> Result<()> {
    let end = motion.last_state();
    let found = ["x_G", "y_G", "psi"]
        .map(|name| motion.info().state_index(name).map_or(f64::NAN, |i| end[i]));
    let off = found.iter().zip(wanted.end).map(|(a, b)| (a - b).abs());
    let off = off.fold(0.0, f64::max);
    let ours = format!(
        "after 10 s x_G = {:.8} m, y_G = {:.8} m, ψ = {:.8} rad; an independent computation differs by {off:.0e}",
        found[0], found[1], found[2]
    );
    part.found("carried_out", ours, off < 1e-6)?;
    let force = largest(motion, "u");
    let key = match (wanted.run.path.turn, force < 10.0) {
        (false, true) => "force",
        (false, false) => "larger_force",
        (true, _) => "force_of_turn",
    };
    let as_known = (force - wanted.force).abs() < 1e-3;
    part.found(key, format!("{force:.5} N"), as_known)?;
    let demand = largest(motion, "friction_demand_P");
    let ours = format!("the contact needs a coefficient of friction of {demand:.4}");
    part.found("friction", ours, demand > 0.0 && demand < 0.3)
}

fn over_time(title: &str, pair: &[Ridden]) -> Figure {
    let over = |name: &str, letter: &str, unit: &str| {
        let mut series: Vec<Series> = Vec::new();
        for (run, motion) in pair {
            let label = format!("{letter} at {} m/s", run.speed);
            let y = motion.column_in_unit(name).unwrap_or_default();
            series.push(line(&label, motion.times().to_vec(), degrees(name, y)));
        }
        if let Some((run, motion)) = pair.first()
            && run.path.turn
            && name == "psi"
        {
            let desired = run.path.along(motion);
            series.push(line(
                "desired",
                motion.times().to_vec(),
                degrees(name, desired),
            ));
        }
        Panel::new(unit, series)
    };
    let panels = vec![
        over("theta", "ϑ", "deg"),
        over("r", "r", "m"),
        over("psi", "ψ", "deg"),
        over("u", "u", "N"),
    ];
    Figure::new(title, "t [s]", panels)
}

fn from_above(title: &str, pair: &[Ridden]) -> Figure {
    let column = |motion: &Trajectory, name: &str| motion.column(name).unwrap_or_default();
    let mut series: Vec<Series> = Vec::new();
    for (run, motion) in pair {
        let label = format!("y_G at {} m/s", run.speed);
        series.push(line(&label, column(motion, "x_G"), column(motion, "y_G")));
    }
    for (run, motion) in pair.iter().filter(|(run, _)| !run.path.turn) {
        let label = format!("desired at {} m/s", run.speed);
        series.push(line(&label, column(motion, "x_G"), run.path.along(motion)));
    }
    paths(title, "x_G [m]", series)
}
