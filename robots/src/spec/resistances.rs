//! Damping, springs and dry friction along a coordinate, a speed or the length of a tendon.

use crate::letters::{Kind, Number, quantity};
use crate::model::Polynomial;
use crate::rotation::is_zero;
use crate::table::Item;

use super::units::Units;
use super::{Writer, operand, plus};

/// Rates below which dry friction fades out, for an angle and for a length: that of an arm of a tenth of a meter.
const SLOW: [f64; 2] = [0.004, 0.0004];

/// The coordinate, speed or tendon on which such forces act.
pub(super) struct Owner<'a> {
    /// Its name in the spec, and in the file.
    pub(super) called: &'a str,
    pub(super) of: &'a str,
    /// `joint` or `tendon`.
    pub(super) kind: &'a str,
    /// The key and the value that give the direction of a load.
    pub(super) along: (&'a str, &'a str),
    pub(super) units: &'a Units,
}

/// A physical property of a joint or a tendon.
#[derive(Clone, Copy)]
pub(super) struct Property<'a> {
    /// Its value in the unit.
    pub(super) value: f64,
    /// Its SI unit.
    pub(super) unit: &'static str,
    /// The beginning of its name as a parameter.
    pub(super) letter: &'a str,
    /// The attribute of a joint that it is, as far as patterns select it.
    pub(super) attribute: &'static str,
    /// Its description, without the joint or tendon.
    pub(super) about: &'a str,
}

