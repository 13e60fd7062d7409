//! Readable bases of subspaces.

use nalgebra::{ComplexField, DMatrix};

/// Smallest pivot, relative to the largest entry.
const PIVOT: f64 = 1e-4;

/// The reduced row echelon form of independent rows: each row has a 1 where the others have 0, and
/// rounding becomes 0. Columns are states; the first ones are eliminated, so that relations
/// give speeds in terms of coordinates.
pub(super) fn row_echelon<T>(mut rows: DMatrix<T>, negligible: f64) -> DMatrix<T>
where
    T: ComplexField<RealField = f64>,
{
    for lead in 0..rows.nrows() {
        let sizes = |column: usize| {
            let below = rows.view_range(lead.., column);
            below
                .iter()
                .map(|entry| entry.clone().modulus())
                .collect::<Vec<f64>>()
        };
        let largest = |column: usize| sizes(column).into_iter().fold(0.0, f64::max);
        let overall = (0..rows.ncols()).map(largest).fold(0.0, f64::max);
        // The first column that is not tiny: rows stay independent.
        let Some(column) = (0..rows.ncols()).find(|&column| largest(column) > PIVOT * overall)
        else {
            break;
        };
        let sizes = sizes(column).into_iter().enumerate();
        let pivot = sizes.max_by(|a, b| a.1.total_cmp(&b.1));
        rows.swap_rows(lead, lead + pivot.map_or(0, |(place, _)| place));
        let leading = rows.row(lead) / rows[(lead, column)].clone();
        rows.set_row(lead, &leading);
        for other in (0..rows.nrows()).filter(|&other| other != lead) {
            let factor = rows[(other, column)].clone();
            let reduced = rows.row(other) - &leading * factor;
            rows.set_row(other, &reduced);
        }
    }
    rows.map(|entry| {
        let rounding = entry.clone().modulus() <= negligible;
        if rounding { T::zero() } else { entry }
    })
}
