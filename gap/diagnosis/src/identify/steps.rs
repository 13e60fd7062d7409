//! Whether a filter may step from row to row.
//!
//! Steps are shortened at non-smooth points of the equations, such as sticking of dry friction, only where that changes
//! the likelihood: elsewhere it costs time, and makes the likelihood of fast smooth motions rough.

use appell_estimate::{EstimateError, Estimation, Recording, Setup};

/// Difference of the log-likelihood that distinguishes two sets of parameters.
const DIFFERENT: f64 = 5.0;

/// Whether steps from row to row are too long for these values.
pub(super) fn are_too_long(
    setup: &Setup<'_>,
    recordings: &[Recording],
    values: &[f64],
) -> Result<bool, EstimateError> {
    if setup.has_corners {
        return Ok(false);
    }
    let cut = Setup {
        has_corners: true,
        ..setup.clone()
    };
    let long = Estimation::new(setup, recordings)?.log_likelihood(values);
    let short = Estimation::new(&cut, recordings)?.log_likelihood(values);
    Ok(match (long, short) {
        (Ok(long), Ok(short)) => (long - short).abs() > DIFFERENT,
        (Err(_), short) => short.is_ok(),
        (Ok(_), Err(_)) => false,
    })
}
