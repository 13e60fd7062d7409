//! The first lines of a report: the cause, its size, what to change, the error before and after.

use std::fmt::Write as _;

use appell_gap::diagnose::{Advice, ErrorOf, GapVerdict, HowFar, Hypothesis, Open, Report, Share};

use super::law::written;
use super::numbers::{compared, is_determined, percent, share};
use super::shares::refitted;
use super::words::{
    NO_GAP, REFITTED, equivalents, first_of, is_one_of_many, joined, moved, name_of, needs_refit,
    percent_of, refit_moves, refit_sentence, sentence, size,
};
use crate::text::{horizon, short, with_unit};

/// The top of the report.
pub struct Headline {
    /// The cause, in a sentence.
    pub cause: String,
    /// Sizes, each with its 95 % interval; parameters with their stated values.
    pub sizes: Vec<String>,
    /// Parameters that re-fitting without effects moves by more than their tolerance, where this closes a part of the gap.
    pub refit: Vec<String>,
    /// The recommended changes: certain ones first, then those that are open, then what should stay as it is.
    pub change: Vec<String>,
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
            // Without a gap these are the sizes.
            refit: match report.verdict {
                GapVerdict::NoGap => Vec::new(),
                _ => refit_moves(report),
            },
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
    let first = report.leading().filter(|_| is_named);
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
        let parameter = first.wrong_parameter(effect);
        let name = parameter.map(|parameter| format!("{} = ", parameter.name));
        name.is_some_and(|name| parameters.iter().any(|one| one.starts_with(&name)))
    };
    let mut sizes = Vec::new();
    for value in &first.parameters {
        let effect = value.name.rsplit_once('.').map_or("", |(effect, _)| effect);
        let is_slight = slight.iter().any(|part| part.name == effect);
        let slight = is_slight.then(|| "predictions hardly change with it".to_owned());
        let is_one_of_many = is_one_of_many(first, value);
        let known = value.yardstick.as_ref();
        let known =
            known.filter(|known| value.is_determined && (known.is_large || !is_one_of_many));
        let remarks: Vec<String> = known.map(compared).into_iter().chain(slight).collect();
        let mut text = size(first, value);
        if !remarks.is_empty() {
            // Writing to a string cannot fail.
            let _ = write!(text, " ({})", remarks.join("; "));
        }
        if !is_changed(effect) {
            sizes.push(text);
        }
    }
    sizes.extend(parameters);
    sizes
}

/// The changes that the verdict calls for.
fn change(report: &Report, applied: Option<usize>) -> Vec<String> {
    let first = report.which.first();
    let is_alternative = |one: &Hypothesis| {
        let mut effects = one.effects.iter();
        effects.any(|effect| effect.starts_with("alternative:"))
    };
    let only = |text: &str| vec![text.to_owned()];
    match report.verdict {
        _ if first.is_some_and(is_alternative) => {
            only("adopt the alternative model and repeat the diagnosis with it")
        }
        GapVerdict::NoGap if applied.is_some() => only("take the parameters over (`appell apply`)"),
        GapVerdict::NoGap => only("nothing"),
        GapVerdict::Explained | GapVerdict::Ambiguous => advised(report, applied),
        GapVerdict::Unexplained => {
            let own = "describe the missing effect yourself, and diagnose with it";
            let file = file(report);
            let command = match applied {
                None => return only(own),
                Some(1) => "`appell apply`".to_owned(),
                Some(number) => format!("`appell apply`, given hypothesis {number},"),
            };
            vec![if written(report) == applied {
                format!("{command} writes the measured force into the {file}; look for its cause")
            } else {
                format!("{command} writes the fitted parameters into the {file}; {own}")
            }]
        }
    }
}

/// The number of the hypothesis that `appell apply` should write, if it should write one.
fn applied(report: &Report) -> Option<usize> {
    let refits = refit_sentence(report).is_some();
    let is_written = |number: &usize| {
        let hypothesis = report.which.get(number - 1);
        hypothesis.is_some_and(|one| one.changes.is_some())
    };
    match report.verdict {
        GapVerdict::Explained | GapVerdict::Ambiguous => {
            let advice = Advice::of(report);
            let whole = (!advice.certain.is_empty()).then_some(1);
            whole
                .map(|whole| advice.hypothesis(report).unwrap_or(whole))
                .filter(is_written)
        }
        GapVerdict::NoGap => refits.then_some(1),
        GapVerdict::Unexplained => written(report).or_else(|| {
            let is_plain = |one: &Hypothesis| one.effects.is_empty() && one.changes.is_some();
            let at = report.which.iter().position(is_plain)?;
            refits.then_some(at + 1)
        }),
    }
}

