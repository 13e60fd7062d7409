//! What switches a model and its inputs, as an integrator asks for it.

use crate::inputs::ModelInputs;
use crate::integrate::Switches;
use crate::model::{At, Model, Switching};
use crate::real::Enclosure;
use crate::switching::Counts;

/// The switches of a model under its inputs, those of the model first.
pub(super) fn switches<'a>(
    model: &'a dyn Model,
    p: &'a [f64],
    inputs: &'a ModelInputs<'_>,
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
    };
    if counts.is_none() {
        return None;
    }
    let info = model.info();
    // Neither states nor inputs decide these, but every function has such arguments.
    let (x, u) = (vec![0.0; info.state_len()], vec![0.0; info.input_len()]);
    let mut inputs_now = u.clone();
    let [of_time, bounded, of_state] = [parts.clone(), parts.clone(), parts];
    Some(Switches {
        counts,
        answers: Box::new(move |t, mut answers| {
            for (part, counts) in &of_time {
                let (own, others) = answers.split_at_mut(counts.answers);
                part.answers(At { t, x: &x, u: &u, p }, own);
                answers = others;
            }
        }),
        within: Some(Box::new(move |[from, to], functions| {
            let (mut answers, mut shapes) = functions.split_at_mut(counts.answers);
            let mut all = Vec::new();
            for (part, counts) in &bounded {
                all.clear();
                all.resize(counts.answers + counts.shapes, Enclosure::UNKNOWN);
                part.within(Enclosure::time(from, to), p, &mut all);
                for (to, own) in [
                    (&mut answers, &all[..counts.answers]),
                    (&mut shapes, &all[counts.answers..]),
                ] {
                    let (now, others) = std::mem::take(to).split_at_mut(own.len());
                    now.copy_from_slice(own);
                    *to = others;
                }
            }
        })),
        crossings: Box::new(move |t, x, mut crossings| {
            inputs.fill(t, x, &mut inputs_now);
            let u = &inputs_now[..];
            for (part, counts) in &of_state {
                let (own, others) = crossings.split_at_mut(counts.crossings);
                part.crossings(At { t, x, u, p }, own);
                crossings = others;
            }
        }),
    })
}
