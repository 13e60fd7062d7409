//! Expressions: names become references; units and degrees are checked on the way.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Zero};

use crate::ast::{ExprAst, ExprAstKind, Spanned};
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::{BinaryOp, Expr, ExprKind, Function, Motion, Quantity, Relation, Span};
use crate::mechanism::{Interpolation, SignalId};
use crate::parse::SECOND_RATE;
use crate::suggest::{did_you_mean, shown};
use crate::units::{Dimension, Unit};

use super::dimensions::{Dim, Typed};
use super::meaning::Meaning;
use super::place::Place;
use super::resolver::Resolver;

impl Resolver<'_> {
    /// Resolves and checks one expression.
    pub(super) fn elaborate(&mut self, ast: &ExprAst, place: &Place) -> Typed {
        let typed = if self.enter(&ast.span) {
            self.elaborated(ast, place)
        } else {
            Typed::poisoned(ast.span.clone())
        };
        self.leave();
        typed
    }

    fn elaborated(&mut self, ast: &ExprAst, place: &Place) -> Typed {
        let span = ast.span.clone();
        match &ast.kind {
            ExprAstKind::Broken => Typed::poisoned(span),
            ExprAstKind::Number(value, None) => number(value.clone(), span),
            ExprAstKind::Number(value, Some(unit)) => measured(value, unit, &span),
            ExprAstKind::Name(name) => self.name(name, span, place),
            ExprAstKind::Rate(name) => self.rate(name, span, place),
            ExprAstKind::Named(word, names) => self.named(*word, names, span, place),
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
                let compared = compared.each_ref().map(|e| self.elaborate(e, place));
                let branches = branches.each_ref().map(|e| self.elaborate(e, place));
                self.choice(*relation, compared, branches, span, place)
            }
        }
    }

    fn choice(
        &mut self,
        relation: Relation,
        [a, b]: [Typed; 2],
        [then, otherwise]: [Typed; 2],
        span: Span,
        place: &Place,
    ) -> Typed {
        self.unify(&a, &b, "compare");
        self.no_rates(&[&a, &b], "a comparison", place);
        self.jumps(&[&a, &b], &span, place);
        let dim = self.unify(&then, &otherwise, "choose between");
        let degree = self.same_degree(&then, &otherwise, place);
        Typed {
            size: then.size.max(otherwise.size),
            expr: Expr {
                kind: ExprKind::Choice {
                    relation,
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

    fn name(&mut self, name: &str, span: Span, place: &Place) -> Typed {
        if self.reserved.contains(name) {
            return Typed::poisoned(span);
        }
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
            Meaning::Definition(id) => self.defined(id, name, span, place),
            Meaning::Output => {
                let message = format!("the output `{name}` cannot be used in an expression");
                let help = "repeat its definition";
                self.error(Code::NotAllowedHere, span.clone(), message, help);
                Typed::poisoned(span)
            }
        }
    }

    pub(super) fn quantity(
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
            return Typed::poisoned(span);
        }
        if let Quantity::Signal(id) = quantity {
            self.smooth_enough(id, &span, place);
        }
        Typed {
            expr: Expr {
                kind: ExprKind::Quantity(quantity),
                span,
            },
            dim: dimension.map_or(Dim::Unknown, Dim::Known),
            degree: Some(u8::from(matches!(
                quantity,
                Quantity::Rate(_)
                    | Quantity::PseudoVelocity(_)
                    | Quantity::Motion(Motion::Velocity(..) | Motion::AngularVelocity(..))
            ))),
            constant: None,
            size: 1,
        }
    }

    fn rate(&mut self, name: &Spanned<String>, span: Span, place: &Place) -> Typed {
        let text = name.value.as_str();
        if self.reserved.contains(text) {
            return Typed::poisoned(span);
        }
        match self.names.get(text) {
            Some(named) => {
                if let Meaning::Quantity(Quantity::Coordinate(id)) = named.meaning {
                    let dimension = named.dimension.and_then(|d| d.rate().ok());
                    let shown = format!("dot({text})");
                    return self.quantity(Quantity::Rate(id), dimension, &shown, span, place);
                }
                let help = match named.meaning {
                    Meaning::Quantity(Quantity::Parameter(_)) => "a parameter is constant",
                    Meaning::Quantity(Quantity::PseudoVelocity(_)) => {
                        "accelerations are results: an output may name `acceleration(P, x)` of a point, or \
                         `angular_acceleration(F, x)` of a frame"
                    }
                    Meaning::Quantity(_) | Meaning::Definition(_) | Meaning::Output => {
                        "define its rate as a separate quantity"
                    }
                };
                let message = format!("`{text}` is not a coordinate; `dot` takes the name of one");
                self.error(Code::NotAllowedHere, name.span.clone(), message, help);
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
        let with_suffix = |suffix| {
            name.strip_suffix(suffix).filter(|&of| {
                let named = self.names.get(of).map(|named| named.meaning);
                matches!(named, Some(Meaning::Quantity(Quantity::Coordinate(_))))
            })
        };
        let (rate_of, twice) = (with_suffix("_dot"), with_suffix("_ddot").is_some());
        let known = known.filter(|_| rate_of.is_none() && !twice);
        let help = did_you_mean(name, known, || {
            if let Some(coordinate) = rate_of {
                return format!("write `dot({coordinate})`");
            }
            if twice {
                return SECOND_RATE.to_owned();
            }
            if Function::from_name(name).is_some() {
                format!("`{name}` is a function; write `{name}(…)`")
            } else {
                "define it as a parameter, coordinate, input, signal or definition".to_owned()
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
            Quantity::Motion(_) | Quantity::Response(_) => "the motion",
            Quantity::Time | Quantity::Pi => "the quantity",
        };
        let allowed = format!("allowed here: {}", place.allowed_words());
        let instead = "write the coordinates that the motion depends on";
        let help = match quantity {
            Quantity::Motion(_) if place.allows_coordinates() => format!("{instead}; {allowed}"),
            _ => allowed,
        };
        let message = format!("{} cannot depend on {what} `{name}`", place.what);
        self.error(Code::NotAllowedHere, span.clone(), message, help);
    }

    fn smooth_enough(&mut self, id: SignalId, span: &Span, place: &Place) {
        let Some((interpolation, name)) = self.interpolation.get(id.index()).copied() else {
            return;
        };
        if place.smooth.admits(interpolation) {
            return;
        }
        let message = format!(
            "the signal `{name}` is not smooth enough for {}",
            place.what
        );
        let help = format!(
            "give the signal `interpolation = \"{}\"`",
            place.smooth.remedy()
        );
        self.error(Code::SignalTooRough, span.clone(), message, help);
    }

    /// Warns of a conditional whose branch can change during the motion.
    fn jumps(&mut self, compared: &[&Typed], span: &Span, place: &Place) {
        if !place.smooth.admits(Interpolation::Hold) && compared.iter().any(|e| moves(&e.expr)) {
            let help = "make both branches agree in value and slope where they meet";
            self.may_jump("if", span, place, help);
        }
    }

    /// Warns of a nonsmooth function of quantities that change during the motion.
    fn kinks(&mut self, function: Function, arguments: &[&Typed], span: &Span, place: &Place) {
        let (course, smooth) = match function {
            Function::Sign => (Interpolation::Hold, "smooth_sign"),
            Function::Abs => (Interpolation::Linear, "smooth_abs"),
            Function::Min => (Interpolation::Linear, "smooth_min"),
            Function::Max => (Interpolation::Linear, "smooth_max"),
            _ => return,
        };
        if !place.smooth.admits(course) && arguments.iter().any(|e| moves(&e.expr)) {
            let help = format!("use `{smooth}`, which is smoothed over a width");
            self.may_jump(function.name(), span, place, &help);
        }
    }

    fn may_jump(&mut self, word: &str, span: &Span, place: &Place, help: &str) {
        let message = format!("`{word}` may not be smooth enough for {}", place.what);
        let finding = Diagnostic::warning(Code::MotionMayJump, message);
        self.tell(finding.at(span.clone(), "").help(help));
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
        self.kinks(function, &all, &span, place);
        let dim = match (function, all.as_slice()) {
            (Function::Abs, [a]) => a.dim,
            (Function::Sign, [_]) => Dim::NONE,
            (Function::Sqrt, [a]) => match a.dim {
                Dim::Known(d) => {
                    let root = d.power(crate::units::Exponent::new(1, 2)).ok();
                    self.known_dimension(root.map(Dim::Known), &span, None)
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
            let message = format!(
                "`{}` takes a pure number or an angle, found {}",
                function.name(),
                crate::units::quantity_name(&d)
            );
            let finding = Diagnostic::error(Code::UnitMismatch, message);
            self.tell(finding.at(argument.span(), super::dimensions::unit_words(d)));
        }
    }

    pub(super) fn no_rates(&mut self, parts: &[&Typed], inside: &str, place: &Place) {
        if let Some(part) = parts.iter().find(|p| p.degree.is_some_and(|d| d > 0)) {
            let message = format!("a rate inside {inside}");
            self.not_linear(place, &message, part.span(), "depends on a rate");
        }
    }

    pub(super) fn not_linear(&mut self, place: &Place, why: &str, span: Span, words: &str) {
        if place.linear {
            let message = format!("{} must be linear in the rates, found {why}", place.what);
            let help = "write a sum of terms with exactly one `dot(q)` each";
            let finding = Diagnostic::error(Code::NotLinear, message);
            self.tell(finding.at(span, words).help(help));
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

/// Whether an expression can change during the motion.
fn moves(expr: &Expr) -> bool {
    let mut moves = false;
    expr.visit(&mut |quantity| {
        moves |= !matches!(quantity, Quantity::Parameter(_) | Quantity::Pi);
    });
    moves
}
