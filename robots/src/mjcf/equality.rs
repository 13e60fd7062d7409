//! Constraints between joints and between bodies.

use appell_spec::{Code, did_you_mean};

use crate::model::{Connection, Coupling, Link};
use crate::rotation::{Pose, Rotation};
use crate::xml::{Element, children, elements, exactly, numbers, tag};

use super::Reader;

/// Most coefficients of a polynomial.
const MOST: usize = 5;

/// What `<equality>` demands.
#[derive(Default)]
pub(super) struct Equality {
    pub(super) couplings: Vec<Coupling>,
    pub(super) connections: Vec<Connection>,
}

/// Reads `<equality>`.
pub(super) fn read<'x>(root: Element<'x>, reader: &mut Reader<'x, '_>) -> Equality {
    let mut read = Equality::default();
    for element in children(root, "equality").flat_map(elements) {
        if element.attribute("active") == Some("false") {
            reader.leave_out("inactive equality".to_owned(), element);
            continue;
        }
        match element.tag_name().name() {
            "joint" => {
                let count = read.couplings.len();
                read.couplings.extend(coupling(element, reader, count));
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

/// `equality/connect` and `equality/weld`: two bodies meet at a point, or everywhere.
fn connection(
    element: Element<'_>,
    reader: &Reader<'_, '_>,
    rigid: bool,
    count: usize,
) -> Option<Connection> {
    if let Some(site) = element.attribute_node("site1") {
        reader.findings.error(
            Code::NotAllowedHere,
            site.range_value(),
            "a connection of sites is not imported",
            "name the bodies, `body1` and `body2`, and the `anchor` in the frame of the first",
        );
        return None;
    }
    let (first, second) = (
        body(element, "body1", reader).ok()?,
        body(element, "body2", reader).ok()?,
    );
    let anchor = match element.attribute_node("anchor") {
        Some(given) => exactly(reader.findings, &given, "a point, x y z,")?,
        None => [0.0; 3],
    };
    let name = element.attribute("name").map_or_else(
        || format!("{}_{}", element.tag_name().name(), count + 1),
        str::to_owned,
    );
    if !rigid {
        return Some(Connection {
            name,
            ends: [(first, anchor), (second, [0.0; 3])],
            second: None,
            rigid,
            place: tag(element),
        });
    }
    // The pose of the second in the first, and the anchor in the second.
    let relative = match element.attribute_node("relpose") {
        Some(given) => {
            let [x, y, z, q @ ..]: [f64; 7] = exactly(
                reader.findings,
                &given,
                "a position and a quaternion, x y z and w x y z,",
            )?;
            Rotation::quaternion(q).map(|rotation| Pose {
                rotation,
                position: [x, y, z],
            })
        }
        None => None,
    };
    Some(match relative {
        Some(pose) => Connection {
            name,
            ends: [(first, pose.of(anchor)), (second, anchor)],
            second: Some(pose.inverse()),
            rigid,
            place: tag(element),
        },
        // The same wherever it is anchored.
        None => Connection {
            name,
            ends: [(first, [0.0; 3]), (second, [0.0; 3])],
            second: None,
            rigid,
            place: tag(element),
        },
    })
}

/// There is no body of a name, which is told.
struct Unknown;

/// The link of a body that is named; none is the world, which is meant where no body is named.
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
    let list = || {
        let names: Vec<String> = known.iter().map(|name| format!("`{name}`")).collect();
        format!("known bodies: {}", names.join(", "))
    };
    reader.findings.error(
        Code::UnknownReference,
        given.range_value(),
        format!("there is no body `{}`", appell_spec::shown(given.value())),
        did_you_mean(given.value(), known.iter().copied(), list),
    );
    Err(Unknown)
}

/// `equality/joint`: a joint follows another one by a polynomial, or stands still.
fn coupling(element: Element<'_>, reader: &Reader<'_, '_>, count: usize) -> Option<Coupling> {
    let find = |key: &str| {
        let given = element.attribute_node(key)?;
        let joints = || reader.links.iter().filter_map(|link| link.joint.as_ref());
        let found = joints().find(|joint| joint.name == given.value());
        if found.is_none() {
            let known = joints().map(|joint| joint.name.as_str());
            reader.findings.error(
                Code::UnknownReference,
                given.range_value(),
                format!("there is no joint `{}`", appell_spec::shown(given.value())),
                did_you_mean(given.value(), known, || {
                    "name a hinge or a slide of the file".to_owned()
                }),
            );
        }
        found
    };
    let joint = find("joint1")?;
    let other = match element.attribute_node("joint2") {
        Some(_) => Some(find("joint2")?),
        None => None,
    };
    let mut coefficients = vec![0.0, 1.0];
    if let Some(given) = element.attribute_node("polycoef") {
        coefficients = numbers(reader.findings, &given)?;
        coefficients.truncate(MOST);
    }
    if other.is_none() {
        coefficients.truncate(1);
    }
    let name = element
        .attribute("name")
        .map_or_else(|| format!("coupling_{}", count + 1), str::to_owned);
    Some(Coupling {
        name,
        joint: joint.name.clone(),
        other: other.map(|other| other.name.clone()),
        zeros: [joint.zero, other.map_or(0.0, |other| other.zero)],
        coefficients,
    })
}
