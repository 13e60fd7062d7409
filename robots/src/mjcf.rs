//! MJCF: bodies within bodies, with joints and geoms, and defaults by class.

mod defaults;
mod equality;
mod geoms;
mod joints;
mod meshes;
mod orientation;

use appell_spec::{Code, did_you_mean};

use crate::includes::Whole;
use crate::inertia::Inertia;
use crate::model::{LeftOut, Link, Robot};
use crate::rotation::{Pose, Rotation, Vector};
use crate::xml::{Element, Findings, child, children, elements, exactly, tag};

use defaults::Defaults;
use equality::Equality;
use orientation::Angles;

const GRAVITY: Vector = [0.0, 0.0, -9.81];

/// Sections that say nothing about masses and joints.
const ELSEWHERE: &[&str] = &["compiler", "option", "default", "worldbody", "equality"];
/// What stands in a body beside those that are read.
const READ: &[&str] = &["body", "joint", "geom", "inertial", "frame", "freejoint"];
/// Elements that change the tree, and are not read.
const NOT_YET: &[&str] = &["replicate", "composite", "flexcomp", "attach"];

/// How the file is to be read.
pub(crate) struct Compiler {
    pub(crate) angles: Angles,
    /// Whether a range makes a limit.
    autolimits: bool,
    inertia_from: InertiaFrom,
    /// Mass to which that of the whole robot is scaled.
    total_mass: Option<f64>,
}

/// Where the inertia of a body comes from.
#[derive(Clone, Copy, PartialEq, Eq)]
enum InertiaFrom {
    /// `inertial`, or the geoms where there is none.
    Either,
    Geoms,
    Inertial,
}

