//! Interpolation of inputs between rows (hold, linear, cubic); detection of held inputs that appear to be samples of a
//! continuous signal.

use appell_estimate::{EstimateError, Recording};
use appell_spec::mechanism::Interpolation;

use crate::channel::{Channel, Role};
use crate::{DataSet, Finding, FindingKind, Part, Run};

/// Least number of rows of an input.
const FEWEST: usize = 32;
/// Largest fraction of rows that may repeat the previous one; of a command that is held for several rows most do.
const REPEATED: f64 = 0.05;
/// Part of the differences that jumps may make, and how many times the mean of the other squares theirs are at least.
const JUMPS: f64 = 0.15;
const FAR: f64 = 16.0;
/// Mean square of second differences over that of first ones: (ω h)² for a frequency ω, 2 for steps at random, 3 for
/// noise. Below this a period has ten rows and more.
const SMOOTH: f64 = 0.4;
/// Errors of linear interpolation above this are reported, relative to the size of the input.
const BENT: f64 = 1e-3;

impl Channel {
    /// Whether it is an input that is interpolated between rows, not held.
    pub fn is_joined(&self) -> bool {
        !matches!(self.interpolation, None | Some(Interpolation::Hold))
    }

    /// Interpolation between rows, for inputs.
    pub fn between_rows(&self) -> appell_runtime::model::Interpolation {
        use appell_runtime::model::Interpolation as Runs;
        match self.interpolation {
            None | Some(Interpolation::Hold) => Runs::Hold,
            Some(Interpolation::Linear) => Runs::Linear,
            Some(Interpolation::Cubic) => Runs::Cubic,
        }
    }
}

impl DataSet {
    /// Adds a finding for every smooth input that is held without a stated interpolation, or that is interpolated
    /// linearly in spite of its curvature.
    pub(crate) fn tell_smooth_inputs(&mut self) {
        let runs: Vec<&Run> = self.runs.iter().filter(|r| r.part == Part::Fit).collect();
        for (index, channel) in self.channels.iter().enumerate() {
            let stated = channel.interpolation;
            if !matches!(channel.role, Role::Input(_))
                || !matches!(stated, None | Some(Interpolation::Linear))
            {
                continue;
            }
            let values = runs.iter().map(|run| &*run.values[index]);
            let Some(off) = Smooth::of(values) else {
                continue;
            };
            let message = if stated.is_none() {
                let step = runs.iter().map(|run| run.sampling.step).fold(0.0, f64::max);
                format!(
                    "it changes smoothly from row to row, and is held from each to the next. If it was sampled from a \
                     continuous signal, it acts half a row ({:.3} ms) late, {:.2} % of its size off, and parameters \
                     with it: write interpolation = \"linear\" or \"cubic\" in its line; write interpolation = \
                     \"hold\" if it was held",
                    500.0 * step,
                    100.0 * off.held
                )
            } else if off.by_lines > BENT {
                format!(
                    "it bends between its rows: the lines that join them are {:.2} % of its size off, and parameters \
                     with it. If it is a smooth signal, write interpolation = \"cubic\" in its line",
                    100.0 * off.by_lines
                )
            } else {
                continue;
            };
            let finding = Finding::new(FindingKind::SmoothInput, message);
            self.findings.push(finding.of_channel(&channel.column));
        }
    }

    /// The same recordings with every input held at its mean between rows.
    pub(crate) fn held_at_means(mut self) -> Result<Self, EstimateError> {
        for (index, channel) in self.channels.iter_mut().enumerate() {
            if channel.is_joined() {
                let between = [channel.between_rows()];
                channel.interpolation = Some(Interpolation::Hold);
                for run in &mut self.runs {
                    let values = std::mem::take(&mut run.values[index]);
                    let recording = Recording::new(run.times.clone(), values, Vec::new())?;
                    let recording = recording.interpolated(&between)?;
                    let rows = 0..run.times.len();
                    run.values[index] = rows.map(|row| recording.mean_inputs(row)[0]).collect();
                }
            }
        }
        Ok(self)
    }
}

/// Errors of an input that changes smoothly, relative to its size.
#[derive(Debug, Clone, Copy)]
pub struct Smooth {
    /// If it is held: it then acts half a row late.
    pub held: f64,
    /// If it is interpolated linearly.
    pub by_lines: f64,
}

impl Smooth {
    /// `None` if it does not change smoothly.
    pub fn of<'v>(runs: impl Iterator<Item = &'v [f64]>) -> Option<Self> {
        let (mut rows, mut repeated) = (0_usize, 0_usize);
        let (mut first, mut second) = (Vec::new(), Vec::new());
        let (mut sum, mut squares) = (0.0, 0.0);
        for values in runs {
            rows += values.len();
            for pair in values.windows(2) {
                first.push((pair[1] - pair[0]).powi(2));
                repeated += usize::from(pair[1].to_bits() == pair[0].to_bits());
            }
            for three in values.windows(3) {
                second.push((three[2] - 2.0 * three[1] + three[0]).powi(2));
            }
            sum += values.iter().sum::<f64>();
            squares += values.iter().map(|value| value * value).sum::<f64>();
        }
        let count = rows as f64;
        let (first, second) = (without_jumps(first), without_jumps(second));
        let is_smooth = rows >= FEWEST
            && (repeated as f64) < REPEATED * count
            && second < SMOOTH * first
            && first > 0.0;
        let spread = (squares / count - (sum / count).powi(2)).max(f64::MIN_POSITIVE);
        is_smooth.then(|| Self {
            held: 0.5 * (first / spread).sqrt(),
            // The mean of c s (h − s)/2 over a row, where c is the curvature.
            by_lines: (second / spread).sqrt() / 12.0,
        })
    }
}

/// The mean of squared differences without the largest ones, which are jumps of a signal that is smooth elsewhere; zero
/// without any.
fn without_jumps(mut squares: Vec<f64>) -> f64 {
    squares.sort_by(f64::total_cmp);
    let mean = |of: &[f64]| of.iter().sum::<f64>() / (of.len() as f64).max(1.0);
    // A part of a number of rows.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let jumps = (JUMPS * squares.len() as f64) as usize;
    let usual = mean(&squares[..squares.len() - jumps]);
    mean(&squares[..squares.partition_point(|square| *square <= FAR * usual)])
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a missing value fails the test")]
mod tests {
    use super::Smooth;

    #[test]
    fn a_sampled_sine_is_smooth_and_commands_are_not() {
        let rows = || (0..400).map(f64::from);
        let sine: Vec<f64> = rows().map(|row| (0.1 * row).sin()).collect();
        let off = Smooth::of([sine.as_slice()].into_iter()).unwrap();
        assert!((off.held - 0.05).abs() < 1e-3, "{off:?}");
        assert!((off.by_lines - 0.01 / 12.0).abs() < 1e-5, "{off:?}");
        // Its jumps do not hide that it is smooth between them.
        let jumping: Vec<f64> = rows()
            .map(|row| (0.1 * row).sin() + 0.5 * (0.14 * row).sin().signum())
            .collect();
        assert!(Smooth::of([jumping.as_slice()].into_iter()).is_some());
        let steps: Vec<f64> = rows().map(|row| (row / 10.0).floor().sin()).collect();
        // Steps at random, a new one in each row.
        let noise: Vec<f64> = rows().map(|row| (row * row).sin()).collect();
        for command in [steps, noise, vec![1.0; 400]] {
            assert!(Smooth::of([command.as_slice()].into_iter()).is_none());
        }
    }
}
