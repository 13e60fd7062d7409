//! Forces that depend on the past motion: laws outside the library, each with an unmeasured state.

use appell_spec::Mechanism;

use super::candidate::Candidate;
use super::hidden_mass::HiddenMass;
use super::hysteresis::Hysteresis;
use super::site::Scales;

/// A force with a hidden state.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Memory {
    HiddenMass(HiddenMass),
    Hysteresis(Hysteresis),
}

impl Candidate {
    /// A force with a hidden state; `None` where its first estimate is not positive and finite, or where the rate of its
    /// coordinate appears in no pseudo-velocity.
    pub(crate) fn remembering(
        mechanism: &Mechanism,
        scales: &Scales,
        memory: &Memory,
    ) -> Option<Self> {
        let size = match memory {
            Memory::HiddenMass(hidden) => hidden.mass[0],
            Memory::Hysteresis(hysteresis) => hysteresis.force[0],
        };
        if size <= 0.0 || !size.is_finite() {
            return None;
        }
        match memory {
            Memory::HiddenMass(hidden) => hidden.candidate(mechanism, scales),
            Memory::Hysteresis(hysteresis) => hysteresis.candidate(mechanism, scales),
        }
    }
}
