//! Lagrange's equations with multipliers: `d/dt ∂T/∂q̇ - ∂T/∂q + ∂V/∂q = Q + Cᵀ λ`, `C q̈ + ċ = 0`.
//!
//! T is expressed in all generalised velocities, before constraints are applied.

use super::inertial::Inertial;
use super::loads::{Which, efforts, generalized_force, potential};
use crate::mechanics::algebra::{Algebra, replacing};
use crate::mechanics::finding::Outcome;
use crate::mechanics::rank::{LinearRow, Standing, standings};
use crate::symbolic::{Expr, Graph, Rational};

/// The solution of Lagrange's equations.
pub(super) struct Lagrange {
    /// Generalised accelerations q̈.
    pub(super) accelerations: Vec<Expr>,
    /// Multiplier of each constraint row; `None` if it does not appear in the equations, because geometry or other
    /// rows already imply the row.
    pub(super) multipliers: Vec<Option<Expr>>,
    /// Whether rows are redundant, so that the multipliers are not unique.
    pub(super) redundant: bool,
}

/// `Σ coefficient q̈ = right` in the state of the motion.
struct Equation {
    coefficients: Vec<Expr>,
    right: Expr,
}

/// Lagrange's equations for velocities with symbols for q̇, solved at q̇ = `rates`. A prescribed pseudo-acceleration
/// is a constraint on q̈.
pub(super) fn lagrange(
    algebra: &mut Algebra,
    inertial: &Inertial<'_>,
    rates: &[Expr],
    given: &[(usize, Expr)],
) -> Outcome<Lagrange> {
    let n = rates.len();
    let dynamics = dynamics(algebra, inertial)?;
    let rows = inertial.rows(algebra)?;
    let mut constraints = Vec::with_capacity(rows.len());
    for row in &rows {
        constraints.push(differentiated(algebra, inertial, row.value)?);
    }
    let definitions = inertial.definitions(algebra)?;
    for &(speed, rate) in given {
        let mut row = differentiated(algebra, inertial, definitions[speed])?;
        row.right = algebra.graph.add(row.right, rate);
        constraints.push(row);
    }
    let active = independent(algebra, &constraints);
    let moving = constraints.iter().filter(|row| row.moves(algebra)).count();

    // M q̈ - Cᵀ λ = right, C q̈ = -ċ, for the constrained motion.
    let size = n + active.len();
    let mut matrix = vec![Graph::ZERO; size * size];
    let mut right = Vec::with_capacity(size);
    for (i, equation) in dynamics.iter().enumerate() {
        matrix[i * size..i * size + n].copy_from_slice(&equation.coefficients);
        right.push(equation.right);
    }
    for (place, &row) in (n..).zip(&active) {
        for (k, &coefficient) in constraints[row].coefficients.iter().enumerate() {
            matrix[place * size + k] = coefficient;
            matrix[k * size + place] = algebra.graph.neg(coefficient);
        }
        right.push(constraints[row].right);
    }
    let mut allowed = replacing(&algebra.graph, &inertial.setting.symbols.rates, rates);
    for entry in matrix.iter_mut().chain(&mut right) {
        *entry = algebra.apply(&mut allowed, &[*entry])?[0];
        algebra.check_size()?;
    }
    let solution = algebra.graph.solve_numerically(matrix, right);
    let mut multipliers = vec![None; rows.len()];
    for (place, &row) in (n..).zip(&active) {
        if let Some(multiplier) = multipliers.get_mut(row) {
            *multiplier = Some(solution[place]);
        }
    }
    Ok(Lagrange {
        accelerations: solution[..n].to_vec(),
        multipliers,
        redundant: active.len() < moving,
    })
}

/// `M q̈ = Q - ∂V/∂q + ∂T/∂q - (d/dt ∂T/∂q̇ without q̈)`, one equation per coordinate.
fn dynamics(algebra: &mut Algebra, inertial: &Inertial<'_>) -> Outcome<Vec<Equation>> {
    let kinetic = kinetic_energy(algebra, inertial)?;
    let potential = potential(algebra, inertial)?;
    let loads = efforts(algebra, inertial, Which::WithoutPotential)?;
    let symbols = inertial.setting.symbols;
    let mut equations = Vec::with_capacity(symbols.coordinates.len());
    for (&q, &rate) in symbols.coordinates.iter().zip(&symbols.rates) {
        let momentum = algebra.derivative(kinetic, rate);
        let mut equation = differentiated(algebra, inertial, momentum)?;
        let slope = algebra.derivative(kinetic, q);
        let pull = algebra.derivative(potential, q);
        let force = generalized_force(algebra, &loads, rate);
        let graph = &mut algebra.graph;
        let pull = graph.neg(pull);
        equation.right = graph.sum(&[force, pull, slope, equation.right]);
        algebra.check_size()?;
        equations.push(equation);
    }
    Ok(equations)
}

/// T = Σ ½ m v·v + ½ ω·I ω
fn kinetic_energy(algebra: &mut Algebra, inertial: &Inertial<'_>) -> Outcome<Expr> {
    let mut parts = Vec::new();
    for (index, body) in inertial.setting.mechanism.bodies.entries() {
        let v = inertial.velocity(&mut algebra.graph, None, body.centre);
        let square = algebra.graph.dot(v, v);
        let mass = inertial.mass(algebra, index)?;
        parts.push(algebra.graph.mul(mass, square));
        let w = inertial.turning(index);
        let momentum = inertial.momentum(algebra, index, w)?;
        parts.push(algebra.graph.dot(w, momentum));
    }
    let twice = algebra.graph.sum(&parts);
    algebra.check_size()?;
    Ok(algebra.graph.scale(&Rational::new(1, 2), twice))
}

/// The rate of a function of coordinates, generalised velocities and time:
/// `Σ ∂f/∂q̇ q̈ = df/dt - (∂f/∂q q̇ + ∂f/∂t)`, with the terms without q̈ for df/dt = 0.
fn differentiated(algebra: &mut Algebra, inertial: &Inertial<'_>, f: Expr) -> Outcome<Equation> {
    let rates = inertial.setting.symbols.rates.iter();
    let coefficients = rates.map(|&rate| algebra.derivative(f, rate)).collect();
    let drift = inertial.setting.rate(algebra, f);
    algebra.check_size()?;
    Ok(Equation {
        coefficients,
        right: algebra.graph.neg(drift),
    })
}

impl Equation {
    /// Whether any acceleration appears in it.
    fn moves(&self, algebra: &mut Algebra) -> bool {
        let Algebra { graph, test, .. } = algebra;
        self.coefficients.iter().any(|&c| !test.is_zero(graph, c))
    }
}

/// The rows that are not linear combinations of preceding rows.
fn independent(algebra: &mut Algebra, rows: &[Equation]) -> Vec<usize> {
    let mut linear = Vec::with_capacity(rows.len());
    for row in rows {
        let coefficients = row.coefficients.iter();
        let coefficients = coefficients.map(|&c| algebra.unless_zero(c));
        linear.push(LinearRow::homogeneous(coefficients.collect()));
    }
    let standings = standings(algebra, &linear).into_iter().enumerate();
    let independent = standings.filter(|(_, standing)| *standing == Standing::Independent);
    independent.map(|(row, _)| row).collect()
}
