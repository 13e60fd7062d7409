//! Constraints between joints and between bodies.

use appell_spec::Code;

use crate::loops::drawn;
use crate::model::{Connection, Coupling, Link, Sum, Tendon};
use crate::rotation::{Pose, Rotation, Vector, minus};
use crate::xml::{Element, children, elements, exactly, no_such, number, numbers, tag};

use super::Reader;

/// Most coefficients of a polynomial.
const MOST: usize = 5;

/// The constraints of `<equality>`.
#[derive(Default)]
pub(super) struct Equality {
    pub(super) couplings: Vec<Coupling>,
    pub(super) connections: Vec<Connection>,
}

/// Reads `<equality>`.
pub(super) fn read<'x>(
    root: Element<'x>,
    reader: &mut Reader<'x, '_>,
    tendons: &[Tendon],
) -> Equality {
    let mut read = Equality::default();
    for element in children(root, "equality").flat_map(elements) {
        let class = reader.class(element, "class");
        let given = reader.given(element, "equality", class);
        if given.word("active") == Some("false") {
            reader.leave_out("inactive equality".to_owned(), element);
            continue;
        }
        match element.tag_name().name() {
            "joint" => {
                reader.coupled_joints(element, &mut read);
            }
            "tendon" => {
                reader.coupled_tendons(element, tendons, &mut read);
            }
            word @ ("connect" | "weld") => {
                let count = read.connections.len();
                read.connections
                    .extend(connection(element, reader, word == "weld", count));
            }
            name => reader.findings.error(
                Code::NotAllowedHere,
                tag(element),
                format!("`equality/{name}` is not imported"),
                "remove it to import the tree alone; add position constraints to the spec",
            ),
        }
    }
    read
}

/// `equality/connect` and `equality/weld`: two bodies share a point, or are fixed together.
fn connection<'x>(
    element: Element<'x>,
    reader: &Reader<'x, '_>,
    weld: bool,
    count: usize,
) -> Option<Connection> {
    let name = element.attribute("name").map_or_else(
        || format!("{}_{}", element.tag_name().name(), count + 1),
        str::to_owned,
    );
    let scale = number(reader.findings, element, "torquescale");
    let rigid = weld && scale != Some(0.0);
    let connected =
        |first: (Option<usize>, Vector), second: Option<usize>, pose: Pose| Connection {
            name,
            ends: [first, (second, pose.of(first.1))],
            second: pose,
            rigid,
            place: tag(element),
        };
    if element.has_attribute("site1") {
        let ends = ["site1", "site2"].map(|key| reader.site(element, key));
        let [Some((first, own)), Some((second, other))] = ends else {
            return None;
        };
        let pose = other.then(own.inverse());
        // A connection of sites leaves their relative orientation free.
        let pose = if weld {
            pose
        } else {
            shifted(own.position, other.position)
        };
        return Some(connected((first, own.position), second, pose));
    }
    let (first, second) = (
        body(element, "body1", reader).ok()?,
        body(element, "body2", reader).ok()?,
    );
    let anchor = match element.attribute_node("anchor") {
        Some(given) => exactly(reader.findings, &given, "a point, x y z,")?,
        None => [0.0; 3],
    };
    let drawn = drawn(&reader.links, [first, second]);
    // The relative pose of a weld: the second body in the first, at the anchor in the second.
    let relative = match element.attribute_node("relpose").filter(|_| weld) {
        Some(given) => {
            let [x, y, z, q @ ..]: [f64; 7] = exactly(
                reader.findings,
                &given,
                "a position and a quaternion, x y z and w x y z,",
            )?;
            Rotation::quaternion(q).map(|rotation| (rotation, [x, y, z]))
        }
        None => None,
    };
    Some(match relative {
        // The anchor of the second is at the position in the first.
        Some((rotation, position)) => {
            let rotation = rotation.inverse();
            let position_of_first = minus(anchor, rotation.of(position));
            let pose = Pose {
                rotation,
                position: position_of_first,
            };
            connected((first, position), second, pose)
        }
        None if weld && !rigid => connected((first, drawn.inverse().of(anchor)), second, drawn),
        // Independent of the anchor.
        None if weld => connected((first, [0.0; 3]), second, drawn),
        None => connected((first, anchor), second, drawn),
    })
}

