//! Closed loops: position constraints f(q, t, p) = 0 in the filter.
//!
//! The equations satisfy the constraints only at velocity level, and a measurement moves the
//! estimate along the tangent. After each step and measurement the dependent coordinates are
//! recomputed: the mean by Newton's method, the covariance by their slopes, so that it has no
//! component across the constraint. Measurements of dependent coordinates have already acted on the
//! others.

use appell_runtime::model::At;
use appell_runtime::positions::{Inconsistent, Moving, Positions};

use super::plant::{Place, Plant, Scratch, Sums};
use crate::matrix::{add_scaled, dot, multiply};

/// Relative step of a central difference of constraints.
const DIFFERENCE: f64 = 1e-5;

/// The dependent coordinates at a point.
#[derive(Debug, Clone)]
pub(crate) struct Closure {
    positions: Positions,
    /// Dependent coordinates, by their index in the state.
    dependent: Vec<usize>,
    /// Number of states, those before the coordinates, of coordinates.
    n: usize,
    speeds: usize,
    coordinates: usize,
    /// The closed state.
    z: Vec<f64>,
    residual: Vec<f64>,
    /// ∂f/∂q.
    jacobian: Vec<f64>,
    /// ∂z/∂z of the dependent coordinates: a row each, a column for each state, zero for dependent
    /// ones.
    slopes: Vec<f64>,
}

impl Closure {
    /// For a model with position constraints.
    pub(crate) fn of(plant: &Plant<'_>) -> Option<Self> {
        let positions = Positions::of(plant.model)?;
        let speeds = plant.speeds;
        let coordinates = plant.info().state_len() - speeds;
        let follows = plant.model.dependent_coordinates();
        let dependent: Vec<usize> = follows.iter().map(|q| speeds + q).collect();
        let count = dependent.len();
        Some(Self {
            positions,
            n: plant.n,
            speeds,
            coordinates,
            z: vec![0.0; plant.n],
            residual: vec![0.0; count],
            jacobian: vec![0.0; count * coordinates],
            slopes: vec![0.0; count * plant.n],
            dependent,
        })
    }

