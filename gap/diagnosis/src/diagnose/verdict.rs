//! The verdict: what the leading hypothesis says, after predictions of the held-out runs.

use super::calibration::{IMMATERIAL, MUCH, TIED};
use super::report::UNKNOWN;
use super::{Bench, HowFar, Hypothesis, Left, Report, Share, Where};

/// The result in one word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum GapVerdict {
    /// No gap beyond measurement and process noise.
    #[default]
    NoGap,
    /// One hypothesis wins.
    Explained,
    /// A gap with several explanations that cannot be distinguished.
    Ambiguous,
    /// A gap that no effect of the library explains.
    Unexplained,
}

/// Largest unexplained part of an explained gap.
const MOST: f64 = 0.5;
/// Mean square error relative to that of the noise up to which predictions are as good as they can be.
const NEAR: f64 = 2.0;
/// Log Bayes factor of a law one step ahead beyond which it is a gap although predictions over a second do not show it:
/// odds of some hundred.
const DECISIVE: f64 = 2.0 * TIED;
/// Part of its probability that `unknown` keeps where its law closes nothing.
const DOUBT: f64 = 0.05;

impl GapVerdict {
    /// The verdict, from the most probable hypothesis and those that are tied.
    pub(super) fn of(top: &Hypothesis, tied: &[Vec<Vec<String>>]) -> Self {
        match top.effects.first().map(String::as_str) {
            None => Self::NoGap,
            Some(UNKNOWN) if tied.is_empty() => Self::Unexplained,
            Some(_) if tied.is_empty() => Self::Explained,
            Some(_) => Self::Ambiguous,
        }
    }

    /// The verdict after predictions of the held-out runs: an effect that does not improve them explains nothing, nor
    /// do effects that leave most of the gap if simulations rank the hypotheses.
    pub(super) fn after(
        self,
        which: &[Hypothesis],
        far: Option<&HowFar>,
        is_by_simulation: bool,
    ) -> Self {
        let Some(far) = far else { return self };
        let names_effects = matches!(self, Self::Explained | Self::Ambiguous)
            && which.iter().any(|one| !one.parameters.is_empty());
        let stays = far.budget.iter().find(|part| part.is_rest());
        let most_stays = stays.is_some_and(|part| part.closed > MOST);
        // An effect that closes nothing is no explanation, however significant it is.
        let mut parts = far.budget.iter();
        let closes = parts.any(|part| part.is_effect() && part.is_material);
        if self == Self::Explained && names_effects && !far.budget.is_empty() && !closes {
            return Self::Ambiguous;
        }
        if names_effects && (far.is_worse || is_by_simulation && most_stays) {
            Self::Unexplained
        } else {
            self
        }
    }

    /// Its keyword.
    pub const fn word(self) -> &'static str {
        match self {
            Self::NoGap => "no_gap",
            Self::Explained => "explained",
            Self::Ambiguous => "ambiguous",
            Self::Unexplained => "unexplained",
        }
    }
}

impl Report {
    /// Whether `unknown` leads after predictions of the held-out runs although no gap was found: a law of no effect of
    /// the library may be too small for windows and yet predict materially better. `place` is where it acts.
    pub(super) fn recall_law(&mut self, far: &HowFar, place: &Where) -> bool {
        let predicts = |part: &Share| part.is_law() && part.interval[0] > IMMATERIAL;
        let is_gap = far.budget.iter().any(predicts) && far.kept_of_law() >= 1.0;
        if self.verdict != GapVerdict::NoGap || !is_gap {
            return false;
        }
        for one in &mut self.which {
            one.probability /= 1.0 + MUCH;
            if one.is_unknown() {
                one.probability += MUCH / (1.0 + MUCH);
            }
        }
        (self.which).sort_by(|a, b| b.probability.total_cmp(&a.probability));
        self.verdict = GapVerdict::of(&self.which[0], &self.tied);
        let windows = std::mem::replace(&mut self.place, place.clone()).windows;
        self.place.windows.extend(windows);
        true
    }

