//! A study with its statistics.

use appell_ensemble::rows::Column;
use appell_ensemble::summary::Summary;

/// Subject of a report.
#[derive(Debug, Clone, Copy)]
pub struct About<'a> {
    /// Its title.
    pub title: &'a str,
    /// The study file.
    pub study: &'a str,
    /// The columns of the rows.
    pub columns: &'a [Column],
    /// Their statistics.
    pub summary: &'a Summary,
}
