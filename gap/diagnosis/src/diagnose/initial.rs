//! Initial values of a search from sizes to first order.

use appell_estimate::{Estimation, Unknown};

use super::DiagnoseError;
use super::bench::{Bench, wrong};
use crate::effects::{Acts, Part};

/// Largest initial delay relative to the longest one.
const BELOW: f64 = 0.9;

/// The best sizes of a candidate.
#[derive(Debug, Clone)]
pub(super) struct SizeEstimates {
    /// Index of the candidate.
    pub(super) candidate: usize,
    /// One for each of its directions.
    pub(super) values: Vec<f64>,
    /// Their standard deviations.
    pub(super) deviations: Vec<f64>,
}

impl SizeEstimates {
    /// A part of them.
    pub(super) fn times(&self, part: f64) -> Self {
        Self {
            values: self.values.iter().map(|value| part * value).collect(),
            ..self.clone()
        }
    }
}

/// Writes the best sizes as initial values, none of them at a bound.
pub(super) fn place(
    bench: &Bench<'_>,
    estimation: &Estimation<'_>,
    sizes: &SizeEstimates,
    values: &mut [f64],
) -> Result<(), DiagnoseError> {
    let layout = estimation.layout();
    let setup = estimation.setup();
    let candidate = bench.candidate(sizes.candidate);
    let first = sizes.values.first().copied().unwrap_or(0.0);
    let at = |list: &[usize], input| list.iter().position(|own| *own == input).unwrap_or(0);
    let now = match candidate.acts {
        Acts::Parameter(index) => values[index],
        _ => 0.0,
    };
    let mut set = |unknown, value: f64| -> Result<(), DiagnoseError> {
        values[layout.place(unknown)?] = value;
        Ok(())
    };
    match candidate.acts {
        Acts::Items => {
            let mut direction = 0;
            for (index, part) in bench.own(candidate) {
                let unknown = Unknown::Parameter(index);
                let quantity = &bench.effects.info().parameters[index];
                match part {
                    Part::Switch => set(unknown, 1.0)?,
                    Part::Shape(_) => {
                        set(unknown, quantity.value)?;
                        continue;
                    }
                    Part::Size | Part::Term(_) => {
                        let size = sizes.values[direction];
                        let least = sizes.deviations[direction];
                        let size = if size.abs() > 0.0 { size } else { least };
                        set(unknown, size)?;
                    }
                }
                direction += 1;
            }
        }
        Acts::Parameter(index) => {
            let most = wrong(bench.set.parameters[index].value);
            let [low, high] = bench.effects.info().parameters[index].range;
            let moved = now + first.clamp(-most, most);
            set(Unknown::Parameter(index), moved.clamp(low, high))?;
        }
        Acts::Bias(channel) => set(Unknown::Bias(channel), first)?,
        Acts::Scale(channel) => set(Unknown::Scale(channel), 1.0 + first)?,
        Acts::Late(channel) => {
            let longest = setup.channels[channel].longest_delay.unwrap_or(0.0);
            set(Unknown::SensorDelay(channel), first.clamp(0.0, longest))?;
        }
        Acts::Lag(_) | Acts::Slow(_) => {
            if let Some(free) = bench.of_signal(candidate.acts, setup) {
                let [shortest, longest] = free.range;
                set(free.unknown, first.clamp(2.0 * shortest, 0.2 * longest))?;
            }
        }
        Acts::Delay(input) => {
            let unknown = Unknown::InputDelay(at(&setup.delayed, input));
            set(unknown, first.clamp(0.0, BELOW * bench.longest_delay()))?;
        }
    }
    Ok(())
}
