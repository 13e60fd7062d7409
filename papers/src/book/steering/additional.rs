//! Results beyond the paper.

use appell_analysis::{Change, Kind, Special};

use super::manoeuvres::{Path, Run};
use crate::book::steady_motions::{GRAVITY, Mechanism, RADIUS, SLIDER_MASS, WHEEL_MASS};
use crate::book::{Part, Result, Section};

/// The additional results.
pub(super) fn section(_: usize) -> Result<Section> {
    let mut part = Part::read(include_str!("additional.toml"))?;
    hoop(&mut part)?;
    discriminant(&mut part)?;
    as_printed(&mut part)?;
    Ok(part.section())
}

/// The critical tilt depends on the inertia.
fn hoop(part: &mut Part) -> Result<()> {
    let hoop = Mechanism::shipped("axisymmetric_wheel")?;
    let axes = [("theta", [-1.0, 1.0], 40), ("psi_dot", [0.5, 8.0], 40)];
    let chart = hoop.chart(&[], axes, &[])?;
    let folds = chart.boundaries.iter().flat_map(|boundary| &boundary.folds);
    let tilts = folds
        .filter(|fold| fold.axis == 0)
        .map(|fold| fold.at[0].to_degrees().abs());
    part.number("hoop", [19.203_773_871_3, tilts.fold(f64::NAN, f64::max)])
}

/// (51) to (54): a, b, c > 0 is not enough; b² > 4ac is needed, and always holds.
fn discriminant(part: &mut Part) -> Result<()> {
    let (m, g) = (WHEEL_MASS, GRAVITY);
    let mut smallest = f64::INFINITY;
    for m0 in [0.01, 0.1, 1.0, SLIDER_MASS, 10.0, 30.0, 1000.0] {
        for k in 0..=400 {
            let square = 0.5 * f64::from(k);
            let a = 5.0 * m * RADIUS * RADIUS;
            let b = 12.0 * square * m * RADIUS * RADIUS + 4.0 * (m0 - m) * g * RADIUS;
            let c = 4.0 * m0 * g * (2.0 * square * RADIUS - g);
            smallest = smallest.min((b * b - 4.0 * a * c) / (b * b + (4.0 * a * c).abs()));
        }
    }
    let ours = format!(
        "as a polynomial in φ̇²R/g it has the discriminant −20 m² m₀ (3m + m₀) < 0; the smallest (b² − 4ac)/(b² + |4ac|) \
         of 2807 samples is {smallest:.2e}"
    );
    part.found("discriminant", ours, smallest > 0.0)?;

    let unicycle = Mechanism::shipped("unicycle")?;
    let branches = unicycle.branches(&[("psi_dot", 0.0)], "phi_dot", [0.05, 20.0])?;
    let specials = branches.iter().flat_map(|branch| &branch.specials);
    let oscillates = |special: &&Special| matches!(special.kind, Kind::Critical(change) if change != Change::RealZero);
    let count = specials.filter(oscillates).count();
    let ours = format!("{count} oscillations meet or begin to grow from 0.05 to 20 rad/s");
    part.found("no_oscillation", ours, count == 0)
}

/// The closed loops with the paths as printed.
fn as_printed(part: &mut Part) -> Result<()> {
    let jumping = |width: f64, speed: f64| Run::new(Path::printed_lane(width), speed);
    let between = Run {
        gains_at: 5.0,
        ..Run::new(Path::lane(10.0), 2.0)
    };
    for (key, run) in [
        ("printed_at_1_m_s", jumping(2.5, 1.0)),
        ("printed_at_5_m_s", jumping(10.0, 5.0)),
        ("printed_at_2_m_s", between),
    ] {
        let (motion, ending) = run.motion(0.01)?;
        let last = motion.times().last().copied().unwrap_or(0.0);
        let ours = match &ending {
            Some(_) => format!("the wheel falls after {last:.2} s"),
            None => "the manoeuvre is carried out".to_owned(),
        };
        part.found(key, ours, ending.is_some())?;
    }
    Ok(())
}
