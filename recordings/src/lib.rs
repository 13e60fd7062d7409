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
//! | `manifest.rs`, `fields.rs` | content of `recording.toml`, with positions |
//! | `bare.rs` | files without one: columns with names of the spec; which part is held out |
//! | `format.rs` | a run from a file of any format, by its extension |
//! | `table.rs` | the numbers of a run, in SI and with increasing times |
//! | `csv.rs`, `motive.rs` | CSV line by line; the header of Motive |
//! | `c3d.rs` | points and analog channels of motion capture |
//! | `mcap.rs`, `parquet.rs` | robot logs, columnar tables; with their features |
//! | `clock.rs` | which rows are in order; steps and gaps |
//! | `channel.rs`, `level.rs` | quantity of a column; its noise level |
//! | `set.rs` | a data set |
//! | `run.rs` | a run from its table: inputs held, angles unwrapped |
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
mod c3d;
mod channel;
mod clock;
pub mod csv;
mod error;
pub mod fields;
mod finding;
mod format;
mod level;
pub mod limits;
mod manifest;
#[cfg(feature = "mcap")]
mod mcap;
pub mod motion_capture;
mod motive;
mod noise;
mod observed;
#[cfg(feature = "parquet")]
mod parquet;
mod quantum;
mod rebound;
mod run;
mod set;
mod stretches;
mod table;

use std::path::Path;

pub use bare::read_bare;
pub use channel::{Channel, Measured, Role};
pub use clock::Sampling;
pub use error::DataError;
pub use finding::{Finding, FindingKind};
pub use format::columns_of as columns;
pub use level::{Noise, NoiseSource};
pub use set::{DataSet, Parameter, Part, Run, Spec};

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
    let Manifest {
        spec,
        mechanism,
        description,
        parameters,
        time,
        channels,
        runs,
    } = manifest::read(&file, library, instead)?;
    let mut findings = Vec::new();
    let mut budget = limits::MAX_NUMBERS;
    let mut read_runs = Vec::new();
    let mut errors = Vec::new();
    for (name, part) in runs {
        let path = folder.join(&name);
        match format::read(&path, time.as_ref(), &channels, &mut budget) {
            Ok(table) => {
                let run = run::read(name, part, table, &channels, &mut findings);
                // A stated unit is trusted.
                if time.is_none() {
                    findings.extend(run.sampling.doubt().map(|doubt| doubt.in_run(&run.name)));
                }
                read_runs.push(run);
            }
            Err(error) => errors.push(error),
        }
    }
    if !errors.is_empty() {
        return Err(DataError::several(errors));
    }
    let runs = stretches::uninterrupted(read_runs, &channels, &mut findings);
    let mut set = DataSet {
        spec,
        mechanism,
        description,
        parameters,
        channels,
        runs,
        findings,
    };
    noise::find(&mut set);
    set.tell_what_lacks();
    set.findings.sort_by_key(Finding::order);
    Ok(set)
}
