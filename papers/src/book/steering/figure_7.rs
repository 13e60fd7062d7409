//! Figure 7: characteristic roots of straight rolling, without and with the sliding mass.

use appell_analysis::{Branch, loci};
use appell_report::figure::{Figure, Mark, Panel, Series};
use appell_spectra::spectrum::Complex;

use crate::book::steady_motions::{GRAVITY, Mechanism, RADIUS, first_critical};
use crate::book::{Part, Result, Section, line};

/// Pitch rates that are drawn, in rad/s.
const RANGE: [f64; 2] = [0.05, 8.0];

/// The root loci, and the jump of the critical pitch rate.
pub(super) fn section(_: usize) -> Result<Section> {
    let mut part = Part::read(include_str!("figure_7.toml"))?;
    let wheel = Mechanism::shipped("rolling_wheel")?;
    let wheel = wheel.branches(&[("psi_dot", 0.0), ("theta", 0.0)], "phi_dot", RANGE)?;
    let unicycle = straight(5.0)?;
    let [first, second] = [3.0, 2.0].map(|k: f64| (GRAVITY / (k * RADIUS)).sqrt());

    part.number("wheel", [first, first_critical(&wheel)])?;
    for mass in [1e-3, 1.0, 5.0, 30.0] {
        part.set("mass", mass);
        part.number("unicycle", [second, first_critical(&straight(mass)?)])?;
    }
    jump(&mut part, &wheel, 0.5 * (first + second))?;

    let mark = |x, about: &str| Mark {
        x,
        about: about.to_owned(),
    };
    let roots = Figure {
        marks: vec![
            mark(first, "the wheel stands up: √(g/(3R))"),
            mark(second, "the unicycle stands up: √(g/(2R))"),
        ],
        ..Figure::new(
            "Characteristic roots of straight rolling",
            "φ̇ [rad/s]",
            vec![
                parts(&wheel, &unicycle, "Re", |z| z.re),
                parts(&wheel, &unicycle, "Im", |z| z.im),
            ],
        )
    };
    part.picture("roots", roots.to_svg())?;
    Ok(part.section())
}

/// Between the two critical rates a small mass leaves a slow unstable root.
fn jump(part: &mut Part, wheel: &[Branch], between: f64) -> Result<()> {
    let light = squares_at(&straight(1e-3)?, between);
    let wheel = squares_at(wheel, between);
    let (fast, slow, wheel) = (light.first(), light.last(), wheel.first());
    let near = fast
        .zip(wheel)
        .is_some_and(|(a, b)| (a - b).norm() < 0.02 * b.norm());
    let grows = slow.is_some_and(|q| q.re > 0.0) && fast.is_some_and(|q| q.re < 0.0);
    let shown = |q: Option<&Complex<f64>>| q.map_or_else(String::new, |q| format!("{:.4}", q.re));
    let ours = format!(
        "with m₀ = 1 g at {between:.2} rad/s: λ₁,₂² = {} 1/s², as of the wheel ({}), and λ₃,₄² = {} 1/s² > 0",
        shown(fast),
        shown(wheel),
        shown(slow)
    );
    part.found("jump", ours, near && grows)
}

/// Straight rolling with a sliding mass in kg: the branch without tilt.
fn straight(mass: f64) -> Result<Vec<Branch>> {
    let unicycle = Mechanism::shipped("unicycle")?;
    unicycle.branches(&[("m0", mass), ("psi_dot", 0.0)], "phi_dot", RANGE)
}

/// Squares of the deciding eigenvalues at the point next to a value, largest first.
fn squares_at(branches: &[Branch], value: f64) -> Vec<Complex<f64>> {
    let points = branches.iter().flat_map(|branch| &branch.points);
    let near = points.min_by(|a, b| (a.value - value).abs().total_cmp(&(b.value - value).abs()));
    let mut squares: Vec<Complex<f64>> = near.map_or_else(Vec::new, |point| {
        let eigenvalues = point.stability.eigenvalues();
        eigenvalues.iter().map(|z| z * z).collect()
    });
    squares.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
    squares
}

/// Real or imaginary parts of the roots of both mechanisms.
fn parts(
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
        let modes = modes.iter().enumerate();
        let values = |locus: &[Complex<f64>]| locus.iter().map(part).collect();
        modes
            .map(|(number, locus)| {
                let label = format!("{name} λ{} {who}", number + 1);
                line(&label, x.clone(), values(locus))
            })
            .collect()
    };
    Panel::new("1/s", [lines(wheel, "wheel"), lines(unicycle, "")].concat())
}
