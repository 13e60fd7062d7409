//! URDF: links, and joints with a parent and a child.

use std::collections::{BTreeMap, BTreeSet};

use appell_spec::Code;

use crate::inertia::Inertia;
use crate::model::{Coupling, Joint, LeftOut, Link, Motion, Robot, Sum};
use crate::options::Options;
use crate::rotation::{Axis, Pose, Rotation, Vector, unit};
use crate::without::Without;
use crate::xml::{Element, Findings, child, children, elements, exactly, no_such, no_type, tag};

const GRAVITY: Vector = [0.0, 0.0, -9.81];

/// A joint with the links that it connects.
struct Connection<'x> {
    element: Element<'x>,
    name: &'x str,
    parent: usize,
    child: usize,
    pose: Pose,
    /// In series; empty if fixed.
    joints: Vec<Joint>,
}

/// Reads `<robot>`.
pub(crate) fn read(root: Element<'_>, findings: &Findings, options: &Options) -> Robot {
    let mut left_out = Vec::new();
    let links: Vec<Element<'_>> = children(root, "link").collect();
    let mut by_name = BTreeMap::new();
    for (index, link) in links.iter().enumerate() {
        let Some(name) = name(*link, findings) else {
            continue;
        };
        if by_name.insert(name, index).is_some() {
            let message = format!("there are two links `{name}`");
            let help = "rename one of them";
            findings.error(Code::DuplicateName, tag(*link), message, help);
        }
    }
    if links.is_empty() {
        let message = "the robot has no link";
        let help = "a URDF has `<link>`s, connected by `<joint>`s";
        findings.error(Code::MissingSection, tag(root), message, help);
    }
    let inertias: Vec<Inertia> = links.iter().map(|link| inertia(*link, findings)).collect();
    let (connections, joints_by_name) = joints(root, &by_name, findings);
    let couplings = if options.without.contains(&Without::Couplings) {
        Vec::new()
    } else {
        let all = children(root, "joint");
        all.filter_map(|element| mimic(element, &joints_by_name, findings))
            .collect()
    };
    for element in elements(root) {
        match element.tag_name().name() {
            "joint" => {
                left_out.extend(unknown(element, "joint", known_of(element)));
            }
            "link" => left_out.extend(unknown(element, "link", &["inertial"])),
            other => left_out.push(omitted(element, other.to_owned())),
        }
    }
    Robot {
        name: root.attribute("name").unwrap_or("robot").to_owned(),
        gravity: GRAVITY,
        links: tree(&links, &inertias, connections, findings),
        couplings,
        tendons: Vec::new(),
        connections: Vec::new(),
        driven: BTreeSet::new(),
        drives: None,
        left_out,
    }
}

/// Elements of a joint that are read; with several coordinates `dynamics`, `limit` and `mimic` would be ambiguous.
fn known_of(joint: Element<'_>) -> &'static [&'static str] {
    const ALL: &[&str] = &[
        "origin", "parent", "child", "axis", "dynamics", "limit", "mimic",
    ];
    if has_several(joint) { &ALL[..4] } else { ALL }
}

/// Whether a joint has several coordinates.
fn has_several(joint: Element<'_>) -> bool {
    let kind = joint.attribute("type");
    kind.is_some_and(|kind| matches!(kind, "planar" | "floating" | "spherical" | "ball"))
}

/// The name of an element, which it must have.
fn name<'x>(element: Element<'x>, findings: &Findings) -> Option<&'x str> {
    let name = element.attribute("name");
    if name.is_none() {
        let kind = element.tag_name().name();
        let help = format!("give it one: `<{kind} name=\"…\">`");
        let message = format!("a `{kind}` without a name");
        findings.error(Code::MissingKey, tag(element), message, help);
    }
    name
}

fn omitted(element: Element<'_>, what: String) -> LeftOut {
    let name = element
        .attribute("name")
        .or_else(|| element.attribute("reference"));
    LeftOut {
        what,
        name: name.map(str::to_owned),
        effect: None,
        place: tag(element),
    }
}

fn unknown<'x>(
    element: Element<'x>,
    within: &'x str,
    known: &'x [&'x str],
) -> impl Iterator<Item = LeftOut> {
    let unknown = elements(element).filter(|one| !known.contains(&one.tag_name().name()));
    let owner = element.attribute("name");
    unknown.map(move |one| {
        let what = format!("{within}/{}", one.tag_name().name());
        LeftOut {
            name: owner.map(str::to_owned),
            ..omitted(one, what)
        }
    })
}

