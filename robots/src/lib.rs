//! Robot descriptions as specs.
//!
//! ```text
//! URDF ─┐
//!       ├─> Robot (links, joints) ─> Tree (bodies) ─> text of a spec
//! MJCF ─┘
//! ```
//!
//! | file | does |
//! |---|---|
//! | `includes.rs` | a file with its includes, as one text |
//! | `format.rs` | the formats |
//! | `xml.rs` | elements and numbers with their places, and findings about them |
//! | `urdf.rs`, `mjcf.rs` | the formats, each to a `Robot` |
//! | `mjcf/corrected.rs` | the text of an MJCF file with changes of its numbers |
//! | `model.rs` | a robot: links in a tree, joints with their properties |
//! | `rotation.rs`, `inertia.rs` | rotations as successive turns; inertias rotated, shifted, combined |
//! | `tree.rs` | links that are fixed together are merged into one body |
//! | `kinematics.rs`, `mass.rs` | poses and partial velocities of links; the mass matrix |
//! | `loops.rs`, `elimination.rs` | constraints of loops and couplings; independent constraints and dependent coordinates |
//! | `assembly.rs` | positions of joints that satisfy the constraints |
//! | `names.rs`, `letters.rs`, `patterns.rs` | valid names; numbers written out or as parameters, also by patterns |
//! | `dictionary.rs` | names of the file in the spec |
//! | `failure.rs` | why a robot cannot be imported |
//! | `options.rs`, `without.rs`, `lock.rs`, `snap.rs` | options; omitted properties; joints made rigid; nearly right angles |
//! | `spec.rs`, `table.rs` | the sections of the spec, and their text |

mod assembly;
mod dictionary;
mod elimination;
mod failure;
mod format;
mod includes;
mod inertia;
mod kinematics;
mod letters;
mod lock;
mod loops;
mod mass;
mod mjcf;
mod model;
mod names;
mod options;
mod patterns;
mod rotation;
mod snap;
mod spec;
mod table;
mod tree;
mod urdf;
mod without;
mod xml;

use appell_spec::{Code, Diagnostic, Report, Severity, did_you_mean};

use appell_spec::limits::MAX_ITEMS;
use includes::Whole;

pub use dictionary::{ActuatorName, BodyName, Dictionary, Entry, JointName};
pub use failure::Failure;
pub use format::Format;
pub use includes::MAX_FILE;
pub use letters::Letters;
pub use lock::Lock;
pub use mjcf::{Amount, Change, Corrected, Number, corrected};
pub use options::Options;
pub use snap::SNAP;
pub use without::Without;

/// A robot as a spec.
#[derive(Debug)]
pub struct Imported {
    /// The spec.
    pub spec: String,
    /// Name of the robot in its file.
    pub name: String,
    /// The format of its file.
    pub format: Format,
    /// Number of joints that move.
    pub joints: usize,
    /// Number of bodies: links that are fixed together count once.
    pub bodies: usize,
    /// Warnings, by the file that they are about.
    pub warnings: Vec<Report>,
    /// Parts of the file without a counterpart in the spec.
    pub left_out: Vec<LeftOut>,
    /// Orientations and axes that are nearly along the axes of their parents.
    pub nearly_right: usize,
    /// The names of the file and of its numbers in the spec.
    pub dictionary: Dictionary,
}

/// Elements of one kind that have no counterpart in a spec.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LeftOut {
    /// The element, such as `actuator/motor`.
    pub what: String,
    /// The file that has them: that of the robot, or one that it includes.
    pub file: String,
    /// Their lines, from 1.
    pub lines: Vec<usize>,
    /// How the motion differs without them; `None` if it does not.
    pub effect: Option<&'static str>,
}

/// Frees or fixes the roots, as the options ask.
fn set_base(robot: &mut model::Robot, options: &Options) {
    use model::{Joint, Motion};
    for link in robot.links.iter_mut().filter(|link| link.parent.is_none()) {
        if options.floating && link.joint.is_none() {
            let joint = Joint::without_axis(link.name.clone(), Motion::Free, [0.0; 3]);
            link.joint = Some(joint);
        }
        if options.grounded {
            link.joint.take_if(|joint| joint.motion == Motion::Free);
        }
    }
}

/// Reports the errors of the spec at their sources in the file of the robot.
fn refuse(spec: &Report, lines: &[(usize, xml::Span)], root: xml::Span, findings: &xml::Findings) {
    for error in spec.diagnostics() {
        if error.severity != Severity::Error {
            continue;
        }
        let at = error.labels.first().map_or(0, |(place, _)| place.start);
        let line = lines.partition_point(|(start, _)| *start <= at);
        let place = line.checked_sub(1).map(|line| lines[line].1.clone());
        let place = place
            .filter(|place| !place.is_empty())
            .unwrap_or_else(|| root.clone());
        let mut own = Diagnostic::error(error.code, error.message.clone()).at(place, "");
        own.help.clone_from(&error.help);
        findings.add(own);
    }
}

/// Parts of the file without a counterpart in a spec, by kind, with their lines.
fn left_out(robot: &model::Robot, whole: &Whole<'_>) -> Vec<LeftOut> {
    let mut left_out: Vec<LeftOut> = Vec::new();
    let mut index = std::collections::BTreeMap::new();
    for one in &robot.left_out {
        let (file, line) = whole.line(&one.place);
        let next = left_out.len();
        let at = *index
            .entry((&one.what, file.to_owned(), one.effect))
            .or_insert(next);
        if at == next {
            left_out.push(LeftOut {
                what: one.what.clone(),
                file: file.to_owned(),
                lines: Vec::new(),
                effect: one.effect,
            });
        }
        left_out[at].lines.push(line);
    }
    // Omissions that change the motion come first.
    left_out.sort_by_key(|one| one.effect.is_none());
    left_out
}

