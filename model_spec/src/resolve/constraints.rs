//! Constraints.

use crate::ast::ItemAst;
use crate::diagnostic::{Code, Diagnostic};
use crate::language::{ConstraintWord, ItemKind};
use crate::mechanism::{Body, Constraint, ConstraintKind, Creep, GROUND, Normal};
use crate::parse::zero;
use crate::units::Dimension;

use super::dimensions::Dim;
use super::meaning::{Acting, Shape};
use super::place::Place;
use super::placement::axis;
use super::resolver::Resolver;

const PRESCRIBED: Place = Place::prescribed("the prescribed velocity");
const DIRECTION: Place = Place::prescribed("a direction");
const FRICTION: Place = Place::surface("a coefficient of friction");
const CREEP: Place = Place::surface("the creep of a contact");
const CLOSURE: Place = Place::closure("a position constraint");

impl Resolver<'_> {
    pub(super) fn constraints(&mut self, bodies: &[Body]) -> Vec<Constraint> {
        let ast = self.ast;
        let mut constraints = Vec::new();
        for item in ast.items("constraints") {
            let Some(ItemKind::Constraint(word)) = item.kind.map(|kind| kind.is) else {
                continue;
            };
            let (kind, left) = match word {
                ConstraintWord::Rolling => (self.rolling(item, bodies), Dim::Any),
                ConstraintWord::Velocity => self.velocity(item),
                ConstraintWord::FixedVelocity => (self.fixed_velocity(item, bodies), Dim::Any),
                ConstraintWord::Position => self.position(item),
            };
            self.constraints
                .insert(item.name.value.as_str(), constraints.len());
            let mut acting = acting(&kind);
            // Invalid parts cause no further findings.
            if left == Dim::Unknown {
                acting.dimension = None;
            }
            self.reacting.push(Some(acting));
            constraints.push(Constraint {
                name: item.name.value.clone(),
                about: Self::about(item),
                kind,
                line: self.line(&item.name.span),
                span: item.name.span.clone(),
            });
        }
        constraints
    }

    fn rolling(&mut self, item: &ItemAst, bodies: &[Body]) -> ConstraintKind {
        let body = self.reference(item, "body");
        self.needs_frame(item, "body", bodies, "roll");
        let on = self.optional_reference(item, "on");
        self.needs_frame(item, "on", bodies, "carry a surface");
        let friction = item.expression("friction").cloned();
        let creep = self.creep(item);
        if let (Some(_), Some(given)) = (&creep, item.entry("on")) {
            let message = format!("`{}` creeps on a body that moves", item.name.value);
            let help = "remove the creep coefficients, or `on`";
            let finding = Diagnostic::error(Code::NotAllowedHere, message);
            self.tell(
                finding
                    .at(given.span.clone(), "creep is known on the ground only")
                    .help(help),
            );
        }
        ConstraintKind::Rolling {
            body,
            contact: self.reference(item, "contact"),
            on,
            normal: self.normal(item),
            friction: friction.map(|ast| self.expression(&ast, &FRICTION, Dim::NONE)),
            creep,
        }
    }

    /// The creep coefficients of a contact, if given.
    fn creep(&mut self, item: &ItemAst) -> Option<Box<Creep>> {
        let keys = ["longitudinal_creep", "lateral_creep"];
        if keys.iter().all(|key| item.expression(key).is_none()) {
            return None;
        }
        let [longitudinal, lateral] = keys.map(|key| {
            let ast = item.expression(key).cloned();
            let ast = ast.unwrap_or_else(|| zero(item.name.span.clone()));
            self.expression(&ast, &CREEP, Dim::NONE)
        });
        Some(Box::new(Creep {
            longitudinal,
            lateral,
        }))
    }

    fn normal(&mut self, item: &ItemAst) -> Option<Normal> {
        let frame = self.optional_reference(item, "in");
        if let (None, Some(given)) = (item.entry("normal"), item.entry("in")) {
            let message = format!("`{}` has no `normal`", item.name.value);
            let help = "write the axis that points from the surface into the body, such as `normal = \"z\"`";
            let finding = Diagnostic::error(Code::MissingKey, message);
            self.tell(
                finding
                    .at(given.span.clone(), "no axis of this frame is given")
                    .help(help),
            );
        }
        item.entry("normal")?;
        let (axis, negative) = axis(item, "normal");
        Some(Normal {
            frame: frame.unwrap_or(GROUND),
            axis,
            negative,
        })
    }

    /// A velocity constraint, and the dimension of its sides.
    fn velocity(&mut self, item: &ItemAst) -> (ConstraintKind, Dim) {
        let span = item.name.span.clone();
        let ast = item.expression("zero").cloned();
        let left = self.elaborate(&ast.unwrap_or_else(|| zero(span.clone())), &Place::RATE_ROW);
        if item.intact && left.degree != Some(1) && left.dim != Dim::Unknown {
            self.not_linear(
                &Place::RATE_ROW,
                "no rate at all",
                left.span(),
                "no `dot(q)` here",
            );
        }
        let right = item.expression("equals").cloned();
        let right = self.elaborate(&right.unwrap_or_else(|| zero(span)), &PRESCRIBED);
        let dim = self.unify(&left, &right, "equate");
        let kind = ConstraintKind::Velocity {
            zero: left.expr,
            equals: right.expr,
            dimension: dim.known().unwrap_or(Dimension::NONE),
        };
        (kind, dim)
    }

    fn fixed_velocity(&mut self, item: &ItemAst, bodies: &[Body]) -> ConstraintKind {
        let body = self.optional_reference(item, "body");
        self.needs_frame(item, "body", bodies, "carry a material point");
        ConstraintKind::FixedVelocity {
            point: self.reference(item, "point"),
            body,
            frame: self.reference(item, "in"),
            direction: self.components_of(item, "direction", &DIRECTION, Dim::NONE),
            equals: self.expression_of(
                item,
                "equals",
                &PRESCRIBED,
                Dim::Known(Dimension::VELOCITY),
            ),
            one_sided: item.flag("one_sided"),
        }
    }

    /// A position constraint, and its dimension.
    fn position(&mut self, item: &ItemAst) -> (ConstraintKind, Dim) {
        let ast = item.expression("zero").cloned();
        let ast = ast.unwrap_or_else(|| zero(item.name.span.clone()));
        let typed = self.elaborate(&ast, &CLOSURE);
        let kind = ConstraintKind::Position {
            dimension: typed.dim.known().unwrap_or(Dimension::NONE),
            zero: typed.expr,
            dependent: self.optional_reference(item, "dependent"),
            one_sided: item.flag("one_sided"),
        };
        (kind, typed.dim)
    }

    /// Reports a point mass used as a rigid body.
    pub(super) fn needs_frame(&mut self, item: &ItemAst, key: &str, bodies: &[Body], what: &str) {
        let Some(name) = item.text(key) else { return };
        let Some(body) = bodies.iter().find(|b| b.name == name.value) else {
            return;
        };
        let given = self
            .ast
            .items("bodies")
            .iter()
            .any(|b| b.name.value == body.name && (b.entry("frame").is_some() || !b.intact));
        if body.frame.is_some() || given {
            return;
        }
        let message = format!("`{}` is a point mass and cannot {what}", body.name);
        let finding = Diagnostic::error(Code::BodyWithoutFrame, message);
        self.tell(
            finding
                .at(name.span, "")
                .at(body.span.clone(), "has no frame")
                .help("give the body a `frame`"),
        );
    }
}

/// Form of the reaction of a constraint in expressions: the force at its point, or a multiplier.
fn acting(kind: &ConstraintKind) -> Acting {
    let (shape, pushes) = match kind {
        ConstraintKind::Rolling { .. } => (Shape::Vector, true),
        ConstraintKind::FixedVelocity { one_sided, .. } => (Shape::Vector, *one_sided),
        ConstraintKind::Position { one_sided, .. } => (Shape::Scalar, *one_sided),
        ConstraintKind::Velocity { .. } => (Shape::Scalar, false),
    };
    let rate = kind.rate_dimension();
    Acting {
        shape,
        dimension: rate.and_then(|rate| Dimension::POWER.over(&rate).ok()),
        size: 1,
        pushes,
    }
}
