//! Units: values are in SI, and displayed in the unit of the spec.

use std::collections::BTreeMap;

use appell_runtime::model::Quantity;
use appell_spec::units::{Dimension, Unit, parse};

use super::xml::Element;

/// The attributes of the base units, in the order of the exponents of a dimension.
const BASE: [&str; 7] = ["m", "kg", "s", "A", "K", "mol", "cd"];

/// A unit in SI; angles and their rates are distinguished from numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Si {
    dimension: Dimension,
    angle: bool,
}

impl Si {
    fn name(self) -> String {
        let rates = [
            Dimension::NONE,
            Dimension::integers([0, 0, -1, 0, 0, 0, 0]),
            Dimension::integers([0, 0, -2, 0, 0, 0, 0]),
        ];
        let rate = rates.iter().position(|rate| *rate == self.dimension);
        match rate.filter(|_| self.angle) {
            Some(0) => "rad".to_owned(),
            Some(1) => "rad/s".to_owned(),
            Some(_) => "rad/s^2".to_owned(),
            None => Unit::si(self.dimension).text,
        }
    }

    /// Exponents of the base units, if they are integers.
    fn base(self) -> Option<Element> {
        let mut element = Element::new("BaseUnit");
        for (name, exponent) in BASE.into_iter().zip(self.dimension.exponents()) {
            if !exponent.is_integer() {
                return None;
            }
            if *exponent.numer() != 0 {
                element = element.with(name, exponent.numer());
            }
        }
        let is_angle = self.name().starts_with("rad");
        Some(element.maybe("rad", is_angle.then_some(1)))
    }
}

/// The units of a model, by their names in SI.
#[derive(Debug, Default)]
pub(super) struct Units {
    units: BTreeMap<String, (Option<Element>, BTreeMap<String, f64>)>,
}

impl Units {
    /// Name of the SI unit of a quantity, and of its display unit, if different.
    pub(super) fn of(&mut self, quantity: &Quantity) -> Option<(String, Option<String>)> {
        let unit = parse(&quantity.unit).ok()?;
        let si = Si {
            dimension: unit.dimension,
            angle: unit.has_angle(),
        };
        let name = self.add(si);
        let shown = quantity.unit.to_string();
        if shown == name {
            return Some((name, None));
        }
        let (_, displays) = self.units.get_mut(&name)?;
        displays.insert(shown.clone(), 1.0 / quantity.scale);
        Some((name, Some(shown)))
    }

    /// Name of the unit of a quantity's rate in SI.
    pub(super) fn of_rate(&mut self, quantity: &Quantity) -> Option<String> {
        let unit = parse(&quantity.unit).ok()?;
        Some(self.add(Si {
            dimension: unit.dimension.rate().ok()?,
            angle: unit.has_angle(),
        }))
    }

    /// Name of the unit of time.
    pub(super) fn of_time(&mut self) -> String {
        self.add(Si {
            dimension: Dimension::TIME,
            angle: false,
        })
    }

    fn add(&mut self, si: Si) -> String {
        let name = si.name();
        let new = || (si.base(), BTreeMap::new());
        self.units.entry(name.clone()).or_insert_with(new);
        name
    }

    /// The definitions.
    pub(super) fn element(&self) -> Element {
        let units = self.units.iter().map(|(name, (base, displays))| {
            let displays = displays.iter().map(|(name, factor)| {
                Element::new("DisplayUnit")
                    .with("name", name)
                    .with("factor", format!("{factor:?}"))
            });
            Element::new("Unit")
                .with("name", name)
                .holding(base.clone())
                .holding(displays)
        });
        Element::new("UnitDefinitions").holding(units)
    }
}
