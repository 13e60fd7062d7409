//! Pseudo-velocities with prescribed rates: a drive supplies the required generalised force.
//!
//! The equation of such a speed p is ω̇ₚ = αₚ. In the other equations Mᵢₚ αₚ is known and added to the bias, so
//! the system stays symmetric: row and column p of M are those of the unit matrix. The required force of the
//! drive is the residual of Appell's equation of p, `M ω̇ + b − Π`.

use appell_spec::Code;

use super::algebra::Algebra;
use super::expressions::Setting;
use super::finding::{Finding, Item, Outcome, unless_any};
use super::gibbs_appell::{GibbsForm, demand};
use crate::symbolic::{Expr, Graph};

/// The prescribed rates, and the equations that they replace.
#[derive(Debug, Clone, Default)]
pub struct Given {
    speeds: Vec<GivenSpeed>,
}

/// A pseudo-velocity with a prescribed rate.
#[derive(Debug, Clone)]
struct GivenSpeed {
    speed: usize,
    /// α.
    rate: Expr,
    /// Row of M, b and Π of the replaced Appell equation.
    mass: Vec<Expr>,
    bias: Expr,
    force: Expr,
}

impl Given {
    /// The prescribed rates of a mechanism.
    pub fn of(algebra: &mut Algebra, setting: Setting<'_>) -> Outcome<Self> {
        let mut speeds = Vec::new();
        for (id, speed) in setting.mechanism.pseudo_velocities.entries() {
            let Some(rate) = &speed.rate else { continue };
            let item = Item::PseudoVelocity(id);
            speeds.push(GivenSpeed {
                speed: id.index(),
                rate: setting.lower_in(&mut algebra.graph, item, rate)?,
                mass: Vec::new(),
                bias: Graph::ZERO,
                force: Graph::ZERO,
            });
        }
        Ok(Self { speeds })
    }

    /// Whether no rate is prescribed.
    pub fn is_empty(&self) -> bool {
        self.speeds.is_empty()
    }

    /// The speeds with their rates.
    pub fn rates(&self) -> impl Iterator<Item = (usize, Expr)> {
        self.speeds.iter().map(|given| (given.speed, given.rate))
    }

    /// Substitutes the prescribed rates in M and b.
    pub fn put_into(&mut self, graph: &mut Graph, gibbs: &mut GibbsForm) {
        for given in &mut self.speeds {
            given.mass.clone_from(&gibbs.mass_matrix[given.speed]);
            given.bias = gibbs.bias[given.speed];
        }
        let rates: Vec<(usize, Expr)> = self.rates().collect();
        gibbs.give(graph, &rates);
    }

    /// Substitutes the prescribed rates in Π.
    pub fn put_into_forces(&mut self, forces: &mut [Expr]) {
        for given in &mut self.speeds {
            given.force = std::mem::replace(&mut forces[given.speed], given.rate);
        }
    }

    /// Required generalised forces of the drives in a motion with these rates.
    pub fn drives(&self, graph: &mut Graph, accelerations: &[Expr]) -> Vec<(usize, Expr)> {
        let drives = self.speeds.iter().map(|given| {
            let force = demand(graph, &given.mass, accelerations, given.bias, given.force);
            (given.speed, force)
        });
        drives.collect()
    }

    /// Reports a conflict of prescribed rates with another method of derivation, `what`.
    pub fn refuse_beside(&self, what: &str) -> Outcome<()> {
        let findings = self.speeds.iter().map(|given| Finding {
            code: Code::NotAllowedHere,
            message: format!("a pseudo-velocity cannot have a given rate beside {what}"),
            item: Item::PseudoVelocity(appell_spec::mechanism::SpeedId::new(given.speed)),
            help: "let a load drive it, such as a torque that an input sets".to_owned(),
        });
        unless_any(findings.collect())
    }
}

impl GibbsForm {
    /// Prescribes rates of speeds: their rows and columns become those of the unit matrix.
    pub fn give(&mut self, graph: &mut Graph, rates: &[(usize, Expr)]) {
        let is_given = |speed: usize| rates.iter().any(|(given, _)| *given == speed);
        for i in 0..self.bias.len() {
            if is_given(i) {
                continue;
            }
            for &(p, rate) in rates {
                let known = graph.mul(self.mass_matrix[i][p], rate);
                self.bias[i] = graph.add(self.bias[i], known);
                self.mass_matrix[i][p] = Graph::ZERO;
            }
        }
        for &(p, _) in rates {
            self.mass_matrix[p].fill(Graph::ZERO);
            self.mass_matrix[p][p] = Graph::ONE;
            self.bias[p] = Graph::ZERO;
        }
    }
}
