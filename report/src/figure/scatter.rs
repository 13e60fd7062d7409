//! Points over two quantities, coloured by a third one.

use std::fmt::Write as _;

use super::axis::Axis;
use super::{Area, CHARACTER, FOOTER_HEIGHT, HEADER_HEIGHT, LEFT, RIGHT, STYLE, WIDTH};
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
const SCATTER_STYLE: &str = "\
.point{fill:none;stroke-width:4;stroke-linecap:round;stroke-opacity:.75}
.k0{stroke:#2166ac}.k1{stroke:#67a9cf}.k2{stroke:#a3a3a3}.k3{stroke:#ef8a62}.k4{stroke:#b2182b}
@media(prefers-color-scheme:dark){.k0{stroke:#4f8fe0}.k1{stroke:#92c5de}.k2{stroke:#c9c9c9}.k3{stroke:#f4a582}.k4{stroke:#ef5a4a}}
";

impl Scatter {
    /// The figure as an SVG document.
    pub fn to_svg(&self) -> String {
        let values = |axis: usize| self.points.iter().map(move |(point, _)| point[axis]);
        let (x_axis, y_axis) = (Axis::padded(values(0)), Axis::padded(values(1)));
        let area = Area {
            top: HEAD + HEADER_HEIGHT,
            width: WIDTH - LEFT - RIGHT,
            height: HEIGHT,
        };
        let height = area.top + HEIGHT + FOOTER_HEIGHT;
        let mut svg = Document::new([WIDTH, height], &[STYLE, SCATTER_STYLE]);
        svg.put(&text([LEFT, 16.0]).text(&self.about));
        svg.put(&text([LEFT, area.top - 9.0]).text(&self.labels[1]));
        area.grid(&mut svg, &x_axis, &y_axis);
        let last = self.classes.len().saturating_sub(1).max(1);
        let mut right = LEFT;
        for (class, name) in self.classes.iter().enumerate() {
            // The ends of the scale, whatever lies between.
            let colour = (4 * class + last / 2) / last;
            let mut places = String::new();
            for ([x, y], _) in self.points.iter().filter(|(_, own)| *own == class) {
                if x.is_finite() && y.is_finite() {
                    let x = LEFT + area.width * x_axis.part(*x);
                    let y = area.top + area.height * (1.0 - y_axis.part(*y));
                    // Writing to a string cannot fail.
                    let _ = write!(places, "M{x:.1} {y:.1}h0");
                }
            }
            let style = format!("point k{colour}");
            svg.put(&path(&style, &places).empty());
            svg.put(&path(&style, &format!("M{:.1} {:.1}h0", right + 5.0, HEAD - 10.0)).empty());
            svg.put(&text([right + 13.0, HEAD - 6.0]).text(name));
            right += 13.0 + CHARACTER * name.chars().count() as f64 + 16.0;
        }
        area.name_x(&mut svg, &x_axis, &self.labels[0]);
        svg.finish()
    }
}
