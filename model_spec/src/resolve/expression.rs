//! Expressions: names become references; units, degrees and sizes are checked on the way.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Pow, Signed, ToPrimitive, Zero};

use crate::ast::{ExprAst, ExprAstKind, Spanned};
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::{BinaryOp, Expr, ExprKind, Function, Quantity, Span};
use crate::limits::{MAX_DEGREE, MAX_EXPONENT};
use crate::suggest::{did_you_mean, shown};
use crate::units::{Dimension, Unit};

use super::Resolver;
use super::dimensions::{Dim, Typed, exponent};
use super::names::Meaning;
use super::place::Place;

/// Longest exact constant, in bits.
const MAX_BITS: u64 = 4096;

impl Resolver<'_> {
    /// Resolves and checks one expression.
    pub(super) fn elaborate(&mut self, ast: &ExprAst, place: &Place) -> Typed {
        let span = ast.span.clone();
        match &ast.kind {
            ExprAstKind::Broken => Typed::poisoned(span),
            ExprAstKind::Number(value, None) => number(value.clone(), span),
            ExprAstKind::Number(value, Some(unit)) => measured(value, unit, &span),
            ExprAstKind::Name(name) => self.name(name, span, place),
            ExprAstKind::Rate(name) => self.rate(name, span, place),
            ExprAstKind::Negate(inner) => {
                let inner = self.elaborate(inner, place);
                Typed {
                    expr: Expr {
                        kind: ExprKind::Negate(Box::new(inner.expr)),
                        span,
                    },
                    constant: inner.constant.map(|c| -c),
                    ..inner
                }
            }
            ExprAstKind::Binary(op, a, b) => {
                let a = self.elaborate(a, place);
                let b = self.elaborate(b, place);
                self.binary(*op, a, b, span, place)
            }
            ExprAstKind::Call(function, arguments) => {
                let arguments = arguments
                    .iter()
                    .map(|a| self.elaborate(a, place))
                    .collect::<Vec<_>>();
                self.call(*function, arguments, span, place)
            }
            ExprAstKind::Choice {
                relation,
                compared,
                branches,
            } => {
                let [a, b] = compared.each_ref().map(|e| self.elaborate(e, place));
                let [then, otherwise] = branches.each_ref().map(|e| self.elaborate(e, place));
                self.unify(&a, &b, "compare");
                self.no_rates(&[&a, &b], "a comparison", place);
                let dim = self.unify(&then, &otherwise, "choose between");
                let degree = self.same_degree(&then, &otherwise, place);
                Typed {
                    size: then.size.max(otherwise.size),
                    expr: Expr {
                        kind: ExprKind::Choice {
                            relation: *relation,
                            compared: Box::new([a.expr, b.expr]),
                            branches: Box::new([then.expr, otherwise.expr]),
                        },
                        span,
                    },
                    dim,
                    degree,
                    constant: None,
                }
            }
        }
    }

    fn name(&mut self, name: &str, span: Span, place: &Place) -> Typed {
        match name {
            "t" => return self.quantity(Quantity::Time, Some(Dimension::TIME), name, span, place),
            "pi" => return self.quantity(Quantity::Pi, Some(Dimension::NONE), name, span, place),
            _ => {}
        }
        let Some(named) = self.names.get(name) else {
            self.unknown("name", name, &span, |this| this.unknown_name(name, &span));
            return Typed::poisoned(span);
        };
        let dimension = named.dimension;
        match named.meaning {
            Meaning::Quantity(quantity) => self.quantity(quantity, dimension, name, span, place),
            Meaning::Output => {
                self.tell(
                    Diagnostic::error(
                        Code::NotAllowedHere,
                        format!("the output `{name}` cannot be used in an expression"),
                    )
                    .at(span.clone(), "")
                    .help("repeat its definition"),
                );
                Typed::poisoned(span)
            }
        }
    }

    fn quantity(
        &mut self,
        quantity: Quantity,
        dimension: Option<Dimension>,
        name: &str,
        span: Span,
        place: &Place,
    ) -> Typed {
        self.used.add(quantity);
        if !place.allows(quantity) {
            self.not_allowed(quantity, name, &span, place);
        } else if let Quantity::Signal(id) = quantity {
            self.smooth_enough(id, &span, place);
        }
        Typed {
            expr: Expr {
                kind: ExprKind::Quantity(quantity),
                span,
            },
            dim: dimension.map_or(Dim::Unknown, Dim::Known),
            degree: Some(u8::from(matches!(quantity, Quantity::Rate(_)))),
            constant: None,
            size: 1,
        }
    }

    fn rate(&mut self, name: &Spanned<String>, span: Span, place: &Place) -> Typed {
        let text = name.value.as_str();
        match self.names.get(text) {
            Some(named) => {
                if let Meaning::Quantity(Quantity::Coordinate(id)) = named.meaning {
                    let dimension = named.dimension.and_then(|d| d.rate().ok());
                    let shown = format!("dot({text})");
                    return self.quantity(Quantity::Rate(id), dimension, &shown, span, place);
                }
                self.tell(
                    Diagnostic::error(
                        Code::NotAllowedHere,
                        format!("`{text}` is not a coordinate; `dot` takes the name of one"),
                    )
                    .at(name.span.clone(), ""),
                );
            }
            None => {
                self.unknown("name", text, &name.span, |this| {
                    this.unknown_name(text, &name.span)
                });
            }
        }
        Typed::poisoned(span)
    }

    fn unknown_name(&self, name: &str, span: &Span) -> Diagnostic {
        let known = self.names.keys().copied().chain(["t", "pi"]);
        let help = did_you_mean(name, known, || {
            if Function::from_name(name).is_some() {
                format!("`{name}` is a function; write `{name}(…)`")
            } else {
                "define it as a parameter, coordinate, input or signal".to_owned()
            }
        });
        Diagnostic::error(Code::UnknownName, format!("unknown name `{}`", shown(name)))
            .at(span.clone(), "")
            .help(help)
    }

    fn not_allowed(&mut self, quantity: Quantity, name: &str, span: &Span, place: &Place) {
        let what = match quantity {
            Quantity::Parameter(_) => "the parameter",
            Quantity::Coordinate(_) => "the coordinate",
            Quantity::Rate(_) => "the rate",
            Quantity::PseudoVelocity(_) => "the pseudo-velocity",
            Quantity::Input(_) => "the input",
            Quantity::Signal(_) => "the signal",
            Quantity::Time | Quantity::Pi => "the quantity",
        };
        self.tell(
            Diagnostic::error(
                Code::NotAllowedHere,
                format!("{} cannot depend on {what} `{name}`", place.what),
            )
            .at(span.clone(), "")
            .help(format!("allowed here: {}", place.allowed_words())),
        );
    }

    fn smooth_enough(&mut self, id: usize, span: &Span, place: &Place) {
        let Some((interpolation, name)) = self.interpolation.get(id).copied() else {
            return;
        };
        if place.smooth.admits(interpolation) {
            return;
        }
        self.tell(
            Diagnostic::error(
                Code::SignalTooRough,
                format!(
                    "the signal `{name}` is not smooth enough for {}",
                    place.what
                ),
            )
            .at(span.clone(), "")
            .help(format!(
                "give the signal `interpolation = \"{}\"`",
                place.smooth.remedy()
            )),
        );
    }

    fn binary(&mut self, op: BinaryOp, a: Typed, b: Typed, span: Span, place: &Place) -> Typed {
        if op == BinaryOp::Power {
            return self.power(a, b, span, place);
        }
        let constants = a.constant.as_ref().zip(b.constant.as_ref());
        let (dim, degree, size, constant) = match op {
            BinaryOp::Add => {
                let dim = self.unify(&a, &b, "add");
                let degree = self.same_degree(&a, &b, place);
                (
                    dim,
                    degree,
                    a.size.max(b.size),
                    constants.map(|(a, b)| a + b),
                )
            }
            BinaryOp::Subtract => {
                let dim = self.unify(&a, &b, "subtract");
                let degree = self.same_degree(&a, &b, place);
                (
                    dim,
                    degree,
                    a.size.max(b.size),
                    constants.map(|(a, b)| a - b),
                )
            }
            BinaryOp::Multiply => {
                let dim = a.dim.product(b.dim, |a, b| a.times(b).ok());
                let degree = self.product_degree(&a, &b, place);
                let dim = self.known_dimension(dim, &span);
                (dim, degree, a.size + b.size, constants.map(|(a, b)| a * b))
            }
            BinaryOp::Divide | BinaryOp::Power => {
                if b.dim == Dim::Any || b.constant.as_ref().is_some_and(Zero::is_zero) {
                    self.tell(
                        Diagnostic::error(Code::DivisionByZero, "division by zero")
                            .at(b.span(), "this is zero"),
                    );
                    return Typed::poisoned(span);
                }
                self.no_rates(&[&b], "a divisor", place);
                let dim = a.dim.product(b.dim, |a, b| a.over(b).ok());
                let dim = self.known_dimension(dim, &span);
                (
                    dim,
                    a.degree,
                    a.size + b.size,
                    constants.map(|(a, b)| a / b),
                )
            }
        };
        let typed = Typed {
            expr: Expr {
                kind: ExprKind::Binary(op, Box::new(a.expr), Box::new(b.expr)),
                span,
            },
            dim,
            degree,
            constant: constant.filter(is_short),
            size,
        };
        self.bounded(typed)
    }

    fn known_dimension(&mut self, dim: Option<Dim>, span: &Span) -> Dim {
        dim.unwrap_or_else(|| {
            self.tell(
                Diagnostic::error(
                    Code::LimitExceeded,
                    "the unit of this expression has too large an exponent",
                )
                .at(span.clone(), ""),
            );
            Dim::Unknown
        })
    }

    /// Tells where repeated powers grow beyond reason.
    fn bounded(&mut self, mut typed: Typed) -> Typed {
        if typed.size > MAX_DEGREE {
            self.tell(
                Diagnostic::error(
                    Code::LimitExceeded,
                    format!("an expression has at most the degree {MAX_DEGREE}"),
                )
                .at(typed.span(), ""),
            );
            typed.size = 1;
        }
        typed
    }

    fn power(&mut self, a: Typed, b: Typed, span: Span, place: &Place) -> Typed {
        self.expect(&b, Dim::NONE, &Place::constant("an exponent"));
        if b.constant.as_ref().is_none_or(|c| !c.is_one()) {
            self.no_rates(&[&a, &b], "a power", place);
        }
        let mut size = a.size;
        let mut constant = None;
        let dim = match (&b.constant, a.dim) {
            (Some(value), _)
                if value.abs() > BigRational::from_integer(BigInt::from(MAX_EXPONENT)) =>
            {
                self.tell(
                    Diagnostic::error(
                        Code::LimitExceeded,
                        format!("an exponent is at most {MAX_EXPONENT}"),
                    )
                    .at(b.span(), "too large"),
                );
                Dim::Unknown
            }
            (Some(value), dim) => {
                size = size.saturating_mul(value.abs().ceil().to_u32().unwrap_or(1).max(1));
                if value.is_negative() && a.constant.as_ref().is_some_and(Zero::is_zero) {
                    self.tell(
                        Diagnostic::error(Code::DivisionByZero, "a negative power of zero")
                            .at(a.span(), "this is zero"),
                    );
                    return Typed::poisoned(span);
                }
                constant = a
                    .constant
                    .as_ref()
                    .and_then(|base| whole_power(base, value));
                match dim {
                    Dim::Known(d) if d.is_none() => dim,
                    Dim::Known(d) => {
                        let raised = exponent(value).and_then(|e| d.power(e).ok());
                        self.known_dimension(raised.map(Dim::Known), &span)
                    }
                    Dim::Any if value.is_zero() => Dim::NONE,
                    other => other,
                }
            }
            (None, Dim::Known(d)) if !d.is_none() => {
                self.exponent_not_constant(&a, d, &b);
                Dim::Unknown
            }
            (None, dim) => dim,
        };
        if dim == Dim::Unknown {
            // Told already; a large degree is only another side of it.
            size = a.size;
        }
        let degree = if a.degree.is_none() {
            None
        } else {
            degree_of_power(&a, &b)
        };
        let typed = Typed {
            expr: Expr {
                kind: ExprKind::Binary(BinaryOp::Power, Box::new(a.expr), Box::new(b.expr)),
                span,
            },
            dim,
            degree,
            constant,
            size,
        };
        self.bounded(typed)
    }

    fn exponent_not_constant(&mut self, base: &Typed, dimension: Dimension, exponent: &Typed) {
        self.tell(
            Diagnostic::error(
                Code::ExponentNotConstant,
                "the exponent of a quantity with a unit must be a number",
            )
            .at(exponent.span(), "not a number")
            .at(base.span(), super::dimensions::unit_words(dimension))
            .help("divide the base by a reference value of the same unit first"),
        );
    }

    fn call(
        &mut self,
        function: Function,
        arguments: Vec<Typed>,
        span: Span,
        place: &Place,
    ) -> Typed {
        let all: Vec<&Typed> = arguments.iter().collect();
        self.no_rates(&all, "a function", place);
        let dim = match (function, all.as_slice()) {
            (Function::Abs, [a]) => a.dim,
            (Function::Sign, [_]) => Dim::NONE,
            (Function::Sqrt, [a]) => match a.dim {
                Dim::Known(d) => {
                    let root = d.power(crate::units::Exponent::new(1, 2)).ok();
                    self.known_dimension(root.map(Dim::Known), &span)
                }
                other => other,
            },
            (Function::Atan2 | Function::SmoothSign, [a, b]) => {
                self.unify(a, b, "compare");
                Dim::NONE
            }
            (_, [a]) => {
                self.dimensionless(a, function);
                Dim::NONE
            }
            (_, [a, b]) => self.unify(a, b, "combine"),
            (_, [a, b, c]) => {
                let first = self.unify(a, b, "combine");
                let second = self.unify(a, c, "combine");
                if first == Dim::Any { second } else { first }
            }
            _ => Dim::Unknown,
        };
        Typed {
            expr: Expr {
                kind: ExprKind::Call(function, arguments.into_iter().map(|a| a.expr).collect()),
                span,
            },
            dim,
            degree: Some(0),
            constant: None,
            size: 1,
        }
    }

    fn dimensionless(&mut self, argument: &Typed, function: Function) {
        if let Dim::Known(d) = argument.dim
            && !d.is_none()
        {
            self.tell(
                Diagnostic::error(
                    Code::UnitMismatch,
                    format!(
                        "`{}` takes a pure number or an angle, found {}",
                        function.name(),
                        crate::units::quantity_name(&d)
                    ),
                )
                .at(argument.span(), super::dimensions::unit_words(d)),
            );
        }
    }

    /// Degree of a sum; every term of a linear expression has the same one.
    fn same_degree(&mut self, a: &Typed, b: &Typed, place: &Place) -> Option<u8> {
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

    fn no_rates(&mut self, parts: &[&Typed], inside: &str, place: &Place) {
        if let Some(part) = parts.iter().find(|p| p.degree.is_some_and(|d| d > 0)) {
            let message = format!("a rate inside {inside}");
            self.not_linear(place, &message, part.span(), "depends on a rate");
        }
    }

    pub(super) fn not_linear(&mut self, place: &Place, why: &str, span: Span, words: &str) {
        if place.linear {
            self.tell(
                Diagnostic::error(
                    Code::NotLinear,
                    format!("{} must be linear in the rates, found {why}", place.what),
                )
                .at(span, words)
                .help("write a sum of terms with exactly one `dot(q)` each"),
            );
        }
    }
}

