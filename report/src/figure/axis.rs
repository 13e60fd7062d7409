//! Ranges and round numbers.

/// The numbers an axis covers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Axis {
    low: f64,
    high: f64,
}

/// Fraction of the range left free above and below a line.
const PADDING: f64 = 0.06;

/// Relative variation below which a line is drawn as constant.
const CONSTANT: f64 = 1e-9;

impl Axis {
    /// From the smallest to the largest finite value.
    pub(super) fn tight(values: impl Iterator<Item = f64>) -> Self {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values.filter(|value| value.is_finite()) {
            (low, high) = (low.min(value), high.max(value));
        }
        if low > high {
            (low, high) = (0.0, 1.0);
        }
        let size = low.abs().max(high.abs());
        let mut axis = Self { low, high };
        if high - low <= CONSTANT * size || size == 0.0 {
            axis.widen_by(if size == 0.0 { 1.0 } else { 0.1 * size });
        }
        axis
    }

    /// A little more than [`Axis::tight`].
    pub(super) fn padded(values: impl Iterator<Item = f64>) -> Self {
        let mut axis = Self::tight(values);
        axis.widen_by(PADDING * axis.span());
        axis
    }

    /// Extends both ends.
    fn widen_by(&mut self, room: f64) {
        (self.low, self.high) = (self.low - room, self.high + room);
    }

    pub(super) fn span(&self) -> f64 {
        self.high - self.low
    }

    /// Extends both ends equally, so that the span becomes `span`.
    pub(super) fn widen_to(&mut self, span: f64) {
        self.widen_by((span - self.span()) / 2.0);
    }

    /// Position of a value between the ends, 0 to 1.
    pub(super) fn part(&self, value: f64) -> f64 {
        (value - self.low) / self.span()
    }

    /// A distance of 1, 2 or 5 times a power of ten that gives at most `count` ticks or so.
    pub(super) fn step(&self, count: u32) -> f64 {
        let rough = self.span() / f64::from(count);
        let power = 10f64.powf(rough.log10().floor());
        let factor = [1.0, 2.0, 5.0, 10.0]
            .into_iter()
            .find(|factor| factor * power >= rough);
        factor.unwrap_or(10.0) * power
    }

    /// Multiples of the step within the ends.
    pub(super) fn ticks(&self, count: u32) -> Vec<f64> {
        let step = self.step(count);
        let first = (self.low / step - 1e-9).ceil();
        // Rounding may hide a tick at the very end, but never adds more than a few.
        (0..=count + 1)
            .map(|i| (first + f64::from(i)) * step)
            .take_while(|tick| *tick <= self.high + 1e-9 * step)
            .collect()
    }
}

/// A multiple of `step` with the decimals that the step needs.
pub(super) fn number(value: f64, step: f64) -> String {
    let size = value.abs().max(step);
    if size >= 1e5 || step < 1e-4 {
        return short_exponent(value, step);
    }
    let decimals = (0..=4).find(|decimals| {
        let scaled = step * 10f64.powi(*decimals);
        (scaled - scaled.round()).abs() < 1e-6
    });
    let decimals = usize::try_from(decimals.unwrap_or(4)).unwrap_or(4);
    let text = format!("{value:.decimals$}");
    // No negative zero, and a typographic minus.
    let is_zero = text.chars().all(|c| matches!(c, '-' | '0' | '.'));
    text.replace('-', if is_zero { "" } else { "−" })
}

/// The digits that distinguish neighbouring ticks, with an exponent.
fn short_exponent(value: f64, step: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let order = |x: f64| x.abs().log10().floor();
    let needed = order(value) - order(step);
    let precision = (0..=8usize)
        .find(|precision| *precision as f64 >= needed)
        .unwrap_or(8);
    format!("{value:.precision$e}").replace('-', "−")
}
