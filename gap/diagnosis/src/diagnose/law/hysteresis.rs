//! A force with hysteresis, reported over the travel since the last reversal.

use super::super::bench::Bench;
use super::{Course, Point};

/// Number of points at which the force is reported.
const PLACES: usize = 81;
/// Range of the travel since the reversal, in presliding displacements.
const REACH: f64 = 5.0;

/// The force against a motion that reversed after a long travel in the other direction; its largest size and the presliding
/// displacement are `values`.
pub(super) fn course(main: &Bench<'_>, unit: String, coordinate: &str, values: &[f64]) -> Course {
    let (force, way) = (values[0], values[1]);
    let mut states = main.effects.info().states.iter();
    let state = states.find(|state| state.name == coordinate);
    let (variable_unit, scale) =
        state.map_or(("", 1.0), |state| (state.unit.as_ref(), state.scale));
    let point = |place: usize| {
        let x = REACH * way * place as f64 / (PLACES - 1) as f64;
        let left = (-x / way).exp();
        Point {
            variable: x / scale,
            force: force * (2.0 * left - 1.0),
            slopes: vec![2.0 * left - 1.0, 2.0 * force * left * x / (way * way)],
        }
    };
    Course {
        unit,
        variable: format!("{coordinate} since it turned"),
        variable_unit: variable_unit.to_owned(),
        factor: None,
        points: (0..PLACES).map(point).collect(),
    }
}
