//! Figure 3: level sets and stability of the steady motions of the rolling wheel.

use crate::errata::ERRATA;
use appell_analysis::{Cell, Chart, Kind, Verdict};
use appell_report::figure::{Curve, Patch, Series, Stroke, Surface};

use super::equations::misprint;
use crate::book::claim::{Claim, Picture, Section, digits};
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
const COMMAND: &str = "appell stability rolling_wheel --chart theta=-60deg..60deg,psi_dot=-10..10 --plot figure_3c.svg";

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
    let tilts = [-TILT_DEG.to_radians(), TILT_DEG.to_radians()];
    let rates = [-RATE, RATE];
    let panel = |names: [&str; 2], count| {
        let range = |name| if name == "theta" { tilts } else { rates };
        let axes = names.map(|name| (name, range(name), count));
        wheel.chart(&[], axes, &[])
    };
    let a = panel(["psi_dot", "phi_dot"], PIECES)?;
    let b = panel(["psi_dot", "phi_dot"], grid)?;
    let c = panel(["theta", "psi_dot"], grid)?;
    let d = panel(["theta", "phi_dot"], grid)?;
    let folds = folds(wheel)?;

    let mut claims = Vec::new();
    whole(&mut claims, wheel, &b, &c)?;
    infinite(&mut claims, wheel)?;
    counted(&mut claims, &d, &folds);

    let levels_of_tilt = [5.0, 10.0, 20.0, 30.0, 50.0].map(f64::to_radians);
    let levels_of_rate = [1.0, 2.0, 4.0, 8.0];
    let level = |quantity, values: &[f64], along, over| {
        let range = if along == "theta" { tilts } else { rates };
        levels(wheel, quantity, values, (along, range), over)
    };
    let mut maps = Vec::new();
    for (title, chart, over, levels) in [
        (
            "(b) levels of the tilt",
            &b,
            ["psi_dot", "phi_dot"],
            level(
                ["theta", "ϑ"],
                &levels_of_tilt,
                "psi_dot",
                ["psi_dot", "phi_dot"],
            )?,
        ),
        (
            "(c) levels of the pitch rate",
            &c,
            ["theta", "psi_dot"],
            level(
                ["phi_dot", "φ̇"],
                &levels_of_rate,
                "theta",
                ["theta", "psi_dot"],
            )?,
        ),
        (
            "(d) levels of the yaw rate",
            &d,
            ["theta", "phi_dot"],
            level(
                ["psi_dot", "ψ̇"],
                &levels_of_rate,
                "theta",
                ["theta", "phi_dot"],
            )?,
        ),
    ] {
        let mut map = regions::map(title, chart, over.map(shown));
        map.curves.extend(levels);
        map.curves.extend(folds.curves(over));
        maps.push(map);
    }
    maps[1].curves.push(Curve {
        line: Series {
            label: "φ̇ → ±∞".to_owned(),
            x: vec![-TILT_DEG, TILT_DEG],
            y: vec![0.0; 2],
        },
        stroke: Stroke::Dashed,
    });
    let flat = maps.iter().map(appell_report::figure::Map::to_svg);
    let pictures = std::iter::once(surface(wheel, &a)?.to_svg()).chain(flat);
    let pictures = pictures.zip(CAPTIONS).map(|(svg, caption)| Picture {
        svg,
        caption: caption.to_owned(),
    });
    Ok(Section {
        title: "Figure 3: steady motions of the rolling wheel".to_owned(),
        about:
            "The panels (b), (c) and (d) are projections of the surface of steady motions (13), \
                panel (a), along ϑ, φ̇ and ψ̇. Stable means neutrally stable: eigenvalues on the \
                imaginary axis."
                .to_owned(),
        claims,
        pictures: pictures.collect(),
    })
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

