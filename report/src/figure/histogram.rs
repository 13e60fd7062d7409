//! Histograms.

use super::axis::Axis;
use super::{Area, FOOTER_HEIGHT, HEADER_HEIGHT, LEFT, RIGHT, STYLE, WIDTH};
use crate::svg::{Document, path, text};
use std::fmt::Write as _;

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
    /// Marked numbers with their names.
    pub marks: Vec<(f64, String)>,
}

const HEIGHT: f64 = 150.0;
const BAR_STYLE: &str = "\
.bar{fill:#0072b2;fill-opacity:.55;stroke:none}
@media(prefers-color-scheme:dark){.bar{fill:#56b4e9}}
";

impl Histogram {
    /// The figure as an SVG document.
    pub fn to_svg(&self) -> String {
        let x_axis = Axis::tight(self.ends.into_iter());
        let heights = self.bars.iter().map(|&count| count as f64);
        let y_axis = Axis::tight(heights.clone().chain([0.0]));
        let area = Area {
            top: HEADER_HEIGHT,
            width: WIDTH - LEFT - RIGHT,
            height: HEIGHT,
        };
        let mut svg = Document::new(
            [WIDTH, area.top + HEIGHT + FOOTER_HEIGHT],
            &[STYLE, BAR_STYLE],
        );
        svg.put(&text([LEFT, 16.0]).text(&self.counted));
        area.grid(&mut svg, &x_axis, &y_axis);
        let mut bars = String::new();
        let wide = area.width / self.bars.len().max(1) as f64;
        for (place, height) in heights.enumerate() {
            let high = area.height * y_axis.part(height);
            let x = LEFT + wide * place as f64;
            // Writing to a string cannot fail.
            let _ = write!(
                bars,
                "M{x:.1} {:.1}v{:.1}h{:.1}v{high:.1}z",
                area.top + area.height,
                -high,
                wide - 1.0
            );
        }
        svg.put(&path("bar", &bars).empty());
        for (value, name) in &self.marks {
            let part = x_axis.part(*value);
            if !(0.0..=1.0).contains(&part) {
                continue;
            }
            let x = LEFT + area.width * part;
            let line = format!("M{x:.1} {:.1}v{HEIGHT:.1}", area.top);
            svg.put(&path("frame dashed", &line).titled(name));
            svg.put(
                &text([x, area.top - 5.0])
                    .with("text-anchor", "middle")
                    .text(name),
            );
        }
        area.name_x(&mut svg, &x_axis, &self.label);
        svg.finish()
    }
}