/// A number from an attribute, with a default.
fn number(element: Option<Element<'_>>, key: &str, default: f64, findings: &Findings) -> f64 {
    let read = element.and_then(|element| crate::xml::number(findings, element, key));
    read.unwrap_or(default)
}

fn vector(
    element: Option<Element<'_>>,
    key: &str,
    what: &str,
    findings: &Findings,
) -> Option<Vector> {
    let attribute = element?.attribute_node(key)?;
    exactly(findings, &attribute, what)
}

/// `<origin xyz rpy>`
fn origin(element: Element<'_>, findings: &Findings) -> Pose {
    let origin = child(element, "origin");
    let position = vector(origin, "xyz", "a position, x y z,", findings);
    let angles = vector(origin, "rpy", "an orientation, roll pitch yaw,", findings);
    Pose {
        rotation: angles.map_or(Rotation::IDENTITY, Rotation::roll_pitch_yaw),
        position: position.unwrap_or_default(),
    }
}

/// `<inertial>` of a link, in the frame of the link.
fn inertia(link: Element<'_>, findings: &Findings) -> Inertia {
    let Some(inertial) = child(link, "inertial") else {
        return Inertia::NONE;
    };
    let pose = origin(inertial, findings);
    let mass = child(inertial, "mass");
    let tensor = child(inertial, "inertia");
    for (found, word, example) in [
        (mass, "mass", "<mass value=\"1\"/>"),
        (
            tensor,
            "inertia",
            "<inertia ixx=\"1e-3\" iyy=\"1e-3\" izz=\"1e-3\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/>",
        ),
    ] {
        if found.is_none() {
            let message = format!("`inertial` has no `{word}`");
            let help = format!("write `{example}`");
            findings.error(Code::MissingKey, tag(inertial), message, help);
        }
    }
    let entries = ["ixx", "iyy", "izz", "ixy", "ixz", "iyz"];
    let own = Inertia {
        mass: number(mass, "value", 0.0, findings),
        centre: [0.0; 3],
        tensor: entries.map(|key| number(tensor, key, 0.0, findings)),
    }
    .placed(pose)
    .without_rounding();
    if let Some(reason) = own.impossible() {
        let link = link.attribute("name").unwrap_or_default();
        let at = if own.mass < 0.0 { mass } else { tensor };
        let message = format!("no body can have the inertia of link `{link}`: {reason}");
        let help = "it is taken as it is; the motion is right wherever the mass matrix is positive definite";
        let place = tag(at.unwrap_or(inertial));
        findings.warning(Code::NotPhysical, place, message, help);
    }
    own
}

/// The joints, and their elements by their names.
fn joints<'x>(
    root: Element<'x>,
    links: &BTreeMap<&str, usize>,
    findings: &Findings,
) -> (Vec<Connection<'x>>, BTreeMap<&'x str, Element<'x>>) {
    let mut connections = Vec::new();
    let mut names = BTreeMap::new();
    for element in children(root, "joint") {
        let Some(name) = name(element, findings) else {
            continue;
        };
        if names.insert(name, element).is_some() {
            let message = format!("there are two joints `{name}`");
            let help = "rename one of them";
            findings.error(Code::DuplicateName, tag(element), message, help);
        }
        let ends = ["parent", "child"].map(|end| link_of(element, end, links, findings));
        let joints = moves(element, name, findings);
        if let [Some(parent), Some(child)] = ends {
            connections.push(Connection {
                element,
                name,
                parent,
                child,
                pose: origin(element, findings),
                joints,
            });
        }
    }
    (connections, names)
}

/// The link that a joint names.
fn link_of(
    joint: Element<'_>,
    end: &'static str,
    links: &BTreeMap<&str, usize>,
    findings: &Findings,
) -> Option<usize> {
    let name = joint.attribute("name").unwrap_or_default();
    let Some(attribute) = child(joint, end).and_then(|end| end.attribute_node("link")) else {
        let message = format!("joint `{name}` has no {end}");
        let help = format!("write `<{end} link=\"…\"/>`");
        findings.error(Code::MissingKey, tag(joint), message, help);
        return None;
    };
    let link = links.get(attribute.value()).copied();
    if link.is_none() {
        let otherwise = format!("the file has {} links, none of that name", links.len());
        let (name, at) = (attribute.value(), attribute.range_value());
        findings.add(no_such("link", name, at, links.keys().copied(), &otherwise));
    }
    link
}

