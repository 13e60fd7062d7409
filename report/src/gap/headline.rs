//! The first lines of a report: the cause, its size, what to change, the error before and after.

use std::fmt::Write as _;

use appell_gap::diagnose::{GapVerdict, HowFar, Hypothesis, Report, Share, Value};

use super::law::written;
use super::numbers::{bounded, is_determined, percent, share};
use super::words::{
    NO_GAP, REFITTED, leading, moved, needs_refit, parameter, refit_sentence, refitted, sentence,
};
use crate::text::{horizon, short, with_unit};

/// The top of the report.
pub struct Headline {
    /// The cause, in a sentence.
    pub cause: String,
    /// Sizes, each with its 95 % interval; parameters with their stated values.
    pub sizes: Vec<String>,
    /// The recommended change.
    pub change: String,
    /// The number of the hypothesis to apply, if one is.
    pub applied: Option<usize>,
    /// Errors of the model as stated and with the cause; nothing without held-out runs.
    pub error: Option<String>,
}

impl Headline {
    /// Of a report.
    pub fn of(report: &Report) -> Self {
        Self {
            cause: cause(report),
            sizes: sizes(report),
            change: change(report, applied(report)),
            applied: applied(report),
            error: report.how_far.as_ref().map(|far| error(report, far)),
        }
    }
}

/// The verdict; sizes follow below it.
fn cause(report: &Report) -> String {
    if report.verdict == GapVerdict::NoGap && refit_sentence(report).is_some() {
        return [NO_GAP, REFITTED].concat();
    }
    sentence(report)
}

/// Values of the leading effects, and significantly changed parameters where predictions need them.
fn sizes(report: &Report) -> Vec<String> {
    let budget = report.how_far.iter().flat_map(|far| &far.budget);
    let (material, slight): (Vec<&Share>, Vec<&Share>) =
        (budget.filter(|part| part.is_effect())).partition(|part| part.is_material);
    let is_named = match report.verdict {
        GapVerdict::Explained | GapVerdict::Ambiguous => true,
        GapVerdict::NoGap => false,
        // Effects named together with the part that the library does not explain.
        GapVerdict::Unexplained => !material.is_empty(),
    };
    let first = leading(report).filter(|_| is_named);
    let Some(first) = first else {
        return refit_sentence(report).into_iter().collect();
    };
    // A wrong parameter is among the changed ones.
    let parameters = if needs_refit(report) {
        moved(Some(first))
    } else {
        Vec::new()
    };
    let is_changed = |effect: &str| {
        let name = parameter(first, effect).map(|name| format!("{name} = "));
        name.is_some_and(|name| parameters.iter().any(|one| one.starts_with(&name)))
    };
    let mut sizes = Vec::new();
    for value in &first.parameters {
        let effect = value.name.rsplit_once('.').map_or("", |(effect, _)| effect);
        let is_slight = slight.iter().any(|part| part.name == effect);
        let mut text = size(first, value);
        if is_slight {
            text += " (predictions hardly change with it)";
        }
        if !is_changed(effect) {
            sizes.push(text);
        }
    }
    sizes.extend(parameters);
    sizes
}

/// The values of a hypothesis, each with half of its 95 % interval.
pub fn values(hypothesis: &Hypothesis) -> Vec<String> {
    let values = hypothesis.parameters.iter();
    values.map(|value| size(hypothesis, value)).collect()
}

/// `force = 0.412 ± 0.041 N`
fn size(hypothesis: &Hypothesis, value: &Value) -> String {
    let (effect, short) = value.name.rsplit_once('.').unwrap_or(("", &value.name));
    let number = with_unit(&bounded(value.value, value.std), &value.unit);
    // Values of several effects may share a name.
    let site = effect
        .split_once('@')
        .filter(|_| hypothesis.effects.len() > 1);
    let site = site.map_or_else(String::new, |(_, site)| format!(" ({site})"));
    format!("{}{site} = {number}", short.replace('_', " "))
}

