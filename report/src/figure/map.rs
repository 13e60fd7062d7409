//! A map of kinds over a plane, with curves, as SVG.

use std::fmt::Write as _;

use super::area::{Area, Axis, INNER, SAMPLE, entry};
use super::{FOOTER_HEIGHT, HEADER_HEIGHT, LEFT, STYLE, Series, TITLE_HEIGHT, WIDTH};
use crate::svg::{Document, Element, path, text, title};

/// Kinds at the points of a grid over two quantities, and curves.
#[derive(Debug, Clone, PartialEq)]
pub struct Map {
    /// Above the map; may be empty.
    pub title: String,
    /// Name and unit of the horizontal and of the vertical quantity.
    pub labels: [String; 2],
    /// Their first and last values.
    pub ranges: [[f64; 2]; 2],
    /// Points along each.
    pub counts: [usize; 2],
    /// Names of the kinds, up to six; one without a name is not in the legend.
    pub kinds: Vec<String>,
    /// The kind of each point, row by row from the first value of the vertical quantity; `None`
    /// where unknown.
    pub cells: Vec<Option<usize>>,
    /// Curves; those with a label are in the legend.
    pub curves: Vec<Curve>,
}

/// A curve on a map.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Its points.
    pub line: Series,
    /// Its style.
    pub stroke: Stroke,
}

/// Style of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stroke {
    /// A line.
    Solid,
    /// A thin line, such as a level of a third quantity.
    Thin,
    /// Dashes.
    Dashed,
    /// Dots.
    Dotted,
    /// A disc at each point.
    Discs,
    /// A square at each point.
    Squares,
}

impl Stroke {
    const fn class(self) -> &'static str {
        match self {
            Self::Solid => "curve",
            Self::Thin => "curve thin",
            Self::Dashed => "curve long",
            Self::Dotted => "curve dots",
            Self::Discs | Self::Squares => "spot",
        }
    }
}

const HEIGHT: f64 = 480.0;
/// Fillings of the kinds, distinguishable with any colour vision.
pub(super) const FILLS: &str = include_str!("map.css");
/// Room for a name in the legend.
pub(super) const LEGEND: f64 = 168.0;
/// Names in a row of the legend.
const PER_ROW: usize = 4;
const LEGEND_ROW: f64 = 18.0;

/// An area of a kind.
pub(super) fn element(kind: usize, line: &str) -> String {
    path(&format!("kind k{kind}"), line).empty()
}

impl Map {
    /// The map as an SVG document.
    pub fn to_svg(&self) -> String {
        let [x_axis, y_axis] = self.ranges.map(|range| Axis::tight(range.into_iter()));
        let kinds = self.kinds.iter().enumerate();
        let kinds = kinds.map(|(kind, name)| (Sample::Kind(kind), name));
        let curves = self.curves.iter();
        let curves = curves.map(|curve| (Sample::Curve(curve.stroke), &curve.line.label));
        let legend: Vec<(Sample, &String)> = (kinds.chain(curves))
            .filter(|(_, name)| !name.is_empty())
            .collect();
        let rows = legend.len().div_ceil(PER_ROW).max(1);
        let area = Area {
            top: TITLE_HEIGHT + HEADER_HEIGHT + LEGEND_ROW * (rows - 1) as f64,
            height: HEIGHT,
            x_axis,
            y_axis,
        };
        let height = area.bottom() + FOOTER_HEIGHT;
        let mut svg = Document::new([WIDTH, height], &[STYLE, FILLS]);
        svg.put(&title([LEFT, 22.0], INNER, &self.title));
        for (i, (sample, name)) in legend.into_iter().enumerate() {
            let x = LEFT + LEGEND * (i % PER_ROW) as f64;
            let y = TITLE_HEIGHT + HEADER_HEIGHT - 9.0 + LEGEND_ROW * (i / PER_ROW) as f64;
            entry(&mut svg, &sample.at([x, y - 4.0]), [x + SAMPLE, y], name);
        }
        for kind in 0..self.kinds.len() {
            svg.put(&element(kind, &self.cells_of(kind, &area)));
        }
        area.grid(&mut svg);
        // Clipped to the ranges.
        let top = area.top;
        let frame = Element::new("svg")
            .with("x", LEFT)
            .lengths([("y", top), ("width", INNER)])
            .with("height", HEIGHT);
        let view_box = format_args!("{LEFT} {top:.1} {INNER:.1} {HEIGHT}");
        svg.put(&frame.with("viewBox", view_box).open());
        for curve in &self.curves {
            svg.put(&curve.stroke.element(&curve.path(&area)));
        }
        svg.put("</svg>");
        area.name_x(&mut svg, &self.labels[0]);
        let (x, y) = (18.0, top + HEIGHT / 2.0);
        let label = text([x, y]).with("text-anchor", "middle");
        let label = label.with("transform", format_args!("rotate(-90 {x} {y})"));
        svg.put(&label.text(&self.labels[1]));
        svg.finish()
    }

