//! Further estimated quantities: lags and delays of inputs, biases, scales and delays of channels.
//! `tau.delay` is the delay of the input tau.

use appell_estimate::{Estimation, Free, Setup, Unknown};
use appell_runtime::model::Quantity;

use super::IdentifyError;
use appell_recordings::{Channel, DataSet, Run};

/// Largest delay in s.
const LONGEST_DELAY: f64 = 0.25;
/// Largest time constant in s.
const LONGEST_LAG: f64 = 10.0;

/// Additions to inputs.
const OF_INPUTS: [&str; 2] = ["lag", "delay"];
/// Additions to channels.
const OF_CHANNELS: [&str; 3] = ["bias", "scale", "delay"];

#[derive(Clone, Copy)]
enum Kind {
    Lag,
    InputDelay,
    Bias,
    Scale,
    SensorDelay,
}

/// One of them.
pub(crate) struct Addition {
    name: String,
    kind: Kind,
    /// Index of the input or channel.
    index: usize,
    /// Unit of a channel.
    unit: (String, f64),
}

/// Finds the inputs and channels of names such as `tau.lag`.
pub(super) fn named(
    names: &[String],
    set: &DataSet,
    setup: &Setup<'_>,
) -> Result<Vec<Addition>, IdentifyError> {
    let info = setup.model.info();
    let inputs: Vec<&str> = info.inputs.iter().map(|input| &*input.name).collect();
    let inputs = &inputs[..info.declared_inputs];
    let measured = set.measured(info);
    let columns: Vec<&str> = measured.iter().map(|(c, _)| c.column.as_str()).collect();
    let find = |name: &String| {
        let (owner, what) = name.rsplit_once('.')?;
        let owner = set.in_spec(owner);
        let place = |list: &[&str]| list.iter().position(|own| *own == owner);
        let (kind, index) = match (what, place(inputs), place(&columns)) {
            ("lag", Some(input), _) => (Kind::Lag, input),
            ("delay", Some(input), _) => (Kind::InputDelay, input),
            ("bias", _, Some(channel)) => (Kind::Bias, channel),
            ("scale", _, Some(channel)) => (Kind::Scale, channel),
            ("delay", _, Some(channel)) => (Kind::SensorDelay, channel),
            _ => return None,
        };
        let unit = match kind {
            Kind::Lag | Kind::InputDelay | Kind::SensorDelay => ("s".to_owned(), 1.0),
            Kind::Scale => ("1".to_owned(), 1.0),
            Kind::Bias => {
                let unit = &measured[index].0.unit;
                (unit.text.clone(), unit.scale)
            }
        };
        let name = name.clone();
        Some(Addition {
            name,
            kind,
            index,
            unit,
        })
    };
    let known = || {
        let of = |owners: &[&str], what: &[&str]| -> Vec<String> {
            let pairs = owners
                .iter()
                .flat_map(|owner| what.iter().map(move |what| (owner, what)));
            pairs
                .map(|(owner, what)| format!("{owner}.{what}"))
                .collect()
        };
        [of(inputs, &OF_INPUTS), of(&columns, &OF_CHANNELS)].concat()
    };
    let found = |name| {
        find(name).ok_or_else(|| IdentifyError::UnknownAddition {
            name: name.clone(),
            known: known(),
        })
    };
    names.iter().map(found).collect()
}

impl Addition {
    /// The scale of a channel.
    pub(super) fn scale(channel: &Channel, index: usize) -> Self {
        Self {
            name: format!("{}.scale", channel.column),
            kind: Kind::Scale,
            index,
            unit: ("1".to_owned(), 1.0),
        }
    }

    /// Adds it to a setup.
    pub(super) fn prepare(&self, setup: &mut Setup<'_>) {
        let add = |list: &mut Vec<usize>| {
            if !list.contains(&self.index) {
                list.push(self.index);
            }
        };
        match self.kind {
            Kind::Lag => add(&mut setup.lagging),
            Kind::InputDelay => add(&mut setup.delayed),
            Kind::SensorDelay => setup.channels[self.index].longest_delay = Some(LONGEST_DELAY),
            Kind::Bias | Kind::Scale => {}
        }
    }

    /// The free value, with its name, unit and value without the addition.
    pub(super) fn free(&self, estimation: &Estimation<'_>, runs: &[Run]) -> (Free, Quantity) {
        let setup = estimation.setup();
        let place = |list: &[usize]| list.iter().position(|own| *own == self.index);
        let unknown = match self.kind {
            Kind::Lag => Unknown::Lag(place(&setup.lagging).unwrap_or(0)),
            Kind::InputDelay => Unknown::InputDelay(place(&setup.delayed).unwrap_or(0)),
            Kind::Bias => Unknown::Bias(self.index),
            Kind::Scale => Unknown::Scale(self.index),
            Kind::SensorDelay => Unknown::SensorDelay(self.index),
        };
        // A lag shorter than the steps has no effect and makes the equations stiff.
        let steps = runs.iter().map(|run| run.sampling.step);
        let step = steps.fold(0.0, f64::max).min(setup.longest_step);
        let (value, range) = match self.kind {
            Kind::Lag => (step, [step, LONGEST_LAG]),
            Kind::InputDelay | Kind::SensorDelay => (0.0, [0.0, LONGEST_DELAY]),
            Kind::Bias => (0.0, [f64::NEG_INFINITY, f64::INFINITY]),
            Kind::Scale => (1.0, [f64::MIN_POSITIVE, f64::INFINITY]),
        };
        let (unit, scale) = self.unit.clone();
        let quantity = Quantity {
            name: self.name.clone().into(),
            about: "".into(),
            unit: unit.into(),
            scale,
            value,
            range,
        };
        (Free::of(unknown).within(range[0], range[1]), quantity)
    }
}
