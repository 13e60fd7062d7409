//! What re-fitted parameters, effects and a measured law close of the gap, and what stays, as a sentence.

use appell_gap::diagnose::{Advice, HowFar, Report, Share};

use super::numbers::{compared, part_of_all, percent, small};
use crate::text::short;

/// The shares of the gap closed by re-fitted parameters and by the effects that matter, the largest first, and the rest:
/// all relative to the gap of the model as stated. `None` if nothing closes a material share.
pub(super) fn shares(report: &Report) -> Option<String> {
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
    // Wrong parameters are named with what all re-fitted ones close.
    let refit = refit.filter(|_| !(named.is_empty() && are_parameters(report, &others)));
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
        about + &doubted(report, &part.name).unwrap_or_default()
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

/// Whether effects are wrong values of parameters, so that re-fitted parameters close their share.
fn are_parameters(report: &Report, effects: &[&Share]) -> bool {
    let is_parameter = |part: &&Share| {
        let first = report.leading();
        first.is_some_and(|first| first.wrong_parameter(&part.name).is_some())
    };
    !effects.is_empty() && effects.iter().all(is_parameter)
}

/// Effects none of which is named, and why.
fn unnoticed(report: &Report, others: &[&Share], names: &str) -> String {
    if let Some(refit) = refitted(report).filter(|_| are_parameters(report, others)) {
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

/// ` (36.1 × the stated inertia of omega: plausible?)`
fn doubted(report: &Report, effect: &str) -> Option<String> {
    let known = report.leading()?.implausible(effect)?;
    Some(format!(" ({}: plausible?)", compared(known)))
}

/// `, an error of 385 times the noise, whose floor is 1.2`: a small part of the gap of a model that diverges is a large error.
fn error_left(far: &HowFar) -> Option<String> {
    let [times, floor] = [far.with_effect, far.noise_floor].map(short);
    let is_known = (far.with_effect / far.noise_floor).is_finite();
    is_known.then(|| format!(", an error of {times} times the noise, whose floor is {floor}"))
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

/// `re-fitted parameters close 98 % of the gap`, where they matter.
pub(super) fn refitted_share(report: &Report) -> Option<String> {
    let closed = percent(refitted(report)?.closed);
    Some(format!("re-fitted parameters close {closed} of the gap"))
}

/// The part of the re-fitted parameters, where it matters.
pub(super) fn refitted(report: &Report) -> Option<&Share> {
    let mut budget = report.how_far.as_ref()?.budget.iter();
    budget.find(|part| part.is_refit() && part.is_material)
}
