//! Essential and ignorable states, from the equations.

use crate::mechanics::Derivation;
use crate::mechanics::symbols::ids;

/// Essential and ignorable states. Coordinates on which no essential rate depends, such as position and heading
/// of a wheel, are ignorable.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Structure {
    /// Essential states, by their index in the model.
    pub essential: Vec<usize>,
    /// The others.
    pub ignorable: Vec<usize>,
}

impl Structure {
    /// Determined from the equations of motion by the identity test.
    pub fn of(derivation: &mut Derivation) -> Self {
        let speeds = derivation.symbols.speeds.len();
        let coordinates = ids(&derivation.algebra.graph, &derivation.symbols.coordinates);
        let mut essential: Vec<usize> = (0..speeds).collect();
        let mut ignorable: Vec<usize> = (speeds..speeds + coordinates.len()).collect();
        let mut asked = 0;
        while let Some(&row) = essential.get(asked) {
            asked += 1;
            let rate = match row.checked_sub(speeds) {
                None => derivation.motion.accelerations[row],
                Some(coordinate) => derivation.coordinate_rates[coordinate],
            };
            let algebra = &mut derivation.algebra;
            ignorable.retain(|&state| {
                let symbol = coordinates[state - speeds];
                let matters = !algebra.test.independent_of(&algebra.graph, rate, symbol);
                if matters {
                    essential.push(state);
                }
                !matters
            });
        }
        essential.sort_unstable();
        Self {
            essential,
            ignorable,
        }
    }

    /// All states, essential ones first.
    pub fn order(&self) -> Vec<usize> {
        [self.essential.as_slice(), &self.ignorable].concat()
    }
}
