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
//! | `simulated.rs` | findings of the paper, tested on the rides |
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
mod simulated;
mod tables;
mod torque;

use std::path::Path;

use super::{Result, Section, failed, made};
use laboratory::{Laboratory, Session};
use rider::Manoeuvre;

pub use simulated::{Finding, findings};

/// A function that makes a section from a laboratory.
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
