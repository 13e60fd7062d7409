//! Systems of linear equations: selection of independent equations and of dependent unknowns.

/// A row is linearly dependent if elimination reduces it below this fraction of its size.
const NOTHING: f64 = 1e-5;
/// Ratio by which a pivot must exceed an earlier candidate, so that rounding does not decide.
const ALIKE: f64 = 1.001;

/// The largest magnitude.
pub(crate) fn largest(row: &[f64]) -> f64 {
    row.iter().fold(0.0_f64, |most, x| most.max(x.abs()))
}

fn subtract(row: &mut [f64], pivot: usize, other: &[f64]) {
    let factor = row[pivot] / other[pivot];
    if factor != 0.0 {
        for (entry, other) in row.iter_mut().zip(other) {
            *entry -= factor * other;
        }
        row[pivot] = 0.0;
    }
}

/// An independent row in reduced echelon form: its pivot entry is 1, and the other rows have zeros there.
#[derive(Debug)]
pub(crate) struct Reduced {
    pub(crate) row: usize,
    pub(crate) pivot: usize,
    pub(crate) entries: Vec<f64>,
}

/// The linearly independent rows, by complete pivoting, in their order.
///
/// A row gets its preferred pivot if that is not negligible. Otherwise entries are compared after scaling by the
/// weights of their columns; columns of weight 0 come last. Among equal pivots the first is chosen.
pub(crate) fn eliminated(
    mut rows: Vec<Vec<f64>>,
    preferred: &[Option<usize>],
    weights: &[f64],
) -> Vec<Reduced> {
    let lengths: Vec<f64> = rows.iter().map(|row| largest(row).max(NOTHING)).collect();
    let mut pivots: Vec<Option<usize>> = vec![None; rows.len()];
    let mut taken = vec![false; weights.len()];
    for _ in 0..rows.len() {
        let share = |row: usize, column: usize| rows[row][column].abs() / lengths[row];
        let open = || (0..rows.len()).filter(|&row| pivots[row].is_none());
        let wanted = open().find_map(|row| {
            let column = preferred[row]?;
            (!taken[column] && share(row, column) > NOTHING).then_some((row, column))
        });
        let best = || {
            let mut best: Option<(f64, bool, usize, usize)> = None;
            for row in open() {
                for (column, &weight) in weights.iter().enumerate() {
                    let share = share(row, column);
                    if share <= NOTHING || taken[column] {
                        continue;
                    }
                    let can = weight > 0.0;
                    let worth = share * if can { weight } else { 1.0 };
                    let is_better = |(most, could, ..): (f64, bool, usize, usize)| {
                        (can, worth) > (could, if can == could { ALIKE * most } else { most })
                    };
                    if best.is_none_or(is_better) {
                        best = Some((worth, can, row, column));
                    }
                }
            }
            best.map(|(.., row, column)| (row, column))
        };
        let Some((row, column)) = wanted.or_else(best) else {
            break;
        };
        pivots[row] = Some(column);
        taken[column] = true;
        let factor = rows[row][column];
        let own: Vec<f64> = rows[row].iter().map(|entry| entry / factor).collect();
        for (index, other) in rows.iter_mut().enumerate() {
            if index != row {
                subtract(other, column, &own);
            }
        }
        rows[row] = own;
    }
    let each = rows.into_iter().zip(pivots).enumerate();
    let reduced = each.filter_map(|(row, (entries, pivot))| {
        Some(Reduced {
            row,
            pivot: pivot?,
            entries,
        })
    });
    reduced.collect()
}

/// The pivots in another order, in which each row has an entry at its own: there is one where the pivots determine all
/// unknowns (augmenting paths: Kuhn, *Naval Research Logistics Quarterly* 2, 1955).
pub(crate) fn matched(rows: &[&Vec<f64>], pivots: &[usize]) -> Vec<usize> {
    let has = |row: usize, pivot: usize| {
        rows[row][pivots[pivot]].abs() > NOTHING * largest(rows[row]).max(NOTHING)
    };
    let mut owner: Vec<Option<usize>> = (0..pivots.len())
        .map(|index| has(index, index).then_some(index))
        .collect();
    for row in (0..rows.len()).filter(|&row| !has(row, row)) {
        let mut seen = vec![false; pivots.len()];
        give(row, &has, &mut owner, &mut seen);
    }
    let mut matched = pivots.to_vec();
    for (pivot, owner) in owner.iter().enumerate() {
        if let Some(row) = owner {
            matched[*row] = pivots[pivot];
        }
    }
    matched
}

/// Assigns a pivot to a row along an augmenting path: another row may have to take a different pivot.
fn give(
    row: usize,
    has: &dyn Fn(usize, usize) -> bool,
    owner: &mut [Option<usize>],
    seen: &mut [bool],
) -> bool {
    for pivot in 0..owner.len() {
        if seen[pivot] || !has(row, pivot) {
            continue;
        }
        seen[pivot] = true;
        if owner[pivot].is_none_or(|other| give(other, has, owner, seen)) {
            owner[pivot] = Some(row);
            return true;
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pivots(
        rows: Vec<Vec<f64>>,
        preferred: &[Option<usize>],
        weights: &[f64],
    ) -> Vec<(usize, usize)> {
        let reduced = eliminated(rows, preferred, weights);
        reduced.iter().map(|one| (one.row, one.pivot)).collect()
    }

    #[test]
    fn rows_that_follow_from_others_are_left_out() {
        let rows = vec![
            vec![1.0, 2.0, 0.0],
            vec![0.0, 1.0, 1.0],
            vec![2.0, 5.0, 1.0],
            vec![0.0, 0.0, 0.0],
            vec![0.0, 0.0, 3.0],
        ];
        let found = pivots(rows, &[None; 5], &[1.0; 3]);
        assert_eq!(found.len(), 3);
        assert!(found.iter().all(|(row, _)| *row != 3), "{found:?}");
        assert!(pivots(vec![vec![0.0; 2]], &[None], &[1.0; 2]).is_empty());
    }

    #[test]
    fn the_largest_pivots_are_chosen_and_wishes_granted() {
        let rows = || vec![vec![1e-7, 1.0, 0.3], vec![1e-7, 0.9, 0.5]];
        let reduced = eliminated(rows(), &[None, None], &[1.0; 3]);
        assert_eq!((reduced[0].pivot, reduced[1].pivot), (1, 2));
        assert!(
            (reduced[0].entries[0] - 5e-8 / 0.23 * 0.8).abs() < 1e-7,
            "{reduced:?}"
        );
        assert_eq!(
            pivots(rows(), &[None, Some(1)], &[1.0; 3]),
            [(0, 2), (1, 1)]
        );
        assert_eq!(
            pivots(rows(), &[None, None], &[1.0, 0.0, 1.0]),
            [(0, 1), (1, 2)],
            "a column without a weight where no other is left"
        );
        let small = vec![vec![1.0, 0.1], vec![0.001, 1.0], vec![1.0, 0.1001]];
        assert_eq!(pivots(small, &[None; 3], &[1.0; 2]), [(0, 0), (1, 1)]);
    }

    #[test]
    fn each_row_gets_a_pivot_that_it_has() {
        let rows = [
            vec![1.0, 2.0, 0.0],
            vec![0.0, 1.0, 1.0],
            vec![0.0, 0.5, 0.0],
        ];
        let rows: Vec<&Vec<f64>> = rows.iter().collect();
        assert_eq!(matched(&rows, &[1, 2, 0]), [0, 2, 1]);
        assert_eq!(matched(&rows, &[0, 2, 1]), [0, 2, 1]);
    }
}
