//! Forces that depend on what was before: laws that are no effect of the library, each with a state of its own
//! that nobody measures.

use appell_spec::Mechanism;

use super::candidate::Candidate;
use super::hidden_mass::HiddenMass;
use super::hysteresis::Hysteresis;
use super::site::Scales;

/// One of them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Memory {
    HiddenMass(HiddenMass),
    Hysteresis(Hysteresis),
}

impl Candidate {
    /// A force that remembers; nothing where its first estimate makes no sense, or its coordinate moves
    /// nothing by itself.
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
