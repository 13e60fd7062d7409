//! The declared inputs between rows: held, or along lines or cubics.
//!
//! On tapes an input is the time from which it counts, and the coefficients of the powers of the time since then.

use crate::data::layout::Layout;
use crate::data::recording::{Late, Recording, Row};
use crate::data::setup::Setup;

/// Numbers of an input.
pub(crate) const NUMBERS: usize = 5;

/// The value of an input at a time.
pub(crate) fn value(commands: &[f64], input: usize, t: f64) -> f64 {
    let [since, c0, c1, c2, c3] = numbers(commands, input);
    let t = t - since;
    c0 + t * (c1 + t * (c2 + t * c3))
}

/// Its slope at a time.
pub(crate) fn slope(commands: &[f64], input: usize, t: f64) -> f64 {
    let [since, _, c1, c2, c3] = numbers(commands, input);
    let t = t - since;
    c1 + t * (2.0 * c2 + t * 3.0 * c3)
}

/// The time from which it counts.
pub(crate) fn since(commands: &[f64], input: usize) -> f64 {
    numbers(commands, input)[0]
}

fn numbers(commands: &[f64], input: usize) -> [f64; NUMBERS] {
    let own = &commands[input * NUMBERS..(input + 1) * NUMBERS];
    [own[0], own[1], own[2], own[3], own[4]]
}

/// All inputs before the first row: constant.
pub(crate) fn at_start(recording: &Recording) -> Vec<f64> {
    let start = recording.times()[0];
    let inputs = recording.inputs(0).iter();
    inputs
        .flat_map(|&value| [start, value, 0.0, 0.0, 0.0])
        .collect()
}

/// The gradient with respect to time by that with respect to all inputs.
pub(crate) fn by_time(commands: &[f64], by_inputs: &[f64], t: f64) -> f64 {
    let inputs = by_inputs.iter().enumerate();
    inputs
        .map(|(input, by)| by * slope(commands, input, t))
        .sum()
}

/// A change of one delayed input, or of all others, at a row.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Switch {
    pub(crate) row: Row,
    pub(crate) input: Option<usize>,
    /// Whether it is the first of the run: then delayed inputs have their first value.
    pub(crate) first: bool,
}

impl Switch {
    pub(crate) fn apply(
        self,
        commands: &mut [f64],
        setup: &Setup<'_>,
        layout: Layout,
        values: &[f64],
        recording: &Recording,
    ) {
        let t = recording.time_of(self.row);
        for (input, own) in commands.chunks_exact_mut(NUMBERS).enumerate() {
            let delay = setup.delayed.iter().position(|&delayed| delayed == input);
            if self.input.map_or(delay.is_none(), |only| only == input) {
                let late = delay.map_or(0.0, |index| values[layout.input_delay(index)]);
                own[0] = t + late;
                own[1..].copy_from_slice(&recording.command(self.row, input));
            } else if self.first && self.input.is_none() {
                let late = delay.map_or(0.0, |index| values[layout.input_delay(index)]);
                let value = recording.input_before(input, t - late);
                own.copy_from_slice(&[t, value, 0.0, 0.0, 0.0]);
            }
        }
    }
}

/// What outputs that are read at a row react to.
pub(crate) struct OfOutputs {
    /// The inputs: those of the motion, or as [`Recording::of_output`].
    pub(crate) held: Vec<f64>,
    /// Each input that lags, with the derivative by its time constant, where it is not that of the motion; none where it
    /// is.
    pub(crate) lags: Vec<[f64; 2]>,
    averaging: Option<Averaging>,
}

/// The time over which the outputs of a row are means.
struct Averaging {
    /// Its length in s.
    duration: f64,
    /// Changes of the inputs in it, as [`Recording::kinks_of_output`].
    kinks: Vec<f64>,
}

impl OfOutputs {
    pub(crate) fn of(
        recording: &Recording,
        row: usize,
        held: &[f64],
        setup: &Setup<'_>,
        layout: Layout,
        values: &[f64],
    ) -> Self {
        let t = recording.times()[row];
        let late = |input: usize| {
            let delay = place(&setup.delayed, input);
            let lag = place(&setup.lagging, input);
            Late {
                delay: delay.map_or(0.0, |index| values[layout.input_delay(index)]),
                lag: lag.map_or(0.0, |index| values[layout.lag(index)]),
            }
        };
        let mut commands = held.to_vec();
        for (input, own) in commands.chunks_exact_mut(NUMBERS).enumerate() {
            if let Some([value, slope]) = recording.of_output(input, t, late(input).delay) {
                own.copy_from_slice(&[t, value, slope, 0.0, 0.0]);
            }
        }
        let lags = setup.lagging.iter();
        let lags = lags.map(|&input| recording.of_lagged_output(input, t, late(input)));
        let averaging = recording.duration_of_output(t).map(|duration| {
            let inputs = 0..recording.input_len();
            let kinks = inputs.map(|input| recording.kinks_of_output(input, t, late(input)));
            Averaging {
                duration,
                kinks: kinks.collect(),
            }
        });
        Self {
            held: commands,
            lags: lags.collect::<Option<_>>().unwrap_or_default(),
            averaging,
        }
    }

    /// The duration of outputs that are means, and the kinks of their inputs.
    pub(crate) fn averaging(&self) -> Option<(f64, &[f64])> {
        let averaging = self.averaging.as_ref()?;
        Some((averaging.duration, &averaging.kinks))
    }
}

fn place(inputs: &[usize], input: usize) -> Option<usize> {
    inputs.iter().position(|own| *own == input)
}
