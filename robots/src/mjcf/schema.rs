//! The elements and attributes of MJCF, as of `MuJoCo` 4.0, and their treatment: read, without effect on the motion, or
//! left out, with a sentence on how the motion differs. Anything else is refused as invalid.

use appell_spec::{Code, did_you_mean};
use roxmltree::Attribute;

use crate::model::LeftOut;
use crate::xml::{Element, Findings, elements, tag};

/// An element, within some others.
struct Row {
    element: &'static str,
    /// Possible parents; `body` stands for all elements that can contain bodies.
    within: &'static str,
    /// Attributes that are read.
    read: &'static str,
    /// Attributes without effect on the motion: of pictures, names, sensors, solvers and contacts.
    idle: &'static str,
    /// Attributes that would change the motion: name, neutral value, effect.
    left_out: &'static [(&'static str, &'static str, &'static str)],
    /// Whether its attributes and children are checked.
    open: bool,
    /// How the motion differs where the whole element is left out.
    effect: Option<&'static str>,
}

/// An element that is read, with nothing in it.
const ROW: Row = Row {
    element: "",
    within: "",
    read: "",
    idle: "",
    left_out: &[],
    open: true,
    effect: None,
};

/// Rows; fields that are not given are those of [`ROW`].
macro_rules! rows {
    ($({ $($field:ident: $value:expr),* })*) => {
        &[$(Row { $($field: $value,)* ..ROW }),*]
    };
}

const OFF: &str = "disable";
const ON: &str = "enable";
const FLUID: &str = "lift, drag and viscous forces of the medium do not act";
const ACTUATOR: &str =
    "its force is an input of the joint; its law, its bounds and its own states do not act";
const DRIVE_BOUND: &str = "forces of actuators are not bounded";
const ALIGNED: &str = "coordinates of the free joint are those of the body's frame, where MuJoCo's are those of its \
                       centre of mass and principal axes";
const YIELD: &str = "the spring does not yield";
const TENDON: &str = "it resists nothing and bounds nothing";
/// Effect of contacts.
pub(super) const TOUCH: &str = "bodies pass through each other";

