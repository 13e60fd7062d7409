//! Base parameters: the combinations of parameters that occur in the equations at all (M. Gautier,
//! *Numerical calculation of the base inertial parameters of robots*, 1991).

use nalgebra::{DMatrix, DVector};

/// Base parameters, and the combinations of the others that they include.
#[derive(Debug, Clone, PartialEq)]
pub struct BaseParameters {
    /// Columns that are independent of each other, in the order in which they were found.
    pub independent: Vec<usize>,
    /// The other columns.
    pub dependent: Vec<usize>,
    /// Regressors of the dependent columns are those of the independent ones times these: a row for
    /// each independent column. Base parameter i is `p_i + Σ combinations[(i, j)] p_j`.
    pub combinations: DMatrix<f64>,
}

impl BaseParameters {
    /// Of regressors at many moments. A column counts as dependent on those before it if its remainder is less
    /// than the fraction `part` of it, such as 1e-8.
    pub fn of(regressors: &DMatrix<f64>, part: f64) -> Self {
        let mut directions: Vec<DVector<f64>> = Vec::new();
        let (mut independent, mut open) = (Vec::new(), Vec::new());
        for (place, column) in regressors.column_iter().enumerate() {
            let length = column.norm();
            let mut rest = column.into_owned();
            // Orthogonalised twice, which is enough (W. Kahan).
            for direction in directions.iter().chain(&directions) {
                rest.axpy(-direction.dot(&rest), direction, 1.0);
            }
            if rest.norm() > part * length {
                directions.push(rest.normalize());
                independent.push(place);
            } else {
                open.push(place);
            }
        }
        if independent.is_empty() {
            return Self {
                combinations: DMatrix::zeros(0, open.len()),
                dependent: open,
                independent,
            };
        }
        let basis = regressors.select_columns(&independent);
        let others = regressors.select_columns(&open);
        let qr = basis.qr();
        let right = qr.q().tr_mul(&others);
        let combinations = qr.r().solve_upper_triangular(&right).unwrap_or(right);
        Self {
            independent,
            dependent: open,
            combinations,
        }
    }
}