/// The motions of a joint in series; none if it is fixed.
fn moves(element: Element<'_>, name: &str, findings: &Findings) -> Vec<Joint> {
    let Some(kind) = element.attribute_node("type") else {
        let help = "write `type=\"revolute\"`, `continuous`, `prismatic` or `fixed`";
        let message = format!("joint `{name}` has no type");
        findings.error(Code::MissingKey, tag(element), message, help);
        return Vec::new();
    };
    let without_axis =
        |motion: Motion| vec![Joint::without_axis(name.to_owned(), motion, [0.0; 3])];
    match kind.value() {
        "fixed" => Vec::new(),
        "revolute" | "continuous" => vec![joint(element, name, Motion::Turning, findings)],
        "prismatic" => vec![joint(element, name, Motion::Sliding, findings)],
        "planar" => planar(name, axis(element, name, findings)),
        "floating" => without_axis(Motion::Free),
        "spherical" | "ball" => without_axis(Motion::Ball),
        other => {
            let kinds = [
                "revolute",
                "continuous",
                "prismatic",
                "planar",
                "floating",
                "fixed",
            ];
            findings.add(no_type("joints", other, kind.range_value(), &kinds));
            Vec::new()
        }
    }
}

/// The direction of `<axis>`.
fn axis(element: Element<'_>, name: &str, findings: &Findings) -> Vector {
    let given = child(element, "axis");
    let along = vector(given, "xyz", "a direction, x y z,", findings).unwrap_or([1.0, 0.0, 0.0]);
    unit(along).unwrap_or_else(|| {
        let message = format!("the axis of joint `{name}` has length zero");
        let help = "give its direction, such as `0 0 1`";
        let place = tag(given.unwrap_or(element));
        findings.error(Code::VanishingLength, place, message, help);
        [1.0, 0.0, 0.0]
    })
}

/// A joint that turns about its axis or slides along it.
fn joint(element: Element<'_>, name: &str, motion: Motion, findings: &Findings) -> Joint {
    let dynamics = child(element, "dynamics");
    Joint {
        range: range(element, name, findings),
        damping: [number(dynamics, "damping", 0.0, findings), 0.0, 0.0],
        place: tag(element),
        friction: number(dynamics, "friction", 0.0, findings),
        ..Joint::along(name.to_owned(), motion, axis(element, name, findings))
    }
}

/// Displacements along the two axes of a plane, then the rotation about its normal.
fn planar(name: &str, across: Vector) -> Vec<Joint> {
    let (nearest, turn) = Axis::nearest(across);
    let slides = [1, 2].map(|step| {
        let index = (nearest.index + step) % 3;
        let along = Axis {
            index,
            backwards: false,
        };
        let name = format!("{name}_{}", ["x", "y", "z"][index]);
        Joint::along(name, Motion::Sliding, turn.of(along.vector()))
    });
    let turns = Joint::along(format!("{name}_turn"), Motion::Turning, across);
    slides.into_iter().chain([turns]).collect()
}

/// The limits of a joint; attributes that are not there are zero.
fn range(element: Element<'_>, name: &str, findings: &Findings) -> Option<[f64; 2]> {
    let kind = element.attribute("type").unwrap_or_default();
    let limit = child(element, "limit");
    let range = ["lower", "upper"].map(|key| number(limit, key, 0.0, findings));
    match limit {
        _ if kind == "continuous" => None,
        None => {
            let instead = match kind {
                "revolute" => "write `type=\"continuous\"` if it has none",
                _ => "write `<limit lower=\"…\" upper=\"…\" effort=\"…\" velocity=\"…\"/>`",
            };
            let message = format!("URDF asks for `<limit>` on the {kind} joint `{name}`");
            findings.warning(Code::MissingKey, tag(element), message, instead);
            None
        }
        Some(limit) if range[0] >= range[1] => {
            let message = format!("the limits of joint `{name}` leave no range");
            let help =
                "they are left out; `lower` has to be less than `upper`, and a missing one is 0";
            findings.warning(Code::EmptyRange, tag(limit), message, help);
            None
        }
        Some(_) => Some(range),
    }
}

