//! A steady motion as values of states, rates and inputs.
//!
//! The rates of essential coordinates vanish, which determines the pseudo-velocities that move them. The other
//! pseudo-velocities are expressed in the rates of ignorable coordinates, by their definitions, if these rates
//! are constant. Unspecified quantities remain symbols.

use appell_spec::mechanism::Mechanism;

use super::structure::Structure;
use crate::mechanics::Derivation;
use crate::symbolic::{Expr, Graph, Substitution, SymbolId};

/// Why conditions do not define a motion.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SteadyError {
    /// A value depends on itself.
    #[error("`{0}` is defined in terms of itself")]
    Circular(String),
    /// Two conditions for one quantity.
    #[error("`{0}` is given twice")]
    Twice(String),
    /// A rate that contradicts the pseudo-velocities.
    #[error(
        "`{0}` contradicts the rate that follows from the pseudo-velocities; give pseudo-velocities instead"
    )]
    Contradiction(String),
    /// Division by zero.
    #[error("the equations divide by zero along this motion")]
    Undefined,
}

/// A steady motion.
#[derive(Debug, Clone)]
pub struct SteadyMotion {
    /// Essential and ignorable states.
    pub structure: Structure,
    /// Symbols with their values in the motion. No value mentions a symbol that has one.
    pub values: Vec<(Expr, Expr)>,
}

impl SteadyMotion {
    /// The steady motion of a mechanism under further conditions: values of states, of inputs, and of
    /// rates q̇, each by its symbol.
    pub fn new(
        mechanism: &Mechanism,
        derivation: &mut Derivation,
        conditions: &[(Expr, Expr)],
    ) -> Result<Self, SteadyError> {
        let structure = Structure::of(derivation);
        let rates = &derivation.symbols.rates;
        let given_rates = conditions.iter().map(|&(symbol, _)| symbol);
        let mut builder = Builder {
            mechanism,
            given_rates: given_rates.filter(|s| rates.contains(s)).collect(),
            derivation,
            motion: Self {
                structure,
                values: Vec::new(),
            },
        };
        for &(symbol, value) in conditions {
            builder.set(symbol, value)?;
        }
        builder.rest()?;
        builder.rates_that_follow()?;
        builder.speeds_in_rates()?;
        builder.check_given_rates()?;
        Ok(builder.motion)
    }

    /// The substitution of the steady motion.
    pub fn substitution(&self, graph: &Graph) -> Substitution {
        Substitution::of_parts(graph, &self.values)
    }

    fn gives(&self, symbol: Expr) -> bool {
        self.values.iter().any(|&(known, _)| known == symbol)
    }
}

struct Builder<'a> {
    mechanism: &'a Mechanism,
    derivation: &'a mut Derivation,
    given_rates: Vec<Expr>,
    motion: SteadyMotion,
}

