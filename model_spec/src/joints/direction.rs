//! Axes of joints: rotations about them, displacements along them.

use num_rational::BigRational;
use num_traits::{One, Signed, Zero};

use crate::ast::{ItemAst, ValueAst};
use crate::axis::Axis;
use crate::diagnostic::{Code, Diagnostic};
use crate::language::Sense;

use super::piece::Piece;
use super::written::Written;

/// The axes of a frame.
pub(super) const AXES: [&str; 3] = Axis::LETTERS;

/// A turn of a frame: the word of its axis, as TOML, and the angle.
pub(super) type Turn = (Piece, Written);

/// Direction of the axis of a joint.
#[derive(Debug, Clone)]
pub(super) enum Direction {
    /// Along an axis of the frame, or against it.
    Along {
        /// Which one.
        index: usize,
        /// Whether it points backwards.
        negative: bool,
    },
    /// Anywhere else.
    Vector(Box<[Written; 3]>),
}

impl Direction {
    /// The direction under a key; `None` where the key is missing.
    pub(super) fn new(text: &str, item: &ItemAst, key: &str) -> Result<Option<Self>, Diagnostic> {
        let Some(entry) = item.entry(key) else {
            return Ok(None);
        };
        let components = match &entry.value {
            ValueAst::Word(Sense::Axis { axis, negative }) => {
                return Ok(Some(Self::Along {
                    index: axis.index(),
                    negative: *negative,
                }));
            }
            ValueAst::Components(components) => components,
            _ => return Ok(None),
        };
        let components = components.each_ref().map(|one| Written::new(text, one));
        let present: Vec<usize> = (0..3).filter(|&i| !components[i].is_zero()).collect();
        let literal = |&index: &usize| components[index].literal.as_ref();
        Ok(Some(match present.as_slice() {
            [] => {
                let name = &item.name.value;
                let help = "write one of the words `x`, `y`, `z`, `-x`, `-y`, `-z`, or a direction that is not zero";
                return Err(Diagnostic::error(
                    Code::NotPhysical,
                    format!("the axis of the joint `{name}` has length 0"),
                )
                .at(entry.span.clone(), "points nowhere")
                .help(help));
            }
            [index] if literal(index).is_some() => Self::Along {
                index: *index,
                negative: literal(index).is_some_and(Signed::is_negative),
            },
            _ => Self::Vector(Box::new(components)),
        }))
    }

    /// The rotations of a frame about the axis by an angle; for the angle 0 their product is the identity.
    pub(super) fn turns(&self, by: &Written) -> Vec<Turn> {
        let components = match self {
            Self::Along { index, negative } => return vec![(word(*index, *negative), by.clone())],
            Self::Vector(components) => components,
        };
        let atan2 = |y: &Piece, x: &Piece| {
            let call = Piece::new("atan2(").then(y).word(", ").then(x).word(")");
            Written::made(call, true)
        };
        let [x, y, z] = components.each_ref().map(|one| &one.piece);
        // In a coordinate plane, one rotation maps the first axis to the direction, and another one back.
        if let Some(across) = (0..3).find(|&i| components[i].is_zero()) {
            let [first, second] = [(across + 1) % 3, (across + 2) % 3];
            let angle = atan2(&components[second].piece, &components[first].piece);
            return vec![
                (word(across, false), angle.clone()),
                (word(first, false), by.clone()),
                (word(across, true), angle),
            ];
        }
        let azimuth = atan2(y, x);
        let across = Piece::new("hypot(").then(x).word(", ").then(y).word(")");
        let elevation = atan2(z, &across);
        vec![
            (word(2, false), azimuth.clone()),
            (word(1, true), elevation.clone()),
            (word(0, false), by.clone()),
            (word(1, false), elevation),
            (word(2, true), azimuth),
        ]
    }

    /// A position displaced along the axis by a distance.
    pub(super) fn moved(&self, place: &[Written; 3], by: &Written) -> [Written; 3] {
        let mut moved = place.clone();
        match self {
            Self::Along { index, negative } => {
                let component = &mut moved[*index];
                *component = if *negative {
                    component.minus(by)
                } else {
                    component.plus(by)
                };
            }
            Self::Vector(components) => {
                let length = length(components);
                for (component, part) in moved.iter_mut().zip(components.iter()) {
                    if part.is_zero() {
                        continue;
                    }
                    let way = by.factor().word("*").then(&part.factor());
                    let way = match &length {
                        Some(length) => way.word("/").then(length),
                        None => way,
                    };
                    *component = component.plus(&Written::made(way, false));
                }
            }
        }
        moved
    }
}

/// An axis as a word of TOML.
pub(super) fn word(index: usize, negative: bool) -> Piece {
    let sign = if negative { "-" } else { "" };
    Piece::new(format!("\"{sign}{}\"", AXES[index]))
}

/// The length of a direction, unless it is 1.
fn length(components: &[Written; 3]) -> Option<Piece> {
    let pure = |part: &'_ Written| !part.piece.text.contains('[');
    let literal: Option<Vec<&BigRational>> = components
        .iter()
        .map(|part| part.literal.as_ref().filter(|_| pure(part)))
        .collect();
    let square = literal.map(|all| all.iter().fold(BigRational::zero(), |sum, x| sum + *x * *x));
    if square.is_some_and(|square| square.is_one()) {
        return None;
    }
    let squares = components.iter().filter(|part| !part.is_zero());
    let squares: Vec<Piece> = squares.map(|part| part.factor().word("^2")).collect();
    Some(Piece::joined(&squares, " + ").within("sqrt(", ")"))
}
