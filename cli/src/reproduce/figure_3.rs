//! Figure 3: level sets and stability of the steady motions of the rolling wheel.

use appell_runtime::analysis::{Branch, Chart, Kind, Verdict};
use appell_runtime::figure::{Curve, Map, Series, Stroke};

use super::claim::{Claim, Picture, Section, Verdict as Fate, digits};
use super::found::{GRAVITY, Mechanism, RADIUS, boundaries, cell_point};
use crate::failure::Failure;

/// Largest tilt that is drawn, in degrees.
const TILT_DEG: f64 = 60.0;
/// Largest rate that is drawn, in rad/s.
const RATE: f64 = 10.0;
/// Beyond it, motions are still followed, so that folds near the edge are found.
const TRACED: f64 = 20.0;
/// Points of the charts along each axis.
const GRID: usize = 160;
/// Columns of panel (d).
const COLUMNS: usize = 60;
const COMMAND: &str = "appell stability rolling_wheel --chart theta=-60deg..60deg,psi_dot=-10..10 --plot figure_3c.svg";
/// One or two kinds of motion at a place of panel (d), and one in the others.
const KINDS: [&str; 6] = [
    "",
    "one stable",
    "one unstable",
    "",
    "stable and unstable",
    "two stable",
];

/// What the panels show.
const CAPTIONS: [&str; 3] = [
    "Panel (b): every pair of yaw and pitch rate has one tilt. Levels at ±5°, ±10°, ±20°, ±30°, ±50°.",
    "Panel (c): levels of the pitch rate at ±1, ±2, ±4, ±8 rad/s; dashed, where it runs to infinity; dotted, the fold.",
    "Panel (d): levels of the yaw rate at ±1, ±2, ±4, ±8 rad/s; the fold is the outer edge of the coloured area.",
];

