//! Branches of steady motions against the continuation parameter.

use appell_analysis::{Branch, Term};
use appell_runtime::model::{Model, ModelInfo};

use super::{Figure, Mark, Panel, Series};

/// A term below this size on all branches is zero, and not drawn.
const ZERO: f64 = 1e-12;

impl Figure {
    /// Steady motions against the quantity along which they were continued, a panel for each term.
    pub fn of_branches(
        model: &dyn Model,
        along: Term,
        terms: &[Term],
        branches: &[Branch],
    ) -> Self {
        let values = |term: Term, branch: &Branch| -> Vec<f64> {
            let points = branch.points.iter();
            points.map(|at| term.value(model, &at.point)).collect()
        };
        let drawn = |term: &&Term| {
            let all = branches.iter().flat_map(|branch| values(**term, branch));
            **term != along && all.into_iter().any(|value| value.abs() > ZERO)
        };
        let panel = |term: &Term| {
            let quantity = term.quantity(model.info());
            let series = branches.iter().enumerate().map(|(i, branch)| Series {
                label: match i {
                    0 => quantity.name.to_string(),
                    _ => format!("branch {}", i + 1),
                },
                x: parameter(model.info(), along, branch),
                y: values(*term, branch)
                    .into_iter()
                    .map(|value| quantity.to_unit(value))
                    .collect(),
            });
            Panel {
                unit: quantity.unit.to_string(),
                series: series.collect(),
            }
        };
        Self {
            panels: terms.iter().filter(drawn).map(panel).collect(),
            ..frame(model.info(), along, branches)
        }
    }
}

/// The continuation parameter along a branch, in its unit.
pub(super) fn parameter(info: &ModelInfo, along: Term, branch: &Branch) -> Vec<f64> {
    let quantity = along.quantity(info);
    let points = branch.points.iter();
    points.map(|at| quantity.to_unit(at.value)).collect()
}

/// Title, horizontal axis, and a mark at every special point.
pub(super) fn frame(info: &ModelInfo, along: Term, branches: &[Branch]) -> Figure {
    let quantity = along.quantity(info);
    let specials = branches.iter().flat_map(|branch| &branch.specials);
    let marks = specials.map(|special| {
        let x = quantity.to_unit(special.motion.value);
        // All digits: the value is exact to rounding.
        let about = format!("{} = {x:.14} {}", quantity.name, quantity.unit);
        Mark { x, about }
    });
    Figure {
        title: info.title.to_string(),
        x_label: format!("{} [{}]", quantity.name, quantity.unit),
        panels: Vec::new(),
        marks: marks.collect(),
        equal_axes: false,
    }
}
