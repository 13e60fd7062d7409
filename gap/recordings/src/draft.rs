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

use std::path::{Path, PathBuf};

use self::judged::Judged;
use self::log::{Clock, Log};
use self::quantities::quantities;
use self::text::Content;
use self::words::Kind;
use crate::limits::MAX_RUNS;
use crate::robot::Robot;
use crate::{DataError, DataSet, Source, Spec, assemble, manifest};

/// What a description is drafted from.
pub struct Draft<'d> {
    /// The mechanism: a spec or a robot file.
    pub mechanism: Spec,
    /// Its name, or its path relative to the description.
    pub named: String,
    /// The recordings: their paths relative to the description, and where they are.
    pub runs: &'d [(String, PathBuf)],
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
    pub fn write(self, path: &Path) -> Result<Drafted, DataError> {
        if self.runs.len() > MAX_RUNS {
            let message = format!("a data set has at most {MAX_RUNS} runs");
            return Err(DataError::whole(path.to_string_lossy(), message));
        }
        let spec = &self.mechanism;
        let robot = Robot::read(Path::new(&spec.file), &spec.text, text::patterns())?;
        let (spec, robot) = match robot {
            Some((spec, robot)) => (spec, Some(robot)),
            None => (spec.clone(), None),
        };
        let mechanism = appell_spec::load(&spec.file, &spec.text)?.mechanism;
        let quantities = quantities(&mechanism, robot.as_ref());
        let paths: Vec<&Path> = self.runs.iter().map(|(_, path)| path.as_path()).collect();
        let log = Log::read(&paths, self.rate_hz)?;
        let is_clock = |column: &usize| match log.clock {
            Clock::Column { index, .. } => index == *column,
            Clock::Rate(_) | Clock::Unknown => false,
        };
        let columns: Vec<usize> = (0..log.names.len())
            .filter(|column| !is_clock(column) && log.ends(*column).is_some())
            .collect();
        let bound = bound::bind(&log, &columns, &quantities);
        let channels = judged::judge(&log, &bound, &quantities);
        let is_bound = |column: &usize| channels.iter().any(|own| own.column == *column);
        let others: Vec<usize> = columns.iter().copied().filter(|c| !is_bound(c)).collect();
        if !channels
            .iter()
            .any(|own| quantities[own.quantity].kind != Kind::Command)
        {
            let names: Vec<&str> = quantities.iter().map(|own| own.name.as_str()).collect();
            let message = format!(
                "no column has a name like one of the mechanism, {}; rename columns, or write the description by hand",
                names.join(", ")
            );
            return Err(DataError::whole(paths[0].to_string_lossy(), message));
        }
        let questions = questions(&log, &channels, &others);
        let lacking = quantities.iter().enumerate().filter(|(index, own)| {
            own.kind == Kind::Command && !channels.iter().any(|known| known.quantity == *index)
        });
        let lacking = lacking.map(|(_, own)| {
            format!(
                "no column is the command `{}`, so zero is taken; is there one?",
                own.name
            )
        });
        let questions: Vec<String> = questions.into_iter().chain(lacking).collect();
        let held_out = match self.runs.len() {
            1 => 0,
            count => (count + 1) / 3,
        };
        let names: Vec<String> = self.runs.iter().map(|(name, _)| name.clone()).collect();
        let (fit, test) = names.split_at(names.len() - held_out.min(names.len() - 1));
        let mut noise = vec![None; channels.len()];
        let text = |noise: &[Option<f64>]| {
            let content = Content {
                mechanism: &self.named,
                names: &mechanism,
                robot: robot.as_ref(),
                log: &log,
                quantities: &quantities,
                channels: &channels,
                others: &others,
                noise,
                fit,
                test,
            };
            content.text()
        };
        let is_open = matches!(log.clock, Clock::Unknown)
            || channels.iter().all(|channel| channel.unit.is_none());
        if is_open {
            return Ok(Drafted {
                text: text(&noise),
                questions,
                set: None,
            });
        }
        let read = |text: &str| {
            let manifest =
                manifest::read(path, text, &[], Some(self.mechanism.clone()), &|_| None)?;
            assemble(manifest, |name| {
                let mut runs = self.runs.iter();
                let run = runs.find(|(own, _)| own == name);
                run.map(|(_, path)| Source::File(path.clone()))
            })
        };
        let set = read(&text(&noise))?;
        for (channel, noise) in channels.iter().zip(&mut noise) {
            let name = &log.names[channel.column];
            let own = set.channels.iter().find(|own| own.column == *name);
            *noise = own.and_then(|own| {
                let bound = set.findings.iter().any(|finding| {
                    finding.kind == crate::FindingKind::NoiseBound
                        && finding.channel.as_deref() == Some(name)
                });
                let found = own.noise.filter(|_| !bound)?.found?;
                Some(own.unit.from_si(found))
            });
        }
        let text = text(&noise);
        let set = read(&text)?;
        Ok(Drafted {
            text,
            questions,
            set: Some(set),
        })
    }
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
