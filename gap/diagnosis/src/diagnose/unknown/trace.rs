//! A coordinate along a run.

use appell_recordings::Run;

/// A coordinate in a run.
pub(super) struct Trace {
    pub(super) times: Vec<f64>,
    pub(super) values: Vec<f64>,
}

impl Trace {
    pub(super) fn of(run: &Run, column: usize) -> Self {
        Self {
            times: run.times.clone(),
            values: filled(run.values[column].clone()),
        }
    }

    pub(super) fn duration(&self) -> f64 {
        self.times[self.times.len() - 1] - self.times[0]
    }

    pub(super) fn step(&self) -> f64 {
        self.duration() / (self.times.len() - 1) as f64
    }

    /// Deviation of each sample from the line through its neighbours, normalised to the noise of one sample.
    pub(super) fn off_the_line(&self) -> impl Iterator<Item = f64> {
        self.times
            .windows(3)
            .zip(self.values.windows(3))
            .map(|(t, v)| {
                let part = (t[1] - t[0]) / (t[2] - t[0]);
                let line = v[0] + part * (v[2] - v[0]);
                (v[1] - line).abs() / (1.0 + part * part + (1.0 - part) * (1.0 - part)).sqrt()
            })
    }

    pub(super) fn longest_row(&self) -> f64 {
        let pairs = self.values.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        pairs.fold(0.0, f64::max)
    }
}

/// A range of positive numbers.
pub(super) struct Span(pub(super) f64, pub(super) f64);

impl Span {
    /// A geometric sequence of numbers in it; none if it is empty.
    pub(super) fn places(&self, count: usize) -> Vec<f64> {
        let &Self(low, high) = self;
        if !(low > 0.0 && high > low) {
            return Vec::new();
        }
        let part = |place: usize| place as f64 / (count - 1) as f64;
        (0..count)
            .map(|i| low * (high / low).powf(part(i)))
            .collect()
    }
}

/// Replaces missing values by the previous ones.
fn filled(mut values: Vec<f64>) -> Vec<f64> {
    let first = values.iter().copied().find(|value| !value.is_nan());
    let mut last = first.unwrap_or(0.0);
    for value in &mut values {
        if value.is_nan() {
            *value = last;
        }
        last = *value;
    }
    values
}
