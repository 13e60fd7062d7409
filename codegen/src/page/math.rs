//! Formulas as trees, the same for every format.

use super::letters::Letter;

/// A formula. The trees that the writer builds are shallow: what is deep gets a letter of its own.
#[derive(Debug, Clone, PartialEq)]
pub enum Math {
    /// A whole number, in digits.
    Integer(String),
    /// A fraction of two whole numbers, in digits.
    Ratio(String, String),
    /// A letter.
    Letter(Letter),
    /// Upright words, such as the name of a frame.
    Words(String),
    /// A sign between two formulas, such as `=`, `·` or `×`.
    Sign(&'static str),
    /// Formulas side by side: a product.
    Row(Vec<Math>),
    /// A sum; each term with whether it is subtracted.
    Sum(Vec<(bool, Math)>),
    /// A quotient.
    Fraction(Box<Math>, Box<Math>),
    /// A power.
    Power(Box<Math>, Box<Math>),
    /// A function, raised to a power.
    Call(&'static str, u32, Box<Math>),
    /// A square root.
    Root(Box<Math>),
    /// An absolute value.
    Size(Box<Math>),
    /// A formula in brackets.
    Brackets(Box<Math>),
    /// Components, side by side or below each other, and the frame they are written in.
    Vector {
        /// Components.
        components: Vec<Math>,
        /// Frame of the components.
        frame: Option<String>,
        /// Whether they stand below each other.
        column: bool,
    },
    /// A matrix, row by row.
    Matrix(Vec<Vec<Math>>),
    /// `value` where `condition` holds, else `otherwise`.
    Cases {
        /// Value where the condition holds.
        value: Box<Math>,
        /// The condition.
        condition: Box<Math>,
        /// Value elsewhere.
        otherwise: Box<Math>,
    },
}

impl Math {
    /// A small whole number.
    pub fn integer(value: usize) -> Self {
        Self::Integer(value.to_string())
    }

    /// Zero.
    pub fn zero() -> Self {
        Self::integer(0)
    }

    /// Whether it is the number `value`.
    pub fn is_integer(&self, value: &str) -> bool {
        matches!(self, Self::Integer(digits) if digits == value)
    }

    /// A product, flat and without brackets that are not needed.
    pub fn product(factors: Vec<Self>) -> Self {
        let several = factors.len() > 1;
        let mut row = Vec::with_capacity(factors.len());
        for factor in factors {
            match factor {
                Self::Row(inner) => row.extend(inner),
                Self::Sum(mut single) if single.len() == 1 && !single[0].0 => {
                    row.push(single.remove(0).1);
                }
                sum @ (Self::Sum(_) | Self::Cases { .. }) if several => {
                    row.push(Self::Brackets(Box::new(sum)));
                }
                other => row.push(other),
            }
        }
        if row.len() == 1 {
            row.remove(0)
        } else {
            Self::Row(row)
        }
    }

    /// A sum of signed terms, flat; zero where there is none.
    pub fn sum(terms: Vec<(bool, Self)>) -> Self {
        let mut flat = Vec::with_capacity(terms.len());
        for (minus, term) in terms {
            match term {
                Self::Sum(inner) => flat.extend(inner.into_iter().map(|(m, t)| (m != minus, t))),
                zero if zero.is_integer("0") => {}
                other => flat.push((minus, other)),
            }
        }
        match flat.as_slice() {
            [] => Self::zero(),
            [(false, _)] => flat.remove(0).1,
            _ => Self::Sum(flat),
        }
    }

    /// A quotient.
    pub fn fraction(above: Self, below: Self) -> Self {
        Self::Fraction(Box::new(above), Box::new(below))
    }

    /// ∂above/∂below
    pub fn partial(above: Letter, below: Letter) -> Self {
        Self::fraction(
            Self::Letter(above.before('∂')),
            Self::Letter(below.before('∂')),
        )
    }

    /// Components in a frame, side by side where they are short.
    pub fn vector(components: Vec<Self>, frame: &str) -> Self {
        const LONGEST_ROW: usize = 34;
        let width: usize = components.iter().map(Self::width).sum();
        let column = width > LONGEST_ROW;
        Self::Vector {
            components,
            frame: Some(frame.to_owned()),
            column,
        }
    }

    /// Whether a quotient is among its outer parts, which makes it taller than a line.
    pub(super) fn has_fraction(&self) -> bool {
        match self {
            Self::Fraction(..) => true,
            Self::Row(parts) => parts.iter().any(|p| matches!(p, Self::Fraction(..))),
            Self::Sum(terms) => terms.iter().any(|(_, term)| match term {
                Self::Row(parts) => parts.iter().any(|p| matches!(p, Self::Fraction(..))),
                term => matches!(term, Self::Fraction(..)),
            }),
            _ => false,
        }
    }

    /// How wide it is, roughly, in characters of a line.
    pub fn width(&self) -> usize {
        super::text::inline(self)
            .chars()
            .filter(|&c| !super::text::is_combining(c))
            .count()
    }
}

/// `left = right` on a line of its own.
#[derive(Debug, Clone, PartialEq)]
pub struct Equation {
    /// Left-hand side.
    pub left: Math,
    /// Right-hand side.
    pub right: Math,
}

impl Equation {
    /// `left = right`
    pub fn new(left: Math, right: Math) -> Self {
        Self { left, right }
    }
}

/// A piece of a line: signs and brackets are where a long line may break.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Piece<'a> {
    /// What stays together.
    Whole(&'a Math),
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
pub(super) const WIDEST_LEFT: usize = 16;

impl Equation {
    /// The equation in lines of about `width` characters; `left_width` is what the left-hand sides
    /// of a list take.
    pub(super) fn display(&self, width: usize, left_width: usize) -> Display<'_> {
        let mut pieces = Vec::new();
        if self.left.width() <= WIDEST_LEFT {
            flatten(&self.right, 0, &mut pieces);
            let lines = broken(&pieces, width.saturating_sub(left_width + 3));
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
            lines: broken(&pieces, width),
        }
    }
}

/// How wide the aligned left-hand sides of a list are.
pub(super) fn left_width(equations: &[Equation]) -> usize {
    equations
        .iter()
        .map(|e| e.left.width())
        .filter(|&w| w <= WIDEST_LEFT)
        .max()
        .unwrap_or(0)
}

/// Lines of pieces, broken before signs so that each fits `width` where possible. A sign outside of
/// brackets is a better place than one inside, unless it leaves most of the line empty.
fn broken<'a>(pieces: &[(Piece<'a>, usize)], width: usize) -> Vec<Vec<Piece<'a>>> {
    let sizes: Vec<usize> = pieces.iter().map(|(piece, _)| size(piece)).collect();
    let mut lines = Vec::new();
    let mut start = 0;
    while start < pieces.len() {
        // Places to break, with their depth and the width used before them.
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
        let stop = if end == pieces.len() && used <= width {
            end
        } else {
            let full = places.iter().filter(|&&(_, _, used)| 2 * used >= width);
            let best = full.min_by_key(|&&(place, depth, _)| (depth, std::cmp::Reverse(place)));
            best.or(places.last())
                .map_or(pieces.len(), |&(place, _, _)| place)
        };
        lines.push(
            pieces[start..stop]
                .iter()
                .map(|(piece, _)| *piece)
                .collect(),
        );
        start = stop;
    }
    lines
}

fn size(piece: &Piece<'_>) -> usize {
    match piece {
        Piece::Whole(math) => math.width() + 1,
        Piece::Sign { .. } | Piece::Equals => 2,
        Piece::Open | Piece::Close => 1,
    }
}

fn flatten<'a>(math: &'a Math, depth: usize, pieces: &mut Vec<(Piece<'a>, usize)>) {
    match math {
        Math::Sum(terms) => {
            for (index, (minus, term)) in terms.iter().enumerate() {
                let first = index == 0;
                if !first || *minus {
                    pieces.push((
                        Piece::Sign {
                            minus: *minus,
                            first,
                        },
                        depth,
                    ));
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
