//! Figure 5: all steady motions of the unicycle.

use appell_analysis::{Cell, Chart, Point};
use appell_report::figure::{Curve, Map, Series, Stroke};

use crate::book::claim::{Claim, Picture, Section, Statement, digits};
use crate::book::computation;
use crate::book::steady_motions::{
    GRAVITY, Mechanism, RADIUS, SLIDER_MASS, WHEEL_MASS, cell_point, shown,
};
use appell::Error;

/// Largest tilt that is drawn, in degrees.
const TILT_DEG: f64 = 60.0;
/// Largest yaw rate that is drawn, in rad/s.
const YAW: f64 = 10.0;
const COMMAND: &str =
    "appell stability unicycle --chart theta=-60deg..60deg,psi_dot=-10..10 --require 'z_A>=0'";

/// Kinds of cells: the feasible motions by the place of the mass, and the others. They are indices
/// of colours.
const MASS_BELOW: usize = 0;
const INFEASIBLE: usize = 3;
const MASS_ABOVE: usize = 5;
/// Their names.
const KINDS: [&str; 6] = [
    "mass below the centre",
    "",
    "",
    "not feasible: z_A ≤ 0",
    "",
    "mass above the centre",
];
/// Axes of the map.
const AXES: [&str; 2] = ["theta", "psi_dot"];

/// The map, and the statements about it.
pub(super) fn section(grid: usize) -> Result<Section, Error> {
    let unicycle = Mechanism::shipped("unicycle")?;
    let tilt = TILT_DEG.to_radians();
    let axes = [
        ("theta", [-tilt, tilt], grid),
        ("psi_dot", [-YAW, YAW], grid),
    ];
    let chart = unicycle.chart(&[], axes, &[("z_A", 0.0)])?;
    let cells = kinds(unicycle, &chart)?;
    let mut claims = Vec::new();
    upright_turning(&mut claims, unicycle)?;
    straight_rolling(&mut claims, unicycle)?;
    tilted_spinning(&mut claims, unicycle)?;
    areas(&mut claims, &cells);
    claims.push(turning(unicycle, &chart)?);
    let caption = "Turning motions by tilt and yaw rate. Blue: feasible, the mass below (light) or above (dark) \
                   the wheel centre; grey: it would be at or below the ground. The paper leaves that area white.";
    let mut curves = special_motions(unicycle)?;
    curves.extend(edges(&chart));
    let map = Map {
        title: "Steady motions of the unicycle".to_owned(),
        labels: AXES.map(|name| shown(name).label),
        ranges: [[-TILT_DEG, TILT_DEG], [-YAW, YAW]],
        counts: [grid; 2],
        kinds: KINDS.map(str::to_owned).to_vec(),
        cells,
        curves,
    };
    Ok(Section {
        title: "Figure 5: steady motions of the unicycle".to_owned(),
        about: "Without force on the mass, with the numbers of table I.".to_owned(),
        claims,
        pictures: vec![Picture {
            svg: map.to_svg(),
            caption: caption.to_owned(),
        }],
    })
}

/// Yaw rate of non-tilted turning, (44).
fn upright_rate() -> f64 {
    (2.0 * SLIDER_MASS * GRAVITY / (3.0 * WHEEL_MASS * RADIUS)).sqrt()
}

/// Spinning, tilted spinning, straight rolling and non-tilted turning.
fn special_motions(unicycle: Mechanism) -> Result<Vec<Curve>, Error> {
    let mut tilted = Vec::new();
    for sign in [-1.0, 1.0] {
        let range = [sign * 0.5, sign * YAW];
        let branches = unicycle.branches(&[("phi_dot", 0.0)], "psi_dot", range)?;
        tilted.extend(unicycle.curves(&branches, AXES, Stroke::Dashed)?);
    }
    if let Some(first) = tilted.first_mut() {
        "tilted spinning".clone_into(&mut first.line.label);
    }
    let curve = |label, tilt, yaw, stroke| Curve {
        line: series(label, tilt, yaw),
        stroke,
    };
    let spinning = curve("spinning", vec![0.0; 2], vec![-YAW, YAW], Stroke::Solid);
    let rolling = curve("straight rolling", vec![0.0], vec![0.0], Stroke::Squares);
    let rate = upright_rate();
    let turning = curve(
        "non-tilted turning",
        vec![0.0; 2],
        vec![-rate, rate],
        Stroke::Discs,
    );
    let mut curves = vec![spinning];
    curves.extend(tilted);
    curves.extend([rolling, turning]);
    Ok(curves)
}

