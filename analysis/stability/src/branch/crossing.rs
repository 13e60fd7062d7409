//! Branch points, where two solution curves cross, and their tangents.

use nalgebra::{DMatrix, DVector};

use crate::steady::newton::{Equations, weighted, weights};
use appell_spectra::singular::Singular;

/// Newton steps.
const MOST_STEPS: usize = 20;
/// Below this, steps that stop shrinking are rounding.
const STALLED: f64 = 1e-12;
/// Step of differences of second derivatives.
const STEP: f64 = 1e-4;

/// A crossing: the Jacobian loses one more rank than on the curve.
#[derive(Debug, Clone)]
pub(crate) struct Crossing {
    /// The unknowns.
    pub(crate) z: DVector<f64>,
    /// Directions of the two curves, of length 1.
    pub(crate) tangents: [DVector<f64>; 2],
}

/// The equations near a crossing, projected onto independent directions: one fewer than unknowns.
struct Projected<'a> {
    equations: &'a dyn Equations,
    /// Rows: the projection with its weights.
    projection: DMatrix<f64>,
}

impl Projected<'_> {
    fn evaluate(&self, z: &DVector<f64>) -> (DVector<f64>, DMatrix<f64>) {
        let (f, jacobian) = self.equations.evaluate(z);
        (&self.projection * f, &self.projection * jacobian)
    }

    /// Derivative of Jᵀψ, by differences of order four: used only in Newton's method and for
    /// directions.
    fn curvature(&self, z: &DVector<f64>, psi: &DVector<f64>) -> DMatrix<f64> {
        let n = z.len();
        let mut curvature = DMatrix::zeros(n, n);
        for i in 0..n {
            let slope = |steps: f64| {
                let mut z = z.clone();
                z[i] += steps * STEP;
                self.evaluate(&z).1.tr_mul(psi)
            };
            let difference = (slope(1.0) - slope(-1.0)) * 8.0 - (slope(2.0) - slope(-2.0));
            curvature.set_column(i, &(difference / (12.0 * STEP)));
        }
        curvature
    }
}

impl Crossing {
    /// The crossing near a point. There F(z) + μ ψ₀ = 0 and Jᵀψ = 0 for some ψ ≠ 0, which is a
    /// regular system even though J is not (G. Moore, 1980); μ is zero.
    pub(crate) fn near(equations: &dyn Equations, start: &DVector<f64>) -> Option<Self> {
        let (_, jacobian) = equations.evaluate(start);
        let weights = weights(&jacobian);
        let singular = Singular::of(&weighted(&jacobian, &weights).transpose());
        let n = start.len();
        let rows = (n - 1).min(singular.right.ncols());
        // Independent equations: left singular vectors except those of the smallest values.
        let mut projection = singular.right.columns(0, rows).transpose();
        for (mut column, weight) in projection.column_iter_mut().zip(weights.iter()) {
            column *= *weight;
        }
        let projected = Projected {
            equations,
            projection,
        };
        let (mut z, mut mu) = (start.clone(), 0.0);
        let mut psi = DVector::zeros(rows);
        psi[rows - 1] = 1.0;
        let fixed = psi.clone();
        let mut last = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            let (f, jacobian) = projected.evaluate(&z);
            let len = n + 1 + rows;
            let mut matrix = DMatrix::zeros(len, len);
            matrix.view_mut((0, 0), (rows, n)).copy_from(&jacobian);
            matrix.view_mut((0, n), (rows, 1)).copy_from(&fixed);
            let curvature = projected.curvature(&z, &psi);
            matrix.view_mut((rows, 0), (n, n)).copy_from(&curvature);
            matrix
                .view_mut((rows, n + 1), (n, rows))
                .copy_from(&jacobian.transpose());
            matrix
                .view_mut((rows + n, n + 1), (1, rows))
                .copy_from(&fixed.transpose());
            let mut target = DVector::zeros(len);
            target.rows_mut(0, rows).copy_from(&-(f + &fixed * mu));
            target.rows_mut(rows, n).copy_from(&-jacobian.tr_mul(&psi));
            target[rows + n] = 1.0 - fixed.dot(&psi);
            let change = matrix.lu().solve(&target)?;
            z += change.rows(0, n);
            mu += change[n];
            psi += change.rows(n + 1, rows);
            let size = change.norm() / (1.0 + z.norm());
            if !size.is_finite() {
                return None;
            }
            if size < 1e-14 || (size >= 0.5 * last && size < STALLED) {
                return Self::directions(&projected, z, &psi);
            }
            last = size;
        }
        None
    }

    /// The roots α of the quadratic form `ψᵀF″[Σα φ]²` over the two-dimensional kernel of J.
    fn directions(projected: &Projected<'_>, z: DVector<f64>, psi: &DVector<f64>) -> Option<Self> {
        let (_, jacobian) = projected.evaluate(&z);
        let singular = Singular::of(&jacobian);
        let n = z.len();
        let [first, second] = [n - 1, n - 2].map(|k| singular.right.column(k).into_owned());
        let curvature = projected.curvature(&z, psi);
        let form = |a: &DVector<f64>, b: &DVector<f64>| a.dot(&(&curvature * b));
        let (aa, ab, bb) = (
            form(&first, &first),
            0.5 * (form(&first, &second) + form(&second, &first)),
            form(&second, &second),
        );
        let discriminant = ab * ab - aa * bb;
        if discriminant <= 0.0 {
            return None;
        }
        // aa α² + 2 ab α β + bb β² = 0, both roots without cancellation.
        let away = -(ab + discriminant.sqrt().copysign(ab));
        let direction = |alpha: f64, beta: f64| (&first * alpha + &second * beta).normalize();
        Some(Self {
            tangents: [direction(away, aa), direction(bb, away)],
            z,
        })
    }
}
