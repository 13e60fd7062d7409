//! Figure 3: level sets and stability of the steady motions of the rolling wheel.

use crate::errata::ERRATA;
use appell_analysis::{Cell, Chart, Kind, Verdict};
use appell_report::figure::{Curve, Map, Patch, Series, Stroke, Surface};

use super::equations::misprint;
use crate::book::claim::{Claim, Picture, Section, Statement, digits};
use crate::book::steady_motions::{GRAVITY, Mechanism, RADIUS, cell_point, degrees, shown};
use appell::Error;
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
/// Axes of the panels.
const RATES: [&str; 2] = ["psi_dot", "phi_dot"];
const TILT_AND_YAW: [&str; 2] = ["theta", "psi_dot"];
const TILT_AND_PITCH: [&str; 2] = ["theta", "phi_dot"];
/// The commands of panels (c) and (d).
const COMMAND: &str = "appell stability rolling_wheel --chart theta=-60deg..60deg,psi_dot=-10..10 --plot figure_3c.svg";
const COMMAND_D: &str =
    "appell stability rolling_wheel --chart theta=-60deg..60deg,phi_dot=-10..10";

/// Descriptions of the panels.
const CAPTIONS: [&str; 4] = [
    "Panel (a): the steady motions (13) as a surface.",
    "Panel (b): every pair of yaw and pitch rate has one tilt. Levels at ±5°, ±10°, ±20°, ±30°, ±50°.",
    "Panel (c): levels of the pitch rate at ±1, ±2, ±4, ±8 rad/s; dashed, where it runs to infinity; dotted, the fold.",
    "Panel (d): levels of the yaw rate at ±1, ±2, ±4, ±8 rad/s; the fold is the outer edge of the coloured area. \
     Yellow and blue are the paper's yellow and dark green.",
];

/// The four panels, and the statements about them.
pub(super) fn section(grid: usize) -> Result<Section, Error> {
    let wheel = Mechanism::shipped("rolling_wheel")?;
    let charts = Charts::of(wheel, grid)?;
    let folds = folds(wheel)?;
    Ok(Section {
        title: "Figure 3: steady motions of the rolling wheel".to_owned(),
        about:
            "The panels (b), (c) and (d) are projections of the surface of steady motions (13), \
                panel (a), along ϑ, φ̇ and ψ̇. Stable means neutrally stable: eigenvalues on the \
                imaginary axis."
                .to_owned(),
        claims: claims(wheel, &charts, &folds)?,
        pictures: pictures(wheel, &charts, &folds)?,
    })
}

/// The charts of the panels.
struct Charts {
    a: Chart,
    b: Chart,
    c: Chart,
    d: Chart,
}

