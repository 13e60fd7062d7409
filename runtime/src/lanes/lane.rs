//! From lanes to scalars and back.

use crate::Real;

/// A scalar that is one number of a lane.
pub trait Lane: Real {
    /// The scalar of a number.
    #[must_use]
    fn of(value: f64) -> Self;
    /// Its number.
    fn value(self) -> f64;
}
