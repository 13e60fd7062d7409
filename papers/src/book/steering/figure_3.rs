//! Figure 3: level sets and stability of the steady motions of the rolling wheel.

use appell_analysis::{Cell, Chart, Kind, Verdict};
use appell_report::figure::{Curve, Map, Patch, Stroke, Surface};

use crate::book::claim::digits;
use crate::book::equations::misprint;
use crate::book::steady_motions::{GRAVITY, Mechanism, RADIUS, degrees, shown};
use crate::book::{Part, Result, Section, line};
use crate::errata::{ERRATA, Erratum};
use appell::steady::regions;

/// Largest tilt that is drawn, in degrees.
const TILT_DEG: f64 = 60.0;
/// Largest rate that is drawn, in rad/s.
const RATE: f64 = 10.0;
/// Beyond it, folds are still sought, so that they leave the panels.
const BEYOND: f64 = 16.0;
/// Pieces of the surface of panel (a) along each axis.
const PIECES: usize = 48;
/// Pitch rates at which folds are sought.
const ROWS: u32 = 60;
/// Largest tilt at which folds are sought, in degrees.
const STEEP_DEG: f64 = 75.0;
/// Levels of tilts, in degrees, and of rates.
const TILTS_DEG: [f64; 5] = [5.0, 10.0, 20.0, 30.0, 50.0];
const RATES: [f64; 4] = [1.0, 2.0, 4.0, 8.0];
/// The surface of steady motions.
const QUANTITIES: [&str; 3] = ["theta", "psi_dot", "phi_dot"];

