//! Line plots as SVG.
//!
//! A figure is a stack of panels over a common horizontal axis, or one panel with equal axes. The
//! text depends on the data alone. Colours are those of Okabe and Ito, which are distinguishable
//! with any colour vision; the figure follows the reader's light or dark scheme.

mod area;
mod map;
mod plot;
mod results;
mod surface;

use appell_gap::identify::HALF_WIDTH_95;
use appell_runtime::model::Quantity;
use appell_runtime::simulate::Breach;
use appell_runtime::trajectory::Trajectory;
use area::{Area, Axis, INNER, SAMPLE, entry, scale};
pub use map::{Curve, Map, Stroke};
pub use plot::{Histogram, Layer, Lever, Look, Plot, Scatter, Tornado};
pub use surface::{Patch, Path, Surface};

use crate::svg::{Document, path, title};

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

impl Series {
    /// A line with a name.
    pub fn new(label: impl Into<String>, x: &[f64], y: Vec<f64>) -> Self {
        Self {
            label: label.into(),
            x: x.to_vec(),
            y,
        }
    }
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
pub const STYLE: &str = include_str!("figure/style.css");

impl Panel {
    /// Lines with the unit of the vertical axis.
    pub fn new(unit: impl Into<String>, series: Vec<Series>) -> Self {
        let unit = unit.into();
        Self { unit, series }
    }
}

impl Figure {
    /// Panels over a common axis.
    pub fn new(title: impl Into<String>, x_label: impl Into<String>, panels: Vec<Panel>) -> Self {
        Self {
            title: title.into(),
            x_label: x_label.into(),
            panels,
            marks: Vec::new(),
            equal_axes: false,
        }
    }

    /// Columns of a trajectory over time, one panel per list of names, with a mark at each limit
    /// that the motion passes. Names that the trajectory does not have, and panels without lines,
    /// are omitted.
    pub fn over_time(trajectory: &Trajectory, panels: &[Vec<&str>]) -> Self {
        let series = |name: &&str| {
            let y = trajectory.column_in_unit(name)?;
            Some(Series::new(*name, trajectory.times(), y))
        };
        let panel = |names: &Vec<&str>| {
            let column = names
                .iter()
                .find_map(|name| trajectory.column_index(name))?;
            let unit = trajectory.columns()[column].unit.as_ref();
            Some(Panel::new(unit, names.iter().filter_map(series).collect()))
        };
        let mark = |breach: &Breach| Mark {
            x: breach.t,
            about: breach.describe(trajectory.info()),
        };
        let (title, panels) = (trajectory.info().title.as_ref(), panels.iter());
        Self {
            marks: trajectory.breaches.iter().map(mark).collect(),
            ..Self::new(title, "t [s]", panels.filter_map(panel).collect())
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
        let across = trajectory.column_in_unit(x)?;
        let series = Series::new(y, &across, trajectory.column_in_unit(y)?);
        let (title, x_label) = (
            trajectory.info().title.as_ref(),
            format!("{x} [{}]", unit(x)?),
        );
        Some(Self {
            equal_axes: true,
            ..Self::new(title, x_label, vec![Panel::new(unit(y)?, vec![series])])
        })
    }

    /// The figure as an SVG document.
    pub fn to_svg(&self) -> String {
        let lines = || self.panels.iter().flat_map(|panel| &panel.series);
        let x_values = lines().flat_map(|series| &series.x).copied();
        let mut x_axis = if self.equal_axes {
            Axis::padded(x_values)
        } else {
            Axis::tight(x_values)
        };
        let mut y_axes: Vec<Axis> = (self.panels.iter())
            .map(|panel| Axis::padded(panel.series.iter().flat_map(|s| &s.y).copied()))
            .collect();
        let mut panel_height = PANEL_HEIGHT;
        if let (true, Some(y_axis)) = (self.equal_axes, y_axes.first_mut()) {
            let [low, high] = EQUAL_HEIGHT;
            panel_height = (INNER * y_axis.span() / x_axis.span()).clamp(low, high);
            let unit_length = (INNER / x_axis.span()).min(panel_height / y_axis.span());
            x_axis.widen_to(INNER / unit_length);
            y_axis.widen_to(panel_height / unit_length);
        }
        let head = if self.title.is_empty() {
            4.0
        } else {
            TITLE_HEIGHT
        };
        let pitch = HEADER_HEIGHT + panel_height;
        let bottom = head + self.panels.len() as f64 * pitch;

        let mut svg = Document::new([WIDTH, bottom + FOOTER_HEIGHT], &[STYLE]);
        if !self.title.is_empty() {
            svg.put(&title([LEFT, 22.0], INNER, &self.title));
        }
        for (i, (panel, y_axis)) in self.panels.iter().zip(y_axes).enumerate() {
            let area = Area {
                top: head + i as f64 * pitch + HEADER_HEIGHT,
                height: panel_height,
                x_axis,
                y_axis,
            };
            area.grid(&mut svg);
            for mark in &self.marks {
                area.mark(&mut svg, mark);
            }
            panel.legend(&mut svg, area.top - 9.0);
            for (k, series) in panel.series.iter().enumerate() {
                svg.put(&path(&style(k), &area.line(series)).empty());
            }
        }
        scale(&mut svg, &x_axis, bottom, &self.x_label);
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
    /// A value with its 95 % band, as three lines: the first name is that of the value.
    pub(crate) fn with_band(
        names: [&str; 3],
        quantity: &Quantity,
        times: &[f64],
        values: &[f64],
        deviations: &[f64],
    ) -> Self {
        let line = |(name, sign): (&str, f64)| {
            let shifted = |(value, std): (&f64, &f64)| value + sign * HALF_WIDTH_95 * std;
            let y = values.iter().zip(deviations).map(shifted);
            Series::new(
                name,
                times,
                y.map(|value| quantity.to_unit(value)).collect(),
            )
        };
        let series = names.into_iter().zip([0.0, -1.0, 1.0]).map(line);
        Self::new(quantity.unit.as_ref(), series.collect())
    }

    /// Samples of the lines with their names. The unit stands in the text of the last name, so
    /// that the space between them does not depend on the reader's font.
    fn legend(&self, svg: &mut Document, y: f64) {
        let mut x = LEFT;
        for (k, series) in self.series.iter().enumerate() {
            let sample = path(&style(k), &format!("M{x:.1} {:.1}h18", y - 4.0));
            let label = if k + 1 == self.series.len() && !self.unit.is_empty() {
                &format!("{} [{}]", series.label, self.unit)
            } else {
                &series.label
            };
            x = entry(svg, &sample.empty(), [x + SAMPLE, y], label);
        }
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
