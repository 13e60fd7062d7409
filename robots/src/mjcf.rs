//! MJCF: bodies within bodies, with joints and geoms, and defaults by class.

mod actuators;
mod compiler;
mod corrected;
mod defaults;
mod equality;
mod geoms;
mod joints;
mod law;
mod meshes;
mod orientation;
mod replicate;
mod schema;
mod tendons;

use std::collections::{BTreeMap, BTreeSet};

use appell_spec::Code;

use crate::includes::Whole;
use crate::inertia::Inertia;
use crate::mass;
use crate::model::{LeftOut, Link, Robot};
use crate::options::Options;
use crate::rotation::{Pose, Rotation, Vector};
use crate::without::Without;
use crate::xml::{Element, Findings, Span, children, elements, exactly, no_such, number, tag};

use compiler::{Compiler, InertiaFrom};
pub use corrected::{Amount, Change, Corrected, Number, corrected};
use defaults::{Defaults, Given};
use equality::Equality;
pub(crate) use replicate::expanded;
use schema::has;

const GRAVITY: Vector = [0.0, 0.0, -9.81];

/// Sections that are read elsewhere.
const ELSEWHERE: &str = "compiler option default asset worldbody equality tendon actuator size statistic visual \
                         extension deformable";
/// Elements of a body that are read separately.
const READ: &str = "joint inertial freejoint";
/// Elements that change the tree, and are not read.
const NOT_YET: &str = "replicate composite flexcomp attach";

/// State that all parts of the reader share.
pub(crate) struct Reader<'x, 'f> {
    findings: &'f Findings,
    compiler: Compiler,
    defaults: Defaults<'x>,
    links: Vec<Link>,
    /// Links by the names of their joints with an axis.
    joint_links: BTreeMap<String, usize>,
    /// Names of bodies and joints.
    names: BTreeSet<(&'static str, String)>,
    /// Link and pose of sites.
    sites: BTreeMap<String, (Option<usize>, Pose)>,
    left_out: Vec<LeftOut>,
    /// Geoms that could collide with others.
    touching: Vec<Span>,
    /// Whether masses of static bodies count as well.
    all_count: bool,
    /// Whether actuators are read.
    actuators: bool,
    root: Element<'x>,
    /// The file with its includes.
    whole: &'f Whole<'f>,
}

/// A place in the tree from which bodies are read.
#[derive(Clone, Copy)]
struct Level<'x> {
    parent: Option<usize>,
    /// Of frames between the parent and here.
    pose: Pose,
    class: Option<&'x str>,
}

/// A child of a body, direct or within frames.
struct Held<'x> {
    element: Element<'x>,
    /// Pose and child class of the enclosing frames.
    pose: Pose,
    class: Option<&'x str>,
}

/// Reads `<mujoco>`.
pub(crate) fn read(
    root: Element<'_>,
    findings: &Findings,
    whole: &Whole<'_>,
    options: &Options,
) -> Robot {
    let mut reader = Reader {
        findings,
        compiler: Compiler::read(root, findings),
        defaults: Defaults::new(root, findings),
        links: Vec::new(),
        joint_links: BTreeMap::new(),
        names: BTreeSet::new(),
        sites: BTreeMap::new(),
        left_out: Vec::new(),
        touching: Vec::new(),
        all_count: options.floating,
        actuators: options.actuators,
        root,
        whole,
    };
    reader.all_count |= reader.compiler.total_mass.is_some();
    schema::check(root, findings, &mut reader.left_out);
    let ground = Level {
        parent: None,
        pose: Pose::IDENTITY,
        class: None,
    };
    for section in elements(root) {
        match section.tag_name().name() {
            "worldbody" => reader.level(section, ground),
            name if has(NOT_YET, name) => reader.not_yet(section),
            name if has(ELSEWHERE, name) => {}
            name => reader.leave_out_of(name, section),
        }
    }
    if reader.links.is_empty() {
        let message = "the file has no body";
        let help = "an MJCF has `<worldbody>` with `<body>`s";
        findings.error(Code::MissingSection, tag(root), message, help);
    }
    if let Some(total) = reader.compiler.total_mass {
        reader.scale_to(total);
    }
    let mut tendons = reader.tendons();
    let mut drives = reader.drives(&mut tendons);
    let settled = mass::settle(&mut reader.links, &tendons);
    let servos = drives.as_deref_mut().unwrap_or_default();
    let damped = mass::damp(servos, &reader.links, &tendons);
    for (done, what, help) in [
        (settled, "springdamper", "write `stiffness` and `damping`"),
        (damped, "dampratio", "write `kv`"),
    ] {
        if !done {
            let message = format!(
                "`{what}` is limited to {} degrees of freedom",
                mass::MOST_FREEDOMS
            );
            findings.error(Code::LimitExceeded, tag(root), message, help);
        }
    }
    let is_off = |flag: &str| schema::disabled(root, flag);
    let free = is_off("equality") || is_off("constraint");
    let Equality {
        couplings,
        connections,
    } = if free || options.without.contains(&Without::Couplings) {
        Equality::default()
    } else {
        equality::read(root, &mut reader, &tendons)
    };
    if !(is_off("contact") || is_off("constraint")) {
        reader.leave_out_contacts();
    }
    let mut robot = Robot {
        name: root.attribute("model").unwrap_or("robot").to_owned(),
        gravity: if is_off("gravity") {
            [0.0; 3]
        } else {
            gravity(root, findings)
        },
        links: reader.links,
        couplings,
        tendons,
        connections,
        driven: driven(root),
        drives,
        left_out: reader.left_out,
    };
    for one in switched_off(&is_off) {
        one.apply(&mut robot);
    }
    robot
}

