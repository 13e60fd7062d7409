//! Figure 7: characteristic roots of straight rolling, without and with the sliding mass.

use appell_analysis::{Branch, Change, Kind, loci};
use appell_report::figure::{Figure, Mark, Panel, Series};
use appell_spectra::spectrum::Complex;

use crate::book::claim::{Picture, Section, Statement};
use crate::book::steady_motions::{GRAVITY, Mechanism, RADIUS, values};
use appell::Error;

/// Pitch rates that are drawn, in rad/s.
const RANGE: [f64; 2] = [0.05, 8.0];
const COMMAND: &str =
    "appell stability unicycle --fix psi_dot=0 --along phi_dot=0.05..8 --plot figure_7.svg";

/// The root loci, and the jump of the critical pitch rate.
pub(super) fn section() -> Result<Section, Error> {
    let wheel = Mechanism::shipped("rolling_wheel")?;
    let wheel = wheel.branches(&[("psi_dot", 0.0), ("theta", 0.0)], "phi_dot", RANGE)?;
    let unicycle = straight(5.0)?;
    let [first, second] = [3.0, 2.0].map(|k: f64| (GRAVITY / (k * RADIUS)).sqrt());

    let mut claims = Vec::new();
    let first_rate = |branches: &[Branch]| critical(branches).first().copied().unwrap_or(f64::NAN);
    let statement = Statement {
        place: "figure 7, wheel",
        published: "the roots λ₁,₂ of the rolling wheel decide: critical at √(g/(3R))",
        command: "appell stability rolling_wheel --fix psi_dot=0 --fix theta=0 --along phi_dot=0.05..8",
    };
    claims.push(statement.number([first, first_rate(&wheel)], 12));
    for mass in [1e-3, 1.0, 5.0, 30.0] {
        let found = straight(mass)?;
        let published = format!(
            "the unicycle is critical at √(g/(2R)) whatever its masses, here m₀ = {mass} kg"
        );
        claims.push(
            Statement {
                place: "figure 7, (54)",
                published: &published,
                command: COMMAND,
            }
            .number([second, first_rate(&found)], 11),
        );
    }
    // The jump: between the two critical rates a small mass leaves a slow unstable root.
    let between = 0.5 * (first + second);
    let published = "the critical pitch rate jumps as soon as m₀ > 0: λ₃,₄ decide, not λ₁,₂";
    let light = straight(1e-3)?;
    let squares = squares_at(&light, between);
    let wheel_square = squares_at(&wheel, between);
    let (fast, slow) = (squares.first().copied(), squares.last().copied());
    let near = fast
        .zip(wheel_square.first().copied())
        .is_some_and(|(a, b)| (a - b).norm() < 0.02 * b.norm());
    let grows = slow.is_some_and(|q| q.re > 0.0) && fast.is_some_and(|q| q.re < 0.0);
    let shown = |q: Option<Complex<f64>>| q.map_or_else(String::new, |q| format!("{:.4}", q.re));
    let ours = format!(
        "with m₀ = 1 g at {between:.2} rad/s: λ₁,₂² = {} 1/s², as of the wheel ({}), and λ₃,₄² = {} 1/s² > 0",
        shown(fast),
        shown(wheel_square.first().copied()),
        shown(slow)
    );
    claims.push(
        Statement {
            place: "figure 7",
            published,
            command: COMMAND,
        }
        .found(ours, near && grows),
    );

    let figure = Figure {
        title: "Characteristic roots of straight rolling".to_owned(),
        x_label: "φ̇ [rad/s]".to_owned(),
        panels: vec![
            panel(&wheel, &unicycle, "Re", |z| z.re),
            panel(&wheel, &unicycle, "Im", |z| z.im),
        ],
        marks: vec![
            Mark {
                x: first,
                about: "the wheel stands up: √(g/(3R))".to_owned(),
            },
            Mark {
                x: second,
                about: "the unicycle stands up: √(g/(2R))".to_owned(),
            },
        ],
        equal_axes: false,
    };
    Ok(Section {
        title: "Figure 7: characteristic roots".to_owned(),
        about: "Roots over the pitch rate in straight rolling, modes followed through their crossings.".to_owned(),
        claims,
        pictures: vec![Picture {
            svg: figure.to_svg(),
            caption: "Rolling wheel and unicycle of table I (m₀ = 5 kg). Dashed: the critical pitch rates of \
                      the wheel, 3.30 rad/s, and of the unicycle, 4.04 rad/s."
                .to_owned(),
        }],
    })
}

/// Straight rolling with a sliding mass in kg: the branch without tilt.
fn straight(mass: f64) -> Result<Vec<Branch>, Error> {
    let unicycle = Mechanism::shipped("unicycle")?;
    unicycle.branches(&[("m0", mass), ("psi_dot", 0.0)], "phi_dot", RANGE)
}

fn critical(branches: &[Branch]) -> Vec<f64> {
    values(branches, |special| {
        special.kind == Kind::Critical(Change::RealZero)
    })
}

/// Squares of the deciding eigenvalues at the point next to a value, largest first.
fn squares_at(branches: &[Branch], value: f64) -> Vec<Complex<f64>> {
    let points = branches.iter().flat_map(|branch| &branch.points);
    let near = points.min_by(|a, b| (a.value - value).abs().total_cmp(&(b.value - value).abs()));
    let mut squares: Vec<Complex<f64>> = near.map_or_else(Vec::new, |point| {
        point
            .stability
            .eigenvalues()
            .iter()
            .map(|z| z * z)
            .collect()
    });
    squares.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
    squares
}

fn panel(
    wheel: &[Branch],
    unicycle: &[Branch],
    name: &str,
    part: fn(&Complex<f64>) -> f64,
) -> Panel {
    let lines = |branches: &[Branch], who: &str| -> Vec<Series> {
        let Some(branch) = branches.first() else {
            return Vec::new();
        };
        let x: Vec<f64> = branch.points.iter().map(|point| point.value).collect();
        let modes = loci(branch.points.iter().map(|point| &point.stability));
        let line = |(number, locus): (usize, &Vec<Complex<f64>>)| Series {
            label: format!("{name} λ{} {who}", number + 1),
            x: x.clone(),
            y: locus.iter().map(part).collect(),
        };
        modes.iter().enumerate().map(line).collect()
    };
    Panel {
        unit: "1/s".to_owned(),
        series: [lines(wheel, "wheel"), lines(unicycle, "")].concat(),
    }
}
