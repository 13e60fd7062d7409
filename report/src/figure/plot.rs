//! One quantity over another: points, lines and bands, as SVG.

use super::area::{Area, SAMPLE, entry};
use super::axis::Axis;
use super::{FOOTER_HEIGHT, HEADER_HEIGHT, LEFT, STYLE, Series, WIDTH};
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
const PLOT_STYLE: &str = include_str!("plot.css");
/// Room for the name of the vertical axis.
const HEAD: f64 = 22.0;

impl Plot {
    /// The plot as an SVG document.
    pub fn to_svg(&self) -> String {
        let area = Area {
            top: HEAD + HEADER_HEIGHT,
            height: self.height,
            x_axis: Axis::tight(self.layers.iter().flat_map(|l| &l.series.x).copied()),
            y_axis: Axis::padded(self.layers.iter().flat_map(Layer::heights)),
        };
        let height = area.bottom() + FOOTER_HEIGHT;
        let mut svg = Document::new([WIDTH, height], &[STYLE, PLOT_STYLE]);
        svg.put(&text([LEFT, 16.0]).text(&self.labels[1]));
        area.grid(&mut svg);
        let (mut right, y) = (LEFT, area.top - 9.0);
        for layer in &self.layers {
            svg.put(&layer.element(&layer.path(&area)));
            if !layer.series.label.is_empty() {
                let sample = layer.element(&layer.sample([right, y - 4.0]));
                right = entry(&mut svg, &sample, [right + SAMPLE, y], &layer.series.label);
            }
        }
        area.name_x(&mut svg, &self.labels[0]);
        svg.finish()
    }
}

impl Layer {
    /// A layer with a name.
    pub fn new(label: &str, look: Look, colour: usize, x: &[f64], y: Vec<f64>) -> Self {
        Self {
            series: Series::new(label, x, y),
            look,
            colour,
        }
    }

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

    fn path(&self, area: &Area) -> String {
        let Series { x, y, .. } = &self.series;
        match &self.look {
            Look::Line => area.line(&self.series),
            Look::Points => area.dots(x.iter().zip(y).map(|(&x, &y)| [x, y])),
            Look::Band(other) | Look::Core(other) => {
                let there = area.line(&self.series);
                let backwards = |values: &[f64]| values.iter().rev().copied().collect::<Vec<_>>();
                let back = Series::new("", &backwards(x), backwards(other));
                format!("{there}{}z", area.line(&back).replacen('M', "L", 1))
            }
        }
    }
}
