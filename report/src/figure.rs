//! Line plots as SVG.
//!
//! A figure is a stack of panels over a common horizontal axis, or one panel with equal axes. The
//! text depends on the data alone. Colours are those of Okabe and Ito, which are distinguishable
//! with any colour vision; the figure follows the reader's light or dark scheme.

mod axis;
mod branches;
mod eigenvalues;
mod histogram;
mod inputs;
mod map;
mod plot;
mod scatter;
mod surface;
mod tornado;

use appell_runtime::model::Quantity;
use appell_runtime::simulate::Breach;
use appell_runtime::trajectory::Trajectory;
use axis::{Axis, number};
pub use histogram::Histogram;
pub use map::{Curve, Map, Stroke};
pub use plot::{Layer, Look, Plot};
pub use scatter::Scatter;
pub use surface::{Patch, Path, Surface};
pub use tornado::{Lever, Tornado};

use crate::svg::{Document, Element, path, text, title};
use std::fmt::Write as _;

/// A line.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Its name in the legend.
    pub label: String,
    /// Horizontal positions.
    pub x: Vec<f64>,
    /// Vertical positions; a number that is not finite interrupts the line.
    pub y: Vec<f64>,
}

/// Lines over a common pair of axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// Unit of the vertical axis; may be empty.
    pub unit: String,
    /// The lines.
    pub series: Vec<Series>,
}

/// A mark on the horizontal axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// Its position.
    pub x: f64,
    /// Its tooltip.
    pub about: String,
}

/// Panels from top to bottom.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Above the panels; may be empty.
    pub title: String,
    /// Name and unit of the horizontal axis.
    pub x_label: String,
    /// The panels.
    pub panels: Vec<Panel>,
    /// Vertical lines through all panels.
    pub marks: Vec<Mark>,
    /// Whether both axes have the same scale.
    pub equal_axes: bool,
}

const WIDTH: f64 = 760.0;
const LEFT: f64 = 70.0;
const RIGHT: f64 = 20.0;
const TITLE_HEIGHT: f64 = 34.0;
/// Legend above a panel.
const HEADER_HEIGHT: f64 = 26.0;
const PANEL_HEIGHT: f64 = 130.0;
/// Tick labels and axis label below the last panel.
const FOOTER_HEIGHT: f64 = 46.0;
/// Limits of the height of a panel with equal axes.
const EQUAL_HEIGHT: [f64; 2] = [160.0, 640.0];
/// Mean width of a character at the font's size of 12.
const CHARACTER: f64 = 6.6;
/// Colours before the order repeats with dashes.
const COLOURS: usize = 6;

