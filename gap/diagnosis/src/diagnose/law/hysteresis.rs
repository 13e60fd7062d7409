//! A force with hysteresis, reported over the travel since the last reversal.

use super::super::bench::Bench;
use super::super::evidence::Fitted;
use super::super::localise::force_unit;
use super::super::report::Law;
use super::super::unknown::Unnamed;
use super::deviation::Deviation;

/// Number of points at which the force is reported.
const PLACES: usize = 81;
/// Range of the travel since the reversal, in presliding displacements.
const REACH: f64 = 5.0;

/// The law with its band: the force against a motion that reversed after a long travel in the other direction.
pub(super) fn law(
    main: &Bench<'_>,
    law: &Unnamed,
    coordinate: &str,
    fitted: &Fitted,
    places: &[usize],
) -> Law {
    let value = |number: usize| fitted.fit.values[places[number]];
    let (force, way) = (value(0), value(1));
    let deviation = Deviation::of(fitted, places);
    let states = &main.effects.info().states;
    let state = states.iter().find(|state| state.name == coordinate);
    let (unit, scale) = state.map_or(("", 1.0), |state| (state.unit.as_ref(), state.scale));
    let point = |place: usize| {
        let x = REACH * way * place as f64 / (PLACES - 1) as f64;
        let left = (-x / way).exp();
        let slopes = [2.0 * left - 1.0, 2.0 * force * left * x / (way * way)];
        [
            x / scale,
            force * (2.0 * left - 1.0),
            deviation.along(&slopes),
        ]
    };
    Law {
        equation: states[law.place].name.to_string(),
        unit: force_unit(&main.effects.mechanism, law.place),
        depends_on: law.variable.clone(),
        variable: format!("{coordinate} since it turned"),
        variable_unit: unit.to_owned(),
        factor: None,
        curve: (0..PLACES).map(point).collect(),
        log_bayes_factor: law.log_bayes_factor,
        forms: Vec::new(),
    }
}
