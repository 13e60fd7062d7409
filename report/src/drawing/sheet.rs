//! Layout of strokes and names, as an SVG document.

use std::fmt::Write as _;

use crate::figure::STYLE;
use crate::svg::{self, Document, Element};
use appell_spec::mechanism::Mechanism;

use super::arcs::{self, Arc};
use super::home::home;
use super::scene::Scene;
use super::shapes::{self, Axes, Stroke};
use super::space::{Vector, add, dot, spans};
use super::view::View;

const WIDTH: f64 = 760.0;
/// Margin for names.
const MARGIN: f64 = 64.0;
const HEAD: f64 = 84.0;
const FOOT: f64 = 104.0;
/// Limits of the height of the drawing.
const HEIGHTS: [f64; 2] = [140.0, 460.0];
/// Length of an axis, relative to the drawing.
const AXIS: f64 = 0.12;
/// Squares of the ground along the drawing.
const SQUARES: f64 = 5.0;
/// Names closer than this are written together.
const CLOSE: f64 = 7.0;
/// Size below which a mechanism counts as a point.
const SMALLEST: f64 = 1e-100;
/// Colours of the three axes.
const AXIS_COLOURS: [&str; 3] = ["c1", "c2", "c0"];
/// Room of the name of an angle.
const NAME_SIZE: [f64; 2] = [70.0, 13.0];
/// Radius of a marking ring.
const RING: f64 = 17.0;
/// Length of the arrow of the weight.
const ARROW: f64 = 40.0;
const ARROW_TAIL: [f64; 2] = [WIDTH - 70.0, 40.0];
/// Its name, from the tail.
const ARROW_NAME: [f64; 2] = [10.0, 14.0];
/// Radii of a point and of a point mass.
const POINT_RADIUS: f64 = 3.5;
const MASS_RADIUS: f64 = 6.0;
/// Distance of title and legend from the left and right edge.
const EDGE: f64 = 20.0;
/// Size of texts, and their distance from all edges.
const TEXT_SIZE: f64 = 12.0;
const PAD: f64 = 4.0;
/// Baselines of title and caption.
const TITLE_LINE: f64 = 26.0;
const CAPTION_LINE: f64 = 46.0;
/// Baselines of the legend, above the lower edge.
const LEGEND_LINES: [f64; 3] = [64.0, 42.0, 20.0];
/// Height of the symbols of the legend above their baseline.
const SYMBOL_RISE: f64 = 4.0;
/// Axes in the legend: length, position of the name, distance to the next axis.
const LEGEND_AXIS: f64 = 16.0;
const LEGEND_AXIS_NAME: f64 = 20.0;
const LEGEND_AXIS_PITCH: f64 = 38.0;
/// Points in the legend: symbol and text.
const LEGEND_POINT: [f64; 2] = [26.0, 38.0];
const LEGEND_MASS: [f64; 2] = [206.0, 220.0];

/// Added to the style of the figures.
const DRAWING_STYLE: &str = include_str!("sheet.css");

/// Mapping from metres to pixels.
struct Sheet<'a> {
    view: &'a View,
    /// Pixels per metre.
    scale: f64,
    /// The point at the upper left corner of the drawing.
    corner: [f64; 2],
    /// Height of the sheet in pixels.
    height: f64,
    svg: Document,
}

