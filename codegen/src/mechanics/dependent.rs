//! Generalised velocities without an explicit formula, as dependent speeds.
//!
//! They are first treated as additional independent speeds `s`, before their elimination: velocities and
//! equations stay short. The system `C s = r(ω)` that determines them then reduces the equations to the
//! pseudo-velocities. With `s = β ω + β₀`, `ṡ = β ω̇ + γ` and `B = [1; β]`, the mass matrix is `Bᵀ M B`, the
//! bias `Bᵀ (b + M [0; γ])`, the pseudo-forces `Bᵀ Π` (Kane and Levinson, Dynamics: Theory and Applications,
//! 1985, sections 2.11 and 4.4).

use appell_spec::mechanism::{CoordinateId, Mechanism};

use super::algebra::{Algebra, name_of, replacing, scalar_product};
use super::constraints::Constraints;
use super::contact_rows::ContactRows;
use super::elimination::{Elimination, GeneralizedVelocities, OpenSystem};
use super::expressions::Setting;
use super::finding::Outcome;
use super::gibbs_appell::{BodyMotion, GibbsForm};
use super::kinematics::Kinematics;
use super::letters;
use super::motion::Way;
use crate::symbolic::vector::Vec3;
use crate::symbolic::{Expr, Graph, Substitution};

/// The dependent speeds of a mechanism; most have none.
#[derive(Debug, Clone, Default)]
pub struct DependentSpeeds {
    /// `C s = r`, with symbols for s.
    pub system: OpenSystem,
    /// ∂r/∂ω, row by row.
    pub driving: Vec<Vec<Expr>>,
    /// `ṙ - Ċ s` at zero pseudo-accelerations, with symbols for s.
    pub change: Vec<Expr>,
    /// s, named.
    pub values: Vec<Expr>,
    /// q̇ in terms of the pseudo-velocities and of the symbols for s.
    pub rates: Vec<Expr>,
    /// Symbols for ṡ.
    pub accelerations: Vec<Expr>,
    /// Symbols for the multipliers λ, one per equation of the system.
    pub multipliers: Vec<Expr>,
    /// β = ∂s/∂ω, named.
    pub partial: Vec<Vec<Expr>>,
    /// γ: ṡ at zero pseudo-accelerations, named.
    pub bias: Vec<Expr>,
}

impl DependentSpeeds {
    /// The dependent speeds with their derivatives, and q̇ with their values. The motions of `bodies` are in
    /// terms of the pseudo-velocities and the dependent speeds.
    pub fn new(
        algebra: &mut Algebra,
        free: Setting<'_>,
        constraints: &Constraints,
        mut elimination: Elimination,
        kinematics: &Kinematics,
        bodies: &[BodyMotion],
    ) -> Outcome<(Self, GeneralizedVelocities)> {
        let Setting {
            mechanism, symbols, ..
        } = free;
        let contacts =
            ContactRows::all(algebra, free, constraints, &elimination, kinematics, bodies)?;
        for contact in &contacts {
            elimination.turn(algebra, &contact.places, &contact.rows);
        }
        let system = elimination.open.clone();
        let rates = elimination.rates.clone();
        let velocities = elimination.closed(algebra, mechanism)?;
        let mut symbols_for = |name: &str| -> Vec<Expr> {
            let unknowns = names(mechanism, &system).into_iter();
            unknowns
                .map(|q| algebra.graph.symbol(&format!("{q}_{name}")))
                .collect()
        };
        let (accelerations, multipliers) = (symbols_for("ddot"), symbols_for("multiplier"));
        let mut dependent = Self {
            values: velocities.solved.clone(),
            partial: vec![Vec::new(); system.unknowns.len()],
            rates: rates.clone(),
            accelerations,
            multipliers,
            system,
            ..Self::default()
        };
        let moving = Setting::new(mechanism, symbols, &rates);
        let residual = dependent.residual(&mut algebra.graph);
        for (place, row) in residual.into_iter().enumerate() {
            let right = dependent.system.right[place];
            let mut driving: Vec<Expr> = symbols
                .speeds
                .iter()
                .map(|&speed| algebra.derivative(right, speed))
                .collect();
            let known = contacts.iter().find_map(|contact| contact.change_of(place));
            let change = if let Some(change) = known {
                change
            } else {
                driving = driving
                    .into_iter()
                    .map(|slope| algebra.shortest(slope))
                    .collect();
                let change = moving.rate(algebra, row);
                algebra.shortest(change)
            };
            dependent.driving.push(driving);
            dependent.change.push(change);
        }
        dependent.solve(algebra, mechanism)?;
        Ok((dependent, velocities))
    }

