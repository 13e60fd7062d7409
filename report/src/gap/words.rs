//! The statements of a gap report.

use std::fmt::Write as _;

use appell_gap::diagnose::{
    Advice, Change, GapVerdict, HowFar, Hypothesis, Left, Refitted, Report, Share, Value,
};

use super::numbers::{bounded, compared, measured, part_of_all, percent, sized, small};
use crate::text::{short, with_unit};

/// The verdict where nothing is missing, and the condition for it.
pub(super) const NO_GAP: &str = "no gap beyond measurement and process noise";
pub(super) const REFITTED: &str = " once parameters are re-fitted";

/// The verdict in one sentence, with the alternatives.
pub fn sentence(report: &Report) -> String {
    let mut statement = statement(report);
    if report.verdict == GapVerdict::Unexplained {
        statement += &not_found(&report.failed);
    }
    let Some((probability, same, rivals)) = alternatives(report) else {
        return statement;
    };
    let mut text = format!("{statement} (probability {}", percent_of(probability));
    if rivals.is_empty() {
        text.extend(next_best(report).map(|next| format!("; next: {next}")));
    } else {
        text.extend(report.leading().map(values));
    }
    text += ")";
    for phrase in same {
        text = text + "; " + &phrase;
    }
    if !rivals.is_empty() {
        // Writing to a string cannot fail.
        let _ = write!(text, "; {} cannot be ruled out", rivals.join(", "));
    }
    text
}

/// `; the search of a, b did not converge, so that these are not ruled out`
fn not_found(failed: &[(Vec<String>, String)]) -> String {
    let failed = failed.iter().filter(|(effects, _)| !effects.is_empty());
    let names = first_of(3, failed.map(|(effects, _)| joined(effects)).collect());
    names.map_or_else(String::new, |names| {
        format!("; the search of {names} did not converge, so that these are not ruled out")
    })
}

/// The first items of a list, and how many more there are; a page shows all.
pub(super) fn first_of(most: usize, mut items: Vec<String>) -> Option<String> {
    let more = items.split_off(items.len().min(most)).len();
    let shown = items.join(", ");
    match more {
        0 => (!items.is_empty()).then_some(shown),
        more => Some(format!("{shown} and {more} more")),
    }
}

/// The hypothesis after the leading one, with its probability.
pub(super) fn next_best(report: &Report) -> Option<String> {
    let first = &report.leading()?.effects;
    let mut others = report.which.iter();
    let next = others.find(|one| one.same_as.is_none() && one.effects != *first)?;
    let name = name_of(&next.effects);
    Some(format!("{name}, {}", percent_of(next.probability)))
}

/// The effects of a hypothesis in a sentence.
pub(super) fn name_of(effects: &[String]) -> String {
    if effects == ["unknown"] {
        return "none of the library".to_owned();
    }
    joined(effects)
}

/// `, delay = 0.012 ± 0.001 s`
fn values(hypothesis: &Hypothesis) -> String {
    let values = hypothesis.parameters.iter().map(|value| {
        let number = sized(value);
        let name = value.name.rsplit('.').next().unwrap_or_default();
        format!(", {} = {number}", name.replace('_', " "))
    });
    values.collect()
}

/// `m = 1.35 ± 0.02 kg (stated 1 kg)`: parameters that differ significantly from their stated values.
pub(super) fn moved(hypothesis: Option<&Hypothesis>) -> Vec<String> {
    /// Standard deviations beyond which a difference is significant.
    const BEYOND: f64 = 3.0;
    let changes = hypothesis.and_then(|one| one.changes.as_ref());
    let parameters = changes.iter().flat_map(|changes| &changes.parameters);
    let moved = parameters.filter_map(|one| {
        let std = one.std?;
        let has_moved = (one.value - one.stated).abs() > BEYOND * std;
        has_moved.then(|| {
            let value = with_unit(&bounded(one.value, std), &one.unit);
            let stated = with_unit(&as_written(one.stated), &one.unit);
            let by = deviations(one).map(|by| format!(", {by}"));
            format!(
                "{} = {value} (stated {stated}{})",
                one.name,
                by.unwrap_or_default()
            )
        })
    });
    moved.collect()
}

