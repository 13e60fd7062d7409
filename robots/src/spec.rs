//! The spec of a robot.

mod bodies;
mod connections;
mod drives;
mod joints;
mod remarks;
mod resistances;
mod selected;
mod tendons;
mod units;

use appell_spec::limits::{MAX_ITEMS, MAX_SENTENCE};

use crate::assembly::Configuration;
use crate::dictionary::{BodyName, Dictionary, JointName};
use crate::failure::Failure;
use crate::format::Format;
use crate::letters::{Numbers, Parameter};
use crate::loops::Equations;
use crate::model::{Link, Motion, Robot};
use crate::names::{Names, short};
use crate::options::Options;
use crate::patterns;
use crate::rotation::Rotation;
use crate::table::{Item, Section, quoted};
use crate::tree::{Body, Part, Tree};
use crate::without::Without;
use crate::xml::Span;

/// Names of bodies and joints in the spec.
struct Called {
    /// By link.
    links: Vec<String>,
    /// The coordinate, by body; the common prefix if a body has several.
    coordinates: Vec<String>,
    /// For bodies with several: those of the position, if it varies, and of the quaternion.
    several: Vec<Vec<String>>,
    /// The frame, by body.
    frames: Vec<String>,
    /// The reference point of the body.
    points: Vec<String>,
}

/// The text of a spec while it is written.
pub(crate) struct Writer<'a> {
    links: &'a [Link],
    tree: &'a Tree,
    called: Called,
    /// The namespace of quantities in expressions.
    quantities: Names,
    /// That of frames, points and bodies, which are called by their links.
    places: Names,
    numbers: Numbers<'a>,
    /// Names, points and masses of drives that have inertia, but no weight.
    weightless: Vec<(String, String, String)>,
    /// The initial configuration, if it differs from that of the file.
    start: Option<&'a Configuration>,
    /// Whether joints have inputs of their own, since actuators are not read.
    driven: bool,
    /// What actuators exert, by body.
    torques: Vec<drives::Exerted>,
    dictionary: Dictionary,
    coordinates: Section,
    inputs: Section,
    frames: Section,
    points: Section,
    bodies: Section,
    constraints: Section,
    speeds: Section,
    loads: Section,
    outputs: Section,
}

/// A spec, and how it came about.
pub(crate) struct Written {
    pub(crate) text: String,
    /// Where lines begin, and where in the file of the robot they come from.
    pub(crate) lines: Vec<(usize, Span)>,
    /// The first selected name that matched no number.
    pub(crate) unknown: Option<Failure>,
    pub(crate) dictionary: Dictionary,
}

/// Writes the spec of a robot.
pub(crate) fn write(
    file: &str,
    format: Format,
    robot: &Robot,
    tree: &Tree,
    equations: &Equations,
    options: &Options,
) -> Written {
    // The path may not be valid where the spec is read.
    let file = file.rsplit('/').next().unwrap_or(file);
    let mut writer = Writer::new(robot, tree, options);
    writer.start = equations.start.as_ref();
    writer.declare(robot);
    let letters = writer.gravity(robot.gravity);
    writer.mark(&(0..0));
    for (index, body) in tree.bodies.iter().enumerate() {
        writer.frame(index);
        writer.point(index);
        writer.body(index);
        writer.mark(&robot.links[body.link].place);
        writer.joint(index);
        writer.mark(&body.joint.place);
    }
    let count = tree
        .bodies
        .iter()
        .map(|body| 2 + body.parts.len())
        .sum::<usize>()
        + tree.ground.len();
    let all_points = count <= MAX_ITEMS && !options.without.contains(&Without::Points);
    if all_points {
        writer.links_on_the_ground();
    }
    writer.links_on_bodies(all_points);
    writer.mark(&(0..0));
    writer.connections(&robot.connections, equations);
    writer.couplings(&robot.couplings, equations);
    writer.speeds(equations);
    writer.carried(robot.gravity, &letters);
    writer.tendons(&robot.tendons);
    writer.drives(robot);
    writer.ends();
    writer.mark(&(0..0));
    let name = Names::default().new_one(&robot.name);
    let mut text = remarks::head(file, format.word(), robot, tree);
    let mut lines = Vec::new();
    writer.mechanism(&name, &robot.name, file, &mut text, &mut lines);
    remarks::left_out(&robot.left_out, options, &mut text);
    remarks::late(robot, &mut text);
    writer.dictionary.entries = std::mem::take(&mut writer.numbers.entries);
    Written {
        text,
        lines,
        unknown: writer.numbers.unknown(),
        dictionary: writer.dictionary,
    }
}