/// `<mimic>`: the position of this joint is an affine function of that of another one.
fn mimic<'x>(
    element: Element<'x>,
    joints: &BTreeMap<&'x str, Element<'x>>,
    findings: &Findings,
) -> Option<Coupling> {
    let mimic = child(element, "mimic")?;
    let name = element.attribute("name")?;
    let Some(other) = mimic.attribute_node("joint") else {
        let help = "write `<mimic joint=\"…\" multiplier=\"1\" offset=\"0\"/>`";
        findings.error(Code::MissingKey, tag(mimic), "`mimic` names no joint", help);
        return None;
    };
    let moves = |name: &str| {
        let kind = joints.get(name).and_then(|joint| joint.attribute("type"));
        kind.is_some_and(|kind| matches!(kind, "revolute" | "continuous" | "prismatic"))
    };
    if !joints.contains_key(other.value()) {
        let moving = joints.keys().copied().filter(|name| moves(name));
        let otherwise = format!("joint `{name}` follows another joint of the file");
        let (name, at) = (other.value(), other.range_value());
        findings.add(no_such("joint", name, at, moving, &otherwise));
        return None;
    }
    if moves(name) && has_several(joints[other.value()]) {
        let message = format!(
            "joint `{name}` follows `{}`, which has several coordinates",
            appell_spec::shown(other.value())
        );
        let help = "a joint follows one that turns or slides";
        findings.error(Code::NotAllowedHere, other.range_value(), message, help);
    }
    let offset = number(Some(mimic), "offset", 0.0, findings);
    let multiplier = number(Some(mimic), "multiplier", 1.0, findings);
    let follows = moves(other.value()) && other.value() != name;
    moves(name).then(|| Coupling {
        name: format!("{name}_follows"),
        follows: Sum::of(name),
        other: follows.then(|| Sum::of(other.value())),
        place: tag(mimic),
        zeros: [0.0; 2],
        coefficients: if follows {
            vec![offset, multiplier]
        } else {
            vec![offset]
        },
    })
}

/// The links in the order of the tree, parents first.
fn tree(
    elements: &[Element<'_>],
    inertias: &[Inertia],
    connections: Vec<Connection<'_>>,
    findings: &Findings,
) -> Vec<Link> {
    let name = |link: usize| elements[link].attribute("name").unwrap_or_default();
    let mut above: Vec<Option<usize>> = vec![None; elements.len()];
    for (index, connection) in connections.iter().enumerate() {
        let Some(first) = above[connection.child].replace(index) else {
            continue;
        };
        let (link, first, second) = (
            name(connection.child),
            connections[first].name,
            connection.name,
        );
        let message =
            format!("link `{link}` has two parents, by joint `{first}` and by joint `{second}`");
        let help = "a URDF is a tree: remove one of the joints; to close a loop, keep the tree and add a connection \
             (in MJCF: `equality/connect`)";
        findings.error(Code::DuplicateName, tag(connection.element), message, help);
    }
    let roots: Vec<usize> = (0..elements.len())
        .filter(|link| above[*link].is_none())
        .collect();
    let named = |link: &&usize| elements[**link].has_attribute("name");
    for extra in roots.iter().skip(1).filter(named) {
        let message = format!(
            "link `{}` is the child of no joint, and so is `{}`",
            name(*extra),
            name(roots[0])
        );
        let help = "a URDF has one root: connect the link by a joint, or remove it";
        findings.error(Code::UnknownReference, tag(elements[*extra]), message, help);
    }
    let mut below: Vec<Vec<usize>> = vec![Vec::new(); elements.len()];
    for (index, connection) in connections.iter().enumerate() {
        if above[connection.child] == Some(index) {
            below[connection.parent].push(index);
        }
    }
    let mut links: Vec<Link> = Vec::new();
    let mut connections: Vec<Option<Connection<'_>>> = connections.into_iter().map(Some).collect();
    // (link, index of its parent in the result, the joint to it)
    let mut open: Vec<(usize, Option<usize>, Option<usize>)> = roots
        .first()
        .map(|root| (*root, None, None))
        .into_iter()
        .collect();
    while let Some((link, parent, by)) = open.pop() {
        let connection = by.and_then(|by| connections[by].take());
        let (pose, joints) =
            connection.map_or((Pose::IDENTITY, Vec::new()), |by| (by.pose, by.joints));
        let own = Link::fixed(name(link).to_owned(), parent, pose, tag(elements[link]));
        let here = own.moved_by(joints, &mut links);
        links[here].inertia = inertias[link];
        for next in below[link].iter().rev() {
            if let Some(connection) = &connections[*next] {
                open.push((connection.child, Some(here), Some(*next)));
            }
        }
    }
    if links.len() < elements.len() && roots.len() <= 1 {
        let mut reached = vec![false; elements.len()];
        let names: BTreeMap<&str, usize> =
            (0..elements.len()).map(|link| (name(link), link)).collect();
        for link in &links {
            if let Some(index) = names.get(link.name.as_str()) {
                reached[*index] = true;
            }
        }
        if let Some(lost) = (0..elements.len()).find(|link| !reached[*link]) {
            let message = format!(
                "link `{}` is not connected with the root: its joints form a circle",
                name(lost)
            );
            let help = "a URDF is a tree: each link has one parent, up to one root";
            findings.error(Code::ReferenceCycle, tag(elements[lost]), message, help);
        }
    }
    links
}