/// `+2.6 stated deviations`
fn deviations(parameter: &Refitted) -> Option<String> {
    let by = parameter.moved_by()?;
    Some(format!("{by:+.1} stated deviations"))
}

/// `J 0.00012 -> 0.000151 kg*m^2 (+2.6 stated deviations)`: the parameters that the re-fit without effects moves by more
/// than one stated deviation, where it closes a material share of the gap.
pub(super) fn refit_moves(report: &Report) -> Vec<String> {
    let is_material = report
        .how_far
        .iter()
        .any(|far| refitted(&far.budget).is_some());
    let plain = report.which.iter().find(|one| one.effects.is_empty());
    let changes = plain.and_then(|one| one.changes.as_ref());
    let parameters = changes
        .filter(|_| is_material)
        .map_or(&[][..], |one| &one.parameters);
    let far = parameters.iter();
    let mut far: Vec<&Refitted> = far
        .filter(|one| one.moved_by().is_some_and(|by| by.abs() > 1.0))
        .collect();
    let by = |one: &Refitted| one.moved_by().map_or(0.0, f64::abs);
    far.sort_by(|a, b| by(b).total_cmp(&by(a)));
    let moves = far.into_iter().filter_map(|one| {
        let to = with_unit(&short(one.value), &one.unit);
        let (name, from) = (&one.name, as_written(one.stated));
        Some(format!("{name} {from} -> {to} ({})", deviations(one)?))
    });
    moves.collect()
}

/// A stated value as it was written, without the rounding of units.
fn as_written(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    rounded.to_string()
}

/// The significantly changed parameters, where predictions need them.
pub fn refit_sentence(report: &Report) -> Option<String> {
    let plain = report.which.iter().find(|one| one.effects.is_empty());
    let moved = moved(plain);
    (needs_refit(report) && !moved.is_empty()).then(|| moved.join(", "))
}

/// Whether predictions need re-fitted parameters.
pub(super) fn needs_refit(report: &Report) -> bool {
    let far = report.how_far.as_ref();
    far.is_none_or(|far| refitted(&far.budget).is_some())
}

/// Where several hypotheses may be true: the probability of the leading one, equivalents of its material effects, and the
/// hypotheses that cannot be ruled out.
pub(super) fn alternatives(report: &Report) -> Option<(f64, Vec<String>, Vec<String>)> {
    let is_named = matches!(
        report.verdict,
        GapVerdict::Explained | GapVerdict::Ambiguous
    );
    let is_open = report.change.is_none() && is_named;
    let first = report.leading().filter(|_| is_open)?;
    let advice = Advice::of(report);
    let groups = advice.equivalent.iter();
    let matters = |own: &str| {
        let unsure = advice.not_determined.iter().chain(&advice.immaterial);
        let mut effects = own.split('+');
        effects.any(|effect| !unsure.clone().any(|one| one == effect))
    };
    let same = groups
        .filter(|group| matters(&group[0]))
        .map(|group| equivalent(group));
    Some((first.probability, same.collect(), rivals(report)))
}

/// `a or b: the recordings cannot tell, either may be changed`
pub(super) fn equivalent(group: &[String]) -> String {
    let names = group.join(" or ").replace('+', " + ");
    format!("{names}: the recordings cannot tell, either may be changed")
}

