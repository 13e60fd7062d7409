//! The statements of a gap report.

use appell_gap::diagnose::{Change, GapVerdict, Hint, HowFar, Hypothesis, Left, Report, Share};

use super::numbers::{bounded, measured, part_of_all, percent};
use crate::text::{short, with_unit};

/// The verdict in one sentence, with the alternatives.
pub fn sentence(report: &Report) -> String {
    let mut statement = statement(report);
    if report.verdict == GapVerdict::Unexplained {
        statement += &not_found(&report.failed);
    }
    let Some((probability, same, rivals)) = alternatives(report) else {
        return statement;
    };
    if report.verdict == GapVerdict::Explained {
        let next = next_best(report).map(|next| format!("; next: {next}"));
        let (sure, next) = (percent_of(probability), next.unwrap_or_default());
        return format!("{statement} (probability {sure}{next})");
    }
    let same = (!same.is_empty())
        .then(|| format!("; {} would be the same in every motion", same.join(", ")));
    let rivals =
        (!rivals.is_empty()).then(|| format!("; {} cannot be ruled out", rivals.join(", ")));
    let (same, rivals) = (same.unwrap_or_default(), rivals.unwrap_or_default());
    let values = leading(report).map(values).unwrap_or_default();
    let sure = percent_of(probability);
    format!("{statement} (probability {sure}{values}){same}{rivals}")
}

/// `; the search of a, b did not converge, so that these are not ruled out`
fn not_found(failed: &[(Vec<String>, String)]) -> String {
    /// Longer lists are shown on the page only.
    const MOST: usize = 3;
    let failed = failed.iter().filter(|(effects, _)| !effects.is_empty());
    let mut names: Vec<String> = failed.map(|(effects, _)| joined(effects)).collect();
    if names.is_empty() {
        return String::new();
    }
    let more = names.split_off(names.len().min(MOST)).len();
    let more = (more > 0).then(|| format!(" and {more} more"));
    let (names, more) = (names.join(", "), more.unwrap_or_default());
    format!("; the search of {names}{more} did not converge, so that these are not ruled out")
}

/// The hypothesis after the leading one, with its probability.
pub(super) fn next_best(report: &Report) -> Option<String> {
    let first = &leading(report)?.effects;
    let mut others = report.which.iter();
    let next = others.find(|one| one.same_as.is_none() && one.effects != *first)?;
    let name = if next.is_unknown() {
        "none of the library".to_owned()
    } else {
        joined(&next.effects)
    };
    Some(format!("{name}, {}", percent_of(next.probability)))
}

/// `, delay = 0.012 ± 0.001 s`
fn values(hypothesis: &Hypothesis) -> String {
    let values = hypothesis.parameters.iter().map(|value| {
        let number = with_unit(&bounded(value.value, value.std), &value.unit);
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
            format!("{} = {value} (stated {stated})", one.name)
        })
    });
    moved.collect()
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

/// The parameter whose wrong value the effect describes, if it is one.
pub(super) fn parameter<'e>(hypothesis: &Hypothesis, effect: &'e str) -> Option<&'e str> {
    let (_, site) = effect.split_once('@')?;
    let changes = hypothesis.changes.as_ref()?;
    let mut parameters = changes.parameters.iter();
    parameters.any(|one| one.name == site).then_some(site)
}

/// Where several hypotheses may be true: the probability of the leading one, those indistinguishable from it, and
/// those that cannot be ruled out.
pub(super) fn alternatives(report: &Report) -> Option<(f64, Vec<String>, Vec<String>)> {
    let is_named = matches!(
        report.verdict,
        GapVerdict::Explained | GapVerdict::Ambiguous
    );
    let is_open = report.change.is_none() && is_named;
    let first = leading(report).filter(|_| is_open)?;
    Some((first.probability, twins(report), rivals(report)))
}