/// A projection of the surface along a quantity.
struct Panel {
    key: &'static str,
    title: &'static str,
    over: [&'static str; 2],
    /// The quantity with levels, and its letter.
    along: [&'static str; 2],
}

const PANELS: [Panel; 3] = [
    Panel {
        key: "b",
        title: "(b) levels of the tilt",
        over: ["psi_dot", "phi_dot"],
        along: ["theta", "ϑ"],
    },
    Panel {
        key: "c",
        title: "(c) levels of the pitch rate",
        over: ["theta", "psi_dot"],
        along: ["phi_dot", "φ̇"],
    },
    Panel {
        key: "d",
        title: "(d) levels of the yaw rate",
        over: ["theta", "phi_dot"],
        along: ["psi_dot", "ψ̇"],
    },
];

/// The four panels, and the statements about them.
pub(super) fn section(grid: usize) -> Result<Section> {
    let wheel = Mechanism::shipped("rolling_wheel")?;
    let chart = |over: [&'static str; 2], count| {
        let axes = over.map(|name| (name, range(name), count));
        wheel.chart(&[], axes, &[])
    };
    let [b, c, d] = PANELS.each_ref().map(|panel| chart(panel.over, grid));
    let charts = [b?, c?, d?];
    let folds = Folds::of(wheel)?;

    let mut part = Part::read(include_str!("figure_3.toml"))?;
    let [b, c, d] = &charts;
    existence(&mut part, b, c)?;
    verdicts(&mut part, wheel, c)?;
    farthest_fold(&mut part, c)?;
    infinite(&mut part, wheel)?;
    let on_figures = |erratum: &&Erratum| erratum.equation == "text on figure 3";
    part.claims
        .extend(ERRATA.iter().filter(on_figures).map(misprint));
    counted(&mut part, d)?;
    beyond_limit(&mut part, d)?;
    folded(&mut part, &folds)?;

    let surface = surface(wheel, &chart(PANELS[0].over, PIECES)?)?;
    part.picture("a", surface.to_svg())?;
    for (panel, chart) in PANELS.iter().zip(&charts) {
        part.picture(panel.key, panel.map(wheel, chart, &folds)?.to_svg())?;
    }
    Ok(part.section())
}

/// The values of a quantity that are drawn.
fn range(name: &str) -> [f64; 2] {
    let end = if name == "theta" {
        TILT_DEG.to_radians()
    } else {
        RATE
    };
    [-end, end]
}

/// 𝒱 of (23): the tilt at which the root in (22) vanishes.
fn limit_tilt() -> f64 {
    let square = (24.0 - 9.0 * 5f64.sqrt()) / 38.0;
    square.sqrt().asin()
}

impl Panel {
    fn map(&self, wheel: Mechanism, chart: &Chart, folds: &Folds) -> Result<Map> {
        let mut map = regions::map(self.title, chart, self.over.map(shown));
        map.curves.extend(self.levels(wheel)?);
        map.curves.extend(folds.curves(self.over));
        if self.key == "c" {
            let line = line("φ̇ → ±∞", vec![-TILT_DEG, TILT_DEG], vec![0.0; 2]);
            let stroke = Stroke::Dashed;
            map.curves.push(Curve { line, stroke });
        }
        Ok(map)
    }

    /// Curves on which the quantity has one of its levels or the opposite; they are followed along
    /// the first axis.
    fn levels(&self, wheel: Mechanism) -> Result<Vec<Curve>> {
        let ([fixed, letter], along) = (self.along, self.over[0]);
        let levels = match fixed {
            "theta" => TILTS_DEG.map(f64::to_radians).to_vec(),
            _ => RATES.to_vec(),
        };
        let mut all = Vec::new();
        for value in levels.iter().flat_map(|value| [-value, *value]) {
            let branches = wheel.branches(&[(fixed, value)], along, range(along))?;
            all.extend(wheel.curves(&branches, self.over, Stroke::Thin)?);
        }
        if let Some(first) = all.first_mut() {
            first.line.label = format!("levels of {letter}");
        }
        Ok(all)
    }
}

/// Panel (a): the tilt over the plane of both rates.
fn surface(wheel: Mechanism, chart: &Chart) -> Result<Surface> {
    let [x, y] = chart.axes;
    let mut patches = Vec::new();
    for j in 1..y.count {
        for i in 1..x.count {
            let mut corners = [[f64::NAN; 3]; 4];
            let mut growing = 0;
            let around = [(i - 1, j - 1), (i, j - 1), (i, j), (i - 1, j)];
            for (corner, (i, j)) in corners.iter_mut().zip(around) {
                if let [cell, ..] = chart.motions(i, j) {
                    let [tilt] = wheel.cell_values(["theta"], chart, cell)?;
                    *corner = [x.value(i), y.value(j), tilt.to_degrees()];
                    growing += usize::from(cell.verdict == Verdict::Unstable);
                }
            }
            let kind = if growing > 1 { 2 } else { 1 };
            patches.push(Patch { corners, kind });
        }
    }
    Ok(Surface {
        title: "(a) steady motions".to_owned(),
        labels: ["psi_dot", "phi_dot", "theta"].map(|name| shown(name).label),
        ranges: [[-RATE, RATE], [-RATE, RATE], [-90.0, 90.0]],
        kinds: ["", "stable", "unstable"].map(str::to_owned).to_vec(),
        patches,
        paths: Vec::new(),
    })
}

/// Folds of the tilt at a constant pitch rate: tilt, yaw rate, pitch rate.
struct Folds(Vec<[f64; 3]>);

impl Folds {
    fn of(wheel: Mechanism) -> Result<Self> {
        let steep = STEEP_DEG.to_radians();
        let mut folds = Vec::new();
        for row in 0..ROWS {
            let pitch = BEYOND * (2.0 * (f64::from(row) + 0.5) / f64::from(ROWS) - 1.0);
            let branches = wheel.branches(&[("phi_dot", pitch)], "theta", [-steep, steep])?;
            let specials = branches.iter().flat_map(|branch| &branch.specials);
            for special in specials.filter(|special| special.kind == Kind::Fold) {
                let [yaw] = wheel.values(["psi_dot"], &special.motion.point)?;
                folds.push([special.motion.value, yaw, pitch]);
            }
        }
        Ok(Self(folds))
    }

    /// The folds in each quadrant, over two of the three quantities.
    fn curves(&self, over: [&str; 2]) -> Vec<Curve> {
        let quarters = [(true, true), (true, false), (false, true), (false, false)];
        let curve = |(right, up): (bool, bool)| {
            let inside = |fold: &&[f64; 3]| (fold[0] > 0.0) == right && (fold[2] > 0.0) == up;
            let part: Vec<_> = self.0.iter().filter(inside).collect();
            let [x, y] = over.map(|name| {
                let component = QUANTITIES.iter().position(|quantity| *quantity == name);
                let component = component.unwrap_or(0);
                degrees(name, part.iter().map(|fold| fold[component]).collect())
            });
            Curve {
                line: line(if right && up { "fold" } else { "" }, x, y),
                stroke: Stroke::Dotted,
            }
        };
        quarters.into_iter().map(curve).collect()
    }
}

/// Panels (b) and (c): existence of motions.
fn existence(part: &mut Part, b: &Chart, c: &Chart) -> Result<()> {
    let [in_b, in_c] = [b, c].map(|chart| count(chart, <[Cell]>::is_empty));
    let points = b.cells.len();
    let ours = format!("motions are missing at {in_b} and {in_c} of {points} grid points");
    // A row or column of the grid may touch ψ̇ = 0, where straight rolling is a family.
    part.found("existence", ours, in_b + in_c <= 4 * b.axes[0].count)
}

/// Panel (c): the stability of every motion against (21).
fn verdicts(part: &mut Part, wheel: Mechanism, chart: &Chart) -> Result<()> {
    let mut wrong = 0;
    for cell in chart.cells.iter().flatten() {
        let [tilt, yaw, pitch] = wheel.cell_values(QUANTITIES, chart, cell)?;
        let square = 0.8 * GRAVITY / RADIUS * tilt.cos()
            - (yaw * yaw + 2.8 * yaw * pitch * tilt.sin() + 2.4 * pitch * pitch);
        wrong += usize::from((square > 0.0) != (cell.verdict == Verdict::Unstable));
    }
    let points = chart.cells.len();
    let ours = format!("{wrong} motions on {points} grid points have another verdict than (21)");
    part.found("verdicts", ours, wrong == 0)
}

/// Panel (c): the tilt of the fold that agrees least with 𝒱.
fn farthest_fold(part: &mut Part, chart: &Chart) -> Result<()> {
    let folds = chart
        .boundaries
        .iter()
        .flat_map(|boundary| &boundary.folds)
        .filter(|fold| fold.decides && fold.axis == 0);
    let tilts = folds.map(|fold| fold.at[0].to_degrees().abs());
    let wanted = limit_tilt().to_degrees();
    let farthest = tilts.min_by_key(|tilt| digits(wanted, *tilt));
    part.number("limit", [wanted, farthest.unwrap_or(f64::NAN)])
}

/// The dashed line of panel (c).
fn infinite(part: &mut Part, wheel: Mechanism) -> Result<()> {
    let (tilt, yaw) = (10f64.to_radians(), 0.02);
    let branches = wheel.branches(&[("theta", tilt)], "psi_dot", [yaw, 5.0])?;
    let first = branches.first().and_then(|branch| branch.points.first());
    let [pitch] = match first {
        Some(at) => wheel.values(["phi_dot"], &at.point)?,
        None => [f64::NAN],
    };
    let wanted = -2.0 * GRAVITY * tilt.tan() / (3.0 * RADIUS);
    part.number("infinite", [wanted, pitch * yaw])?;
    let none = wheel.has_none(&[("theta", tilt), ("psi_dot", 0.0)], 20)?;
    let ours = if none {
        "none is found at ϑ = 10°, ψ̇ = 0"
    } else {
        "one is found"
    };
    part.found("none_on_the_line", ours, none)
}

/// Grid points of a kind.
fn count(chart: &Chart, is: impl Fn(&[Cell]) -> bool) -> usize {
    chart.cells.iter().filter(|cells| is(cells)).count()
}

/// Unstable motions at a grid point.
pub(super) fn unstable(cells: &[Cell]) -> usize {
    let grows = |cell: &&Cell| cell.verdict == Verdict::Unstable;
    cells.iter().filter(grows).count()
}

/// Panel (d): number of motions.
fn counted(part: &mut Part, chart: &Chart) -> Result<()> {
    let all = chart.cells.len();
    let green = count(chart, |cells| cells.len() == 2 && unstable(cells) == 0);
    let yellow = count(chart, |cells| cells.len() == 2 && unstable(cells) == 1);
    let none = count(chart, <[Cell]>::is_empty);
    let others = all - green - yellow - none;
    let of_all = |count: usize| format!("{count} of {all} grid points");
    part.found("two_stable", of_all(green), green > 0)?;
    let ours = format!(
        "{}; {others} beside the fold have one motion",
        of_all(yellow)
    );
    part.found("one_stable", ours, yellow > 0 && others * 1000 < all)?;
    part.found("none", of_all(none), none > 0)
}

/// Panel (d): stability beyond the limit tilt.
fn beyond_limit(part: &mut Part, chart: &Chart) -> Result<()> {
    let (limit, columns) = (limit_tilt(), chart.axes[0].count);
    let beyond = |index: usize| chart.axes[0].value(index % columns).abs() > limit;
    let cells = chart.cells.iter().enumerate();
    let wrong = cells.filter(|(index, cells)| beyond(*index) && unstable(cells) > 0);
    let wrong = wrong.count();
    let ours = format!("{wrong} grid points beyond 𝒱 have an unstable motion");
    part.found("beyond_limit", ours, wrong == 0)
}

/// The fold: dφ̇/dψ̇ = 0 of (14), which is ψ̇² = 4 g/(5 R cos ϑ).
fn folded(part: &mut Part, folds: &Folds) -> Result<()> {
    let agree = folds.0.iter().map(|[tilt, yaw, _]| {
        let wanted = 4.0 * GRAVITY / (5.0 * RADIUS * tilt.cos());
        digits(wanted, yaw * yaw)
    });
    let agree = agree.min().unwrap_or(0);
    let count = folds.0.len();
    let ours = format!("{count} folds found, ψ̇² = 4 g/(5 R cos ϑ) in {agree} digits");
    part.found("folds", ours, agree >= 8 && count >= 2 * ROWS as usize)
}
