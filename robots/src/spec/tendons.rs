//! Sums of coordinates: tendons and couplings.

use crate::letters::{plain, quantity};
use crate::loops::Equations;
use crate::model::{Coupling, Motion, Sum, Tendon};
use crate::rotation::is_zero;
use crate::table::Item;

use super::resistances::{Owner, Property};
use super::units::Units;
use super::{Writer, operand, plus};

impl Writer<'_> {
    /// The units of a sum: those of a length if one of its joints slides.
    pub(super) fn units(&self, sum: &Sum) -> Units {
        let slides = |name: &String| {
            let body = self.tree.by_joint.get(name);
            body.is_some_and(|body| self.tree.bodies[*body].joint.motion == Motion::Sliding)
        };
        let slides = sum.terms.iter().any(|(name, _)| slides(name));
        Units::of(if slides {
            Motion::Sliding
        } else {
            Motion::Turning
        })
    }

    /// A sum over coordinates, each written by `each`.
    pub(super) fn sum(&self, sum: &Sum, units: &Units, each: impl Fn(&str) -> String) -> String {
        let mut written = "0".to_owned();
        for (name, factor) in &sum.terms {
            let Some(&body) = self.tree.by_joint.get(name) else {
                continue;
            };
            let q = each(&self.called.coordinates[body]);
            let own = Units::of(self.tree.bodies[body].joint.motion).coordinate;
            let factor = match plain(*factor) {
                number if own != units.coordinate => format!("{number} [m]"),
                number => number,
            };
            let term = match factor.as_str() {
                "0" => continue,
                "1" => q,
                "-1" => format!("-{q}"),
                factor => format!("{factor}*{q}"),
            };
            written = plus(&written, &term);
        }
        written
    }

    /// The passive forces of tendons.
    pub(super) fn tendons(&mut self, tendons: &[Tendon]) {
        for tendon in tendons {
            let called = self.quantities.new_one(&crate::names::short(&tendon.name));
            let units = self.units(&tendon.length);
            let length = self.sum(&tendon.length, &units, str::to_owned);
            let rate = self.sum(&tendon.length, &units, |q| format!("dot({q})"));
            if rate == "0" {
                continue;
            }
            let owner = Owner {
                called: &called,
                of: &tendon.name,
                kind: "tendon",
                along: ("velocity", &rate),
                units: &units,
            };
            self.damping(&owner, tendon.damping, &rate);
            self.friction(&owner, tendon.friction, &rate);
            if !is_zero(tendon.stiffness) {
                let [from, to] = tendon.relaxed.map(|end| tendon.length.constant - end);
                let beyond = |end: f64| plus(&length, &quantity(end, units.coordinate));
                let strain = if to - from == 0.0 {
                    beyond(from)
                } else {
                    let zero = if units.coordinate == "m" {
                        "0 [m]"
                    } else {
                        "0"
                    };
                    format!(
                        "min({}, {zero}) + max({}, {zero})",
                        beyond(from),
                        beyond(to)
                    )
                };
                self.elastic(&owner, tendon.stiffness, &strain);
            }
            if tendon.armature != 0.0 {
                let property = Property::new("armature", "", "inertia");
                let inertia = self.of_owner(&owner, property, tendon.armature, units.inertia);
                let of = format!("tendon {}", tendon.name);
                self.turning_rotor(&called, &length, inertia, &units, &of);
            }
            self.mark(&tendon.place);
        }
    }

    /// The equations between coordinates.
    pub(super) fn couplings(&mut self, couplings: &[Coupling], equations: &Equations) {
        for (coupling, follower) in couplings.iter().zip(&equations.couplings) {
            let Some(follower) = follower else {
                continue;
            };
            let own = self.units(&coupling.follows);
            let value = self.polynomial(coupling, &own);
            let shift = coupling.follows.constant - coupling.zeros[0];
            let follows = self.sum(&coupling.follows, &own, str::to_owned);
            let zero = plus(&follows, &quantity(shift, own.coordinate));
            let zero = match value.as_str() {
                "0" => zero,
                value if value.contains([' ', '-']) => format!("{zero} - ({value})"),
                value => format!("{zero} - {value}"),
            };
            let item = Item::default()
                .text("kind", "position")
                .text("zero", &zero)
                .text("dependent", &self.called.coordinates[follower.body]);
            self.constraints.add(&coupling.name, &item);
            self.mark(&coupling.place);
        }
    }

    /// The value of the dependent sum as a polynomial of the other one.
    fn polynomial(&self, coupling: &Coupling, own: &Units) -> String {
        if let Some(other) = coupling
            .other
            .as_ref()
            .filter(|other| other.terms.is_empty())
        {
            let x = other.constant - coupling.zeros[1];
            let value = coupling
                .coefficients
                .iter()
                .rev()
                .fold(0.0, |sum, factor| sum * x + factor);
            return quantity(value, own.coordinate);
        }
        let x = coupling.other.as_ref().map(|other| {
            let units = self.units(other);
            let shift = quantity(other.constant - coupling.zeros[1], units.coordinate);
            let x = operand(&plus(&self.sum(other, &units, str::to_owned), &shift));
            (x, units.coordinate)
        });
        let mut value = "0".to_owned();
        for (power, coefficient) in coupling.coefficients.iter().enumerate() {
            if *coefficient == 0.0 {
                continue;
            }
            let term = match (power, &x) {
                (0, _) => quantity(*coefficient, own.coordinate),
                (_, None) => continue,
                (_, Some((x, unit))) => {
                    let x = match power {
                        1 => x.clone(),
                        power => format!("{x}^{power}"),
                    };
                    let number = plain(*coefficient);
                    let factor = match (own.coordinate, *unit) {
                        (y, x) if y == x && (power == 1 || y == "rad") => number,
                        ("m", "m") => format!("{number} [1/m^{}]", power - 1),
                        ("m", _) => format!("{number} [m]"),
                        _ => format!("{number} [1/m^{power}]"),
                    };
                    match factor.as_str() {
                        "1" => x,
                        factor => format!("{factor}*{x}"),
                    }
                }
            };
            value = plus(&value, &term);
        }
        value
    }
}
