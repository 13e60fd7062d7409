//! Figure 8: the error between the two torques over the height, for both models and four manoeuvres.

use super::laboratory::Laboratory;
use super::rider::Manoeuvre;
use super::simulated::simulated;
use super::torque::{Curve, Planar};
use crate::book::{Part, Result, Section, line};
use appell_report::figure::{Figure, Panel};

/// The curves of a manoeuvre: three and two degrees of freedom.
struct Curves {
    manoeuvre: Manoeuvre,
    three: Curve,
    two: Curve,
    /// Three degrees of freedom, the rider's angle seen from the pedals.
    pedals: Curve,
}

pub(super) fn section(laboratory: &Laboratory) -> Result<Section> {
    let [three, two] = Planar::both()?;
    let curves = laboratory.sessions.iter().map(|session| {
        Ok(Curves {
            manoeuvre: session.manoeuvre,
            three: Curve::of(three, &session.by_3)?,
            two: Curve::of(two, &session.by_3)?,
            pedals: Curve::of(three, &session.by_pedals)?,
        })
    });
    let curves: Vec<Curves> = curves.collect::<Result<_>>()?;
    let mut part = Part::read(include_str!("figure_8.toml"))?;
    order(&mut part, &curves)?;
    for set in &curves {
        part.set("manoeuvre", set.manoeuvre.name());
        let [three, two] = [set.three.least, set.two.least];
        let ours = format!("{:.3} N m and {:.3} N m", three[1], two[1]);
        simulated(&mut part, "smaller_error", &ours, three[1] < two[1])?;
        let ours = format!("{:.3} m and {:.3} m", three[0], two[0]);
        simulated(&mut part, "larger_height", &ours, three[0] > two[0])?;
    }
    flatness(&mut part, &curves)?;
    for set in &curves {
        part.set("manoeuvre", set.manoeuvre.name());
        heights(&mut part, set, laboratory.height)?;
    }
    let panels = curves.iter().map(|set| {
        let lines = [
            (&set.three, three.name),
            (&set.two, two.name),
            (&set.pedals, "3 DoF, seen from the pedals"),
        ];
        let lines = lines.map(|(curve, name)| {
            let label = format!("{}, {name}", set.manoeuvre.name());
            line(&label, curve.heights.clone(), curve.errors.clone())
        });
        Panel::new("N m", lines.to_vec())
    });
    let figure = Figure::new("RMSE between M_d,1 and M_d,2", "h [m]", panels.collect());
    part.picture("curves", figure.to_svg())?;
    Ok(part.section())
}

/// The manoeuvres with the smallest and the largest error.
fn order(part: &mut Part, curves: &[Curves]) -> Result<()> {
    let error = |set: &Curves| set.three.least[1];
    let list: Vec<String> = (curves.iter())
        .map(|set| format!("{} {:.2} N m", set.manoeuvre.name(), error(set)))
        .collect();
    let list = list.join(", ");
    let best = curves.iter().min_by(|a, b| error(a).total_cmp(&error(b)));
    let worst = curves.iter().max_by(|a, b| error(a).total_cmp(&error(b)));
    let is = |set: Option<&Curves>, manoeuvre| set.is_some_and(|set| set.manoeuvre == manoeuvre);
    simulated(part, "smallest", &list, is(best, Manoeuvre::Deceleration))?;
    simulated(part, "largest", &list, is(worst, Manoeuvre::FigureEight))
}

/// Flat curves.
fn flatness(part: &mut Part, curves: &[Curves]) -> Result<()> {
    let rise = |manoeuvre: Manoeuvre| {
        let set = curves.iter().find(|set| set.manoeuvre == manoeuvre);
        set.map_or(f64::NAN, |set| set.three.rise())
    };
    let [straight, speeding, braking, eight] = Manoeuvre::ALL.map(rise);
    let ours = format!(
        "from the least error to the largest between 0.1 m and 1.6 m: constant speed {straight:.1} N m, acceleration \
         {speeding:.1} N m, deceleration {braking:.1} N m, figure-eight {eight:.1} N m"
    );
    for (manoeuvre, rise) in [("constant speed", straight), ("figure-eight", eight)] {
        part.set("manoeuvre", manoeuvre);
        simulated(part, "flat", &ours, rise < speeding.min(braking))?;
    }
    let ours = "stand in a picture alone; their numbers depend on recordings that nobody can get";
    part.found("curves", ours, true)
}

/// The height with the least error, with the rider's angle by (3) and about the pedals.
fn heights(part: &mut Part, set: &Curves, truth: f64) -> Result<()> {
    let [height, error] = set.three.least;
    let end = if set.three.is_open() {
        ", where the tried heights end"
    } else {
        ""
    };
    let ours = format!("h = {height:.2} m{end}, RMSE {error:.2} N m; true h = {truth:.3} m");
    let close = (height - truth).abs() < 0.05 * truth;
    simulated(part, "height", &ours, close)?;
    let [height, error] = set.pedals.least;
    let ours = format!(
        "seen from the pedals, about which the 3 DoF rider turns: h = {height:.2} m, RMSE {error:.2} N m. (3) sees the \
         rider from the wheel centre, about which the 2 DoF rider turns"
    );
    part.found("angle", ours, true)
}
