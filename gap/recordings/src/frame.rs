//! Runs in memory, such as data frames.

use std::path::PathBuf;

use crate::channel::Channel;
use crate::table::{Columns, OwnClock, Table};
use crate::time::Stated;
use crate::{DataError, format};

/// A run in memory: columns of one length in the units of its description, NaN where a value is missing.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Name of the run.
    pub name: String,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Their values.
    pub values: Vec<Vec<f64>>,
}

/// Where a recording is.
#[derive(Clone)]
pub enum Logged<'f> {
    /// In a file.
    File(PathBuf),
    /// In memory.
    Frame(&'f Frame),
}

/// Where a run comes from, and which episode of a file it is.
pub(crate) type Source<'s> = (Logged<'s>, Option<u64>);

impl Logged<'_> {
    /// The name in messages.
    pub(crate) fn name(&self) -> String {
        match self {
            Self::File(path) => path.to_string_lossy().into_owned(),
            Self::Frame(frame) => frame.name.clone(),
        }
    }

    /// The names of the columns.
    pub(crate) fn header(&self) -> Result<Vec<String>, DataError> {
        match self {
            Self::File(path) => format::header(path),
            Self::Frame(frame) => Ok(frame.columns.clone()),
        }
    }

    /// The columns of the channels, and the times.
    pub(crate) fn read(
        &self,
        time: &Stated,
        channels: &[Channel],
        episode: Option<u64>,
        budget: &mut usize,
    ) -> Result<Table, DataError> {
        match self {
            Self::File(path) => format::read(path, time, channels, episode, budget),
            Self::Frame(frame) => {
                let columns = Columns {
                    names: frame.columns.clone(),
                    values: frame.values.clone(),
                    clock: OwnClock::None,
                };
                columns.table(&frame.name, time, channels, None, budget)
            }
        }
    }
}
