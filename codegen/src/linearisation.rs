//! A and B as formulas about a steady motion, and the characteristic polynomial.
//!
//! [`Linearisation::about`] substitutes the steady motion ([`SteadyMotion`]) in the exact Jacobians and writes
//! every entry as one fraction. Essential states are determined from the equations ([`Structure`]).

mod characteristic;
mod steady;
mod structure;

pub use characteristic::Characteristic;
pub use steady::{SteadyError, SteadyMotion};
pub use structure::Structure;

use crate::mechanics::Derivation;
use crate::mechanics::linear::ImplicitMotion;
use crate::symbolic::dissolve::Dissolved;
use crate::symbolic::{Expr, Graph, Substitution};

/// Numerators with more terms are left in derived form.
const MOST_TERMS: usize = 200;
/// Entries with more operations are left in derived form.
const MOST_OPERATIONS: usize = 1000;

/// `ẋ = A x + B u` for small perturbations of a steady motion.
#[derive(Debug, Clone)]
pub struct Linearisation {
    /// The motion.
    pub steady: SteadyMotion,
    /// Symbols of the states, essential ones first.
    pub states: Vec<Expr>,
    /// The number of essential states.
    pub essential: usize,
    /// Symbols of the inputs.
    pub inputs: Vec<Expr>,
    /// Rates of the essential states; the motion is steady where they vanish.
    pub rates: Vec<Expr>,
    /// A, row by row.
    pub a: Vec<Vec<Expr>>,
    /// B, row by row.
    pub b: Vec<Vec<Expr>>,
}

impl Linearisation {
    /// The linear equations about a motion.
    pub fn about(derivation: &mut Derivation, steady: SteadyMotion) -> Result<Self, SteadyError> {
        let structure = steady.structure.clone();
        let d = &mut *derivation;
        let all = [d.symbols.speeds.clone(), d.symbols.coordinates.clone()].concat();
        let rates = [d.motion.accelerations.clone(), d.coordinate_rates.clone()].concat();
        let order = structure.order();
        let states: Vec<Expr> = order.iter().map(|&k| all[k]).collect();
        let inputs = d.symbols.inputs.clone();
        let implicit = ImplicitMotion {
            gibbs: &d.gibbs,
            forces: &d.forces,
            motion: &d.motion,
            coordinate_rates: &d.coordinate_rates,
        };
        let residual = implicit.residual(&mut d.algebra, &d.symbols);
        let variables = [states.as_slice(), &inputs].concat();
        let columns = implicit
            .jacobian(&mut d.algebra, &d.symbols, &residual, &variables)
            .map_err(|_| SteadyError::Undefined)?;

        let mut entries = Entries {
            motion: steady.substitution(&derivation.algebra.graph),
            derivation,
            names: Dissolved::default(),
        };
        let essential = structure.essential.len();
        let mut matrix = Vec::with_capacity(order.len());
        for &row in &order {
            let row: Result<Vec<Expr>, SteadyError> = columns
                .iter()
                .map(|column| entries.of(column[row]))
                .collect();
            matrix.push(row?);
        }
        let rates: Result<Vec<Expr>, SteadyError> = order[..essential]
            .iter()
            .map(|&k| entries.of(rates[k]))
            .collect();
        let (a, b) = matrix
            .into_iter()
            .map(|mut row| {
                let inputs = row.split_off(states.len());
                (row, inputs)
            })
            .unzip();
        Ok(Self {
            rates: rates?,
            steady,
            states,
            essential,
            inputs,
            a,
            b,
        })
    }

    /// The characteristic polynomial of the essential states. `None` if it has too many terms, or if position
    /// constraints make states dependent, which A treats as independent.
    pub fn characteristic(&self, derivation: &mut Derivation) -> Option<Characteristic> {
        if !derivation.positions.dependent.is_empty() {
            return None;
        }
        let block: Vec<&[Expr]> = self.a[..self.essential]
            .iter()
            .map(|row| &row[..self.essential])
            .collect();
        Characteristic::of(derivation, &block)
    }
}

/// Functions of the state, evaluated in the steady motion.
struct Entries<'a> {
    derivation: &'a mut Derivation,
    motion: Substitution,
    names: Dissolved,
}

impl Entries<'_> {
    fn of(&mut self, value: Expr) -> Result<Expr, SteadyError> {
        let graph = &mut self.derivation.algebra.graph;
        let value = self
            .motion
            .apply(graph, value)
            .ok_or(SteadyError::Undefined)?;
        Ok(simplest(self.derivation, &mut self.names, value))
    }
}

/// One fraction, with names replaced by their definitions; a value that becomes too long is left unchanged.
fn simplest(derivation: &mut Derivation, names: &mut Dissolved, value: Expr) -> Expr {
    let algebra = &mut derivation.algebra;
    if algebra.test.is_zero(&algebra.graph, value) {
        return Graph::ZERO;
    }
    if algebra.graph.operations(&[value]) > MOST_OPERATIONS {
        return value;
    }
    let explicit = names.of(&mut algebra.graph, value, |_| false);
    let fraction = explicit.and_then(|explicit| {
        algebra
            .graph
            .one_fraction(&mut algebra.test, explicit, MOST_TERMS)
    });
    fraction.unwrap_or(value)
}
