//! Equations whose content are numbers: circles, critical values, ranks, poles; results beyond the paper.

use appell_analysis::control::controllability::{Controllability, output_rank};
use appell_analysis::{Change, Kind, Special, circle};
use appell_spectra::spectrum::characteristic_polynomial;

use super::figure_5::place_in_spinning;
use super::manoeuvres::{Path, Run};
use super::tables::{POLE, placed, steered, straight};
use crate::book::claim::digits;
use crate::book::steady_motions::{
    GRAVITY, Mechanism, RADIUS, SLIDER_MASS, WHEEL_MASS, critical_values, first_critical,
};
use crate::book::{Part, Result, Section, computation};
use crate::steering::OUTPUTS;

/// A tilt at which the turning wheel has two critical yaw rates, in degrees.
const TILT: f64 = 10.0;

/// The numbers.
pub(super) fn section(_: usize) -> Result<Section> {
    let mut part = Part::read(include_str!("numbers.toml"))?;
    circles(&mut part)?;
    wheel(&mut part)?;
    unicycle(&mut part)?;
    ranks(&mut part)?;
    poles(&mut part)?;
    references(&mut part)?;
    Ok(part.section())
}

/// (11), (12): a turning motion draws circles.
fn circles(part: &mut Part) -> Result<()> {
    let wheel = Mechanism::shipped("rolling_wheel")?;
    let (tilt, turn) = (TILT.to_radians(), 2.0);
    let problem = wheel.problem(&[("theta", tilt), ("psi_dot", turn)])?;
    let motion = problem.solve().map_err(computation)?;
    let [spin] = wheel.values(["phi_dot"], &motion.point)?;
    for (key, names, wanted) in [
        (
            "circle_of_the_centre",
            ["x_G", "y_G"],
            spin / turn + tilt.sin(),
        ),
        ("circle_of_the_contact", ["x_P", "y_P"], spin / turn),
    ] {
        let [x, y] = names.map(|name| wheel.term(name));
        let path = circle(wheel.0, &motion.point, [x?, y?]);
        part.number(key, [wanted.abs() * RADIUS, path.radius])?;
    }
    Ok(())
}

/// (22) to (31): critical rates of the wheel.
fn wheel(part: &mut Part) -> Result<()> {
    let wheel = Mechanism::shipped("rolling_wheel")?;
    let tilt = TILT.to_radians();
    let turning = wheel.branches(&[("theta", tilt)], "psi_dot", [0.5, 12.0])?;
    let rates = critical_values(&turning);
    let (s, c) = (tilt.sin().powi(2), tilt.cos());
    let root = (76.0 * s * s - 96.0 * s + 9.0).sqrt();
    for (index, sign) in [(0, 1.0), (1, -1.0)] {
        let square = (3.0 - 6.0 * c * c + sign * root) / ((2.0 * s - 3.0) * c);
        let wanted = (2.0 * GRAVITY / (5.0 * RADIUS) * square).sqrt();
        let found = rates.get(index).copied().unwrap_or(f64::NAN);
        part.set("number", index + 1);
        part.number("turning_wheel", [wanted, found])?;
    }

    let upright = [("psi_dot", 0.0), ("theta", 0.0)];
    let rolling = wheel.branches(&upright, "phi_dot", [0.5, 10.0])?;
    let wanted = (GRAVITY / (3.0 * RADIUS)).sqrt();
    part.number("rolling_wheel", [wanted, first_critical(&rolling)])?;
    let rolling = wheel.branches(&upright, "speed", [0.1, 3.0])?;
    let wanted = (GRAVITY * RADIUS / 3.0).sqrt();
    part.number("speed_of_the_wheel", [wanted, first_critical(&rolling)])?;
    let spinning = wheel.branches(&[("phi_dot", 0.0)], "psi_dot", [0.5, 10.0])?;
    let wanted = (4.0 * GRAVITY / (5.0 * RADIUS)).sqrt();
    part.number("spinning_wheel", [wanted, first_critical(&spinning)])
}

