//! Region of attraction: simulations of a law from a grid of disturbances.

use std::fmt::Write as _;

use appell_analysis::control::attraction::{Axis, Fate, Fates, Region};
use appell_analysis::control::feedback::Feedback;
use appell_analysis::control::sampler::{SampledFeedback, Sampler};
use appell_report::figure::Map;
use appell_report::text::number;
use appell_runtime::Trajectory;
use appell_runtime::inputs::InputSource;
use appell_runtime::model::{Model, ModelInfo, Quantity};
use serde_json::{Value, json};

use super::design::{Design, DesignedGains};
use super::parse;
use crate::setup::{Setup, listed};
use crate::{Error, Field};

/// Settling tolerance, relative to the largest deviation.
const SETTLED: f64 = 0.05;
/// Absolute settling tolerance, in SI.
const STILL: f64 = 1e-6;
/// Maximum number of motions.
const MOST: usize = 100_000;

/// The disturbed motions and their fates.
pub struct Explored<'a> {
    info: &'a ModelInfo,
    fates: Fates,
    duration: f64,
}

impl crate::Model {
    /// Which motions settle under a law, from a grid of disturbances of one or two states such as
    /// `theta=-20deg..20deg/8,r=-10cm..10cm/8`, each simulated for `duration` seconds; `progress` is called
    /// with the number of completed motions and their total.
    pub fn attraction(
        &self,
        design: &Design,
        grid: &str,
        duration: f64,
        progress: &(dyn Fn(usize, usize) + Sync),
    ) -> Result<Explored<'_>, Error> {
        if !(duration.is_finite() && duration > 0.0) {
            let message = format!("{duration} is not a positive number of seconds");
            return Err(Error::request(Field::Duration, message));
        }
        let Some(law) = &design.law else {
            let message = "a region of attraction needs a law; give poles or weights";
            return Err(Error::request(Field::Attraction, message));
        };
        let (model, setup) = (self.equations(), self.setup()?);
        let axes = axes(&setup, design, grid)?;
        let count: usize = axes.iter().map(|axis| axis.values.len()).product();
        if count > MOST {
            let message = format!("{count} motions are too many; at most {MOST} are possible");
            return Err(Error::request(Field::Attraction, message));
        }
        let settled = |motion: &Trajectory| {
            design.outputs.iter().all(|&state| {
                let column = motion
                    .column(&setup.info.states[state].name)
                    .unwrap_or_default();
                has_settled(motion.times(), &column, |t| design.desired(state, t))
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
        let fates = region.explore(&|done| progress(done, count));
        Ok(Explored {
            info: setup.info,
            fates: fates.map_err(Error::computation)?,
            duration,
        })
    }
}

/// Whether a state ends near its desired value, compared with its largest deviation.
fn has_settled(times: &[f64], values: &[f64], desired: impl Fn(f64) -> f64) -> bool {
    let away = times.iter().zip(values);
    let away = away.map(|(&t, x)| (x - desired(t)).abs());
    let largest = away.clone().fold(0.0, f64::max);
    let last = away.last();
    last.is_some_and(|last| last <= STILL.max(SETTLED * largest))
}

/// The law as the inputs of a simulation. Other inputs keep their values on the steady motion.
fn closed<'a>(
    model: &dyn Model,
    design: &'a Design,
    law: &'a DesignedGains,
    duration: f64,
) -> Box<dyn InputSource + 'a> {
    let (inputs, states) = (design.equations.inputs.clone(), design.outputs.clone());
    let offset: Vec<f64> = inputs.iter().map(|&input| design.u[input]).collect();
    let desired = |t: f64, y: &mut [f64]| {
        for (y, &state) in y.iter_mut().zip(&design.outputs) {
            *y = design.desired(state, t);
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

/// The axes of the grid: states about the steady motion.
fn axes(setup: &Setup<'_>, design: &Design, asked: &str) -> Result<Vec<Axis>, Error> {
    let mut axes: Vec<Axis> = Vec::new();
    for part in listed(asked) {
        let (state, values) = parse::disturbances(setup, part)?;
        if axes.iter().any(|axis| axis.state == state) {
            let name = &setup.info.states[state].name;
            let message = format!("`{name}` is given twice");
            return Err(Error::request(Field::Attraction, message));
        }
        let values = values.into_iter().map(|value| design.x[state] + value);
        axes.push(Axis {
            state,
            values: values.collect(),
        });
    }
    if axes.len() > 2 {
        let message = "disturb one state or two";
        return Err(Error::request(Field::Attraction, message));
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

    /// The summary as text.
    pub fn text(&self) -> String {
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
        // The grid need not surround the motion: only the simulated range is claimed.
        let reach = reach.map(|(axis, centre)| {
            let quantity = self.quantity(axis);
            let away = || axis.values.iter().map(|value| value - centre);
            let largest = safe * away().map(f64::abs).fold(0.0, f64::max);
            let inside = || away().filter(|away| away.abs() <= largest * (1.0 + 1e-9));
            let [low, high] = [
                inside().fold(f64::INFINITY, f64::min),
                inside().fold(f64::NEG_INFINITY, f64::max),
            ]
            .map(|end| number(quantity.to_unit(end)));
            format!("{} by {low} to {high} {}", quantity.name, quantity.unit)
        });
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "  all motions settle that were disturbed: {}",
            reach.collect::<Vec<_>>().join(", ")
        );
        text
    }

    /// The results as JSON, in SI.
    pub fn to_json(&self) -> Value {
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

    /// The map over two states.
    pub fn map(&self) -> Result<Map, Error> {
        let [x, y] = &self.fates.axes[..] else {
            let message = "the map needs disturbances of two states";
            return Err(Error::request(Field::Plot, message));
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_output_settles_on_its_motion_or_its_value() {
        let times = [0.0, 1.0, 2.0, 3.0];
        let advancing = |t: f64| 2.0 + 5.0 * t;
        assert!(has_settled(&times, &[2.5, 7.2, 12.1, 17.001], advancing));
        assert!(!has_settled(&times, &[2.5, 2.0, 2.0, 2.0], advancing));
        let constant = |_: f64| 1.0;
        assert!(has_settled(&times, &[2.0, 1.5, 1.1, 1.01], constant));
        assert!(!has_settled(&times, &[2.0, 1.5, 1.1, 1.1], constant));
    }
}
