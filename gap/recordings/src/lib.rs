//! Recordings of real mechanisms: values in SI at increasing times, bound to the names of a spec, each
//! channel with its noise level, with findings on repairs and doubts.
//!
//! A data set is a folder with `recording.toml` and a file for each run, or such files alone.
//! [`motion_capture`] makes one of a capture of rigid bodies.
//!
//! ```text
//! recording.toml --manifest--> mechanism, parameters, channels, runs
//! run.csv, …     --table----> rows, --clock--> increasing times, --channel--> SI, whole angles
//! runs           --noise----> noise level of each channel
//! ```
//!
//! | file | idea |
//! |---|---|
//! | `manifest.rs`, `parameters.rs`, `differences.rs`, `fields.rs` | content of `recording.toml`, with positions |
//! | `channels.rs`, `column.rs` | its channels: patterns; a line with unit and scale |
//! | `bare.rs` | files without one: columns with names of the spec; which part is held out |
//! | `format.rs` | a run from a file of any format, by its extension |
//! | `frame.rs` | runs in memory |
//! | `table.rs` | the numbers of a run, in SI and with increasing times |
//! | `csv.rs`, `motive.rs` | CSV line by line; the header of Motive |
//! | `c3d.rs`, `npz.rs` | points and analog channels of motion capture; arrays of `numpy` |
//! | `episode.rs` | several runs in one file |
//! | `mcap.rs`, `topics.rs`, `parquet.rs` | robot logs, columnar tables; with their features |
//! | `time.rs` | the column of the times and its unit |
//! | `clock.rs` | which rows are in order; steps and gaps |
//! | `channel.rs`, `level.rs` | quantity of a column; its noise level |
//! | `between.rs` | inputs between rows |
//! | `draft.rs` | a description from recordings without one |
//! | `set.rs`, `judged.rs` | a data set; what it lacks, once it is read |
//! | `run.rs`, `jumps.rs` | a run from its table: inputs held, angles unwrapped; jumps |
//! | `quantum.rs`, `noise.rs` | resolution of a sensor; noise level, stated and estimated |
//! | `observed.rs` | the runs as recordings for estimation |
//! | `rebound.rs` | the same recordings for another spec |
//! | `stretches.rs` | subsampling of long recordings |
//! | `finding.rs`, `error.rs` | repairs and warnings; errors |
//! | `limits.rs` | limits of the size of a data set |
//!
//! Results do not depend on the units of the files. Test runs do not affect noise levels or other
//! computed values; findings about them concern their form.

mod bare;
pub mod between;
mod c3d;
mod channel;
mod channels;
mod clock;
mod column;
pub mod csv;
mod differences;
mod draft;
mod episode;
mod error;
pub mod fields;
mod finding;
mod format;
mod frame;
mod judged;
mod jumps;
mod level;
pub mod limits;
mod manifest;
#[cfg(feature = "mcap")]
mod mcap;
pub mod motion_capture;
mod motive;
mod named;
mod noise;
mod npz;
mod observed;
mod parameters;
#[cfg(feature = "parquet")]
mod parquet;
mod quantum;
mod rebound;
mod robot;
mod run;
mod set;
mod stretches;
mod table;
mod time;
mod topics;

use std::path::Path;

pub use bare::{read_bare, read_bare_frames};
pub use channel::{Channel, Measured, Role};
pub use clock::Sampling;
pub use draft::{Draft, Drafted};
pub use error::DataError;
pub use finding::{Finding, FindingKind};
pub use format::columns_of as columns;
pub use frame::{Frame, Logged};
pub use level::{Noise, NoiseSource};
pub use robot::Robot;
pub use set::{DataSet, Difference, Parameter, Part, Reading, Row, Run, Spec};

use frame::Source;
use manifest::Manifest;

/// Name of the file that describes a data set.
pub const MANIFEST: &str = "recording.toml";

/// Specs that can be referred to by name, without a path.
pub type Library<'l> = &'l [(&'l str, Spec)];

/// Reads a data set: a folder with a `recording.toml`, or the path of such a file. `instead` replaces
/// the mechanism that the file names.
pub fn read(
    path: &Path,
    library: Library<'_>,
    instead: Option<Spec>,
) -> Result<DataSet, DataError> {
    let file = if path.is_dir() {
        path.join(MANIFEST)
    } else {
        path.to_owned()
    };
    if path.is_dir() && !file.exists() {
        return Err(DataError::NoManifest {
            folder: path.to_owned(),
        });
    }
    let folder = file.parent().unwrap_or(Path::new(""));
    let text = appell_files::read_text(&file, appell_spec::limits::MAX_FILE as u64)?;
    let columns = |run: &str| format::header(&folder.join(episode::split(folder, run).0)).ok();
    let manifest = manifest::read(&file, &text, library, instead, &columns)?;
    assemble(manifest, |name| {
        let (file, episodes) = episode::split(folder, name);
        let episode = episodes.map(|episodes| *episodes.start());
        Some((Logged::File(folder.join(file)), episode))
    })
}

/// A data set whose runs are in memory, from the text of a `recording.toml`, whose `[runs]` name them. `file` is the
/// path of that text, or a name for messages.
pub fn read_frames(
    file: &Path,
    text: &str,
    frames: &[Frame],
    library: Library<'_>,
    instead: Option<Spec>,
) -> Result<DataSet, DataError> {
    let frame = |name: &str| frames.iter().find(|frame| frame.name == name);
    let columns = |run: &str| frame(run).map(|frame| frame.columns.clone());
    let manifest = manifest::read(file, text, library, instead, &columns)?;
    assemble(manifest, |name| Some((Logged::Frame(frame(name)?), None)))
}

/// The data set of a description, with the source of each run.
fn assemble<'s>(
    manifest: Manifest,
    source: impl Fn(&str) -> Option<Source<'s>>,
) -> Result<DataSet, DataError> {
    let Manifest {
        spec,
        robot,
        mechanism,
        description,
        parameters,
        time,
        mut channels,
        runs,
        mut differences,
    } = manifest;
    let mut findings = Vec::new();
    let sources = runs.into_iter().map(|(name, part)| {
        let source = source(&name);
        (name, part, source)
    });
    let mut runs = run::read_all(sources, &time, &channels, &mut findings)?;
    for run in &mut runs {
        run.differences = differences.remove(&run.name).unwrap_or_default();
    }
    if let Some(robot) = &robot {
        robot.drive(&mut runs, &mut channels, &mechanism);
    }
    let set = DataSet {
        reading: Reading::default(),
        spec,
        robot,
        mechanism,
        description,
        parameters,
        channels,
        runs,
        findings,
    };
    Ok(set.judged())
}