/// (42), (46), (54) and section IV.B: the unicycle.
fn unicycle(part: &mut Part) -> Result<()> {
    let unicycle = Mechanism::shipped("unicycle")?;
    let tilt = TILT.to_radians();
    let excluded =
        (2.0 * SLIDER_MASS * GRAVITY / (3.0 * WHEEL_MASS * RADIUS * tilt.cos().powi(3))).sqrt();
    let none = unicycle.has_none(&[("theta", tilt), ("psi_dot", excluded)], 60)?;
    let ours = if none {
        "no steady motion is found at ϑ = 10°"
    } else {
        "a steady motion is found"
    };
    part.set("excluded", excluded);
    part.found("excluded", ours, none)?;

    let motions = unicycle.isolated(&[("theta", tilt), ("phi_dot", 0.0)])?;
    let place = |point| unicycle.values(["r"], point).map(|[place]| place);
    let places: Vec<f64> = motions.iter().map(place).collect::<Result<_>>()?;
    let found = places.first().copied().unwrap_or(f64::NAN);
    part.number("tilted_spinning", [place_in_spinning(tilt), found])?;
    let above = !places.is_empty() && places.iter().all(|r| r * tilt > 0.0);
    let ours = format!("r ϑ > 0 in all {} motions found", places.len());
    part.found("mass_above", ours, above)?;

    let rolling = unicycle.branches(&[("psi_dot", 0.0)], "phi_dot", [0.5, 10.0])?;
    let wanted = (GRAVITY / (2.0 * RADIUS)).sqrt();
    part.number("rolling_unicycle", [wanted, first_critical(&rolling)])?;
    let rolling = unicycle.branches(&[("psi_dot", 0.0)], "speed", [0.1, 3.0])?;
    let critical = first_critical(&rolling);
    part.number("printed_speed", [1.21, critical])?;
    let wanted = (RADIUS * GRAVITY / 2.0).sqrt();
    part.number("speed_of_the_unicycle", [wanted, critical])
}

/// (56), (57), (63): controllability.
fn ranks(part: &mut Part) -> Result<()> {
    let (mut states, mut lane, mut turn) = (Vec::new(), Vec::new(), Vec::new());
    for speed in [1.0, 5.0] {
        let (equations, outputs) = straight(speed, &OUTPUTS)?;
        let controllable = Controllability::of(&equations.system).map_err(computation)?;
        states.push(controllable.rank);
        lane.push(output_rank(&equations.system, &outputs));
        turn.push(output_rank(&equations.system, &outputs[..5]));
    }
    for (key, found, wanted) in [
        ("controllable_states", states, 6),
        ("controllable_lane", lane, 6),
        ("controllable_turn", turn, 5),
    ] {
        let holds = found.iter().all(|rank| *rank == wanted);
        part.found(key, format!("{found:?} at 1 and 5 m/s"), holds)?;
    }
    Ok(())
}

/// (67): all poles of the closed loop are placed.
fn poles(part: &mut Part) -> Result<()> {
    for outputs in [&OUTPUTS[..], &OUTPUTS[..5]] {
        let mut worst = 15;
        for speed in [1.0, 5.0] {
            let gain = placed(speed, outputs)?;
            let closed = steered(speed, outputs)?.system.closed(&gain);
            let found = characteristic_polynomial(&closed).map_err(computation)?;
            // (λ + 8)ⁿ
            let times = |polynomial: Vec<f64>, _: &&str| {
                let padded = polynomial.iter().chain(&[0.0]);
                let shifted = [0.0].iter().chain(&polynomial);
                padded.zip(shifted).map(|(a, b)| a - POLE * b).collect()
            };
            let wanted: Vec<f64> = outputs.iter().fold(vec![1.0], times);
            let pairs = wanted.iter().zip(&found);
            worst = pairs.fold(worst, |worst, (a, b)| worst.min(digits(*a, *b)));
        }
        part.set("outputs", outputs.len());
        part.set("worst", worst);
        let ours = format!("coefficients of the characteristic polynomial agree in {worst} digits");
        part.found("poles", ours, worst >= 9)?;
    }
    Ok(())
}

/// (66), (71): the desired paths.
fn references(part: &mut Part) -> Result<()> {
    let printed_turn = Path {
        end: -Path::TURN.end,
        ..Path::TURN
    };
    let printed_lane = Path::printed_lane(10.0);
    for (key, printed, right, unit) in [
        ("lane", printed_lane, Path::lane(10.0), "m"),
        ("turn", printed_turn, Path::TURN, "rad"),
    ] {
        let [before, after] = [printed.jump(), right.jump()];
        let ours = format!(
            "as printed it jumps by {before:.2} {unit}, as corrected by {after:.1e} {unit}"
        );
        part.found(key, ours, before > 1.0 && after < 1e-9)?;
    }
    Ok(())
}

pub(super) fn additional(_: usize) -> Result<Section> {
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