    /// β and γ from the system.
    fn solve(&mut self, algebra: &mut Algebra, mechanism: &Mechanism) -> Outcome<()> {
        let names = names(mechanism, &self.system);
        for (i, speed) in mechanism.pseudo_velocities.iter().enumerate() {
            let right: Vec<Expr> = self.driving.iter().map(|row| row[i]).collect();
            let solved = self.system.solved_for(&mut algebra.graph, &right);
            for ((row, name), partial) in self.partial.iter_mut().zip(&names).zip(solved) {
                let name = format!("d_{name}_dot_d_{}", speed.label.name);
                row.push(algebra.graph.name(&name, partial));
            }
        }
        let mut actual = self.actual(&algebra.graph);
        let change = algebra.apply(&mut actual, &self.change)?;
        let solved = self.system.solved_for(&mut algebra.graph, &change);
        for (name, bias) in names.iter().zip(solved) {
            self.bias
                .push(algebra.graph.name(&format!("a0_{name}"), bias));
        }
        Ok(())
    }

    /// `r - C s`, with symbols for s.
    pub fn residual(&self, graph: &mut Graph) -> Vec<Expr> {
        let OpenSystem {
            unknowns,
            matrix,
            right,
            ..
        } = &self.system;
        if unknowns.is_empty() {
            return Vec::new();
        }
        let rows = matrix.chunks(unknowns.len()).zip(right);
        rows.map(|(row, &right)| {
            let left = scalar_product(graph, row, unknowns);
            graph.sub(right, left)
        })
        .collect()
    }

    /// Substitutes the values for the symbols.
    pub fn actual(&self, graph: &Graph) -> Substitution {
        replacing(graph, &self.system.unknowns, &self.values).keeping_names()
    }

