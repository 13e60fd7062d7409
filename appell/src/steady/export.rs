//! Steady motions for programs: JSON in SI, CSV in the units of the spec.

use std::io::{self, Write};

use appell_analysis::{Branch, Change, End, Kind, Point, Stability, Term, Verdict, circle};
use appell_runtime::contact::ContactForces;
use serde_json::{Value, json};

use crate::json::{named, object};

use super::{Answer, Resolved};

/// All of the answer.
pub fn json(asked: &Resolved<'_>, answer: &Answer) -> Value {
    let info = asked.problem.model().info();
    let names = |states: &[usize]| -> Vec<&str> {
        states
            .iter()
            .map(|&state| info.states[state].name.as_ref())
            .collect()
    };
    let structure = asked.problem.structure();
    let turning = (0..info.state_len()).filter(|&state| structure.turns(state));
    let turning: Vec<usize> = turning.collect();
    let mut all = json!({
        "schema": "steady/1",
        "mechanism": info.name,
        "essential": names(&structure.essential),
        "ignorable": names(&structure.ignorable),
        "uniform": names(&structure.uniform),
        "turning": names(&turning),
    });
    match answer {
        Answer::Motions(motions) => {
            let motion = |(motion, stability): &(_, _)| {
                let motion: &appell_analysis::SteadyMotion = motion;
                point(asked, &motion.point, stability)
            };
            all["motions"] = motions.iter().map(motion).collect();
        }
        Answer::Branches(branches) => {
            let along = asked.along.map(|(along, _)| along.name(info));
            all["along"] = json!(along);
            all["branches"] = branches.iter().map(|b| branch(asked, b)).collect();
        }
    }
    all
}

fn branch(asked: &Resolved<'_>, branch: &Branch) -> Value {
    let point = |at: &appell_analysis::BranchPoint| {
        let mut told = point(asked, &at.point, &at.stability);
        told["value"] = json!(at.value);
        told["feasible"] = json!(at.feasible);
        told
    };
    let special = |special: &appell_analysis::Special| {
        let mut told = point(&special.motion);
        told["kind"] = json!(kind(special.kind));
        told["after"] = json!(special.after);
        if let Kind::Critical(Change::Oscillation { frequency } | Change::Collision { frequency }) =
            special.kind
        {
            told["frequency"] = json!(frequency);
        }
        told
    };
    json!({
        "ends": branch.ends.map(end),
        "specials": branch.specials.iter().map(special).collect::<Vec<_>>(),
        "points": branch.points.iter().map(point).collect::<Vec<_>>(),
    })
}

/// The word for a special point.
pub fn kind(kind: Kind) -> &'static str {
    match kind {
        Kind::Fold => "fold",
        Kind::Crossing => "crossing",
        Kind::Critical(Change::RealZero) => "real_zero",
        Kind::Critical(Change::Oscillation { .. }) => "oscillation",
        Kind::Critical(Change::Collision { .. }) => "collision",
        Kind::Feasibility(_) => "feasibility",
    }
}

fn end(end: End) -> &'static str {
    match end {
        End::Range => "range",
        End::State(_) => "state_range",
        End::Infinity => "infinity",
        End::Closed => "closed",
        End::Infeasible(_) => "infeasible",
        End::Lost => "lost",
        End::Points => "points",
    }
}

/// A verdict in words.
pub const fn in_words(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Asymptotic => "asymptotically stable",
        Verdict::Neutral => "neutrally stable",
        Verdict::Unstable => "unstable",
        Verdict::Critical => "critical",
    }
}

/// The keyword of a verdict.
pub fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Asymptotic => "asymptotic",
        Verdict::Neutral => "neutral",
        Verdict::Unstable => "unstable",
        Verdict::Critical => "critical",
    }
}

