//! Equations with their subjects, and their lines: breaks of long ones.

use appell_spec::mechanism::{BodyId, ConstraintId, CoordinateId, FrameId, LoadId, PointId};

use super::Math;

/// `left = right` on a line of its own.
#[derive(Debug, Clone, PartialEq)]
pub struct Equation {
    /// Left-hand side.
    pub left: Math,
    /// Right-hand side.
    pub right: Math,
    /// Its subject, in addition to its letters.
    pub about: Option<About>,
    /// The lines of the spec that it depends on, once they are [located](super::locate).
    pub lines: Vec<usize>,
}

impl Equation {
    /// `left = right`
    pub fn new(left: Math, right: Math) -> Self {
        Self {
            left,
            right,
            about: None,
            lines: Vec::new(),
        }
    }

    /// The same, with its subject.
    #[must_use]
    pub fn about(self, about: About) -> Self {
        Self {
            about: Some(about),
            ..self
        }
    }
}

/// A piece of a line: signs and brackets are where a long line may break.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Piece<'a> {
    /// A part that is not broken.
    Whole(&'a Math),
    /// Between two factors of a line.
    Times,
    /// Plus or minus before a term; the first term of a sum has one only if it is subtracted.
    Sign { minus: bool, first: bool },
    /// The equality sign behind a left-hand side that is itself broken.
    Equals,
    /// An opening bracket.
    Open,
    /// A closing bracket.
    Close,
}

/// An equation in lines.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Display<'a> {
    /// Left-hand side, before the equality signs of the list; `None` where it is among the lines.
    pub(super) left: Option<&'a Math>,
    /// The rest.
    pub(super) lines: Vec<Vec<Piece<'a>>>,
}

/// A left-hand side wider than this is not aligned with those of other equations.
const WIDEST_LEFT: usize = 16;

impl Equation {
    /// The equation in lines of about `width` characters; `left_width` is the width of the
    /// left-hand sides of a list.
    pub(super) fn display(&self, width: usize, left_width: usize) -> Display<'_> {
        let mut pieces = Vec::new();
        if self.left.width() <= WIDEST_LEFT {
            flatten(&self.right, 0, &mut pieces);
            let width = width.saturating_sub(left_width + 3);
            let lines = broken(&pieces, width, width);
            return Display {
                left: Some(&self.left),
                lines,
            };
        }
        // The equality sign is the best place to break.
        flatten(&self.left, 1, &mut pieces);
        pieces.push((Piece::Equals, 0));
        flatten(&self.right, 1, &mut pieces);
        Display {
            left: None,
            lines: broken(&pieces, width, width.saturating_sub(CONTINUED)),
        }
    }
}

/// Indentation of the lines of an equation that is broken at its equality sign.
const CONTINUED: usize = 4;

/// Width of the aligned left-hand sides of a list.
pub(super) fn left_width(equations: &[Equation]) -> usize {
    let widths = equations.iter().map(|e| e.left.width());
    widths.filter(|&w| w <= WIDEST_LEFT).max().unwrap_or(0)
}

/// Lines of pieces, broken before signs so that the first and the others fit their widths where possible. A sign outside of
/// brackets is a better place than one inside, unless it leaves most of the line empty.
fn broken<'a>(pieces: &[(Piece<'a>, usize)], first: usize, others: usize) -> Vec<Vec<Piece<'a>>> {
    let sizes: Vec<usize> = pieces.iter().map(|(piece, _)| size(piece)).collect();
    let mut lines = Vec::new();
    let mut start = 0;
    while start < pieces.len() {
        let width = if start == 0 { first } else { others };
        // Possible breaks, with their depth and the width used before them.
        let mut places: Vec<(usize, usize, usize)> = Vec::new();
        let mut used = 0;
        let mut end = start;
        while end < pieces.len() && (used + sizes[end] <= width || places.is_empty()) {
            let (piece, depth) = pieces[end];
            let may_break = matches!(piece, Piece::Equals | Piece::Sign { first: false, .. });
            if may_break && end > start {
                places.push((end, depth, used));
            }
            used += sizes[end];
            end += 1;
        }
        let mut stop = pieces.len();
        if end < stop || used > width {
            let full = places.iter().filter(|&&(_, _, used)| 2 * used >= width);
            let best = full.min_by_key(|&&(place, depth, _)| (depth, std::cmp::Reverse(place)));
            stop = best.or(places.last()).map_or(stop, |&(place, _, _)| place);
        }
        lines.push(with_times(&pieces[start..stop]));
        start = stop;
    }
    lines
}

/// The pieces of a line, factors apart.
fn with_times<'a>(pieces: &[(Piece<'a>, usize)]) -> Vec<Piece<'a>> {
    let mut line = Vec::with_capacity(pieces.len());
    for &(piece, _) in pieces {
        let is_factor = matches!(piece, Piece::Whole(_) | Piece::Open);
        if is_factor && matches!(line.last(), Some(Piece::Whole(_) | Piece::Close)) {
            line.push(Piece::Times);
        }
        line.push(piece);
    }
    line
}

fn size(piece: &Piece<'_>) -> usize {
    match piece {
        Piece::Whole(math) => math.width() + 1,
        Piece::Sign { .. } | Piece::Equals => 2,
        Piece::Open | Piece::Close => 1,
        Piece::Times => 0,
    }
}

fn flatten<'a>(math: &'a Math, depth: usize, pieces: &mut Vec<(Piece<'a>, usize)>) {
    match math {
        Math::Sum(terms) => {
            for (index, &(minus, ref term)) in terms.iter().enumerate() {
                let first = index == 0;
                if !first || minus {
                    pieces.push((Piece::Sign { minus, first }, depth));
                }
                flatten(term, depth, pieces);
            }
        }
        Math::Row(factors) if factors.iter().any(|f| matches!(f, Math::Brackets(_))) => {
            for factor in factors {
                flatten(factor, depth, pieces);
            }
        }
        Math::Brackets(inner) => {
            pieces.push((Piece::Open, depth));
            flatten(inner, depth + 1, pieces);
            pieces.push((Piece::Close, depth));
        }
        whole => pieces.push((Piece::Whole(whole), depth)),
    }
}

/// The subject of an equation, in addition to its letters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum About {
    /// Acceleration energy of a body.
    Body(BodyId),
    /// Velocity or acceleration of a point.
    Point(PointId),
    /// Angular velocity of a frame.
    Frame(FrameId),
    /// A row of a constraint.
    Constraint(ConstraintId),
    /// The rate of a coordinate, which constraints determine.
    Rate(CoordinateId),
    /// Virtual power of a load.
    Load(LoadId),
    /// The inertia of all bodies that move with both pseudo-velocities.
    Inertia(usize, usize),
    /// The generalised force of a pseudo-velocity.
    Force(usize),
    /// The equation of motion of a pseudo-velocity.
    Motion(usize),
    /// All bodies, as in the kinetic energy.
    Bodies,
    /// All loads, as in the potential energy.
    Loads,
}
