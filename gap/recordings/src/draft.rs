//! A draft of a description from recordings without one: which column is which quantity of the mechanism, units,
//! signs, noise, runs to hold out; and questions about what the recordings do not tell.
//!
//! ```text
//! files      --log------> columns, times
//! mechanism  --quantities-> joints, rates, torques, commands
//! both       --bound----> a quantity for each column, by names (words), numbers, motion (evidence)
//!            --judged---> units and signs
//!            --text-----> recording.toml
//! ```

mod bound;
mod evidence;
mod judged;
mod log;
mod quantities;
mod text;
mod words;

use std::path::Path;

use appell_robots::Options;

use self::judged::Judged;
use self::log::{Clock, Log};
use self::quantities::{Quantity, quantities};
use self::text::Content;
use self::words::Kind;
use crate::limits::MAX_RUNS;
use crate::robot::Robot;
use crate::{DataError, DataSet, FindingKind, Logged, Spec, assemble, episode, manifest};

/// What a description is drafted from.
pub struct Draft<'d> {
    /// The mechanism: a spec or a robot file.
    pub mechanism: Spec,
    /// Its name, or its path relative to the description.
    pub named: String,
    /// The recordings: their names, of files their paths relative to the description, and where they are.
    pub runs: &'d [(String, Logged<'d>)],
    /// Rows per second, where no column is the time.
    pub rate_hz: Option<f64>,
}

/// A drafted description.
pub struct Drafted {
    /// The text of `recording.toml`.
    pub text: String,
    /// What the recordings do not tell, a sentence each.
    pub questions: Vec<String>,
    /// The data set that it describes, unless it lacks an answer.
    pub set: Option<DataSet>,
}

impl Draft<'_> {
    /// Drafts a description for the file `path`.
    pub fn write(&self, path: &Path) -> Result<Drafted, DataError> {
        if self.runs.len() > MAX_RUNS {
            let message = format!("a data set has at most {MAX_RUNS} runs");
            return Err(DataError::whole(path.to_string_lossy(), message));
        }
        let spec = &self.mechanism;
        let options = Options {
            actuators: true,
            ..Options::default()
        };
        let path_of_robot = Path::new(&spec.file);
        let robot = Robot::read(path_of_robot, &spec.text, text::patterns(), &options)?;
        let (spec, robot) = match robot {
            Some((spec, robot)) => (spec, Some(robot)),
            None => (spec.clone(), None),
        };
        let mechanism = appell_spec::load(&spec.file, &spec.text)?.mechanism;
        let quantities = quantities(&mechanism, robot.as_ref());
        let log = Log::read(self.runs, self.rate_hz)?;
        let columns = log.columns();
        let bound = bound::bind(&log, &columns, &quantities);
        let channels = judged::judge(&log, &bound, &quantities);
        let mut measured = channels.iter().map(|own| quantities[own.quantity].kind);
        if !measured.any(|kind| kind != Kind::Command) {
            return Err(self.foreign(&quantities));
        }
        let others = others(&log, &columns, &channels);
        let mut questions = questions(&log, &channels, &others);
        questions.extend(lacking(&quantities, &channels));
        let held_out = match log.named.len() {
            1 => 0,
            count => (count + 1) / 3,
        };
        let (fit, test) = log.named.split_at(log.named.len() - held_out);
        let mut content = Content {
            mechanism: &self.named,
            names: &mechanism,
            robot: robot.as_ref(),
            log: &log,
            quantities: &quantities,
            channels: &channels,
            others: &others,
            noise: vec![None; channels.len()],
            fit,
            test,
        };
        let has_units = channels.iter().all(|channel| channel.unit.is_some());
        let set = if has_units && !matches!(log.clock, Clock::Unknown) {
            let set = self.read(path, &content.text())?;
            let columns = channels.iter().map(|channel| &log.names[channel.column]);
            content.noise = columns.map(|column| level(&set, column)).collect();
            Some(self.read(path, &content.text())?)
        } else {
            None
        };
        Ok(Drafted {
            text: content.text(),
            questions,
            set,
        })
    }

    /// The data set of a text.
    fn read(&self, path: &Path, text: &str) -> Result<DataSet, DataError> {
        let mechanism = Some(self.mechanism.clone());
        let manifest = manifest::read(path, text, &[], mechanism, &|_| None)?;
        assemble(manifest, |name| {
            let (file, episodes) = episode::split(path.parent()?, name);
            let (_, logged) = self.runs.iter().find(|(own, _)| own == file)?;
            let episode = episodes.map(|episodes| *episodes.start());
            Some((logged.clone(), episode))
        })
    }

    /// The error of recordings without any name of the mechanism.
    fn foreign(&self, quantities: &[Quantity]) -> DataError {
        let names: Vec<&str> = quantities.iter().map(|own| own.name.as_str()).collect();
        let message = format!(
            "no column has a name like one of the mechanism, {}; rename columns, or write the description by hand",
            names.join(", ")
        );
        let first = self.runs.first().map_or("", |(name, _)| name);
        DataError::whole(first, message)
    }
}