fn number(value: BigRational, span: Span) -> Typed {
    let zero = value.is_zero();
    Typed {
        expr: Expr {
            kind: ExprKind::Number(value.clone()),
            span,
        },
        dim: if zero { Dim::Any } else { Dim::NONE },
        degree: if zero { None } else { Some(0) },
        constant: Some(value),
        size: 1,
    }
}

/// A number with a unit, in SI. Powers of π stay symbols, so that `180 [deg]` is exactly `pi`.
fn measured(value: &BigRational, unit: &Unit, span: &Span) -> Typed {
    let number = |value| Expr {
        kind: ExprKind::Number(value),
        span: span.clone(),
    };
    let mut expr = number(value * &unit.factor);
    if unit.pi_power != 0 {
        let pi = Expr {
            kind: ExprKind::Quantity(Quantity::Pi),
            span: span.clone(),
        };
        let power = BigRational::from_integer(BigInt::from(unit.pi_power));
        let factor = if power.is_one() {
            pi
        } else {
            let power = Box::new(number(power));
            Expr {
                kind: ExprKind::Binary(BinaryOp::Power, Box::new(pi), power),
                span: span.clone(),
            }
        };
        expr = Expr {
            kind: ExprKind::Binary(BinaryOp::Multiply, Box::new(expr), Box::new(factor)),
            span: span.clone(),
        };
    }
    Typed {
        expr,
        dim: Dim::Known(unit.dimension),
        degree: Some(0),
        constant: None,
        size: 1,
    }
}

/// A first power keeps the degree; any other has been refused if it held a rate.
fn degree_of_power(a: &Typed, b: &Typed) -> Option<u8> {
    let first = b.constant.as_ref().is_some_and(One::is_one);
    if first { a.degree } else { Some(0) }
}

fn is_short(value: &BigRational) -> bool {
    value.numer().bits() + value.denom().bits() <= MAX_BITS
}

/// An exact power, where the exponent is whole and the result short.
fn whole_power(base: &BigRational, exponent: &BigRational) -> Option<BigRational> {
    let exponent = exponent.is_integer().then(|| exponent.to_i32())??;
    let bits = base.numer().bits() + base.denom().bits();
    let short = bits.saturating_mul(u64::from(exponent.unsigned_abs())) <= MAX_BITS;
    short.then(|| Pow::pow(base, exponent))
}
