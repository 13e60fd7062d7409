//! Figure 5: all steady motions of the unicycle.

use appell_analysis::{Cell, Chart, Point};
use appell_report::figure::{Curve, Map, Series, Stroke};

use crate::book::claim::{Claim, Picture, Section, digits};
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
    "appell stability unicycle --chart theta=-60deg..60deg,psi_dot=-10..10 --require z_A>=0";

/// The map, and the statements about it.
pub(super) fn section(grid: usize) -> Result<Section, Error> {
    let unicycle = Mechanism::shipped("unicycle")?;
    let tilt = TILT_DEG.to_radians();
    let axes = [
        ("theta", [-tilt, tilt], grid),
        ("psi_dot", [-YAW, YAW], grid),
    ];
    let chart = unicycle.chart(&[], axes, &[("z_A", 0.0)])?;
    let upright = (2.0 * SLIDER_MASS * GRAVITY / (3.0 * WHEEL_MASS * RADIUS)).sqrt();

    let mut curves = vec![Curve {
        line: series("spinning", vec![0.0, 0.0], vec![-YAW, YAW]),
        stroke: Stroke::Solid,
    }];
    for sign in [-1.0, 1.0] {
        let range = [sign * 0.5, sign * YAW];
        let branches = unicycle.branches(&[("phi_dot", 0.0)], "psi_dot", range)?;
        curves.extend(unicycle.curves(&branches, ["theta", "psi_dot"], Stroke::Dashed)?);
    }
    if let Some(tilted) = curves.get_mut(1) {
        "tilted spinning".clone_into(&mut tilted.line.label);
    }
    curves.push(Curve {
        line: series("straight rolling", vec![0.0], vec![0.0]),
        stroke: Stroke::Squares,
    });
    curves.push(Curve {
        line: series("non-tilted turning", vec![0.0; 2], vec![-upright, upright]),
        stroke: Stroke::Discs,
    });

    let names = ["theta", "psi_dot"].map(shown);
    curves.extend(chart.edges.iter().map(|edge| {
        Curve {
            line: series(
                "",
                edge.points
                    .iter()
                    .map(|at| at[0] * names[0].scale)
                    .collect(),
                edge.points.iter().map(|at| at[1]).collect(),
            ),
            stroke: Stroke::Thin,
        }
    }));
    let heights = Heights::new(unicycle);
    let kind = |cells: &Vec<Cell>| {
        let first = cells.first().map(|cell| heights.kind(&chart, cell));
        first.transpose()
    };
    let cells: Vec<Option<usize>> = chart.cells.iter().map(kind).collect::<Result<_, _>>()?;
    let mut claims = Vec::new();
    non_generic(&mut claims, unicycle, upright)?;
    areas(&mut claims, unicycle, &chart, &cells)?;
    let map = Map {
        title: "Steady motions of the unicycle".to_owned(),
        labels: names.map(|name| name.label),
        ranges: [[-TILT_DEG, TILT_DEG], [-YAW, YAW]],
        counts: [grid; 2],
        kinds: [
            "mass below the centre",
            "",
            "",
            "not feasible: z_A ≤ 0",
            "",
            "mass above the centre",
        ]
        .map(str::to_owned)
        .to_vec(),
        cells,
        curves,
    };
    let caption = "Turning motions by tilt and yaw rate. Blue: feasible, the mass below (light) or above (dark) \
                   the wheel centre; grey: it would be at or below the ground. The paper leaves that area white.";
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

fn series(label: &str, x: Vec<f64>, y: Vec<f64>) -> Series {
    Series {
        label: label.to_owned(),
        x,
        y,
    }
}

/// Position of the mass in the cells of a chart.
struct Heights {
    unicycle: Mechanism,
    base: Point,
}

impl Heights {
    fn new(unicycle: Mechanism) -> Self {
        let base = Point::initial(unicycle.0);
        Self { unicycle, base }
    }

    fn kind(&self, chart: &Chart, cell: &Cell) -> Result<usize, Error> {
        let point = cell_point(chart, &cell.unknowns, &self.base);
        let [mass, tilt] = ["z_A", "theta"].map(|name| self.unicycle.value(name, &point));
        let (mass, centre) = (mass?, RADIUS * tilt?.cos());
        Ok(if mass <= 0.0 {
            3
        } else if mass < centre {
            0
        } else {
            5
        })
    }
}

/// Straight rolling, upright turning, spinning on the spot.
fn non_generic(claims: &mut Vec<Claim>, unicycle: Mechanism, upright: f64) -> Result<(), Error> {
    let problem = unicycle.problem(&[("theta", 0.0), ("r", 0.1)])?;
    let motions = problem.solve_isolated(60).map_err(computation)?;
    let value = |name: &str| -> Result<Vec<f64>, Error> {
        motions
            .iter()
            .map(|motion| unicycle.value(name, &motion.point))
            .collect()
    };
    let (yaw, pitch) = (value("psi_dot")?, value("phi_dot")?);
    let command = "appell steady unicycle --fix theta=0 --fix r=0.1";
    let agree = yaw
        .iter()
        .map(|yaw| digits(upright, yaw.abs()))
        .min()
        .unwrap_or(0);
    let ours = format!("{yaw:?} rad/s, in {agree} digits");
    let published = "non-tilted turning at ψ̇₁,₂ = ±√(2 m₀ g/(3 m R)) only, black dots";
    claims.push(Claim::that(
        "figure 5, (44)",
        published,
        ours,
        agree >= 10 && yaw.len() == 2,
        command,
    ));
    let pairs = yaw.iter().zip(&pitch);
    let agree = pairs
        .map(|(yaw, pitch)| digits(yaw * 0.1 / RADIUS, *pitch))
        .min()
        .unwrap_or(0);
    let published = "there φ̇ = ψ̇ r/R, here for r = 0.1 m";
    let ours = format!("{pitch:?} rad/s, in {agree} digits");
    claims.push(Claim::that("(44)", published, ours, agree >= 10, command));

    let problem = unicycle.problem(&[("psi_dot", 0.0), ("speed", 2.0)])?;
    let motions = problem.solve_isolated(60).map_err(computation)?;
    let rest = |name: &str| {
        motions
            .iter()
            .all(|m| unicycle.value(name, &m.point).is_ok_and(|v| v.abs() < 1e-9))
    };
    let published = "straight rolling: ϑ = 0, r = 0, any pitch rate, black square";
    let ours = format!(
        "{} motion at ψ̇ = 0 and 2 m/s, upright and with the mass in the middle",
        motions.len()
    );
    let holds = motions.len() == 1 && rest("theta") && rest("r");
    let command = "appell steady unicycle --fix psi_dot=0 --fix speed=2";
    claims.push(Claim::that(
        "figure 5, (43)",
        published,
        ours,
        holds,
        command,
    ));

    // (46) along the tilted branch.
    let branches = unicycle.branches(&[("phi_dot", 0.0)], "psi_dot", [0.5, YAW])?;
    let (mut agree, mut count, mut upright_points, mut above) = (15, 0, 0, true);
    for at in branches.iter().flat_map(|branch| &branch.points) {
        let [tilt, r] = ["theta", "r"].map(|name| unicycle.value(name, &at.point));
        let (tilt, r) = (tilt?, r?);
        if tilt.abs() < 0.01 {
            upright_points += 1;
            continue;
        }
        let (m, m0, c) = (WHEEL_MASS, SLIDER_MASS, tilt.cos());
        let root = (m * m * c.powi(4) + 3.0 * m * m0 * c * c + m0 * m0).sqrt();
        let wanted = RADIUS * tilt.tan() / (2.0 * m0) * (m * c * c + m0 + root);
        agree = agree.min(digits(wanted, r));
        above &= r * tilt > 0.0;
        count += 1;
    }
    let command = "appell steady unicycle --fix phi_dot=0 --along psi_dot=0.5..10";
    let published =
        "tilted spinning lies on the curves (46), dashed lines; upright spinning on ϑ = 0";
    let ours = format!("{count} tilted points in {agree} digits, {upright_points} upright ones");
    let holds = agree >= 9 && count > 20 && upright_points > 20;
    claims.push(Claim::that(
        "figure 5, dashed and solid",
        published,
        ours,
        holds,
        command,
    ));
    let published = "on the dashed lines the mass is above the centre";
    let ours = format!("r ϑ > 0 at all {count} points: {above}");
    claims.push(Claim::that(
        "figure 5, (46)",
        published,
        ours,
        above && count > 0,
        command,
    ));
    Ok(())
}

/// The coloured areas.
fn areas(
    claims: &mut Vec<Claim>,
    unicycle: Mechanism,
    chart: &Chart,
    cells: &[Option<usize>],
) -> Result<(), Error> {
    let count = |kind: usize| cells.iter().filter(|cell| **cell == Some(kind)).count();
    for (kind, place, published) in [
        (
            0,
            "figure 5, light blue",
            "feasible motions with the mass below the wheel centre, 0 < z_A < z_G",
        ),
        (
            5,
            "figure 5, light purple",
            "feasible motions with the mass above the wheel centre, z_A > z_G",
        ),
        (
            3,
            "figure 5, white",
            "motions that are not feasible, z_A ≤ 0",
        ),
    ] {
        let ours = format!("{} of {} motions", count(kind), cells.len());
        claims.push(Claim::that(
            place,
            published,
            ours,
            count(kind) > 0,
            COMMAND,
        ));
    }
    // Every motion against (41).
    let base = Point::initial(unicycle.0);
    let mut worst: f64 = 0.0;
    for cell in chart.cells.iter().flatten() {
        let point = cell_point(chart, &cell.unknowns, &base);
        let [tilt, yaw, r] = ["theta", "psi_dot", "r"].map(|name| unicycle.value(name, &point));
        let wanted = place_of_mass(SLIDER_MASS, tilt?, yaw?);
        worst = worst.max((r? - wanted).abs() / wanted.abs().max(1.0));
    }
    let found = chart.cells.iter().flatten().count();
    let ours = format!("{found} motions, each within {worst:.0e} of (41)");
    let published = "every tilt and yaw rate has one turning motion, with r by (41)";
    let holds = worst < 1e-6 && found * 100 > chart.cells.len() * 98;
    claims.push(Claim::that(
        "figure 5, (41)",
        published,
        ours,
        holds,
        COMMAND,
    ));
    Ok(())
}

/// (41) with the numbers of table I except for the sliding mass.
pub(super) fn place_of_mass(m0: f64, tilt: f64, yaw: f64) -> f64 {
    let (s, c, m) = (tilt.sin(), tilt.cos(), WHEEL_MASS);
    m * RADIUS * (yaw * yaw * RADIUS * c + 2.0 * GRAVITY) * s * c
        / (6.0 * yaw * yaw * m * RADIUS * c.powi(3) - 4.0 * m0 * GRAVITY)
}