/// All elements with their attributes.
const TABLE: &[Row] = rows! {
    { element: "mujoco", within: "", read: "model" }
    { element: "compiler", within: "mujoco",
      read: "angle assetdir autolimits balanceinertia boundinertia boundmass coordinate eulerseq inertiafromgeom \
             inertiagrouprange meshdir settotalmass strippath",
      idle: "conflict convexhull discardvisual fitaabb fusestatic passthrough savecanonical savecompiled \
             saveinertial texturedir usethread",
      left_out: &[
          ("alignfree", "false", ALIGNED),
          ("exactmeshinertia", "false", "meshes have their inertia by MuJoCo's older way"),
      ] }
    { element: "lengthrange", within: "compiler", open: false }
    { element: "option", within: "mujoco", read: "gravity",
      idle: "apirate ccd_iterations ccd_tolerance collision cone impratio integrator iterations jacobian \
             ls_iterations ls_tolerance magnetic mpr_iterations mpr_tolerance noslip_iterations noslip_tolerance \
             o_friction o_margin o_solimp o_solref sdf_initpoints sdf_iterations sleep_tolerance solver timestep \
             tolerance",
      left_out: &[
          ("density", "0", FLUID),
          ("viscosity", "0", FLUID),
          ("wind", "0", "the medium is at rest"),
          ("actuatorgroupdisable", "", "their joints have inputs all the same"),
      ] }
    { element: "flag", within: "option",
      read: "constraint contact damper equality frictionloss gravity limit passive spring",
      idle: "autoreset clampctrl diagexact energy eulerdamp filterparent fwdinv invdiscrete ipc island midphase \
             multiccd nativeccd override refsafe sensor sensornoise sleep speculative warmstart",
      left_out: &[("actuation", ON, "joints have inputs all the same")] }
    { element: "size statistic visual sensor keyframe custom extension", within: "mujoco", open: false }
    { element: "default", within: "mujoco default", read: "class" }
    { element: "asset", within: "mujoco" }
    { element: "mesh", within: "asset default", read: "class file inertia name refpos refquat scale",
      idle: "builtin content_type face material maxhullvert normal params smoothnormal texcoord vertex" }
    { element: "plugin", within: "mesh geom actuator sensor", open: false }
    { element: "hfield", within: "asset", read: "file name size", idle: "content_type elevation ncol nrow" }
    { element: "skin", within: "asset deformable", open: false }
    { element: "texture material", within: "asset default", open: false }
    { element: "model", within: "asset", read: "content_type file name" }
    { element: "worldbody", within: "mujoco" }
    { element: "body", within: "body", read: "axisangle childclass euler gravcomp name pos quat xyaxes zaxis",
      idle: "fuse simple sleep user", left_out: &[("mocap", "false", "it stands still")] }
    { element: "frame", within: "body", read: "axisangle childclass euler name pos quat xyaxes zaxis" }
    { element: "replicate", within: "mujoco body", read: "childclass count euler offset sep" }
    { element: "attach", within: "body", read: "body frame model prefix" }
    { element: "inertial", within: "body", read: "axisangle diaginertia euler fullinertia mass pos quat xyaxes zaxis" }
    { element: "joint", within: "body default",
      read: "armature axis class damping frictionloss limited name pos range ref springdamper springref stiffness type",
      idle: "actuatorgravcomp group solimpfriction solimplimit solreffriction solreflimit user",
      left_out: &[
          ("actuatorfrcrange", "0", DRIVE_BOUND),
          ("actuatorfrclimited", "false|auto", DRIVE_BOUND),
          ("margin", "0", "the limit begins at the range itself"),
          ("springyield", "0", YIELD),
      ] }
    { element: "freejoint", within: "body", read: "name", idle: "group", left_out: &[("align", "false|auto", ALIGNED)] }
    { element: "geom", within: "body default",
      read: "axisangle class conaffinity contype density euler fromto group hfield mass mesh name pos quat \
             shellinertia size type xyaxes zaxis",
      idle: "adhesion castshadow condim fitscale fluidcoef fluidshape friction gap margin material priority rgba \
             solimp solmix solref surfacevel user" }
    { element: "site", within: "body default", read: "axisangle class euler fromto name pos quat xyaxes zaxis",
      idle: "group material mesh rgba size type user" }
    { element: "camera light", within: "body default", open: false }
    { element: "plugin", within: "body", open: false, effect: Some("its forces do not act") }
    { element: "composite flexcomp", within: "body", open: false }
    { element: "deformable", within: "mujoco" }
    { element: "flex", within: "deformable", open: false, effect: Some("its elastic forces do not act") }
    { element: "contact", within: "mujoco" }
    { element: "pair", within: "contact", open: false, effect: Some(TOUCH) }
    { element: "pair", within: "default", open: false }
    { element: "exclude", within: "contact", open: false }
    { element: "tendon", within: "mujoco" }
    { element: "spatial fixed", within: "tendon",
      read: "armature class damping frictionloss limited name range springlength stiffness",
      idle: "group margin material rgba solimpfriction solimplimit solreffriction solreflimit user width",
      left_out: &[
          ("actuatorfrcrange", "0", DRIVE_BOUND),
          ("actuatorfrclimited", "false|auto", DRIVE_BOUND),
          ("springyield", "0", YIELD),
      ] }
    { element: "tendon", within: "default",
      read: "armature class damping frictionloss limited name range springlength stiffness",
      idle: "group margin material rgba solimpfriction solimplimit solreffriction solreflimit user width",
      left_out: &[
          ("actuatorfrcrange", "0", DRIVE_BOUND),
          ("actuatorfrclimited", "false|auto", DRIVE_BOUND),
          ("springyield", "0", YIELD),
      ] }
    { element: "joint", within: "fixed", read: "coef joint" }
    { element: "site", within: "spatial", read: "site" }
    { element: "geom", within: "spatial", read: "geom sidesite" }
    { element: "pulley", within: "spatial", read: "divisor" }
    { element: "equality", within: "mujoco" }
    { element: "equality", within: "default", read: "active", idle: "solimp solref" }
    { element: "connect", within: "equality", read: "active anchor body1 body2 class name site1 site2",
      idle: "solimp solref" }
    { element: "weld", within: "equality",
      read: "active anchor body1 body2 class name relpose site1 site2 torquescale", idle: "solimp solref" }
    { element: "joint", within: "equality", read: "active class joint1 joint2 name polycoef", idle: "solimp solref" }
    { element: "tendon", within: "equality", read: "active class name polycoef tendon1 tendon2", idle: "solimp solref" }
    { element: "flex flexvert", within: "equality", read: "active class flex name", idle: "solimp solref" }
    { element: "flexstrain", within: "equality", read: "active cell class flex name", idle: "solimp solref" }
    { element: "distance", within: "equality", read: "active class name geom1 geom2 distance", idle: "solimp solref" }
    { element: "actuator", within: "mujoco" }
    { element: ACTUATORS, within: "actuator default", open: false, effect: Some(ACTUATOR) }
};