impl Charts {
    fn of(wheel: Mechanism, grid: usize) -> Result<Self, Error> {
        let panel = |names: [&str; 2], count| {
            let axes = names.map(|name| (name, range(name), count));
            wheel.chart(&[], axes, &[])
        };
        Ok(Self {
            a: panel(RATES, PIECES)?,
            b: panel(RATES, grid)?,
            c: panel(TILT_AND_YAW, grid)?,
            d: panel(TILT_AND_PITCH, grid)?,
        })
    }
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

fn claims(wheel: Mechanism, charts: &Charts, folds: &Folds) -> Result<Vec<Claim>, Error> {
    let mut claims = vec![
        existence(&charts.b, &charts.c),
        verdicts(wheel, &charts.c)?,
        farthest_fold(&charts.c),
    ];
    infinite(&mut claims, wheel)?;
    let on_figures = ERRATA
        .iter()
        .filter(|erratum| erratum.equation == "text on figure 3");
    claims.extend(on_figures.map(misprint));
    counted(&mut claims, &charts.d);
    claims.push(beyond_limit(&charts.d));
    claims.push(folded(folds));
    Ok(claims)
}

fn pictures(wheel: Mechanism, charts: &Charts, folds: &Folds) -> Result<Vec<Picture>, Error> {
    let [b, c, d] = maps(wheel, charts, folds)?;
    let drawn = [
        surface(wheel, &charts.a)?.to_svg(),
        b.to_svg(),
        c.to_svg(),
        d.to_svg(),
    ];
    let picture = |(svg, caption): (String, &str)| Picture {
        svg,
        caption: caption.to_owned(),
    };
    Ok(drawn.into_iter().zip(CAPTIONS).map(picture).collect())
}

/// Panels (b), (c) and (d).
fn maps(wheel: Mechanism, charts: &Charts, folds: &Folds) -> Result<[Map; 3], Error> {
    let map = |title: &str, chart: &Chart, over: [&'static str; 2], levels: Vec<Curve>| {
        let mut map = regions::map(title, chart, over.map(shown));
        map.curves.extend(levels);
        map.curves.extend(folds.curves(over));
        map
    };
    let tilts = [5.0, 10.0, 20.0, 30.0, 50.0].map(f64::to_radians);
    let rates = [1.0, 2.0, 4.0, 8.0];
    let tilt = levels(wheel, ["theta", "ϑ"], &tilts, RATES)?;
    let pitch = levels(wheel, ["phi_dot", "φ̇"], &rates, TILT_AND_YAW)?;
    let yaw = levels(wheel, ["psi_dot", "ψ̇"], &rates, TILT_AND_PITCH)?;
    let b = map("(b) levels of the tilt", &charts.b, RATES, tilt);
    let mut c = map(
        "(c) levels of the pitch rate",
        &charts.c,
        TILT_AND_YAW,
        pitch,
    );
    c.curves.push(Curve {
        line: Series {
            label: "φ̇ → ±∞".to_owned(),
            x: vec![-TILT_DEG, TILT_DEG],
            y: vec![0.0; 2],
        },
        stroke: Stroke::Dashed,
    });
    let d = map("(d) levels of the yaw rate", &charts.d, TILT_AND_PITCH, yaw);
    Ok([b, c, d])
}

/// Panel (a): the tilt over the plane of both rates.
fn surface(wheel: Mechanism, chart: &Chart) -> Result<Surface, Error> {
    let tilt = |cell: &Cell| {
        let base = appell_analysis::Point::initial(wheel.0);
        let point = cell_point(chart, &cell.unknowns, &base);
        Ok::<_, Error>(wheel.value("theta", &point)?.to_degrees())
    };
    let [x, y] = chart.axes;
    let mut patches = Vec::new();
    for j in 1..y.count {
        for i in 1..x.count {
            let mut corners = [[f64::NAN; 3]; 4];
            let mut unstable = 0;
            let around = [(i - 1, j - 1), (i, j - 1), (i, j), (i - 1, j)];
            for (corner, (i, j)) in corners.iter_mut().zip(around) {
                if let [cell, ..] = chart.motions(i, j) {
                    *corner = [x.value(i), y.value(j), tilt(cell)?];
                    unstable += usize::from(cell.verdict == Verdict::Unstable);
                }
            }
            let kind = if unstable > 1 { 2 } else { 1 };
            patches.push(Patch { corners, kind });
        }
    }
    let [yaw, pitch, tilt] = ["psi_dot", "phi_dot", "theta"].map(|name| shown(name).label);
    Ok(Surface {
        title: "(a) steady motions".to_owned(),
        labels: [yaw, pitch, tilt],
        ranges: [[-RATE, RATE], [-RATE, RATE], [-90.0, 90.0]],
        kinds: ["", "stable", "unstable"].map(str::to_owned).to_vec(),
        patches,
        paths: Vec::new(),
    })
}

/// Curves on which a quantity, by its name and letter, has one of the values or its opposite; they
/// are followed along the first axis.
fn levels(
    wheel: Mechanism,
    [fixed, letter]: [&str; 2],
    values: &[f64],
    over: [&str; 2],
) -> Result<Vec<Curve>, Error> {
    let along = over[0];
    let mut all = Vec::new();
    for value in values.iter().flat_map(|value| [-value, *value]) {
        let branches = wheel.branches(&[(fixed, value)], along, range(along))?;
        all.extend(wheel.curves(&branches, over, Stroke::Thin)?);
    }
    if let Some(first) = all.first_mut() {
        first.line.label = format!("levels of {letter}");
    }
    Ok(all)
}

/// Folds of the tilt at a constant pitch rate: tilt, yaw rate, pitch rate.
struct Folds(Vec<[f64; 3]>);

fn folds(wheel: Mechanism) -> Result<Folds, Error> {
    let mut folds = Vec::new();
    for row in 0..ROWS {
        let pitch = BEYOND * (2.0 * (f64::from(row) + 0.5) / f64::from(ROWS) - 1.0);
        let steep = STEEP_DEG.to_radians();
        let branches = wheel.branches(&[("phi_dot", pitch)], "theta", [-steep, steep])?;
        let specials = branches.iter().flat_map(|branch| &branch.specials);
        for special in specials.filter(|special| special.kind == Kind::Fold) {
            let yaw = wheel.value("psi_dot", &special.motion.point)?;
            folds.push([special.motion.value, yaw, pitch]);
        }
    }
    Ok(Folds(folds))
}

impl Folds {
    /// The folds in each quadrant, over two of the three.
    fn curves(&self, over: [&str; 2]) -> Vec<Curve> {
        let component = |name: &str| match name {
            "theta" => 0,
            "psi_dot" => 1,
            _ => 2,
        };
        let values = |part: &[&[f64; 3]], name: &str| {
            let values = part.iter().map(|fold| fold[component(name)]).collect();
            degrees(name, values)
        };
        let quarters = [(true, true), (true, false), (false, true), (false, false)];
        let curve = |(right, up): (bool, bool)| {
            let inside = |fold: &&[f64; 3]| (fold[0] > 0.0) == right && (fold[2] > 0.0) == up;
            let part: Vec<&[f64; 3]> = self.0.iter().filter(inside).collect();
            Curve {
                line: Series {
                    label: (if right && up { "fold" } else { "" }).to_owned(),
                    x: values(&part, over[0]),
                    y: values(&part, over[1]),
                },
                stroke: Stroke::Dotted,
            }
        };
        quarters.into_iter().map(curve).collect()
    }
}

/// Panels (b) and (c): existence of motions.
fn existence(b: &Chart, c: &Chart) -> Claim {
    let empty = |chart: &Chart| chart.cells.iter().filter(|cells| cells.is_empty()).count();
    let ours = format!(
        "motions are missing at {} and {} of {} grid points",
        empty(b),
        empty(c),
        b.cells.len()
    );
    // A row or column of the grid may touch ψ̇ = 0, where straight rolling is a family.
    let holds = empty(b) + empty(c) <= 4 * b.axes[0].count;
    Statement {
        place: "figure 3(b), (c)",
        published: "the steady motions (13) are a surface over the planes of (b) and (c)",
        command: COMMAND,
    }
    .found(ours, holds)
}

/// Panel (c): the stability of every motion against (21).
fn verdicts(wheel: Mechanism, chart: &Chart) -> Result<Claim, Error> {
    let base = appell_analysis::Point::initial(wheel.0);
    let mut wrong = 0;
    for cell in chart.cells.iter().flatten() {
        let point = cell_point(chart, &cell.unknowns, &base);
        let [tilt, yaw, pitch] =
            ["theta", "psi_dot", "phi_dot"].map(|name| wheel.value(name, &point));
        let (tilt, yaw, pitch) = (tilt?, yaw?, pitch?);
        let square = 0.8 * GRAVITY / RADIUS * tilt.cos()
            - (yaw * yaw + 2.8 * yaw * pitch * tilt.sin() + 2.4 * pitch * pitch);
        wrong += usize::from((square > 0.0) != (cell.verdict == Verdict::Unstable));
    }
    let ours = format!(
        "{wrong} motions on {} grid points have another verdict than (21)",
        chart.cells.len()
    );
    let statement = Statement {
        place: "figure 3(c)",
        published: "green and red areas are stable and unstable motions",
        command: COMMAND,
    };
    Ok(statement.found(ours, wrong == 0))
}

/// Panel (c): the tilt of the fold that agrees least with 𝒱.
fn farthest_fold(chart: &Chart) -> Claim {
    let folds = chart
        .boundaries
        .iter()
        .flat_map(|boundary| &boundary.folds)
        .filter(|fold| fold.decides && fold.axis == 0);
    let tilts = folds.map(|fold| fold.at[0].to_degrees().abs());
    let wanted = limit_tilt().to_degrees();
    let farthest = tilts.min_by_key(|tilt| digits(wanted, *tilt));
    Statement {
        place: "(23)",
        published: "𝒱 = 18.62°: beyond this tilt every motion is stable",
        command: COMMAND,
    }
    .number([wanted, farthest.unwrap_or(f64::NAN)], 12)
}

/// The dashed line of panel (c).
fn infinite(claims: &mut Vec<Claim>, wheel: Mechanism) -> Result<(), Error> {
    let place = "figure 3(c), dashed line";
    let (tilt, yaw) = (10f64.to_radians(), 0.02);
    let branches = wheel.branches(&[("theta", tilt)], "psi_dot", [yaw, 5.0])?;
    let first = branches.first().and_then(|branch| branch.points.first());
    let pitch = first
        .map(|at| wheel.value("phi_dot", &at.point))
        .transpose()?;
    let product = pitch.unwrap_or(f64::NAN) * yaw;
    let wanted = -2.0 * GRAVITY * tilt.tan() / (3.0 * RADIUS);
    let published =
        "φ̇ → ±∞ where ψ̇ → 0 at a tilt: φ̇ ψ̇ → −2 g tan ϑ/(3 R), here at ϑ = 10°, ψ̇ = 0.02 rad/s";
    let claim = Statement {
        place,
        published,
        command: "appell steady rolling_wheel --fix theta=10deg --along psi_dot=0.02..5",
    }
    .number([wanted, product], 4);
    claims.push(claim.approximately());
    let none = wheel.has_none(&[("theta", tilt), ("psi_dot", 0.0)], 20)?;
    let ours = if none {
        "none is found at ϑ = 10°, ψ̇ = 0"
    } else {
        "one is found"
    };
    let statement = Statement {
        place,
        published: "on the dashed line there is no tilted motion",
        command: "appell steady rolling_wheel --fix theta=10deg --fix psi_dot=0",
    };
    claims.push(statement.found(ours, none));
    Ok(())
}

/// Unstable motions at a grid point.
fn unstable(cells: &[Cell]) -> usize {
    let grows = |cell: &&Cell| cell.verdict == Verdict::Unstable;
    cells.iter().filter(grows).count()
}

/// Panel (d): number of motions.
fn counted(claims: &mut Vec<Claim>, chart: &Chart) {
    let count = |is: &dyn Fn(&[Cell]) -> bool| chart.cells.iter().filter(|cells| is(cells)).count();
    let all = chart.cells.len();
    let green = count(&|cells| cells.len() == 2 && unstable(cells) == 0);
    let yellow = count(&|cells| cells.len() == 2 && unstable(cells) == 1);
    let none = count(&<[Cell]>::is_empty);
    let others = all - green - yellow - none;
    for (place, published, ours, holds) in [
        (
            "figure 3(d), dark green",
            "two stable steady states with different yaw rates",
            format!("{green} of {all} grid points"),
            green > 0,
        ),
        (
            "figure 3(d), yellow",
            "a stable and an unstable steady state",
            format!("{yellow} of {all} grid points; {others} beside the fold have one motion"),
            yellow > 0 && others * 1000 < all,
        ),
        (
            "figure 3(d), white",
            "no steady state exists regardless of the yaw rate",
            format!("{none} of {all} grid points"),
            none > 0,
        ),
    ] {
        let statement = Statement {
            place,
            published,
            command: COMMAND_D,
        };
        claims.push(statement.found(ours, holds));
    }
}

/// Panel (d): stability beyond the limit tilt.
fn beyond_limit(chart: &Chart) -> Claim {
    let limit = limit_tilt();
    let columns = chart.axes[0].count;
    let beyond = |index: usize| chart.axes[0].value(index % columns).abs() > limit;
    let cells = chart.cells.iter().enumerate();
    let wrong = cells.filter(|(index, cells)| beyond(*index) && unstable(cells) > 0);
    let wrong = wrong.count();
    Statement {
        place: "figure 3(d)",
        published: "beyond 𝒱 both motions are stable",
        command: COMMAND_D,
    }
    .found(
        format!("{wrong} grid points beyond 𝒱 have an unstable motion"),
        wrong == 0,
    )
}

/// The fold: dφ̇/dψ̇ = 0 of (14), which is ψ̇² = 4 g/(5 R cos ϑ).
fn folded(folds: &Folds) -> Claim {
    let agree = folds.0.iter().map(|[tilt, yaw, _]| {
        let wanted = 4.0 * GRAVITY / (5.0 * RADIUS * tilt.cos());
        digits(wanted, yaw * yaw)
    });
    let agree = agree.min().unwrap_or(0);
    let count = folds.0.len();
    Statement {
        place: "figure 3(b), (c), (d), dotted",
        published: "dotted curves: the folding of the surface, the outer edges of the sand glass in (d)",
        command: COMMAND_D,
    }
    .found(
        format!("{count} folds found, ψ̇² = 4 g/(5 R cos ϑ) in {agree} digits"),
        agree >= 8 && count >= 2 * ROWS as usize,
    )
}