    /// Independent states.
    pub(crate) fn independent(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.n).filter(|state| !self.dependent.contains(state))
    }

    /// Chooses the best conditioned dependent coordinates at a point, as [`Closure::close`] does.
    pub(crate) fn choose(&mut self, plant: &Plant<'_>, place: Place<'_>, scratch: &mut Scratch) {
        plant.at(place, scratch, |at| {
            let follow = self.positions.choose_dependent(plant.model, at);
            self.dependent = follow.iter().map(|q| self.speeds + q).collect();
        });
    }

    /// Solves the constraints for the dependent coordinates of `z`, and computes their slopes
    /// there.
    pub(crate) fn close(
        &mut self,
        plant: &Plant<'_>,
        place: Place<'_>,
        scratch: &mut Scratch,
        z: &mut [f64],
    ) -> Result<(), Inconsistent> {
        self.choose(plant, Place { z, ..place }, scratch);
        self.z.copy_from_slice(z);
        let states = self.speeds + self.coordinates;
        let mut closed = Ok(());
        plant.at(Place { z, ..place }, scratch, |at| {
            let (model, x) = (plant.model, &mut self.z[..states]);
            let positions = &mut self.positions;
            closed = positions.restore(model, at.t, x, at.u, at.p, Moving::Dependent);
            if closed.is_ok() {
                let at = At { x, ..at };
                model.position_constraints(at, &mut self.residual, &mut self.jacobian);
            }
        });
        closed?;
        z.copy_from_slice(&self.z);
        self.take_slopes()
    }

    /// `-(∂f/∂q_d)⁻¹ ∂f/∂q` in the columns of the independent coordinates.
    fn take_slopes(&mut self) -> Result<(), Inconsistent> {
        let mut column = vec![0.0; self.dependent.len()];
        self.slopes.fill(0.0);
        for q in 0..self.coordinates {
            if self.dependent.contains(&(self.speeds + q)) {
                continue;
            }
            for (row, entry) in column.iter_mut().enumerate() {
                *entry = -self.jacobian[row * self.coordinates + q];
            }
            self.solve(&mut column, false)?;
            for (row, entry) in column.iter().enumerate() {
                self.slopes[row * self.n + self.speeds + q] = *entry;
            }
        }
        Ok(())
    }

    /// Solves with `∂f/∂q_d`, or with its transpose.
    fn solve(&self, right: &mut [f64], transposed: bool) -> Result<(), Inconsistent> {
        let count = self.dependent.len();
        let entry = |row: usize, column: usize| {
            self.jacobian[row * self.coordinates + self.dependent[column] - self.speeds]
        };
        let mut matrix = vec![0.0; count * count];
        for row in 0..count {
            for column in 0..count {
                matrix[row * count + column] = if transposed {
                    entry(column, row)
                } else {
                    entry(row, column)
                };
            }
        }
        let solved = appell_runtime::dense::solved_in_place(&mut matrix, right, count);
        solved.then_some(()).ok_or(Inconsistent {
            residual: f64::INFINITY,
            state: self.dependent[0],
        })
    }

    /// Recomputes the dependent rows of a matrix, n rows of any width: N A.
    pub(crate) fn follow(&self, matrix: &mut [f64]) {
        let width = matrix.len() / self.n;
        let mut rows = vec![0.0; self.dependent.len() * width];
        multiply(&self.slopes, matrix, self.n, &mut rows);
        for (&state, row) in self.dependent.iter().zip(rows.chunks_exact(width)) {
            matrix[state * width..(state + 1) * width].copy_from_slice(row);
        }
    }

    /// Derivatives of the dependent coordinates with respect to a parameter, each with its state.
    pub(crate) fn by_parameter(
        &self,
        plant: &Plant<'_>,
        place: Place<'_>,
        scratch: &mut Scratch,
        parameter: usize,
    ) -> Vec<(usize, f64)> {
        let mut slope = vec![0.0; self.dependent.len()];
        plant.at(
            Place {
                z: &self.z,
                ..place
            },
            scratch,
            |at| {
                self.differences(plant, at, Varied::Parameter(parameter), |sign, f, _| {
                    add_scaled(-sign, f, &mut slope);
                });
            },
        );
        // The slopes were computed with the same matrix.
        let _ = self.solve(&mut slope, false);
        self.dependent.iter().copied().zip(slope).collect()
    }

    /// Calls with f and ∂f/∂q above and below, and with the factors of a central difference.
    fn differences(
        &self,
        plant: &Plant<'_>,
        at: At<'_>,
        varied: Varied,
        mut tell: impl FnMut(f64, &[f64], &[f64]),
    ) {
        let (mut x, mut p) = (at.x.to_vec(), at.p.to_vec());
        let (mut f, mut jacobian) = (self.residual.clone(), self.jacobian.clone());
        let (value, floor) = match varied {
            Varied::Coordinate(q) => (x[self.speeds + q], 1.0),
            Varied::Parameter(index) => (p[index], DIFFERENCE),
        };
        let h = DIFFERENCE * value.abs().max(floor);
        for sign in [1.0, -1.0] {
            match varied {
                Varied::Coordinate(q) => x[self.speeds + q] = value + sign * h,
                Varied::Parameter(index) => p[index] = value + sign * h,
            }
            let at = At { x: &x, p: &p, ..at };
            plant.model.position_constraints(at, &mut f, &mut jacobian);
            tell(sign / (2.0 * h), &f, &jacobian);
        }
    }

    /// Reverse sweep: from gradients with respect to the closed state and N P Nᵀ to those with
    /// respect to the state before and P, given a root of P.
    pub(crate) fn adjoint(
        &self,
        plant: &Plant<'_>,
        place: Place<'_>,
        scratch: &mut Scratch,
        root: &[f64],
        covariance: &mut [f64],
        sums: &mut Sums,
    ) {
        let (n, count) = (self.n, self.dependent.len());
        // The derivative with respect to N is 2 Λ N P.
        let mut closed = root.to_vec();
        self.follow(&mut closed);
        let mut by_closed = vec![0.0; count * n];
        let rows = self
            .dependent
            .iter()
            .map(|&state| &covariance[state * n..(state + 1) * n]);
        for (row, out) in rows.zip(by_closed.chunks_exact_mut(n)) {
            multiply(row, &closed, n, out);
        }
        let mut by_slopes = vec![0.0; count * n];
        for (row, out) in by_closed.chunks_exact(n).zip(by_slopes.chunks_exact_mut(n)) {
            for (j, out) in out.iter_mut().enumerate() {
                *out = 2.0 * dot(row, &root[j * n..(j + 1) * n]);
            }
        }
        let weights = self.jacobian_weights(&by_slopes);
        let mut mu = vec![0.0; count];
        let mut by_p = vec![0.0; place.p.len()];
        plant.at(
            Place {
                z: &self.z,
                ..place
            },
            scratch,
            |at| {
                for q in 0..self.coordinates {
                    let by_q = &mut sums.z[self.speeds + q];
                    self.differences(plant, at, Varied::Coordinate(q), |sign, _, jacobian| {
                        *by_q -= sign * dot(&weights, jacobian);
                    });
                }
                for (mu, &state) in mu.iter_mut().zip(&self.dependent) {
                    *mu = sums.z[state];
                }
                let _ = self.solve(&mut mu, true);
                for (index, by_p) in by_p.iter_mut().enumerate() {
                    self.differences(plant, at, Varied::Parameter(index), |sign, f, jacobian| {
                        *by_p -= sign * (dot(&mu, f) + dot(&weights, jacobian));
                    });
                }
            },
        );
        plant.pass_on_parameters(1.0, &mut by_p, sums);
        // Nᵀ λ and Nᵀ Λ N.
        self.gather(&mut sums.z);
        self.gather(covariance);
        let mut row = vec![0.0; n];
        for line in covariance.chunks_exact_mut(n) {
            row.copy_from_slice(line);
            self.gather(&mut row);
            line.copy_from_slice(&row);
        }
    }

    /// Weights W with d⟨K, slopes⟩ = −⟨W, d(∂f/∂q)⟩.
    fn jacobian_weights(&self, by_slopes: &[f64]) -> Vec<f64> {
        let (n, count) = (self.n, self.dependent.len());
        let mut weights = vec![0.0; count * self.coordinates];
        let mut column = vec![0.0; count];
        for q in 0..self.coordinates {
            let state = self.speeds + q;
            if self.dependent.contains(&state) {
                continue;
            }
            for (row, entry) in column.iter_mut().enumerate() {
                *entry = by_slopes[row * n + state];
            }
            let _ = self.solve(&mut column, true);
            for (row, &entry) in column.iter().enumerate() {
                weights[row * self.coordinates + q] = entry;
                for (other, &dependent) in self.dependent.iter().enumerate() {
                    weights[row * self.coordinates + dependent - self.speeds] +=
                        entry * self.slopes[other * n + state];
                }
            }
        }
        weights
    }

    /// Nᵀ A of a matrix of n rows.
    fn gather(&self, matrix: &mut [f64]) {
        let width = matrix.len() / self.n;
        for (row, &state) in self.dependent.iter().enumerate() {
            let taken: Vec<f64> = matrix[state * width..(state + 1) * width].to_vec();
            matrix[state * width..(state + 1) * width].fill(0.0);
            for j in 0..self.n {
                let slope = self.slopes[row * self.n + j];
                add_scaled(slope, &taken, &mut matrix[j * width..(j + 1) * width]);
            }
        }
    }
}

/// The varied quantity of a difference.
#[derive(Clone, Copy)]
enum Varied {
    Coordinate(usize),
    Parameter(usize),
}
