//! Figures of one frame: one quantity over another as points, lines and bands; histograms; points in classes; tornados.

use super::area::{Area, Axis, INNER, SAMPLE, centred, entry, number, numbers};
use super::{FOOTER_HEIGHT, HEADER_HEIGHT, LEFT, Mark, RIGHT, STYLE, Series, WIDTH};
use crate::svg::{Document, Element, path, text};

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

const HISTOGRAM_HEIGHT: f64 = 150.0;
const BAR_STYLE: &str = include_str!("histogram.css");

impl Histogram {
    /// The figure as an SVG document.
    pub fn to_svg(&self) -> String {
        let heights = self.bars.iter().map(|&count| count as f64);
        let area = Area {
            top: HEADER_HEIGHT,
            height: HISTOGRAM_HEIGHT,
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

const SCATTER_HEIGHT: f64 = 320.0;
const SCATTER_HEAD: f64 = 44.0;
const SCATTER_STYLE: &str = include_str!("scatter.css");

impl Scatter {
    /// The figure as an SVG document.
    pub fn to_svg(&self) -> String {
        let values = |axis: usize| self.points.iter().map(move |(point, _)| point[axis]);
        let area = Area {
            top: SCATTER_HEAD + HEADER_HEIGHT,
            height: SCATTER_HEIGHT,
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
            let sample = format!("M{:.1} {:.1}h0", right + 5.0, SCATTER_HEAD - 10.0);
            let place = [right + 13.0, SCATTER_HEAD - 6.0];
            right = entry(&mut svg, &path(&style, &sample).empty(), place, name);
        }
        area.name_x(&mut svg, &self.labels[0]);
        svg.finish()
    }
}

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
const TORNADO_HEAD: f64 = 26.0;
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
        let (width, bottom) = (
            WIDTH - NAMES - RIGHT,
            TORNADO_HEAD + ROW * levers.len() as f64,
        );
        let place = |value: f64| NAMES + width * axis.part(value);
        let mut svg = Document::new([WIDTH, bottom + FOOTER_HEIGHT], &[STYLE, TORNADO_STYLE]);
        let upright = |x: f64| format!("M{x:.1} {TORNADO_HEAD:.1}V{bottom:.1}");
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
            let y = TORNADO_HEAD + ROW * row as f64 + 0.5 * (ROW - BAR);
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
