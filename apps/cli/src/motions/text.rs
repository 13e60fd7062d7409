//! Steady motions as text tables, in the units of the spec.

use std::fmt::Write as _;

use appell_analysis::{Branch, Change, End, Kind, Special, Stability, SteadyMotion, circle};
use appell_runtime::contact::ContactForces;
use appell_runtime::model::ModelInfo;
use appell_spectra::spectrum::Complex;

use appell::steady::Resolved;
use appell::steady::export::in_words as verdict;
use appell_report::row;
use appell_report::text::{number, table};

/// Largest number of motions side by side.
const COLUMNS: usize = 6;

/// Essential states and ignorable coordinates.
pub(crate) fn structure(asked: &Resolved<'_>) -> String {
    let info = asked.problem.model().info();
    let names = |states: &[usize]| {
        let names: Vec<&str> = states
            .iter()
            .map(|&s| info.states[s].name.as_ref())
            .collect();
        if names.is_empty() {
            "none".to_owned()
        } else {
            names.join(", ")
        }
    };
    let structure = asked.problem.structure();
    let turning: Vec<usize> = (0..info.state_len())
        .filter(|&state| structure.turns(state))
        .collect();
    let turning = match &turning[..] {
        [] => String::new(),
        all => format!("  turning    {}\n", names(all)),
    };
    format!(
        "{}\n  essential  {}\n  ignorable  {}\n{turning}",
        info.title,
        names(&structure.essential),
        names(&structure.ignorable),
    )
}

/// Motions side by side.
pub(crate) fn motions(asked: &Resolved<'_>, motions: &[(SteadyMotion, Stability)]) -> String {
    let (model, shown) = (
        asked.problem.model(),
        &motions[..motions.len().min(COLUMNS)],
    );
    let info = model.info();
    let mut rows = Vec::new();
    let mut row =
        |name: String, unit: String, value: &dyn Fn(&(SteadyMotion, Stability)) -> String| {
            let values = shown.iter().map(value);
            rows.push(
                std::iter::once(name)
                    .chain(values)
                    .chain([unit])
                    .collect::<Vec<_>>(),
            );
        };
    for term in asked.terms() {
        let quantity = term.quantity(info);
        row(
            quantity.name.to_string(),
            quantity.unit.to_string(),
            &|(motion, _)| number(quantity.to_unit(tidy(term.value(model, &motion.point)))),
        );
    }
    for (place, name) in asked.places() {
        row(
            format!("radius of the path of {name}"),
            "m".to_owned(),
            &|(motion, _)| {
                let radius = circle(model, &motion.point, place).radius;
                if radius.is_finite() {
                    number(radius)
                } else {
                    "straight".to_owned()
                }
            },
        );
    }
    for (i, contact) in info.contacts.iter().enumerate() {
        let force = |motion: &SteadyMotion| {
            let mut forces = ContactForces::new();
            forces
                .at(model, motion.point.at())
                .get(i)
                .copied()
                .unwrap_or_default()
        };
        row(
            format!("normal force {}", contact.name),
            "N".to_owned(),
            &|(m, _)| number(force(m).normal),
        );
        if contact.grips {
            row(
                format!("friction demand {}", contact.name),
                String::new(),
                &|(m, _)| number(tidy(force(m).demand())),
            );
        }
    }
    let count = motions.len();
    let mut text = match count {
        1 => "1 steady motion\n".to_owned(),
        _ => format!("{count} steady motions\n"),
    };
    text += &table(&rows, 1..1 + shown.len());
    for outside in asked.problem.outside(asked.starts) {
        let _ = writeln!(
            text,
            "  one more outside of a range: {outside}; `--ignore-ranges` shows it"
        );
    }
    if count > shown.len() {
        let _ = writeln!(
            text,
            "  {} more; `--json` and `--csv` list all",
            count - shown.len()
        );
    }
    for (i, (_, stability)) in shown.iter().enumerate() {
        let which = if count == 1 {
            String::new()
        } else {
            format!("{}: ", i + 1)
        };
        let _ = writeln!(text, "  {which}{}", verdict(stability.verdict));
    }
    text
}

