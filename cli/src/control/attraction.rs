//! From which disturbances a law brings the mechanism back: simulations from a grid of them.

use std::fmt::Write as _;

use appell_analysis::control::attraction::{Axis, Fate, Fates, Region};
use appell_analysis::control::feedback::Feedback;
use appell_analysis::control::sampler::{SampledFeedback, Sampler};
use appell_report::figure::Map;
use appell_runtime::Trajectory;
use appell_runtime::inputs::InputSource;
use appell_runtime::model::{Model, ModelInfo, Quantity};
use serde_json::{Value, json};

use super::ask;
use super::design::{Design, Law};
use crate::failure::Failure;
use crate::progress;
use crate::setup::Setup;
use crate::table::number;

/// A motion is settled where each fed-back state is within this part of the largest deviation that
/// it had, …
const SETTLED: f64 = 0.05;
/// … or within this of the steady motion, in SI.
const STILL: f64 = 1e-6;
/// Motions of one grid at most.
const MOST: usize = 100_000;

/// What became of the motions.
pub(crate) struct Explored<'a> {
    info: &'a ModelInfo,
    fates: Fates,
    duration: f64,
}

/// Simulates a law from every disturbance of `NAME=FROM..TO/STEPS,…`.
pub(crate) fn explore<'a>(
    model: &dyn Model,
    setup: &Setup<'a>,
    design: &Design,
    asked: &str,
    duration: f64,
) -> Result<Explored<'a>, Failure> {
    if !(duration.is_finite() && duration > 0.0) {
        let text = format!("`--for-s {duration}` must be a positive number of seconds");
        return Err(Failure::Usage(text));
    }
    let Some(law) = &design.law else {
        return Err(Failure::Usage("`--attraction` needs a law".to_owned()));
    };
    let axes = axes(setup, design, asked)?;
    let count: usize = axes.iter().map(|axis| axis.values.len()).product();
    if count > MOST {
        let text =
            format!("--attraction: {count} motions are too many; at most {MOST} are possible");
        return Err(Failure::Usage(text));
    }
    let settled = |motion: &Trajectory| {
        design.outputs.iter().all(|&state| {
            let away = |x: &f64| (x - design.x[state]).abs();
            let column = motion
                .column(&setup.info.states[state].name)
                .unwrap_or_default();
            let largest = column.iter().map(away).fold(0.0, f64::max);
            away(&motion.last_state()[state]) <= STILL.max(SETTLED * largest)
        })
    };
    let region = Region {
        model,
        parameters: &design.p,
        state: &design.x,
        inputs: &|| closed(model, design, law, duration),
        duration,
        axes,
        settled: &settled,
    };
    let bar = progress::parts();
    bar.set_length(count as u64);
    let fates = region.explore(&|done| bar.set_position(done as u64));
    bar.finish_and_clear();
    Ok(Explored {
        info: setup.info,
        fates: fates.map_err(|error| Failure::Computation(error.to_string()))?,
        duration,
    })
}

/// The law as the inputs of a simulation. Inputs that it does not set stay as on the motion.
fn closed<'a>(
    model: &dyn Model,
    design: &'a Design,
    law: &'a Law,
    duration: f64,
) -> Box<dyn InputSource + 'a> {
    let (inputs, states) = (design.equations.inputs.clone(), design.outputs.clone());
    let offset: Vec<f64> = inputs.iter().map(|&input| design.u[input]).collect();
    let desired = |t: f64, y: &mut [f64]| {
        for (y, &state) in y.iter_mut().zip(&design.outputs) {
            *y = design.x[state] + t * design.running(state);
        }
    };
    let declared = model.info().declared_inputs;
    let others = (0..declared).filter(|input| !design.equations.inputs.contains(input));
    let others: Vec<usize> = others.collect();
    let own: Box<dyn InputSource + 'a> = match law.sampling {
        None => Box::new(Feedback {
            inputs,
            states,
            gain: law.gain.clone(),
            offset,
            desired,
            switching_times: Vec::new(),
        }),
        Some(sampling) => Box::new(SampledFeedback {
            inputs,
            states,
            gain: law.gain.clone(),
            offset,
            desired,
            sampler: Sampler::new(sampling, duration),
        }),
    };
    if others.is_empty() {
        return own;
    }
    let times = own.switching_times();
    Box::new(appell_runtime::inputs::SwitchedInputs {
        function: move |t: f64, x: &[f64], u: &mut [f64]| {
            own.inputs(t, x, u);
            for &input in &others {
                u[input] = design.u[input];
            }
        },
        switching_times: times,
    })
}

