//! Tornado diagram of the sensitivities of a number: one bar a factor, the longest on top.

use super::area::{Axis, SAMPLE, centred, entry, number, numbers};
use super::{FOOTER_HEIGHT, RIGHT, STYLE, WIDTH};
use crate::svg::{Document, Element, path, text};

/// A bar of a tornado.
#[derive(Debug, Clone, PartialEq)]
pub struct Lever {
    /// Name of the factor.
    pub name: String,
    /// The number where the factor is low, and where it is high.
    pub ends: [f64; 2],
}

/// Bars about a centre.
#[derive(Debug, Clone, PartialEq)]
pub struct Tornado {
    /// Name and unit of the number.
    pub label: String,
    /// Names of the two ends.
    pub legend: [String; 2],
    /// The common base of all bars.
    pub centre: f64,
    /// The bars, in any order.
    pub levers: Vec<Lever>,
}

/// Width for names.
const NAMES: f64 = 150.0;
const HEAD: f64 = 26.0;
const ROW: f64 = 26.0;
const BAR: f64 = 16.0;
/// Largest number of bars.
const MOST: usize = 15;
const TORNADO_STYLE: &str = include_str!("tornado.css");

impl Tornado {
    /// The figure as an SVG document.
    pub fn to_svg(&self) -> String {
        let mut levers: Vec<&Lever> = self.levers.iter().collect();
        let size = |lever: &Lever| (lever.ends[1] - lever.ends[0]).abs();
        levers.retain(|lever| size(lever).is_finite());
        levers.sort_by(|a, b| size(b).total_cmp(&size(a)));
        levers.truncate(MOST);
        let ends = levers.iter().flat_map(|lever| lever.ends);
        let axis = Axis::padded(ends.chain([self.centre]));
        let (width, bottom) = (WIDTH - NAMES - RIGHT, HEAD + ROW * levers.len() as f64);
        let place = |value: f64| NAMES + width * axis.part(value);
        let mut svg = Document::new([WIDTH, bottom + FOOTER_HEIGHT], &[STYLE, TORNADO_STYLE]);
        let upright = |x: f64| format!("M{x:.1} {HEAD:.1}V{bottom:.1}");
        let ticks = axis.ticks(8).into_iter();
        let grid: String = ticks.map(|tick| upright(place(tick))).collect();
        numbers(&mut svg, &axis, [NAMES, width], bottom);
        svg.put(&path("grid", &grid).empty());
        svg.put(&centred([NAMES + width / 2.0, bottom + 35.0], &self.label));
        let classes = ["low", "high"];
        for (side, (class, name)) in classes.iter().zip(&self.legend).enumerate() {
            let x = NAMES + 190.0 * side as f64;
            let sample = [("x", x), ("y", 6.0), ("width", 18.0), ("height", 9.0)];
            let sample = Element::new("rect").with("class", class).lengths(sample);
            entry(&mut svg, &sample.empty(), [x + SAMPLE, 15.0], name);
        }
        for (row, lever) in levers.iter().enumerate() {
            let y = HEAD + ROW * row as f64 + 0.5 * (ROW - BAR);
            let name = text([NAMES - 8.0, y + BAR - 4.0]).with("text-anchor", "end");
            svg.put(&name.text(&lever.name));
            for (class, end) in classes.iter().zip(lever.ends) {
                let (a, b) = (place(self.centre), place(end));
                let lengths = [
                    ("x", a.min(b)),
                    ("y", y),
                    ("width", (b - a).abs()),
                    ("height", BAR),
                ];
                let bar = Element::new("rect").with("class", class).lengths(lengths);
                svg.put(&bar.titled(&number(end, axis.step(8) / 100.0)));
            }
        }
        svg.put(&path("frame", &upright(place(self.centre))).empty());
        svg.finish()
    }
}
