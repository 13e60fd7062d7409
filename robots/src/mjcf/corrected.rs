//! The text of an MJCF or URDF file with changes of its numbers; everything else stays byte for byte.
//!
//! | file | changes |
//! |---|---|
//! | `corrected/joint.rs` | numbers of joints, springs, readings |
//! | `corrected/body.rs` | masses, centres of mass, inertias, payloads |
//! | `corrected/actuator.rs` | gains, biases, lags, delays, limits of actuators |
//! | `corrected/option.rs` | gravity |
//! | `corrected/keyframe.rs` | states of new joints and filters in keyframes |
//! | `corrected/play.rs` | backlash: a second joint |
//! | `corrected/link.rs` | inertias, damping, friction and payloads of a URDF |
//! | `corrected/sheet.rs` | attributes that are to be written, element by element |
//! | `corrected/change.rs` | the changes, and why one cannot be made |
//! | `corrected/bytes.rs` | replacements of ranges of the text |

mod actuator;
mod body;
mod bytes;
mod change;
mod joint;
mod keyframe;
mod link;
mod option;
mod play;
mod sheet;

use appell_spec::{Code, Diagnostic, Severity};

use crate::Failure;
use crate::format::Format;
use crate::includes::Whole;
use crate::options::Options;
use crate::urdf;
use crate::xml::{self, Findings, parse};

use bytes::Edits;
pub use change::{Amount, Change, Number};
use change::{Refused, refused};
use sheet::Sheet;

/// A file with changes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Corrected {
    /// Its text.
    pub text: String,
    /// The changes, a sentence for each element.
    pub edits: Vec<String>,
}

/// The text of an MJCF or URDF file with changes of its numbers, and with remarks as comments at its head. All other bytes are
/// those of `text`. `others` reads the files that it includes; an element in one of them cannot be changed.
///
/// ```
/// use appell_robots::{Amount, Change, Number, corrected};
///
/// let door = r#"<mujoco>
///   <worldbody><body name="leaf"><inertial pos="0.4 0 0" mass="20" diaginertia="0.1 1.1 1.1"/>
///     <joint name="hinge" axis="0 0 1"   damping="0.5" /> <!-- as measured -->
///   </body></worldbody></mujoco>"#;
/// let friction = Change::number("hinge", Number::Frictionloss, Amount::Add(0.2));
/// let none = |_: &str| Err("only this text is read".to_owned());
/// let better = corrected("door.xml", door, &[friction], &[], &none).unwrap();
/// assert!(better.text.contains(r#"damping="0.5" frictionloss="0.2" /> <!-- as measured -->"#));
/// ```
///
/// # Errors
///
/// The file is no robot, has errors, or lacks an element that is to be changed; or its format cannot express a change.
pub fn corrected(
    file: &str,
    text: &str,
    changes: &[Change],
    remarks: &[String],
    others: &dyn Fn(&str) -> Result<Vec<u8>, String>,
) -> Result<Corrected, Failure> {
    let whole = Whole::read(file, text, others).map_err(Failure::File)?;
    let whole = super::expanded(whole).map_err(Failure::File)?;
    let fail = |mut findings: Vec<Diagnostic>| {
        findings.retain(|finding| finding.severity == Severity::Error);
        Failure::File(Box::new(whole.first_error(findings)))
    };
    let document = parse(&whole.text).map_err(|error| fail(vec![error]))?;
    let root = document.root_element();
    let word = root.tag_name().name();
    let Some(format) = Format::named(word) else {
        let message = format!(
            "the file begins with `<{}>`, and is neither MJCF nor URDF",
            appell_spec::shown(word)
        );
        let help = "corrections are written into files that begin with `<mujoco>` or `<robot>`";
        let error = refused(Code::NotAllowedHere, xml::tag(root), message, help);
        return Err(fail(vec![error]));
    };
    let mut edits = Edits::default();
    edits.remark(text, remarks);
    if changes.is_empty() {
        return Ok(Corrected {
            text: edits.applied(text),
            edits: Vec::new(),
        });
    }
    let findings = Findings::default();
    let options = Options {
        actuators: true,
        ..Options::default()
    };
    let robot = match format {
        Format::Mjcf => super::read(root, &findings, &whole, &options),
        Format::Urdf => urdf::read(root, &findings, &options),
    };
    if findings.has_errors() {
        return Err(fail(findings.into_inner()));
    }
    let mut sheet = Sheet::new(root, format, &whole, text, robot, &findings);
    for change in changes {
        sheet.change(change).map_err(|error| fail(vec![error]))?;
    }
    sheet.finish().map_err(|error| fail(vec![error]))?;
    let said = sheet.write(&mut edits);
    let edits_of = said.map_err(|error| fail(vec![error]))?;
    Ok(Corrected {
        text: edits.applied(text),
        edits: edits_of,
    })
}

impl Sheet<'_, '_> {
    /// Writes what depends on all changes of an element.
    fn finish(&mut self) -> Result<(), Refused> {
        if self.format == Format::Urdf {
            self.write_dynamics()?;
            return self.write_groups();
        }
        self.write_plays()?;
        self.write_groups()?;
        self.write_settled()?;
        self.write_laws()?;
        self.write_keyframes()
    }

    fn change(&mut self, change: &Change) -> Result<(), Refused> {
        if !change.is_expressed_by(self.format) {
            let message = format!(
                "{} cannot express this change: {change:?}",
                self.format.word()
            );
            let help = "it has inertias of links, and damping and friction of joints";
            let place = xml::tag(self.root);
            return Err(refused(Code::NotAllowedHere, place, message, help));
        }
        match change {
            Change::Number { of, number, amount } => self.number(of, *number, *amount),
            Change::Spring {
                joint,
                stiffness,
                relaxed_at,
            } => self.spring(joint, *stiffness, *relaxed_at),
            Change::Centre { body, amounts } => self.centre(body, *amounts),
            Change::Payload { body, mass, at } => self.payload(body, *mass, *at),
            Change::ForceLimit { actuator, range } => self.force_limit(actuator, *range),
            Change::Gravity(gravity) => self.gravity(*gravity),
        }
    }

    fn number(&mut self, of: &str, number: Number, amount: Amount) -> Result<(), Refused> {
        let joint_number: fn(&mut Self, &str, Number, Amount) -> Result<(), Refused> =
            match self.format {
                Format::Urdf => Self::dynamics,
                Format::Mjcf => Self::joint_number,
            };
        match number {
            Number::Damping
            | Number::Frictionloss
            | Number::Armature
            | Number::Stiffness
            | Number::Springref
            | Number::Ref => joint_number(self, of, number, amount),
            Number::Reading => self.reading(of, amount.of(0.0)),
            Number::Play => self.play(of, amount.of(0.0)),
            Number::Mass => self.mass(of, amount),
            Number::Inertia => self.inertia_times(of, amount.of(1.0)),
            Number::Kp => self.kp(of, amount),
            Number::Kv => self.kv(of, amount),
            Number::Gear => self.gear(of, amount),
            Number::Gain => self.gain(of, amount.of(1.0)),
            Number::Bias => self.bias(of, amount.of(0.0)),
            Number::Lag => self.lag(of, amount),
            Number::Delay => self.delay(of, amount),
            Number::ForceRange => self.force_range_by(of, amount),
        }
    }
}