/// The verdict in one sentence.
pub(super) fn statement(report: &Report) -> String {
    let about = report.found.iter().map(|found| found.about.as_str());
    let about: Vec<&str> = about.collect();
    let names = about.join(" and ");
    if let Some(change) = &report.change {
        return changed(report, change, &names);
    }
    match report.verdict {
        GapVerdict::NoGap => {
            let refit = refit_sentence(report).map(|moved| format!("{REFITTED}: {moved}"));
            format!("{NO_GAP}{}", refit.unwrap_or_default())
        }
        GapVerdict::Explained => {
            shares(report).unwrap_or_else(|| format!("the gap is explained by {names}"))
        }
        GapVerdict::Ambiguous => shares(report).unwrap_or_else(|| {
            let explain = if about.len() > 1 {
                "explain"
            } else {
                "explains"
            };
            format!("there is a gap; {names} {explain} it best")
        }),
        GapVerdict::Unexplained if report.how_far.as_ref().is_some_and(|far| far.is_worse) => {
            let nothing = "there is a gap; what fits the recordings best makes predictions worse and explains nothing";
            match refitted_share(report).zip(refit_sentence(report)) {
                Some((share, moved)) => format!(
                    "{share}: {moved}; what fits the recordings best beyond them does not better predictions"
                ),
                None => nothing.to_owned(),
            }
        }
        GapVerdict::Unexplained if names_effects(report) => match shares(report) {
            Some(shares) => shares,
            None => format!("there is a gap; {names} explains a part of it, most stays"),
        },
        GapVerdict::Unexplained => {
            let law = law_share(report).unwrap_or_default();
            match shares(report) {
                // The law is listed among the shares.
                Some(shares) if !law.is_empty() => {
                    let left = report.left.as_ref().map_or("", |left| &left.about);
                    format!("{shares}; the law, which no effect of the library has, is {left}")
                }
                Some(shares) => unnamed(report, Some(shares)),
                None => unnamed(report, None) + &law,
            }
        }
    }
}

/// `re-fitted parameters close 98 % of the gap`, where they matter.
fn refitted_share(report: &Report) -> Option<String> {
    let refit = refitted(&report.how_far.as_ref()?.budget)?;
    let closed = percent(refit.closed);
    Some(format!("re-fitted parameters close {closed} of the gap"))
}

/// The part of the gap that no effect of the library explains, after the shares of the others.
fn unnamed(report: &Report, shares: Option<String>) -> String {
    let left = report.left.as_ref();
    let is_sure = left.is_none_or(Left::is_there);
    let left = left.filter(|left| !left.about.is_empty());
    let left = left.map_or_else(String::new, |left| format!(": {}", left.about));
    let before = shares.map(|shares| format!("{shares}; "));
    if is_sure {
        return match before {
            Some(before) => format!("{before}no effect of the library explains the rest{left}"),
            None => format!("there is a gap that no effect of the library explains{left}"),
        };
    }
    let unknown = report.which.iter().find(|one| one.is_unknown());
    let sure = percent_of(unknown.map_or(f64::NAN, |one| one.probability));
    let before = before.unwrap_or_default();
    format!(
        "{before}the recordings leave it open (probability {sure}) whether something is missing that the library lacks{left}"
    )
}

/// `; measured, it closes 90 % of the gap`
fn law_share(report: &Report) -> Option<String> {
    let mut budget = report.how_far.as_ref()?.budget.iter();
    let law = budget.find(|part| part.is_law() && part.is_material)?;
    let closed = part_of_all(law.closed);
    Some(format!("; measured, it closes {closed} of the gap"))
}

/// The part of the re-fitted parameters, where it matters.
pub(super) fn refitted(budget: &[Share]) -> Option<&Share> {
    let mut budget = budget.iter();
    budget.find(|part| part.is_refit() && part.is_material)
}

/// The shares of the gap closed by re-fitted parameters and by the effects that matter, the largest first, and the rest:
/// all relative to the gap of the model as stated. `None` if nothing closes a material share.
fn shares(report: &Report) -> Option<String> {
    let far = report.how_far.as_ref()?;
    let budget = &far.budget;
    let refit = refitted_share(report);
    let effects: Vec<&Share> = budget.iter().filter(|part| part.is_effect()).collect();
    let (mut named, others) = named(report, &effects);
    named.sort_by(|a, b| b.closed.total_cmp(&a.closed));
    if named.is_empty() && refit.is_none() {
        return None;
    }
    let rest = budget.iter().find(|part| part.is_rest());
    let is_most = |rest: &&Share| budget.iter().all(|part| part.closed <= rest.closed);
    let most = rest.filter(is_most).map(|rest| {
        let most = if rest.closed > 0.5 {
            "most"
        } else {
            "the largest part"
        };
        let (closed, error) = (small(rest.closed), error_left(far).unwrap_or_default());
        format!("{most} of the gap ({closed}{error}) has no known cause")
    });
    let most_stays = most.is_some();
    let mut parts: Vec<String> = most.into_iter().chain(refit).collect();
    parts.extend(effects_share(report, &named, &others));
    for part in budget {
        if part.is_law() && part.is_material {
            parts.push(format!("a measured law {}", percent(part.closed)));
        } else if part.is_rest() && !most_stays {
            let error = error_left(far).unwrap_or_default();
            parts.push(format!("{} stays{error}", small(part.closed)));
        }
    }
    Some(parts.join("; "))
}