/// The axes, as states about the motion.
fn axes(setup: &Setup<'_>, design: &Design, asked: &str) -> Result<Vec<Axis>, Failure> {
    let mut axes: Vec<Axis> = Vec::new();
    for part in asked.split(',') {
        let (state, values) = ask::disturbances(setup, part)?;
        if axes.iter().any(|axis| axis.state == state) {
            let name = &setup.info.states[state].name;
            return Err(Failure::Usage(format!(
                "--attraction: `{name}` is given twice"
            )));
        }
        let values = values.into_iter().map(|value| design.x[state] + value);
        axes.push(Axis {
            state,
            values: values.collect(),
        });
    }
    if axes.len() > 2 {
        let text = "--attraction: disturb one state or two".to_owned();
        return Err(Failure::Usage(text));
    }
    Ok(axes)
}

impl Explored<'_> {
    fn quantity(&self, axis: &Axis) -> &Quantity {
        &self.info.states[axis.state]
    }

    fn count(&self, wanted: impl Fn(&Fate) -> bool) -> usize {
        self.fates.fates.iter().filter(|fate| wanted(fate)).count()
    }

    /// For people.
    pub(crate) fn text(&self) -> String {
        let mut text = format!(
            "region of attraction: of {} disturbed motions {} settle within {} s, {} do not, {} are lost\n",
            self.fates.fates.len(),
            self.count(|fate| *fate == Fate::Settled),
            self.duration,
            self.count(|fate| *fate == Fate::Unsettled),
            self.count(|fate| matches!(fate, Fate::Lost { .. })),
        );
        let safe = self.fates.safe_part();
        let reach = self.fates.axes.iter().zip(&self.fates.centre);
        let reach = reach.map(|(axis, centre)| {
            let quantity = self.quantity(axis);
            let away = axis.values.iter().map(|value| (value - centre).abs());
            let largest = quantity.to_unit(safe * away.fold(0.0, f64::max));
            format!("{} by {} {}", quantity.name, number(largest), quantity.unit)
        });
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "  all settle that are disturbed by no more than: {}",
            reach.collect::<Vec<_>>().join(", ")
        );
        text
    }

    /// In SI.
    pub(crate) fn json(&self) -> Value {
        let axes = self.fates.axes.iter().zip(&self.fates.centre);
        let axes = axes.map(|(axis, centre)| {
            json!({
                "state": self.quantity(axis).name,
                "steady": centre,
                "values": axis.values,
            })
        });
        let fate = |fate: &Fate| match fate {
            Fate::Settled => json!("settled"),
            Fate::Unsettled => json!("unsettled"),
            Fate::Lost { time } => json!({ "lost_s": time }),
        };
        json!({
            "axes": axes.collect::<Vec<_>>(),
            "duration_s": self.duration,
            "safe_part": self.fates.safe_part(),
            "fates": self.fates.fates.iter().map(fate).collect::<Vec<_>>(),
        })
    }

    /// A map over two states.
    pub(crate) fn map(&self) -> Result<Map, Failure> {
        let [x, y] = &self.fates.axes[..] else {
            let text = "`--plot` draws disturbances of two states: name two in `--attraction`";
            return Err(Failure::Usage(text.to_owned()));
        };
        let kind = |i: usize, j: usize| match self.fates.fates[i * y.values.len() + j] {
            Fate::Settled => 1,
            Fate::Lost { .. } => 2,
            Fate::Unsettled => 3,
        };
        let places = (0..y.values.len()).flat_map(|j| (0..x.values.len()).map(move |i| (i, j)));
        let cells: Vec<Option<usize>> = places.map(|(i, j)| Some(kind(i, j))).collect();
        let ends = |axis: &Axis| {
            let quantity = self.quantity(axis);
            let end = |value: Option<&f64>| quantity.to_unit(value.copied().unwrap_or(f64::NAN));
            [end(axis.values.first()), end(axis.values.last())]
        };
        let label = |axis: &Axis| {
            let quantity = self.quantity(axis);
            format!("{} at the start [{}]", quantity.name, quantity.unit)
        };
        Ok(Map {
            title: format!("{}: region of attraction", self.info.title),
            labels: [label(x), label(y)],
            ranges: [ends(x), ends(y)],
            counts: [x.values.len(), y.values.len()],
            kinds: ["", "settles", "lost", "not settled in time"]
                .map(str::to_owned)
                .to_vec(),
            cells,
            curves: Vec::new(),
        })
    }
}
