//! *Experimental Model Identification of the Longitudinal Dynamics of an Electric Unicycle with a Human
//! Rider*, on simulated rides: its recordings are not public.
//!
//! | file | part |
//! |---|---|
//! | `tables.rs` | every numbered equation; tables 1 to 3 |
//! | `rider.rs` | the spatial unicycle with a rider, four manoeuvres |
//! | `capture.rs`, `random.rs` | captured rigid bodies; noise |
//! | `recorded.rs` | the rides as data sets, for `appell diagnose` |
//! | `sample.rs` | two of them to try commands with |
//! | `laboratory.rs` | all rides, captured and smoothed |
//! | `torque.rs` | M_d,1 and M_d,2, and their difference over the height |
//! | `figure_3.rs`, `figure_6.rs`, `figure_8.rs` | figures 3 and 4, 6 and 7, 8 |
//! | `heights.rs` | the height with its interval |
//! | `simulated.rs` | findings of the paper on the simulated rides |

mod capture;
mod figure_3;
mod figure_6;
mod figure_8;
mod heights;
mod laboratory;
mod random;
mod recorded;
mod rider;
pub mod sample;
mod simulated;
mod tables;
mod torque;

use std::path::Path;

use laboratory::{Laboratory, Session};
use rider::Manoeuvre;
pub use simulated::{Finding, findings};

use super::{Result, Section, failed};

/// A part of the book: its name for progress messages, and its function.
type Part = (&'static str, fn(&Laboratory) -> Result<Section>);

const PARTS: &[Part] = &[
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
    let all = PARTS.len() + 1;
    making("rides", 0, all);
    let laboratory = Laboratory::new()?;
    recorded::write(&laboratory, rides)?;
    let part = |(number, (name, make)): (usize, &Part)| {
        making(name, number + 1, all);
        make(&laboratory)
    };
    PARTS.iter().enumerate().map(part).collect()
}

impl Laboratory {
    fn session(&self, manoeuvre: Manoeuvre) -> Result<&Session> {
        let mut sessions = self.sessions.iter();
        let found = sessions.find(|session| session.manoeuvre == manoeuvre);
        found.ok_or_else(|| failed("the manoeuvre was not ridden"))
    }
}