/// The effects of a headline, and the others. Those are named that close a material share, significantly if any does, with
/// a size that the recordings determine.
fn named<'s>(report: &Report, effects: &[&'s Share]) -> (Vec<&'s Share>, Vec<&'s Share>) {
    let advice = Advice::of(report);
    let is_sized = |part: &Share| part.is_material && !advice.not_determined.contains(&part.name);
    let is_shown = |part: &Share| is_sized(part) && part.interval[0] > 0.0;
    let any_shown = effects.iter().any(|part| is_shown(part));
    let parts = effects.iter().copied();
    parts.partition(|part| {
        if any_shown {
            is_shown(part)
        } else {
            is_sized(part)
        }
    })
}

/// What the named effects close, and what the others do together.
fn effects_share(report: &Report, named: &[&Share], others: &[&Share]) -> Vec<String> {
    /// A share of the others that is worth a word.
    const NOTABLE: f64 = 0.005;
    let about = |part: &&Share| {
        let mut found = report.found.iter();
        let found = found.find(|found| found.effect == part.name);
        let about = found.map_or_else(|| part.name.clone(), |found| found.about.clone());
        about + &large(report, &part.name).unwrap_or_default()
    };
    let listed = |parts: &[&Share]| parts.iter().map(about).collect::<Vec<_>>().join(" and ");
    let sum = |parts: &[&Share]| parts.iter().map(|part| part.closed).sum::<f64>();
    let (names, rest) = (listed(named), sum(others));
    let mut parts = match named {
        [] if others.is_empty() => Vec::new(),
        [] => vec![unnoticed(report, others, &listed(others))],
        [one] => {
            let [low, high] = one.interval.map(percent);
            let (closed, open) = (part_of_all(one.closed), unsettled(one.interval));
            vec![format!(
                "{names} closes {closed} [{low}, {high}] of the gap{open}"
            )]
        }
        several => {
            let each: Vec<String> = several.iter().map(|part| percent(part.closed)).collect();
            let (all, each) = (part_of_all(sum(several)), each.join(", "));
            vec![format!("{names} close {all} ({each}) of the gap")]
        }
    };
    if !named.is_empty() && rest.abs() > NOTABLE {
        parts.push(format!("other effects {}", percent(rest)));
    }
    parts
}

/// Effects none of which is named, and why.
fn unnoticed(report: &Report, others: &[&Share], names: &str) -> String {
    let refit = report
        .how_far
        .as_ref()
        .and_then(|far| refitted(&far.budget));
    let is_parameter = |part: &&Share| {
        let first = report.leading();
        first.is_some_and(|first| first.wrong_parameter(&part.name).is_some())
    };
    if let Some(refit) = refit.filter(|_| others.iter().all(is_parameter)) {
        let closed = percent(refit.closed);
        return format!(
            "{names}: re-fitted together with the others it closes {closed} of the gap"
        );
    }
    if others.iter().any(|part| part.is_material) {
        return format!("the recordings do not determine the size of {names}");
    }
    let [are, them] = if others.len() > 1 {
        ["are", "them"]
    } else {
        ["is", "it"]
    };
    format!(
        "{names} {are} there as well, but predictions of the held-out runs hardly change with {them}"
    )
}

