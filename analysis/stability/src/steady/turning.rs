//! Unit quaternions that vary in a steady motion.
//!
//! The quaternion of a rotating body varies even if the motion is steady: ė = K e with an antisymmetric K. The motion
//! is a relative equilibrium if the equations are equivariant under this rotation, ẋ(exp(K s) x) = exp(K s) ẋ(x). For
//! attitudes relative to the ground, K is e ↦ ½ a e: a rotation about the vertical if only gravity distinguishes a
//! direction, any rotation without gravity. The symmetries are determined from A and ẋ, like ignorable coordinates.
//! Perturbations are those of exp(-K t) x, which is constant in the steady motion.

use appell_runtime::model::{At, Model};
use appell_spectra::singular::Singular;
use nalgebra::{DMatrix, DVector, Matrix4};

/// Effects of a rotation, relative to the row of A, that are rounding.
const ROUNDING: f64 = 1e-11;
/// Directions shorter than this, relative to the longest, coincide with others.
const SAME_DIRECTION: f64 = 1e-9;
/// Rotations in four dimensions: pairs of axes.
const PLANES: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];
/// Steps towards a reference.
const MOST_STEPS: usize = 100;

/// ẋ and A at a state.
pub(crate) struct Sample {
    pub(crate) x: Vec<f64>,
    pub(crate) u: Vec<f64>,
    pub(crate) rates: Vec<f64>,
    pub(crate) a: Vec<f64>,
}

/// Quaternions, and the rotations of their components under which the equations are equivariant.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Turning {
    /// The components of each, by their index among the states.
    pub(crate) quaternions: Vec<[usize; 4]>,
    /// For each rotation, K of every quaternion.
    rotations: Vec<Vec<Matrix4<f64>>>,
}

/// The quaternions of a model, by their components among the states. They are recognised by the position
/// constraints of their norms, whose gradient is twice the components.
pub(crate) fn quaternions(model: &dyn Model, at: At<'_>) -> Vec<[usize; 4]> {
    let speeds = model.info().speeds;
    let (count, coordinates) = (model.dependent_coordinates().len(), at.x.len() - speeds);
    let (mut residual, mut slopes) = (vec![0.0; count], vec![0.0; count * coordinates]);
    model.position_constraints(at, &mut residual, &mut slopes);
    let of_row = |row: &[f64]| {
        let places: Vec<usize> = (0..coordinates).filter(|&q| row[q] != 0.0).collect();
        let twice = |q: &usize| (row[*q] - 2.0 * at.x[speeds + q]).abs() <= 1e-12 * row[*q].abs();
        let four: [usize; 4] = places.try_into().ok()?;
        four.iter().all(twice).then(|| four.map(|q| speeds + q))
    };
    let rows = slopes.chunks_exact(coordinates.max(1));
    rows.filter_map(of_row).collect()
}

/// Gives each quaternion norm 1.
pub(crate) fn normalise(quaternions: &[[usize; 4]], x: &mut [f64]) {
    for quaternion in quaternions {
        let norm = quaternion.iter().map(|&e| x[e] * x[e]).sum::<f64>().sqrt();
        if norm > 0.0 {
            for &e in quaternion {
                x[e] /= norm;
            }
        }
    }
}

impl Turning {
    /// The rotations that change none of the rates of `rows`, apart from rotating them.
    pub(crate) fn of(quaternions: Vec<[usize; 4]>, samples: &[Sample], rows: &[usize]) -> Self {
        let columns = PLANES.len() * quaternions.len();
        let unit = |column: usize| -> Vec<Matrix4<f64>> {
            let [i, j] = PLANES[column % PLANES.len()];
            let mut all = vec![Matrix4::zeros(); quaternions.len()];
            let k = &mut all[column / PLANES.len()];
            (k[(i, j)], k[(j, i)]) = (-1.0, 1.0);
            all
        };
        let units = Self {
            rotations: (0..columns).map(unit).collect(),
            quaternions,
        };
        let mut effects = DMatrix::zeros(samples.len() * rows.len(), columns);
        for (place, sample) in samples.iter().enumerate() {
            let changes = units.changes(sample, rows);
            effects
                .rows_mut(place * rows.len(), rows.len())
                .copy_from(&changes);
        }
        let rotations = if columns == 0 {
            Vec::new()
        } else {
            let singular = Singular::of(&effects);
            let none = |k: &usize| singular.values[*k] <= ROUNDING;
            let free = (0..columns).filter(none);
            free.map(|k| units.combined(&singular.right.column(k).into_owned()))
                .collect()
        };
        Self { rotations, ..units }
    }

