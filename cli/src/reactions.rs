//! Units of the constraint forces.

use appell_runtime::model::Quantity;
use appell_spec::Mechanism;
use appell_spec::units::{Dimension, Unit};

/// Names the unit of every column `reaction_…` and `normal_force_…`: a force for a point; for a
/// constraint without a point its multiplier, which is a power divided by the rate of what the
/// constraint holds at a value.
pub(crate) fn name_units(mechanism: &Mechanism, columns: &mut [Quantity]) {
    let components = columns.iter_mut().filter_map(|column| {
        let place = column.name.strip_prefix("normal_force_").or_else(|| {
            let name = column.name.strip_prefix("reaction_")?;
            let mut axes = ["_x", "_y", "_z"].iter();
            axes.find_map(|axis| name.strip_suffix(axis))
        })?;
        Some((place.to_owned(), column))
    });
    for (place, column) in components {
        let unit = if mechanism.points.iter().any(|point| point.name == place) {
            "N".to_owned()
        } else {
            multiplier(mechanism, &place).unwrap_or_default()
        };
        column.unit = unit.into();
    }
}

fn multiplier(mechanism: &Mechanism, place: &str) -> Option<String> {
    let name = place.strip_prefix("constraint_");
    let mut constraints = mechanism.constraints.iter();
    let constraint = constraints.find(|c| c.name == place || Some(c.name.as_str()) == name)?;
    let unit = Dimension::POWER.over(constraint.kind.dimension()?).ok()?;
    Some(Unit::si(unit).text)
}