    /// Whether the evidence for a law is decisive, one step ahead and on runs to which it was not fitted: predictions
    /// over a second may not resolve it. Over windows there is no process noise that gusts could be, and what servos
    /// hide is immaterial.
    fn is_law_decisive(&self, bench: &Bench<'_>) -> bool {
        let is_decisive = |left: &Left| left.log_bayes_factor > DECISIVE;
        let is_one_step = !bench.is_over_windows() && !bench.is_of_robot;
        is_one_step && self.left.as_ref().is_some_and(is_decisive)
    }

    /// The verdict after predictions of the held-out runs.
    pub(super) fn settle(&mut self, far: Option<&HowFar>, bench: &Bench<'_>) {
        if let Some(far) = far
            && !self.is_law_decisive(bench)
            && forget_immaterial_law(&mut self.which, far)
        {
            self.verdict = GapVerdict::of(&self.which[0], &self.tied);
            if self.verdict == GapVerdict::NoGap {
                self.place = Where::default();
            }
        }
        let is_by_simulation = bench.is_over_windows();
        self.verdict = self.verdict.after(&self.which, far, is_by_simulation);
    }
}

impl HowFar {
    /// Part of its probability that a law of no effect of the library keeps: a law that closes nothing is no gap, however
    /// significant it is, if all else closes the gap up to errors near the noise, or if the noise explains the errors.
    fn kept_of_law(&self) -> f64 {
        let closed = |is_it: fn(&Share) -> bool| {
            let parts = self.budget.iter().filter(|part| is_it(part));
            parts.map(|part| part.closed).sum::<f64>()
        };
        let (law, rest) = (closed(Share::is_law), closed(Share::is_rest));
        let [floor, nominal, refitted] =
            [self.noise_floor, self.nominal, self.refitted].map(|error| error.powi(2));
        // Errors far below the floor are no sign of noise: process noise has taken the place of a systematic error.
        let is_noise = (refitted..=NEAR * refitted).contains(&floor);
        let without_law = floor + (law + rest) * (nominal - floor);
        let is_closed_otherwise = law + rest <= IMMATERIAL && without_law <= NEAR * floor;
        match (is_noise, is_closed_otherwise) {
            (true, _) => DOUBT,
            (false, true) => (law / IMMATERIAL).clamp(DOUBT, 1.0),
            (false, false) => 1.0,
        }
    }
}

/// Reduces the probability of a leading `unknown` by what its law closes. Returns whether another hypothesis leads then.
fn forget_immaterial_law(which: &mut [Hypothesis], far: &HowFar) -> bool {
    if far.budget.is_empty() || !which.first().is_some_and(Hypothesis::is_unknown) {
        return false;
    }
    let before = which[0].probability;
    which[0].probability *= far.kept_of_law();
    let removed = before - which[0].probability;
    let others: f64 = which[1..].iter().map(|one| one.probability).sum();
    match which {
        // Beside a certain law the best of the others had too small a probability for a number.
        [_, next, ..] if others == 0.0 => next.probability = removed,
        [_, rest @ ..] => {
            for one in rest {
                one.probability += removed * one.probability / others;
            }
        }
        [] => {}
    }
    which.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    !which[0].is_unknown()
}

#[cfg(test)]
mod tests {
    use super::super::report::{LAW, REFIT, REST};
    use super::super::yardstick::Value;
    use super::*;

    fn far(closed: f64, is_material: bool) -> HowFar {
        let share = |name: &str, closed: f64, is_material| Share {
            name: name.to_owned(),
            closed,
            interval: [closed - 0.01, closed + 0.01],
            is_material,
        };
        HowFar {
            nominal: 10.0,
            refitted: 9.0,
            with_effect: 1.0,
            noise_floor: 0.5,
            budget: vec![
                share(REFIT, 0.99 - closed, true),
                share("coulomb_friction@x", closed, is_material),
                share(REST, 0.01, false),
            ],
            ..HowFar::default()
        }
    }

    fn hypothesis(effect: Option<&str>, probability: f64) -> Hypothesis {
        Hypothesis {
            effects: effect.iter().map(|&name| name.to_owned()).collect(),
            probability,
            ..Hypothesis::default()
        }
    }