    /// Whether the rate of a state that is no component of a quaternion is the same along all rotations.
    pub(crate) fn keeps(&self, samples: &[Sample], state: usize) -> bool {
        let change = |sample| self.changes(sample, &[state]).amax();
        self.rotations.is_empty() || samples.iter().all(|sample| change(sample) <= ROUNDING)
    }

    /// What rotations change of rates, relative to their rows of A: a row each, a column for each rotation.
    fn changes(&self, sample: &Sample, rows: &[usize]) -> DMatrix<f64> {
        let n = sample.x.len();
        let a = DMatrix::from_row_slice(n, n, &sample.a).select_rows(rows);
        let rotated = self.directions(&sample.rates).select_rows(rows);
        let mut changes = &a * self.directions(&sample.x) - rotated;
        for (k, mut change) in changes.row_iter_mut().enumerate() {
            let size = a.row(k).amax().max(sample.rates[rows[k]].abs());
            change /= size.max(f64::MIN_POSITIVE);
        }
        changes
    }

    /// Whether a state is a component of a quaternion that is changed by a rotation.
    pub(crate) fn moves(&self, state: usize) -> bool {
        let of = self.quaternions.iter().position(|q| q.contains(&state));
        let turns = |of: usize| self.rotations.iter().any(|all| all[of] != Matrix4::zeros());
        of.is_some_and(turns)
    }

    /// Σ c K.
    fn combined(&self, c: &DVector<f64>) -> Vec<Matrix4<f64>> {
        let mut sum = vec![Matrix4::zeros(); self.quaternions.len()];
        for (rotation, c) in self.rotations.iter().zip(c.iter()) {
            for (sum, k) in sum.iter_mut().zip(rotation) {
                *sum += k * *c;
            }
        }
        sum
    }

    /// K x of every rotation, as columns.
    pub(crate) fn directions(&self, x: &[f64]) -> DMatrix<f64> {
        let mut directions = DMatrix::zeros(x.len(), self.rotations.len());
        for (column, rotation) in self.rotations.iter().enumerate() {
            for (k, quaternion) in rotation.iter().zip(&self.quaternions) {
                for (i, &row) in quaternion.iter().enumerate() {
                    directions[(row, column)] = (0..4).map(|j| k[(i, j)] * x[quaternion[j]]).sum();
                }
            }
        }
        directions
    }

    /// The generator Σ c K of the rotation of a state with these rates, as a matrix over all states.
    pub(crate) fn turn(&self, x: &[f64], rates: &[f64]) -> DMatrix<f64> {
        let n = x.len();
        let mut turn = DMatrix::zeros(n, n);
        if self.rotations.is_empty() {
            return turn;
        }
        let along = Along::of(self.directions(x));
        let sum = self.combined(&along.coefficients(&DVector::from_column_slice(rates)));
        for (k, quaternion) in sum.iter().zip(&self.quaternions) {
            for (i, &row) in quaternion.iter().enumerate() {
                for (j, &column) in quaternion.iter().enumerate() {
                    turn[(row, column)] = k[(i, j)];
                }
            }
        }
        turn
    }

    /// The rates relative to the rotation.
    pub(crate) fn still(&self, x: &[f64], rates: &[f64]) -> Vec<f64> {
        let turning = self.turn(x, rates) * DVector::from_column_slice(x);
        rates
            .iter()
            .zip(turning.iter())
            .map(|(a, b)| a - b)
            .collect()
    }