/// The verdict in one sentence.
pub(super) fn statement(report: &Report) -> String {
    let about: Vec<&str> = report
        .found
        .iter()
        .map(|found| found.about.as_str())
        .collect();
    if let Some(change) = &report.change {
        return changed(report, change, &about);
    }
    match report.verdict {
        GapVerdict::NoGap => {
            let refit = refit_sentence(report);
            let refit = refit.map(|moved| format!(" once parameters are re-fitted: {moved}"));
            let refit = refit.unwrap_or_default();
            format!("no gap beyond measurement and process noise{refit}")
        }
        GapVerdict::Explained => match shares(report) {
            Some(shares) => shares,
            None => format!("the gap is explained by {}", about.join(" and ")),
        },
        GapVerdict::Ambiguous => shares(report).unwrap_or_else(|| {
            let explain = if about.len() > 1 {
                "explain"
            } else {
                "explains"
            };
            format!("there is a gap; {} {explain} it best", about.join(" and "))
        }),
        GapVerdict::Unexplained if report.how_far.as_ref().is_some_and(|far| far.is_worse) => {
            let far = report.how_far.as_ref();
            let refit = far.and_then(|far| refitted(&far.budget));
            if let (Some(refit), Some(moved)) = (refit, refit_sentence(report)) {
                return format!(
                    "re-fitted parameters close {} of the gap: {moved}; what fits the recordings best beyond them \
                     does not better predictions",
                    percent(refit.closed)
                );
            }
            "there is a gap; what fits the recordings best makes predictions worse and explains nothing"
                .to_owned()
        }
        GapVerdict::Unexplained if names_effects(report) => match shares(report) {
            Some(shares) => format!("most of the gap stays: {shares}"),
            None => format!(
                "there is a gap; {} explains a part of it, most stays",
                about.join(" and ")
            ),
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
                None => unnamed(report, refitted_share(report)) + &law,
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
    let left = left.map(|left| left.about.as_str()).unwrap_or_default();
    let left = if left.is_empty() {
        String::new()
    } else {
        format!(": {left}")
    };
    if is_sure {
        return match shares {
            Some(shares) => format!("{shares}; no effect of the library explains the rest{left}"),
            None => format!("there is a gap that no effect of the library explains{left}"),
        };
    }
    let probability = report.which.iter().find(|one| one.is_unknown());
    let probability = probability.map_or(f64::NAN, |one| one.probability);
    let before = shares.map_or_else(String::new, |shares| format!("{shares}; "));
    let sure = percent_of(probability);
    format!(
        "{before}the recordings leave it open (probability {sure}) whether something is missing that the library lacks{left}"
    )
}

/// `; measured, it closes 90 % of the gap`
fn law_share(report: &Report) -> Option<String> {
    let budget = &report.how_far.as_ref()?.budget;
    let mut law = budget.iter();
    let law = law.find(|part| part.is_law() && part.is_material)?;
    Some(format!(
        "; measured, it closes {} of the gap",
        part_of_all(law.closed)
    ))
}

/// The part of the re-fitted parameters, where it matters.
pub(super) fn refitted(budget: &[Share]) -> Option<&Share> {
    let mut budget = budget.iter();
    budget.find(|part| part.is_refit() && part.is_material)
}

/// The shares of the gap closed by re-fitted parameters and by the material effects, the largest first, and the
/// rest: all relative to the gap of the model as stated.
fn shares(report: &Report) -> Option<String> {
    let budget = &report.how_far.as_ref()?.budget;
    let (mut material, others): (Vec<&Share>, Vec<&Share>) =
        (budget.iter().filter(|part| part.is_effect())).partition(|part| part.is_material);
    material.sort_by(|a, b| b.closed.total_cmp(&a.closed));
    let refit = refitted(budget);
    let about = |part: &&Share| {
        let mut found = report.found.iter();
        let found = found.find(|found| found.effect == part.name);
        found.map_or_else(|| part.name.clone(), |found| found.about.clone())
    };
    let names: Vec<String> = material.iter().map(about).collect();
    let (names, all) = (names.join(" and "), material.iter().chain(&others));
    let sum = part_of_all(all.map(|part| part.closed).sum());
    let before = refit.map_or_else(String::new, |part| {
        let closed = percent(part.closed);
        format!("re-fitted parameters close {closed} of the gap; ")
    });
    let mut text = match material.as_slice() {
        [] if others.is_empty() || before.is_empty() => return None,
        [] => {
            let names: Vec<String> = others.iter().map(about).collect();
            let is_parameter = |part: &&Share| {
                leading(report).is_some_and(|first| parameter(first, &part.name).is_some())
            };
            if let Some(refit) = refit.filter(|_| others.iter().all(is_parameter)) {
                let (names, closed) = (names.join(" and "), percent(refit.closed));
                return Some(format!(
                    "{names}: re-fitted together with the others it closes {closed} of the gap"
                ));
            }
            let depend = "predictions of the held-out runs hardly change with";
            let them = if names.len() > 1 { "them" } else { "it" };
            let are = if names.len() > 1 { "are" } else { "is" };
            let names = names.join(" and ");
            return Some(format!(
                "{before}{names} {are} there as well, but {depend} {them}"
            ));
        }
        [one] if others.is_empty() => {
            let [low, high] = one.interval.map(percent);
            let open = unsettled(one.interval);
            format!("{before}{names} closes {sum} [{low}, {high}] of the gap{open}")
        }
        [_] => format!("{before}{names} closes {sum} of the gap"),
        several => {
            let each: Vec<String> = several.iter().map(|part| percent(part.closed)).collect();
            let each = each.join(", ");
            format!("{before}{names} close {sum} ({each}) of the gap")
        }
    };
    let tail = budget.iter().filter_map(|part| {
        let is_told = part.is_law() && part.is_material;
        let law = is_told.then(|| format!("; a measured law {}", percent(part.closed)));
        law.or_else(|| {
            let rest = part_of_all(part.closed);
            part.is_rest().then(|| format!("; {rest} stays"))
        })
    });
    text.extend(tail);
    text.extend(report.how_far.as_ref().and_then(far_from_floor));
    Some(text)
}

/// A small part of the gap may still be a large error, if the model without the effects diverges.
fn far_from_floor(far: &HowFar) -> Option<String> {
    /// Share of the gap that prints as nothing, and the multiple of the floor that is notable.
    const SMALL: f64 = 5e-4;
    const MANY: f64 = 2.0;
    let rest = far.budget.iter().find(|part| part.is_rest())?;
    let times = far.with_effect / far.noise_floor;
    let is_far = rest.closed < SMALL && times > MANY && times.is_finite();
    is_far.then(|| format!(", yet errors are {times:.1} times the noise floor"))
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
    let differing = if differing.is_empty() {
        String::new()
    } else {
        format!("; {} differ from run to run", differing.join(", "))
    };
    format!("{had}, {count} parameters fitted{differing}")
}

/// The difference from the previous recordings.
fn changed(report: &Report, change: &Change, about: &[&str]) -> String {
    if !change.is_changed {
        return "nothing changed that matters for predictions".to_owned();
    }
    let names = about.join(" and ");
    match report.verdict {
        GapVerdict::NoGap => "nothing changed".to_owned(),
        GapVerdict::Explained => format!("what changed: {names}"),
        GapVerdict::Ambiguous => {
            let others = [twins(report), rivals(report)].concat();
            let all = [vec![names], others].concat();
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
    report
        .which
        .first()
        .is_some_and(|first| !first.parameters.is_empty())
}

/// A probability in whole percent, none of them certain.
pub(super) fn percent_of(probability: f64) -> String {
    match 100.0 * probability {
        percent if percent > 99.0 => "over 99 %".to_owned(),
        percent if percent < 1.0 => "under 1 %".to_owned(),
        percent => format!("{percent:.0} %"),
    }
}

/// The most probable hypothesis of the library.
pub(super) fn leading(report: &Report) -> Option<&Hypothesis> {
    report.which.iter().find(|one| one.effects != ["unknown"])
}

/// Names of the hypotheses indistinguishable from the leading one.
fn twins(report: &Report) -> Vec<String> {
    let first = leading(report).map(|first| &first.effects);
    let same = report
        .which
        .iter()
        .filter(|one| one.same_as.as_ref() == first);
    let same = same.filter(|one| one.same_as.is_some());
    same.map(|one| joined(&one.effects)).collect()
}

/// The hypotheses that are tied with the leading one, with their probabilities.
fn rivals(report: &Report) -> Vec<String> {
    let Some(first) = leading(report).map(|first| &first.effects) else {
        return Vec::new();
    };
    let groups = report.tied.iter();
    let tied = groups.filter(|group| group.contains(first)).flatten();
    let named = |effects: &Vec<String>| {
        let mut hypotheses = report.which.iter();
        let hypothesis = hypotheses.find(|hypothesis| hypothesis.effects == *effects)?;
        if hypothesis.same_as.is_some() {
            return None;
        }
        Some(format!(
            "{} ({}{})",
            joined(effects),
            percent_of(hypothesis.probability),
            values(hypothesis)
        ))
    };
    tied.filter(|effects| *effects != first)
        .filter_map(named)
        .collect()
}

/// The sentence of a hint.
fn hinted(hint: &Hint) -> String {
    format!(
        "the gap in the equation of {} depends on {}, a channel that is not in the model",
        hint.equation, hint.variable
    )
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
    let channels = report.hints.iter().map(hinted);
    channels.chain(tolerances).chain(interpolated).collect()
}

/// Windows that no hypothesis predicts, if any.
pub fn events(report: &Report) -> Option<String> {
    /// Longer lists are shown on the page only.
    const MOST: usize = 4;
    let windows = report.place.windows.iter();
    let mut events: Vec<String> = windows
        .filter_map(|window| {
            let channel = window.unexplained.as_ref()?;
            let [from, to] = [window.from, window.to].map(short);
            Some(format!(
                "{} at {from} to {to} s (the error of {channel} is {} times an ordinary one)",
                window.run,
                short(window.z)
            ))
        })
        .collect();
    if events.is_empty() {
        return None;
    }
    let more = events.split_off(events.len().min(MOST)).len();
    let more = (more > 0).then(|| format!(" and {more} more"));
    Some(format!(
        "an external force, a contact or a fault of the log: {}{}",
        events.join(", "),
        more.unwrap_or_default()
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
    let named: Vec<String> = named.collect();
    (!named.is_empty()).then(|| {
        format!(
            "{}: in the recordings, but too small to change predictions; fitted together with every hypothesis",
            named.join(", ")
        )
    })
}

/// The effects of a hypothesis; for an unexplained rest, also the effects that close a part of the gap.
pub fn said(report: &Report, hypothesis: &Hypothesis) -> String {
    let named = joined(&hypothesis.effects);
    if !hypothesis.is_unknown() {
        return named;
    }
    let budget = report.how_far.iter().flat_map(|far| &far.budget);
    let beside = budget.filter(|part| part.is_effect() && part.is_material);
    let beside: Vec<&str> = beside.map(|part| part.name.as_str()).collect();
    if beside.is_empty() {
        named
    } else {
        format!("{named} in addition to {}", beside.join(" + "))
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