/// Style of paper, grid, frame, text and lines (`c0` to `c5`), for any drawing that accompanies the figures.
pub const STYLE: &str = "\
.paper{fill:#fff}.grid{stroke:#e3e3e3}.frame{stroke:#777;fill:none}
text{fill:#222;font:12px system-ui,sans-serif}.title{font-size:15px;font-weight:600}
.c0{stroke:#0072b2}.c1{stroke:#d55e00}.c2{stroke:#009e73}.c3{stroke:#cc79a7}.c4{stroke:#e69f00}.c5{stroke:#56b4e9}
.line{fill:none;stroke-width:1.6;stroke-linejoin:round}.dashed{stroke-dasharray:7 4}
@media(prefers-color-scheme:dark){
.paper{fill:#16181c}.grid{stroke:#30343b}.frame{stroke:#8a8f98}text{fill:#e6e6e6}
.c0{stroke:#56b4e9}.c1{stroke:#e69f00}.c2{stroke:#009e73}.c3{stroke:#cc79a7}.c4{stroke:#f0e442}.c5{stroke:#d55e00}
}
";

impl Figure {
    /// Columns of a trajectory over time, one panel per list of names, with a mark at each limit
    /// that the motion passes. Names that the trajectory does not have, and panels without lines,
    /// are omitted.
    pub fn over_time(trajectory: &Trajectory, panels: &[Vec<&str>]) -> Self {
        let series = |name: &&str| {
            let y = trajectory.column_in_unit(name)?;
            Some(Series {
                label: (*name).to_string(),
                x: trajectory.times().to_vec(),
                y,
            })
        };
        let panel = |names: &Vec<&str>| {
            let column = names
                .iter()
                .find_map(|name| trajectory.column_index(name))?;
            let unit = trajectory.columns()[column].unit.to_string();
            Some(Panel {
                unit,
                series: names.iter().filter_map(series).collect(),
            })
        };
        let mark = |breach: &Breach| Mark {
            x: breach.t,
            about: breach.describe(trajectory.info()),
        };
        Self {
            title: trajectory.info().title.to_string(),
            x_label: "t [s]".to_string(),
            panels: panels.iter().filter_map(panel).collect(),
            marks: trajectory.breaches.iter().map(mark).collect(),
            equal_axes: false,
        }
    }

    /// All states and inputs over time. Coordinates, pseudo-velocities and inputs of one unit share
    /// a panel, unless one is so large that the others would appear constant.
    pub fn of_states_and_inputs(trajectory: &Trajectory) -> Self {
        let info = trajectory.info();
        let (speeds, others) = trajectory.columns().split_at(info.speeds);
        let (coordinates, others) = others.split_at(info.state_len() - info.speeds);
        let inputs = &others[..info.input_len()];
        let mut panels: Vec<Vec<&str>> = Vec::new();
        for group in [coordinates, speeds, inputs] {
            let mut shared: Vec<SharedPanel<'_>> = Vec::new();
            for quantity in group {
                let size = trajectory
                    .column(&quantity.name)
                    .map_or(0.0, |y| largest(&y));
                let fitting = shared.iter_mut().find(|panel| panel.suits(quantity, size));
                match fitting {
                    Some(panel) => {
                        panel.names.push(&quantity.name);
                        panel.size = panel.size.max(size);
                    }
                    None => shared.push(SharedPanel {
                        unit: &quantity.unit,
                        size,
                        names: vec![&quantity.name],
                    }),
                }
            }
            panels.extend(shared.into_iter().map(|panel| panel.names));
        }
        Self::over_time(trajectory, &panels)
    }

    /// One column over another with equal axes, such as the path of a point seen from above. `None`
    /// if a column does not exist.
    pub fn path(trajectory: &Trajectory, x: &str, y: &str) -> Option<Self> {
        let unit = |name| {
            let index = trajectory.column_index(name)?;
            Some(trajectory.columns()[index].unit.to_string())
        };
        let series = Series {
            label: y.to_string(),
            x: trajectory.column_in_unit(x)?,
            y: trajectory.column_in_unit(y)?,
        };
        Some(Self {
            title: trajectory.info().title.to_string(),
            x_label: format!("{x} [{}]", unit(x)?),
            panels: vec![Panel {
                unit: unit(y)?,
                series: vec![series],
            }],
            marks: Vec::new(),
            equal_axes: true,
        })
    }

    /// The figure as an SVG document.
    pub fn to_svg(&self) -> String {
        let width = WIDTH - LEFT - RIGHT;
        let x_values = || {
            self.panels
                .iter()
                .flat_map(|p| &p.series)
                .flat_map(|s| &s.x)
                .copied()
        };
        let mut x_axis = if self.equal_axes {
            Axis::padded(x_values())
        } else {
            Axis::tight(x_values())
        };
        let mut y_axes: Vec<Axis> = self
            .panels
            .iter()
            .map(|panel| Axis::padded(panel.series.iter().flat_map(|s| &s.y).copied()))
            .collect();
        let mut panel_height = PANEL_HEIGHT;
        if let (true, Some(y_axis)) = (self.equal_axes, y_axes.first_mut()) {
            let [low, high] = EQUAL_HEIGHT;
            panel_height = (width * y_axis.span() / x_axis.span()).clamp(low, high);
            let unit_length = (width / x_axis.span()).min(panel_height / y_axis.span());
            x_axis.widen_to(width / unit_length);
            y_axis.widen_to(panel_height / unit_length);
        }
        let head = if self.title.is_empty() {
            4.0
        } else {
            TITLE_HEIGHT
        };
        let pitch = HEADER_HEIGHT + panel_height;
        let height = head + self.panels.len() as f64 * pitch + FOOTER_HEIGHT;

        let mut svg = Document::new([WIDTH, height], &[STYLE]);
        if !self.title.is_empty() {
            svg.put(&title([LEFT, 22.0], WIDTH - LEFT - RIGHT, &self.title));
        }
        for (i, (panel, y_axis)) in self.panels.iter().zip(&y_axes).enumerate() {
            let area = Area {
                top: head + i as f64 * pitch + HEADER_HEIGHT,
                width,
                height: panel_height,
            };
            area.grid(&mut svg, &x_axis, y_axis);
            for mark in &self.marks {
                area.mark(&mut svg, mark, &x_axis);
            }
            panel.legend(&mut svg, area.top - 9.0);
            for (k, series) in panel.series.iter().enumerate() {
                let line = area.line(series, &x_axis, y_axis);
                svg.put(&path(&style(k), &line).empty());
            }
        }
        let all_panels = Area {
            top: head,
            width,
            height: self.panels.len() as f64 * pitch,
        };
        all_panels.name_x(&mut svg, &x_axis, &self.x_label);
        svg.finish()
    }
}

/// Quantities that share a panel.
struct SharedPanel<'a> {
    unit: &'a str,
    size: f64,
    names: Vec<&'a str>,
}

impl SharedPanel<'_> {
    /// Whether a quantity of this magnitude has the unit and is visible with the others.
    fn suits(&self, quantity: &Quantity, size: f64) -> bool {
        let similar = size <= 12.0 * self.size && self.size <= 12.0 * size;
        quantity.unit == self.unit && (similar || size == 0.0 || self.size == 0.0)
    }
}

/// The largest finite absolute value; 0 without one.
fn largest(values: &[f64]) -> f64 {
    let finite = values.iter().filter(|value| value.is_finite());
    finite.fold(0.0, |largest, value| value.abs().max(largest))
}

impl Panel {
    /// Samples of the lines with their names. The unit stands in the text of the last name, so
    /// that the space between them does not depend on the reader's font.
    fn legend(&self, svg: &mut Document, y: f64) {
        let mut x = LEFT;
        for (k, series) in self.series.iter().enumerate() {
            let sample = format!("M{x:.1} {:.1}h18", y - 4.0);
            svg.put(&path(&style(k), &sample).empty());
            let label = if k + 1 == self.series.len() && !self.unit.is_empty() {
                &format!("{} [{}]", series.label, self.unit)
            } else {
                &series.label
            };
            svg.put(&text([x + 23.0, y]).text(label));
            x += 23.0 + CHARACTER * series.label.chars().count() as f64 + 16.0;
        }
    }
}

/// Position of a panel.
struct Area {
    top: f64,
    width: f64,
    height: f64,
}

impl Area {
    /// Numbers and the label below.
    fn name_x(&self, svg: &mut Document, axis: &Axis, label: &str) {
        let bottom = self.top + self.height;
        for tick in axis.ticks(8) {
            let x = LEFT + self.width * axis.part(tick);
            let label = number(tick, axis.step(8));
            svg.put(&centred([x, bottom + 16.0], &label));
        }
        let x = LEFT + self.width / 2.0;
        svg.put(&centred([x, bottom + 35.0], label));
    }

    fn grid(&self, svg: &mut Document, x_axis: &Axis, y_axis: &Axis) {
        let mut grid = String::new();
        for tick in x_axis.ticks(8) {
            let x = LEFT + self.width * x_axis.part(tick);
            // Writing to a string cannot fail.
            let _ = write!(grid, "M{x:.1} {:.1}v{:.1}", self.top, self.height);
        }
        let count = if self.height > PANEL_HEIGHT { 8 } else { 5 };
        for tick in y_axis.ticks(count) {
            let y = self.top + self.height * (1.0 - y_axis.part(tick));
            let _ = write!(grid, "M{LEFT:.1} {y:.1}h{:.1}", self.width);
            let label = number(tick, y_axis.step(count));
            let tick_label = text([LEFT - 7.0, y + 4.0]).with("text-anchor", "end");
            svg.put(&tick_label.text(&label));
        }
        svg.put(&path("grid", &grid).empty());
        let frame = Element::new("rect").with("class", "frame").with("x", LEFT);
        let lengths = [
            ("y", self.top),
            ("width", self.width),
            ("height", self.height),
        ];
        svg.put(&frame.lengths(lengths).empty());
    }

    fn mark(&self, svg: &mut Document, mark: &Mark, x_axis: &Axis) {
        let part = x_axis.part(mark.x);
        if !(0.0..=1.0).contains(&part) {
            return;
        }
        let line = format!(
            "M{:.1} {:.1}v{:.1}",
            LEFT + self.width * part,
            self.top,
            self.height
        );
        svg.put(&path("frame dashed", &line).titled(&mark.about));
    }

    /// The path of the line without invisible points: a point is drawn if it or its successor is
    /// more than a third of a pixel from the last one drawn.
    fn line(&self, series: &Series, x_axis: &Axis, y_axis: &Axis) -> String {
        const VISIBLE: f64 = 1.0 / 3.0;
        let place = |(x, y): (&f64, &f64)| {
            (x.is_finite() && y.is_finite()).then(|| {
                let right = LEFT + self.width * x_axis.part(*x);
                let down = self.top + self.height * (1.0 - y_axis.part(*y));
                [right, down]
            })
        };
        let far = |a: [f64; 2], b: [f64; 2]| {
            (a[0] - b[0]).abs() > VISIBLE || (a[1] - b[1]).abs() > VISIBLE
        };
        let mut path = String::new();
        let mut drawn: Option<[f64; 2]> = None;
        let mut skipped: Option<[f64; 2]> = None;
        let mut draw = |command: char, [x, y]: [f64; 2]| {
            let _ = write!(path, "{command}{x:.1} {y:.1}");
        };
        for point in series.x.iter().zip(&series.y).map(place) {
            match (point, drawn) {
                (None, _) => {
                    if let Some(last) = skipped.take() {
                        draw('L', last);
                    }
                    drawn = None;
                }
                (Some(point), None) => {
                    draw('M', point);
                    drawn = Some(point);
                }
                (Some(point), Some(last)) if far(point, last) => {
                    if let Some(before) = skipped.take() {
                        draw('L', before);
                    }
                    draw('L', point);
                    drawn = Some(point);
                }
                (Some(point), Some(_)) => skipped = Some(point),
            }
        }
        if let Some(last) = skipped {
            draw('L', last);
        }
        path
    }
}

/// Classes of the line of this number.
fn style(series: usize) -> String {
    let dashes = if series / COLOURS % 2 == 1 {
        " dashed"
    } else {
        ""
    };
    format!("line c{}{dashes}", series % COLOURS)
}

/// A text centred at a point.
fn centred(place: [f64; 2], content: &str) -> String {
    text(place).with("text-anchor", "middle").text(content)
}
