//! `<replicate>`: replaced by copies of its children, each posed relative to the previous one. The number of the copy
//! is appended to names, and elements of other sections that refer to them are copied as well.

use std::collections::BTreeSet;

use appell_spec::{Code, Diagnostic, Report};

use crate::includes::{Edit, MAX_FILE, Whole};
use crate::letters::plain;
use crate::rotation::{Pose, Vector, add, scaled};
use crate::xml::{Element, Findings, Span, elements, exactly, inside, number, parse, tag};

use super::compiler::Compiler;

/// Largest number of `replicate` elements.
const MOST: usize = 256;
/// Largest number of copies.
const MOST_COPIES: f64 = 65_536.0;
/// Sections that can refer to copied elements.
const SECTIONS: [&str; 4] = ["equality", "tendon", "actuator", "contact"];

/// The text with all copies written out, from the innermost `replicate` outwards.
pub(crate) fn expanded(mut whole: Whole<'_>) -> Result<Whole<'_>, Box<Report>> {
    if !whole.text.contains("<replicate") {
        return Ok(whole);
    }
    for count in 0.. {
        let edits = match next(&whole.text, count) {
            Ok(Some(edits)) => edits,
            Ok(None) => break,
            Err(findings) => return Err(Box::new(whole.first_error(findings))),
        };
        whole = whole.edited(&edits);
    }
    Ok(whole)
}

/// The edits of one innermost `replicate`; none where there is none.
fn next(text: &str, count: usize) -> Result<Option<Vec<Edit>>, Vec<Diagnostic>> {
    let document = parse(text).map_err(|error| vec![error])?;
    let root = document.root_element();
    let is_one = |element: &Element<'_>| element.has_tag_name("replicate");
    let innermost = |element: &Element<'_>| {
        is_one(element) && element.descendants().filter(is_one).count() == 1
    };
    let within_bodies = |element: &Element<'_>| {
        element
            .ancestors()
            .any(|outer| outer.has_tag_name("worldbody"))
    };
    let mut all = root.descendants().filter(innermost).filter(within_bodies);
    let Some(element) = all.next() else {
        return Ok(None);
    };
    let findings = Findings::default();
    let copies = copies(root, element, &findings);
    let joints = elements(element)
        .find(|inner| ["joint", "freejoint", "inertial"].contains(&inner.tag_name().name()));
    if let Some(joint) = joints {
        let help = "write `<body>` around it";
        let name = joint.tag_name().name();
        let message = format!("`replicate` holds a `{name}`");
        findings.error(Code::NotAllowedHere, tag(joint), message, help);
    }
    let size = copies.len().saturating_mul(element.range().len()) + text.len();
    if count >= MOST || size as u64 > MAX_FILE {
        let message = format!(
            "copies make the file larger than {} MiB, or there are more than {MOST} `replicate`",
            MAX_FILE >> 20
        );
        let help = "write fewer copies";
        findings.error(Code::LimitExceeded, tag(element), message, help);
    }
    if findings.has_errors() {
        return Err(findings.into_inner());
    }
    Ok(Some(edits(root, element, &copies)))
}

/// Poses and endings of the copies.
fn copies(root: Element<'_>, element: Element<'_>, findings: &Findings) -> Vec<(Pose, String)> {
    let angles = Compiler::read(root, findings).angles;
    let read = |key: &str, what: &str| -> Option<Vector> {
        exactly(findings, &element.attribute_node(key)?, what)
    };
    let offset = read("offset", "an offset, x y z,").unwrap_or_default();
    let turns = read("euler", "a set of Euler angles").unwrap_or_default();
    let count = number(findings, element, "count").unwrap_or_default();
    if !(1.0..=MOST_COPIES).contains(&count) || count.fract() != 0.0 {
        let message = format!("`replicate` needs a `count` between 1 and {MOST_COPIES}");
        let help = "write `count=\"3\"`";
        findings.error(Code::MissingKey, tag(element), message, help);
        return Vec::new();
    }
    let separator = element.attribute("sep").unwrap_or_default();
    let width = plain(count).len();
    let mut copies = Vec::new();
    let mut position = [0.0; 3];
    while (copies.len() as f64) < count {
        // As in MuJoCo 4.0: angles add up, and offsets are along the axes of the previous copy.
        let rotation = angles.euler(scaled(turns, copies.len() as f64));
        let number = format!("{separator}{:0width$}", copies.len());
        copies.push((Pose { rotation, position }, number));
        position = add(position, rotation.of(offset));
    }
    copies
}

/// The text around and within the copies.
fn edits(root: Element<'_>, element: Element<'_>, copies: &[(Pose, String)]) -> Vec<Edit> {
    let named = |inner: &Element<'_>| inner.attribute("name").map(str::to_owned);
    let names: BTreeSet<String> = element
        .descendants()
        .filter_map(|inner| named(&inner))
        .collect();
    // Each span of the text is replaced by copies of a part of it, with a prefix and a suffix.
    let mut replaced: Vec<(Span, Vec<Edit>)> = Vec::new();
    let own = element.range();
    let mut within = Vec::new();
    for (pose, ending) in copies {
        let [x, y, z] = pose.position;
        let [w, i, j, k] = pose.rotation.to_quaternion();
        let open = format!("<frame pos=\"{x:e} {y:e} {z:e}\" quat=\"{w:e} {i:e} {j:e} {k:e}\" ");
        within.push(Edit::Insert(open, own.start));
        let class = element.attribute_node("childclass");
        within.extend(class.map(|class| Edit::Keep(class.range())));
        within.push(Edit::Insert(">".to_owned(), own.start));
        let ends = element
            .descendants()
            .skip(1)
            .filter_map(|inner| Some(inner.attribute_node("name")?.range_value().end));
        within.extend(with_endings(&inside(element), ends.collect(), ending));
        within.push(Edit::Insert("</frame>".to_owned(), own.start));
    }
    replaced.push((own, within));
    let sections = elements(root).filter(|section| SECTIONS.contains(&section.tag_name().name()));
    for user in sections.flat_map(elements) {
        let all = || user.descendants().flat_map(|inner| inner.attributes());
        let is_reference = |key: &str| !["name", "class"].contains(&key);
        let refers = |one: &roxmltree::Attribute<'_, '_>| {
            is_reference(one.name()) && names.contains(one.value())
        };
        if !all().any(|one| refers(&one)) {
            continue;
        }
        let mut copied = Vec::new();
        for (_, ending) in copies {
            let ends = all().filter(|one| refers(one) || one.name() == "name");
            let ends = ends.map(|one| one.range_value().end).collect();
            copied.extend(with_endings(&user.range(), ends, ending));
        }
        replaced.push((user.range(), copied));
    }
    replaced.sort_by_key(|(span, _)| span.start);
    let mut edits = Vec::new();
    let mut from = 0;
    for (span, copied) in replaced {
        edits.push(Edit::Keep(from..span.start));
        edits.extend(copied);
        from = span.end;
    }
    edits.push(Edit::Keep(from..root.document().input_text().len()));
    edits
}

/// A part of the text with an ending inserted at some places.
fn with_endings(part: &Span, mut ends: Vec<usize>, ending: &str) -> Vec<Edit> {
    ends.sort_unstable();
    let mut edits = Vec::new();
    let mut from = part.start;
    for end in ends {
        edits.push(Edit::Keep(from..end));
        edits.push(Edit::Insert(ending.to_owned(), end));
        from = end;
    }
    edits.push(Edit::Keep(from..part.end));
    edits
}