/// The three panels, and what they are said to show.
pub(super) fn section() -> Result<Section, Failure> {
    let wheel = Mechanism::shipped("rolling_wheel")?;
    let tilt = (
        "theta",
        [-TILT_DEG.to_radians(), TILT_DEG.to_radians()],
        GRID,
    );
    let [yaw, pitch] = ["psi_dot", "phi_dot"].map(|name| (name, [-RATE, RATE], GRID));
    let chart_b = wheel.chart(&[], [yaw, pitch], &[])?;
    let chart_c = wheel.chart(&[], [tilt, yaw], &[])?;
    let columns = columns(wheel)?;
    let folds = folds(wheel, &columns)?;

    let mut claims = Vec::new();
    whole(&mut claims, wheel, &chart_b, &chart_c)?;
    infinite(&mut claims, wheel)?;
    counted(&mut claims, &columns, &folds);

    let level =
        |quantity, values: &[f64], along, over| levels(wheel, quantity, values, along, over);
    let radians = [
        -50.0, -30.0, -20.0, -10.0, -5.0, 5.0, 10.0, 20.0, 30.0, 50.0,
    ]
    .map(f64::to_radians);
    let rates = [-8.0, -4.0, -2.0, -1.0, 1.0, 2.0, 4.0, 8.0];
    let mut curves_b = level(
        ["theta", "ϑ"],
        &radians,
        ("psi_dot", [-RATE, RATE]),
        ["psi_dot", "phi_dot"],
    )?;
    let range = [-TILT_DEG.to_radians(), TILT_DEG.to_radians()];
    let mut curves_c = level(
        ["phi_dot", "φ̇"],
        &rates,
        ("theta", range),
        ["theta", "psi_dot"],
    )?;
    let curves_d = level(
        ["psi_dot", "ψ̇"],
        &rates,
        ("theta", range),
        ["theta", "phi_dot"],
    )?;
    curves_b.extend(boundaries(&chart_b, ["psi_dot", "phi_dot"]));
    curves_b.extend(folds.curves([|f| f[1], |f| f[2]]));
    curves_c.extend(boundaries(&chart_c, ["theta", "psi_dot"]));
    curves_c.extend(folds.curves([|f| f[0].to_degrees(), |f| f[1]]));
    curves_c.push(Curve {
        line: Series {
            label: "φ̇ → ±∞".to_owned(),
            x: vec![-TILT_DEG, TILT_DEG],
            y: vec![0.0; 2],
        },
        stroke: Stroke::Dashed,
    });
    let rate = [-RATE, RATE];
    let b = map(
        "(b) levels of the tilt",
        ["ψ̇ [rad/s]", "φ̇ [rad/s]"],
        [rate, rate],
        &chart_b,
        curves_b,
    );
    let c = map(
        "(c) levels of the pitch rate",
        ["ϑ [deg]", "ψ̇ [rad/s]"],
        [[-TILT_DEG, TILT_DEG], rate],
        &chart_c,
        curves_c,
    );
    let mut d = map(
        "(d) levels of the yaw rate",
        ["ϑ [deg]", "φ̇ [rad/s]"],
        [[-TILT_DEG, TILT_DEG], rate],
        &chart_c,
        curves_d,
    );
    d.counts = [COLUMNS; 2];
    d.cells = (0..COLUMNS * COLUMNS)
        .map(|k| columns[k % COLUMNS].kind(k / COLUMNS))
        .collect();
    d.curves
        .extend(folds.curves([|f| f[0].to_degrees(), |f| f[2]]));
    let maps = [b, c, d];
    let pictures = maps.iter().zip(CAPTIONS).map(|(map, caption)| Picture {
        svg: map.to_svg(),
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

/// Curves on which a quantity, by its name and letter, is constant.
fn levels(
    wheel: Mechanism,
    [fixed, letter]: [&str; 2],
    values: &[f64],
    (along, range): (&str, [f64; 2]),
    over: [&str; 2],
) -> Result<Vec<Curve>, Failure> {
    let mut all = Vec::new();
    for &value in values {
        let branches = wheel.branches(&[(fixed, value)], along, range)?;
        all.extend(wheel.curves(&branches, over, Stroke::Thin)?);
    }
    if let Some(first) = all.first_mut() {
        first.line.label = format!("levels of {letter}");
    }
    Ok(all)
}

fn map(
    title: &str,
    labels: [&str; 2],
    ranges: [[f64; 2]; 2],
    chart: &Chart,
    curves: Vec<Curve>,
) -> Map {
    let kind = |cell: &appell_runtime::analysis::Cell| match cell.verdict {
        Verdict::Unstable => 2,
        _ => 1,
    };
    let two = title.starts_with("(d)");
    let name = |kind: usize| if (kind > 2) == two { KINDS[kind] } else { "" };
    Map {
        title: title.to_owned(),
        labels: labels.map(str::to_owned),
        ranges,
        counts: chart.axes.map(|axis| axis.count),
        kinds: (0..KINDS.len()).map(|kind| name(kind).to_owned()).collect(),
        cells: chart
            .cells
            .iter()
            .map(|cell| cell.as_ref().map(kind))
            .collect(),
        curves,
    }
}

/// A column of panel (d): a tilt and its motions along the pitch rate.
struct Column {
    tilt: f64,
    branches: Vec<Branch>,
}

impl Column {
    /// How many motions are stable and unstable at the pitch rate of a row.
    fn count(&self, row: usize) -> [usize; 2] {
        let pitch = RATE * (2.0 * (row as f64 + 0.5) / COLUMNS as f64 - 1.0);
        let mut count = [0; 2];
        for pair in self
            .branches
            .iter()
            .flat_map(|branch| branch.points.windows(2))
        {
            if (pair[0].value - pitch) * (pair[1].value - pitch) < 0.0 {
                let nearer = (pair[0].value - pitch).abs() > (pair[1].value - pitch).abs();
                let unstable = pair[usize::from(nearer)].stability.verdict == Verdict::Unstable;
                count[usize::from(unstable)] += 1;
            }
        }
        count
    }

    fn kind(&self, row: usize) -> Option<usize> {
        match self.count(row) {
            [0, 0] => None,
            [2, 0] => Some(5),
            [1, 1] => Some(4),
            [0, _] => Some(2),
            _ => Some(1),
        }
    }
}

fn columns(wheel: Mechanism) -> Result<Vec<Column>, Failure> {
    let column = |k: usize| {
        let part = (k as f64 + 0.5) / COLUMNS as f64;
        let tilt = (TILT_DEG * (2.0 * part - 1.0)).to_radians();
        let branches = wheel.branches(&[("theta", tilt)], "phi_dot", [-TRACED, TRACED])?;
        Ok(Column { tilt, branches })
    };
    (0..COLUMNS).map(column).collect()
}

/// Where the pitch rate turns back at a constant tilt: tilt, yaw rate, pitch rate.
struct Folds(Vec<[f64; 3]>);

impl Folds {
    /// The folds with positive and with negative yaw rate, over two of the three.
    fn curves(&self, axes: [fn(&[f64; 3]) -> f64; 2]) -> Vec<Curve> {
        let mut curves = Vec::new();
        for (right, up) in [(true, true), (true, false), (false, true), (false, false)] {
            let part: Vec<&[f64; 3]> = self
                .0
                .iter()
                .filter(|f| (f[0] > 0.0) == right && (f[1] > 0.0) == up)
                .collect();
            curves.push(Curve {
                line: Series {
                    label: (if right && up { "fold" } else { "" }).to_owned(),
                    x: part.iter().map(|f| axes[0](f)).collect(),
                    y: part.iter().map(|f| axes[1](f)).collect(),
                },
                stroke: Stroke::Dotted,
            });
        }
        curves
    }
}

fn folds(wheel: Mechanism, columns: &[Column]) -> Result<Folds, Failure> {
    let mut folds = Vec::new();
    for column in columns {
        let specials = column.branches.iter().flat_map(|branch| &branch.specials);
        for special in specials.filter(|special| special.kind == Kind::Fold) {
            let yaw = wheel.value("psi_dot", &special.motion.point)?;
            folds.push([column.tilt, yaw, special.motion.value]);
        }
    }
    Ok(Folds(folds))
}

/// Panels (b) and (c): where motions exist, and where they are stable.
fn whole(claims: &mut Vec<Claim>, wheel: Mechanism, b: &Chart, c: &Chart) -> Result<(), Failure> {
    let full = |chart: &Chart| chart.cells.iter().filter(|cell| cell.is_none()).count();
    let published = "the steady motions (13) are a surface over the planes of (b) and (c)";
    let ours = format!(
        "motions are missing at {} and {} of {} places",
        full(b),
        full(c),
        GRID * GRID
    );
    // A row or column of the grid may touch ψ̇ = 0, where straight rolling is a family.
    let holds = full(b) + full(c) <= 4 * GRID;
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
        let base = appell_runtime::analysis::Point::initial(wheel.0);
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
        .filter(|boundary| boundary.decides)
        .flat_map(|b| &b.folds);
    let tilts: Vec<f64> = folds
        .filter(|fold| fold.axis == 0)
        .map(|fold| fold.at[0].to_degrees().abs())
        .collect();
    let published = "𝒱 = 18.62°: beyond this tilt every motion is stable";
    let wanted = 18.623_570_746_969_177;
    let ours = tilts.iter().copied().fold(f64::NAN, f64::max);
    let agree = tilts
        .iter()
        .map(|tilt| digits(wanted, *tilt))
        .min()
        .unwrap_or(0);
    let claim = Claim::number("(23)", published, [wanted, ours], 12, COMMAND);
    claims.push(
        Claim {
            holds: agree >= 12,
            ..claim
        }
        .verdict(Fate::Digits(agree)),
    );
    Ok(())
}

/// The dashed line of panel (c), and which panel is which.
fn infinite(claims: &mut Vec<Claim>, wheel: Mechanism) -> Result<(), Failure> {
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
    claims.push(Claim::number(
        "figure 3(c), dashed line",
        published,
        [wanted, product],
        4,
        command,
    ));
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
    claims.push(Claim::that(
        "figure 3(c), dashed line",
        published,
        ours,
        none,
        command,
    ));
    let published = "panels (c) and (d) show the level sets of ψ̇ and φ̇, respectively";
    let ours = "the other way round: the line φ̇ → ±∞ lies in the plane of ϑ and ψ̇, and motions that differ \
                in ψ̇ alone lie over one place of the plane of ϑ and φ̇, so (c) has levels of φ̇ and (d) of ψ̇";
    let claim = Claim::that("text on figure 3", published, ours, true, COMMAND);
    claims.push(claim.verdict(Fate::Erratum("two words swapped")));
    Ok(())
}

/// Panel (d): how many motions there are.
fn counted(claims: &mut Vec<Claim>, columns: &[Column], folds: &Folds) {
    let counts: Vec<(f64, [usize; 2])> = columns
        .iter()
        .flat_map(|column| (0..COLUMNS).map(|row| (column.tilt, column.count(row))))
        .collect();
    let of = |wanted: [usize; 2]| counts.iter().filter(|(_, count)| *count == wanted).count();
    let (none, green, yellow) = (of([0, 0]), of([2, 0]), of([1, 1]));
    let others = counts.len() - none - green - yellow;
    let command = "appell steady rolling_wheel --fix theta=20deg --along phi_dot=-10..10";
    let mut that = |place: &str, published: &str, ours: String, holds: bool| {
        claims.push(Claim::that(place, published, ours, holds, command));
    };
    that(
        "figure 3(d), dark green",
        "two stable steady states with different yaw rates",
        format!("{green} of {} places", counts.len()),
        green > 0,
    );
    that(
        "figure 3(d), yellow",
        "a stable and an unstable steady state",
        format!(
            "{yellow} of {} places; no place has any other pair ({others})",
            counts.len()
        ),
        yellow > 0 && others == 0,
    );
    that(
        "figure 3(d), white",
        "no steady state exists regardless of the yaw rate",
        format!("{none} of {} places", counts.len()),
        none > 0,
    );
    let limit = 18.623_570_746_969_177_f64.to_radians();
    let mixed = counts
        .iter()
        .filter(|(tilt, count)| tilt.abs() > limit && count[1] > 0);
    let ours = format!(
        "{} places beyond 𝒱 have an unstable motion",
        mixed.clone().count()
    );
    that(
        "figure 3(d)",
        "beyond 𝒱 both motions are stable",
        ours,
        mixed.count() == 0,
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
        agree >= 8 && folds.0.len() >= COLUMNS,
    );
}
