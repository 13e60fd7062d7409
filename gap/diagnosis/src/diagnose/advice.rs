//! Which effects of the leading hypothesis call for a change: a change of a spec lasts, so that it should be right
//! whichever of the hypotheses that cannot be ruled out is true.

use serde::Serialize;

use super::calibration::TIED;
use super::{Hypothesis, QUANTILE, Report, Share};

/// Part of the gap that may stay where effects close it.
const STAYS: f64 = 0.05;

/// The effects of the leading hypothesis, by what is known of them.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Advice {
    /// In every hypothesis that cannot be ruled out, with the same plausible size within the uncertainties; it closes a
    /// significant and material share of the gap.
    pub certain: Vec<String>,
    /// Of a determined size, but not certain.
    pub open: Vec<Open>,
    /// No size differs significantly from that without the effect.
    pub not_determined: Vec<String>,
    /// Predictions of the held-out runs hardly change with it.
    pub immaterial: Vec<String>,
    /// Effects that are equivalent in the recordings: some of the leading hypothesis, and those that may replace them.
    pub equivalent: Vec<Vec<String>>,
}

/// An effect that is not certain.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Open {
    /// Its name.
    pub effect: String,
    /// The hypotheses without it, or with another size, that cannot be ruled out.
    pub instead: Vec<Vec<String>>,
    /// Whether the held-out runs show that it closes a part of the gap.
    #[serde(rename = "shown")]
    pub is_shown: bool,
}

impl Advice {
    /// Of a report.
    pub fn of(report: &Report) -> Self {
        let mut advice = Self::default();
        let Some(first) = report.leading() else {
            return advice;
        };
        let budget = report.how_far.as_ref().map_or(&[][..], |far| &far.budget);
        // Whatever is beside an effect that closes the gap, the effect is there.
        let mut rest = budget.iter().filter(|share| share.is_rest());
        let is_closed = rest.any(|rest| rest.closed < STAYS);
        let is_rival = |one: &&Hypothesis| {
            one.effects != first.effects
                && !(is_closed && one.is_unknown())
                && one.same_as.is_none()
                && (first.probability / one.probability).ln() < TIED
        };
        let rivals: Vec<&Hypothesis> = report.which.iter().filter(is_rival).collect();
        for effect in &first.effects {
            let effect = effect.clone();
            let share = share(first, &effect, budget);
            let instead = rivals.iter().filter(|one| !agrees(first, one, &effect));
            let instead: Vec<Vec<String>> = instead.map(|one| one.effects.clone()).collect();
            let is_shown = share.is_none_or(|share| share.interval[0] > 0.0);
            if !is_determined(first, &effect) {
                advice.not_determined.push(effect);
            } else if share.is_some_and(|share| !share.is_material) {
                advice.immaterial.push(effect);
            } else if instead.is_empty() && is_shown && first.implausible(&effect).is_none() {
                advice.certain.push(effect);
            } else {
                advice.open.push(Open {
                    effect,
                    instead,
                    is_shown,
                });
            }
        }
        let twins = report.which.iter();
        for twin in twins.filter(|one| one.same_as.as_ref() == Some(&first.effects)) {
            let [own, other] = [(first, twin), (twin, first)].map(|(one, without)| {
                let effects = one.effects.iter();
                let only: Vec<&str> = effects
                    .filter(|effect| !without.effects.contains(effect))
                    .map(String::as_str)
                    .collect();
                only.join("+")
            });
            match advice.equivalent.iter_mut().find(|group| group[0] == own) {
                Some(group) => group.push(other),
                None => advice.equivalent.push(vec![own, other]),
            }
        }
        advice
    }

    /// The hypothesis, numbered from 1, that has all certain effects and no other, with sizes that agree with those of
    /// the leading one.
    pub fn hypothesis(&self, report: &Report) -> Option<usize> {
        let first = report.leading()?;
        let is_certain = |one: &Hypothesis| {
            let own = one.effects.iter();
            one.effects.len() == self.certain.len()
                && own.clone().all(|effect| self.certain.contains(effect))
                && own.clone().all(|effect| agrees(first, one, effect))
        };
        Some(report.which.iter().position(is_certain)? + 1)
    }
}

/// Whether any size differs significantly from that without the effect. An effect without sizes has none to determine.
fn is_determined(hypothesis: &Hypothesis, effect: &str) -> bool {
    let sizes = hypothesis.values_of(effect);
    let mut sizes = sizes.filter(|value| value.without.is_some()).peekable();
    sizes.peek().is_none() || sizes.any(|size| size.is_determined)
}

/// The share of an effect in the gap; that of the re-fitted parameters for the wrong value of one of them.
fn share<'s>(hypothesis: &Hypothesis, effect: &str, budget: &'s [Share]) -> Option<&'s Share> {
    let own = budget.iter().find(|share| share.name == effect)?;
    let refit = budget
        .iter()
        .find(|share| share.is_refit() && share.is_material);
    let is_refitted = !own.is_material && hypothesis.wrong_parameter(effect).is_some();
    refit.filter(|_| is_refitted).or(Some(own))
}

/// Whether another hypothesis has an effect of a size that agrees with that of the first one.
fn agrees(first: &Hypothesis, other: &Hypothesis, effect: &str) -> bool {
    let has_size = first.values_of(effect).all(|own| {
        let mut others = other
            .values_of(effect)
            .filter(|other| other.name == own.name);
        // A value at a limit has no deviation.
        let std = |std: f64| if std.is_nan() { 0.0 } else { std };
        others.any(|other| {
            let apart = (own.value - other.value).abs();
            apart <= QUANTILE * std(own.std).hypot(std(other.std))
        })
    });
    has_size && other.effects.iter().any(|own| own == effect)
}
