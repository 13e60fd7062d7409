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
    /// The beginning of its name as a parameter.
    letter: &'a str,
    /// The attribute of a joint that it is, as far as patterns select it.
    attribute: &'static str,
    /// Its description, without the joint or tendon.
    about: &'a str,
}

impl<'a> Property<'a> {
    pub(super) const fn new(letter: &'a str, attribute: &'static str, about: &'a str) -> Self {
        Self {
            letter,
            attribute,
            about,
        }
    }
}

const DAMPING: Property<'_> = Property::new("damping", "damping", "damping");
const STIFFNESS: Property<'_> = Property::new("stiffness", "stiffness", "stiffness of the spring");
const RELAXED: &str = "coordinate of the relaxed spring";
const FRICTION: Property<'_> = Property::new("friction", "frictionloss", "dry friction");

impl Writer<'_> {
    /// A number of a joint or a tendon, as an expression.
    pub(super) fn of_owner(
        &mut self,
        owner: &Owner<'_>,
        property: Property<'_>,
        value: f64,
        unit: &'static str,
    ) -> String {
        let Property {
            letter,
            attribute,
            about,
        } = property;
        let number = Number {
            value,
            unit,
            letter: &format!("{letter}_{}", owner.called),
            of: owner.of,
            attribute: match owner.kind {
                "joint" => attribute,
                _ => "",
            },
            about: &format!("{about} of {} {}", owner.kind, owner.of),
            kind: Kind::Other,
            never_negative: value >= 0.0 && letter != "relaxed",
        };
        self.numbers.write(number, &mut self.quantities)
    }

    /// Whether a number of a joint is selected by its name, also where it is zero.
    fn chosen(&self, owner: &Owner<'_>, attribute: &str) -> bool {
        owner.kind == "joint" && self.numbers.patterns.names(owner.of, attribute)
    }

    /// Adds a load along the coordinate, speed or tendon.
    fn resist(&mut self, owner: &Owner<'_>, word: &str, force: &str) {
        let item = Item::generalized(owner.along, force);
        self.loads.add(&format!("{word}_{}", owner.called), &item);
    }

    /// A resisting force as a polynomial, given the powers of its argument.
    fn opposing(
        &mut self,
        owner: &Owner<'_>,
        word: &'static str,
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
            let attribute = if index == 0 { word } else { "" };
            let property = Property::new(&letter, attribute, word);
            let factor = self.of_owner(owner, property, factor, units[index]);
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
            let damping = self.of_owner(owner, DAMPING, linear, owner.units.damping[0]);
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
        let unit = owner.units.coordinate;
        if let [linear, 0.0, 0.0] = stiffness {
            let stiffness = self.of_owner(owner, STIFFNESS, linear, owner.units.stiffness[0]);
            let at = Property::new("relaxed", "springref", RELAXED);
            let relaxed = self.of_owner(owner, at, relaxed, unit);
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
        let at = Property::new("relaxed", "", RELAXED);
        let relaxed = self.of_owner(owner, at, -relaxed, unit);
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
        let friction = self.of_owner(owner, FRICTION, friction, owner.units.force);
        let is_angle = owner.units.coordinate == "rad";
        let slow = quantity(SLOW[usize::from(!is_angle)], owner.units.rate);
        let force = format!("-{friction}*smooth_sign({rate}, {slow})");
        self.resist(owner, "friction", &force);
    }
}
