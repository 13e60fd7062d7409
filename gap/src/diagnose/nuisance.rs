//! What is free in a fit beside its members, and what is known of it beforehand.

use appell_estimate::{Coordinate, Direction, Fit, Free, Unknown};

/// What is free under a hypothesis and moves the mean.
pub(super) fn moving(fit: &Fit) -> Vec<Direction> {
    let free = fit.free.iter();
    free.map(|free| Direction::Value(free.unknown))
        .filter(|direction| moves_the_mean(*direction))
        .collect()
}

/// How far a coordinate is off what is expected, and the slope of that by its value: slopes are by values, what is
/// known beforehand is of coordinates.
pub(super) fn known(free: &Free, coordinate: f64) -> Option<[f64; 2]> {
    let [expected, deviation] = free.prior?;
    let stretch = match free.coordinate {
        Coordinate::Plain => 1.0,
        Coordinate::Logarithm => free.to_value(coordinate),
    };
    let off = coordinate - free.to_coordinate(expected);
    Some([off / deviation, (deviation * stretch).recip()])
}

pub(super) fn moves_the_mean(direction: Direction) -> bool {
    !matches!(
        direction,
        Direction::Value(Unknown::Disturbance(_) | Unknown::Noise(_) | Unknown::Spread { .. })
    )
}