    /// Projects columns of derivatives of rates onto the orthogonal complement of the rotations.
    pub(crate) fn across(&self, x: &[f64], columns: &mut DMatrix<f64>) {
        if !self.rotations.is_empty() {
            let along = Along::of(self.directions(x));
            for mut column in columns.column_iter_mut() {
                let less = &along.directions * along.coefficients(&column.clone_owned());
                column -= less;
            }
        }
    }

    /// Number of rotations.
    pub(crate) fn len(&self) -> usize {
        self.rotations.len()
    }

    /// Rotates a state about all of them at once.
    pub(crate) fn rotate(&self, by: f64, x: &mut [f64]) {
        let each = (0..self.len()).map(|k| by / (1.0 + k as f64));
        self.rotate_by(&DVector::from_iterator(self.len(), each), x);
    }

    /// Rotates a state by Σ c K.
    fn rotate_by(&self, c: &DVector<f64>, x: &mut [f64]) {
        for (k, quaternion) in self.combined(c).iter().zip(&self.quaternions) {
            let turned = k.exp() * nalgebra::Vector4::from(quaternion.map(|e| x[e]));
            for (&e, turned) in quaternion.iter().zip(turned.iter()) {
                x[e] = *turned;
            }
        }
    }

    /// Replaces a state by the one nearest to `reference` among those that differ only by rotations and by signs of
    /// quaternions, so that equivalent motions are reported once.
    pub(crate) fn bring_near(&self, reference: &[f64], x: &mut [f64]) {
        /// Below this all of them are equally far from the reference, and a perturbed reference decides.
        const FAR: f64 = 1e-6;
        const BESIDE: [f64; 4] = [0.3, 0.9, -0.5, 0.7];
        let mut wanted = DVector::zeros(x.len());
        for quaternion in &self.quaternions {
            for &e in quaternion {
                wanted[e] = reference[e];
            }
        }
        if self.climb(&wanted, x) < FAR {
            for quaternion in &self.quaternions {
                for (&e, beside) in quaternion.iter().zip(BESIDE) {
                    wanted[e] += 0.01 * beside;
                }
            }
            self.climb(&wanted, x);
        }
    }

    /// Rotates a state so that its inner product with another is maximal; returns this product.
    fn climb(&self, wanted: &DVector<f64>, x: &mut [f64]) -> f64 {
        let product = |x: &[f64]| -> f64 { x.iter().zip(wanted.iter()).map(|(x, w)| x * w).sum() };
        for quaternion in &self.quaternions {
            if quaternion.iter().map(|&e| x[e] * wanted[e]).sum::<f64>() < 0.0 {
                for &e in quaternion {
                    x[e] = -x[e];
                }
            }
        }
        for _ in 0..MOST_STEPS {
            let directions = self.directions(x);
            let slopes = directions.tr_mul(wanted);
            let (slope, here) = (slopes.norm_squared(), product(x));
            let length = (&directions * &slopes).norm();
            if slope.sqrt() <= ROUNDING || length <= 0.0 {
                break;
            }
            // For a single rotation the product is a sine of its angle.
            let rate = length / (self.quaternions.len() as f64).sqrt();
            let mut by = (slope / rate).atan2(here) / rate;
            let mut turned = x.to_vec();
            for _ in 0..20 {
                turned.copy_from_slice(x);
                self.rotate_by(&(&slopes * by), &mut turned);
                if product(&turned) >= here - f64::EPSILON {
                    break;
                }
                by *= 0.5;
            }
            x.copy_from_slice(&turned);
        }
        product(x)
    }
}

/// Directions, with their singular values.
struct Along {
    directions: DMatrix<f64>,
    singular: Singular<f64>,
    rank: usize,
}

impl Along {
    fn of(directions: DMatrix<f64>) -> Self {
        let singular = Singular::of(&directions);
        Self {
            rank: singular.rank(SAME_DIRECTION),
            singular,
            directions,
        }
    }

    /// Coefficients with which the directions come nearest to a vector.
    fn coefficients(&self, vector: &DVector<f64>) -> DVector<f64> {
        self.singular.solve(vector, self.rank)
    }
}