/// The pose that takes one point to another without a turn.
fn shifted(from: Vector, to: Vector) -> Pose {
    Pose {
        rotation: Rotation::IDENTITY,
        position: minus(to, from),
    }
}

/// A body does not exist, which has been reported.
struct Unknown;

/// The link of a named body; `None` is the world, also if no body is named.
fn body(
    element: Element<'_>,
    key: &str,
    reader: &Reader<'_, '_>,
) -> Result<Option<usize>, Unknown> {
    let Some(given) = element.attribute_node(key) else {
        return Ok(None);
    };
    let named = |link: &Link| link.written && link.name == given.value();
    if given.value() == "world" {
        return Ok(None);
    }
    if let Some(found) = reader.links.iter().position(named) {
        return Ok(Some(found));
    }
    let bodies = reader.links.iter().filter(|link| link.written);
    let known: Vec<&str> = bodies
        .map(|link| link.name.as_str())
        .chain(["world"])
        .collect();
    let list: Vec<String> = known.iter().map(|name| format!("`{name}`")).collect();
    let list = format!("known bodies: {}", list.join(", "));
    let (name, at) = (given.value(), given.range_value());
    let finding = no_such("body", name, at, known.iter().copied(), &list);
    reader.findings.add(finding);
    Err(Unknown)
}

impl<'x> Reader<'x, '_> {
    /// `equality/joint`: a joint position is a polynomial of another one, or constant.
    fn coupled_joints(&self, element: Element<'x>, read: &mut Equality) -> Option<()> {
        let joint = self.joint_named(element, "joint1")?;
        let other = match element.attribute_node("joint2") {
            Some(_) => Some(self.joint_named(element, "joint2")?),
            None => None,
        };
        let zeros = [joint.zero, other.map_or(0.0, |other| other.zero)];
        let follows = Sum::of(&joint.name);
        let other = other.map(|other| Sum::of(&other.name));
        self.couple(element, follows, other, zeros, read)
    }

    /// Adds the equation of two sums; without the second, the first is constant.
    pub(super) fn couple(
        &self,
        element: Element<'x>,
        follows: Sum,
        other: Option<Sum>,
        zeros: [f64; 2],
        read: &mut Equality,
    ) -> Option<()> {
        let mut coefficients = vec![0.0, 1.0];
        if let Some(given) = element.attribute_node("polycoef") {
            // Missing coefficients have their defaults.
            let given = numbers(self.findings, &given)?;
            if given.len() > 1 {
                coefficients = given;
                coefficients.truncate(MOST);
            } else {
                coefficients[0] = given.first().copied().unwrap_or_default();
            }
        }
        if other.is_none() {
            coefficients.truncate(1);
        }
        let count = read.couplings.len() + 1;
        let name = element.attribute("name");
        read.couplings.push(Coupling {
            name: name.map_or_else(|| format!("coupling_{count}"), str::to_owned),
            follows,
            other,
            zeros,
            coefficients,
            place: tag(element),
        });
        Some(())
    }

    /// The link and the pose of the site that an attribute names.
    fn site(&self, element: Element<'x>, key: &str) -> Option<(Option<usize>, Pose)> {
        let Some(given) = element.attribute_node(key) else {
            let help = "name two sites, `site1` and `site2`, or bodies";
            self.findings
                .error(Code::MissingKey, tag(element), format!("no `{key}`"), help);
            return None;
        };
        let found = self.sites.get(given.value()).copied();
        if found.is_none() {
            let known = self.sites.keys().map(String::as_str);
            let (name, at) = (given.value(), given.range_value());
            let help = "name a site of the file";
            self.findings.add(no_such("site", name, at, known, help));
        }
        found
    }
}