/// Rounding errors become zero.
fn tidy(value: f64) -> f64 {
    if value.abs() < 1e-14 { 0.0 } else { value }
}

/// One eigenvalue.
pub(crate) fn eigenvalue(value: Complex<f64>) -> String {
    if value.im == 0.0 {
        return number(tidy(value.re));
    }
    let sign = if value.im < 0.0 { '-' } else { '+' };
    format!(
        "{} {sign} {} i",
        number(tidy(value.re)),
        number(value.im.abs())
    )
}

/// Branches with their special points.
pub(crate) fn branches(asked: &Resolved<'_>, branches: &[Branch]) -> String {
    let Some((along, _)) = asked.along else {
        return String::new();
    };
    let info = asked.problem.model().info();
    let quantity = along.quantity(info);
    let mut text = String::new();
    for (i, branch) in branches.iter().enumerate() {
        let ends = [branch.points.first(), branch.points.last()];
        let ends = ends.map(|end| end.map_or(f64::NAN, |end| quantity.to_unit(end.value)));
        let _ = writeln!(
            text,
            "branch {}: {} = {} … {} {}, {} points{}",
            i + 1,
            quantity.name,
            number(ends[0]),
            number(ends[1]),
            quantity.unit,
            branch.points.len(),
            why(info, branch.ends),
        );
        let mut rows = Vec::new();
        let first = branch.points.first().map(|point| point.stability.verdict);
        if let Some(first) = first {
            rows.push(row!["beginning", "", verdict(first)]);
        }
        for (k, special) in branch.specials.iter().enumerate() {
            let next = branch.specials.get(k + 1).map(|next| next.after);
            let at = |place: usize| branch.points.get(place).map(|p| p.stability.verdict);
            let (before, behind) = (at(special.after), at(special.after + 1));
            let mut what = event(asked, special);
            if let Some(behind) = behind.filter(|_| behind != before && next != Some(special.after))
            {
                let _ = write!(what, "; {} beyond", verdict(behind));
            }
            let value = quantity.to_unit(special.motion.value);
            rows.push(row![exact(value), quantity.unit, what]);
        }
        text += &table(&rows, 0..1);
    }
    text
}

/// A value that is exact to rounding, with all its digits.
pub(crate) fn exact(value: f64) -> String {
    format!("{value:.14}")
}

fn why(info: &ModelInfo, ends: [End; 2]) -> String {
    let one = |end: End| match end {
        End::Range => None,
        End::State(state) => Some(format!("the range of {}", info.states[state].name)),
        End::Infinity => Some("infinity".to_owned()),
        End::Closed => Some("its beginning".to_owned()),
        End::Infeasible(_) => Some("the limit of feasibility".to_owned()),
        End::Lost => Some("the last motion found".to_owned()),
        End::Points => Some("the maximum number of points".to_owned()),
    };
    match ends.map(one) {
        _ if ends == [End::Closed; 2] => ", closed".to_owned(),
        [None, None] => String::new(),
        [Some(first), None] => format!(", from {first}"),
        [None, Some(last)] => format!(", up to {last}"),
        [Some(first), Some(last)] => format!(", from {first} up to {last}"),
    }
}

fn event(asked: &Resolved<'_>, special: &Special) -> String {
    let info = asked.problem.model().info();
    match special.kind {
        Kind::Fold => "fold: the branch turns back".to_owned(),
        Kind::Crossing => "another branch crosses".to_owned(),
        Kind::Critical(change) => change_text(change),
        Kind::Feasibility(number) => match asked.requirements.get(number) {
            Some(requirement) => {
                format!("limit of feasibility: {}", requirement.term.name(info))
            }
            None => "a contact lifts".to_owned(),
        },
    }
}

/// Behaviour of the eigenvalues at a critical point.
pub(crate) fn change_text(change: Change) -> String {
    match change {
        Change::RealZero => "a real eigenvalue passes through zero".to_owned(),
        Change::Oscillation { frequency } => format!(
            "a complex pair of {} rad/s crosses the imaginary axis",
            number(frequency)
        ),
        Change::Collision { frequency } => {
            format!("two imaginary pairs of {} rad/s collide", number(frequency))
        }
    }
}