/// The kinds of actuators.
pub(super) const ACTUATORS: &str = "general motor position velocity intvelocity orientation pid damper cylinder muscle \
                                    adhesion dcmotor";

/// Whether a word is one of several, separated by blanks.
pub(super) fn has(words: &str, word: &str) -> bool {
    words.split_ascii_whitespace().any(|own| own == word)
}

/// The kind of an element as a parent.
fn kind(holder: Element<'_>) -> &str {
    match holder.tag_name().name() {
        "worldbody" | "frame" | "replicate" => "body",
        name => name,
    }
}

fn row(element: Element<'_>) -> Option<&'static Row> {
    let holder = element.parent_element().map_or("", kind);
    let name = element.tag_name().name();
    let fits =
        |row: &&Row| has(row.element, name) && (has(row.within, holder) || holder == row.within);
    TABLE.iter().find(fits)
}

/// How the motion differs where an element is left out.
pub(super) fn effect(element: Element<'_>) -> Option<&'static str> {
    match element.tag_name().name() {
        "spatial" | "fixed" => Some(TENDON),
        _ => row(element)?.effect,
    }
}

/// Refuses elements and attributes that MJCF does not have, and lists attributes that are left out.
pub(super) fn check(root: Element<'_>, findings: &Findings, left_out: &mut Vec<LeftOut>) {
    let mut open = vec![root];
    while let Some(element) = open.pop() {
        let name = element.tag_name().name();
        let Some(row) = row(element) else {
            let holder = element.parent_element();
            let all = || {
                TABLE
                    .iter()
                    .filter(|row| holder.is_some_and(|holder| has(row.within, kind(holder))))
            };
            let known = all().flat_map(|row| row.element.split_ascii_whitespace());
            let within = holder.map_or("", |holder| holder.tag_name().name());
            let message = format!("`{within}` holds no element `{}`", appell_spec::shown(name));
            let help = did_you_mean(name, known, || {
                "MuJoCo 4.0 allows none there: move it, or remove it".to_owned()
            });
            findings.error(Code::UnknownKey, tag(element), message, help);
            continue;
        };
        if !row.open {
            continue;
        }
        for attribute in element.attributes() {
            let key = attribute.name();
            if let Some((_, idle, effect)) = row.left_out.iter().find(|(own, ..)| *own == key) {
                if !changes_nothing(attribute.value(), idle) {
                    left_out.push(LeftOut {
                        what: format!("{name}/{key}"),
                        name: element.attribute("name").map(str::to_owned),
                        effect: Some(effect),
                        place: attribute.range(),
                    });
                }
            } else if !has(row.read, key) && !has(row.idle, key) {
                let all = [row.read, row.idle]
                    .into_iter()
                    .flat_map(str::split_ascii_whitespace);
                let all = all.chain(row.left_out.iter().map(|(own, ..)| *own));
                unknown_attribute(name, &attribute, all, findings);
            }
        }
        let inner: Vec<Element<'_>> = elements(element).collect();
        open.extend(inner.into_iter().rev());
    }
}

/// Refuses an attribute that elements of a name do not have.
pub(super) fn unknown_attribute<'a>(
    element: &str,
    attribute: &Attribute<'_, '_>,
    known: impl IntoIterator<Item = &'a str>,
    findings: &Findings,
) {
    let key = attribute.name();
    let message = format!("`{element}` has no attribute `{}`", appell_spec::shown(key));
    let otherwise = "MuJoCo 4.0 does not know it: remove it, or correct its name";
    let help = did_you_mean(key, known, || otherwise.to_owned());
    findings.error(Code::UnknownKey, attribute.range(), message, help);
}

/// Whether a value of an attribute is neutral: one of several words, or zeros.
fn changes_nothing(value: &str, idle: &str) -> bool {
    let zero = |word: &str| word.parse::<f64>().is_ok_and(|number| number == 0.0);
    let mut words = value.split_ascii_whitespace();
    idle.split('|').any(|word| word == value) || (idle == "0" && words.all(zero))
}

/// Whether a feature is disabled by its flag in `option`.
pub(super) fn disabled(root: Element<'_>, flag: &str) -> bool {
    let options = elements(root).filter(|section| section.has_tag_name("option"));
    let flags = options.flat_map(|option| elements(option).filter(|one| one.has_tag_name("flag")));
    let given = flags.filter_map(|flags| flags.attribute(flag));
    given.last() == Some(OFF)
}
