//! Nuisance parameters of a fit, and their priors.

use appell_estimate::{Direction, Fit, Free};

/// The free values of a hypothesis that affect the predicted mean.
pub(super) fn moving(fit: &Fit) -> Vec<Direction> {
    let free = fit.free.iter();
    free.map(|free| Direction::Value(free.unknown))
        .filter(|direction| moves_the_mean(*direction))
        .collect()
}

/// Their priors.
pub(super) fn priors(fit: &Fit) -> Vec<Option<[f64; 2]>> {
    let free = fit.free.iter().zip(&fit.coordinates);
    free.filter(|(own, _)| moves_the_mean(Direction::Value(own.unknown)))
        .map(|(own, coordinate)| known(own, *coordinate))
        .collect()
}

/// The deviation of a coordinate from its prior mean, in prior standard deviations, and its derivative by the value:
/// sensitivities are by values, priors of coordinates.
pub(super) fn known(free: &Free, coordinate: f64) -> Option<[f64; 2]> {
    let [expected, deviation] = free.prior?;
    let stretch = free.stretch(free.to_value(coordinate));
    let off = coordinate - free.to_coordinate(expected);
    Some([off / deviation, (deviation * stretch).recip()])
}

pub(super) fn moves_the_mean(direction: Direction) -> bool {
    !matches!(direction, Direction::Value(unknown) if unknown.is_level())
}
