//! Sums, products, quotients and powers: their units, degrees and sizes.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Pow, Signed, ToPrimitive, Zero};

use crate::diagnostic::{Code, Diagnostic};
use crate::expr::{BinaryOp, Expr, ExprKind, Span};
use crate::limits::{MAX_DEGREE, MAX_EXPONENT};
use crate::units::Dimension;

use super::dimensions::{Dim, Typed, exponent, unit_words};
use super::place::Place;
use super::resolver::Resolver;

/// Longest exact constant, in bits.
const MAX_BITS: u64 = 4096;
const EXPONENT: Place = Place::constant("an exponent");

/// The result type of an operation; the fields are those of [`Typed`].
struct Grade {
    dim: Dim,
    degree: Option<u8>,
    size: u32,
}

impl Resolver<'_> {
    pub(super) fn binary(
        &mut self,
        op: BinaryOp,
        a: Typed,
        b: Typed,
        span: Span,
        place: &Place,
    ) -> Typed {
        let grade = match op {
            BinaryOp::Add => Some(self.sum("add", &a, &b, place)),
            BinaryOp::Subtract => Some(self.sum("subtract", &a, &b, place)),
            BinaryOp::Multiply => Some(self.product(&a, &b, &span, place)),
            BinaryOp::Divide => self.quotient(&a, &b, &span, place),
            BinaryOp::Power => self.power(&a, &b, &span, place),
        };
        let Some(Grade { dim, degree, size }) = grade else {
            return Typed::poisoned(span);
        };
        // A refused operation has no value, as it may be a power that overflows.
        let known = a.constant.as_ref().zip(b.constant.as_ref());
        let constant = known
            .filter(|_| dim != Dim::Unknown)
            .and_then(|(a, b)| self.constant(op, a, b, &span));
        let typed = Typed {
            expr: Expr {
                kind: ExprKind::Binary(op, Box::new(a.expr), Box::new(b.expr)),
                span,
            },
            dim,
            degree,
            constant,
            size,
        };
        self.bounded(typed)
    }

    fn sum(&mut self, doing: &str, a: &Typed, b: &Typed, place: &Place) -> Grade {
        Grade {
            dim: self.unify(a, b, doing),
            degree: self.same_degree(a, b, place),
            size: a.size.max(b.size),
        }
    }

    fn product(&mut self, a: &Typed, b: &Typed, span: &Span, place: &Place) -> Grade {
        let dim = a.dim.product(b.dim, |a, b| a.times(b).ok());
        Grade {
            degree: self.product_degree(a, b, place),
            dim: self.known_dimension(dim, span, None),
            size: a.size + b.size,
        }
    }

    fn quotient(&mut self, a: &Typed, b: &Typed, span: &Span, place: &Place) -> Option<Grade> {
        if b.dim == Dim::Any || b.constant.as_ref().is_some_and(Zero::is_zero) {
            self.tell(
                Diagnostic::error(Code::DivisionByZero, "division by zero")
                    .at(b.span(), "this is zero"),
            );
            return None;
        }
        self.no_rates(&[b], "a divisor", place);
        let dim = a.dim.product(b.dim, |a, b| a.over(b).ok());
        Some(Grade {
            dim: self.known_dimension(dim, span, None),
            degree: a.degree,
            size: a.size + b.size,
        })
    }

    fn power(&mut self, a: &Typed, b: &Typed, span: &Span, place: &Place) -> Option<Grade> {
        self.expect(b, Dim::NONE, &EXPONENT);
        let first = b.constant.as_ref().is_some_and(One::is_one);
        if !first {
            self.no_rates(&[a, b], "a power", place);
        }
        let dim = match &b.constant {
            Some(value) => self.constant_power(a, b, value, span)?,
            None => self.varying_power(a, b),
        };
        let factor = match &b.constant {
            // If a power has been refused, a large degree is a consequence.
            Some(value) if dim != Dim::Unknown => value.abs().ceil().to_u32().unwrap_or(1).max(1),
            _ => 1,
        };
        Some(Grade {
            dim,
            // A first power keeps the degree; any other has been refused if it held a rate.
            degree: a.degree.map(|degree| if first { degree } else { 0 }),
            size: a.size.saturating_mul(factor),
        })
    }

    /// Dimension of a power with a number for exponent; `None` where it divides by zero.
    fn constant_power(
        &mut self,
        a: &Typed,
        b: &Typed,
        value: &BigRational,
        span: &Span,
    ) -> Option<Dim> {
        if value.abs() > BigRational::from_integer(BigInt::from(MAX_EXPONENT)) {
            self.tell(
                Diagnostic::error(
                    Code::LimitExceeded,
                    format!("an exponent is at most {MAX_EXPONENT}"),
                )
                .at(b.span(), "too large"),
            );
            return Some(Dim::Unknown);
        }
        if value.is_negative() && a.constant.as_ref().is_some_and(Zero::is_zero) {
            self.tell(
                Diagnostic::error(Code::DivisionByZero, "a negative power of zero")
                    .at(a.span(), "this is zero"),
            );
            return None;
        }
        Some(match a.dim {
            Dim::Known(d) if !d.is_none() => {
                let raised = exponent(value).and_then(|e| d.power(e).ok());
                let help = (!value.is_integer())
                    .then(|| "write the exponent as a fraction, such as `1/3`".to_owned());
                self.known_dimension(raised.map(Dim::Known), span, help)
            }
            Dim::Any if value.is_zero() => Dim::NONE,
            other => other,
        })
    }

    /// Dimension of a power whose exponent is not a number: only pure numbers have one.
    fn varying_power(&mut self, a: &Typed, b: &Typed) -> Dim {
        match a.dim {
            Dim::Known(d) if !d.is_none() => {
                self.exponent_not_constant(a, d, b);
                Dim::Unknown
            }
            other => other,
        }
    }

    fn exponent_not_constant(&mut self, base: &Typed, dimension: Dimension, exponent: &Typed) {
        let message = "the exponent of a quantity with a unit must be a number";
        let help = "divide the base by a reference value of the same unit first";
        let finding = Diagnostic::error(Code::ExponentNotConstant, message);
        self.tell(
            finding
                .at(exponent.span(), "not a number")
                .at(base.span(), unit_words(dimension))
                .help(help),
        );
    }

    /// The dimension of a product or power; reports one beyond that of any quantity.
    pub(super) fn known_dimension(
        &mut self,
        dim: Option<Dim>,
        span: &Span,
        help: Option<String>,
    ) -> Dim {
        dim.unwrap_or_else(|| {
            let message = "the unit of this expression has too large an exponent";
            let finding = Diagnostic::error(Code::LimitExceeded, message);
            self.tell(finding.at(span.clone(), "").maybe_help(help));
            Dim::Unknown
        })
    }

    /// The exact value of an operation on numbers, if it is short; reports one that overflows a double.
    fn constant(
        &mut self,
        op: BinaryOp,
        a: &BigRational,
        b: &BigRational,
        span: &Span,
    ) -> Option<BigRational> {
        if !is_double(op, a, b) {
            self.tell(
                Diagnostic::error(Code::NotFinite, "the number is beyond double precision")
                    .at(span.clone(), "a double holds 1e-308 to 1e308")
                    .help("use other units, or write the value of the whole expression"),
            );
            return None;
        }
        constant(op, a, b)
    }

    /// Limits the growth of repeated powers.
    fn bounded(&mut self, mut typed: Typed) -> Typed {
        if typed.size > MAX_DEGREE {
            self.tell(
                Diagnostic::error(
                    Code::LimitExceeded,
                    format!("the degree of an expression is at most {MAX_DEGREE}"),
                )
                .at(typed.span(), ""),
            );
            typed.size = 1;
        }
        typed
    }

    /// Degree of a sum; every term of a linear expression has the same one.
    pub(super) fn same_degree(&mut self, a: &Typed, b: &Typed, place: &Place) -> Option<u8> {
        match (a.degree, b.degree) {
            (None, other) | (other, None) => other,
            (Some(x), Some(y)) if x == y => Some(x),
            (Some(x), Some(_)) => {
                let term = if x == 0 { a } else { b };
                self.not_linear(
                    place,
                    "a term without a rate",
                    term.span(),
                    "no `dot(q)` here",
                );
                Some(1)
            }
        }
    }

    fn product_degree(&mut self, a: &Typed, b: &Typed, place: &Place) -> Option<u8> {
        let sum = a.degree?.saturating_add(b.degree?);
        if sum > 1 {
            let span =
                a.expr.span.start.min(b.expr.span.start)..b.expr.span.end.max(a.expr.span.end);
            self.not_linear(place, "a product of rates", span, "more than one `dot(q)`");
        }
        Some(sum.min(1))
    }
}

