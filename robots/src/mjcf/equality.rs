//! Constraints between joints; others are refused.

use appell_spec::{Code, did_you_mean};

use crate::model::Coupling;
use crate::xml::{Element, children, elements, numbers, tag};

use super::Reader;

/// Most coefficients of a polynomial.
const MOST: usize = 5;

/// Reads `<equality>`.
pub(super) fn read<'x>(root: Element<'x>, reader: &mut Reader<'x, '_>) -> Vec<Coupling> {
    let mut couplings = Vec::new();
    for element in children(root, "equality").flat_map(elements) {
        if element.attribute("active") == Some("false") {
            reader.leave_out("inactive equality".to_owned(), element);
            continue;
        }
        match element.tag_name().name() {
            "joint" => couplings.extend(coupling(element, reader, couplings.len())),
            name => {
                let references = ["body1", "body2"].map(|key| body(element, key, reader));
                if references.iter().all(|known| *known) {
                    reader.findings.error(
                        Code::NotAllowedHere,
                        tag(element),
                        format!("`equality/{name}` is not imported yet"),
                        "remove it to import the tree alone; add position constraints to the spec",
                    );
                }
            }
        }
    }
    couplings
}

/// Whether a body that is named exists.
fn body(element: Element<'_>, key: &str, reader: &Reader<'_, '_>) -> bool {
    let Some(given) = element.attribute_node(key) else {
        return true;
    };
    let bodies = reader.links.iter().filter(|link| link.written);
    let known: Vec<&str> = bodies
        .map(|link| link.name.as_str())
        .chain(["world"])
        .collect();
    let found = known.contains(&given.value());
    if !found {
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
    }
    found
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
