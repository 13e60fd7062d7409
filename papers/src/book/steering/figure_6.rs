//! Figure 6: stability of the turning motions for eight sliding masses.

use appell_analysis::{Cell, Chart, Point, Verdict};

use super::figure_5::place_of_mass;
use crate::book::claim::{Claim, Picture, Section, Statement};
use crate::book::steady_motions::{Mechanism, WHEEL_MASS, cell_point, shown};
use appell::Error;
use appell::steady::regions;

const TILT_DEG: f64 = 60.0;
const YAW: f64 = 10.0;
/// In kg.
const MASSES: [f64; 8] = [0.0, 1.0, 2.0, 5.0, 10.0, 15.0, 20.0, 30.0];

/// A chart for each mass.
pub(super) fn section(grid: usize) -> Result<Section, Error> {
    let (mut claims, mut pictures) = (Vec::new(), Vec::new());
    for mass in MASSES {
        let (mechanism, chart) = chart(mass, grid)?;
        claims.push(claim(mass, mechanism, &chart)?);
        pictures.push(picture(mass, &chart));
    }
    claims.push(without_mass());
    Ok(Section {
        title: "Figure 6: stability of the unicycle's steady motions".to_owned(),
        about: "Turning motions without force on the mass, for eight values of m₀. Each chart is checked \
                motion by motion: the place of the mass against (41), the verdict against the coefficients of \
                the characteristic polynomial."
            .to_owned(),
        claims,
        pictures,
    })
}

fn chart(mass: f64, grid: usize) -> Result<(Mechanism, Chart), Error> {
    let (mechanism, given, least) = given(mass);
    let mechanism = Mechanism::shipped(mechanism)?;
    let tilt = TILT_DEG.to_radians();
    let axes = [
        ("theta", [-tilt, tilt], grid),
        ("psi_dot", [-YAW, YAW], grid),
    ];
    let chart = mechanism.chart(&given, axes, &least)?;
    Ok((mechanism, chart))
}

fn picture(mass: f64, chart: &Chart) -> Picture {
    let axes = ["theta", "psi_dot"].map(shown);
    let map = regions::map(&format!("m₀ = {mass} kg"), chart, axes);
    Picture {
        svg: map.to_svg(),
        caption: format!("m₀ = {mass} kg, m₀/m = {}.", mass / WHEEL_MASS),
    }
}

/// The chart of m₀ = 0 is not of the unicycle.
fn without_mass() -> Claim {
    Statement {
        place: "figure 6, m₀ = 0",
        published: "without the sliding mass the chart is that of the rolling wheel, figure 3(c)",
        command: "appell stability rolling_wheel --chart theta=-60deg..60deg,psi_dot=-10..10",
    }
    .found("computed with the rolling wheel", true)
    .unchecked("the unicycle's equations divide by m₀")
}

type Given = (
    &'static str,
    Vec<(&'static str, f64)>,
    Vec<(&'static str, f64)>,
);

/// Mechanism, parameters and requirements of a sliding mass.
fn given(mass: f64) -> Given {
    if mass > 0.0 {
        ("unicycle", vec![("m0", mass)], vec![("z_A", 0.0)])
    } else {
        ("rolling_wheel", Vec::new(), Vec::new())
    }
}

fn claim(mass: f64, mechanism: Mechanism, chart: &Chart) -> Result<Claim, Error> {
    let base = Point::initial(mechanism.0);
    let (mut worst, mut wrong): (f64, usize) = (0.0, 0);
    let found: Vec<&Cell> = chart.cells.iter().flatten().collect();
    for cell in &found {
        if mass > 0.0 {
            let point = cell_point(chart, &cell.unknowns, &base);
            let [tilt, yaw, r] =
                ["theta", "psi_dot", "r"].map(|name| mechanism.value(name, &point));
            let wanted = place_of_mass(mass, tilt?, yaw?);
            worst = worst.max((r? - wanted).abs() / wanted.abs().max(1.0));
        }
        wrong += usize::from(disagrees(cell));
    }
    let count = |wanted: bool| {
        let stable = |cell: &&&Cell| (cell.verdict != Verdict::Unstable) == wanted;
        found.iter().filter(stable).count()
    };
    let infeasible = found.iter().filter(|cell| !cell.feasible).count();
    let ours = format!(
        "{} motions on {} grid points: {} stable, {} unstable; {infeasible} of them not feasible. Place of the mass \
         within {worst:.0e} of (41); {wrong} verdicts that contradict (49)",
        found.len(),
        chart.cells.len(),
        count(true),
        count(false),
    );
    let published = format!("chart for m₀ = {mass} kg");
    let enough = found.len() * 100 > chart.cells.len() * 90;
    let holds = worst < 1e-6 && wrong == 0 && enough && count(true) > 0 && count(false) > 0;
    let command = if mass > 0.0 {
        format!(
            "appell stability unicycle --set m0={mass} --chart theta=-60deg..60deg,psi_dot=-10..10 --require 'z_A>=0'"
        )
    } else {
        "appell stability rolling_wheel --chart theta=-60deg..60deg,psi_dot=-10..10".to_owned()
    };
    let statement = Statement {
        place: "figure 6",
        published: &published,
        command: &command,
    };
    Ok(statement.found(ours, holds))
}

/// Whether the verdict contradicts the roots q = λ² of (49): stable where they are real and negative.
fn disagrees(cell: &Cell) -> bool {
    /// Fraction of the largest root within which the boundary lies.
    const NEAR: f64 = 1e-4;
    let squares: Vec<_> = cell.eigenvalues.iter().map(|z| z * z).collect();
    let size = squares
        .iter()
        .map(|q| q.norm())
        .fold(f64::MIN_POSITIVE, f64::max);
    let clear = |unstable: bool| {
        squares.iter().any(|q| {
            if unstable {
                q.re > NEAR * size || q.im.abs() > NEAR * size
            } else {
                q.norm() < NEAR * size
            }
        })
    };
    let (grows, border) = (clear(true), clear(false));
    !border && grows != (cell.verdict == Verdict::Unstable)
}