/// The edges of the areas.
fn edges(chart: &Chart) -> impl Iterator<Item = Curve> {
    let [tilt, yaw] = AXES.map(|name| shown(name).scale);
    chart.edges.iter().map(move |edge| Curve {
        line: series(
            "",
            edge.points.iter().map(|at| at[0] * tilt).collect(),
            edge.points.iter().map(|at| at[1] * yaw).collect(),
        ),
        stroke: Stroke::Thin,
    })
}

fn series(label: &str, x: Vec<f64>, y: Vec<f64>) -> Series {
    Series {
        label: label.to_owned(),
        x,
        y,
    }
}

/// The kind of each cell of a chart; `None` without a motion.
fn kinds(unicycle: Mechanism, chart: &Chart) -> Result<Vec<Option<usize>>, Error> {
    let base = Point::initial(unicycle.0);
    let kind = |cell: &Cell| -> Result<usize, Error> {
        let point = cell_point(chart, &cell.unknowns, &base);
        let [mass, tilt] = ["z_A", "theta"].map(|name| unicycle.value(name, &point));
        let (mass, centre) = (mass?, RADIUS * tilt?.cos());
        Ok(if mass <= 0.0 {
            INFEASIBLE
        } else if mass < centre {
            MASS_BELOW
        } else {
            MASS_ABOVE
        })
    };
    let first = |cells: &Vec<Cell>| cells.first().map(&kind).transpose();
    chart.cells.iter().map(first).collect()
}

/// (44): turning without tilt.
fn upright_turning(claims: &mut Vec<Claim>, unicycle: Mechanism) -> Result<(), Error> {
    let command = "appell steady unicycle --fix theta=0 --fix r=0.1";
    let problem = unicycle.problem(&[("theta", 0.0), ("r", 0.1)])?;
    let motions = problem.solve_isolated(60).map_err(computation)?;
    let value = |name: &str| -> Result<Vec<f64>, Error> {
        motions
            .iter()
            .map(|motion| unicycle.value(name, &motion.point))
            .collect()
    };
    let (yaw, pitch) = (value("psi_dot")?, value("phi_dot")?);
    let rate = upright_rate();
    let agree = yaw.iter().map(|yaw| digits(rate, yaw.abs()));
    let agree = agree.min().unwrap_or(0);
    let statement = Statement {
        place: "figure 5, (44)",
        published: "non-tilted turning at ψ̇₁,₂ = ±√(2 m₀ g/(3 m R)) only, black dots",
        command,
    };
    let ours = format!("{yaw:?} rad/s, in {agree} digits");
    claims.push(statement.found(ours, agree >= 10 && yaw.len() == 2));

    let pairs = yaw.iter().zip(&pitch);
    let agree = pairs.map(|(yaw, pitch)| digits(yaw * 0.1 / RADIUS, *pitch));
    let agree = agree.min().unwrap_or(0);
    let statement = Statement {
        place: "(44)",
        published: "there φ̇ = ψ̇ r/R, here for r = 0.1 m",
        command,
    };
    let ours = format!("{pitch:?} rad/s, in {agree} digits");
    claims.push(statement.found(ours, agree >= 10));
    Ok(())
}

/// (43): straight rolling.
fn straight_rolling(claims: &mut Vec<Claim>, unicycle: Mechanism) -> Result<(), Error> {
    let problem = unicycle.problem(&[("psi_dot", 0.0), ("speed", 2.0)])?;
    let motions = problem.solve_isolated(60).map_err(computation)?;
    let vanishes = |name: &str| {
        motions
            .iter()
            .all(|m| unicycle.value(name, &m.point).is_ok_and(|v| v.abs() < 1e-9))
    };
    let statement = Statement {
        place: "figure 5, (43)",
        published: "straight rolling: ϑ = 0, r = 0, any pitch rate, black square",
        command: "appell steady unicycle --fix psi_dot=0 --fix speed=2",
    };
    let ours = format!(
        "{} motion at ψ̇ = 0 and 2 m/s, upright and with the mass in the middle",
        motions.len()
    );
    let holds = motions.len() == 1 && vanishes("theta") && vanishes("r");
    claims.push(statement.found(ours, holds));
    Ok(())
}

