//! Linear equations: which say something new, and which unknowns follow from the others.

/// A row shorter than this share of itself, less what others say, adds nothing.
const NOTHING: f64 = 1e-5;

fn largest(row: &[f64]) -> f64 {
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

/// Which rows do not follow from those before them.
pub(crate) fn independent(rows: Vec<Vec<f64>>) -> Vec<bool> {
    let mut known: Vec<(usize, Vec<f64>)> = Vec::new();
    let says_more = |mut row: Vec<f64>| {
        let whole = largest(&row).max(NOTHING);
        for (pivot, other) in &known {
            subtract(&mut row, *pivot, other);
        }
        let columns = 0..row.len();
        let pivot = columns.max_by(|&a, &b| row[a].abs().total_cmp(&row[b].abs()));
        let pivot = pivot.filter(|&pivot| row[pivot].abs() > NOTHING * whole);
        known.extend(pivot.map(|pivot| (pivot, row)));
        pivot.is_some()
    };
    rows.into_iter().map(says_more).collect()
}

/// A pivot for each row, by complete pivoting, and the rows reduced so that each alone has its pivot, whose entry is 1.
///
/// Rows with a preferred pivot take it as long as it is there; among the other columns weights count, and one without a
/// weight is the last choice. There is no result where a row has no pivot.
pub(crate) fn eliminated(
    mut rows: Vec<Vec<f64>>,
    preferred: &[Option<usize>],
    weights: &[f64],
) -> Option<(Vec<usize>, Vec<Vec<f64>>)> {
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
                    if best.is_none_or(|(most, could, ..)| (can, worth) > (could, most)) {
                        best = Some((worth, can, row, column));
                    }
                }
            }
            best.map(|(.., row, column)| (row, column))
        };
        let (row, column) = wanted.or_else(best)?;
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
    Some((pivots.into_iter().flatten().collect(), rows))
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

/// Gives a row a pivot, of which another row may have to let go.
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

    #[test]
    fn rows_that_follow_from_others_are_found() {
        let rows = vec![
            vec![1.0, 2.0, 0.0],
            vec![0.0, 1.0, 1.0],
            vec![2.0, 5.0, 1.0],
            vec![0.0, 0.0, 0.0],
            vec![0.0, 0.0, 3.0],
        ];
        assert_eq!(independent(rows), [true, true, false, false, true]);
    }

    #[test]
    fn the_largest_pivots_are_chosen_and_wishes_granted() {
        let rows = || vec![vec![1e-7, 1.0, 0.3], vec![1e-7, 0.9, 0.5]];
        let (pivots, reduced) = eliminated(rows(), &[None, None], &[1.0; 3]).expect("pivots");
        assert_eq!(pivots, [1, 2]);
        assert!(
            (reduced[0][0] - 5e-8 / 0.23 * 0.8).abs() < 1e-7,
            "{reduced:?}"
        );
        let (pivots, _) = eliminated(rows(), &[None, Some(1)], &[1.0; 3]).expect("pivots");
        assert_eq!(pivots, [2, 1]);
        let (pivots, _) = eliminated(rows(), &[None, None], &[1.0, 0.0, 1.0]).expect("pivots");
        assert_eq!(
            pivots,
            [1, 2],
            "a column without a weight where no other is left"
        );
        assert!(eliminated(vec![vec![0.0; 2]], &[None], &[1.0; 2]).is_none());
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
