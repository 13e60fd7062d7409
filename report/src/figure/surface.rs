//! Surfaces and paths in space, in parallel projection, as SVG.

use std::fmt::Write as _;

use super::area::{Axis, SAMPLE, entry, number};
use super::map::{FILLS, LEGEND, Sample, element};
use super::{HEADER_HEIGHT, LEFT, STYLE, TITLE_HEIGHT, WIDTH};
use crate::svg::{self, Document, Element, text};

/// Pieces of a surface over three quantities.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// Above the picture; may be empty.
    pub title: String,
    /// Name and unit of each quantity; the last one points upwards.
    pub labels: [String; 3],
    /// Their first and last values.
    pub ranges: [[f64; 2]; 3],
    /// Names of the kinds, coloured as those of a [`Map`](super::Map).
    pub kinds: Vec<String>,
    /// The pieces. Those outside the ranges are omitted.
    pub patches: Vec<Patch>,
    /// Paths in front of them.
    pub paths: Vec<Path>,
}

/// A path in space.
#[derive(Debug, Clone, PartialEq)]
pub struct Path {
    /// Its name in the legend.
    pub label: String,
    /// Its points.
    pub points: Vec<[f64; 3]>,
}

/// A piece of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Patch {
    /// Its corners, in order.
    pub corners: [[f64; 3]; 4],
    /// Its kind.
    pub kind: usize,
}

const HEIGHT: f64 = 500.0;
/// Half the edge of the box.
const SIZE: f64 = 150.0;
/// Sine and cosine of the azimuth and the elevation of the view.
const TURN: [f64; 2] = [0.529_919_264_233_204_9, 0.848_048_096_156_426];
const DIP: [f64; 2] = [0.422_618_261_740_699_44, 0.906_307_787_036_649_9];
/// Surfaces are opaque; their mesh shows their form.
const SOLID: &str = include_str!("surface.css");

/// A projected point with its depth.
fn seen([x, y, z]: [f64; 3]) -> ([f64; 2], f64) {
    let [sideways, depth] = [TURN[1] * x - TURN[0] * y, TURN[0] * x + TURN[1] * y];
    let upwards = DIP[1] * z + DIP[0] * depth;
    let near = DIP[0] * z - DIP[1] * depth;
    let [across, down] = [WIDTH / 2.0, TITLE_HEIGHT + HEADER_HEIGHT + HEIGHT / 2.0];
    ([across + SIZE * sideways, down - SIZE * upwards], near)
}

fn line(index: usize, line: &str) -> String {
    svg::path(&format!("line c{}", index % 6), line).empty()
}

impl Surface {
    /// The surface as an SVG document.
    pub fn to_svg(&self) -> String {
        let height = TITLE_HEIGHT + HEADER_HEIGHT + HEIGHT;
        let mut svg = Document::new([WIDTH, height], &[STYLE, FILLS, SOLID]);
        svg.put(&svg::title([LEFT, 22.0], WIDTH - 2.0 * LEFT, &self.title));
        let place = |entry: usize| {
            let x = LEFT + LEGEND * entry as f64;
            [x, TITLE_HEIGHT + HEADER_HEIGHT - 9.0]
        };
        let kinds = self.kinds.iter().enumerate();
        let named = kinds.filter(|(_, name)| !name.is_empty());
        for (i, (kind, name)) in named.enumerate() {
            let [x, y] = place(i);
            let sample = Sample::Kind(kind).at([x, y - 4.0]);
            entry(&mut svg, &sample, [x + SAMPLE, y], name);
        }
        for (i, path) in self.paths.iter().enumerate() {
            let [x, y] = place(self.kinds.len() + i);
            let sample = line(i, &format!("M{x:.1} {:.1}h16", y - 4.0));
            entry(&mut svg, &sample, [x + SAMPLE, y], &path.label);
        }
        self.walls(&mut svg);
        svg.put(&Element::new("g").with("class", "piece").open());
        for (kind, path) in self.pieces() {
            svg.put(&element(kind, &path));
        }
        svg.put("</g>");
        for (i, path) in self.paths.iter().enumerate() {
            svg.put(&line(i, &self.way(&path.points)));
        }
        self.scales(&mut svg);
        svg.finish()
    }

