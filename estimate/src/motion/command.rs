//! The declared inputs between rows: held, or along straight lines.
//!
//! On tapes an input is three numbers: its value at a time, its slope, that time.

use crate::data::layout::Layout;
use crate::data::recording::Recording;
use crate::data::setup::Setup;

/// Numbers of an input.
pub(crate) const NUMBERS: usize = 3;

/// The value of an input at a time.
pub(crate) fn value(commands: &[f64], input: usize, t: f64) -> f64 {
    let [value, slope, since] = numbers(commands, input);
    value + slope * (t - since)
}

/// Its slope.
pub(crate) fn slope(commands: &[f64], input: usize) -> f64 {
    numbers(commands, input)[1]
}

/// The time from which its line counts.
pub(crate) fn since(commands: &[f64], input: usize) -> f64 {
    numbers(commands, input)[2]
}

fn numbers(commands: &[f64], input: usize) -> [f64; NUMBERS] {
    let own = &commands[input * NUMBERS..(input + 1) * NUMBERS];
    [own[0], own[1], own[2]]
}

/// All inputs before the first row: constant.
pub(crate) fn at_start(recording: &Recording) -> Vec<f64> {
    let start = recording.times()[0];
    let inputs = recording.inputs(0).iter();
    inputs.flat_map(|&value| [value, 0.0, start]).collect()
}

/// The value of all inputs times the gradient with respect to it, for a change of time.
pub(crate) fn by_time(commands: &[f64], by_inputs: &[f64]) -> f64 {
    let inputs = by_inputs.iter().enumerate();
    inputs.map(|(input, by)| by * slope(commands, input)).sum()
}

/// A change of one delayed input, or of all others, at a row.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Switch {
    pub(crate) row: usize,
    pub(crate) input: Option<usize>,
    /// Whether it is the first of the run: then delayed inputs have their first value.
    pub(crate) first: bool,
}

impl Switch {
    pub(crate) fn apply(
        self,
        commands: &mut [f64],
        (setup, layout, values): (&Setup<'_>, Layout, &[f64]),
        recording: &Recording,
    ) {
        let t = recording.times()[self.row];
        for (input, own) in commands.chunks_exact_mut(NUMBERS).enumerate() {
            let delay = setup.delayed.iter().position(|&delayed| delayed == input);
            let value = recording.inputs(self.row)[input];
            if self.input.map_or(delay.is_none(), |only| only == input) {
                let late = delay.map_or(0.0, |index| values[layout.input_delay(index)]);
                own.copy_from_slice(&[value, recording.slope(self.row, input), t + late]);
            } else if self.first && self.input.is_none() {
                own.copy_from_slice(&[value, 0.0, t]);
            }
        }
    }
}