/// (46): spinning on the spot, along the tilted branch.
fn tilted_spinning(claims: &mut Vec<Claim>, unicycle: Mechanism) -> Result<(), Error> {
    /// Below it in rad, a point is on the upright branch.
    const UPRIGHT: f64 = 0.01;
    let branches = unicycle.branches(&[("phi_dot", 0.0)], "psi_dot", [0.5, YAW])?;
    let (mut agree, mut tilted, mut upright, mut above) = (15, 0, 0, true);
    for at in branches.iter().flat_map(|branch| &branch.points) {
        let [tilt, r] = ["theta", "r"].map(|name| unicycle.value(name, &at.point));
        let (tilt, r) = (tilt?, r?);
        if tilt.abs() < UPRIGHT {
            upright += 1;
            continue;
        }
        agree = agree.min(digits(place_in_spinning(tilt), r));
        above &= r * tilt > 0.0;
        tilted += 1;
    }
    let command = "appell steady unicycle --fix phi_dot=0 --along psi_dot=0.5..10";
    let statement = Statement {
        place: "figure 5, dashed and solid",
        published: "tilted spinning lies on the curves (46), dashed lines; upright spinning on ϑ = 0",
        command,
    };
    let ours = format!("{tilted} tilted points in {agree} digits, {upright} upright ones");
    claims.push(statement.found(ours, agree >= 9 && tilted > 20 && upright > 20));
    let statement = Statement {
        place: "figure 5, (46)",
        published: "on the dashed lines the mass is above the centre",
        command,
    };
    let ours = format!("r ϑ > 0 at all {tilted} points: {above}");
    claims.push(statement.found(ours, above && tilted > 0));
    Ok(())
}

/// The coloured areas.
fn areas(claims: &mut Vec<Claim>, cells: &[Option<usize>]) {
    for (kind, place, published) in [
        (
            MASS_BELOW,
            "figure 5, light blue",
            "feasible motions with the mass below the wheel centre, 0 < z_A < z_G",
        ),
        (
            MASS_ABOVE,
            "figure 5, light purple",
            "feasible motions with the mass above the wheel centre, z_A > z_G",
        ),
        (
            INFEASIBLE,
            "figure 5, white",
            "motions that are not feasible, z_A ≤ 0",
        ),
    ] {
        let count = cells.iter().filter(|cell| **cell == Some(kind)).count();
        let statement = Statement {
            place,
            published,
            command: COMMAND,
        };
        let ours = format!("{count} of {} grid points", cells.len());
        claims.push(statement.found(ours, count > 0));
    }
}

/// Every motion against (41).
fn turning(unicycle: Mechanism, chart: &Chart) -> Result<Claim, Error> {
    let base = Point::initial(unicycle.0);
    let mut worst: f64 = 0.0;
    for cell in chart.cells.iter().flatten() {
        let point = cell_point(chart, &cell.unknowns, &base);
        let [tilt, yaw, r] = ["theta", "psi_dot", "r"].map(|name| unicycle.value(name, &point));
        let wanted = place_of_mass(SLIDER_MASS, tilt?, yaw?);
        worst = worst.max((r? - wanted).abs() / wanted.abs().max(1.0));
    }
    let found = chart.cells.iter().flatten().count();
    let statement = Statement {
        place: "figure 5, (41)",
        published: "every tilt and yaw rate has one turning motion, with r by (41)",
        command: COMMAND,
    };
    let ours = format!("{found} motions, each within {worst:.0e} of (41)");
    let holds = worst < 1e-6 && found * 100 > chart.cells.len() * 98;
    Ok(statement.found(ours, holds))
}

/// (46): place of the mass in tilted spinning, with the numbers of table I.
pub(super) fn place_in_spinning(tilt: f64) -> f64 {
    let (m, m0, c) = (WHEEL_MASS, SLIDER_MASS, tilt.cos());
    let root = (m * m * c.powi(4) + 3.0 * m * m0 * c * c + m0 * m0).sqrt();
    RADIUS * tilt.tan() / (2.0 * m0) * (m * c * c + m0 + root)
}

/// (41) with the numbers of table I except for the sliding mass.
pub(super) fn place_of_mass(m0: f64, tilt: f64, yaw: f64) -> f64 {
    let (s, c, m) = (tilt.sin(), tilt.cos(), WHEEL_MASS);
    m * RADIUS * (yaw * yaw * RADIUS * c + 2.0 * GRAVITY) * s * c
        / (6.0 * yaw * yaw * m * RADIUS * c.powi(3) - 4.0 * m0 * GRAVITY)
}