    /// A point in the box, each quantity between −1 and 1.
    fn inside(&self, values: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|k: usize| self.part(k, values[k]))
    }

    fn part(&self, k: usize, value: f64) -> f64 {
        let [from, to] = self.ranges[k];
        2.0 * (value - from) / (to - from) - 1.0
    }

    /// A projected path; unknown points interrupt it.
    fn way(&self, points: &[[f64; 3]]) -> String {
        let (mut way, mut is_on) = (String::new(), false);
        for &point in points {
            let inside = self.inside(point);
            let is_known = inside.iter().all(|part| part.is_finite());
            if is_known {
                let [x, y] = seen(inside).0;
                // Writing to a string cannot fail.
                let _ = write!(way, "{}{x:.1} {y:.1}", if is_on { 'L' } else { 'M' });
            }
            is_on = is_known;
        }
        way
    }

    /// The pieces, the farthest first.
    fn pieces(&self) -> Vec<(usize, String)> {
        let piece = |patch: &Patch| {
            let corners = patch.corners.map(|corner| self.inside(corner));
            let mut parts = corners.iter().flatten();
            let is_inside = parts.all(|part| part.abs() <= 1.0);
            let near: f64 = corners.iter().map(|corner| seen(*corner).1).sum();
            let path = svg::polyline(corners.map(|corner| seen(corner).0)) + "z";
            is_inside.then_some((near, (patch.kind, path)))
        };
        let mut pieces: Vec<(f64, (usize, String))> =
            self.patches.iter().filter_map(piece).collect();
        pieces.sort_by(|a, b| a.0.total_cmp(&b.0));
        pieces.into_iter().map(|(_, piece)| piece).collect()
    }

    /// The floor and the two walls behind, with the lines of the ticks.
    fn walls(&self, svg: &mut Document) {
        let mut grid = String::new();
        let mut line = |ends: [[f64; 3]; 2]| {
            let [[x, y], [to_x, to_y]] = ends.map(|end| seen(end).0);
            let _ = write!(grid, "M{x:.1} {y:.1}L{to_x:.1} {to_y:.1}");
        };
        for (k, other, third) in [(0, 1, 2), (1, 0, 2), (2, 0, 1)] {
            let ticks = self.ticks(k).into_iter().map(|(part, _)| part);
            for tick in ticks.chain([-1.0, 1.0]) {
                for (along, still) in [(other, third), (third, other)] {
                    // The faces behind: the far ends of the first two, the floor of the last.
                    let behind = |axis: usize| if axis == 2 { -1.0 } else { 1.0 };
                    let mut ends = [[0.0; 3]; 2];
                    for (end, part) in ends.iter_mut().zip([-1.0, 1.0]) {
                        (end[k], end[along], end[still]) = (tick, part, behind(still));
                    }
                    line(ends);
                }
            }
        }
        let lines = Element::new("path").with("class", "grid");
        svg.put(&lines.with("fill", "none").with("d", grid).empty());
    }

    /// Ticks and names along the edges in front.
    fn scales(&self, svg: &mut Document) {
        for (k, edge, away) in [
            (0, [0.0, -1.0, -1.0], [0.0, 16.0]),
            (1, [-1.0, 0.0, -1.0], [-16.0, 14.0]),
            (2, [-1.0, 1.0, 0.0], [-14.0, 4.0]),
        ] {
            let at = |part: f64| {
                let mut place = edge;
                place[k] = part;
                seen(place).0
            };
            let anchor = if k == 0 { "start" } else { "end" };
            let label = |[x, y]: [f64; 2], content: &str| {
                text([x, y]).with("text-anchor", anchor).text(content)
            };
            for (part, number) in self.ticks(k) {
                let [x, y] = at(part);
                svg.put(&label([x + away[0], y + away[1]], &number));
            }
            let [x, y] = at(0.0);
            let place = [x + 3.2 * away[0], y + 3.0 * away[1]];
            svg.put(&label(place, &self.labels[k]));
        }
    }

    /// Positions of the ticks of a quantity in the box, and their labels.
    fn ticks(&self, k: usize) -> Vec<(f64, String)> {
        /// Approximate number of ticks.
        const COUNT: u32 = 5;
        let axis = Axis::tight(self.ranges[k].into_iter());
        let ticks = axis.ticks(COUNT).into_iter();
        ticks
            .map(|tick| (self.part(k, tick), number(tick, axis.step(COUNT))))
            .collect()
    }
}
