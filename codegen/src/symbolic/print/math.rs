//! Formulas as trees, independent of the output format.

use super::letter::Letter;

/// A formula. The trees that the writer builds are shallow: deep subexpressions are replaced by letters.
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
    /// Adjacent formulas: a product.
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
    /// Components, in a row or a column, and the frame in which they are given.
    Vector {
        /// Components.
        components: Vec<Math>,
        /// Frame of the components.
        frame: Option<String>,
        /// Whether they form a column.
        column: bool,
    },
    /// A matrix, row by row.
    Matrix(Vec<Vec<Math>>),
    /// `value` if `condition` holds, else `otherwise`.
    Cases {
        /// Value where the condition holds.
        value: Box<Math>,
        /// The condition.
        condition: Box<Math>,
        /// Value otherwise.
        otherwise: Box<Math>,
    },
}

impl Math {
    /// Changes every letter, in reading order.
    pub fn for_each_letter(&mut self, change: &mut dyn FnMut(&mut Letter)) {
        match self {
            Self::Letter(letter) => {
                change(letter);
                if let Some(by) = &mut letter.by {
                    change(by);
                }
            }
            Self::Row(parts)
            | Self::Vector {
                components: parts, ..
            } => {
                for part in parts {
                    part.for_each_letter(change);
                }
            }
            Self::Sum(terms) => {
                for (_, term) in terms {
                    term.for_each_letter(change);
                }
            }
            Self::Fraction(first, second) | Self::Power(first, second) => {
                first.for_each_letter(change);
                second.for_each_letter(change);
            }
            Self::Call(_, _, inner)
            | Self::Root(inner)
            | Self::Size(inner)
            | Self::Brackets(inner) => inner.for_each_letter(change),
            Self::Matrix(rows) => {
                for entry in rows.iter_mut().flatten() {
                    entry.for_each_letter(change);
                }
            }
            Self::Cases {
                value,
                condition,
                otherwise,
            } => {
                for part in [value, condition, otherwise] {
                    part.for_each_letter(change);
                }
            }
            Self::Integer(_) | Self::Ratio(..) | Self::Words(_) | Self::Sign(_) => {}
        }
    }

    /// Written terms with the signs before a first term that is subtracted, and before other ones that are added or
    /// subtracted.
    pub(super) fn signed(
        terms: &[(bool, Self)],
        [first_minus, plus, minus]: [&str; 3],
        write: impl Fn(&Self) -> String,
    ) -> String {
        let sign = |place: usize, is_minus: bool| match (place, is_minus) {
            (0, false) => "",
            (0, true) => first_minus,
            (_, false) => plus,
            (_, true) => minus,
        };
        let terms = terms.iter().enumerate();
        terms
            .map(|(place, (minus, term))| sign(place, *minus).to_owned() + &write(term))
            .collect()
    }

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

    /// A product, flattened and without redundant brackets.
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

    /// A sum of signed terms, flattened; zero if there are none.
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

    /// A letter, or the quotient ∂a/∂b that its name denotes.
    pub fn letter(mut letter: Letter) -> Self {
        match letter.by.take() {
            Some(by) => Self::partial(letter, *by),
            None => Self::Letter(letter),
        }
    }

    /// ∂above/∂below
    pub fn partial(above: Letter, below: Letter) -> Self {
        Self::fraction(
            Self::Letter(above.before('∂')),
            Self::Letter(below.before('∂')),
        )
    }

    /// Components in a frame, as a row if they are short.
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

    /// Whether it contains a quotient outside functions, which makes it taller than a line.
    pub fn has_fraction(&self) -> bool {
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

    /// Its approximate width in characters.
    pub fn width(&self) -> usize {
        super::text::columns(&super::text::text(self))
    }
}
