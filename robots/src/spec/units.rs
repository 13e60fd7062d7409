//! Units of quantities of a joint.

use crate::model::Motion;

/// Units of quantities of a kind of joint.
pub(super) struct Units {
    pub(super) coordinate: &'static str,
    pub(super) rate: &'static str,
    pub(super) force: &'static str,
    /// Of the factors of a rate, its square and its cube, and of a coordinate likewise.
    pub(super) damping: [&'static str; 3],
    pub(super) stiffness: [&'static str; 3],
    pub(super) inertia: &'static str,
}

impl Units {
    pub(super) fn of(motion: Motion) -> Self {
        match motion {
            Motion::Turning => Self {
                coordinate: "rad",
                rate: "rad/s",
                force: "N*m",
                damping: ["N*m*s", "N*m*s^2", "N*m*s^3"],
                stiffness: ["N*m"; 3],
                inertia: "kg*m^2",
            },
            // A joint with several coordinates has no common unit.
            Motion::Sliding | Motion::Ball | Motion::Free => Self {
                coordinate: "m",
                rate: "m/s",
                force: "N",
                damping: ["N*s/m", "N*s^2/m^2", "N*s^3/m^3"],
                stiffness: ["N/m", "N/m^2", "N/m^3"],
                inertia: "kg",
            },
        }
    }
}
