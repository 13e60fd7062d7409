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

#[derive(Clone, Copy)]
enum Kind {
    Lag,
    InputDelay,
    Bias,
    Scale,
    SensorDelay,
}

/// Additions to inputs.
const OF_INPUTS: [(&str, Kind); 2] = [("lag", Kind::Lag), ("delay", Kind::InputDelay)];
/// Additions to channels.
const OF_CHANNELS: [(&str, Kind); 3] = [
    ("bias", Kind::Bias),
    ("scale", Kind::Scale),
    ("delay", Kind::SensorDelay),
];

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
    let all = [(inputs, &OF_INPUTS[..]), (columns.as_slice(), &OF_CHANNELS)];
    let find = |name: &String| {
        let (owner, what) = name.rsplit_once('.')?;
        let owner = set.in_spec(owner);
        let (kind, index) = all.iter().find_map(|(owners, kinds)| {
            let index = owners.iter().position(|own| *own == owner)?;
            let (_, kind) = kinds.iter().find(|(own, _)| *own == what)?;
            Some((*kind, index))
        })?;
        let unit = match kind {
            Kind::Lag | Kind::InputDelay | Kind::SensorDelay => ("s".to_owned(), 1.0),
            Kind::Scale => ("1".to_owned(), 1.0),
            Kind::Bias => {
                let unit = &measured[index].0.unit;
                (unit.text.clone(), unit.scale)
            }
        };
        Some(Addition {
            name: name.clone(),
            kind,
            index,
            unit,
        })
    };
    let known = all.iter().flat_map(|(owners, kinds)| {
        let names = |owner| kinds.iter().map(move |(what, _)| format!("{owner}.{what}"));
        owners.iter().flat_map(names)
    });
    let found = |name| {
        find(name).ok_or_else(|| IdentifyError::UnknownAddition {
            name: name.clone(),
            known: known.clone().collect(),
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
        // A lag shorter than the steps has no effect and makes the equations stiff.
        let steps = runs.iter().map(|run| run.sampling.step);
        let step = steps.fold(0.0, f64::max).min(setup.longest_step);
        let index = self.index;
        let (unknown, value, range) = match self.kind {
            Kind::Lag => {
                let lag = Unknown::Lag(place(&setup.lagging).unwrap_or(0));
                (lag, step, [step, LONGEST_LAG])
            }
            Kind::InputDelay => {
                let delay = Unknown::InputDelay(place(&setup.delayed).unwrap_or(0));
                (delay, 0.0, [0.0, LONGEST_DELAY])
            }
            Kind::SensorDelay => (Unknown::SensorDelay(index), 0.0, [0.0, LONGEST_DELAY]),
            Kind::Bias => (
                Unknown::Bias(index),
                0.0,
                [f64::NEG_INFINITY, f64::INFINITY],
            ),
            Kind::Scale => (
                Unknown::Scale(index),
                1.0,
                [f64::MIN_POSITIVE, f64::INFINITY],
            ),
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
