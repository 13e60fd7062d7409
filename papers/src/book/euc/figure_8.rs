//! Figure 8: the error between the two torques over the height, for both models and four manoeuvres.

use appell_report::figure::{Figure, Panel, Series};

use super::laboratory::Laboratory;
use super::rider::Manoeuvre;
use super::torque::{Curve, Planar};
use crate::book::claim::{Claim, NOT_PUBLIC, Picture, Section};
use appell::Error;

const COMMAND: &str = "appell reproduce euc";

/// The curves of a manoeuvre: three and two degrees of freedom.
struct Curves {
    manoeuvre: Manoeuvre,
    three: Curve,
    two: Curve,
    /// Three degrees of freedom, the rider's angle seen from the pedals.
    pedals: Curve,
}

pub(super) fn section(laboratory: &Laboratory) -> Result<Section, Error> {
    let [three, two] = Planar::both()?;
    let curves = laboratory.sessions.iter().map(|session| {
        Ok(Curves {
            manoeuvre: session.manoeuvre,
            three: Curve::of(three, &session.by_3)?,
            two: Curve::of(two, &session.by_3)?,
            pedals: Curve::of(three, &session.by_pedals)?,
        })
    });
    let curves: Vec<Curves> = curves.collect::<Result<_, Error>>()?;
    let mut claims = Vec::new();
    order(&mut claims, &curves);
    for own in &curves {
        models(&mut claims, own);
    }
    flatness(&mut claims, &curves);
    for own in &curves {
        let [height, error] = own.three.least;
        let end = if own.three.is_open() {
            ", where the tried heights end"
        } else {
            ""
        };
        let ours = format!(
            "h = {height:.2} m{end}, RMSE {error:.2} N m; true h = {:.3} m",
            laboratory.height
        );
        let place = format!("figure 8, {}", own.manoeuvre.name());
        let published = "the h with the least error is the rider's";
        let close = (height - laboratory.height).abs() < 0.05 * laboratory.height;
        claims.push(Claim::finding(&place, published, ours, close, COMMAND));
        let [height, error] = own.pedals.least;
        let ours = format!(
            "seen from the pedals, about which the 3 DoF rider turns: h = {height:.2} m, RMSE {error:.2} N m. (3) sees \
             the rider from the wheel centre, about which the 2 DoF rider turns"
        );
        let claim = Claim::that(&place, "the rider's angle by (3)", ours, true, COMMAND);
        claims.push(claim.added());
    }
    let panel = |own: &Curves| Panel {
        unit: "N m".to_owned(),
        series: [
            (&own.three, three.name),
            (&own.two, two.name),
            (&own.pedals, "3 DoF, seen from the pedals"),
        ]
        .map(|(curve, name)| Series {
            label: format!("{}, {name}", own.manoeuvre.name()),
            x: curve.heights.clone(),
            y: curve.errors.clone(),
        })
        .to_vec(),
    };
    let figure = Figure {
        title: "RMSE between M_d,1 and M_d,2".to_owned(),
        x_label: "h [m]".to_owned(),
        panels: curves.iter().map(panel).collect(),
        marks: Vec::new(),
        equal_axes: false,
    };
    Ok(Section {
        title: "Figure 8: error over height".to_owned(),
        about: "The paper's way to the height h: the root mean square of M_d,1 − M_d,2 is made least. Its findings are \
                stated as it states them, and hold or do not hold on the simulated rides; nothing was tuned to make \
                them hold."
            .to_owned(),
        claims,
        pictures: vec![Picture {
            svg: figure.to_svg(),
            caption: "Figure 8: the error of the two models over the height, for each manoeuvre.".to_owned(),
        }],
    })
}

/// The manoeuvres with the smallest and the largest error.
fn order(claims: &mut Vec<Claim>, curves: &[Curves]) {
    let error = |own: &Curves| own.three.least[1];
    let list: Vec<String> = (curves.iter())
        .map(|own| format!("{} {:.2} N m", own.manoeuvre.name(), error(own)))
        .collect();
    let list = list.join(", ");
    let best = curves.iter().min_by(|a, b| error(a).total_cmp(&error(b)));
    let worst = curves.iter().max_by(|a, b| error(a).total_cmp(&error(b)));
    let is = |own: Option<&Curves>, manoeuvre| own.is_some_and(|own| own.manoeuvre == manoeuvre);
    claims.push(Claim::finding(
        "figure 8",
        "deceleration has the smallest error at the optimal h",
        &list,
        is(best, Manoeuvre::Deceleration),
        COMMAND,
    ));
    claims.push(Claim::finding(
        "figure 8",
        "figure-eight has the largest error at the optimal h",
        &list,
        is(worst, Manoeuvre::FigureEight),
        COMMAND,
    ));
}

/// Comparison of the two models.
fn models(claims: &mut Vec<Claim>, own: &Curves) {
    let place = format!("figure 8, {}", own.manoeuvre.name());
    let [three, two] = [own.three.least, own.two.least];
    claims.push(Claim::finding(
        &place,
        "3 DoF has the smaller error at its minimum",
        format!("{:.3} N m and {:.3} N m", three[1], two[1]),
        three[1] < two[1],
        COMMAND,
    ));
    claims.push(Claim::finding(
        &place,
        "3 DoF identifies the larger h",
        format!("{:.3} m and {:.3} m", three[0], two[0]),
        three[0] > two[0],
        COMMAND,
    ));
}

/// Flat curves.
fn flatness(claims: &mut Vec<Claim>, curves: &[Curves]) {
    let rise = |manoeuvre: Manoeuvre| {
        let own = curves.iter().find(|own| own.manoeuvre == manoeuvre);
        own.map_or(f64::NAN, |own| own.three.rise())
    };
    let [straight, speeding, braking, eight] = Manoeuvre::ALL.map(rise);
    let ours = format!(
        "from the least error to the largest between 0.1 m and 1.6 m: constant speed {straight:.1} N m, acceleration \
         {speeding:.1} N m, deceleration {braking:.1} N m, figure-eight {eight:.1} N m"
    );
    for (published, rise) in [
        (
            "the curve of constant speed is flat: a large range of h gives similar torques",
            straight,
        ),
        (
            "the curve of figure-eight is flat: a large range of h gives similar torques",
            eight,
        ),
    ] {
        let flat = rise < speeding.min(braking);
        claims.push(Claim::finding("figure 8", published, &ours, flat, COMMAND));
    }
    claims.push(
        Claim::that(
            "figure 8",
            "the printed curves",
            "stand in a picture alone; their numbers depend on recordings that nobody can get",
            true,
            COMMAND,
        )
        .unchecked(NOT_PUBLIC),
    );
}
