//! Figures 5 and 6: all steady motions of the unicycle, and their stability for eight sliding masses.

use appell::steady::regions;
use appell_analysis::{Cell, Chart, Verdict};
use appell_report::figure::{Curve, Map, Stroke};

use super::figure_3::unstable;
use crate::book::claim::digits;
use crate::book::steady_motions::{GRAVITY, Mechanism, RADIUS, SLIDER_MASS, WHEEL_MASS, shown};
use crate::book::{Part, Result, Section, line};

/// Largest tilt that is drawn, in degrees.
const TILT_DEG: f64 = 60.0;
/// Largest yaw rate that is drawn, in rad/s.
const YAW: f64 = 10.0;
/// Axes of the map.
const AXES: [&str; 2] = ["theta", "psi_dot"];

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

/// The map, and the statements about it.
pub(super) fn section(grid: usize) -> Result<Section> {
    let unicycle = Mechanism::shipped("unicycle")?;
    let chart = turning_motions(unicycle, grid, &[], &[("z_A", 0.0)])?;
    let cells = kinds(unicycle, &chart)?;
    let mut part = Part::read(include_str!("figure_5.toml"))?;
    upright_turning(&mut part, unicycle)?;
    straight_rolling(&mut part, unicycle)?;
    tilted_spinning(&mut part, unicycle)?;
    for (key, kind) in [
        ("mass_below", MASS_BELOW),
        ("mass_above", MASS_ABOVE),
        ("infeasible", INFEASIBLE),
    ] {
        let count = cells.iter().filter(|cell| **cell == Some(kind)).count();
        let ours = format!("{count} of {} grid points", cells.len());
        part.found(key, ours, count > 0)?;
    }
    let worst = farthest_from_41(unicycle, &chart, SLIDER_MASS)?;
    let found = chart.cells.iter().flatten().count();
    let ours = format!("{found} motions, each within {worst:.0e} of (41)");
    let holds = worst < 1e-6 && found * 100 > chart.cells.len() * 98;
    part.found("turning", ours, holds)?;

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
    part.picture("map", map.to_svg())?;
    Ok(part.section())
}

/// The chart over tilt and yaw rate.
pub(super) fn turning_motions(
    mechanism: Mechanism,
    grid: usize,
    given: &[(&str, f64)],
    least: &[(&str, f64)],
) -> Result<Chart> {
    let tilt = TILT_DEG.to_radians();
    let axes = [
        ("theta", [-tilt, tilt], grid),
        ("psi_dot", [-YAW, YAW], grid),
    ];
    mechanism.chart(given, axes, least)
}

/// The largest distance of the mass from (41) in a chart.
pub(super) fn farthest_from_41(unicycle: Mechanism, chart: &Chart, mass: f64) -> Result<f64> {
    let mut worst: f64 = 0.0;
    for cell in chart.cells.iter().flatten() {
        let [tilt, yaw, r] = unicycle.cell_values(["theta", "psi_dot", "r"], chart, cell)?;
        let wanted = place_of_mass(mass, tilt, yaw);
        worst = worst.max((r - wanted).abs() / wanted.abs().max(1.0));
    }
    Ok(worst)
}

/// Yaw rate of non-tilted turning, (44).
fn upright_rate() -> f64 {
    (2.0 * SLIDER_MASS * GRAVITY / (3.0 * WHEEL_MASS * RADIUS)).sqrt()
}

/// Spinning, tilted spinning, straight rolling and non-tilted turning.
fn special_motions(unicycle: Mechanism) -> Result<Vec<Curve>> {
    let mut tilted = Vec::new();
    for sign in [-1.0, 1.0] {
        let range = [sign * 0.5, sign * YAW];
        let branches = unicycle.branches(&[("phi_dot", 0.0)], "psi_dot", range)?;
        tilted.extend(unicycle.curves(&branches, AXES, Stroke::Dashed)?);
    }
    if let Some(first) = tilted.first_mut() {
        "tilted spinning".clone_into(&mut first.line.label);
    }
    let upright = |label, yaw: &[f64], stroke| Curve {
        line: line(label, vec![0.0; yaw.len()], yaw.to_vec()),
        stroke,
    };
    let rate = upright_rate();
    let mut curves = vec![upright("spinning", &[-YAW, YAW], Stroke::Solid)];
    curves.extend(tilted);
    curves.push(upright("straight rolling", &[0.0], Stroke::Squares));
    curves.push(upright("non-tilted turning", &[-rate, rate], Stroke::Discs));
    Ok(curves)
}

