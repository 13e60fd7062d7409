//! Essential states and hidden ones, from the equations.

use crate::mechanics::Derivation;
use crate::mechanics::symbols::ids;

/// Which states matter to the motion. Where a wheel stands and which way it looks changes nothing
/// about how it moves on: such coordinates are hidden. Essential are the pseudo-velocities and every
/// coordinate that a rate of an essential state depends on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Structure {
    /// Essential states, by their index in the model.
    pub essential: Vec<usize>,
    /// The others.
    pub hidden: Vec<usize>,
}

impl Structure {
    /// From the equations of motion, by the identity test.
    pub fn of(derivation: &mut Derivation) -> Self {
        let speeds = derivation.symbols.speeds.len();
        let coordinates = ids(&derivation.algebra.graph, &derivation.symbols.coordinates);
        let mut essential: Vec<usize> = (0..speeds).collect();
        let mut hidden: Vec<usize> = (speeds..speeds + coordinates.len()).collect();
        let mut asked = 0;
        while let Some(&row) = essential.get(asked) {
            asked += 1;
            let rate = match row.checked_sub(speeds) {
                None => derivation.motion.accelerations[row],
                Some(coordinate) => derivation.coordinate_rates[coordinate],
            };
            let algebra = &mut derivation.algebra;
            hidden.retain(|&state| {
                let symbol = coordinates[state - speeds];
                let matters = !algebra.test.independent_of(&algebra.graph, rate, symbol);
                if matters {
                    essential.push(state);
                }
                !matters
            });
        }
        essential.sort_unstable();
        Self { essential, hidden }
    }

    /// All states, essential ones first.
    pub fn order(&self) -> Vec<usize> {
        [self.essential.as_slice(), &self.hidden].concat()
    }
}