/// A remark on an effect that is larger than all that the model has of its kind.
fn large(report: &Report, effect: &str) -> Option<String> {
    let first = report.leading()?;
    let mut values = first.values_of(effect);
    let is_large = |value: &&Value| value.yardstick.as_ref().is_some_and(|known| known.is_large);
    let compared = compared(values.find(is_large)?)?;
    Some(format!(" ({compared}: plausible?)"))
}

/// `, an error of 385 times the noise floor`: a small part of the gap of a model that diverges is a large error.
fn error_left(far: &HowFar) -> Option<String> {
    let times = far.with_effect / far.noise_floor;
    let is_known = times.is_finite();
    is_known.then(|| format!(", an error of {} times the noise floor", short(times)))
}

/// A remark on an interval that hardly bounds a share.
fn unsettled([low, high]: [f64; 2]) -> &'static str {
    if low <= 0.0 {
        ", an interval in which the held-out runs leave it open whether it closes anything"
    } else if high - low > 1.0 {
        ", an interval so wide that the held-out runs hardly bound the share"
    } else {
        ""
    }
}

/// The diagnosis of the previous recordings: effects that the model now has, and how many parameters.
pub fn before_sentence(change: &Change) -> String {
    let (_, effects) = &change.before;
    let had = match effects.as_slice() {
        [] => "the model as it is".to_owned(),
        [one] if one == "unknown" => "the model with the law that was measured".to_owned(),
        effects => format!("the model with {}", effects.join(" + ")),
    };
    let count = change.parameters.len();
    let differing = change.parameters.iter().filter(|own| own.spread > own.std);
    let differing: Vec<&str> = differing.map(|own| own.name.as_str()).collect();
    let mut text = format!("{had}, {count} parameters fitted");
    if !differing.is_empty() {
        let _ = write!(text, "; {} differ from run to run", differing.join(", "));
    }
    text
}

/// The difference from the previous recordings.
fn changed(report: &Report, change: &Change, names: &str) -> String {
    if !change.is_changed {
        return "nothing changed that matters for predictions".to_owned();
    }
    match report.verdict {
        GapVerdict::NoGap => "nothing changed".to_owned(),
        GapVerdict::Explained => format!("what changed: {names}"),
        GapVerdict::Ambiguous => {
            let all = [vec![names.to_owned()], twins(report), rivals(report)].concat();
            format!("something changed: {}", all.join(", or "))
        }
        GapVerdict::Unexplained => {
            let left = report.left.as_ref().map(|left| format!(": {}", left.about));
            let left = left.unwrap_or_default();
            format!("something changed that no effect of the library explains{left}")
        }
    }
}

/// Whether the most probable hypothesis names effects.
fn names_effects(report: &Report) -> bool {
    let first = report.which.first();
    first.is_some_and(|first| !first.parameters.is_empty())
}

/// A probability in whole percent, none of them certain.
pub(super) fn percent_of(probability: f64) -> String {
    match 100.0 * probability {
        percent if percent > 99.0 => "over 99 %".to_owned(),
        percent if percent < 1.0 => "under 1 %".to_owned(),
        percent => format!("{percent:.0} %"),
    }
}

/// Names of the hypotheses indistinguishable from the leading one.
fn twins(report: &Report) -> Vec<String> {
    let first = report.leading().map(|first| &first.effects);
    let which = report.which.iter();
    let same = which.filter(|one| one.same_as.is_some() && one.same_as.as_ref() == first);
    same.map(|one| joined(&one.effects)).collect()
}

/// The hypotheses that are tied with the leading one, with their probabilities.
fn rivals(report: &Report) -> Vec<String> {
    let Some(first) = report.leading().map(|first| &first.effects) else {
        return Vec::new();
    };
    let groups = report.tied.iter();
    let tied = groups.filter(|group| group.contains(first)).flatten();
    let named = |effects: &Vec<String>| {
        let mut hypotheses = report.which.iter();
        let hypothesis = hypotheses.find(|hypothesis| hypothesis.effects == *effects);
        let rival = hypothesis.filter(|hypothesis| hypothesis.same_as.is_none())?;
        let (sure, values) = (percent_of(rival.probability), values(rival));
        Some(format!("{} ({sure}{values})", joined(effects)))
    };
    tied.filter(|effects| *effects != first)
        .filter_map(named)
        .collect()
}

