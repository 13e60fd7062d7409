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
//! | `includes.rs` | a file with those that it includes, as one text |
//! | `format.rs` | the formats |
//! | `xml.rs` | elements and numbers with their places, and findings about them |
//! | `urdf.rs`, `mjcf.rs` | the formats, each to a `Robot` |
//! | `model.rs` | what a robot is: links in a tree, joints with their properties |
//! | `rotation.rs`, `inertia.rs` | rotations and their turns; inertias turned, shifted, put together |
//! | `tree.rs` | links that are fixed together become one body |
//! | `loops.rs` | what connects two links of the tree: equations, and which coordinates follow from them |
//! | `names.rs`, `letters.rs` | valid names; numbers written out or as parameters |
//! | `options.rs`, `without.rs`, `snap.rs` | requests; what is left out; nearly right angles |
//! | `spec.rs`, `table.rs` | the sections of the spec, and their text |

mod format;
mod includes;
mod inertia;
mod letters;
mod loops;
mod mjcf;
mod model;
mod names;
mod options;
mod rotation;
mod snap;
mod spec;
mod table;
mod tree;
mod urdf;
mod without;
mod xml;

use appell_spec::{Code, Diagnostic, Report, did_you_mean};

use includes::Whole;

pub use format::Format;
pub use includes::MAX_FILE;
pub use letters::Letters;
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
    /// What has no counterpart in the spec.
    pub left_out: Vec<LeftOut>,
    /// Orientations and axes that are nearly along the axes of their parents.
    pub nearly_right: usize,
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
}

/// Why a robot cannot be imported.
#[derive(Debug)]
pub enum Failure {
    /// Its file, or one that it includes, is wrong or has what cannot be imported; the report is about one file.
    File(Box<Report>),
    /// Names that are to become parameters but name nothing.
    Unknown {
        /// The first one.
        name: String,
        /// What may be meant.
        help: String,
    },
}

/// Frees the links that nothing else moves or holds.
fn float(robot: &mut model::Robot) {
    for link in &mut robot.links {
        if link.parent.is_none() && link.joint.is_none() {
            let name = link.name.clone();
            link.joint = Some(model::Joint::without_axis(
                name,
                model::Motion::Free,
                [0.0; 3],
            ));
        }
    }
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
    import_with(file, text, options, &|_| None)
}

/// [`import`] where files that this one names may be read: `others` gives the bytes of a file by its path from
/// the folder of this one. An MJCF includes others, and meshes are read where a body has no other inertia.
pub fn import_with(
    file: &str,
    text: &str,
    options: &Options,
    others: &dyn Fn(&str) -> Option<Vec<u8>>,
) -> Result<Imported, Failure> {
    let whole = Whole::read(file, text, others).map_err(Failure::File)?;
    let fail = |findings: Vec<Diagnostic>| Failure::File(Box::new(whole.first_error(findings)));
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
    let mut robot = match format {
        Format::Urdf => urdf::read(root, &findings),
        Format::Mjcf => mjcf::read(root, &findings, &whole),
    };
    if options.floating {
        float(&mut robot);
    }
    for one in &options.without {
        one.apply(&mut robot);
    }
    let nearly_right = snap::snap(&mut robot, options.snap);
    let tree = tree::merged(&robot.links, &findings);
    if tree.bodies.is_empty() && !findings.has_errors() {
        let help = "joints are revolute, continuous, prismatic, planar or floating (URDF), hinge, slide, ball or free (MJCF)";
        findings.error(
            Code::MissingSection,
            xml::tag(root),
            "the robot has no joint that moves",
            help,
        );
    }
    let meetings = loops::meetings(&robot, &tree, &findings);
    if findings.has_errors() {
        return Err(fail(findings.into_inner()));
    }
    let findings = findings.into_inner();
    let written = spec::write(file, format, &robot, &tree, &meetings, options);
    if let Some(name) = written.unused.first() {
        let known = written.known.iter().map(String::as_str);
        let help = did_you_mean(name, known, || {
            "name links, joints or parameters of the robot".to_owned()
        });
        return Err(Failure::Unknown {
            name: name.clone(),
            help,
        });
    }
    let mut left_out: Vec<LeftOut> = Vec::new();
    for (what, all) in spec::grouped(&robot.left_out) {
        let first = left_out.len();
        for one in all {
            let (file, line) = whole.line(&one.place);
            match left_out[first..].iter_mut().find(|own| own.file == file) {
                Some(own) => own.lines.push(line),
                None => left_out.push(LeftOut {
                    what: what.to_owned(),
                    file: file.to_owned(),
                    lines: vec![line],
                }),
            }
        }
    }
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
        warnings: whole.reports(findings),
    })
}
