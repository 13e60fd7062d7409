//! Points over two quantities, coloured by a third one.

use super::area::{Area, entry};
use super::axis::Axis;
use super::{FOOTER_HEIGHT, HEADER_HEIGHT, LEFT, STYLE, WIDTH};
use crate::svg::{Document, path, text};

/// Points in classes.
#[derive(Debug, Clone, PartialEq)]
pub struct Scatter {
    /// Name and unit of the horizontal and of the vertical axis.
    pub labels: [String; 2],
    /// Meaning of the colours.
    pub about: String,
    /// Names of the classes, at most five, from low to high; an empty class is drawn too.
    pub classes: Vec<String>,
    /// Positions and classes of the points; a point of a class that does not exist is omitted.
    pub points: Vec<([f64; 2], usize)>,
}

const HEIGHT: f64 = 320.0;
const HEAD: f64 = 44.0;
const SCATTER_STYLE: &str = include_str!("scatter.css");

impl Scatter {
    /// The figure as an SVG document.
    pub fn to_svg(&self) -> String {
        let values = |axis: usize| self.points.iter().map(move |(point, _)| point[axis]);
        let area = Area {
            top: HEAD + HEADER_HEIGHT,
            height: HEIGHT,
            x_axis: Axis::padded(values(0)),
            y_axis: Axis::padded(values(1)),
        };
        let height = area.bottom() + FOOTER_HEIGHT;
        let mut svg = Document::new([WIDTH, height], &[STYLE, SCATTER_STYLE]);
        svg.put(&text([LEFT, 16.0]).text(&self.about));
        svg.put(&text([LEFT, area.top - 9.0]).text(&self.labels[1]));
        area.grid(&mut svg);
        let last = self.classes.len().saturating_sub(1).max(1);
        let mut right = LEFT;
        for (class, name) in self.classes.iter().enumerate() {
            // The ends of the scale, whatever lies between.
            let style = format!("point k{}", (4 * class + last / 2) / last);
            let own = self.points.iter().filter(|(_, own)| *own == class);
            let dots = area.dots(own.map(|(point, _)| *point));
            svg.put(&path(&style, &dots).empty());
            let sample = format!("M{:.1} {:.1}h0", right + 5.0, HEAD - 10.0);
            let place = [right + 13.0, HEAD - 6.0];
            right = entry(&mut svg, &path(&style, &sample).empty(), place, name);
        }
        area.name_x(&mut svg, &self.labels[0]);
        svg.finish()
    }
}
