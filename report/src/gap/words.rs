//! The statements of a gap report.

use std::fmt::Write as _;

use appell_gap::diagnose::{
    Advice, Change, Changes, GapVerdict, Hypothesis, Left, Refitted, Report, Value,
};

use super::law::part_of_law;
use super::numbers::{bounded, part_of_all, sized};
use super::shares::{refitted, refitted_share, shares};
use crate::text::{short, with_unit};

/// Number of sizes of one kind that a sentence lists.
const FEW: usize = 2;

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
        text.extend(report.leading().map(values_after));
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
fn values_after(hypothesis: &Hypothesis) -> String {
    let values = ranges(hypothesis);
    values.iter().flat_map(|value| [", ", value]).collect()
}

/// The values of a hypothesis, each with half of its 95 % interval.
pub(super) fn values(hypothesis: &Hypothesis) -> Vec<String> {
    let values = hypothesis.parameters.iter();
    values.map(|value| size(hypothesis, value)).collect()
}

/// The same in few words: sizes of one kind at many places as a range, `coefficient at 6 places = 3.1 … 23.6 N*m*s/rad`.
pub fn ranges(hypothesis: &Hypothesis) -> Vec<String> {
    let mut ranges = Vec::new();
    for group in hypothesis
        .parameters
        .chunk_by(|a, b| kind(a) == kind(b) && a.unit == b.unit)
    {
        if group.len() <= FEW {
            ranges.extend(group.iter().map(|value| size(hypothesis, value)));
            continue;
        }
        let sizes = group.iter().map(|value| value.value);
        let low = sizes.clone().fold(f64::INFINITY, f64::min);
        let high = sizes.fold(f64::NEG_INFINITY, f64::max);
        let high = with_unit(&short(high), &group[0].unit);
        let (_, what) = kind(&group[0]);
        ranges.push(format!(
            "{what} at {} places = {} … {high}",
            group.len(),
            short(low)
        ));
    }
    ranges
}

/// The effect of a size, and what it is without the name of its place.
fn kind(value: &Value) -> (&str, &str) {
    let (effect, own) = value.name.rsplit_once('.').unwrap_or(("", &value.name));
    (effect, own.rsplit_once('_').map_or(own, |(_, what)| what))
}

/// Whether a hypothesis has many sizes of the kind of one.
pub(super) fn is_one_of_many(hypothesis: &Hypothesis, value: &Value) -> bool {
    let alike = hypothesis.parameters.iter();
    alike.filter(|other| kind(other) == kind(value)).count() > FEW
}

/// `force = 0.412 ± 0.041 N`
pub(super) fn size(hypothesis: &Hypothesis, value: &Value) -> String {
    let (effect, short) = value.name.rsplit_once('.').unwrap_or(("", &value.name));
    let number = sized(value);
    // Values of several effects may share a name.
    let site = effect
        .split_once('@')
        .filter(|_| hypothesis.effects.len() > 1);
    let site = site.map_or_else(String::new, |(_, site)| format!(" ({site})"));
    format!("{}{site} = {number}", short.replace('_', " "))
}

/// `m = 1.35 ± 0.02 kg (stated 1 kg)`: parameters that differ significantly from their stated values.
pub(super) fn moved(hypothesis: Option<&Hypothesis>) -> Vec<String> {
    /// Standard deviations beyond which a difference is significant.
    const BEYOND: f64 = 3.0;
    let changes = hypothesis.and_then(|one| one.changes.as_ref());
    let parameters = changes.iter().flat_map(|changes| changes.refitted());
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
    let changes = plain(report).and_then(|one| one.changes.as_ref());
    let changes = changes.filter(|_| refitted(report).is_some()).into_iter();
    let far = changes.flat_map(Changes::refitted);
    let mut far: Vec<&Refitted> = far
        .filter(|one| one.moved_by().is_some_and(|by| by.abs() > 1.0))
        .collect();
    let by = |one: &Refitted| one.moved_by().map_or(0.0, f64::abs);
    far.sort_by(|a, b| by(b).total_cmp(&by(a)));
    let moves = far.into_iter().filter_map(|one| {
        let name = &one.name;
        let [from, to] = [one.stated, one.value].map(short);
        let to = with_unit(&to, &one.unit);
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
    let moved = moved(plain(report));
    (needs_refit(report) && !moved.is_empty()).then(|| moved.join(", "))
}

/// Whether predictions need re-fitted parameters.
pub(super) fn needs_refit(report: &Report) -> bool {
    report.how_far.is_none() || refitted(report).is_some()
}

/// The hypothesis of re-fitted parameters alone.
fn plain(report: &Report) -> Option<&Hypothesis> {
    report.which.iter().find(|one| one.effects.is_empty())
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
    Some((first.probability, equivalents(report), rivals(report)))
}

/// `a or b: the recordings cannot tell, either may be changed`, for effects that call for a change.
pub(super) fn equivalents(report: &Report) -> Vec<String> {
    let advice = Advice::of(report);
    let idle = |effect: &str| {
        let mut idle = advice.not_determined.iter().chain(&advice.immaterial);
        idle.any(|one| one == effect)
    };
    let groups = advice.equivalent.iter();
    let groups = groups.filter(|group| !group[0].split('+').all(idle));
    let phrases = groups.map(|group| {
        let names = group.join(" or ").replace('+', " + ");
        format!("{names}: the recordings cannot tell, either may be changed")
    });
    phrases.collect()
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
    let law = part_of_law(report).filter(|law| law.is_material)?;
    let closed = part_of_all(law.closed);
    Some(format!("; measured, it closes {closed} of the gap"))
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
        let (sure, values) = (percent_of(rival.probability), values_after(rival));
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
