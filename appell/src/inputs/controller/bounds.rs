//! Bounds on the inputs along a segment of a motion.

use appell_runtime::inputs::InputSource;
use appell_runtime::model::Along;
use appell_runtime::real::{Enclosure, Real};

use super::Controller;
use crate::inputs::law::Slot;

impl Controller<'_> {
    /// Bounds on the inputs; none for laws that are sampled, scheduled or by inverse dynamics.
    pub(super) fn bounds_along(&self, along: &Along<'_>, u: &mut [Enclosure]) {
        let wiring = self.wiring;
        let is_law = !wiring.sampled.is_empty() || !wiring.scheduled.is_empty();
        if is_law || !wiring.by_model.is_empty() {
            u.fill(Enclosure::UNKNOWN);
            return;
        }
        match &wiring.recorded {
            Some(recorded) => recorded.bounds(along, u),
            None => u.fill(Enclosure::constant(0.0)),
        }
        let mut own = u.to_vec();
        for (inputs, source) in &wiring.driven {
            source.bounds(along, &mut own);
            for &input in inputs {
                u[input] += own[input];
            }
        }
        // Values beyond those of the function are zero.
        let mut values = vec![Enclosure::constant(0.0); wiring.slots.len()];
        let p = &self.parameters;
        wiring.function.bounds(&Along { p, ..*along }, &mut values);
        for (slot, &value) in wiring.slots.iter().zip(&values) {
            match slot {
                Slot::Input(input) => u[*input] += value,
                Slot::Desired(term) => {
                    let gain = Enclosure::constant(-term.gain);
                    u[term.input] += gain * (along.x[term.state] - value);
                }
                _ => {}
            }
        }
    }
}