/// The change that the verdict calls for.
fn change(report: &Report, applied: Option<usize>) -> String {
    let first = report.which.first();
    let is_alternative = |one: &Hypothesis| {
        let mut effects = one.effects.iter();
        effects.any(|effect| effect.starts_with("alternative:"))
    };
    match report.verdict {
        _ if first.is_some_and(is_alternative) => {
            "adopt the alternative model and repeat the diagnosis with it".to_owned()
        }
        GapVerdict::NoGap if applied.is_some() => {
            "take the parameters over (`appell apply`)".to_owned()
        }
        GapVerdict::NoGap => "nothing".to_owned(),
        GapVerdict::Ambiguous => {
            let motion = match report.experiment {
                Some(_) => "the experiment below",
                None => "other motions",
            };
            format!(
                "nothing yet: record {motion}, and diagnose again with the recording before `appell apply`"
            )
        }
        GapVerdict::Explained => explained(first),
        GapVerdict::Unexplained => {
            let own = "describe the missing effect yourself, and diagnose with it";
            let command = match applied {
                None => return own.to_owned(),
                Some(1) => "`appell apply`".to_owned(),
                Some(number) => format!("`appell apply`, given hypothesis {number},"),
            };
            if written(report) == applied {
                format!("{command} writes the measured force into the spec; look for its cause")
            } else {
                format!("{command} writes the fitted parameters into the spec; {own}")
            }
        }
    }
}

/// The number of the hypothesis that `appell apply` should write, if it should write one.
fn applied(report: &Report) -> Option<usize> {
    let refits = refit_sentence(report).is_some();
    match report.verdict {
        GapVerdict::Explained | GapVerdict::Ambiguous => Some(1),
        GapVerdict::NoGap => refits.then_some(1),
        GapVerdict::Unexplained => written(report).or_else(|| {
            let is_plain = |one: &Hypothesis| one.effects.is_empty() && one.changes.is_some();
            let at = report.which.iter().position(is_plain)?;
            refits.then_some(at + 1)
        }),
    }
}

/// Effects that a spec can hold are written, the others belong elsewhere.
fn explained(first: Option<&Hypothesis>) -> String {
    let Some(changes) = first.and_then(|first| first.changes.as_ref()) else {
        return "add the effect to the spec (`appell apply`)".to_owned();
    };
    let adds = !(changes.items.trim().is_empty() && changes.inputs.is_empty());
    let elsewhere = changes.signal_effects.iter();
    let elsewhere = elsewhere.filter(|one| one.output.is_none());
    let mut names: Vec<&str> = elsewhere.map(|one| one.effect.as_str()).collect();
    names.dedup();
    let what = match (adds, names.is_empty()) {
        (true, true) => "add the effect to the spec (`appell apply`)",
        (false, true) => "write the fitted parameters into the spec (`appell apply`)",
        (true, false) => "add to the spec the effects that it can express",
        (false, false) => "nothing in the equations",
    };
    let listed = names.join(", ");
    match names.len() {
        0 => what.to_owned(),
        1 => format!("{what}; {listed} belongs elsewhere, `appell apply` says where"),
        _ => format!("{what}; {listed} belong elsewhere, `appell apply` says where"),
    }
}

/// Errors before and after, and the share that closes.
fn error(report: &Report, far: &HowFar) -> String {
    let what = if report.is_by_forces {
        "forces missed on held-out runs".to_owned()
    } else {
        format!("{} ahead on held-out runs", horizon(far.horizon_s))
    };
    let [before, after, floor] = [far.nominal, far.with_effect, far.noise_floor].map(short);
    let mut text = format!("{what}: {before} -> {after} times the noise (floor {floor})");
    if is_determined(far.closed, far.closed_ci95) {
        let closed = share(far.closed, far.closed_ci95);
        // Writing to a string cannot fail.
        let _ = write!(text, "; {closed} of the gap closes");
    } else {
        text += "; these runs do not determine how much of the gap closes";
    }
    // More than the re-fitted parameters differs from the stated model.
    let mut budget = far.budget.iter();
    let has_more = budget.any(|part| part.is_effect() || part.is_law());
    if let Some(refit) = refitted(&far.budget).filter(|_| has_more) {
        let closed = percent(refit.closed);
        let _ = write!(text, ", {closed} by re-fitted parameters alone");
    }
    if far.is_worse {
        text += "; worse than with re-fitted parameters alone";
    }
    text
}