/// Curves on which a quantity, by its name and letter, has one of the values or its opposite.
fn levels(
    wheel: Mechanism,
    [fixed, letter]: [&str; 2],
    values: &[f64],
    (along, range): (&str, [f64; 2]),
    over: [&str; 2],
) -> Result<Vec<Curve>, Error> {
    let mut all = Vec::new();
    for value in values.iter().flat_map(|value| [-value, *value]) {
        let branches = wheel.branches(&[(fixed, value)], along, range)?;
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
        let steep = 75f64.to_radians();
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
        let place = |name: &str| match name {
            "theta" => 0,
            "psi_dot" => 1,
            _ => 2,
        };
        let values = |part: &[&[f64; 3]], name: &str| {
            let values = part.iter().map(|fold| fold[place(name)]).collect();
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

/// Panels (b) and (c): existence and stability of motions.
fn whole(claims: &mut Vec<Claim>, wheel: Mechanism, b: &Chart, c: &Chart) -> Result<(), Error> {
    let full = |chart: &Chart| chart.cells.iter().filter(|cells| cells.is_empty()).count();
    let published = "the steady motions (13) are a surface over the planes of (b) and (c)";
    let ours = format!(
        "motions are missing at {} and {} of {} places",
        full(b),
        full(c),
        b.cells.len()
    );
    // A row or column of the grid may touch ψ̇ = 0, where straight rolling is a family.
    let holds = full(b) + full(c) <= 4 * b.axes[0].count;
    claims.push(Claim::that(
        "figure 3(b), (c)",
        published,
        ours,
        holds,
        COMMAND,
    ));

    // Every cell against (21).
    let mut wrong = 0;
    for cell in c.cells.iter().flatten() {
        let base = appell_analysis::Point::initial(wheel.0);
        let point = cell_point(c, &cell.unknowns, &base);
        let [tilt, yaw, pitch] =
            ["theta", "psi_dot", "phi_dot"].map(|name| wheel.value(name, &point));
        let (tilt, yaw, pitch) = (tilt?, yaw?, pitch?);
        let square = 0.8 * GRAVITY / RADIUS * tilt.cos()
            - (yaw * yaw + 2.8 * yaw * pitch * tilt.sin() + 2.4 * pitch * pitch);
        wrong += usize::from((square > 0.0) != (cell.verdict == Verdict::Unstable));
    }
    let ours = format!(
        "{wrong} of {} motions have another verdict than (21)",
        c.cells.len()
    );
    let published = "green and red areas are stable and unstable motions";
    claims.push(Claim::that(
        "figure 3(c)",
        published,
        ours,
        wrong == 0,
        COMMAND,
    ));

    let folds = c
        .boundaries
        .iter()
        .flat_map(|boundary| &boundary.folds)
        .filter(|fold| fold.decides);
    let tilts = folds
        .filter(|fold| fold.axis == 0)
        .map(|fold| fold.at[0].to_degrees().abs());
    let published = "𝒱 = 18.62°: beyond this tilt every motion is stable";
    let wanted = 18.623_570_746_969_177;
    let farthest = tilts.min_by_key(|tilt| digits(wanted, *tilt));
    let pair = [wanted, farthest.unwrap_or(f64::NAN)];
    claims.push(Claim::number("(23)", published, pair, 12, COMMAND));
    Ok(())
}

/// The dashed line of panel (c), and the identification of the panels.
fn infinite(claims: &mut Vec<Claim>, wheel: Mechanism) -> Result<(), Error> {
    let (tilt, yaw) = (10f64.to_radians(), 0.02);
    let branches = wheel.branches(&[("theta", tilt)], "psi_dot", [yaw, 5.0])?;
    let first = branches.first().and_then(|branch| branch.points.first());
    let pitch = first
        .map(|at| wheel.value("phi_dot", &at.point))
        .transpose()?;
    let product = pitch.unwrap_or(f64::NAN) * yaw;
    let published =
        "φ̇ → ±∞ where ψ̇ → 0 at a tilt: φ̇ ψ̇ → −2 g tan ϑ/(3 R), here at ϑ = 10°, ψ̇ = 0.02 rad/s";
    let wanted = -2.0 * GRAVITY * tilt.tan() / (3.0 * RADIUS);
    let command = "appell steady rolling_wheel --fix theta=10deg --along psi_dot=0.02..5";
    let place = "figure 3(c), dashed line";
    let claim = Claim::number(place, published, [wanted, product], 4, command);
    claims.push(claim.approximately());
    let none = wheel
        .problem(&[("theta", tilt), ("psi_dot", 0.0)])?
        .solve_all(20)
        .is_err();
    let published = "on the dashed line there is no tilted motion";
    let ours = if none {
        "none is found at ϑ = 10°, ψ̇ = 0"
    } else {
        "one is found"
    };
    let command = "appell steady rolling_wheel --fix theta=10deg --fix psi_dot=0";
    claims.push(Claim::that(place, published, ours, none, command));
    let on_figures = ERRATA
        .iter()
        .filter(|erratum| erratum.equation == "text on figure 3");
    claims.extend(on_figures.map(misprint));
    Ok(())
}

/// Panel (d): number of motions.
fn counted(claims: &mut Vec<Claim>, chart: &Chart, folds: &Folds) {
    let unstable = |cells: &[Cell]| {
        let grows = |cell: &&Cell| cell.verdict == Verdict::Unstable;
        cells.iter().filter(grows).count()
    };
    let pairs = |wanted: usize| {
        let pairs = chart.cells.iter().filter(|cells| cells.len() == 2);
        pairs.filter(|cells| unstable(cells) == wanted).count()
    };
    let number = |count: usize| {
        chart
            .cells
            .iter()
            .filter(|cells| cells.len() == count)
            .count()
    };
    let all = chart.cells.len();
    let (green, yellow, none) = (pairs(0), pairs(1), number(0));
    let others = all - green - yellow - none;
    let command = "appell stability rolling_wheel --chart theta=-60deg..60deg,phi_dot=-10..10";
    let mut that = |place: &str, published: &str, ours: String, holds: bool| {
        claims.push(Claim::that(place, published, ours, holds, command));
    };
    that(
        "figure 3(d), dark green",
        "two stable steady states with different yaw rates",
        format!("{green} of {all} places"),
        green > 0,
    );
    that(
        "figure 3(d), yellow",
        "a stable and an unstable steady state",
        format!("{yellow} of {all} places; {others} beside the fold have one motion"),
        yellow > 0 && others * 1000 < all,
    );
    that(
        "figure 3(d), white",
        "no steady state exists regardless of the yaw rate",
        format!("{none} of {all} places"),
        none > 0,
    );
    let limit = 18.623_570_746_969_177_f64.to_radians();
    let columns = chart.axes[0].count;
    let beyond = chart.cells.iter().enumerate().filter(|(place, cells)| {
        chart.axes[0].value(place % columns).abs() > limit && unstable(cells) > 0
    });
    let beyond = beyond.count();
    that(
        "figure 3(d)",
        "beyond 𝒱 both motions are stable",
        format!("{beyond} places beyond 𝒱 have an unstable motion"),
        beyond == 0,
    );
    // dφ̇/dψ̇ = 0 of (14): ψ̇² = 4 g/(5 R cos ϑ).
    let agree = folds
        .0
        .iter()
        .map(|[tilt, yaw, _]| digits(4.0 * GRAVITY / (5.0 * RADIUS * tilt.cos()), yaw * yaw));
    let agree = agree.min().unwrap_or(0);
    let ours = format!(
        "{} folds found, ψ̇² = 4 g/(5 R cos ϑ) in {agree} digits",
        folds.0.len()
    );
    let published =
        "dotted curves: the folding of the surface, the outer edges of the sand glass in (d)";
    that(
        "figure 3(b), (c), (d), dotted",
        published,
        ours,
        agree >= 8 && folds.0.len() >= 2 * ROWS as usize,
    );
}