/// Evidence against statements of the data set: channels missing from the model, tolerances, inputs between rows.
pub fn hints(report: &Report) -> Vec<String> {
    let tolerances = report.tolerances.iter().map(|found| {
        format!(
            "the parameters move by more than their tolerances allow: {} times the stated ones are the most probable \
             (log Bayes factor {})",
            short(found.factor),
            short(found.log_bayes_factor)
        )
    });
    let interpolated = report.interpolated.iter().map(|found| {
        format!(
            "{} fits better along lines between its rows than held (log likelihood + {}): if it was sampled from a \
             continuous signal, write interpolation = \"linear\" in its line and diagnose again",
            found.input,
            short(found.log_likelihood)
        )
    });
    let channels = report.hints.iter().map(|hint| {
        format!(
            "the gap in the equation of {} depends on {}, a channel that is not in the model",
            hint.equation, hint.variable
        )
    });
    channels.chain(tolerances).chain(interpolated).collect()
}

/// Windows that no hypothesis predicts, if any.
pub fn events(report: &Report) -> Option<String> {
    let windows = report.place.windows.iter().filter_map(|window| {
        let channel = window.unexplained.as_ref()?;
        let [from, to, times] = [window.from, window.to, window.z].map(short);
        Some(format!(
            "{} at {from} to {to} s (the error of {channel} is {times} times an ordinary one)",
            window.run
        ))
    });
    let events = first_of(4, windows.collect())?;
    Some(format!(
        "an external force, a contact or a fault of the log: {events}"
    ))
}

/// A note on unused training rows, if any.
pub fn left_out(report: &Report) -> Option<String> {
    let [fitted, all] = report.rows;
    if report.is_by_forces {
        return Some(format!(
            "the forces of {fitted} motions were fitted, spread over {all} training rows"
        ));
    }
    (fitted < all).then(|| {
        format!("{fitted} of {all} training rows were used, in segments spread over the runs")
    })
}

/// Imperfections of channels that change no prediction, if any.
pub fn imperfections(report: &Report) -> Option<String> {
    let named = report.imperfections.iter().map(|value| {
        let number = with_unit(&measured(value.value, value.std), &value.unit);
        let effect = value.name.rsplit_once('.').map_or("", |(effect, _)| effect);
        format!("{effect} {number}")
    });
    let named = named.reduce(|all, one| format!("{all}, {one}"))?;
    Some(format!(
        "{named}: in the recordings, but too small to change predictions; fitted together with every hypothesis"
    ))
}

/// The effects of a hypothesis; for an unexplained rest, also the effects that close a part of the gap.
pub fn said(report: &Report, hypothesis: &Hypothesis) -> String {
    let named = joined(&hypothesis.effects);
    let budget = report.how_far.iter().flat_map(|far| &far.budget);
    let others = budget.filter(|part| part.is_effect() && part.is_material);
    let others: Vec<&str> = others.map(|part| part.name.as_str()).collect();
    if hypothesis.is_unknown() && !others.is_empty() {
        format!("{named} in addition to {}", others.join(" + "))
    } else {
        named
    }
}

/// `a + b`
pub fn joined(effects: &[String]) -> String {
    if effects.is_empty() {
        "nominal model".to_owned()
    } else {
        effects.join(" + ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_search_that_did_not_converge_rules_nothing_out() {
        let failed = |names: &[&str]| {
            let names = names
                .iter()
                .map(|name| (vec![(*name).to_owned()], String::new()));
            names.collect::<Vec<_>>()
        };
        assert_eq!(not_found(&[(Vec::new(), String::new())]), "");
        let told = not_found(&failed(&["dry friction at x"]));
        assert!(told.starts_with("; the search of dry friction at x did not converge"));
        let told = not_found(&failed(&["a", "b", "c", "d", "e"]));
        assert!(told.starts_with("; the search of a, b, c and 2 more did"));
    }
}
