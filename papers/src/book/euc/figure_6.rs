//! Figures 6 and 7: processed data of decelerations and of a figure-eight.

use appell_recordings::motion_capture::Smoothed;
use appell_report::figure::{Figure, Panel};

use super::laboratory::{Laboratory, Session};
use super::rider::Manoeuvre;
use super::simulated::simulated;
use super::torque::{Curve, Planar};
use crate::book::{Part, Result, Section, failed, line};

/// Channels of the smoothed rides: pitch of the body and of the rider.
const GAMMA: usize = 1;
const PHI: usize = 2;

pub(super) fn section(laboratory: &Laboratory) -> Result<Section> {
    let mut part = Part::read(include_str!("figure_6.toml"))?;
    let [three, _] = Planar::both()?;
    for (place, manoeuvre) in [
        ("figure 6", Manoeuvre::Deceleration),
        ("figure 7", Manoeuvre::FigureEight),
    ] {
        let session = laboratory.session(manoeuvre)?;
        let [height, error] = Curve::of(three, &session.by_3)?.least;
        let capitalised = place.replacen('f', "F", 1);
        part.set("figure", place);
        let ours = format!(
            "h = {height:.2} m, RMSE {error:.2} N m on the simulated rides; true h = {:.3} m",
            laboratory.height
        );
        part.found(place, ours, true)?;

        let [gamma, phi] = [GAMMA, PHI].map(|channel| largest(session, channel).to_degrees());
        let ours = format!("|γ| ≤ {gamma:.1}° while |ϕ| ≤ {phi:.1}°");
        part.found("small_pitch", ours, gamma < 10.0)?;

        let off = torque_off(three, session, height)?;
        let ours = format!(
            "the mean of M_d,1 and M_d,2 is off the true torque by {off:.2} N m, root mean square"
        );
        part.found("torque", ours, off.is_finite())?;

        part.set("runs", session.by_3.rides.len());
        part.set("manoeuvre", manoeuvre.name());
        part.set("window", session.by_3.window);
        let title = format!("{capitalised}: {}", manoeuvre.name());
        part.set("Figure", capitalised);
        let torques = three.torques(&session.by_3, 0, height, 1)?;
        let figure = processed(&title, session, &torques);
        part.picture("data", figure.to_svg())?;
    }
    braking(&mut part, laboratory)?;
    Ok(part.section())
}

/// What happens to the pitch angles while the rider brakes.
fn braking(part: &mut Part, laboratory: &Laboratory) -> Result<()> {
    let runs = &laboratory.session(Manoeuvre::Deceleration)?.by_3.smoothed;
    // γ at the largest backward lean of the rider, and its value before.
    let fall = |run: &Smoothed| {
        let [gamma, phi] = [GAMMA, PHI].map(|channel| run.channels[channel].derivative(0));
        let most = (0..phi.len()).min_by(|&a, &b| phi[a].total_cmp(&phi[b]));
        gamma[most.unwrap_or(0)] - gamma[0]
    };
    let gamma = runs.iter().map(fall).sum::<f64>() / runs.len() as f64;
    let ours = format!(
        "where ϕ is least γ has changed by {:.1}° in the mean; the simulated motor law is not the paper's",
        gamma.to_degrees()
    );
    simulated(part, "body_while_braking", &ours, gamma < 0.0)?;

    let leans = runs.iter().flat_map(|run| run.channels[PHI].derivative(0));
    let lowest = leans.fold(0.0, f64::min);
    let ours = format!("ϕ falls to {:.1}°", lowest.to_degrees());
    part.found("rider_while_braking", ours, lowest < -0.05)
}

fn largest(session: &Session, channel: usize) -> f64 {
    let runs = session.by_3.smoothed.iter();
    runs.flat_map(|run| run.channels[channel].derivative(0))
        .fold(0.0, |most, angle| angle.abs().max(most))
}

/// Root mean square of the difference from the true driving torque.
fn torque_off(planar: Planar, session: &Session, height: f64) -> Result<f64> {
    let (mut squares, mut count) = (0.0, 0);
    for (run, motion) in session.motions.iter().enumerate() {
        let found = planar.torques(&session.by_3, run, height, 1)?;
        let truth = motion.column("M_d").ok_or_else(|| failed("no torque"))?;
        for ([first, second], truth) in found.iter().zip(&truth) {
            squares += (0.5 * (first + second) - truth).powi(2);
            count += 1;
        }
    }
    Ok((squares / f64::from(count)).sqrt())
}

/// Angles of all runs, and the driving torque of the first.
fn processed(title: &str, session: &Session, torques: &[[f64; 2]]) -> Figure {
    let times = |run: usize| session.by_3.rides[run].times.clone();
    let runs = || session.by_3.smoothed.iter().enumerate();
    let angle = |letter: &str, of: &dyn Fn(&Smoothed) -> Vec<f64>| {
        let series = runs().map(|(run, smoothed)| {
            let degrees = of(smoothed).into_iter().map(f64::to_degrees);
            let label = if run == 0 { letter } else { "" };
            line(label, times(run), degrees.collect())
        });
        Panel::new("deg", series.collect())
    };
    let truth = session.motions[0].column("M_d").unwrap_or_default();
    let [first, second] = [0, 1].map(|k| torques.iter().map(|pair| pair[k]).collect());
    let torques = [("M_d,1", first), ("M_d,2", second), ("true", truth)]
        .map(|(label, torque)| line(label, times(0), torque));
    let panels = vec![
        angle("ψ", &|run| run.angles[0].derivative(0)),
        angle("ϑ", &|run| run.angles[1].derivative(0)),
        angle("γ", &|run| run.channels[GAMMA].derivative(0)),
        angle("ϕ", &|run| run.channels[PHI].derivative(0)),
        Panel::new("N m", torques.to_vec()),
    ];
    Figure::new(title, "t [s]", panels)
}