/// The drawing of a scene.
pub(super) fn svg(mechanism: &Mechanism, scene: &Scene, marked: &[&str], given: &str) -> String {
    let view = &View::of(mechanism, scene.flat_across);
    let mut strokes = shapes::links(mechanism, scene);
    let points = || scene.points.iter().flatten().copied();
    let frame_size = size(points());
    let bodies = shapes::bodies(mechanism, scene, view).into_iter();
    strokes.extend(bodies.filter(|body| {
        // A hint that would hide the rest is none.
        let all = size(body.corners.iter().copied());
        body.class == "wheel" || frame_size == 0.0 || all <= 2.0 * frame_size
    }));
    let drawn = |strokes: &[Stroke]| -> Vec<Vector> {
        let corners = strokes.iter().flat_map(|stroke| stroke.corners.clone());
        corners.chain(points()).collect()
    };
    let places = drawn(&strokes);
    let extent = Some(size(places.iter().copied())).filter(|&extent| extent > SMALLEST);
    let extent = extent.unwrap_or(1.0);
    let step = round_number(extent / SQUARES);
    let axes = shapes::axes(mechanism, scene);
    let ground = shapes::ground(view, &places, step);

    let tips = axes.iter().flat_map(|axes| tips(axes, extent));
    let corners = drawn(&ground).into_iter().chain(places).chain(tips);
    let [[left, right], [low, high]] = spans(corners.map(|place| view.seen(place)));
    let [flattest, highest] = HEIGHTS;
    let scale = ((WIDTH - 2.0 * MARGIN) / (right - left)).min(highest / (high - low));
    let drawn_height = ((high - low) * scale).max(flattest);
    let height = HEAD + drawn_height + FOOT;
    let beside = (WIDTH - (right - left) * scale) / 2.0;
    let above = (drawn_height - (high - low) * scale) / 2.0;
    let mut sheet = Sheet {
        view,
        scale,
        corner: [left - beside / scale, high + (HEAD + above) / scale],
        height,
        svg: Document::new([WIDTH, height], &[STYLE, DRAWING_STYLE]),
    };
    let title = svg::title([EDGE, TITLE_LINE], WIDTH - 2.0 * EDGE, &mechanism.title);
    sheet.svg.put(&title);
    let caption = caption(mechanism, scene, given);
    sheet.text([EDGE, CAPTION_LINE], "small soft", "start", &caption);
    for stroke in ground.iter().chain(&strokes) {
        sheet.stroke(stroke);
    }
    for axes in &axes {
        sheet.axes(axes, extent);
    }
    let mut names = Vec::new();
    for arc in arcs::arcs(mechanism, scene, extent) {
        sheet.arc(&arc, &mut names);
    }
    sheet.rings(mechanism, scene, marked);
    sheet.points(mechanism, scene);
    sheet.weight();
    sheet.legend(height, step, &strokes);
    sheet.svg.finish()
}

/// Notes on the drawing.
fn caption(mechanism: &Mechanism, scene: &Scene, given: &str) -> String {
    let mut text = "at the initial state".to_owned();
    if !given.is_empty() {
        let _ = write!(text, ", with {given}");
    }
    if !scene.consistent {
        text.push_str("; it does not satisfy the position constraints");
    }
    let named = mechanism.points.iter().zip(&scene.points);
    let missing = named.filter(|(_, place)| place.is_none());
    let missing: Vec<&str> = missing.map(|(point, _)| point.name.as_str()).collect();
    if !missing.is_empty() {
        let missing = missing.join(", ");
        // Writing to a string cannot fail.
        let _ = write!(text, "; not drawn (position not finite): {missing}");
    }
    text
}

/// The largest of length, width and height, including the extent along the line of sight.
fn size(places: impl Iterator<Item = Vector>) -> f64 {
    let sizes = spans(places).map(|[low, high]| high - low);
    sizes.into_iter().fold(0.0, f64::max)
}

fn tips(axes: &Axes, extent: f64) -> [Vector; 3] {
    axes.directions
        .map(|axis| add(axes.at, AXIS * extent, axis))
}

/// The largest of 1, 2, 5, 10, … that is not larger.
fn round_number(value: f64) -> f64 {
    let power = 10.0_f64.powf(value.log10().floor());
    let mut steps = [5.0, 2.0].map(|step| step * power).into_iter();
    steps.find(|&step| step <= value).unwrap_or(power)
}