/// Properties that are disabled by flags of `option`.
fn switched_off(is_off: &dyn Fn(&str) -> bool) -> Vec<Without> {
    let passive = is_off("passive");
    let (springs, dampers) = (passive || is_off("spring"), passive || is_off("damper"));
    let constraint = is_off("constraint");
    let all = [
        (springs, Without::Springs),
        (dampers, Without::Damping),
        // With springs and dampers disabled, there are no passive forces.
        (springs && dampers, Without::Compensation),
        (constraint || is_off("frictionloss"), Without::Friction),
        (constraint || is_off("limit"), Without::Limits),
    ];
    all.into_iter()
        .filter_map(|(off, what)| off.then_some(what))
        .collect()
}

/// Joints that actuators drive, by tendons or by themselves.
fn driven(root: Element<'_>) -> BTreeSet<String> {
    let sections = ["actuator", "tendon"].into_iter();
    let drives = sections.flat_map(|section| children(root, section));
    let named = drives.flat_map(|drive| drive.descendants());
    named
        .filter_map(|element| element.attribute("joint").map(str::to_owned))
        .collect()
}

/// `<option gravity>`; later elements add to earlier ones.
fn gravity(root: Element<'_>, findings: &Findings) -> Vector {
    let given = children(root, "option").filter_map(|option| option.attribute_node("gravity"));
    let read = given.filter_map(|given| exactly(findings, &given, "gravity, x y z,"));
    read.last().unwrap_or(GRAVITY)
}