impl Builder<'_> {
    /// Assigns a value to a symbol, and substitutes it in the known values.
    fn set(&mut self, symbol: Expr, value: Expr) -> Result<(), SteadyError> {
        let graph = &self.derivation.algebra.graph;
        let Some(id) = graph.as_symbol(symbol) else {
            return Ok(());
        };
        let name = graph.symbol_name(id).to_owned();
        if self.motion.gives(symbol) {
            return Err(SteadyError::Twice(name));
        }
        let value = self.value(value)?;
        let graph = &mut self.derivation.algebra.graph;
        if graph.mentions(value, &[id]) {
            return Err(SteadyError::Circular(name));
        }
        let mut here = Substitution::new(graph, &[(id, value)]);
        for (_, known) in &mut self.motion.values {
            *known = here.apply(graph, *known).ok_or(SteadyError::Undefined)?;
        }
        self.motion.values.push((symbol, value));
        Ok(())
    }

    /// The value of an expression in the motion, as far as known.
    fn value(&mut self, expr: Expr) -> Result<Expr, SteadyError> {
        let graph = &mut self.derivation.algebra.graph;
        let mut motion = self.motion.substitution(graph);
        motion.apply(graph, expr).ok_or(SteadyError::Undefined)
    }

    /// Pseudo-velocities without a value.
    fn open_speeds(&self) -> Vec<Expr> {
        let speeds = self.derivation.symbols.speeds.iter().copied();
        speeds.filter(|&w| !self.motion.gives(w)).collect()
    }

    /// The subset of symbols on which an expression depends.
    fn depends(&mut self, expr: Expr, symbols: &[Expr]) -> Vec<Expr> {
        let algebra = &mut self.derivation.algebra;
        let ids: Vec<(Expr, SymbolId)> = symbols
            .iter()
            .filter_map(|&s| Some((s, algebra.graph.as_symbol(s)?)))
            .collect();
        ids.into_iter()
            .filter(|&(_, id)| !algebra.test.independent_of(&algebra.graph, expr, id))
            .map(|(symbol, _)| symbol)
            .collect()
    }

    /// Sets rates of essential coordinates to zero, unless given. Each pass finds pseudo-velocities that alone
    /// remain in such a rate.
    fn rest(&mut self) -> Result<(), SteadyError> {
        let speeds = self.derivation.symbols.speeds.len();
        let essential = self.motion.structure.essential.clone();
        let coordinates: Vec<usize> = essential
            .iter()
            .filter_map(|k| k.checked_sub(speeds))
            .collect();
        for _ in 0..coordinates.len() {
            for &coordinate in &coordinates {
                let rate = self.value(self.derivation.coordinate_rates[coordinate])?;
                let symbol = self.derivation.symbols.rates[coordinate];
                let wanted = if self.motion.gives(symbol) {
                    self.value(symbol)?
                } else {
                    Graph::ZERO
                };
                let open = self.open_speeds();
                let [speed] = self.depends(rate, &open)[..] else {
                    continue;
                };
                let excess = self.derivation.algebra.graph.sub(rate, wanted);
                let algebra = &mut self.derivation.algebra;
                let slope = algebra.derivative(excess, speed);
                let zero = Substitution::by_zero(&algebra.graph, &[speed])
                    .apply(&mut algebra.graph, excess)
                    .ok_or(SteadyError::Undefined)?;
                let value = if algebra.test.is_zero(&algebra.graph, zero) {
                    Graph::ZERO
                } else {
                    let minus = algebra.graph.neg(zero);
                    algebra.graph.div(minus, slope)
                };
                self.set(speed, value)?;
            }
        }
        Ok(())
    }

    /// Rates determined by the known pseudo-velocities.
    fn rates_that_follow(&mut self) -> Result<(), SteadyError> {
        let rates = self.derivation.symbols.rates.clone();
        for (k, symbol) in rates.into_iter().enumerate() {
            let rate = self.value(self.derivation.coordinate_rates[k])?;
            let open = self.open_speeds();
            if self.motion.gives(symbol) || !self.depends(rate, &open).is_empty() {
                continue;
            }
            let algebra = &mut self.derivation.algebra;
            let rate = algebra.shortest(rate);
            self.set(symbol, rate)?;
        }
        Ok(())
    }

    /// Expresses the other pseudo-velocities by their definitions, if these contain as many constant rates.
    fn speeds_in_rates(&mut self) -> Result<(), SteadyError> {
        let symbols = self.derivation.symbols.clone();
        let constant = self.constant_rates()?;
        let (mut written, mut used) = (Vec::new(), Vec::new());
        for (&speed, spec) in symbols.speeds.iter().zip(&self.mechanism.pseudo_velocities) {
            let graph = &mut self.derivation.algebra.graph;
            let Ok(definition) = symbols.lower(graph, &spec.definition) else {
                continue;
            };
            if self.motion.gives(speed) {
                continue;
            }
            let follow = self.with_given_rates_as_letters(definition)?;
            let rates = self.depends(follow, &symbols.rates);
            if rates.iter().all(|rate| constant.contains(rate)) {
                used.extend(rates);
                written.push((speed, definition));
            }
        }
        used.sort_unstable();
        used.dedup();
        if used.len() != written.len() {
            return Ok(());
        }
        for (speed, definition) in written {
            self.set(speed, definition)?;
        }
        Ok(())
    }

    /// Constant rates of ignorable coordinates that are not determined by known values.
    fn constant_rates(&mut self) -> Result<Vec<Expr>, SteadyError> {
        let symbols = self.derivation.symbols.clone();
        let speeds = symbols.speeds.len();
        let structure = self.motion.structure.clone();
        let coordinates: Vec<usize> = structure.ignorable.iter().map(|k| k - speeds).collect();
        let ignorable: Vec<Expr> = coordinates
            .iter()
            .map(|&k| symbols.coordinates[k])
            .collect();
        let mut constant = Vec::new();
        for k in coordinates {
            let symbol = symbols.rates[k];
            let follows = self.motion.gives(symbol) && !self.given_rates.contains(&symbol);
            let rate = self.value(self.derivation.coordinate_rates[k])?;
            if !follows && self.depends(rate, &ignorable).is_empty() {
                constant.push(symbol);
            }
        }
        Ok(constant)
    }

    fn with_given_rates_as_letters(&mut self, expr: Expr) -> Result<Expr, SteadyError> {
        let values = self.motion.values.iter().copied();
        let values: Vec<(Expr, Expr)> = values
            .filter(|(symbol, _)| !self.given_rates.contains(symbol))
            .collect();
        let graph = &mut self.derivation.algebra.graph;
        let mut known = Substitution::of_parts(graph, &values);
        known.apply(graph, expr).ok_or(SteadyError::Undefined)
    }

    /// Checks that given rates agree with the pseudo-velocities.
    fn check_given_rates(&mut self) -> Result<(), SteadyError> {
        let rates = self.derivation.symbols.rates.clone();
        for (k, symbol) in rates.into_iter().enumerate() {
            if !self.given_rates.contains(&symbol) {
                continue;
            }
            let rate = self.value(self.derivation.coordinate_rates[k])?;
            let given = self.value(symbol)?;
            let algebra = &mut self.derivation.algebra;
            if !algebra.test.are_equal(&algebra.graph, rate, given) {
                let name = algebra.graph.as_symbol(symbol);
                let name = name.map_or("", |id| algebra.graph.symbol_name(id));
                return Err(SteadyError::Contradiction(name.to_owned()));
            }
        }
        Ok(())
    }
}
