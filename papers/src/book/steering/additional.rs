//! Results beyond the paper.

use appell_analysis::{Change, Kind};

use super::manoeuvres::{Path, Run};
use crate::book::claim::{Claim, Section, Statement};
use crate::book::steady_motions::{GRAVITY, Mechanism, RADIUS, SLIDER_MASS, WHEEL_MASS};
use appell::Error;

/// The additional results.
pub(super) fn section() -> Result<Section, Error> {
    let mut claims = Vec::new();
    hoop(&mut claims)?;
    discriminant(&mut claims)?;
    as_printed(&mut claims)?;
    Ok(Section {
        title: "Results beyond the paper".to_owned(),
        about: "Statements that are not in the paper, and what its printed formulas would do."
            .to_owned(),
        claims,
        pictures: Vec::new(),
    })
}

/// The critical tilt depends on the inertia.
fn hoop(claims: &mut Vec<Claim>) -> Result<(), Error> {
    let hoop = Mechanism::shipped("axisymmetric_wheel")?;
    let axes = [("theta", [-1.0, 1.0], 40), ("psi_dot", [0.5, 8.0], 40)];
    let chart = hoop.chart(&[], axes, &[])?;
    let folds = chart.boundaries.iter().flat_map(|boundary| &boundary.folds);
    let tilts = folds
        .filter(|fold| fold.axis == 0)
        .map(|fold| fold.at[0].to_degrees().abs());
    let tilt = tilts.fold(f64::NAN, f64::max);
    let claim = Statement {
        place: "after (23)",
        published: "𝒱 is a constant of any rolling wheel; but of a thin hoop it is 19.2037738713°",
        command: "appell stability axisymmetric_wheel --chart theta=-1..1,psi_dot=0.5..8",
    }
    .number([19.203_773_871_3, tilt], 12);
    claims.push(claim.erratum("over-claim"));
    Ok(())
}

/// (51) to (54): a, b, c > 0 is not enough; b² > 4ac is needed, and always holds.
fn discriminant(claims: &mut Vec<Claim>) -> Result<(), Error> {
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
    let command = "appell stability unicycle --fix psi_dot=0 --along phi_dot=0.05..8";
    let published = "b² > 4ac, without which the roots are a complex quadruple, is not mentioned; it always holds";
    let claim = Statement {
        place: "(51)–(54)",
        published,
        command,
    }
    .found(ours, smallest > 0.0);
    claims.push(claim.added());

    let unicycle = Mechanism::shipped("unicycle")?;
    let branches = unicycle.branches(&[("psi_dot", 0.0)], "phi_dot", [0.05, 20.0])?;
    let specials = branches.iter().flat_map(|branch| &branch.specials);
    let oscillating = specials.filter(
        |special| matches!(special.kind, Kind::Critical(change) if change != Change::RealZero),
    );
    let count = oscillating.count();
    let ours = format!("{count} oscillations meet or begin to grow from 0.05 to 20 rad/s");
    let published = "no complex quadruple appears in straight rolling";
    let claim = Statement {
        place: "(51)–(54)",
        published,
        command,
    }
    .found(ours, count == 0);
    claims.push(claim.added());
    Ok(())
}

/// The closed loops with the paths as printed.
fn as_printed(claims: &mut Vec<Claim>) -> Result<(), Error> {
    let command =
        "appell simulate unicycle --feedback docs/examples/feedback/lane_change_5_m_s.toml";
    let jumping = |width: f64| Path {
        amplitude: width,
        ..Path::lane(width)
    };
    for (place, what, run) in [
        (
            "(66) as printed",
            "the lane change at 1 m/s",
            Run::new(jumping(2.5), 1.0),
        ),
        (
            "(66) as printed",
            "the lane change at 5 m/s",
            Run::new(jumping(10.0), 5.0),
        ),
        (
            "after (66) as printed",
            "L = 10 m at 2 m/s with the gains of table II",
            Run {
                gains_at: 5.0,
                ..Run::new(Path::lane(10.0), 2.0)
            },
        ),
    ] {
        let (motion, ending) = run.motion(0.01)?;
        let ours = match &ending {
            Some(_) => format!(
                "the wheel falls after {:.2} s",
                motion.times().last().copied().unwrap_or(0.0)
            ),
            None => "the manoeuvre is carried out".to_owned(),
        };
        let published = format!("{what} succeeds");
        let claim = Statement {
            place,
            published: &published,
            command,
        }
        .found(ours, ending.is_some());
        claims.push(claim.erratum("undecided"));
    }
    Ok(())
}