    /// The points of a kind as rectangles about them, one for each run in a row.
    fn cells_of(&self, kind: usize, area: &Area) -> String {
        let [columns, rows] = self.counts;
        // Ranges may run downwards.
        let [left, down] = self.ranges.map(|[from, to]| from > to);
        let mut path = String::new();
        for (j, row) in self.cells.chunks(columns.max(1)).enumerate() {
            let [top, bottom] = reach([j, j + 1], rows, !down);
            let mut i = 0;
            for run in row.chunk_by(PartialEq::eq) {
                let end = i + run.len();
                if run[0] == Some(kind) {
                    let [from, to] = reach([i, end], columns, left);
                    let [x, width] = [LEFT + INNER * from, INNER * (to - from)];
                    let [y, high] = [area.top + area.height * top, area.height * (bottom - top)];
                    // Writing to a string cannot fail.
                    let _ = write!(path, "M{x:.1} {y:.2}h{width:.1}v{high:.2}h-{width:.1}z");
                }
                i = end;
            }
        }
        path
    }
}

/// Beginning and end of a run of points in a row of so many, as fractions of the row: midway to the
/// adjacent points.
fn reach(run: [usize; 2], count: usize, backwards: bool) -> [f64; 2] {
    let part = |end: usize| (end as f64 - 0.5) / count.saturating_sub(1).max(1) as f64;
    let [from, to] = run.map(|end| part(end).clamp(0.0, 1.0));
    if backwards {
        [1.0 - to, 1.0 - from]
    } else {
        [from, to]
    }
}

impl Curve {
    fn path(&self, area: &Area) -> String {
        if !self.stroke.is_spots() {
            return area.line(&self.line);
        }
        let points = self.line.x.iter().zip(&self.line.y);
        let spot = |(x, y): (&f64, &f64)| self.stroke.spot(area.place(*x, *y));
        points.map(spot).collect()
    }
}

impl Stroke {
    fn element(self, line: &str) -> String {
        path(self.class(), line).empty()
    }

    const fn is_spots(self) -> bool {
        matches!(self, Self::Discs | Self::Squares)
    }

    /// A spot at a point.
    fn spot(self, [x, y]: [f64; 2]) -> String {
        match self {
            Self::Squares => format!("M{:.1} {:.1}h10v10h-10z", x - 5.0, y - 5.0),
            _ => format!("M{:.1} {y:.1}a5 5 0 1 0 10 0a5 5 0 1 0 -10 0z", x - 5.0),
        }
    }
}

/// Sample before a name in the legend.
pub(super) enum Sample {
    Kind(usize),
    Curve(Stroke),
}

impl Sample {
    /// The sample, with the middle of its left end at a point.
    pub(super) fn at(&self, [x, y]: [f64; 2]) -> String {
        match self {
            Self::Kind(kind) => element(*kind, &format!("M{x:.1} {:.1}h16v10h-16z", y - 5.0)),
            Self::Curve(stroke) if stroke.is_spots() => stroke.element(&stroke.spot([x + 8.0, y])),
            Self::Curve(stroke) => stroke.element(&format!("M{x:.1} {y:.1}h18")),
        }
    }
}
