//! Histograms.

use super::area::{Area, INNER, centred};
use super::axis::Axis;
use super::{FOOTER_HEIGHT, HEADER_HEIGHT, LEFT, Mark, STYLE, WIDTH};
use crate::svg::{Document, path, text};

/// Bars of equal width.
#[derive(Debug, Clone, PartialEq)]
pub struct Histogram {
    /// Name and unit of the numbers.
    pub label: String,
    /// Name of the counted items.
    pub counted: String,
    /// Ends of the first and of the last bar.
    pub ends: [f64; 2],
    /// Heights of the bars.
    pub bars: Vec<u64>,
    /// Marked numbers.
    pub marks: Vec<Mark>,
}

const HEIGHT: f64 = 150.0;
const BAR_STYLE: &str = include_str!("histogram.css");

impl Histogram {
    /// The figure as an SVG document.
    pub fn to_svg(&self) -> String {
        let heights = self.bars.iter().map(|&count| count as f64);
        let area = Area {
            top: HEADER_HEIGHT,
            height: HEIGHT,
            x_axis: Axis::tight(self.ends.into_iter()),
            y_axis: Axis::tight(heights.clone().chain([0.0])),
        };
        let bottom = area.bottom();
        let mut svg = Document::new([WIDTH, bottom + FOOTER_HEIGHT], &[STYLE, BAR_STYLE]);
        svg.put(&text([LEFT, 16.0]).text(&self.counted));
        area.grid(&mut svg);
        let wide = INNER / self.bars.len().max(1) as f64;
        let bar = |(place, height): (usize, f64)| {
            let high = area.height * area.y_axis.part(height);
            let x = LEFT + wide * place as f64;
            let width = wide - 1.0;
            format!("M{x:.1} {bottom:.1}v{:.1}h{width:.1}v{high:.1}z", -high)
        };
        let bars: String = heights.enumerate().map(bar).collect();
        svg.put(&path("bar", &bars).empty());
        for mark in &self.marks {
            if let Some(x) = area.mark(&mut svg, mark) {
                svg.put(&centred([x, area.top - 5.0], &mark.about));
            }
        }
        area.name_x(&mut svg, &self.label);
        svg.finish()
    }
}
