//! Findings of the paper on its recordings, tested on the simulated rides.

use serde::Deserialize;

use crate::book::claim::Claim;
use crate::book::{Part, Result, computation};
use crate::equations::items;

/// A finding that shows on the simulated rides or does not.
#[derive(Debug, Deserialize)]
pub struct Finding {
    /// Its place in the paper.
    pub place: String,
    /// The statement.
    pub published: String,
    /// Whether it shows.
    pub shows: bool,
}

/// The findings with a known result.
pub fn findings() -> Result<Vec<Finding>> {
    items(include_str!("simulated.toml")).map_err(computation)
}

/// A statement about unpublished recordings, tested on simulated ones. It is expected to show or not
/// as the findings say; otherwise either may be.
pub(super) fn simulated(part: &mut Part, key: &str, ours: &str, shows: bool) -> Result<()> {
    let claim = part.statement(key)?.found(ours, shows);
    let known = findings()?.into_iter();
    let mut known = known
        .filter(|finding| finding.place == claim.place && finding.published == claim.published);
    part.claims.push(Claim {
        as_expected: known.all(|finding| finding.shows == shows),
        note: "on simulated rides".to_owned(),
        ..claim
    });
    Ok(())
}
