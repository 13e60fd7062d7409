//! The contents of `recording.toml`.
//!
//! ```toml
//! mechanism   = "pendulum"                 # a name of the library, or the path of a spec beside this file
//! description = "driven pendulum, encoder at the pivot"
//!
//! [parameters]                             # of this rig; std = tolerance, 0 = known exactly
//! m = { value = 2.04, unit = "kg", std = 0.04 }
//!
//! [channels]                               # every column other than the times
//! theta = { measures = "theta", unit = "deg", noise_std = 0.05 }
//! tau   = { input = "tau", unit = "N m" }  # held to the next row; interpolation = "linear" joins rows by lines, "cubic" by a spline
//! room  = { unit = "K" }                   # recorded, and in no model
//! omega = { measures = "omega", unit = "rpm", unit_checked = true }   # never doubted
//! alpha = { measures = "alpha", unit = "rad", reversed = true }       # positive the other way round
//! slide = { measures = "x", unit = "mm", scale_std = 0.02 }            # the scale of the sensor is known to 2 %
//! motor = { input = "F", unit = "N", gain_std = "10 %" }              # the gain of the actuator
//! clock = { time = true, unit = "ms" }     # the column of the times, where its name does not tell it
//! knee  = { measures = "knee", counts_per_turn = 4096, gear = 9, zero = 2048, scale = -1 }   # of an encoder
//!
//! [runs]
//! fit  = ["run1.csv", "run2.csv"]
//! test = ["run3.csv"]
//!
//! [run."run2.csv"]                         # what differs in a run (differences.rs)
//! payload = { on = "arm", mass = 1.5, at = [0, 0, 0.08] }
//! ```

use std::collections::BTreeMap;
use std::path::Path;

use appell_spec::expr::Span;
use appell_spec::limits::MAX_FILE;
use appell_spec::{Code, Mechanism, did_you_mean, shown};
use toml::de::DeTable;

use crate::channel::Channel;
use crate::channels::channels;
use crate::differences;
use crate::fields::Fields;
use crate::limits::MAX_RUNS;
use crate::named::Named;
use crate::parameters::parameters;
use crate::robot::{self, Robot};
use crate::set::Difference;
use crate::time::Stated;
use crate::{DataError, Library, Parameter, Part, Spec, episode};

/// A description whose names and units fit the mechanism.
pub(crate) struct Manifest {
    pub(crate) spec: Spec,
    pub(crate) robot: Option<Robot>,
    pub(crate) mechanism: Mechanism,
    pub(crate) description: String,
    pub(crate) parameters: Vec<Parameter>,
    pub(crate) time: Stated,
    pub(crate) channels: Vec<Channel>,
    pub(crate) runs: Vec<(String, Part)>,
    /// Of runs that differ from the others.
    pub(crate) differences: BTreeMap<String, Vec<Difference>>,
}

const KEYS: &[&str] = &[
    "mechanism",
    "description",
    "rate",
    "lock",
    "base",
    "parameters",
    "channels",
    "runs",
    differences::SECTION,
];

/// Help where the mechanism is not known.
const NAME_ONE: &str = "name a shipped mechanism, or the path of a spec relative to this file";

/// Reads a description; `instead` replaces the mechanism that it names. `columns` are those of a run.
pub(crate) fn read(
    path: &Path,
    text: &str,
    library: Library<'_>,
    instead: Option<Spec>,
    columns: &dyn Fn(&str) -> Option<Vec<String>>,
) -> Result<Manifest, DataError> {
    let file = path.to_string_lossy();
    let (mut fields, table) = Fields::new(&file, text);
    if fields.is_wrong() {
        return Err(fields.report().into());
    }
    let table = table.get_ref();
    fields.only(table, KEYS);
    let named = fields.string(table, "mechanism");
    let spec = match (instead, named) {
        (Some(spec), _) => Some(spec),
        (None, Some((name, at))) => find(&name, at, path, library, &mut fields)?,
        (None, None) => {
            fields.missing("mechanism", 0..0, NAME_ONE);
            None
        }
    };
    let Some(spec) = spec else {
        return Err(fields.report().into());
    };
    let options = robot::options(&mut fields, table);
    let mut keys = differences::parameter_keys(table);
    keys.extend(differences::keys(table));
    let robot = Robot::read(Path::new(&spec.file), &spec.text, keys, &options)?;
    let (spec, robot) = match robot {
        Some((spec, robot)) => (spec, Some(robot)),
        None => (spec, None),
    };
    let mut mechanism = appell_spec::load(&spec.file, &spec.text)?.mechanism;
    let payloads = differences::payloads(&mut fields, table);
    let (spec, payloads) =
        differences::with_payloads(&mut fields, &payloads, spec, &mechanism, robot.as_ref());
    if !payloads.is_empty() {
        mechanism = appell_spec::load(&spec.file, &spec.text)?.mechanism;
    }
    let description = fields.string(table, "description");
    let named = Named {
        mechanism: &mechanism,
        robot: robot.as_ref(),
    };
    let parameters = parameters(&mut fields, table, named);
    let columns = || columns(&first_run(table)?);
    let (time, channels) = channels(&mut fields, table, named, &columns);
    let runs = runs(&mut fields, table, path.parent().unwrap_or(Path::new("")));
    let differences =
        differences::of_runs(&mut fields, table, named, &parameters, &payloads, &runs);
    if fields.is_wrong() {
        return Err(fields.report().into());
    }
    Ok(Manifest {
        description: description.map_or_else(String::new, |(text, _)| text),
        spec,
        robot,
        mechanism,
        parameters,
        time,
        channels,
        runs,
        differences,
    })
}

