//! Sign changes of a function of time within a step.

/// Subintervals of a step in which sign changes are sought.
const PARTS: usize = 8;
/// Golden-section iterations for a minimum of the absolute value: to a relative length of 1e-9.
const SHORTENINGS: usize = 44;
/// The shorter fraction of a golden section.
const GOLDEN: f64 = 0.381_966_011_250_105_1;
/// Distance from an end of the step at which its slope is measured, as a fraction of an eighth.
const NEAR: f64 = 1e-3;

/// Adjacent times between which the predicate of a function changes for the first time.
///
/// The function is sampled at eighths of the interval. Where its absolute value has a minimum between three samples,
/// or next to an end, the minimum is located, so that a double sign change between samples is found.
pub(super) fn first_change(
    mut g: impl FnMut(f64) -> f64,
    answer: impl Fn(f64) -> bool,
    [from, to]: [f64; 2],
) -> Option<[f64; 2]> {
    let time = |part: usize| match part {
        PARTS => to,
        _ => from + (to - from) * (part as f64 / PARTS as f64),
    };
    let mut samples = [g(from); PARTS + 1];
    let mut last = PARTS;
    for (part, sample) in samples.iter_mut().enumerate().skip(1) {
        *sample = g(time(part));
        if answer(*sample) {
            last = part;
            break;
        }
    }
    let size = |part: usize| samples[part].abs();
    let near = NEAR * (time(1) - from);
    for part in 0..=last {
        let dips = match part {
            // A minimum next to an end shows in the slope there.
            0 => last > 0 && size(1) >= size(0) && g(from + near).abs() < size(0),
            PARTS => size(last - 1) >= size(last) && g(to - near).abs() < size(last),
            _ if part == last => false,
            _ => size(part) <= size(part - 1) && size(part) <= size(part + 1),
        };
        let [left, right] = [part.saturating_sub(1), (part + 1).min(last)].map(time);
        let found = dips.then(|| changed_near_zero(&mut g, &answer, [left, right]));
        if let Some(changed) = found.flatten() {
            return Some(neighbours(|t| answer(g(t)), [left, changed]));
        }
    }
    answer(samples[last]).then(|| neighbours(|t| answer(g(t)), [time(last - 1), time(last)]))
}

/// A time near a minimum of the absolute value at which the predicate has changed.
fn changed_near_zero(
    mut g: impl FnMut(f64) -> f64,
    answer: impl Fn(f64) -> bool,
    [mut left, mut right]: [f64; 2],
) -> Option<f64> {
    let inner = |left: f64, right: f64| {
        [
            left + GOLDEN * (right - left),
            right - GOLDEN * (right - left),
        ]
    };
    let mut at = inner(left, right);
    let mut values = at.map(&mut g);
    for _ in 0..SHORTENINGS {
        if let Some(which) = values.iter().position(|&value| answer(value)) {
            return Some(at[which]);
        }
        if values[0].abs() < values[1].abs() {
            right = at[1];
            at = [inner(left, right)[0], at[0]];
            values = [g(at[0]), values[0]];
        } else {
            left = at[0];
            at = [at[1], inner(left, right)[1]];
            values = [values[1], g(at[1])];
        }
        if at[1] <= at[0] {
            break;
        }
    }
    None
}

/// The last time with the old value and the first with the new one, by bisection down to adjacent numbers.
pub(super) fn neighbours(
    mut changed: impl FnMut(f64) -> bool,
    [mut same, mut other]: [f64; 2],
) -> [f64; 2] {
    loop {
        let middle = same + (other - same) / 2.0;
        if middle <= same || middle >= other {
            return [same, other];
        }
        let end = if changed(middle) {
            &mut other
        } else {
            &mut same
        };
        *end = middle;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn negative(g: f64) -> bool {
        g < 0.0
    }

    #[test]
    fn a_change_and_its_opposite_between_samples_are_found() {
        for (centre, width) in [(0.5, 1e-3), (0.03, 1e-2), (0.97, 1e-2), (0.42, 1e-6)] {
            let smooth = |t: f64| (t - centre).powi(2) - width * width;
            let sharp = |t: f64| (t - centre).abs() - width;
            for change in [
                first_change(smooth, negative, [0.0, 1.0]),
                first_change(sharp, negative, [0.0, 1.0]),
            ] {
                let found = change.unwrap_or_else(|| panic!("{centre} {width}"));
                assert!((found[1] - (centre - width)).abs() < 1e-9, "{found:?}");
            }
        }
    }

    #[test]
    fn what_comes_near_and_turns_back_does_not_change() {
        let away = |t: f64| (t - 0.3).powi(2) + 1e-9;
        assert_eq!(first_change(away, negative, [0.0, 1.0]), None);
        assert_eq!(first_change(|t| 1.0 + t, negative, [0.0, 1.0]), None);
    }
}