impl<'a> Writer<'a> {
    fn new(robot: &'a Robot, tree: &'a Tree, options: &'a Options) -> Self {
        let mut places = Names::without(&["ground", "O"]);
        let mut quantities = Names::default();
        let links: Vec<String> = robot
            .links
            .iter()
            .map(|link| places.new_one(&short(&link.name)))
            .collect();
        let joints = tree
            .bodies
            .iter()
            .map(|body| quantities.new_one(&short(&body.joint.name)));
        let coordinates: Vec<String> = joints.collect();
        let several = tree.bodies.iter().zip(&coordinates).map(|(body, q)| {
            let endings: &[&str] = match body.joint.motion {
                Motion::Free => &["x", "y", "z", "qw", "qx", "qy", "qz"],
                Motion::Ball => &["qw", "qx", "qy", "qz"],
                Motion::Turning | Motion::Sliding => &[],
            };
            let all = endings
                .iter()
                .map(|ending| quantities.new_one(&format!("{q}_{ending}")));
            all.collect()
        });
        let several = several.collect();
        Self {
            links: &robot.links,
            tree,
            called: Called {
                links,
                coordinates,
                several,
                frames: Vec::new(),
                points: Vec::new(),
            },
            quantities,
            places,
            numbers: Numbers::new(&options.letters),
            weightless: Vec::new(),
            start: None,
            driven: robot.drives.is_none(),
            torques: Vec::new(),
            dictionary: Dictionary::default(),
            coordinates: Section::default(),
            inputs: Section::default(),
            frames: Section::default(),
            points: Section::default(),
            bodies: Section::default(),
            constraints: Section::default(),
            speeds: Section::default(),
            loads: Section::default(),
            outputs: Section::default(),
        }
    }

    /// The frame of the parent of a body.
    fn frame_of(&self, parent: Option<usize>) -> String {
        parent.map_or("ground".to_owned(), |parent| {
            self.called.frames[parent].clone()
        })
    }

    /// The point relative to which children of a body are positioned.
    fn point_of(&self, parent: Option<usize>) -> String {
        parent.map_or("O".to_owned(), |parent| self.called.points[parent].clone())
    }

    /// Records the source, in the robot's file, of the items that were added since the last call.
    fn mark(&mut self, place: &Span) {
        for section in [
            &mut self.coordinates,
            &mut self.inputs,
            &mut self.frames,
            &mut self.points,
            &mut self.bodies,
            &mut self.constraints,
            &mut self.speeds,
            &mut self.loads,
            &mut self.outputs,
        ] {
            section.mark(place);
        }
    }

    /// Pseudo-velocities of the independent coordinates.
    fn speeds(&mut self, equations: &Equations) {
        let mut followers: Vec<Vec<usize>> = vec![Vec::new(); self.tree.bodies.len()];
        for follower in equations.followers() {
            followers[follower.body].push(follower.component);
        }
        for (index, body) in self.tree.bodies.iter().enumerate() {
            if !body.joint.motion.has_axis() {
                self.several_speeds(index, &followers[index]);
            } else if followers[index].is_empty() {
                let q = &self.called.coordinates[index];
                let name = self.quantities.new_one(&format!("v_{q}"));
                let item = Item::default().text("value", &format!("dot({q})"));
                let rate = units::Units::of(body.joint.motion).rate;
                self.speeds.add(&name, &item.text("unit", rate));
                self.joint_name(index, name);
            } else {
                let rate = format!("dot({})", self.called.coordinates[index]);
                self.joint_name(index, rate);
            }
            self.mark(&body.joint.place);
        }
    }

    /// Records the names of a joint with an axis.
    fn joint_name(&mut self, index: usize, velocity: String) {
        self.dictionary.joints.push(JointName {
            name: self.tree.bodies[index].joint.name.clone(),
            coordinate: self.called.coordinates[index].clone(),
            velocity,
            torque: None,
        });
    }

    /// Records the names of bodies, and declares the names of all numbers that patterns can select.
    fn declare(&mut self, robot: &Robot) {
        self.dictionary.gravity = robot.gravity;
        for (index, link) in robot.links.iter().enumerate() {
            let body = self.tree.body_of[index].map(|body| self.tree.bodies[body].link);
            let body = body.map_or("ground", |body| &self.called.links[body]);
            if link.written {
                self.dictionary.bodies.push(BodyName {
                    name: link.name.clone(),
                    body: body.to_owned(),
                    axes: self.axes(index).0,
                });
            }
        }
        let patterns = &mut self.numbers.patterns;
        let names = |parts: &[Part]| -> Vec<String> {
            let parts = parts.iter().filter(|part| robot.links[part.link].written);
            parts
                .map(|part| robot.links[part.link].name.clone())
                .collect()
        };
        for name in names(&self.tree.ground) {
            patterns.declare(&name, patterns::OF_BODIES);
        }
        for body in &self.tree.bodies {
            let link = &robot.links[body.link];
            if link.written {
                patterns.declare_body(&link.name, names(&body.parts));
            }
            patterns.declare(&body.joint.name, patterns::OF_JOINTS);
        }
        for drive in robot.drives.iter().flatten() {
            patterns.declare(&drive.name, drive.attributes());
        }
        patterns.declare(patterns::OPTION, &["gravity.x", "gravity.y", "gravity.z"]);
    }

