//! *Experimental Model Identification of the Longitudinal Dynamics of an Electric Unicycle with a Human
//! Rider*, on simulated rides: its recordings are not public.
//!
//! | file | part |
//! |---|---|
//! | `tables.rs` | every numbered equation; tables 1 to 3 |
//! | `rider.rs` | the spatial unicycle with a rider, four manoeuvres |
//! | `capture.rs` | captured rigid bodies; noise |
//! | `recorded.rs` | the rides as data sets, for `appell diagnose` |
//! | `sample.rs` | two of them to try commands with |
//! | `laboratory.rs` | all rides, captured and smoothed |
//! | `torque.rs` | M_d,1 and M_d,2, and their difference over the height |
//! | `figure_3.rs`, `figure_6.rs`, `figure_8.rs` | figures 3 and 4, 6 and 7, 8 |
//! | `heights.rs` | the height with its interval |

mod capture;
mod figure_3;
mod figure_6;
mod figure_8;
mod heights;
mod laboratory;
mod recorded;
mod rider;
pub mod sample;
mod tables;
mod torque;

use std::path::Path;

use serde::Deserialize;

use super::claim::Claim;
use super::{Part, Result, Section, computation, failed, made};
use crate::equations::items;
use laboratory::{Laboratory, Session};
use rider::Manoeuvre;

/// What makes a section, from a laboratory of any lifetime.
type Make = fn(&Laboratory) -> Result<Section>;

/// Parts with their names for progress messages.
const PARTS: &[(&str, Make)] = &[
    ("equations", tables::equations),
    ("tables", tables::section),
    ("figures 3 and 4", figure_3::section),
    ("figures 6 and 7", figure_6::section),
    ("figure 8", figure_8::section),
    ("heights", heights::section),
];

/// The book part by part; `making` is called with the current part and the progress. The rides are
/// written to a folder, as recordings.
pub fn book(rides: &Path, mut making: impl FnMut(&str, usize, usize)) -> Result<Vec<Section>> {
    making("rides", 0, PARTS.len() + 1);
    let laboratory = Laboratory::new()?;
    recorded::write(&laboratory, rides)?;
    made(PARTS, &laboratory, 1, making)
}

impl Laboratory {
    fn session(&self, manoeuvre: Manoeuvre) -> Result<&Session> {
        let mut sessions = self.sessions.iter();
        let found = sessions.find(|session| session.manoeuvre == manoeuvre);
        found.ok_or_else(|| failed("the manoeuvre was not ridden"))
    }
}

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
    items(include_str!("euc/simulated.toml")).map_err(computation)
}

/// A statement about unpublished recordings, tested on simulated ones. It is expected to show or not
/// as the findings say; otherwise either may be.
fn simulated(part: &mut Part, key: &str, ours: &str, shows: bool) -> Result<()> {
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