/// The edges of the areas.
fn edges(chart: &Chart) -> impl Iterator<Item = Curve> {
    let scales = AXES.map(|name| shown(name).scale);
    chart.edges.iter().map(move |edge| {
        let [x, y] = [0, 1].map(|k| edge.points.iter().map(|at| at[k] * scales[k]).collect());
        Curve {
            line: line("", x, y),
            stroke: Stroke::Thin,
        }
    })
}

/// The kind of each cell of a chart; `None` without a motion.
fn kinds(unicycle: Mechanism, chart: &Chart) -> Result<Vec<Option<usize>>> {
    let kind = |cell: &Cell| -> Result<usize> {
        let [mass, tilt] = unicycle.cell_values(["z_A", "theta"], chart, cell)?;
        let centre = RADIUS * tilt.cos();
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
fn upright_turning(part: &mut Part, unicycle: Mechanism) -> Result<()> {
    let motions = unicycle.isolated(&[("theta", 0.0), ("r", 0.1)])?;
    let (mut yaw, mut pitch) = (Vec::new(), Vec::new());
    for motion in &motions {
        let values = unicycle.values(["psi_dot", "phi_dot"], motion)?;
        yaw.push(values[0]);
        pitch.push(values[1]);
    }
    let rate = upright_rate();
    let agree = yaw.iter().map(|yaw| digits(rate, yaw.abs()));
    let agree = agree.min().unwrap_or(0);
    let ours = format!("{yaw:?} rad/s, in {agree} digits");
    part.found("upright_turning", ours, agree >= 10 && yaw.len() == 2)?;

    let pairs = yaw.iter().zip(&pitch);
    let agree = pairs.map(|(yaw, pitch)| digits(yaw * 0.1 / RADIUS, *pitch));
    let agree = agree.min().unwrap_or(0);
    let ours = format!("{pitch:?} rad/s, in {agree} digits");
    part.found("pitch_rate", ours, agree >= 10)
}

/// (43): straight rolling.
fn straight_rolling(part: &mut Part, unicycle: Mechanism) -> Result<()> {
    let motions = unicycle.isolated(&[("psi_dot", 0.0), ("speed", 2.0)])?;
    let mut holds = motions.len() == 1;
    for motion in &motions {
        let values = unicycle.values(["theta", "r"], motion)?;
        holds &= values.iter().all(|value| value.abs() < 1e-9);
    }
    let ours = format!(
        "{} motion at ψ̇ = 0 and 2 m/s, upright and with the mass in the middle",
        motions.len()
    );
    part.found("straight_rolling", ours, holds)
}

/// (46): spinning on the spot, along the tilted branch.
fn tilted_spinning(part: &mut Part, unicycle: Mechanism) -> Result<()> {
    /// Below it in rad, a point is on the upright branch.
    const UPRIGHT: f64 = 0.01;
    let branches = unicycle.branches(&[("phi_dot", 0.0)], "psi_dot", [0.5, YAW])?;
    let (mut agree, mut tilted, mut upright, mut above) = (15, 0, 0, true);
    for at in branches.iter().flat_map(|branch| &branch.points) {
        let [tilt, r] = unicycle.values(["theta", "r"], &at.point)?;
        if tilt.abs() < UPRIGHT {
            upright += 1;
            continue;
        }
        agree = agree.min(digits(place_in_spinning(tilt), r));
        above &= r * tilt > 0.0;
        tilted += 1;
    }
    let ours = format!("{tilted} tilted points in {agree} digits, {upright} upright ones");
    let holds = agree >= 9 && tilted > 20 && upright > 20;
    part.found("tilted_spinning", ours, holds)?;
    let ours = format!("r ϑ > 0 at all {tilted} points: {above}");
    part.found("above_in_spinning", ours, above && tilted > 0)
}

/// (46): place of the mass in tilted spinning, with the numbers of table I.
pub(super) fn place_in_spinning(tilt: f64) -> f64 {
    let (m, m0, c) = (WHEEL_MASS, SLIDER_MASS, tilt.cos());
    let root = (m * m * c.powi(4) + 3.0 * m * m0 * c * c + m0 * m0).sqrt();
    RADIUS * tilt.tan() / (2.0 * m0) * (m * c * c + m0 + root)
}

/// (41) with the numbers of table I except for the sliding mass.
fn place_of_mass(m0: f64, tilt: f64, yaw: f64) -> f64 {
    let (s, c, m) = (tilt.sin(), tilt.cos(), WHEEL_MASS);
    m * RADIUS * (yaw * yaw * RADIUS * c + 2.0 * GRAVITY) * s * c
        / (6.0 * yaw * yaw * m * RADIUS * c.powi(3) - 4.0 * m0 * GRAVITY)
}

/// In kg. Without it, the unicycle is the rolling wheel.
const MASSES: [f64; 8] = [0.0, 1.0, 2.0, 5.0, 10.0, 15.0, 20.0, 30.0];

/// A chart for each mass.
pub(super) fn figure_6(grid: usize) -> Result<Section> {
    let mut part = Part::read(include_str!("figure_6.toml"))?;
    for mass in MASSES {
        part.set("mass", mass);
        part.set("ratio", mass / WHEEL_MASS);
        chart(&mut part, mass, grid)?;
    }
    part.found("without_mass", "computed with the rolling wheel", true)?;
    Ok(part.section())
}

fn chart(part: &mut Part, mass: f64, grid: usize) -> Result<()> {
    let with_mass = mass > 0.0;
    let (name, given, least) = if with_mass {
        ("unicycle", vec![("m0", mass)], vec![("z_A", 0.0)])
    } else {
        ("rolling_wheel", Vec::new(), Vec::new())
    };
    let mechanism = Mechanism::shipped(name)?;
    let chart = turning_motions(mechanism, grid, &given, &least)?;
    let worst = if with_mass {
        farthest_from_41(mechanism, &chart, mass)?
    } else {
        0.0
    };
    let found: Vec<&Cell> = chart.cells.iter().flatten().collect();
    let wrong = found.iter().filter(|cell| disagrees(cell)).count();
    let cells = chart.cells.iter();
    let unstable: usize = cells.map(|cells| unstable(cells)).sum();
    let stable = found.len() - unstable;
    let infeasible = found.iter().filter(|cell| !cell.feasible).count();
    let ours = format!(
        "{} motions on {} grid points: {stable} stable, {unstable} unstable; {infeasible} of them not feasible. Place of \
         the mass within {worst:.0e} of (41); {wrong} verdicts that contradict (49)",
        found.len(),
        chart.cells.len(),
    );
    let enough = found.len() * 100 > chart.cells.len() * 90;
    let holds = worst < 1e-6 && wrong == 0 && enough && stable > 0 && unstable > 0;
    part.found(name, ours, holds)?;
    let axes = ["theta", "psi_dot"].map(shown);
    let map = regions::map(&format!("m₀ = {mass} kg"), &chart, axes);
    part.picture("map", map.to_svg())
}

/// Whether the verdict contradicts the roots q = λ² of (49): stable where they are real and negative.
fn disagrees(cell: &Cell) -> bool {
    /// Fraction of the largest root within which the boundary lies.
    const NEAR: f64 = 1e-4;
    let squares: Vec<_> = cell.eigenvalues.iter().map(|z| z * z).collect();
    let sizes = squares.iter().map(|q| q.norm());
    let near = NEAR * sizes.fold(f64::MIN_POSITIVE, f64::max);
    let grows = squares.iter().any(|q| q.re > near || q.im.abs() > near);
    let border = squares.iter().any(|q| q.norm() < near);
    !border && grows != (cell.verdict == Verdict::Unstable)
}
