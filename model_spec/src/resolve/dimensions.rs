//! Dimensions of expressions, as far as known.

use num_rational::BigRational;
use num_traits::ToPrimitive;

use crate::diagnostic::{Code, Diagnostic};
use crate::expr::{Expr, ExprKind, Span};
use crate::units::{Dimension, Exponent, Unit, quantity_name};

use super::place::Place;
use super::resolver::Resolver;

/// The dimension of an expression, as far as it is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Dim {
    /// A literal zero: fits everywhere.
    Any,
    /// Unknown because of an error that has been reported.
    Unknown,
    /// This one.
    Known(Dimension),
}

/// An expression with its properties for the checks.
#[derive(Debug, Clone)]
pub(super) struct Typed {
    pub(super) expr: Expr,
    pub(super) dim: Dim,
    /// Degree in the rates; `None` for a literal zero, which has every degree.
    pub(super) degree: Option<u8>,
    /// Value, if it consists of numbers only.
    pub(super) constant: Option<BigRational>,
    /// Bound on the polynomial degree, as a protection against huge powers.
    pub(super) size: u32,
}

impl Typed {
    /// An invalid expression; expressions that contain it cause no further error.
    pub(super) fn poisoned(span: Span) -> Self {
        Self {
            expr: Expr::integer(0, span),
            dim: Dim::Unknown,
            degree: None,
            constant: None,
            size: 1,
        }
    }

    pub(super) fn span(&self) -> Span {
        self.expr.span.clone()
    }

    /// The correction to suggest for a bare number where a quantity is required.
    fn missing_unit(&self, wanted: Dimension) -> Option<String> {
        let bare = self.constant.is_some() && self.dim == Dim::NONE;
        bare.then(|| {
            let unit = Unit::si(wanted).text;
            format!("write the unit after the number: `[{unit}]`")
        })
    }

    /// The correction to suggest for milliseconds instead of metres and seconds, as in `9.81 [ms^-2]`.
    fn milliseconds(&self, wanted: Dimension) -> Option<String> {
        let unit = Unit::si(wanted).text;
        let Dim::Known(found) = self.dim else {
            return None;
        };
        let power = ["m/s", "m/s^2"].iter().position(|own| *own == unit)? + 1;
        let per_time = Exponent::from_integer(-i32::try_from(power).ok()?);
        let second = crate::units::parse("s").ok()?.dimension;
        let is_number = matches!(self.expr.kind, ExprKind::Number(_));
        let meant = is_number && second.power(per_time).ok()? == found;
        meant.then(|| format!("`ms^-{power}` has milliseconds in it; write `{unit}`"))
    }
}

impl Dim {
    pub(super) const NONE: Self = Self::Known(Dimension::NONE);

    /// Combines two known dimensions; an unknown one stays unknown.
    pub(super) fn product(
        self,
        other: Self,
        combine: impl Fn(&Dimension, &Dimension) -> Option<Dimension>,
    ) -> Option<Self> {
        match (self, other) {
            (Self::Unknown, _) | (_, Self::Unknown) => Some(Self::Unknown),
            (Self::Any, _) | (_, Self::Any) => Some(Self::Any),
            (Self::Known(a), Self::Known(b)) => combine(&a, &b).map(Self::Known),
        }
    }

    pub(super) fn known(self) -> Option<Dimension> {
        match self {
            Self::Known(dimension) => Some(dimension),
            Self::Any | Self::Unknown => None,
        }
    }

    /// The dimension of a quantity divided by this one, as far as both are known.
    pub(super) fn per(self, divisor: Option<Dimension>) -> Self {
        match (self, divisor) {
            (Self::Known(a), Some(b)) => a.over(&b).map_or(Self::Unknown, Self::Known),
            _ => Self::Unknown,
        }
    }

    pub(super) fn times(self, factor: Option<Dimension>) -> Self {
        match (self, factor) {
            (Self::Known(a), Some(b)) => a.times(&b).map_or(Self::Unknown, Self::Known),
            _ => Self::Unknown,
        }
    }
}

/// A constant exponent as an exponent of dimensions.
pub(super) fn exponent(value: &BigRational) -> Option<Exponent> {
    let numerator = value.numer().to_i32()?;
    let denominator = value.denom().to_i32()?;
    Some(Exponent::new(numerator, denominator))
}

/// A dimension in the words of a label: `N*m`.
pub(super) fn unit_words(dimension: Dimension) -> String {
    format!("unit `{}`", Unit::si(dimension).text)
}

impl Resolver<'_> {
    /// Reports an expression without the dimension that its place requires.
    pub(super) fn expect(&mut self, typed: &Typed, wanted: Dim, place: &Place) {
        let (Dim::Known(found), Dim::Known(wanted)) = (typed.dim, wanted) else {
            return;
        };
        if found == wanted {
            return;
        }
        let unit = Unit::si(wanted).text;
        let must = if wanted.is_none() {
            format!("be {}", quantity_name(&wanted))
        } else {
            format!("have the unit `{unit}`")
        };
        let message = format!(
            "{} must {must}, found {}",
            place.what,
            quantity_name(&found)
        );
        let finding = Diagnostic::error(Code::UnitMismatch, message);
        self.tell(
            finding.at(typed.span(), unit_words(found)).maybe_help(
                typed
                    .missing_unit(wanted)
                    .or_else(|| typed.milliseconds(wanted)),
            ),
        );
    }

    /// The common dimension of two sides; reports a difference.
    pub(super) fn unify(&mut self, a: &Typed, b: &Typed, doing: &str) -> Dim {
        match (a.dim, b.dim) {
            (Dim::Unknown, _) | (_, Dim::Unknown) => Dim::Unknown,
            (Dim::Any, other) | (other, Dim::Any) => other,
            (Dim::Known(left), Dim::Known(right)) => {
                if left == right {
                    return a.dim;
                }
                let message = format!(
                    "cannot {doing} {} and {}",
                    quantity_name(&left),
                    quantity_name(&right)
                );
                let finding = Diagnostic::error(Code::UnitMismatch, message);
                self.tell(
                    finding
                        .at(b.span(), unit_words(right))
                        .at(a.span(), unit_words(left))
                        .maybe_help(b.missing_unit(left).or_else(|| a.missing_unit(right))),
                );
                Dim::Unknown
            }
        }
    }
}
