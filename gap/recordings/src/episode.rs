//! Episodes: runs that one file holds, told apart by a column.

use std::ops::RangeInclusive;
use std::path::Path;

use crate::DataError;

/// Names of the column with the number of the episode of each row.
const COLUMNS: [&str; 2] = ["episode_index", "episode"];

/// Whether a column has the number of the episode of each row.
pub(crate) fn is_episode(column: &str) -> bool {
    COLUMNS.contains(&column)
}

/// The column of the episodes.
pub(crate) fn column(names: &[String], file: &str) -> Result<usize, DataError> {
    let found = names.iter().position(|name| is_episode(name));
    let message = "an episode of the file is asked for, but it has no column `episode_index`";
    found.ok_or_else(|| DataError::whole(file, message))
}

/// The episode that a cell names.
pub(crate) fn number(cell: f64) -> Option<u64> {
    let is_whole = (0.0..1e15).contains(&cell) && cell.fract() == 0.0;
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "it is whole, not negative and not large"
    )]
    is_whole.then_some(cell as u64)
}

/// The file of the name of a run, and the episodes of it: `all.parquet#3`, `all.parquet#0-7`. A name of a file that
/// exists has none.
pub(crate) fn split<'n>(folder: &Path, name: &'n str) -> (&'n str, Option<RangeInclusive<u64>>) {
    let Some((file, episodes)) = name.rsplit_once('#') else {
        return (name, None);
    };
    let (first, last) = episodes.split_once('-').unwrap_or((episodes, episodes));
    match (first.parse(), last.parse()) {
        (Ok(first), Ok(last)) if first <= last && !folder.join(name).exists() => {
            (file, Some(first..=last))
        }
        _ => (name, None),
    }
}