/// One motion in SI.
fn point(asked: &Resolved<'_>, point: &Point, stability: &Stability) -> Value {
    let model = asked.problem.model();
    let info = model.info();
    let uniform = asked.problem.structure().uniform.iter();
    let rates = uniform.map(|&state| {
        let rate = Term::Rate(state);
        (rate.name(info), json!(rate.value(model, point)))
    });
    let paths = asked.places().into_iter().map(|(place, name)| {
        let path = circle(model, point, place);
        let told = json!({
            "radius": path.radius,
            "centre": path.centre,
            "turn_rate": path.turn_rate,
            "speed": path.speed,
        });
        (name, told)
    });
    let mut forces = ContactForces::new();
    let contacts = info.contacts.iter().zip(forces.at(model, point.at()));
    let contacts = contacts.map(|(contact, force)| {
        let told = json!({
            "normal_force": force.normal,
            "tangential_force": force.tangential,
            "friction_demand": force.demand(),
        });
        (&contact.name, told)
    });
    json!({
        "state": named(&info.states, &point.x),
        "inputs": named(&info.inputs, &point.u),
        "parameters": named(&info.parameters, &point.p),
        "rates": object(rates),
        "outputs": named(&info.outputs, &point.outputs(model)),
        "paths": object(paths),
        "contacts": object(contacts),
        "eigenvalues": stability.eigenvalues().iter().map(|z| [z.re, z.im]).collect::<Vec<_>>(),
        "zeros": stability.zeros,
        "family": stability.family,
        "verdict": verdict(stability.verdict),
    })
}

/// A row for every motion or point of a branch.
pub fn csv(asked: &Resolved<'_>, answer: &Answer, to: &mut dyn Write) -> io::Result<()> {
    let model = asked.problem.model();
    let info = model.info();
    let terms = asked.terms();
    let quantities: Vec<_> = terms.iter().map(|term| term.quantity(info)).collect();
    let deciding = match answer {
        Answer::Motions(motions) => motions.iter().map(|(_, s)| s.deciding.len()).max(),
        Answer::Branches(branches) => {
            let points = branches.iter().flat_map(|branch| &branch.points);
            points.map(|point| point.stability.deciding.len()).max()
        }
    };
    let deciding = deciding.unwrap_or(0);
    write!(to, "# mechanism: {}\n# units:", info.name)?;
    for quantity in &quantities {
        write!(to, " {} {},", quantity.name, quantity.unit)?;
    }
    for contact in info.contacts.iter() {
        write!(to, " normal_force_{} N,", contact.name)?;
    }
    writeln!(to, " re and im 1/s")?;
    write!(to, "branch")?;
    for quantity in &quantities {
        write!(to, ",{}", quantity.name)?;
    }
    for contact in info.contacts.iter() {
        write!(to, ",normal_force_{0},friction_demand_{0}", contact.name)?;
    }
    for i in 1..=deciding {
        write!(to, ",re_{i},im_{i}")?;
    }
    writeln!(to, ",verdict,feasible")?;
    let mut row = |branch: usize, at: &Point, stability: &Stability, feasible: bool| {
        write!(to, "{branch}")?;
        for (term, quantity) in terms.iter().zip(&quantities) {
            write!(to, ",{}", quantity.to_unit(term.value(model, at)))?;
        }
        for force in ContactForces::new().at(model, at.at()) {
            write!(to, ",{},{}", force.normal, force.demand())?;
        }
        let values = stability.eigenvalues();
        for i in 0..deciding {
            match values.get(i) {
                Some(value) => write!(to, ",{},{}", value.re, value.im)?,
                None => write!(to, ",,")?,
            }
        }
        writeln!(to, ",{},{feasible}", verdict(stability.verdict))
    };
    match answer {
        Answer::Motions(motions) => {
            for (i, (motion, stability)) in motions.iter().enumerate() {
                row(i + 1, &motion.point, stability, true)?;
            }
        }
        Answer::Branches(branches) => {
            for (i, branch) in branches.iter().enumerate() {
                for at in &branch.points {
                    row(i + 1, &at.point, &at.stability, at.feasible)?;
                }
            }
        }
    }
    Ok(())
}