    /// The solution method of the reduced equations.
    pub fn way(&self) -> Way<'static> {
        if self.values.is_empty() {
            Way::Shortest
        } else {
            Way::Factorized
        }
    }

    /// `D ω̇ + c - C ṡ` for rates of all speeds.
    pub fn acceleration_residual(&self, graph: &mut Graph, accelerations: &[Expr]) -> Vec<Expr> {
        let (own, dependent) = accelerations.split_at(accelerations.len() - self.values.len());
        let rows = self
            .system
            .matrix
            .chunks(self.values.len().max(1))
            .zip(&self.driving)
            .zip(&self.change);
        rows.map(|((row, driving), &change)| {
            let driven = scalar_product(graph, driving, own);
            let left = scalar_product(graph, row, dependent);
            let right = graph.add(driven, change);
            graph.sub(right, left)
        })
        .collect()
    }

    /// λ in `Cᵀ λ = work`, named.
    pub fn solved_multipliers(&self, graph: &mut Graph, work: &[Expr]) -> Vec<Expr> {
        let solved = self.system.transposed_for(graph, work).into_iter();
        solved
            .zip(&self.multipliers)
            .map(|(value, &symbol)| graph.name(&name_of(graph, symbol), value))
            .collect()
    }

    /// `residual + [D, -C]ᵀ λ` with symbols for λ.
    pub fn balance(&self, graph: &mut Graph, residual: &[Expr]) -> Vec<Expr> {
        let n = self.values.len();
        let own = residual.len() - n;
        residual
            .iter()
            .enumerate()
            .map(|(j, &residual)| {
                let column: Vec<Expr> = (0..n)
                    .map(|row| match j.checked_sub(own) {
                        None => self.driving[row][j],
                        Some(d) => graph.neg(self.system.matrix[row * n + d]),
                    })
                    .collect();
                let work = scalar_product(graph, &column, &self.multipliers);
                graph.add(residual, work)
            })
            .collect()
    }

    /// ω̇ followed by the corresponding ṡ.
    pub fn accelerations_with(&self, graph: &mut Graph, independent: &[Expr]) -> Vec<Expr> {
        let mut all = independent.to_vec();
        for (row, &bias) in self.partial.iter().zip(&self.bias) {
            let along = scalar_product(graph, row, independent);
            let sum = graph.add(bias, along);
            let symbol = self.accelerations[all.len() - independent.len()];
            all.push(graph.name(&name_of(graph, symbol), sum));
        }
        all
    }

    /// `Bᵀ v` for a vector with an entry for each speed, the dependent ones last.
    pub fn along_allowed(&self, graph: &mut Graph, all: &[Expr]) -> Vec<Expr> {
        let (own, dependent) = all.split_at(all.len() - self.values.len());
        own.iter()
            .enumerate()
            .map(|(i, &own)| {
                let share: Vec<Expr> = self.partial.iter().map(|row| row[i]).collect();
                let share = scalar_product(graph, &share, dependent);
                graph.add(own, share)
            })
            .collect()
    }

    /// M and b of the pseudo-velocities from those of all speeds.
    pub fn reduced(
        &self,
        algebra: &mut Algebra,
        mechanism: &Mechanism,
        all: &GibbsForm,
    ) -> Outcome<GibbsForm> {
        if self.values.is_empty() {
            return Ok(all.clone());
        }
        let speeds = all.bias.len() - self.values.len();
        let mut actual = self.actual(&algebra.graph);
        let bias = algebra.apply(&mut actual, &all.bias)?;
        let graph = &mut algebra.graph;
        let mass = letters::mass(mechanism);
        // M B, the rows of the dependent speeds.
        let coupling: Vec<Vec<Expr>> = all.mass_matrix[speeds..]
            .iter()
            .zip(&self.system.unknowns)
            .map(|(row, &unknown)| {
                let along = self.along_allowed(graph, row);
                let name = name_of(graph, unknown);
                let named = along.into_iter().zip(&mechanism.pseudo_velocities);
                named
                    .map(|(entry, speed)| {
                        graph.name(&format!("{mass}_{name}_{}", speed.label.name), entry)
                    })
                    .collect()
            })
            .collect();
        let column = |matrix: &[Vec<Expr>], j: usize| -> Vec<Expr> {
            matrix.iter().map(|row| row[j]).collect()
        };
        let mut mass_matrix = vec![vec![Graph::ZERO; speeds]; speeds];
        let mut reduced_bias = self.along_allowed(graph, &bias);
        for i in 0..speeds {
            for j in 0..=i {
                let own = &all.mass_matrix[i];
                let direct = scalar_product(graph, &own[speeds..], &column(&self.partial, j));
                let shared =
                    scalar_product(graph, &column(&self.partial, i), &column(&coupling, j));
                let entry = graph.sum(&[own[j], direct, shared]);
                mass_matrix[i][j] = entry;
                mass_matrix[j][i] = entry;
            }
            let share = scalar_product(graph, &column(&coupling, i), &self.bias);
            reduced_bias[i] = graph.add(reduced_bias[i], share);
        }
        Ok(GibbsForm {
            mass_matrix,
            bias: reduced_bias,
        })
    }

    /// Motions of the bodies in terms of the pseudo-velocities alone.
    pub fn reduced_bodies(
        &self,
        algebra: &mut Algebra,
        mut bodies: Vec<BodyMotion>,
    ) -> Outcome<Vec<BodyMotion>> {
        if self.values.is_empty() {
            return Ok(bodies);
        }
        let mut actual = self.actual(&algebra.graph);
        for body in &mut bodies {
            let centre = &mut body.centre;
            centre.velocity.v = apply3(&mut actual, algebra, centre.velocity.v)?;
            centre.bias = apply3(&mut actual, algebra, centre.bias)?;
            let more = self.reduce_partial(&mut algebra.graph, &mut centre.partial);
            centre.bias = algebra.graph.add3(centre.bias, more);
            if let Some(rotation) = &mut body.rotation {
                rotation.velocity.v = apply3(&mut actual, algebra, rotation.velocity.v)?;
                rotation.bias = apply3(&mut actual, algebra, rotation.bias)?;
                rotation.momentum_rate = apply3(&mut actual, algebra, rotation.momentum_rate)?;
                let more = self.reduce_partial(&mut algebra.graph, &mut rotation.partial);
                rotation.bias = algebra.graph.add3(rotation.bias, more);
                let growth = algebra.graph.mat_vec(&rotation.inertia, more);
                rotation.momentum_rate = algebra.graph.add3(rotation.momentum_rate, growth);
            }
        }
        Ok(bodies)
    }

    /// Replaces partial velocities with respect to all speeds by those with respect to the pseudo-velocities;
    /// returns the contribution of the dependent speeds at zero pseudo-accelerations.
    fn reduce_partial(&self, graph: &mut Graph, partial: &mut Vec<Vec3>) -> Vec3 {
        let dependent = partial.split_off(partial.len() - self.values.len());
        for (i, own) in partial.iter_mut().enumerate() {
            for (&direction, row) in dependent.iter().zip(&self.partial) {
                let share = graph.scale3(row[i], direction);
                *own = graph.add3(*own, share);
            }
        }
        let mut more = [Graph::ZERO; 3];
        for (&direction, &bias) in dependent.iter().zip(&self.bias) {
            let share = graph.scale3(bias, direction);
            more = graph.add3(more, share);
        }
        more
    }
}

/// The names of the coordinates whose rates a system determines.
fn names<'m>(mechanism: &'m Mechanism, system: &OpenSystem) -> Vec<&'m str> {
    let coordinates = system.coordinates.iter();
    let labels = coordinates.map(|&q| &mechanism.coordinates[CoordinateId::new(q)].label);
    labels.map(|label| label.name.as_str()).collect()
}

fn apply3(actual: &mut Substitution, algebra: &mut Algebra, v: Vec3) -> Outcome<Vec3> {
    let applied = algebra.apply(actual, &v)?;
    Ok([applied[0], applied[1], applied[2]])
}