/// Columns that are no quantity. A log may have a joint by its name and by its number.
fn others(log: &Log, columns: &[usize], channels: &[Judged]) -> Vec<usize> {
    let is_known = |column: &usize| {
        let mut bound = channels.iter();
        bound.any(|own| own.column == *column || log.column(own.column).eq(log.column(*column)))
    };
    let others = columns.iter().copied();
    others.filter(|column| !is_known(column)).collect()
}

/// The noise level that the data tell of a column, in its unit.
fn level(set: &DataSet, column: &str) -> Option<f64> {
    let channel = set.channels.iter().find(|own| own.column == column)?;
    let is_bound = set.findings.iter().any(|finding| {
        finding.kind == FindingKind::NoiseBound && finding.channel.as_deref() == Some(column)
    });
    let found = channel.noise.filter(|_| !is_bound)?.found?;
    Some(channel.unit.from_si(found))
}

/// A question for each command without a column.
fn lacking(quantities: &[Quantity], channels: &[Judged]) -> Vec<String> {
    let lacks = |(index, own): &(usize, &Quantity)| {
        own.kind == Kind::Command && !channels.iter().any(|known| known.quantity == *index)
    };
    let lacking = quantities.iter().enumerate().filter(lacks);
    let asked = lacking.map(|(_, own)| {
        let name = &own.name;
        format!("no column is the command `{name}`, so zero is taken; is there one?")
    });
    asked.collect()
}

/// All questions, with the columns that they are about. One that is asked of several columns is asked once.
fn questions(log: &Log, channels: &[Judged], others: &[usize]) -> Vec<String> {
    let mut asked: Vec<(String, Vec<String>)> = Vec::new();
    match &log.clock {
        Clock::Column {
            question: Some(question),
            ..
        } => asked.push((question.clone(), Vec::new())),
        Clock::Unknown => asked.push((
            "no column is the time: how many rows are there per second?".to_owned(),
            Vec::new(),
        )),
        _ => {}
    }
    for channel in channels {
        let name = &log.names[channel.column];
        for question in &channel.questions {
            match asked.iter_mut().find(|(own, _)| own == question) {
                Some((_, names)) => names.push(name.clone()),
                None => asked.push((question.clone(), vec![name.clone()])),
            }
        }
    }
    if !others.is_empty() {
        let names = others.iter().map(|&column| log.names[column].clone());
        let question = "no quantity has a name like these; are they in no model?";
        asked.push((question.to_owned(), names.collect()));
    }
    let line = |(question, names): (String, Vec<String>)| match &names[..] {
        [] => question,
        names => format!("{}: {question}", names.join(", ")),
    };
    asked.into_iter().map(line).collect()
}
