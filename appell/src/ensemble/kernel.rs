//! The motions of a study as a source for a graphics card.

use appell_codegen::c::{self, Followed};
use appell_codegen::program::FunctionKind;
use appell_codegen::tape::{Argument, ResultArray, Tape};
use appell_ensemble::study::{Kept, Method};
use appell_runtime::integrate::{Dop853, Dopri5, Range};

use super::cases::{self, Cases, Task};
use super::spec::Quantity;
use super::variant::Variant;
use crate::inputs::closed_loop::Onto;
use crate::inputs::law::index;
use crate::{Error, Field, Model};

/// The name of the kernel.
#[cfg(feature = "cuda")]
pub(super) const NAME: &str = "motion_cases";

/// The kept quantities of a motion by how a kernel computes them: indices among those of the task.
#[derive(Default)]
pub(super) struct Kinds {
    events: Vec<usize>,
    followed: Vec<usize>,
    /// Those of a time: at the end, at a given time, over time.
    pub(super) recorded: Vec<usize>,
}

impl Kinds {
    pub(super) fn of(task: &Task) -> Self {
        let mut kinds = Self::default();
        for (index, keep) in task.keep.iter().enumerate() {
            let kind = match keep.kept {
                Kept::When { .. } => &mut kinds.events,
                Kept::Max | Kept::Min | Kept::Mean => &mut kinds.followed,
                Kept::End | Kept::At(_) | Kept::Course => &mut kinds.recorded,
            };
            kind.push(index);
        }
        kinds
    }
}

/// The source of the motions of a spec under a law.
pub(super) fn source(study: &Cases, variant: &Variant) -> Result<String, Error> {
    let (model, task, motion) = (&*variant.model, &study.task, &study.study.motion);
    if let Some(reason) = variant.wiring.outside() {
        let message = format!("a graphics card computes no motion with {reason}");
        return Err(Error::request(Field::Device, message));
    }
    let info = model.info();
    let seen: Vec<Onto> = variant.noises.iter().map(|noise| noise.onto).collect();
    let composed = |functions: &[&Tape]| variant.wiring.composed(functions, info, &seen);
    let own_crossings = variant.wiring.crossings();
    let crossings = model.tape(FunctionKind::Crossings)?.into_iter();
    let crossings: Vec<&Tape> = crossings.chain(&own_crossings).collect();
    let kinds = Kinds::of(task);
    let kept = |which: &[usize]| -> Result<Tape, Error> {
        let quantities = which.iter().map(|&index| variant.kept[task.which[index]]);
        Ok(composed(&[&listed(model, quantities)?]))
    };
    let factors = study.factors();
    let column = |index: usize| task.layout.first[index] - factors;
    let kept_as = |index: usize| &task.keep[index].kept;
    let stops = |index: usize| *kept_as(index) == Kept::When { stop: true };
    let followed_columns = kinds.followed.iter().map(|&index| {
        let how = match kept_as(index) {
            Kept::Max => Followed::Largest,
            Kept::Min => Followed::Smallest,
            _ => Followed::Mean,
        };
        (how, column(index))
    });
    let ends = kinds.recorded.iter().enumerate();
    let ends = ends.filter(|&(_, &index)| *kept_as(index) == Kept::End);
    Ok(c::motion(&c::Motion {
        title: &info.title,
        sizes: [
            info.state_len(),
            variant.wiring.inputs() + seen.len(),
            info.parameter_len(),
        ],
        columns: task.layout.columns.len() - factors,
        rates: &composed(&[model.rates()?]),
        crossings: &composed(&crossings),
        events: &kept(&kinds.events)?,
        event_columns: kinds
            .events
            .iter()
            .map(|&index| (column(index), stops(index)))
            .collect(),
        followed: &kept(&kinds.followed)?,
        followed_columns: followed_columns.collect(),
        constraints: &composed(&[&constraints(model)?]),
        constrained: [
            model.equations().dependent_coordinates().len(),
            info.state_len() - info.speeds,
        ],
        recorded: &kept(&kinds.recorded)?,
        end_columns: ends.map(|(place, &index)| (place, column(index))).collect(),
        method: match motion.method {
            Method::Dop853 => Dop853::coefficients(),
            Method::Dopri5 => Dopri5::coefficients(),
        },
        options: cases::options(motion),
        end: motion.t_end,
        interval: task.layout.interval,
        ranges: if motion.ignore_ranges {
            Vec::new()
        } else {
            Range::of(info)
        },
        noises: (variant.noises.iter())
            .map(|noise| (noise.every(), noise.count(motion.t_end)))
            .collect(),
    }))
}

/// Quantities as one list.
fn listed(model: &Model, quantities: impl Iterator<Item = Quantity>) -> Result<Tape, Error> {
    let mut tape = model
        .tape(FunctionKind::Outputs)?
        .cloned()
        .unwrap_or_default();
    let outputs = tape.results.first().map(|result| result.entries.clone());
    let outputs = outputs.unwrap_or_default();
    let entries = quantities.map(|quantity| match quantity {
        Quantity::State(state) => tape.argument(Argument::State(index(state))),
        Quantity::Input(input) => tape.argument(Argument::Input(index(input))),
        Quantity::Output(output, _) => outputs[output],
    });
    let entries = entries.collect();
    tape.results = vec![ResultArray {
        name: "kept".to_owned(),
        entries,
    }];
    Ok(tape)
}

/// The position constraints and their derivatives as one list.
fn constraints(model: &Model) -> Result<Tape, Error> {
    let tape = model.tape(FunctionKind::PositionConstraints)?;
    let mut tape = tape.cloned().unwrap_or_default();
    let entries = tape
        .results
        .iter()
        .flat_map(|result| result.entries.clone());
    tape.results = vec![ResultArray {
        name: "constraints".to_owned(),
        entries: entries.collect(),
    }];
    Ok(tape)
}
