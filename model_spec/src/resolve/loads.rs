//! Forces, torques, springs and dampers.

use crate::ast::{ItemAst, Spanned};
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::{Expr, ExprKind, Quantity, Span};
use crate::language::{ItemKind, LoadWord};
use crate::mechanism::{
    Axis, Body, Connection, CoordinateId, Frame, Load, LoadKind, ORIGIN, Spring,
};
use crate::parse::zero;
use crate::units::Dimension;

use super::dimensions::{Dim, Typed};
use super::load_order;
use super::meaning::{Acting, Shape};
use super::place::Place;
use super::placement::axis;
use super::resolver::Resolver;

const ACCELERATION: Place = Place::constant("the gravitational acceleration");
const FORCE: Place = Place::force("a component of a force");
const TORQUE: Place = Place::force("a component of a torque");
const STIFFNESS: Place = Place::scheduled("the stiffness of a spring");
const RELAXED: Place = Place::scheduled("the relaxed length");
const ANGLE: Place = Place::scheduled("the relaxed angle");
const DAMPING: Place = Place::force("the damping of a damper");
const GENERALIZED: Place = Place::force("a generalised force");

impl Resolver<'_> {
    pub(super) fn loads(&mut self, bodies: &[Body], frames: &[Frame]) -> Vec<Load> {
        let ast = self.ast;
        let is_load = |item: &&ItemAst| matches!(item.kind.map(|k| k.is), Some(ItemKind::Load(_)));
        let items: Vec<&ItemAst> = ast.items("loads").iter().filter(is_load).collect();
        for (place, item) in items.iter().enumerate() {
            self.loads.insert(item.name.value.as_str(), place);
        }
        self.acting = vec![None; items.len()];
        let mut read = vec![None; items.len()];
        for place in load_order::ordered(self, &items) {
            self.largest_size = 1;
            read[place] = self.load(items[place], bodies, frames);
            self.acting[place] = read[place].as_ref().map(|(_, acting)| *acting);
        }
        read.into_iter().flatten().map(|(load, _)| load).collect()
    }

    /// A load, and the form of its force in expressions.
    fn load(
        &mut self,
        item: &ItemAst,
        bodies: &[Body],
        frames: &[Frame],
    ) -> Option<(Load, Acting)> {
        let Some(ItemKind::Load(word)) = item.kind.map(|kind| kind.is) else {
            return None;
        };
        let (kind, shape, dimension) = match word {
            LoadWord::Gravity => (self.gravity(item), Shape::Spread, None),
            LoadWord::Force => {
                let force = Some(Dimension::FORCE);
                (self.force(item, bodies), Shape::Vector, force)
            }
            LoadWord::Torque => {
                let torque = Some(Dimension::TORQUE);
                (self.torque(item, bodies), Shape::Vector, torque)
            }
            LoadWord::Spring => {
                let (kind, tension) = self.spring(item);
                (kind, Shape::Scalar, tension)
            }
            LoadWord::Damper => {
                let (kind, tension) = self.damper(item);
                (kind, Shape::Scalar, tension)
            }
            LoadWord::TorsionalSpring => {
                let torque = Some(Dimension::TORQUE);
                (self.torsional_spring(item, frames), Shape::Scalar, torque)
            }
            LoadWord::Generalized => {
                let (kind, force) = self.generalized(item);
                (kind, Shape::Scalar, force)
            }
        };
        let acting = Acting {
            shape,
            dimension,
            size: self.largest_size.saturating_add(1),
            pushes: false,
        };
        let load = Load {
            name: item.name.value.clone(),
            about: Self::about(item),
            kind,
            line: self.line(&item.name.span),
            span: item.name.span.clone(),
        };
        Some((load, acting))
    }

    fn gravity(&mut self, item: &ItemAst) -> LoadKind {
        let (direction, negative) = axis(item, "down");
        let step = if negative { -1 } else { 1 };
        LoadKind::Gravity {
            down: match direction {
                Axis::X => [step, 0, 0],
                Axis::Y => [0, step, 0],
                Axis::Z => [0, 0, step],
            },
            acceleration: self.expression_of(
                item,
                "acceleration",
                &ACCELERATION,
                Dim::Known(Dimension::ACCELERATION),
            ),
        }
    }

    fn force(&mut self, item: &ItemAst, bodies: &[Body]) -> LoadKind {
        let on = self.reference(item, "on");
        let body = self.optional_reference(item, "body");
        self.needs_frame(item, "body", bodies, "carry a material point");
        let reaction_on = self.optional_reference(item, "reaction_on");
        self.on_itself(item);
        LoadKind::Force {
            on,
            body,
            reaction_on,
            frame: self.reference(item, "in"),
            vector: self.components_of(item, "vector", &FORCE, Dim::Known(Dimension::FORCE)),
        }
    }

    fn torque(&mut self, item: &ItemAst, bodies: &[Body]) -> LoadKind {
        let on = self.reference(item, "on");
        let reaction_on = self.optional_reference(item, "reaction_on");
        self.needs_frame(item, "on", bodies, "be subject to a torque");
        self.needs_frame(item, "reaction_on", bodies, "be subject to a torque");
        self.on_itself(item);
        LoadKind::Torque {
            on,
            reaction_on,
            frame: self.reference(item, "in"),
            vector: self.components_of(item, "vector", &TORQUE, Dim::Known(Dimension::TORQUE)),
        }
    }

    fn on_itself(&mut self, item: &ItemAst) {
        if let (Some(on), Some(reaction)) = (item.text("on"), item.text("reaction_on"))
            && on.value == reaction.value
        {
            self.connected_to_itself(on.value, reaction.span, on.span);
        }
    }

    fn connected_to_itself(&mut self, name: &str, span: Span, first: Span) {
        let message = format!("`{name}` acts on itself, which changes nothing");
        let finding = Diagnostic::error(Code::SelfReaction, message);
        self.tell(
            finding
                .at(span, "the same again")
                .at(first, "here")
                .help("name two different items"),
        );
    }

    fn two_ends(&mut self, a: &Spanned<String>, b: &Spanned<String>) {
        if a.value == b.value {
            self.connected_to_itself(&a.value, b.span.clone(), a.span.clone());
        }
    }

    /// The connection of a spring or damper, and the dimension of its displacement.
    fn connection(&mut self, item: &ItemAst) -> (Connection, Option<Dimension>) {
        let both = item.entry("between").is_some() && item.entry("coordinate").is_some();
        if let Some([a, b]) = item.names("between") {
            let first = self.find(&a.value, &a.span).unwrap_or(ORIGIN);
            let second = self.find(&b.value, &b.span).unwrap_or(ORIGIN);
            self.two_ends(a, b);
            let displacement = Some(Dimension::LENGTH).filter(|_| !both);
            return (Connection::Points(first, second), displacement);
        }
        let (coordinate, dimension) = self.coordinate_under(item);
        let along = Self::quantity_under(item, Quantity::Coordinate(coordinate));
        (Connection::Along(along), dimension)
    }

    /// A coordinate or its rate, at the position of the key `coordinate`.
    fn quantity_under(item: &ItemAst, quantity: Quantity) -> Expr {
        let span = item.text("coordinate").map(|name| name.span);
        Expr {
            kind: ExprKind::Quantity(quantity),
            span: span.unwrap_or_else(|| item.name.span.clone()),
        }
    }

    fn coordinate_under(&mut self, item: &ItemAst) -> (CoordinateId, Option<Dimension>) {
        let Some(name) = item.text("coordinate") else {
            return (CoordinateId::new(0), None);
        };
        let Some(id) = self.find(name.value, &name.span) else {
            return (CoordinateId::new(0), None);
        };
        self.used.add(Quantity::Coordinate(id));
        let dimension = self.names.get(name.value).and_then(|n| n.dimension);
        (id, dimension)
    }

    /// A spring and the dimension of its tension.
    fn spring(&mut self, item: &ItemAst) -> (LoadKind, Option<Dimension>) {
        let (between, displacement) = self.connection(item);
        let force = Dim::Known(Dimension::TORQUE).per(displacement);
        let stiffness = force.per(displacement);
        let relaxed = displacement.map_or(Dim::Unknown, Dim::Known);
        let kind = LoadKind::SpringDamper {
            between,
            spring: Some(Spring {
                stiffness: self.expression_of(item, "stiffness", &STIFFNESS, stiffness),
                relaxed: self.expression_of(item, "relaxed", &RELAXED, relaxed),
            }),
            damping: None,
        };
        (kind, force.known())
    }

    /// A damper and the dimension of its tension.
    fn damper(&mut self, item: &ItemAst) -> (LoadKind, Option<Dimension>) {
        let (between, displacement) = self.connection(item);
        let force = Dim::Known(Dimension::TORQUE).per(displacement);
        let damping = force.per(displacement).times(Some(Dimension::TIME));
        let kind = LoadKind::SpringDamper {
            between,
            spring: None,
            damping: Some(self.expression_of(item, "damping", &DAMPING, damping)),
        };
        (kind, force.known())
    }

    fn torsional_spring(&mut self, item: &ItemAst, frames: &[Frame]) -> LoadKind {
        let angle = match item.names("between") {
            Some([a, b]) if a.value == b.value => {
                self.two_ends(a, b);
                Expr::integer(0, a.span.clone())
            }
            Some([first, second]) => self.relative_angle([first, second], frames),
            _ => Expr::integer(0, item.name.span.clone()),
        };
        let torque = Dim::Known(Dimension::TORQUE);
        let damping = item.entry("damping").is_some();
        LoadKind::SpringDamper {
            between: Connection::Along(angle),
            spring: Some(Spring {
                stiffness: self.expression_of(item, "stiffness", &STIFFNESS, torque),
                relaxed: self.expression_of(item, "relaxed", &ANGLE, Dim::NONE),
            }),
            damping: damping.then(|| {
                let damping = torque.times(Some(Dimension::TIME));
                self.expression_of(item, "damping", &DAMPING, damping)
            }),
        }
    }

    /// A generalised force and its dimension.
    fn generalized(&mut self, item: &ItemAst) -> (LoadKind, Option<Dimension>) {
        // Force times velocity is a power for velocities of any dimension.
        let (velocity, dimension) = if item.entry("velocity").is_some() {
            let along = self.velocity_along(item);
            (along.expr, along.dim.known())
        } else {
            let (coordinate, displacement) = self.coordinate_under(item);
            let velocity = Self::quantity_under(item, Quantity::Rate(coordinate));
            (velocity, displacement.and_then(|own| own.rate().ok()))
        };
        let force = Dim::Known(Dimension::POWER).per(dimension);
        let kind = LoadKind::Generalized {
            velocity,
            force: self.expression_of(item, "force", &GENERALIZED, force),
        };
        (kind, force.known())
    }

    fn velocity_along(&mut self, item: &ItemAst) -> Typed {
        let missing = || zero(item.name.span.clone());
        let ast = item.expression("velocity").cloned().unwrap_or_else(missing);
        let along = self.elaborate(&ast, &Place::ALONG);
        if item.intact && along.degree != Some(1) && along.dim != Dim::Unknown {
            let message = "no rate at all";
            self.not_linear(&Place::ALONG, message, along.span(), "no velocity here");
        }
        along
    }
}