/// The changes by effect: those that are certain, those that are open with what they compete with, and the others.
fn advised(report: &Report, applied: Option<usize>) -> Vec<String> {
    let (advice, first) = (Advice::of(report), report.leading());
    let motion = match report.experiment {
        Some(_) => "the experiment below",
        None => "other motions",
    };
    let mut lines = if advice.certain.is_empty() {
        vec![format!(
            "nothing yet: record {motion}, and diagnose again with the recording before `appell apply`"
        )]
    } else {
        let what = written_where(report, &advice.certain);
        vec![format!("certain: {}: {what}", advice.certain.join(", "))]
    };
    // Effects that are open for the same reason.
    let mut open: Vec<(String, Vec<&str>)> = Vec::new();
    for one in &advice.open {
        let why = opened(report, first, one);
        match open.iter_mut().find(|(own, _)| *own == why) {
            Some((_, effects)) => effects.push(&one.effect),
            None => open.push((why, vec![&one.effect])),
        }
    }
    let open: Vec<String> = (open.into_iter())
        .map(|(why, effects)| format!("{} ({why})", effects.join(", ")))
        .collect();
    if !open.is_empty() {
        lines.push(format!("open: {}", open.join("; ")));
    }
    let [not_determined, immaterial] = [
        (&advice.not_determined, "not determined"),
        (&advice.immaterial, "immaterial"),
    ]
    .map(|(effects, why)| {
        effects
            .iter()
            .map(move |effect| format!("{effect} ({why})"))
    });
    let leave: Vec<String> = not_determined.chain(immaterial).collect();
    if !leave.is_empty() {
        lines.push(format!("do not change: {}", leave.join(", ")));
    }
    lines.extend(equivalents(report));
    let hypothesis = applied.and_then(|number| report.which.get(number - 1));
    let effects = hypothesis.map_or(&[][..], |hypothesis| &hypothesis.effects);
    let others = effects
        .iter()
        .filter(|effect| !advice.certain.contains(effect));
    let others: Vec<&str> = others.map(String::as_str).collect();
    if !others.is_empty() {
        lines.push(format!(
            "`appell apply` also writes {}, fitted together with the others: remove what you do not want",
            others.join(", ")
        ));
    }
    lines
}

/// `or delay@u 12 %`: why an effect is open, with the hypotheses that do without it.
fn opened(report: &Report, first: Option<&Hypothesis>, open: &Open) -> String {
    let effect = &open.effect;
    let names = open.instead.iter().map(|effects| {
        let is_new = |one: &&String| !first.is_some_and(|first| first.effects.contains(one));
        let new: Vec<String> = effects.iter().filter(is_new).cloned().collect();
        let other = match (effects.contains(effect), new.is_empty()) {
            (true, true) => "another size".to_owned(),
            (true, false) => format!("another size with {}", joined(&new)),
            (false, true) => "without it".to_owned(),
            (false, false) => name_of(&new),
        };
        let mut which = report.which.iter();
        let hypothesis = which.find(|one| one.effects == *effects);
        let sure = hypothesis.map_or(f64::NAN, |one| one.probability);
        format!("{other} {}", percent_of(sure))
    });
    let other = first_of(3, names.collect()).map(|names| format!("or {names}"));
    let implausible = first.and_then(|first| first.implausible(effect));
    let implausible = implausible.map(|known| format!("{}: plausible?", compared(known)));
    let unshown = (!open.is_shown).then(|| "not shown by the held-out runs".to_owned());
    let why = other.into_iter().chain(implausible).chain(unshown);
    why.collect::<Vec<_>>().join("; ")
}

/// What holds the model.
fn file(report: &Report) -> &'static str {
    match report.robot {
        Some(_) => "robot file",
        None => "spec",
    }
}

/// Where changes are written: effects that a spec can hold, and those that belong elsewhere.
fn written_where(report: &Report, effects: &[String]) -> String {
    let (first, file) = (report.leading(), file(report));
    let signals = first.and_then(|first| first.changes.as_ref());
    let signals = signals.map_or(&[][..], |changes| &changes.signal_effects);
    let is_elsewhere = |effect: &&String| {
        let mut signals = signals.iter().filter(|one| one.output.is_none());
        signals.any(|one| one.effect == **effect)
    };
    let (elsewhere, own): (Vec<&String>, Vec<&String>) = effects.iter().partition(is_elsewhere);
    let elsewhere: Vec<&str> = elsewhere.into_iter().map(String::as_str).collect();
    let listed = elsewhere.join(", ");
    let belong = if elsewhere.len() == 1 {
        "belongs"
    } else {
        "belong"
    };
    match (own.is_empty(), elsewhere.is_empty()) {
        (true, _) => format!(
            "nothing in the equations; {listed} {belong} elsewhere, `appell apply` says where"
        ),
        (false, false) => format!(
            "write into the {file} what it can express; {listed} {belong} elsewhere, `appell apply` says where"
        ),
        (false, true) => format!("write into the {file} (`appell apply`)"),
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
    let in_noise = format!("{before} -> {after} times the noise");
    let mut text = match in_units(&far.channels) {
        Some(channels) => format!("{what}: {channels} ({in_noise}, floor {floor})"),
        None => format!("{what}: {in_noise} (floor {floor})"),
    };
    if is_determined(far.closed, far.closed_ci95) {
        let closed = share(far.closed, far.closed_ci95);
        // Writing to a string cannot fail.
        let _ = write!(text, "; {closed} of the gap closes");
    } else {
        text += "; these runs do not determine how much of the gap closes";
    }
    // More than the re-fitted parameters differs from the stated model.
    let mut budget = far.budget.iter();
    let has_more = is_determined(far.closed, far.closed_ci95)
        && budget.any(|part| part.is_effect() || part.is_law());
    if let Some(refit) = refitted(report).filter(|_| has_more) {
        let closed = percent(refit.closed);
        let _ = write!(text, ", {closed} by re-fitted parameters alone");
    }
    if far.is_worse {
        text += "; worse than with re-fitted parameters alone";
    }
    text
}

/// `phi 540 -> 34.2 rad, ...`: root mean square errors of channels, those that change most first.
fn in_units(channels: &[ErrorOf]) -> Option<String> {
    let mut channels: Vec<&ErrorOf> = channels.iter().collect();
    let left = |channel: &ErrorOf| channel.with_effect / channel.nominal;
    channels.sort_by(|a, b| left(a).total_cmp(&left(b)));
    let channels = channels.into_iter().map(|channel| {
        let [before, after] = [channel.nominal, channel.with_effect].map(short);
        format!(
            "{} {before} -> {}",
            channel.name,
            with_unit(&after, &channel.unit)
        )
    });
    first_of(3, channels.collect())
}
