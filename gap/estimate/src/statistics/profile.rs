//! Profile likelihood intervals, without a quadratic approximation: the other values are refitted at
//! each end.

use crate::EstimateError;
use crate::estimation::Estimation;
use crate::fitting::fit::{Effort, Fit};
use crate::fitting::free::Free;

/// Halvings towards an end; each end is found to a hundredth of a standard deviation.
const MOST_HALVINGS: usize = 12;
/// Doublings away from the optimum after which an end counts as infinite.
const MOST_DOUBLINGS: usize = 6;

impl Fit {
    /// Limits in SI at which the profile log-posterior is `drop` below the optimum: 1.92 for 95 %.
    /// Infinite, or the limit of the value, if it does not fall so far within 64 standard
    /// deviations.
    pub fn profile_interval(
        &self,
        estimation: &Estimation<'_>,
        index: usize,
        drop: f64,
    ) -> Result<[f64; 2], EstimateError> {
        let below = self.profile_end(estimation, index, drop, -1.0)?;
        let above = self.profile_end(estimation, index, drop, 1.0)?;
        Ok([below, above])
    }

    fn profile_end(
        &self,
        estimation: &Estimation<'_>,
        index: usize,
        drop: f64,
        sign: f64,
    ) -> Result<f64, EstimateError> {
        let held = self.free[index];
        let place = estimation.layout().place(held.unknown)?;
        let others: Vec<Free> = (self.free.iter().enumerate())
            .filter(|(other, _)| *other != index)
            .map(|(_, free)| *free)
            .collect();
        let deviation = self.covariance()?[(index, index)].sqrt();
        let mut start = self.values.clone();
        let mut falls = |offset: f64| -> Result<f64, EstimateError> {
            let coordinate = self.coordinates[index] + sign * offset;
            start[place] = held.to_value(coordinate);
            let fit = Fit::of(estimation, &start, &others, Effort::default())?;
            start.clone_from(&fit.values);
            Ok(self.log_posterior - fit.log_posterior - log_density(held, coordinate))
        };
        let limit = held.to_coordinate(held.range[usize::from(sign > 0.0)]);
        let room = sign * (limit - self.coordinates[index]);
        let (mut near, mut far) = (0.0, (2.0 * drop).sqrt() * deviation);
        let mut doublings = 0;
        while far < room && falls(far)? < drop {
            (near, far) = (far, 2.0 * far);
            doublings += 1;
            if doublings > MOST_DOUBLINGS {
                return Ok(held.to_value(sign * f64::INFINITY));
            }
        }
        if far >= room {
            far = room;
            if falls(far)? < drop {
                return Ok(held.to_value(limit));
            }
        }
        for _ in 0..MOST_HALVINGS {
            if far - near < 0.01 * deviation {
                break;
            }
            let middle = f64::midpoint(near, far);
            if falls(middle)? < drop {
                near = middle;
            } else {
                far = middle;
            }
        }
        Ok(held.to_value(self.coordinates[index] + sign * f64::midpoint(near, far)))
    }
}

/// Log-prior of the held value, which the fit of the others lacks.
fn log_density(held: Free, coordinate: f64) -> f64 {
    held.prior.map_or(0.0, |[expected, deviation]| {
        let off = (coordinate - held.to_coordinate(expected)) / deviation;
        -0.5 * off * off
    })
}