impl<'x> Reader<'x, '_> {
    fn leave_out(&mut self, what: String, element: Element<'_>) {
        let keys = ["name", "joint", "class"];
        let name = keys.into_iter().find_map(|key| element.attribute(key));
        self.left_out.push(LeftOut {
            what,
            name: name.map(str::to_owned),
            effect: schema::effect(element),
            place: tag(element),
        });
    }

    /// Leaves out an element of a section, or a whole section.
    fn leave_out_of(&mut self, section: &str, element: Element<'_>) {
        if element.tag_name().name() != section {
            let what = format!("{section}/{}", element.tag_name().name());
            return self.leave_out(what, element);
        }
        let mut empty = true;
        for inner in elements(element) {
            self.leave_out_of(section, inner);
            empty = false;
        }
        if empty {
            self.leave_out(section.to_owned(), element);
        }
    }

    /// Contacts of geoms, which a spec would have to describe otherwise.
    fn leave_out_contacts(&mut self) {
        let touching = std::mem::take(&mut self.touching);
        if touching.len() < 2 {
            return;
        }
        self.left_out
            .extend(touching.into_iter().map(|place| LeftOut {
                what: "contacts of geoms".to_owned(),
                name: None,
                effect: Some(schema::TOUCH),
                place,
            }));
    }

    fn not_yet(&self, element: Element<'_>) {
        let name = element.tag_name().name();
        let help = "let MuJoCo write out the bodies that it makes, and import `flat.xml`: \
                    `python -c \"import mujoco; s = mujoco.MjSpec.from_file('FILE'); s.compile(); \
                    open('flat.xml', 'w').write(s.to_xml())\"`";
        let message =
            format!("`{name}` changes the tree of bodies, and `import` does not read it yet");
        self.findings
            .error(Code::NotAllowedHere, tag(element), message, help);
    }

    /// Reads the children of a body, a frame or the world.
    fn level(&mut self, element: Element<'x>, level: Level<'x>) {
        for inner in elements(element) {
            match inner.tag_name().name() {
                "body" => self.body(inner, level),
                "site" => self.site_at(inner, level),
                "geom" => self.touch(inner, level.class),
                "frame" => {
                    let pose = level.pose.then(self.own_pose(inner));
                    let class = self.class(inner, "childclass").or(level.class);
                    self.level(
                        inner,
                        Level {
                            pose,
                            class,
                            ..level
                        },
                    );
                }
                name if has(NOT_YET, name) => self.not_yet(inner),
                name if has(READ, name) && level.parent.is_none() => self.findings.error(
                    Code::NotAllowedHere,
                    tag(inner),
                    format!("the world holds a `{name}`"),
                    "put it inside a `<body>`, together with its geoms",
                ),
                name if has(READ, name) => {}
                name => self.leave_out(name.to_owned(), inner),
            }
        }
    }

    /// The class that an attribute names; a missing one is an error.
    fn class(&self, element: Element<'x>, key: &str) -> Option<&'x str> {
        let given = element.attribute_node(key)?;
        let name = given.value();
        if !self.defaults.knows(name) {
            let (at, known) = (given.range_value(), self.defaults.names());
            let help = "classes are defined by `<default class=\"…\">`";
            self.findings
                .add(no_such("default class", name, at, known, help));
            return None;
        }
        Some(name)
    }

    /// The attributes of an element; `kinds` are the names of elements of its kind in classes.
    fn given(
        &self,
        element: Element<'x>,
        kinds: &'static str,
        class: Option<&'x str>,
    ) -> Given<'_, 'x> {
        Given {
            element,
            kinds,
            class,
            defaults: &self.defaults,
            findings: self.findings,
        }
    }

    /// Position and orientation of an element of a kind without defaults.
    fn own_pose(&self, element: Element<'x>) -> Pose {
        self.pose(&self.given(element, "", None))
    }

    /// Position and orientation of an element.
    fn pose(&self, given: &Given<'_, 'x>) -> Pose {
        let position = given.exactly("pos", "a position, x y z,");
        let angles = &self.compiler.angles;
        // An orientation of the element takes precedence over one of its class in another form.
        let own = angles.orientation(&|key| given.element.attribute_node(key), self.findings);
        let rotation =
            own.or_else(|| angles.orientation(&|key| given.attribute(key), self.findings));
        Pose {
            rotation: rotation.unwrap_or(Rotation::IDENTITY),
            position: position.unwrap_or_default(),
        }
    }

    fn body(&mut self, element: Element<'x>, level: Level<'x>) {
        let pose = level.pose.then(self.own_pose(element));
        let class = self.class(element, "childclass").or(level.class);
        let name = element.attribute("name");
        let name = name.map_or_else(|| format!("body{}", self.links.len() + 1), str::to_owned);
        self.refuse_twice("bodies", &name, tag(element));
        let mut held = Vec::new();
        self.hold(element, Pose::IDENTITY, class, &mut held);
        let joints = self.joints(&held, &name);
        for joint in &joints {
            self.refuse_twice("joints", &joint.name, joint.place.clone());
        }
        let counts = self.all_count || !joints.is_empty() || self.moves(level.parent);
        let inertia = self.inertia(element, &name, &held, counts);
        let carried = number(self.findings, element, "gravcomp");
        let own = Link::fixed(name, level.parent, pose, tag(element));
        let from = self.links.len();
        let here = own.moved_by(joints, &mut self.links);
        for (index, link) in self.links.iter().enumerate().skip(from) {
            if let Some(joint) = link.joint.as_ref().filter(|joint| joint.motion.has_axis()) {
                self.joint_links.insert(joint.name.clone(), index);
            }
        }
        self.links[here].inertia = inertia;
        self.links[here].carried = carried.unwrap_or_default();
        let inside = Level {
            parent: Some(here),
            pose: Pose::IDENTITY,
            class,
        };
        self.level(element, inside);
    }

    /// Whether a link or one of its ancestors has a joint.
    fn moves(&self, link: Option<usize>) -> bool {
        let mut behind = std::iter::successors(link, |&link| self.links[link].parent);
        behind.any(|link| self.links[link].joint.is_some())
    }

    /// Refuses duplicate names of one kind.
    fn refuse_twice(&mut self, kind: &'static str, name: &str, place: Span) {
        if !self.names.insert((kind, name.to_owned())) {
            let message = format!("there are two {kind} `{name}`");
            self.findings
                .error(Code::DuplicateName, place, message, "rename one of them");
        }
    }

    /// Records the pose of a site by its name; sites that are not referenced are only drawn.
    fn site_at(&mut self, element: Element<'x>, level: Level<'x>) {
        let class = self.class(element, "class").or(level.class);
        let pose = level
            .pose
            .then(self.pose(&self.given(element, "site", class)));
        if let Some(name) = element.attribute("name") {
            self.sites.insert(name.to_owned(), (level.parent, pose));
        }
        self.leave_out("site".to_owned(), element);
    }

    /// Collects the children of a body or a frame in the order of the file.
    fn hold(
        &self,
        holder: Element<'x>,
        pose: Pose,
        class: Option<&'x str>,
        held: &mut Vec<Held<'x>>,
    ) {
        for element in elements(holder) {
            if element.has_tag_name("frame") {
                let class = self.class(element, "childclass").or(class);
                self.hold(element, pose.then(self.own_pose(element)), class, held);
            } else {
                held.push(Held {
                    element,
                    pose,
                    class,
                });
            }
        }
    }

    /// The inertia of a body in its frame.
    fn inertia(
        &mut self,
        body: Element<'x>,
        name: &str,
        held: &[Held<'x>],
        counts: bool,
    ) -> Inertia {
        let is_one = |held: &&Held<'_>| held.element.has_tag_name("inertial");
        // The last one holds.
        let inertial = held.iter().rfind(is_one);
        let from = self.compiler.inertia_from;
        let inertia = match inertial {
            Some(inertial) if from != InertiaFrom::Geoms => {
                self.inertial(inertial.element).placed(inertial.pose)
            }
            None if from == InertiaFrom::Inertial => Inertia::NONE,
            _ => self.of_geoms(held, counts),
        };
        let inertia = self.compiler.corrected(inertia).without_rounding();
        if let Some(reason) = inertia.impossible() {
            let message = format!("no body can have the inertia of `{name}`: {reason}");
            let help = "it is taken as it is; the motion is right wherever the mass matrix is positive definite";
            let place = tag(inertial.map_or(body, |inertial| inertial.element));
            self.findings
                .warning(Code::NotPhysical, place, message, help);
        }
        inertia
    }

    fn inertial(&self, element: Element<'x>) -> Inertia {
        let given = self.given(element, "", None);
        let mass = given.exactly("mass", "a mass");
        let diagonal = given.exactly("diaginertia", "a diagonal, xx yy zz,");
        let full = given.exactly("fullinertia", "an inertia, xx yy zz xy xz yz,");
        if !element.has_attribute("mass") {
            let (message, help) = ("`inertial` has no `mass`", "write `mass=\"1\"`");
            self.findings
                .error(Code::MissingKey, tag(element), message, help);
        }
        let tensor = full.or_else(|| diagonal.map(|[xx, yy, zz]| [xx, yy, zz, 0.0, 0.0, 0.0]));
        Inertia {
            mass: mass.map_or(0.0, |[mass]| mass),
            centre: [0.0; 3],
            tensor: tensor.unwrap_or_default(),
        }
        .placed(self.pose(&given))
    }

    /// Scales all masses and inertias.
    fn scale_to(&mut self, total: f64) {
        let sum: f64 = self.links.iter().map(|link| link.inertia.mass).sum();
        if sum > 0.0 {
            for link in &mut self.links {
                link.inertia.mass *= total / sum;
                link.inertia.tensor = link.inertia.tensor.map(|entry| entry * total / sum);
            }
        }
    }
}
