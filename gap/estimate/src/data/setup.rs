//! Measured quantities, disturbances, delayed inputs.

use appell_runtime::model::Model;

use crate::{EstimateError, Recording};

/// Quantity measured by a channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measured {
    /// A pseudo-velocity or coordinate, by its index in the state.
    State(usize),
    /// An output of the spec, by its index.
    Output(usize),
}

/// A column of measurements: y = scale · quantity + bias + white noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Channel {
    /// The quantity.
    pub measures: Measured,
    /// Largest delay of the sensor in s, if the delay is estimated. Rows within this time from the
    /// start are not used, so that the data do not depend on the delay.
    pub longest_delay: Option<f64>,
    /// Whether the sensor is a first-order low-pass filter: one additional state, its reading.
    pub lags: bool,
}

impl Channel {
    /// A channel without a delay or lag.
    pub fn of(measures: Measured) -> Self {
        Self {
            measures,
            longest_delay: None,
            lags: false,
        }
    }
}

/// White process noise. Its level is the square root of its two-sided spectral density: the
/// standard deviation of its integral over one second.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Disturbance {
    /// A generalised force added to Π in the equation of a pseudo-velocity, by its index. The level
    /// is in the unit of the force times √s.
    Force(usize),
    /// Added to the rate of a state, by its index in the state or, from its end on, in the lists of
    /// lagging inputs, of lagging channels and of drifting parameters. The level is in the unit of the
    /// state per √s.
    Rate(usize),
}

/// A model with its measurements and disturbances.
#[derive(Clone)]
pub struct Setup<'a> {
    /// Equations of motion.
    pub model: &'a dyn Model,
    /// Columns of the measurements.
    pub channels: Vec<Channel>,
    /// Process noise.
    pub disturbances: Vec<Disturbance>,
    /// Declared inputs with a first-order lag: one additional state each.
    pub lagging: Vec<usize>,
    /// Declared inputs with a constant delay.
    pub delayed: Vec<usize>,
    /// Drifting parameters, by their indices: one additional state each, driven only by a
    /// [`Disturbance::Rate`]. The value in the list of parameters is not used.
    pub drifting: Vec<usize>,
    /// Largest integration step in s; longer intervals between samples are divided.
    pub longest_step: f64,
    /// Whether steps are halved at kinks of the equations, such as those of regularised dry
    /// friction. Smooth motions have none; likelihoods of chaotic ones are smoother without.
    pub has_corners: bool,
    /// Memory in bytes up to which a gradient keeps the parts of such steps; beyond, its reverse sweep takes them
    /// again. The result is the same.
    pub most_memory: usize,
}

impl<'a> Setup<'a> {
    /// Channels without delays or lags, a force on every pseudo-velocity, inputs without lags or delays,
    /// steps from sample to sample.
    pub fn new(model: &'a dyn Model, measured: &[Measured]) -> Self {
        Self {
            model,
            channels: measured
                .iter()
                .map(|&measures| Channel::of(measures))
                .collect(),
            disturbances: (0..model.info().speeds).map(Disturbance::Force).collect(),
            lagging: Vec::new(),
            delayed: Vec::new(),
            drifting: Vec::new(),
            longest_step: f64::INFINITY,
            has_corners: false,
            most_memory: 1 << 30,
        }
    }

    /// Number of states, including those of lags and drifting parameters.
    pub(crate) fn state_len(&self) -> usize {
        self.model.info().state_len() + self.lag_len() + self.drifting.len()
    }

    /// Number of lags, of inputs and then of channels.
    pub(crate) fn lag_len(&self) -> usize {
        self.lagging.len() + self.lagging_channels().count()
    }

