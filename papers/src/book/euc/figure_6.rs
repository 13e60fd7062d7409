//! Figures 6 and 7: processed data of decelerations and of a figure-eight.

use appell_recordings::motion_capture::Smoothed;
use appell_report::figure::{Figure, Panel, Series};

use super::laboratory::{Laboratory, Session};
use super::rider::Manoeuvre;
use super::torque::{Curve, Planar};
use crate::book::claim::{Claim, NOT_PUBLIC, Picture, Section, Statement};
use crate::book::failed;
use appell::Error;

/// Published values of a manoeuvre: height in m, error in N m.
struct Printed {
    figure: &'static str,
    manoeuvre: Manoeuvre,
    published: &'static str,
}

const PRINTED: [Printed; 2] = [
    Printed {
        figure: "figure 6",
        manoeuvre: Manoeuvre::Deceleration,
        published: "h = 0.61 m, RMSE 4.7599 N m",
    },
    Printed {
        figure: "figure 7",
        manoeuvre: Manoeuvre::FigureEight,
        published: "h = 0.28 m, RMSE 13.5626 N m",
    },
];

const COMMAND: &str =
    "appell motion SKELETON ride.csv; appell inverse euc_3dof --data recording --free h";

pub(super) fn section(laboratory: &Laboratory) -> Result<Section, Error> {
    let [three, _] = Planar::both()?;
    let mut claims = Vec::new();
    let mut pictures = Vec::new();
    for printed in &PRINTED {
        let session = laboratory.session(printed.manoeuvre)?;
        let best = Curve::of(three, &session.by_3)?.least;
        claims.push(
            Statement {
                place: printed.figure,
                published: printed.published,
                command: COMMAND,
            }
            .found(
                format!(
                    "h = {:.2} m, RMSE {:.2} N m on the simulated rides; true h = {:.3} m",
                    best[0], best[1], laboratory.height
                ),
                true,
            )
            .unchecked(NOT_PUBLIC),
        );
        let [gamma, phi] = [1, 2].map(|channel| largest(session, channel).to_degrees());
        claims.push(
            Statement {
                place: printed.figure,
                published: "the pitch angle γ of the body remains small",
                command: COMMAND,
            }
            .found(
                format!("|γ| ≤ {gamma:.1}° while |ϕ| ≤ {phi:.1}°"),
                gamma < 10.0,
            ),
        );
        let off = torque_off(three, session, best[0])?;
        claims.push(
            Statement {
                place: printed.figure,
                published: "nothing: the torque was not measured",
                command: COMMAND,
            }
            .found(
                format!(
                    "the mean of M_d,1 and M_d,2 is off the true torque by {off:.2} N m, root mean square"
                ),
                off.is_finite(),
            )
            .added(),
        );
        pictures.push(Picture {
            svg: figure(three, session, best[0], printed.figure)?.to_svg(),
            caption: format!(
                "{}: {} runs of {}. Yaw and tilt of the unicycle, pitch of body and rider, driving torque of the first run. \
                 The filter's window is {} frames.",
                capitalised(printed.figure),
                session.by_3.rides.len(),
                session.manoeuvre.name(),
                session.by_3.window
            ),
        });
    }
    claims.extend(braking(laboratory)?);
    Ok(Section {
        title: "Figures 6 and 7: processed data".to_owned(),
        about: "Derivatives by one Savitzky-Golay filter for all signals; the rider's angle by (3); the torque by (9) \
                and (10) at the height with the least difference between them. The paper's numbers depend on its \
                recordings, which nobody can get; beside them stand those of the simulated rides."
            .to_owned(),
        claims,
        pictures,
    })
}