/// What all parts of the reader share.
pub(crate) struct Reader<'x, 'f> {
    findings: &'f Findings,
    compiler: Compiler,
    defaults: Defaults<'x>,
    links: Vec<Link>,
    left_out: Vec<LeftOut>,
    root: Element<'x>,
    /// The file, and those that it names.
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

/// Reads `<mujoco>`.
pub(crate) fn read(root: Element<'_>, findings: &Findings, whole: &Whole<'_>) -> Robot {
    let mut reader = Reader {
        findings,
        compiler: compiler(root, findings),
        defaults: Defaults::new(root, findings),
        links: Vec::new(),
        left_out: Vec::new(),
        root,
        whole,
    };
    let ground = Level {
        parent: None,
        pose: Pose::IDENTITY,
        class: None,
    };
    for section in elements(root) {
        match section.tag_name().name() {
            "worldbody" => reader.level(section, ground),
            name if NOT_YET.contains(&name) => reader.not_yet(section),
            name if ELSEWHERE.contains(&name) => {}
            name => reader.leave_out_section(section, name),
        }
    }
    if reader.links.is_empty() {
        findings.error(
            Code::MissingSection,
            tag(root),
            "the file has no body",
            "an MJCF has `<worldbody>` with `<body>`s",
        );
    }
    if let Some(total) = reader.compiler.total_mass {
        reader.scale_to(total);
    }
    let Equality {
        couplings,
        connections,
    } = equality::read(root, &mut reader);
    Robot {
        name: root.attribute("model").unwrap_or("robot").to_owned(),
        gravity: gravity(root, findings),
        links: reader.links,
        couplings,
        connections,
        driven: driven(root),
        left_out: reader.left_out,
    }
}

/// Joints that actuators drive, by tendons or by themselves.
fn driven(root: Element<'_>) -> Vec<String> {
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

fn compiler(root: Element<'_>, findings: &Findings) -> Compiler {
    let mut compiler = Compiler {
        angles: Angles::default(),
        autolimits: true,
        inertia_from: InertiaFrom::Either,
        total_mass: None,
    };
    for element in children(root, "compiler") {
        let word = |key: &str, words: &[&str]| -> Option<usize> {
            let given = element.attribute_node(key)?;
            let found = words.iter().position(|word| *word == given.value());
            if found.is_none() {
                findings.error(
                    Code::UnknownWord,
                    given.range_value(),
                    format!("`{key}` cannot be `{}`", appell_spec::shown(given.value())),
                    did_you_mean(given.value(), words.iter().copied(), || {
                        format!("write {}", words.join(" or "))
                    }),
                );
            }
            found
        };
        if let Some(unit) = word("angle", &["degree", "radian"]) {
            compiler.angles.degrees = unit == 0;
        }
        if let Some(on) = word("autolimits", &["false", "true"]) {
            compiler.autolimits = on == 1;
        }
        if let Some(from) = word("inertiafromgeom", &["auto", "true", "false"]) {
            compiler.inertia_from = [
                InertiaFrom::Either,
                InertiaFrom::Geoms,
                InertiaFrom::Inertial,
            ][from];
        }
        if word("coordinate", &["local", "global"]) == Some(1) {
            let help = "global coordinates were removed from the format: save the file anew with MuJoCo 2.3 or older";
            findings.error(
                Code::NotAllowedHere,
                tag(element),
                "`coordinate=\"global\"` is not read",
                help,
            );
        }
        if let Some(given) = element.attribute_node("eulerseq") {
            compiler.angles.read_sequence(&given, findings);
        }
        if let Some(given) = element.attribute_node("settotalmass")
            && let Some([total]) = exactly(findings, &given, "`settotalmass`")
            && total > 0.0
        {
            compiler.total_mass = Some(total);
        }
        for key in [
            "boundmass",
            "boundinertia",
            "balanceinertia",
            "inertiagrouprange",
        ] {
            if let Some(given) = element.attribute_node(key)
                && !["0", "false"].contains(&given.value())
            {
                let help = "masses and inertias are taken as they are in the file";
                findings.warning(
                    Code::NotAllowedHere,
                    given.range(),
                    format!("`{key}` is not applied"),
                    help,
                );
            }
        }
    }
    compiler
}

impl<'x> Reader<'x, '_> {
    fn leave_out(&mut self, what: String, element: Element<'_>) {
        let keys = ["name", "joint", "class"];
        let name = keys.into_iter().find_map(|key| element.attribute(key));
        self.left_out.push(LeftOut {
            what,
            name: name.map(str::to_owned),
            place: tag(element),
        });
    }

    fn leave_out_section(&mut self, section: Element<'_>, name: &str) {
        let mut empty = true;
        for element in elements(section) {
            self.leave_out(format!("{name}/{}", element.tag_name().name()), element);
            empty = false;
        }
        if empty {
            self.leave_out(name.to_owned(), section);
        }
    }

    fn not_yet(&self, element: Element<'_>) {
        let name = element.tag_name().name();
        let help = "write out the bodies that it makes; MuJoCo does so when it saves a model";
        self.findings.error(
            Code::NotAllowedHere,
            tag(element),
            format!("`{name}` changes the tree of bodies, and `import` does not read it yet"),
            help,
        );
    }

    /// What a body, a frame or the world holds.
    fn level(&mut self, element: Element<'x>, level: Level<'x>) {
        for inner in elements(element) {
            match inner.tag_name().name() {
                "body" => self.body(inner, level),
                "frame" => {
                    let pose = level.pose.then(self.pose(inner, None));
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
                name if NOT_YET.contains(&name) => self.not_yet(inner),
                name if READ.contains(&name) => {}
                name => self.leave_out(name.to_owned(), inner),
            }
        }
    }

    /// The class that an attribute names, which has to exist.
    fn class(&self, element: Element<'x>, key: &str) -> Option<&'x str> {
        let given = element.attribute_node(key)?;
        let name = given.value();
        if !self.defaults.knows(name) {
            self.findings.error(
                Code::UnknownReference,
                given.range_value(),
                format!("there is no default class `{}`", appell_spec::shown(name)),
                did_you_mean(name, self.defaults.names(), || {
                    "classes are defined by `<default class=\"…\">`".to_owned()
                }),
            );
            return None;
        }
        Some(name)
    }

    /// Position and orientation of an element.
    fn pose(
        &self,
        element: Element<'x>,
        defaults: Option<(&'static str, Option<&'x str>)>,
    ) -> Pose {
        let attribute = |key: &str| {
            let own = element.attribute_node(key);
            own.or_else(|| {
                defaults.and_then(|(kind, class)| self.defaults.attribute(kind, class, key))
            })
        };
        let position =
            attribute("pos").and_then(|given| exactly(self.findings, &given, "a position, x y z,"));
        // What the element says itself stands before what its class says otherwise.
        let own = self
            .compiler
            .angles
            .orientation(&|key| element.attribute_node(key), self.findings);
        let rotation = own.or_else(|| self.compiler.angles.orientation(&attribute, self.findings));
        Pose {
            rotation: rotation.unwrap_or(Rotation::IDENTITY),
            position: position.unwrap_or_default(),
        }
    }

    fn body(&mut self, element: Element<'x>, level: Level<'x>) {
        let pose = level.pose.then(self.pose(element, None));
        let class = self.class(element, "childclass").or(level.class);
        let name = element.attribute("name");
        let name = name.map_or_else(|| format!("body{}", self.links.len() + 1), str::to_owned);
        if self
            .links
            .iter()
            .any(|link| link.written && link.name == name)
        {
            let message = format!("there are two bodies `{name}`");
            self.findings.error(
                Code::DuplicateName,
                tag(element),
                message,
                "rename one of them",
            );
        }
        let joints = self.joints(element, &name, class);
        let inertia = self.inertia(element, &name, class, !joints.is_empty());
        let carried = element.attribute_node("gravcomp");
        let carried = carried.and_then(|given| exactly(self.findings, &given, "`gravcomp`"));
        let own = Link::fixed(name, level.parent, pose, tag(element));
        let here = own.moved_by(joints, &mut self.links);
        self.links[here].inertia = inertia;
        self.links[here].carried = carried.map_or(0.0, |[share]: [f64; 1]| share);
        let inside = Level {
            parent: Some(here),
            pose: Pose::IDENTITY,
            class,
        };
        self.level(element, inside);
    }

    /// The inertia of a body in its frame.
    fn inertia(
        &mut self,
        body: Element<'x>,
        name: &str,
        class: Option<&'x str>,
        moves: bool,
    ) -> Inertia {
        let inertial = child(body, "inertial");
        let from = self.compiler.inertia_from;
        let inertia = match inertial {
            Some(inertial) if from != InertiaFrom::Geoms => self.inertial(inertial),
            None if from == InertiaFrom::Inertial => Inertia::NONE,
            _ => self.of_geoms(
                body,
                class,
                moves || self.links.iter().any(|link| link.joint.is_some()),
            ),
        };
        if let Some(reason) = inertia.impossible() {
            self.findings.warning(
                Code::NotPhysical,
                tag(inertial.unwrap_or(body)),
                format!("no body can have the inertia of `{name}`: {reason}"),
                "it is taken as it is; the motion is right wherever the mass matrix is positive definite",
            );
        }
        inertia
    }

    fn inertial(&self, element: Element<'x>) -> Inertia {
        let pose = self.pose(element, None);
        let number = |key: &str| element.attribute_node(key);
        let mass = number("mass").and_then(|given| exactly::<1>(self.findings, &given, "a mass"));
        let diagonal = number("diaginertia")
            .and_then(|given| exactly::<3>(self.findings, &given, "a diagonal, xx yy zz,"));
        let full = number("fullinertia").and_then(|given| {
            exactly::<6>(self.findings, &given, "an inertia, xx yy zz xy xz yz,")
        });
        if element.attribute_node("mass").is_none() {
            self.findings.error(
                Code::MissingKey,
                tag(element),
                "`inertial` has no `mass`",
                "write `mass=\"1\"`",
            );
        }
        let tensor = full.or_else(|| diagonal.map(|[xx, yy, zz]| [xx, yy, zz, 0.0, 0.0, 0.0]));
        Inertia {
            mass: mass.map_or(0.0, |[mass]| mass),
            centre: [0.0; 3],
            tensor: tensor.unwrap_or_default(),
        }
        .placed(pose)
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