    /// Channels that lag.
    pub(crate) fn lagging_channels(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.channels.len()).filter(|&channel| self.channels[channel].lags)
    }

    /// The lag of a channel, as [`Unknown::Lag`](crate::Unknown::Lag) counts them: inputs first, then
    /// the lagging channels in their order. None for a channel that does not lag.
    pub fn lag_of_channel(&self, channel: usize) -> Option<usize> {
        let place = self
            .lagging_channels()
            .position(|lagging| lagging == channel);
        place.map(|place| self.lagging.len() + place)
    }

    /// The quantity that a channel reads: the state of its filter if the channel lags.
    pub(crate) fn reads(&self, channel: usize) -> Measured {
        let lag = self.lag_of_channel(channel);
        lag.map_or(self.channels[channel].measures, |lag| {
            Measured::State(self.model.info().state_len() + lag)
        })
    }

    /// Number of outputs to evaluate for the channels: all, or none if no channel reads any.
    pub(crate) fn output_len(&self) -> usize {
        let mut channels = 0..self.channels.len();
        let reads_any = channels.any(|channel| matches!(self.reads(channel), Measured::Output(_)));
        usize::from(reads_any) * self.model.info().output_len()
    }

    /// The channels with a value among those of a row: one delayed channel, or all others.
    pub(crate) fn sampled(&self, measured: &[f64], only: Option<usize>) -> Vec<usize> {
        let is_sampled = |channel: &usize| {
            let late = self.channels[*channel].longest_delay.is_some();
            only.map_or(!late, |only| only == *channel) && !measured[*channel].is_nan()
        };
        (0..self.channels.len()).filter(is_sampled).collect()
    }

    pub(crate) fn check(&self, recordings: &[Recording]) -> Result<(), EstimateError> {
        let info = self.model.info();
        let nothing = |what| Err(EstimateError::Nothing { what });
        if recordings.is_empty() {
            return nothing("recordings");
        }
        if self.channels.is_empty() {
            return nothing("channels");
        }
        if info.states.is_empty() {
            return nothing("states");
        }
        for channel in &self.channels {
            match channel.measures {
                Measured::State(index) => below("state", index, info.state_len())?,
                Measured::Output(index) => below("output", index, info.output_len())?,
            }
            if let Some(delay) = channel.longest_delay {
                positive("longest delay of a channel in s", delay)?;
            }
        }
        for disturbance in &self.disturbances {
            match *disturbance {
                Disturbance::Force(index) => below("pseudo-velocity", index, info.speeds)?,
                Disturbance::Rate(index) => below("state", index, self.state_len())?,
            }
        }
        for (what, list, len) in [
            ("input", &self.lagging, info.declared_inputs),
            ("input", &self.delayed, info.declared_inputs),
            ("parameter", &self.drifting, info.parameter_len()),
        ] {
            for (place, &index) in list.iter().enumerate() {
                below(what, index, len)?;
                if list[..place].contains(&index) {
                    return Err(EstimateError::Twice { what, index });
                }
            }
        }
        positive("longest step in s", self.longest_step)?;
        let delays = !self.delayed.is_empty()
            || self
                .channels
                .iter()
                .any(|channel| channel.longest_delay.is_some());
        if delays && (info.explicit_time || !info.signals.is_empty()) {
            return Err(EstimateError::DelayWithTime);
        }
        for recording in recordings {
            let expected = [
                ("inputs", recording.input_len(), info.declared_inputs),
                ("measurements", recording.channel_len(), self.channels.len()),
            ];
            for (what, found, columns) in expected {
                if found != columns {
                    let rows = recording.times().len();
                    return Err(EstimateError::Lengths {
                        what,
                        rows,
                        columns,
                        found: rows * found,
                    });
                }
            }
        }
        Ok(())
    }
}

fn below(what: &'static str, index: usize, len: usize) -> Result<(), EstimateError> {
    let error = EstimateError::Unknown { what, index, len };
    (index < len).then_some(()).ok_or(error)
}

fn positive(what: &str, value: f64) -> Result<(), EstimateError> {
    let error = EstimateError::Value {
        what: what.to_owned(),
        value,
        demand: "positive",
    };
    (value > 0.0).then_some(()).ok_or(error)
}
