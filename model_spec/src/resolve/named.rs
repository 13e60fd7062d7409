//! Kinematic quantities and forces by name: their references and dimensions.

use crate::ast::Spanned;
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::{Motion, Quantity, Response, Span, Word};
use crate::ids::{ConstraintId, FrameId, LoadId, SpeedId};
use crate::mechanism::{Axis, GROUND};
use crate::suggest::shown;
use crate::units::Dimension;

use super::dimensions::Typed;
use super::meaning::{Acting, Shape};
use super::names::Referred;
use super::place::Place;
use super::resolver::Resolver;

type Names<'a> = &'a [Spanned<String>];
/// An axis of a frame.
type Along = (Axis, FrameId);

fn as_written(word: Word, names: Names<'_>) -> String {
    let names: Vec<&str> = names.iter().map(|name| name.value.as_str()).collect();
    shown(&format!("{}({})", word.name(), names.join(", ")))
}

impl Resolver<'_> {
    /// A kinematic quantity or a force by name.
    pub(super) fn named(
        &mut self,
        word: Word,
        names: Names<'_>,
        span: Span,
        place: &Place,
    ) -> Typed {
        match word {
            Word::Position | Word::Velocity | Word::Speed | Word::AngularVelocity => {
                return self.motion(word, names, span, place);
            }
            _ if !place.allows_word(word) => self.unanswered(word, &span, place),
            Word::Acceleration | Word::AngularAcceleration => {
                return self.acceleration(word, names, span, place);
            }
            Word::Reaction => {
                let found = self.force_of(word, names, &span, |this, id: ConstraintId| {
                    this.reacting.get(id.index()).copied().flatten()
                });
                if let Some((id, along, acting)) = found {
                    return self.response(Response::Reaction(id, along), acting, span, place);
                }
            }
            Word::Force => {
                let found = self.force_of(word, names, &span, |this, id: LoadId| {
                    this.acting.get(id.index()).copied().flatten()
                });
                if let Some((id, along, acting)) = found {
                    return self.response(Response::Force(id, along), acting, span, place);
                }
            }
            Word::DriveForce => return self.drive_force(names, span, place),
            Word::NormalForce => {
                if let Some((id, acting)) = self.contact(names, &span) {
                    return self.response(Response::NormalForce(id), acting, span, place);
                }
            }
        }
        Typed::poisoned(span)
    }

    /// Generalised force that the actuator supplies along a pseudo-velocity with prescribed rate.
    fn drive_force(&mut self, names: Names<'_>, span: Span, place: &Place) -> Typed {
        let [of] = names else {
            self.wrong_names(Word::DriveForce, &span);
            return Typed::poisoned(span);
        };
        let Some(id): Option<SpeedId> = self.find(&of.value, &of.span) else {
            return Typed::poisoned(span);
        };
        let item = self.ast.items("pseudo_velocities").get(id.index());
        if item.is_none_or(|item| item.entry("rate").is_none()) {
            let name = shown(&of.value);
            let message = format!("no drive gives the rate of `{name}`");
            let diagnostic = Diagnostic::error(Code::NotAllowedHere, message);
            let help =
                format!("give `{name}` a `rate`, or name the force of a load: `force(load)`");
            self.tell(diagnostic.at(of.span.clone(), "").help(help));
            return Typed::poisoned(span);
        }
        let speed = self.names.get(of.value.as_str());
        let dimension = speed.and_then(|named| named.dimension);
        let dimension = dimension.and_then(|speed| Dimension::POWER.over(&speed).ok());
        let quantity = Quantity::Response(Response::DriveForce(id));
        let shown = as_written(Word::DriveForce, names);
        self.quantity(quantity, dimension, &shown, span, place)
    }

    /// A kinematic quantity of a point or a frame.
    fn motion(&mut self, word: Word, names: Names<'_>, span: Span, place: &Place) -> Typed {
        let quantity = match (word, names) {
            (Word::Speed, [point]) => {
                let point = self.find(&point.value, &point.span);
                point.map(Motion::Speed)
            }
            (Word::Speed, _) => {
                self.wrong_names(word, &span);
                None
            }
            (Word::AngularVelocity, _) => self
                .component(word, names, &span)
                .map(|(of, axis, frame)| Motion::AngularVelocity(of, axis, frame)),
            (Word::Position, _) => self
                .component(word, names, &span)
                .map(|(of, axis, frame)| Motion::Position(of, axis, frame)),
            _ => self
                .component(word, names, &span)
                .map(|(of, axis, frame)| Motion::Velocity(of, axis, frame)),
        };
        let Some(quantity) = quantity else {
            return Typed::poisoned(span);
        };
        let dimension = match quantity {
            Motion::Position(..) => Dimension::LENGTH,
            Motion::Velocity(..) | Motion::Speed(_) => Dimension::VELOCITY,
            Motion::AngularVelocity(..) => Dimension::NONE.rate().unwrap_or(Dimension::NONE),
        };
        let shown = as_written(word, names);
        let quantity = Quantity::Motion(quantity);
        let typed = self.quantity(quantity, Some(dimension), &shown, span, place);
        if word == Word::Speed {
            self.not_linear(place, "a speed", typed.span(), "not linear");
        }
        typed
    }

    fn acceleration(&mut self, word: Word, names: Names<'_>, span: Span, place: &Place) -> Typed {
        let (response, dimension) = if word == Word::Acceleration {
            let found = self.component(word, names, &span);
            let response = found.map(|(of, axis, frame)| Response::Acceleration(of, axis, frame));
            (response, Some(Dimension::ACCELERATION))
        } else {
            let found = self.component(word, names, &span);
            let response =
                found.map(|(of, axis, frame)| Response::AngularAcceleration(of, axis, frame));
            let rate = Dimension::NONE.rate().and_then(|rate| rate.rate());
            (response, rate.ok())
        };
        match response {
            Some(response) => {
                let quantity = Quantity::Response(response);
                self.quantity(quantity, dimension, &as_written(word, names), span, place)
            }
            None => Typed::poisoned(span),
        }
    }

    /// A point or frame, an axis and the frame of the axis.
    fn component<I: Referred>(
        &mut self,
        word: Word,
        names: Names<'_>,
        span: &Span,
    ) -> Option<(I, Axis, FrameId)> {
        let ([of, axis] | [of, axis, _]) = names else {
            self.wrong_names(word, span);
            return None;
        };
        let along = self.along(axis, names.get(2), word);
        let of = self.find(&of.value, &of.span);
        of.zip(along).map(|(of, (axis, frame))| (of, axis, frame))
    }

    fn along(
        &mut self,
        axis: &Spanned<String>,
        frame: Option<&Spanned<String>>,
        word: Word,
    ) -> Option<Along> {
        let axis = self.axis_named(axis, word);
        let frame = match frame {
            Some(frame) => self.find(&frame.value, &frame.span),
            None => Some(GROUND),
        };
        axis.zip(frame)
    }

    fn response(&mut self, response: Response, acting: Acting, span: Span, place: &Place) -> Typed {
        let quantity = Quantity::Response(response);
        Typed {
            size: acting.size,
            ..self.quantity(quantity, acting.dimension, "", span, place)
        }
    }

    /// The load or constraint of a force, and the axis.
    fn force_of<I: Referred>(
        &mut self,
        word: Word,
        names: Names<'_>,
        span: &Span,
        known: impl Fn(&Self, I) -> Option<Acting>,
    ) -> Option<(I, Option<Along>, Acting)> {
        let (of, axis, frame) = match names {
            [of] => (of, None, None),
            [of, axis] => (of, Some(axis), None),
            [of, axis, frame] => (of, Some(axis), Some(frame)),
            _ => {
                self.wrong_names(word, span);
                return None;
            }
        };
        let along = match axis {
            Some(axis) => Some(self.along(axis, frame, word)?),
            None => None,
        };
        let id = self.find(&of.value, &of.span)?;
        // Invalid and cyclic references have been reported.
        let acting = known(self, id)?;
        let (own, name) = (word.name(), shown(&of.value));
        let (message, help) = match (acting.shape, along) {
            (Shape::Vector, Some(_)) | (Shape::Scalar, None) => return Some((id, along, acting)),
            (Shape::Vector, None) => (
                format!("`{own}({name})` has three components"),
                format!(
                    "name an axis: `{own}({name}, x)`, or `{own}({name}, x, frame)` for an axis of \
                     a frame"
                ),
            ),
            (Shape::Scalar, Some(_)) => (
                format!("`{own}({name})` is one number and has no axes"),
                format!("write `{own}({name})`"),
            ),
            (Shape::Spread, _) => (
                format!("`{name}` acts on every body with another force"),
                "write the weight of a body as its mass times the acceleration".to_owned(),
            ),
        };
        self.error(Code::WrongArity, span.clone(), message, help);
        None
    }

    /// A contact with a normal force.
    fn contact(&mut self, names: Names<'_>, span: &Span) -> Option<(ConstraintId, Acting)> {
        let [of] = names else {
            self.wrong_names(Word::NormalForce, span);
            return None;
        };
        let id: ConstraintId = self.find(&of.value, &of.span)?;
        let acting = self.reacting.get(id.index()).copied().flatten()?;
        if acting.pushes {
            return Some((id, acting));
        }
        let name = shown(&of.value);
        let written = match acting.shape {
            Shape::Vector => format!("reaction({name}, z)"),
            Shape::Scalar | Shape::Spread => format!("reaction({name})"),
        };
        let message = format!("`{name}` is no contact: its reaction has no normal");
        let help = format!(
            "write `{written}`, or give a constraint that can only push `one_sided = true`"
        );
        self.error(Code::NotAllowedHere, span.clone(), message, help);
        None
    }

    /// Reports an expression in which accelerations and forces are not allowed.
    fn unanswered(&mut self, word: Word, span: &Span, place: &Place) {
        let is_acceleration = matches!(
            word,
            Word::Acceleration | Word::AngularAcceleration | Word::DriveForce
        );
        let what = if is_acceleration {
            "accelerations"
        } else {
            "forces of loads and constraints"
        };
        let help = if is_acceleration && place.is_force() {
            "a force that grows with an acceleration is the inertia of a mass: add the mass to \
             `[bodies]`"
                .to_owned()
        } else {
            format!("allowed here: {}", place.allowed_words())
        };
        let message = format!("{} cannot depend on {what}", place.what);
        self.error(Code::NotAllowedHere, span.clone(), message, help);
    }

    fn axis_named(&mut self, name: &Spanned<String>, word: Word) -> Option<Axis> {
        let axis = match name.value.as_str() {
            "x" => Some(Axis::X),
            "y" => Some(Axis::Y),
            "z" => Some(Axis::Z),
            _ => None,
        };
        if axis.is_none() {
            let message = format!("`{}` is no axis", shown(&name.value));
            let help = format!(
                "the second name is an axis, `x`, `y` or `z`: `{}`",
                word.example()
            );
            self.error(Code::UnknownReference, name.span.clone(), message, help);
        }
        axis
    }

    fn wrong_names(&mut self, word: Word, span: &Span) {
        let alone = [Word::Speed, Word::NormalForce, Word::DriveForce];
        let more = if alone.contains(&word) {
            String::new()
        } else {
            let with_frame = word.example().replace(')', ", frame)");
            format!(", or `{with_frame}` for an axis of a frame")
        };
        let message = format!("`{}` has other names", word.name());
        let help = format!("write `{}`{more}", word.example());
        self.error(Code::WrongArity, span.clone(), message, help);
    }
}