/// Turns the text of a URDF or an MJCF file into that of a spec.
///
/// ```
/// let urdf = r#"<robot name="door"><link name="wall"/>
///   <link name="leaf"><inertial><origin xyz="0.4 0 0"/><mass value="20"/>
///     <inertia ixx="0.1" iyy="1.1" izz="1.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
///   <joint name="hinge" type="continuous"><parent link="wall"/><child link="leaf"/>
///     <axis xyz="0 0 1"/></joint></robot>"#;
/// let door = appell_robots::import("door.urdf", urdf, &appell_robots::Options::default()).unwrap();
/// assert!(door.spec.contains("leaf = { parent = \"ground\", about_axis = \"z\", by = \"hinge\" }"));
/// ```
pub fn import(file: &str, text: &str, options: &Options) -> Result<Imported, Failure> {
    let none = |_: &str| Err("only this text is read".to_owned());
    import_with(file, text, options, &none)
}

/// [`import`] with access to other files: `others` reads a file by its path relative to the folder of this one. It is
/// used for includes of an MJCF, and for meshes of bodies without another source of inertia.
pub fn import_with(
    file: &str,
    text: &str,
    options: &Options,
    others: &dyn Fn(&str) -> Result<Vec<u8>, String>,
) -> Result<Imported, Failure> {
    let whole = Whole::read(file, text, others).map_err(Failure::File)?;
    let whole = mjcf::expanded(whole).map_err(Failure::File)?;
    let fail = |mut findings: Vec<Diagnostic>| {
        findings.retain(|finding| finding.severity == Severity::Error);
        Failure::File(Box::new(whole.first_error(findings)))
    };
    let document = xml::parse(&whole.text).map_err(|error| fail(vec![error]))?;
    let findings = xml::Findings::default();
    let root = document.root_element();
    let word = root.tag_name().name();
    let Some(format) = Format::named(word) else {
        let message = format!("the file begins with `<{}>`", appell_spec::shown(word));
        let error = Diagnostic::error(Code::UnknownWord, message).at(xml::tag(root), "");
        let help = did_you_mean(word, ["robot", "mujoco"], || {
            "a URDF begins with `<robot>`, an MJCF with `<mujoco>`".to_owned()
        });
        return Err(fail(vec![error.help(help)]));
    };
    let of_xacro = |element: &xml::Element<'_>| {
        let namespace = element.tag_name().namespace();
        namespace.is_some_and(|name| name.contains("xacro"))
    };
    if let Some(element) = root.descendants().find(of_xacro) {
        let name = appell_spec::shown(element.tag_name().name());
        let error = Diagnostic::error(
            Code::NotAllowedHere,
            format!("`xacro:{name}` is not expanded"),
        );
        return Err(fail(vec![error.at(xml::tag(element), "").help(xml::XACRO)]));
    }
    let mut robot = match format {
        Format::Urdf => urdf::read(root, &findings, options),
        Format::Mjcf => mjcf::read(root, &findings, &whole, options),
    };
    set_base(&mut robot, options);
    for one in &options.without {
        one.apply(&mut robot);
    }
    // Errors of the file are reported before those of the options.
    if !findings.has_errors() {
        lock::lock(&mut robot, &options.lock).map_err(Failure::Lock)?;
    }
    let nearly_right = snap::snap(&mut robot, options.snap);
    let tree = tree::merged(&robot.links, &findings);
    if tree.bodies.is_empty() && !findings.has_errors() {
        let help = "joints are revolute, continuous, prismatic, planar or floating (URDF), hinge, slide, ball or free (MJCF)";
        let message = "the robot has no joint that moves";
        findings.error(Code::MissingSection, xml::tag(root), message, help);
    }
    if tree.bodies.len() > MAX_ITEMS {
        let count = tree.bodies.len();
        let message = format!("the robot has {count} joints that move");
        let help =
            format!("a spec has at most {MAX_ITEMS} coordinates: import a part of the robot");
        findings.error(Code::LimitExceeded, xml::tag(root), message, help);
        return Err(fail(findings.into_inner()));
    }
    let equations = loops::equations(&robot, &tree, &findings);
    if findings.has_errors() {
        return Err(fail(findings.into_inner()));
    }
    let written = spec::write(file, format, &robot, &tree, &equations, options);
    if let Some(unknown) = written.unknown {
        return Err(unknown);
    }
    if let Err(report) = appell_spec::load("robot.toml", &written.text) {
        refuse(&report, &written.lines, xml::tag(root), &findings);
        return Err(fail(findings.into_inner()));
    }
    let findings = findings.into_inner();
    let left_out = left_out(&robot, &whole);
    Ok(Imported {
        spec: written.text,
        name: robot.name.clone(),
        format,
        joints: tree.bodies.len(),
        bodies: tree
            .bodies
            .iter()
            .filter(|body| !body.inertia.is_nothing())
            .count(),
        left_out,
        nearly_right,
        dictionary: written.dictionary,
        warnings: whole.reports(findings),
    })
}