/// The name of the first run.
fn first_run(table: &DeTable<'_>) -> Option<String> {
    let runs = table.get("runs")?.get_ref().as_table()?;
    let mut lists = ["fit", "test"].into_iter().filter_map(|key| runs.get(key));
    let list = lists.find_map(|list| list.get_ref().as_array()?.iter().next())?;
    list.get_ref().as_str().map(str::to_owned)
}

/// The spec of a name, or of a path relative to the description.
fn find(
    name: &str,
    at: Span,
    manifest: &Path,
    library: Library<'_>,
    fields: &mut Fields<'_>,
) -> Result<Option<Spec>, DataError> {
    if let Some((_, spec)) = library.iter().find(|(known, _)| *known == name) {
        return Ok(Some(spec.clone()));
    }
    let folder = manifest.parent().unwrap_or(Path::new(""));
    let path = match appell_files::below(folder, name) {
        Ok(path) => path,
        Err(error) => {
            fields.tell(Code::NotAllowedHere, error.to_string(), at, "");
            return Ok(None);
        }
    };
    if path.exists() {
        return Ok(Some(Spec {
            file: path.to_string_lossy().into_owned(),
            text: appell_files::read_text(&path, MAX_FILE as u64)?,
        }));
    }
    let names = || library.iter().map(|(name, _)| *name);
    let help = did_you_mean(name, names(), || NAME_ONE.to_owned());
    let message = format!("there is no mechanism and no file `{}`", shown(name));
    fields.tell(Code::UnknownReference, message, at, &help);
    Ok(None)
}

/// The files of the runs, those to fit first.
fn runs(fields: &mut Fields<'_>, table: &DeTable<'_>, folder: &Path) -> Vec<(String, Part)> {
    let help = "write fit = [\"run1.csv\"] and test = [\"run2.csv\"]";
    let Some(table) = fields.needed_section(table, "runs", help) else {
        return Vec::new();
    };
    fields.only(table, &["fit", "test"]);
    let mut runs: Vec<(String, Part)> = Vec::new();
    for (key, part) in [("fit", Part::Fit), ("test", Part::Test)] {
        for (name, at) in episodes(folder, fields.strings(table, key)) {
            let file = episode::split(folder, &name).0;
            if let Err(error) = appell_files::below(folder, file) {
                fields.tell(Code::NotAllowedHere, error.to_string(), at, "");
            } else if let Some((_, other)) = runs.iter().find(|(other, _)| *other == name) {
                let message = format!("the run `{}` stands here twice", shown(&name));
                let help = if *other == part {
                    "remove one of them"
                } else {
                    "a run that is held out may not be fitted"
                };
                fields.tell(Code::DuplicateName, message, at, help);
            } else if runs.len() == MAX_RUNS {
                let message = format!("a data set has at most {MAX_RUNS} runs");
                fields.tell(Code::LimitExceeded, message, at, "");
                return runs;
            } else {
                runs.push((name, part));
            }
        }
    }
    if !fields.is_wrong() && !runs.iter().any(|(_, part)| *part == Part::Fit) {
        let message = "there is no run to fit";
        let help = "write fit = [\"run1.csv\"]";
        fields.tell(Code::MissingKey, message, 0..0, help);
    }
    runs
}

/// The names of runs, with one for each episode of a range, up to one more than a data set may have.
fn episodes(folder: &Path, names: Vec<(String, Span)>) -> Vec<(String, Span)> {
    let mut all = Vec::new();
    for (name, at) in names {
        match episode::split(folder, &name) {
            (file, Some(episodes)) => {
                let numbers = episodes.take(MAX_RUNS + 1);
                all.extend(numbers.map(|number| (format!("{file}#{number}"), at.clone())));
            }
            (_, None) => all.push((name, at)),
        }
    }
    all
}