    /// From the axes of the body of a link to those of the link.
    fn axes(&self, link: usize) -> Rotation {
        let Some(body) = self.tree.body_of[link] else {
            return Rotation::IDENTITY;
        };
        let mut turned = Rotation::IDENTITY;
        let mut at = link;
        while let (None, Some(parent)) = (&self.links[at].joint, self.links[at].parent) {
            turned = self.links[at].pose.rotation.then(turned);
            at = parent;
        }
        turned.inverse().then(self.tree.bodies[body].own)
    }

    fn mechanism(
        &self,
        name: &str,
        title: &str,
        file: &str,
        text: &mut String,
        lines: &mut Vec<(usize, Span)>,
    ) {
        let mut mechanism = Section::default();
        let count = self.tree.bodies.len();
        let joints = if count == 1 { "joint" } else { "joints" };
        mechanism.key("name", quoted(name));
        let title = sentence(&format!("{title}, {count} {joints}"));
        mechanism.key("title", quoted(&title));
        mechanism.key("source", quoted(&sentence(file)));
        let mut parameters = Section::default();
        for Parameter {
            name,
            value,
            unit,
            about,
            never_negative,
        } in &self.numbers.parameters
        {
            let item = Item::default()
                .raw("value", &crate::letters::plain(*value))
                .text("unit", unit)
                .text("about", &sentence(about));
            parameters.add(name, &item.raw_if(*never_negative, "at_least", "0"));
        }
        mechanism.write("mechanism", text, lines);
        for (title, section) in [
            ("parameters", &parameters),
            ("coordinates", &self.coordinates),
            ("inputs", &self.inputs),
            ("frames", &self.frames),
            ("points", &self.points),
            ("bodies", &self.bodies),
            ("constraints", &self.constraints),
            ("pseudo_velocities", &self.speeds),
            ("loads", &self.loads),
            ("outputs", &self.outputs),
        ] {
            section.write(title, text, lines);
        }
    }

    fn at(&self, index: usize) -> &'a Body {
        &self.tree.bodies[index]
    }
}

/// A sentence that is not too long.
fn sentence(text: &str) -> String {
    let mut sentence = appell_spec::foreign::sentence(text);
    sentence.truncate(sentence.floor_char_boundary(MAX_SENTENCE));
    sentence
}

/// An expression plus a number that is written with its sign.
fn plus(expression: &str, number: &str) -> String {
    match (expression, number) {
        (_, "0") => expression.to_owned(),
        ("0", _) => number.to_owned(),
        _ => number.strip_prefix('-').map_or_else(
            || format!("{expression} + {number}"),
            |number| format!("{expression} - {number}"),
        ),
    }
}

/// The difference of two expressions.
fn minus(expression: &str, other: &str) -> String {
    if other == "0" {
        return expression.to_owned();
    }
    let (sign, other) = match other.strip_prefix('-') {
        Some(other) if !is_sum(other) => ('+', other.to_owned()),
        _ if is_sum(other) => ('-', format!("({other})")),
        _ => ('-', other.to_owned()),
    };
    match (expression, sign) {
        ("0", '+') => other,
        ("0", _) => format!("-{other}"),
        _ => format!("{expression} {sign} {other}"),
    }
}

/// Whether an expression has several terms.
fn is_sum(expression: &str) -> bool {
    let mut depth = 0_i32;
    let signs = expression.match_indices(|c| "()[]+-".contains(c));
    signs.into_iter().any(|(at, sign)| {
        match sign {
            "(" | "[" => depth += 1,
            ")" | "]" => depth -= 1,
            // A sign between blanks, other than that of an exponent.
            _ => return depth == 0 && expression[..at].ends_with(' '),
        }
        false
    })
}

/// An expression that can be a factor or a base: a name or the rate of one as it is, all else in brackets.
fn operand(expression: &str) -> String {
    let rate = expression
        .strip_prefix("dot(")
        .and_then(|rest| rest.strip_suffix(')'));
    let name = rate.unwrap_or(expression);
    if name.contains(|c: char| !c.is_alphanumeric() && c != '_') {
        format!("({expression})")
    } else {
        expression.to_owned()
    }
}
