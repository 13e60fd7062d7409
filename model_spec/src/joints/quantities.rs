//! The coordinates and pseudo-velocities of the kinds of joints: their names, units and meanings.

use crate::ast::{ItemAst, ValueAst};
use crate::expr::Span;
use crate::language::{ItemKind, JointWord, Sense};

use super::direction::AXES;

/// Name, unit and description of a quantity of a kind of joint.
type Known = (String, &'static str, &'static str);

/// A coordinate or pseudo-velocity that a joint introduces.
#[derive(Debug, Clone)]
pub(super) struct JointQuantity {
    /// Its name.
    pub(super) name: String,
    /// Position of its name in the spec; `None` if it is named after the joint.
    pub(super) written: Option<Span>,
    /// Its unit.
    pub(super) unit: &'static str,
    /// Its description.
    pub(super) about: &'static str,
}

/// The kind of a joint.
pub(super) fn word(item: &ItemAst) -> Option<JointWord> {
    match item.kind.map(|kind| kind.is) {
        Some(ItemKind::Joint(word)) => Some(word),
        _ => None,
    }
}

/// The coordinates of a joint, in order.
pub(super) fn coordinates(item: &ItemAst) -> Vec<JointQuantity> {
    let angle = |stem: &str| (stem.to_owned(), "rad", "angle");
    let way = |stem: &str| (stem.to_owned(), "m", "displacement");
    let quaternion = || {
        let parts = ["scalar part of the attitude"; 1].into_iter();
        let parts = parts.chain(["vector part of the attitude"; 3]);
        parts
            .enumerate()
            .map(|(part, about)| (format!("e{part}"), "1", about))
    };
    let known: Vec<Known> = match word(item) {
        Some(JointWord::Revolute | JointWord::Screw) => vec![angle("q")],
        Some(JointWord::Prismatic) => vec![way("q")],
        Some(JointWord::Cylindrical) => vec![angle("q"), way("s")],
        Some(JointWord::Universal) => vec![angle("q1"), angle("q2")],
        Some(JointWord::Planar) => {
            let [first, second] = plane(item).map(|axis| way(AXES[axis]));
            vec![first, second, angle("q")]
        }
        Some(JointWord::Ball) => quaternion().collect(),
        Some(JointWord::Free) => AXES.map(way).into_iter().chain(quaternion()).collect(),
        Some(JointWord::Fixed) | None => Vec::new(),
    };
    named(item, known, ["coordinate", "coordinates"])
}

/// The pseudo-velocities of a joint, in order; none if its rates are determined by constraints.
pub(super) fn speeds(item: &ItemAst) -> Vec<JointQuantity> {
    if item.flag("dependent") {
        return Vec::new();
    }
    let turning = |stem: &str| (stem.to_owned(), "rad/s", "angular velocity");
    let moving = |stem: &str| (stem.to_owned(), "m/s", "velocity");
    let about_all = || AXES.map(|axis| turning(&format!("omega_{axis}")));
    let along = |axis: &str| moving(&format!("v_{axis}"));
    let known: Vec<Known> = match word(item) {
        Some(JointWord::Revolute | JointWord::Screw) => vec![turning("omega")],
        Some(JointWord::Prismatic) => vec![moving("v")],
        Some(JointWord::Cylindrical) => vec![turning("omega"), moving("v")],
        Some(JointWord::Universal) => vec![turning("omega1"), turning("omega2")],
        Some(JointWord::Planar) => {
            let [first, second] = plane(item).map(|axis| along(AXES[axis]));
            vec![first, second, turning("omega")]
        }
        Some(JointWord::Ball) => about_all().into(),
        Some(JointWord::Free) => AXES.map(along).into_iter().chain(about_all()).collect(),
        Some(JointWord::Fixed) | None => Vec::new(),
    };
    named(item, known, ["speed", "speeds"])
}

/// The two axes of the plane of a joint, which form a right-handed system with its normal.
pub(super) fn plane(item: &ItemAst) -> [usize; 2] {
    match item.word("axis") {
        Some(Sense::Axis { axis, .. }) => [(axis.index() + 1) % 3, (axis.index() + 2) % 3],
        _ => [0, 1],
    }
}

fn named(item: &ItemAst, known: Vec<Known>, keys: [&str; 2]) -> Vec<JointQuantity> {
    let written = |place: usize| {
        let entry = keys.iter().find_map(|key| item.entry(key))?;
        match &entry.value {
            ValueAst::Text(name) => Some((name.clone(), entry.span.clone())),
            ValueAst::Names(names) => {
                let name = names.get(place)?;
                Some((name.value.clone(), name.span.clone()))
            }
            _ => None,
        }
    };
    let own = known.into_iter().enumerate();
    own.map(|(place, (stem, unit, about))| {
        let (name, written) = match written(place) {
            Some((name, span)) => (name, Some(span)),
            None => (format!("{stem}_{}", item.name.value), None),
        };
        JointQuantity {
            name,
            written,
            unit,
            about,
        }
    })
    .collect()
}
