//! Switching functions of a model and its inputs, in the form required by an integrator.

use crate::inputs::ModelInputs;
use crate::integrate::{SharedTimes, Stretch, Switches};
use crate::model::{Along, At, Model, Switching};
use crate::real::Enclosure;
use crate::switching::Counts;

/// The switching functions of a model and of its inputs, those of the model first. Motions whose functions of time are the
/// same share what is known about them.
pub(super) fn switches<'a>(
    model: &'a dyn Model,
    p: &'a [f64],
    inputs: &'a ModelInputs<'_>,
    shared: &SharedTimes,
) -> Option<Switches<'a>> {
    let both = [model.switching(), inputs.switching()];
    let parts: Vec<(&dyn Switching, Counts)> = both
        .into_iter()
        .flatten()
        .map(|part| (part, part.counts()))
        .collect();
    let total = |of: fn(&Counts) -> usize| parts.iter().map(|(_, counts)| of(counts)).sum();
    let counts = Counts {
        answers: total(|counts| counts.answers),
        shapes: total(|counts| counts.shapes),
        crossings: total(|counts| counts.crossings),
        pulses: total(|counts| counts.pulses),
    };
    if counts.is_none() {
        return None;
    }
    let are_same = parts.iter().all(|(part, _)| part.is_of_time_alone());
    let info = model.info();
    // Functions of time alone ignore these arguments.
    let (x, u) = (vec![0.0; info.state_len()], vec![0.0; info.input_len()]);
    let mut inputs_now = u.clone();
    let mut u_along = vec![Enclosure::UNKNOWN; u.len()];
    let [of_time, bounded, of_state, bounded_by_state] =
        [parts.clone(), parts.clone(), parts.clone(), parts];
    Some(Switches {
        counts,
        shared: are_same.then(|| shared.clone()),
        answers: Box::new(move |t, mut answers| {
            for (part, counts) in &of_time {
                let (own, others) = answers.split_at_mut(counts.answers);
                part.answers(At { t, x: &x, u: &u, p }, own);
                answers = others;
            }
        }),
        within: Some(Box::new(move |[from, to], functions| {
            let mut sorted = Sorted::new(functions, counts.answers);
            for (part, own) in &bounded {
                let mut all = vec![Enclosure::UNKNOWN; own.answers + own.shapes];
                part.within(Enclosure::time(from, to), p, &mut all);
                sorted.take(&all, own.answers);
            }
        })),
        crossings: Box::new(move |t, x, functions| {
            inputs.fill(t, x, &mut inputs_now);
            let u = &inputs_now[..];
            let mut sorted = Sorted::new(functions, counts.crossings);
            for (part, own) in &of_state {
                let mut all = vec![0.0; own.crossings + own.pulses];
                part.crossings(At { t, x, u, p }, &mut all);
                sorted.take(&all, own.crossings);
            }
        }),
        along: Some(Box::new(move |stretch, functions| {
            let Stretch { start, t, x } = stretch;
            let of_inputs = Along {
                start,
                t,
                x,
                u: &[],
                p,
            };
            inputs.bounds(&of_inputs, &mut u_along);
            let along = Along {
                u: &u_along,
                ..of_inputs
            };
            let mut sorted = Sorted::new(functions, counts.crossings);
            for (part, own) in &bounded_by_state {
                let mut all = vec![Enclosure::UNKNOWN; own.crossings + own.pulses];
                part.crossings_within(&along, &mut all);
                sorted.take(&all, own.crossings);
            }
        })),
    })
}

/// The functions of all parts, sorted by kind.
struct Sorted<'f, T> {
    first: &'f mut [T],
    second: &'f mut [T],
}

impl<'f, T: Copy> Sorted<'f, T> {
    fn new(functions: &'f mut [T], count: usize) -> Self {
        let (first, second) = functions.split_at_mut(count);
        Self { first, second }
    }

    /// Adds those of the next part, of which `count` are of the first kind.
    fn take(&mut self, all: &[T], count: usize) {
        let (first, second) = all.split_at(count);
        for (to, own) in [(&mut self.first, first), (&mut self.second, second)] {
            let (now, others) = std::mem::take(to).split_at_mut(own.len());
            now.copy_from_slice(own);
            *to = others;
        }
    }
}
