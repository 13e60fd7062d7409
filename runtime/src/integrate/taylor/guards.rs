//! Where the equations of a series become others: a step ends there.

use crate::integrate::sign_changes;
use crate::series::Guard;

/// A change of an answer within a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Change {
    /// The guard.
    pub(super) guard: usize,
    /// The last time since the start of the step, in s, at which its polynomial gives the old answer.
    pub(super) before: f64,
    /// The first one at which it gives another.
    pub(super) after: f64,
}

/// The first change of an answer within `h` seconds. `coefficients` are those of the guards, order by order.
pub(super) fn first_change(guards: &[Guard], coefficients: &[f64], h: f64) -> Option<Change> {
    let count = guards.len();
    let mut first: Option<Change> = None;
    for (place, guard) in guards.iter().enumerate() {
        let terms = || coefficients[place..].iter().step_by(count);
        let longest = first.map_or(h, |change| change.before);
        let most = terms().skip(1).rev();
        let most = longest * most.fold(0.0, |sum, term| term.abs() + longest * sum);
        if terms().next().is_some_and(|now| now.abs() > most) {
            continue;
        }
        let g = |tau: f64| terms().rev().fold(0.0, |sum, term| term + tau * sum);
        let old = guard.answer(g(0.0));
        let change =
            sign_changes::first_change(g, |value| guard.answer(value) != old, [0.0, longest]);
        if let Some([before, after]) = change {
            first = Some(Change {
                guard: place,
                before,
                after,
            });
        }
    }
    first
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_change_of_all_guards_ends_the_step() {
        // 1 − τ and τ² − 1/4.
        let guards = [Guard::Negative, Guard::NotPositive];
        let coefficients = [1.0, -0.25, -1.0, 0.0, 0.0, 1.0];
        let change = first_change(&guards, &coefficients, 2.0);
        assert_eq!(change.map(|change| change.guard), Some(1));
        let close = |t: f64| (t - 0.5).abs() < 1e-15;
        assert!(change.is_some_and(|change| close(change.before) && close(change.after)));
        assert_eq!(first_change(&guards, &coefficients, 0.4), None);
    }

    #[test]
    fn a_sign_ends_at_once_where_it_is_zero() {
        let change = first_change(&[Guard::Sign], &[0.0, 1.0], 1.0);
        let at_once = |change: Change| change.before == 0.0 && change.after < 1e-300;
        assert!(change.is_some_and(at_once), "{change:?}");
    }
}