/// What happens to the pitch angles while the rider brakes.
fn braking(laboratory: &Laboratory) -> Result<[Claim; 2], Error> {
    let braking = laboratory.session(Manoeuvre::Deceleration)?;
    let lowest = (braking.by_3.smoothed.iter())
        .flat_map(|run| run.channels[2].derivative(0))
        .fold(0.0, f64::min);
    // γ at the largest backward lean of the rider, and its value before.
    let fall = |run: &Smoothed| {
        let [gamma, phi] = [1, 2].map(|channel| run.channels[channel].derivative(0));
        let most = (0..phi.len()).min_by(|&a, &b| phi[a].total_cmp(&phi[b]));
        gamma[most.unwrap_or(0)] - gamma[0]
    };
    let runs = &braking.by_3.smoothed;
    let gamma = runs.iter().map(fall).sum::<f64>() / runs.len() as f64;
    let ours = format!(
        "where ϕ is least γ has changed by {:.1}° in the mean; the simulated motor law is not the paper's",
        gamma.to_degrees()
    );
    Ok([
        Statement {
            place: "figure 6",
            published: "as the rider leans back, the pitch angle γ of the body also decreases",
            command: COMMAND,
        }
        .simulated(ours, gamma < 0.0),
        Statement {
            place: "figure 6",
            published: "the rider leans back to reduce the speed: ϕ is negative",
            command: COMMAND,
        }
        .found(
            format!("ϕ falls to {:.1}°", lowest.to_degrees()),
            lowest < -0.05,
        ),
    ])
}

fn capitalised(text: &str) -> String {
    text.replacen('f', "F", 1)
}

fn largest(session: &Session, channel: usize) -> f64 {
    let runs = session.by_3.smoothed.iter();
    runs.flat_map(|run| run.channels[channel].derivative(0))
        .fold(0.0, |most, angle| angle.abs().max(most))
}

/// Root mean square of the difference from the true driving torque.
fn torque_off(planar: Planar, session: &Session, height: f64) -> Result<f64, Error> {
    let (mut squares, mut count) = (0.0, 0);
    for (run, motion) in session.motions.iter().enumerate() {
        let found = planar.torques(&session.by_3, run, height, 1)?;
        let truth = motion.column("M_d").ok_or_else(|| failed("no torque"))?;
        for (row, truth) in truth.iter().enumerate().take(found.first.len()) {
            squares += (0.5 * (found.first[row] + found.second[row]) - truth).powi(2);
            count += 1;
        }
    }
    Ok((squares / f64::from(count)).sqrt())
}

fn figure(planar: Planar, session: &Session, height: f64, title: &str) -> Result<Figure, Error> {
    let degrees = |values: Vec<f64>| values.into_iter().map(f64::to_degrees).collect();
    let times = |run: usize| session.by_3.rides[run].times.clone();
    let runs = 0..session.by_3.rides.len();
    let angle = |letter: &str, of: &dyn Fn(usize) -> Vec<f64>| {
        let series = runs.clone().map(|run| Series {
            label: if run == 0 {
                letter.to_owned()
            } else {
                String::new()
            },
            x: times(run),
            y: degrees(of(run)),
        });
        Panel {
            unit: "deg".to_owned(),
            series: series.collect(),
        }
    };
    let smoothed = |run: usize| &session.by_3.smoothed[run];
    let torques = planar.torques(&session.by_3, 0, height, 1)?;
    let truth = session.motions[0].column("M_d").unwrap_or_default();
    let line = |label: &str, y: Vec<f64>| Series {
        label: label.to_owned(),
        x: times(0),
        y,
    };
    Ok(Figure {
        title: format!("{}: {}", capitalised(title), session.manoeuvre.name()),
        x_label: "t [s]".to_owned(),
        panels: vec![
            angle("ψ", &|run| smoothed(run).angles[0].derivative(0)),
            angle("ϑ", &|run| smoothed(run).angles[1].derivative(0)),
            angle("γ", &|run| smoothed(run).channels[1].derivative(0)),
            angle("ϕ", &|run| smoothed(run).channels[2].derivative(0)),
            Panel {
                unit: "N m".to_owned(),
                series: vec![
                    line("M_d,1", torques.first),
                    line("M_d,2", torques.second),
                    line("true", truth),
                ],
            },
        ],
        marks: Vec::new(),
        equal_axes: false,
    })
}