/// The exact value of an operation on numbers, if it is short.
fn constant(op: BinaryOp, a: &BigRational, b: &BigRational) -> Option<BigRational> {
    let bits = |value: &BigRational| value.numer().bits() + value.denom().bits();
    let value = match op {
        BinaryOp::Add => a + b,
        BinaryOp::Subtract => a - b,
        BinaryOp::Multiply => a * b,
        BinaryOp::Divide => a / b,
        BinaryOp::Power => {
            let exponent = b.is_integer().then(|| b.to_i32())??;
            let long = bits(a).saturating_mul(u64::from(exponent.unsigned_abs()));
            if long > MAX_BITS {
                return None;
            }
            Pow::pow(a, exponent)
        }
    };
    (bits(&value) <= MAX_BITS).then_some(value)
}

/// Whether the result of an operation on nonzero numbers is representable as a double.
fn is_double(op: BinaryOp, a: &BigRational, b: &BigRational) -> bool {
    let double = |value: &BigRational| value.to_f64().unwrap_or(f64::NAN);
    let (x, y) = (double(a), double(b));
    let value = match op {
        // Terms that cancel leave zero.
        BinaryOp::Add | BinaryOp::Subtract => return (x + y).is_finite() && (x - y).is_finite(),
        BinaryOp::Multiply => x * y,
        BinaryOp::Divide => x / y,
        BinaryOp::Power => x.abs().powf(y),
    };
    value.is_finite() && (value != 0.0 || a.is_zero() || b.is_zero())
}
