//! One quantity over another: points, lines and bands, as SVG.

use std::fmt::Write as _;

use super::axis::Axis;
use super::{Area, CHARACTER, FOOTER_HEIGHT, HEADER_HEIGHT, LEFT, RIGHT, STYLE, Series, WIDTH};
use crate::svg::{Document, path, text};

/// Layers over a common pair of axes, drawn in their order.
#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    /// Name and unit of the horizontal and of the vertical axis.
    pub labels: [String; 2],
    /// Height of the frame.
    pub height: f64,
    /// The layers.
    pub layers: Vec<Layer>,
}

/// A part of a plot; one without a label is not in the legend.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// Name and values.
    pub series: Series,
    /// Their style.
    pub look: Look,
    /// Number of its colour, 0 to 5.
    pub colour: usize,
}

/// Style of a layer.
#[derive(Debug, Clone, PartialEq)]
pub enum Look {
    /// A line.
    Line,
    /// A small disc at each point.
    Points,
    /// The band between the series and these values.
    Band(Vec<f64>),
    /// The same, as the core of another band.
    Core(Vec<f64>),
}

/// Added to the style of the figures.
const PLOT_STYLE: &str = "\
.band{stroke:none;fill-opacity:.25}.dots{stroke-width:3.2;stroke-linecap:round;stroke-opacity:.55;fill:none}
.core{stroke:none;fill-opacity:.45}
.f0{fill:#0072b2}.f1{fill:#d55e00}.f2{fill:#009e73}.f3{fill:#cc79a7}.f4{fill:#e69f00}.f5{fill:#56b4e9}
@media(prefers-color-scheme:dark){.f0{fill:#56b4e9}.f1{fill:#e69f00}.f4{fill:#f0e442}.f5{fill:#d55e00}}
";
/// Room for the name of the vertical axis.
const HEAD: f64 = 22.0;

impl Plot {
    /// The plot as an SVG document.
    pub fn to_svg(&self) -> String {
        let x_axis = Axis::tight(self.layers.iter().flat_map(|l| &l.series.x).copied());
        let y_axis = Axis::padded(self.layers.iter().flat_map(Layer::heights));
        let area = Area {
            top: HEAD + HEADER_HEIGHT,
            width: WIDTH - LEFT - RIGHT,
            height: self.height,
        };
        let bottom = area.top + area.height;
        let height = bottom + FOOTER_HEIGHT;
        let mut svg = Document::new([WIDTH, height], &[STYLE, PLOT_STYLE]);
        svg.put(&text([LEFT, 16.0]).text(&self.labels[1]));
        area.grid(&mut svg, &x_axis, &y_axis);
        let mut right = LEFT;
        for layer in &self.layers {
            let path = layer.path(&area, &x_axis, &y_axis);
            svg.put(&layer.element(&path));
            if !layer.series.label.is_empty() {
                let y = area.top - 9.0;
                svg.put(&layer.element(&layer.sample([right, y - 4.0])));
                svg.put(&text([right + 23.0, y]).text(&layer.series.label));
                right += 23.0 + CHARACTER * layer.series.label.chars().count() as f64 + 16.0;
            }
        }
        area.name_x(&mut svg, &x_axis, &self.labels[0]);
        svg.finish()
    }
}

impl Layer {
    fn heights(&self) -> impl Iterator<Item = f64> {
        let other: &[f64] = match &self.look {
            Look::Band(other) | Look::Core(other) => other,
            Look::Line | Look::Points => &[],
        };
        self.series.y.iter().chain(other).copied()
    }

    fn element(&self, line: &str) -> String {
        let colour = self.colour;
        let class = match self.look {
            Look::Line => format!("line c{colour}"),
            Look::Points => format!("dots c{colour}"),
            Look::Band(_) => format!("band f{colour}"),
            Look::Core(_) => format!("core f{colour}"),
        };
        path(&class, line).empty()
    }

    fn sample(&self, [x, y]: [f64; 2]) -> String {
        match self.look {
            Look::Line => format!("M{x:.1} {y:.1}h18"),
            Look::Points => format!("M{:.1} {y:.1}h0", x + 9.0),
            Look::Band(_) | Look::Core(_) => format!("M{x:.1} {:.1}h18v9h-18z", y - 4.5),
        }
    }

    fn path(&self, area: &Area, x_axis: &Axis, y_axis: &Axis) -> String {
        match &self.look {
            Look::Line => area.line(&self.series, x_axis, y_axis),
            Look::Points => {
                let place = |x: f64, y: f64| {
                    let right = LEFT + area.width * x_axis.part(x);
                    [right, area.top + area.height * (1.0 - y_axis.part(y))]
                };
                let mut path = String::new();
                let points = self.series.x.iter().zip(&self.series.y);
                for (x, y) in points.filter(|(x, y)| x.is_finite() && y.is_finite()) {
                    let [x, y] = place(*x, *y);
                    // Writing to a string cannot fail.
                    let _ = write!(path, "M{x:.1} {y:.1}h0");
                }
                path
            }
            Look::Band(other) | Look::Core(other) => {
                let there = area.line(&self.series, x_axis, y_axis);
                let back = Series {
                    label: String::new(),
                    x: self.series.x.iter().rev().copied().collect(),
                    y: other.iter().rev().copied().collect(),
                };
                let back = area.line(&back, x_axis, y_axis);
                format!("{there}{}z", back.replacen('M', "L", 1))
            }
        }
    }
}
