//! Centres of mass and inertias whose numbers patterns select: they are those of the file's frames.

use crate::inertia::without_rounding;
use crate::letters::{Kind, Number, plain, quantity};
use crate::model::Motion;
use crate::rotation::add;

use super::drives::times;
use super::{Writer, plus};

/// Entries of a rotation that count as zero.
const ROUNDING: f64 = 1e-15;
const COMPONENTS: [(&str, &str); 3] = [("x", "com.x"), ("y", "com.y"), ("z", "com.z")];

impl Writer<'_> {
    /// Whether a component of a centre of mass is to be a parameter.
    pub(super) fn centre_is_selected(&self, index: usize) -> bool {
        let link = &self.links[self.at(index).link].name;
        let patterns = &self.numbers.patterns;
        COMPONENTS
            .iter()
            .any(|(_, attribute)| patterns.choose(link, attribute, 1.0))
    }

    /// A centre of mass from the point of its body, with components in the frame of its link as parameters.
    pub(super) fn centre_in_link(&mut self, index: usize) -> Vec<String> {
        let body = self.at(index);
        let link = &self.links[body.link];
        let called = self.called.links[body.link].clone();
        let anchor = match body.joint.motion {
            Motion::Turning | Motion::Ball => body.joint.anchor,
            Motion::Sliding | Motion::Free => [0.0; 3],
        };
        let mut with_mass = body
            .parts
            .iter()
            .filter(|part| !self.links[part.link].inertia.is_nothing());
        let alone = with_mass.all(|part| part.link == body.link);
        let centre = if alone {
            link.inertia.centre
        } else {
            add(body.own.of(body.inertia.centre), anchor)
        };
        let numbers = &mut self.numbers;
        let quantities = &mut self.quantities;
        let own: Vec<String> = COMPONENTS
            .into_iter()
            .zip(centre)
            .map(|((axis, attribute), value)| {
                let number = Number {
                    value,
                    unit: "m",
                    letter: &format!("c{axis}_{called}"),
                    of: &link.name,
                    attribute,
                    about: &format!("centre of mass of {called} in its frame in the file, {axis}"),
                    kind: Kind::Inertial,
                    ..Number::default()
                };
                numbers.write(number, quantities)
            })
            .collect();
        let turned = body.own.inverse();
        let shift = without_rounding(turned.of(anchor));
        (turned.0.iter().zip(shift))
            .map(|(row, shift)| {
                let terms = row
                    .iter()
                    .zip(&own)
                    .filter(|(factor, _)| factor.abs() > ROUNDING);
                let sum = terms.fold("0".to_owned(), |sum, (factor, of)| {
                    plus(&sum, &times(&plain(*factor), of))
                });
                plus(&sum, &quantity(-shift, "m"))
            })
            .collect()
    }

    /// Entries of an inertia, times a common factor if the inertia is to be a parameter.
    pub(super) fn scaled(&mut self, index: usize, entries: Vec<String>) -> Vec<String> {
        let body = self.at(index);
        let called = self.called.links[body.link].clone();
        if entries.iter().all(|entry| entry == "0") {
            return entries;
        }
        let number = Number {
            letter: &format!("inertia_{called}"),
            of: &self.links[body.link].name,
            attribute: "inertia",
            about: &format!(
                "inertia of {called} about its centre of mass, relative to that of the file"
            ),
            kind: Kind::Inertial,
            never_negative: true,
            ..Number::default()
        };
        let Some(factor) = self.numbers.factor(number, &mut self.quantities) else {
            return entries;
        };
        let scaled = entries.into_iter().map(|entry| match entry.as_str() {
            "0" => entry,
            entry => format!("{entry}*{factor}"),
        });
        scaled.collect()
    }
}
