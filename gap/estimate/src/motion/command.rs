//! The declared inputs between rows: held, or along lines or cubics.
//!
//! On tapes an input is the time from which it counts, and the coefficients of the powers of the time since then.

use crate::data::layout::Layout;
use crate::data::recording::{Recording, Row};
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

/// The inputs of outputs that are read at a row: those of the motion, or as [`Recording::of_output`].
pub(crate) fn of_reading(
    recording: &Recording,
    row: usize,
    held: &[f64],
    setup: &Setup<'_>,
    layout: Layout,
    values: &[f64],
) -> Vec<f64> {
    let mut commands = held.to_vec();
    let t = recording.times()[row];
    for (input, own) in commands.chunks_exact_mut(NUMBERS).enumerate() {
        let late = delay(input, setup, layout, values);
        if let Some([value, slope]) = recording.of_output(input, t, late) {
            own.copy_from_slice(&[t, value, slope, 0.0, 0.0]);
        }
    }
    commands
}

/// The time over which the outputs of a row are means.
pub(crate) struct Averaging {
    /// Its length in s.
    pub(crate) duration: f64,
    /// Changes of the inputs in it, as [`Recording::kinks_of_output`]; those that act by a lag make no kink.
    pub(crate) kinks: Vec<f64>,
}

impl Averaging {
    /// That of a row; `None` if outputs are readings.
    pub(crate) fn of(
        recording: &Recording,
        row: usize,
        setup: &Setup<'_>,
        layout: Layout,
        values: &[f64],
    ) -> Option<Self> {
        let t = recording.times()[row];
        let duration = recording.duration_of_output(t)?;
        let of_input = |input: usize| {
            if setup.lagging.contains(&input) {
                return 0.0;
            }
            recording.kinks_of_output(input, t, delay(input, setup, layout, values))
        };
        let kinks = (0..recording.input_len()).map(of_input).collect();
        Some(Self { duration, kinks })
    }
}

/// The delay of an input.
fn delay(input: usize, setup: &Setup<'_>, layout: Layout, values: &[f64]) -> f64 {
    let mut delayed = setup.delayed.iter();
    let place = delayed.position(|&delayed| delayed == input);
    place.map_or(0.0, |index| values[layout.input_delay(index)])
}