impl Writer<'_> {
    /// A number of a joint or a tendon, as an expression.
    pub(super) fn of_owner(
        &mut self,
        called: &str,
        of: &str,
        kind: &str,
        property: Property<'_>,
    ) -> String {
        let number = Number {
            value: property.value,
            unit: property.unit,
            letter: &format!("{}_{called}", property.letter),
            of,
            attribute: if kind == "joint" {
                property.attribute
            } else {
                ""
            },
            about: &format!("{} of {kind} {of}", property.about),
            kind: Kind::Other,
            never_negative: property.value >= 0.0 && !property.letter.starts_with("relaxed"),
        };
        self.numbers.write(number, &mut self.quantities)
    }

    /// Whether a number of a joint is selected by its name, also where it is zero.
    fn chosen(&self, owner: &Owner<'_>, attribute: &str) -> bool {
        owner.kind == "joint" && self.numbers.patterns.names(owner.of, attribute)
    }

    /// Adds a load along the coordinate, speed or tendon.
    fn resist(&mut self, owner: &Owner<'_>, word: &str, force: &str) {
        let (key, along) = owner.along;
        let item = Item::default()
            .text("kind", "generalized")
            .text(key, along)
            .text("force", force);
        self.loads.add(&format!("{word}_{}", owner.called), &item);
    }

    /// A resisting force as a polynomial, given the powers of its argument.
    fn opposing(
        &mut self,
        owner: &Owner<'_>,
        word: &str,
        factors: Polynomial,
        units: [&'static str; 3],
        powers: [String; 3],
    ) -> String {
        let mut force = "0".to_owned();
        for (index, (factor, power)) in factors.into_iter().zip(powers).enumerate() {
            if factor == 0.0 {
                continue;
            }
            let letter = match index {
                0 => word.to_owned(),
                _ => format!("{word}_{}", index + 1),
            };
            let number = Property {
                value: factor,
                unit: units[index],
                letter: &letter,
                attribute: match (index, word) {
                    (0, "damping") => "damping",
                    (0, "stiffness") => "stiffness",
                    _ => "",
                },
                about: word,
            };
            let factor = self.of_owner(owner.called, owner.of, owner.kind, number);
            let term = format!("{factor}*{power}");
            force = match (force.as_str(), term.strip_prefix('-')) {
                ("0", Some(term)) => term.to_owned(),
                ("0", None) => format!("-{term}"),
                (force, Some(term)) => format!("{force} + {term}"),
                (force, None) => format!("{force} - {term}"),
            };
        }
        force
    }

    /// Damping a v + b v |v| + c v³.
    pub(super) fn damping(&mut self, owner: &Owner<'_>, damping: Polynomial, rate: &str) {
        let ("coordinate", [linear, 0.0, 0.0]) = (owner.along.0, damping) else {
            if !is_zero(damping) {
                let factor = operand(rate);
                let powers = [
                    factor.clone(),
                    format!("{factor}*abs({rate})"),
                    format!("{factor}^3"),
                ];
                let units = owner.units.damping;
                let force = self.opposing(owner, "damping", damping, units, powers);
                self.resist(owner, "damping", &force);
            }
            return;
        };
        if linear != 0.0 || self.chosen(owner, "damping") {
            let number = Property {
                value: linear,
                unit: owner.units.damping[0],
                letter: "damping",
                attribute: "damping",
                about: "damping",
            };
            let damping = self.of_owner(owner.called, owner.of, owner.kind, number);
            let item = Item::default()
                .text("kind", "damper")
                .text("coordinate", owner.along.1)
                .expression("damping", &damping);
            self.loads.add(&format!("damping_{}", owner.called), &item);
        }
    }

    /// A spring of a coordinate, a x + b x² + c x³.
    pub(super) fn spring(&mut self, owner: &Owner<'_>, stiffness: Polynomial, relaxed: f64) {
        if is_zero(stiffness) && !self.chosen(owner, "stiffness") {
            return;
        }
        let relaxed_at = |value: f64, attribute: &'static str| Property {
            value,
            unit: owner.units.coordinate,
            letter: "relaxed",
            attribute,
            about: "coordinate of the relaxed spring",
        };
        if let [linear, 0.0, 0.0] = stiffness {
            let number = Property {
                value: linear,
                unit: owner.units.stiffness[0],
                letter: "stiffness",
                attribute: "stiffness",
                about: "stiffness of the spring",
            };
            let stiffness = self.of_owner(owner.called, owner.of, owner.kind, number);
            let relaxed = self.of_owner(
                owner.called,
                owner.of,
                owner.kind,
                relaxed_at(relaxed, "springref"),
            );
            let item = Item::default()
                .text("kind", "spring")
                .text("coordinate", owner.along.1)
                .expression("stiffness", &stiffness);
            let item = if relaxed == "0" {
                item
            } else {
                item.expression("relaxed", &relaxed)
            };
            self.loads.add(&format!("spring_{}", owner.called), &item);
            return;
        }
        let relaxed = self.of_owner(owner.called, owner.of, owner.kind, relaxed_at(-relaxed, ""));
        let x = plus(owner.along.1, &relaxed);
        self.elastic(owner, stiffness, &x);
    }

    /// The force of a spring by how far it is strained.
    pub(super) fn elastic(&mut self, owner: &Owner<'_>, stiffness: Polynomial, strain: &str) {
        let x = operand(strain);
        let powers = [x.clone(), format!("{x}^2"), format!("{x}^3")];
        let force = self.opposing(owner, "stiffness", stiffness, owner.units.stiffness, powers);
        self.resist(owner, "spring", &force);
    }

    /// Dry friction.
    pub(super) fn friction(&mut self, owner: &Owner<'_>, friction: f64, rate: &str) {
        if friction == 0.0 && !self.chosen(owner, "frictionloss") {
            return;
        }
        let number = Property {
            value: friction,
            unit: owner.units.force,
            letter: "friction",
            attribute: "frictionloss",
            about: "dry friction",
        };
        let friction = self.of_owner(owner.called, owner.of, owner.kind, number);
        let is_angle = owner.units.coordinate == "rad";
        let slow = quantity(SLOW[usize::from(!is_angle)], owner.units.rate);
        let force = format!("-{friction}*smooth_sign({rate}, {slow})");
        self.resist(owner, "friction", &force);
    }
}