impl Sheet<'_> {
    fn place(&self, place: Vector) -> [f64; 2] {
        let [right, up] = self.view.seen(place);
        [
            (right - self.corner[0]) * self.scale,
            (self.corner[1] - up) * self.scale,
        ]
    }

    /// A text, moved into the sheet where it would cross an edge.
    fn text(&mut self, [x, y]: [f64; 2], class: &str, anchor: &str, content: &str) {
        let room = WIDTH - 2.0 * PAD;
        let width = svg::width(content, TEXT_SIZE).min(room);
        let before = match anchor {
            "start" => 0.0,
            "middle" => width / 2.0,
            _ => width,
        };
        let x = x.clamp(PAD + before, WIDTH - PAD - width + before);
        let y = y.clamp(TEXT_SIZE, self.height - PAD);
        let text = svg::text([x, y]).with("class", class);
        let text = svg::shortened(text.with("text-anchor", anchor), content, TEXT_SIZE, room);
        self.svg.put(&text);
    }

    fn path(&mut self, class: &str, places: &[[f64; 2]], about: &str) {
        let line = svg::polyline(places.iter().copied());
        self.svg.put(&svg::path(class, &line).titled(about));
    }

    fn stroke(&mut self, stroke: &Stroke) {
        let corners = self.places(&stroke.corners);
        self.path(stroke.class, &corners, &stroke.about);
    }

    fn places(&self, places: &[Vector]) -> Vec<[f64; 2]> {
        places.iter().map(|&place| self.place(place)).collect()
    }

    fn dot(&mut self, class: &str, place: [f64; 2], radius: f64) {
        self.svg.put(&circle(class, place, radius).empty());
    }

    /// Axes with the names of their frames beyond the steepest tip.
    fn axes(&mut self, axes: &Axes, extent: f64) {
        let from = self.place(axes.at);
        let tips = tips(axes, extent).map(|tip| self.place(tip));
        for (tip, colour) in tips.iter().zip(AXIS_COLOURS) {
            self.path(&format!("axis {colour}"), &[from, *tip], &axes.names);
        }
        let rise = |tip: &[f64; 2]| (tip[1] - from[1]).abs();
        let steepest = tips.into_iter().max_by(|a, b| rise(a).total_cmp(&rise(b)));
        if let Some([x, y]) = steepest {
            let beyond = if y > from[1] { 13.0 } else { -5.0 };
            self.text([x, y + beyond], "small soft halo", "middle", &axes.names);
        }
    }

    /// Draws the arc of an angle. Its label is placed at its start, outside the arc, below any label already there.
    fn arc(&mut self, arc: &Arc, names: &mut Vec<[f64; 2]>) {
        let corners = self.places(&arc.corners);
        let from = arc.from.map(|end| self.place(end));
        self.path("from", &from, "");
        self.path("angle", &corners, &arc.name);
        let [x, mut y] = from[1];
        let last = corners.last().map_or(x, |[x, _]| *x);
        let (anchor, side) = aside(last > x, 5.0);
        let [width, height] = NAME_SIZE;
        let meets = |y: f64| {
            move |name: &[f64; 2]| (name[0] - x).abs() < width && (name[1] - y).abs() < height
        };
        while names.iter().any(meets(y)) {
            y += height;
        }
        names.push([x, y]);
        let place = [x + side, y + 4.0];
        self.text(place, "small halo angle-name", anchor, &arc.name);
    }

    /// Points and their names, with those of the bodies whose centres they are.
    fn points(&mut self, mechanism: &Mechanism, scene: &Scene) {
        let mut names: Vec<Named> = Vec::new();
        for (id, point) in mechanism.points.entries() {
            let Some(at) = scene.points[id].map(|place| self.place(place)) else {
                continue;
            };
            let bodies = mechanism.bodies.iter();
            let mut bodies = bodies.filter(|body| body.centre == id && body.has_place());
            if bodies.clone().any(|body| body.inertia.is_none()) {
                self.dot("mass", at, MASS_RADIUS);
            } else {
                self.dot("point", at, POINT_RADIUS);
            }
            let name = match bodies.next() {
                Some(body) => format!("{} ({})", point.name, body.name),
                None => point.name.clone(),
            };
            name_at(&mut names, at, Some(name));
        }
        for ([x, y], names) in names {
            let (anchor, side) = aside(x > 0.6 * WIDTH, 9.0);
            self.text([x + side, y + 14.0], "name halo", anchor, &names.join(", "));
        }
    }

    /// Rings around the locations of names; names that meet are written together.
    fn rings(&mut self, mechanism: &Mechanism, scene: &Scene, marked: &[&str]) {
        let mut rings: Vec<Named> = Vec::new();
        for &name in marked {
            let points = home(mechanism, name).into_iter();
            let places = points.filter_map(|point| Some(self.place(scene.points[point]?)));
            for (index, at) in places.enumerate() {
                // A name stands at its first location alone.
                name_at(&mut rings, at, (index == 0).then(|| name.to_owned()));
            }
        }
        for (at @ [x, y], names) in rings {
            let ring = circle("ring c1", at, RING).with("fill", "none");
            self.svg.put(&ring.with("stroke-width", 4).empty());
            if !names.is_empty() {
                let place = [x + 0.8 * RING, y - RING];
                self.text(place, "name halo", "start", &names.join(", "));
            }
        }
    }

    /// The direction of the weight, in the upper right corner.
    fn weight(&mut self) {
        let Some(down) = self.view.down else {
            return;
        };
        let [right, up] = self.view.seen(down);
        let tail @ [x, y] = ARROW_TAIL;
        let along = |s: f64, aside: f64| {
            let (across, down) = (s * right + aside * up, aside * right - s * up);
            [x + ARROW * across, y + ARROW * down]
        };
        // Seen from above, the weight points into the paper.
        if dot([right, up, 0.0], [right, up, 0.0]) > 0.01 {
            self.path("arrow", &[tail, along(1.0, 0.0)], "weight");
            let head = [along(0.78, 0.1), along(1.0, 0.0), along(0.78, -0.1)];
            self.path("arrow", &head, "weight");
            let name = [x + ARROW_NAME[0], y + ARROW_NAME[1]];
            self.text(name, "small", "start", "weight");
        }
    }

    /// The legend, with a scale.
    fn legend(&mut self, height: f64, step: f64, strokes: &[Stroke]) {
        let [first, second, third] = LEGEND_LINES.map(|line| height - line);
        let mut x = EDGE;
        let mut symbol = first - SYMBOL_RISE;
        for (name, colour) in ["x", "y", "z"].into_iter().zip(AXIS_COLOURS) {
            let line = [[x, symbol], [x + LEGEND_AXIS, symbol]];
            self.path(&format!("axis {colour}"), &line, "");
            self.text([x + LEGEND_AXIS_NAME, first], "small", "start", name);
            x += LEGEND_AXIS_PITCH;
        }
        let about = "axes of a frame, with its name at a tip";
        self.text([x, first], "small", "start", about);
        symbol = second - SYMBOL_RISE;
        for (class, radius, [x, text], about) in [
            (
                "point",
                POINT_RADIUS,
                LEGEND_POINT,
                "point (centre of a body)",
            ),
            ("mass", MASS_RADIUS, LEGEND_MASS, "point mass"),
        ] {
            self.dot(class, [x, symbol], radius);
            self.text([text, second], "small", "start", about);
        }
        let hints = [
            ("wheel", "blue: a rolling body through its contact"),
            (
                "body",
                "yellow: the homogeneous ellipsoid of a body's mass and inertia",
            ),
        ];
        let is_drawn = |class: &str| strokes.iter().any(|stroke| stroke.class == class);
        let hints: Vec<&str> = (hints.into_iter())
            .filter_map(|(class, text)| is_drawn(class).then_some(text))
            .collect();
        self.text([EDGE, third], "small", "start", &hints.join("; "));
        let (bar, right) = (step * self.scale, WIDTH - EDGE);
        self.path("arrow", &[[right - bar, symbol], [right, symbol]], "");
        let scale = format!("{} m", round_text(step));
        self.text([right, first], "small", "end", &scale);
    }
}

/// A position with its names.
type Named = ([f64; 2], Vec<String>);

/// Names that are close to each other are written together.
fn name_at(names: &mut Vec<Named>, [x, y]: [f64; 2], name: Option<String>) {
    let is_close = |named: &&mut Named| (x - named.0[0]).hypot(y - named.0[1]) < CLOSE;
    match names.iter_mut().find(is_close) {
        Some((_, names)) => names.extend(name),
        None => names.push(([x, y], name.into_iter().collect())),
    }
}

/// Anchor of a text and its distance from a point, to the left or to the right of it.
const fn aside(is_left: bool, distance: f64) -> (&'static str, f64) {
    if is_left {
        ("end", -distance)
    } else {
        ("start", distance)
    }
}

fn circle(class: &str, [x, y]: [f64; 2], radius: f64) -> Element {
    let circle = Element::new("circle").with("class", class);
    circle.lengths([("cx", x), ("cy", y)]).with("r", radius)
}

/// A round number of any magnitude.
fn round_text(step: f64) -> String {
    // Rounding may leave further digits.
    let digit = format!("{step:.0e}");
    match digit.parse::<f64>() {
        Ok(number) if (1e-3..1e5).contains(&number) => number.to_string(),
        _ => digit,
    }
}
