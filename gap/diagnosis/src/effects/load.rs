//! A load that depends on the motion like a feedback controller, as stated by the spec.

use appell_spec::Mechanism;
use appell_spec::expr::{Expr, ExprKind, Quantity};
use appell_spec::mechanism::{Load, LoadKind};
use appell_spec::units::Dimension;
use num_traits::Zero;
use toml_edit::{Array, DocumentMut, InlineTable, Item, Table, Value};

/// The expression of a load that depends on an input and the motion, or on a coordinate and a rate, with its index
/// among the components.
pub(crate) fn controlled(load: &Load) -> Option<(usize, &Expr)> {
    let (place, law) = match &load.kind {
        LoadKind::Generalized { force, .. } => (0, force),
        LoadKind::Force { vector, .. } | LoadKind::Torque { vector, .. } => {
            let mut acting = vector.iter().enumerate().filter(|(_, part)| !is_zero(part));
            let only = acting.next()?;
            acting.next().is_none().then_some(only)?
        }
        _ => return None,
    };
    let [mut input, mut place_in, mut rate] = [false; 3];
    law.visit(&mut |quantity| match quantity {
        Quantity::Input(_) => input = true,
        Quantity::Coordinate(_) => place_in = true,
        Quantity::Rate(_) | Quantity::PseudoVelocity(_) => rate = true,
        _ => {}
    });
    let follows = input && (place_in || rate) || place_in && rate;
    follows.then_some((place, law))
}

pub(super) fn is_zero(part: &Expr) -> bool {
    matches!(&part.kind, ExprKind::Number(n) if n.is_zero())
}

/// The statement of such a load in the spec.
#[derive(Debug, Clone)]
pub(super) struct Stated {
    key: &'static str,
    /// One expression, or three components.
    parts: Vec<Value>,
    place: usize,
    /// Its unit in SI.
    pub(super) unit: &'static str,
}

impl Stated {
    /// `None` for loads of other kinds.
    pub(super) fn of(mechanism: &Mechanism, load: &Load, text: &str) -> Option<Self> {
        let (place, _) = controlled(load)?;
        let (key, unit) = match &load.kind {
            LoadKind::Generalized { velocity, .. } => ("force", along(mechanism, velocity)?),
            LoadKind::Force { .. } => ("vector", "N"),
            LoadKind::Torque { .. } => ("vector", "N*m"),
            _ => return None,
        };
        let document: DocumentMut = text.parse().ok()?;
        let value = document
            .get("loads")?
            .get(&load.name)?
            .get(key)?
            .as_value()?;
        let parts = match value {
            Value::Array(parts) => parts.iter().cloned().collect(),
            one => vec![one.clone()],
        };
        parts.get(place).and_then(Value::as_str)?;
        Some(Self {
            key,
            parts,
            place,
            unit,
        })
    }

    /// Name of the definition that holds its expression, given the name of an effect.
    pub(super) fn name(effect: &str) -> String {
        format!("{effect}_stated")
    }

    /// Its expression.
    fn expression(&self) -> &str {
        self.parts[self.place].as_str().unwrap_or("0")
    }

    /// Its expression under its name, as an item of a spec.
    pub(super) fn definition(&self, effect: &str) -> String {
        let item = InlineTable::from_iter([("value", Value::from(self.expression()))]);
        section("definitions", &Self::name(effect), item)
    }

    /// The load with terms added to its expression, as an item of a spec.
    pub(super) fn with(&self, name: &str, added: &[&str]) -> String {
        let sum = [&[self.expression()], added].concat().join(" + ");
        let mut parts = self.parts.clone();
        parts[self.place] = Value::from(sum);
        let value = match (self.key, parts.as_slice()) {
            ("force", [only]) => only.clone(),
            _ => Value::Array(Array::from_iter(parts)),
        };
        section("loads", name, InlineTable::from_iter([(self.key, value)]))
    }
}

/// A spec of one item.
fn section(name: &str, item: &str, keys: InlineTable) -> String {
    let items = Table::from_iter([(item, Item::Value(keys.into()))]);
    let mut document = DocumentMut::new();
    document.insert(name, Item::Table(items));
    document.to_string()
}

/// The unit of a force along a rate or a pseudo-velocity.
fn along(mechanism: &Mechanism, velocity: &Expr) -> Option<&'static str> {
    let rate = match velocity.kind {
        ExprKind::Quantity(Quantity::Rate(q)) => {
            let way = mechanism.coordinates[q].label.unit.dimension;
            way.rate().ok()?
        }
        ExprKind::Quantity(Quantity::PseudoVelocity(speed)) => {
            mechanism.pseudo_velocities[speed].label.unit.dimension
        }
        _ => return None,
    };
    let units = [(Dimension::LENGTH, "N"), (Dimension::NONE, "N*m")];
    let mut units = units.into_iter();
    let unit = units.find(|(way, _)| way.rate().is_ok_and(|own| own == rate));
    unit.map(|(_, unit)| unit)
}