    /// The first hypothesis and its probability after a report of how far `unknown` predicts.
    fn first(unknown: f64, far: &HowFar) -> (Vec<String>, f64) {
        let mut which = [
            hypothesis(Some(UNKNOWN), unknown),
            hypothesis(None, 0.8 * (1.0 - unknown)),
            hypothesis(Some("coulomb_friction@x"), 0.2 * (1.0 - unknown)),
        ];
        let changes = forget_immaterial_law(&mut which, far);
        let sum: f64 = which.iter().map(|one| one.probability).sum();
        assert!((sum - 1.0).abs() < 1e-12, "{sum}");
        assert_eq!(changes, !which[0].is_unknown());
        let [first, ..] = which;
        (first.effects, first.probability)
    }

    fn with_budget(budget: &[(&str, f64)]) -> HowFar {
        let budget = budget.iter().map(|&(name, closed)| Share {
            name: name.to_owned(),
            closed,
            interval: [closed; 2],
            is_material: closed > 0.02,
        });
        HowFar {
            budget: budget.collect(),
            ..far(1.0, true)
        }
    }

    #[test]
    fn a_law_that_closes_nothing_is_no_gap() {
        // Re-fitted parameters close all of it, with and without a measured law.
        for budget in [
            &[(REFIT, 1.05), (REST, -0.05)][..],
            &[(REFIT, 0.999), (LAW, 0.0), (REST, 0.001)],
        ] {
            // Beside a law that was certain no other has a share.
            for (unknown, range) in [(0.95, 0.7..0.8), (1.0, 0.9..1.0)] {
                let (effects, probability) = first(unknown, &with_budget(budget));
                assert!(effects.is_empty() && range.contains(&probability));
            }
        }
        // Nothing of the gap closes, as there is none: the noise explains the errors.
        let of_noise = |error: f64, noise_floor: f64| HowFar {
            nominal: error,
            refitted: error,
            noise_floor,
            ..with_budget(&[(REFIT, 0.0), (REST, 1.0)])
        };
        assert!(first(0.95, &of_noise(14.2, 14.7)).0.is_empty());
        for far in [
            // The law closes a part, or much stays, or a part that is small and many times the noise.
            with_budget(&[(REFIT, 0.7), (LAW, 0.29), (REST, 0.01)]),
            with_budget(&[(REFIT, 0.6), (LAW, 0.0), (REST, 0.4)]),
            with_budget(&[(REFIT, 0.985), (LAW, 0.014), (REST, 0.001)]),
            // Errors above the noise, and far below what process noise would do.
            of_noise(14.2, 12.0),
            of_noise(112.0, 505.0),
        ] {
            assert_eq!(first(0.95, &far), (vec![UNKNOWN.to_owned()], 0.95));
        }
    }

    #[test]
    fn a_law_that_predicts_is_a_gap_although_windows_do_not_show_it() {
        let recalled = |budget: &[(&str, f64)]| {
            let mut report = Report {
                which: vec![hypothesis(None, 1.0), hypothesis(Some(UNKNOWN), 0.0)],
                ..Report::default()
            };
            let is_recalled = report.recall_law(&with_budget(budget), &Where::default());
            assert_eq!(is_recalled, report.verdict == GapVerdict::Unexplained);
            assert_eq!(is_recalled, report.which[0].is_unknown());
            report.which[0].probability
        };
        let probability = recalled(&[(REFIT, 0.62), (LAW, 0.32), (REST, 0.06)]);
        assert!((probability - 20.0 / 21.0).abs() < 1e-12, "{probability}");
        // The law is immaterial, or there is none.
        for budget in [
            &[(REFIT, 0.98), (LAW, 0.01), (REST, 0.01)][..],
            &[(REFIT, 0.62), (REST, 0.38)],
        ] {
            assert!(recalled(budget) >= 1.0);
        }
    }

    #[test]
    fn what_closes_nothing_explains_nothing() {
        let which = [Hypothesis {
            parameters: vec![Value::default()],
            ..hypothesis(Some("coulomb_friction@x"), 0.95)
        }];
        let after = |far: &HowFar| GapVerdict::Explained.after(&which, Some(far), false);
        assert_eq!(after(&far(0.9, true)), GapVerdict::Explained);
        assert_eq!(after(&far(0.001, false)), GapVerdict::Ambiguous);
    }
}
