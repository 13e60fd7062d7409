//! The frame of a panel with its axes: positions of points, ranges and round numbers.

use std::fmt::Write as _;

use super::{CHARACTER, LEFT, Mark, PANEL_HEIGHT, RIGHT, Series, WIDTH};
use crate::svg::{Document, Element, path, text};

/// Width of the frames.
pub(super) const INNER: f64 = WIDTH - LEFT - RIGHT;
/// Approximate number of ticks of a horizontal axis.
const TICKS: u32 = 8;
/// Distance of a name in a legend from the left end of its sample, and of the next sample from the name.
pub(super) const SAMPLE: f64 = 23.0;
const APART: f64 = 16.0;

/// A frame with its axes.
pub(super) struct Area {
    pub(super) top: f64,
    pub(super) height: f64,
    pub(super) x_axis: Axis,
    pub(super) y_axis: Axis,
}

impl Area {
    pub(super) fn bottom(&self) -> f64 {
        self.top + self.height
    }

    pub(super) fn right(&self, x: f64) -> f64 {
        LEFT + INNER * self.x_axis.part(x)
    }

    pub(super) fn place(&self, x: f64, y: f64) -> [f64; 2] {
        let down = self.top + self.height * (1.0 - self.y_axis.part(y));
        [self.right(x), down]
    }

    /// Numbers and the label below.
    pub(super) fn name_x(&self, svg: &mut Document, label: &str) {
        scale(svg, &self.x_axis, self.bottom(), label);
    }

    /// Frame, grid and the numbers of the vertical axis.
    pub(super) fn grid(&self, svg: &mut Document) {
        let mut grid = String::new();
        for tick in self.x_axis.ticks(TICKS) {
            // Writing to a string cannot fail.
            let _ = write!(grid, "{}", self.upright(self.right(tick)));
        }
        let count = if self.height > PANEL_HEIGHT { 8 } else { 5 };
        for tick in self.y_axis.ticks(count) {
            let [_, y] = self.place(0.0, tick);
            let _ = write!(grid, "M{LEFT:.1} {y:.1}h{INNER:.1}");
            let tick_label = text([LEFT - 7.0, y + 4.0]).with("text-anchor", "end");
            svg.put(&tick_label.text(&number(tick, self.y_axis.step(count))));
        }
        svg.put(&path("grid", &grid).empty());
        let frame = Element::new("rect").with("class", "frame").with("x", LEFT);
        let lengths = [("y", self.top), ("width", INNER), ("height", self.height)];
        svg.put(&frame.lengths(lengths).empty());
    }

    /// A vertical line through the frame.
    fn upright(&self, x: f64) -> String {
        format!("M{x:.1} {:.1}v{:.1}", self.top, self.height)
    }

    /// A marked value of the horizontal axis; its position, if it lies in the frame.
    pub(super) fn mark(&self, svg: &mut Document, mark: &Mark) -> Option<f64> {
        let is_inside = (0.0..=1.0).contains(&self.x_axis.part(mark.x));
        let x = is_inside.then(|| self.right(mark.x))?;
        svg.put(&path("frame dashed", &self.upright(x)).titled(&mark.about));
        Some(x)
    }

    /// A dot at each finite point.
    pub(super) fn dots(&self, points: impl Iterator<Item = [f64; 2]>) -> String {
        let finite = points.filter(|point| point.iter().all(|value| value.is_finite()));
        let dot = |[x, y]: [f64; 2]| {
            let [x, y] = self.place(x, y);
            format!("M{x:.1} {y:.1}h0")
        };
        finite.map(dot).collect()
    }

    /// The path of the line without invisible points: a point is drawn if it or its successor is
    /// more than a third of a pixel from the last one drawn.
    pub(super) fn line(&self, series: &Series) -> String {
        const VISIBLE: f64 = 1.0 / 3.0;
        let far = |a: [f64; 2], b: [f64; 2]| {
            (a[0] - b[0]).abs() > VISIBLE || (a[1] - b[1]).abs() > VISIBLE
        };
        let mut path = String::new();
        let mut drawn: Option<[f64; 2]> = None;
        let mut skipped: Option<[f64; 2]> = None;
        let mut draw = |command: char, point: Option<[f64; 2]>| {
            if let Some([x, y]) = point {
                let _ = write!(path, "{command}{x:.1} {y:.1}");
            }
        };
        for (&x, &y) in series.x.iter().zip(&series.y) {
            let point = (x.is_finite() && y.is_finite()).then(|| self.place(x, y));
            match (point, drawn) {
                (Some(here), Some(last)) if !far(here, last) => {
                    skipped = point;
                    continue;
                }
                (Some(_), None) => draw('M', point),
                _ => {
                    draw('L', skipped.take());
                    draw('L', point);
                }
            }
            drawn = point;
        }
        draw('L', skipped);
        path
    }
}

/// Numbers of a horizontal axis, from its left end over its width.
pub(super) fn numbers(svg: &mut Document, axis: &Axis, [left, width]: [f64; 2], bottom: f64) {
    for tick in axis.ticks(TICKS) {
        let x = left + width * axis.part(tick);
        svg.put(&centred(
            [x, bottom + 16.0],
            &number(tick, axis.step(TICKS)),
        ));
    }
}

/// Numbers and the name of the horizontal axis of the frames.
pub(super) fn scale(svg: &mut Document, axis: &Axis, bottom: f64, name: &str) {
    numbers(svg, axis, [LEFT, INNER], bottom);
    svg.put(&centred([LEFT + INNER / 2.0, bottom + 35.0], name));
}

/// A text centred at a point.
pub(super) fn centred(place: [f64; 2], content: &str) -> String {
    text(place).with("text-anchor", "middle").text(content)
}

/// A sample in the legend with its name at a point; the position of the next sample.
pub(super) fn entry(svg: &mut Document, sample: &str, [x, y]: [f64; 2], name: &str) -> f64 {
    svg.put(sample);
    svg.put(&text([x, y]).text(name));
    x + CHARACTER * name.chars().count() as f64 + APART
}

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
