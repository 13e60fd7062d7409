//! Resolution of a sensor: lines of an encoder, digits of a converter.

/// Number of changes examined.
const MOST: usize = 20_000;
/// Least number of changes of a few steps.
const FEWEST: usize = 24;
/// Largest change that is examined, in steps.
const FAR: f64 = 20.0;
/// Largest distance of a change from a whole number of steps, as digits are rounded.
const NEAR: f64 = 0.1;
/// Part of the changes that have to be whole; of numbers without steps, a fifth are.
const MOST_OF_THEM: f64 = 0.98;
/// Part of the values that have to repeat the one before, or to change by several steps.
const REPEATED: f64 = 0.05;

/// The largest step of which all changes are multiples; `None` if there is none.
pub(crate) fn quantum<'v>(records: impl Iterator<Item = &'v [f64]>) -> Option<f64> {
    let (mut changes, mut unchanged) = (Vec::new(), 0_usize);
    for values in records {
        let mut there = values.iter().filter(|value| !value.is_nan());
        let Some(mut last) = there.next() else {
            continue;
        };
        for value in there {
            let change = (value - last).abs();
            last = value;
            if change > 0.0 {
                changes.push(change);
            } else {
                unchanged += 1;
            }
        }
    }
    let varied = REPEATED * (changes.len() + unchanged) as f64;
    let often_unchanged = unchanged as f64 > varied;
    let every = changes.len().div_ceil(MOST).max(1);
    let mut changes: Vec<f64> = changes.into_iter().step_by(every).collect();
    changes.sort_by(f64::total_cmp);
    // The smallest ones may be rounding; of a motion that is slow somewhere, many are one step.
    let smallest = *changes.get(changes.len() / 50)?;
    [1.0, 2.0, 3.0]
        .into_iter()
        .find_map(|part| whole(&changes, smallest / part))
        // A steady motion changes by about as much each time, which is no step.
        .filter(|step| {
            let several = changes.iter().filter(|change| **change > 1.5 * step);
            often_unchanged || several.count() as f64 > varied
        })
}

/// The step near a first guess, if most changes are multiples of it.
fn whole(changes: &[f64], guess: f64) -> Option<f64> {
    let mut step = guess;
    for far in [2.5, 6.0, FAR] {
        let few = changes.iter().filter(|change| **change < far * step);
        let (mut over, mut under) = (0.0, 0.0);
        for change in few {
            let count = (change / step).round();
            over += count * change;
            under += count * count;
        }
        if under > 0.0 {
            step = over / under;
        }
    }
    let few: Vec<f64> = changes
        .iter()
        .map(|change| change / step)
        .filter(|count| *count < FAR)
        .collect();
    let near = few.iter().filter(|count| {
        let nearest = count.round();
        nearest > 0.0 && (**count - nearest).abs() < NEAR
    });
    let enough = few.len() >= FEWEST && near.count() as f64 >= MOST_OF_THEM * few.len() as f64;
    enough.then_some(step)
}
