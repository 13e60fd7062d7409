//! The sensitivities of all candidates and the nuisance directions.

use appell_estimate::{Direction, Estimation, Tangent, Unknown};

use super::super::bench::wrong;
use super::super::gram::{Normal, known, moves_the_mean, whitened};
use super::super::screen::directions;
use super::super::{Bench, Fitted, Result};
use super::{BEYOND, Column, Level, Nuisance};
use crate::effects::Acts;

/// Whether the linearisation does not apply to a fit without this member.
pub(in super::super) fn is_fixed(bench: &Bench<'_>, member: usize) -> bool {
    let candidate = bench.candidate(member);
    candidate.brings.is_some() || matches!(candidate.acts, Acts::Slow(_))
}

/// The columns of all candidates with sensitivities.
pub(super) fn columns(
    bench: &Bench<'_>,
    fitted: &Fitted,
    estimation: &Estimation<'_>,
    values: &[f64],
) -> Result<Vec<Column>> {
    let (setup, layout) = (estimation.setup(), estimation.layout());
    let at = |list: &[usize], input: usize| list.iter().position(|own| *own == input);
    let mut list: Vec<Column> = Vec::new();
    for candidate in 0..bench.effects.candidates.len() {
        let own = bench.candidate(candidate);
        let is_member = fitted.members.contains(&candidate);
        // To first order a lag of a channel is its delay.
        let is_slow = matches!(own.acts, Acts::Slow(_));
        if own.brings.is_some() || is_slow || is_member && is_fixed(bench, candidate) {
            continue;
        }
        let all = directions(bench, candidate).into_iter().enumerate();
        for (place, (direction, is_positive)) in all {
            let inside = match (own.acts, is_member) {
                (Acts::Lag(input), true) => at(&setup.lagging, input).map(Unknown::Lag),
                (Acts::Delay(input), true) => at(&setup.delayed, input).map(Unknown::InputDelay),
                (Acts::Late(channel), true) => Some(Unknown::SensorDelay(channel)),
                _ => None,
            };
            let direction = inside.map_or(direction, Direction::Value);
            let (neutral, known) = match (own.acts, direction) {
                (Acts::Parameter(_), Direction::Value(Unknown::Parameter(index))) => {
                    let nominal = bench.set.parameters[index].value;
                    (nominal, Some(wrong(nominal)))
                }
                (_, Direction::Value(unknown @ Unknown::Scale(_))) => {
                    (1.0, bench.wanted(unknown).map(|_| wrong(1.0)))
                }
                _ => (0.0, None),
            };
            let size = match direction {
                Direction::Value(unknown) if is_member => values[layout.place(unknown)?] - neutral,
                _ => 0.0,
            };
            list.push(Column {
                candidate,
                place,
                direction,
                is_positive,
                most: match own.acts {
                    Acts::Delay(_) | Acts::Late(_) => BEYOND * bench.longest_delay(),
                    _ => f64::INFINITY,
                },
                known,
                size,
            });
        }
    }
    Ok(list)
}

/// The nuisance directions: parameters of the nominal model, of fixed members, and shapes of other members.
pub(super) fn nuisances(bench: &Bench<'_>, fitted: &Fitted, columns: &[Column]) -> Vec<Nuisance> {
    let mut all = Vec::new();
    for (place, free) in fitted.fit.free.iter().enumerate() {
        let direction = Direction::Value(free.unknown);
        if !moves_the_mean(direction) {
            continue;
        }
        let is_own = |column: &Column| {
            column.direction == direction && fitted.members.contains(&column.candidate)
        };
        let of_member = columns.iter().any(is_own);
        if !of_member {
            let coordinate = fitted.fit.coordinates[place];
            all.push(Nuisance {
                direction,
                known: known(free, coordinate),
            });
            continue;
        }
        // A parameter whose error is a member is within its tolerance in sets without that member.
        if let Some(own) = bench.wanted(free.unknown) {
            let expected = own.prior.map_or(0.0, |[value, _]| own.to_coordinate(value));
            all.push(Nuisance {
                direction,
                known: known(own, expected),
            });
        }
    }
    all
}

impl Level {
    pub(super) fn of(
        bench: &Bench<'_>,
        scale: f64,
        tangent: &Tangent,
        nuisances: &[Nuisance],
        columns: &[Column],
    ) -> Self {
        let (free, own) = (nuisances.len(), columns.len());
        let kicks = tangent.slopes.nrows() - free - own;
        // Innovations with all sizes at zero.
        let mut rest = whitened(tangent);
        for (place, column) in columns.iter().enumerate() {
            if column.size != 0.0 {
                rest.axpy(
                    -column.size,
                    &tangent.slopes.row(free + place).transpose(),
                    1.0,
                );
            }
        }
        let priors: Vec<_> = nuisances.iter().map(|nuisance| nuisance.known).collect();
        let mut normal = Normal::of(tangent, &rest, bench.weight, &priors);
        // The impulses of feedback inputs are bounded by the error of the filter.
        for (place, own) in (free + own..).zip(&tangent.added_squares) {
            normal.squares[(place, place)] += own;
        }
        let eliminated: Vec<usize> = (0..free).chain(free + own..free + own + kicks).collect();
        let mut gram = normal.beside(&eliminated, free..free + own);
        for (place, column) in columns.iter().enumerate() {
            if let Some(deviation) = column.known {
                gram.squares[(place, place)] += deviation.powi(-2);
            }
        }
        let told = bench.weight * tangent.samples.len() as f64;
        let free_noise = bench
            .is_over_windows()
            .then_some([told, -0.5 * normal.scales]);
        Self {
            scale,
            gram,
            free_noise,
        }
    }
}
