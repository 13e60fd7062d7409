//! The recordings that a draft is made from: their columns, and which of them are the times.

use crate::clock::{median, steps};
use crate::episode::{is_episode, number};
use crate::limits::{MAX_RUNS, MIN_ROWS};
use crate::time::{self, TIME, may_be_time, unit_of};
use crate::topics::hold;
use crate::{DataError, Logged, format};

/// Runs that the quantities and units are found from; the others only have to have the same columns.
const MOST_RUNS: usize = 4;
/// Steps between rows, relative to their median, that still are those of a clock.
const STEADY: std::ops::Range<f64> = 0.02..50.0;
/// Units of time, with the size in s and the least time since 1970 that a date in this unit has.
const UNITS: [(&str, f64, f64); 4] = [
    ("ns", 1e-9, 1e17),
    ("us", 1e-6, 1e14),
    ("ms", 1e-3, 1e11),
    ("s", 1.0, 1e8),
];

/// Columns of some runs, in the units of the files.
pub(super) struct Log {
    pub(super) names: Vec<String>,
    pub(super) runs: Vec<Rows>,
    pub(super) clock: Clock,
    /// Names of all runs: of files, or of episodes of files.
    pub(super) named: Vec<String>,
}

/// A run: times in s, and the columns.
pub(super) struct Rows {
    pub(super) times: Vec<f64>,
    pub(super) values: Vec<Vec<f64>>,
}

/// Where the times come from.
pub(super) enum Clock {
    /// A column with this unit; whether its name and unit need a line in the description.
    Column {
        index: usize,
        unit: &'static str,
        line: bool,
        question: Option<String>,
    },
    /// Rows at this rate in Hz.
    Rate(f64),
    /// Nothing; the rate has to be stated.
    Unknown,
}

impl Log {
    /// Reads the first runs.
    pub(super) fn read(
        recordings: &[(String, Logged<'_>)],
        rate: Option<f64>,
    ) -> Result<Self, DataError> {
        let mut names: Vec<String> = Vec::new();
        let (mut tables, mut named) = (Vec::new(), Vec::new());
        for (name, logged) in recordings {
            let has_episodes = names.iter().any(|name| is_episode(name));
            if tables.len() >= MOST_RUNS && !has_episodes {
                named.push(name.clone());
                continue;
            }
            let (own, values) = match logged {
                Logged::File(path) => format::columns_of(path)?,
                Logged::Frame(frame) => (frame.columns.clone(), frame.values.clone()),
            };
            let file = logged.name();
            if values.iter().map(Vec::len).max().unwrap_or(0) < MIN_ROWS {
                let message = format!("a draft needs {MIN_ROWS} rows of numbers and more");
                return Err(DataError::whole(file, message));
            }
            if names.is_empty() {
                names.clone_from(&own);
            }
            let values = in_order(&names, &own, values).ok_or_else(|| {
                let first = recordings[0].1.name();
                DataError::whole(file, format!("the columns differ from those of {first}"))
            })?;
            for (episode, mut values) in episodes(&names, values) {
                named.push(match episode {
                    Some(episode) => format!("{name}#{episode}"),
                    None => name.clone(),
                });
                // Topics may have times of their own.
                for column in &mut values {
                    hold(column, f64::NAN);
                }
                if tables.len() < MOST_RUNS {
                    tables.push(values);
                }
            }
        }
        let Some(first) = tables.first() else {
            return Err(DataError::whole("recordings", "there is no recording"));
        };
        let clock = match rate {
            Some(rate) => Clock::Rate(rate),
            None => clock(&names, first),
        };
        let runs = tables.into_iter().map(|values| {
            let rows = values.iter().map(Vec::len).max().unwrap_or(0);
            let times = match &clock {
                Clock::Column { index, unit, .. } => {
                    let start = values[*index].first().copied().unwrap_or(0.0);
                    let size = size(unit);
                    values[*index].iter().map(|t| (t - start) * size).collect()
                }
                Clock::Rate(rate) => (0..rows).map(|row| row as f64 / rate).collect(),
                Clock::Unknown => (0..rows).map(|row| row as f64).collect(),
            };
            Rows { times, values }
        });
        Ok(Self {
            runs: runs.collect(),
            names,
            named,
            clock,
        })
    }

    /// Columns of numbers that are neither the times nor the number of an episode.
    pub(super) fn columns(&self) -> Vec<usize> {
        let is_clock = |column: usize| match self.clock {
            Clock::Column { index, .. } => index == column,
            Clock::Rate(_) | Clock::Unknown => false,
        };
        let columns = 0..self.names.len();
        let is_other = |column: &usize| {
            !is_clock(*column) && !is_episode(&self.names[*column]) && self.ends(*column).is_some()
        };
        columns.filter(is_other).collect()
    }

    /// The values of a column in each run.
    pub(super) fn column(&self, index: usize) -> impl Iterator<Item = &[f64]> {
        self.runs.iter().map(move |run| &*run.values[index])
    }

    /// Smallest and largest value of a column; `None` if it holds no number.
    pub(super) fn ends(&self, index: usize) -> Option<[f64; 2]> {
        let values = self.column(index).flatten().copied();
        let ends = values
            .filter(|value| value.is_finite())
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
                [low.min(value), high.max(value)]
            });
        (ends[0] <= ends[1]).then_some(ends)
    }

    /// Whether a column never changes.
    pub(super) fn is_constant(&self, index: usize) -> bool {
        self.ends(index).is_none_or(|[low, high]| low >= high)
    }
}

/// The columns in the order of the names of the first run; `None` if one is missing.
fn in_order(names: &[String], own: &[String], mut values: Vec<Vec<f64>>) -> Option<Vec<Vec<f64>>> {
    let place = |name: &String| own.iter().position(|own| own == name);
    let places: Option<Vec<usize>> = names.iter().map(place).collect();
    let places = places?.into_iter();
    Some(
        places
            .map(|place| std::mem::take(&mut values[place]))
            .collect(),
    )
}

/// The rows of each episode, where there are several.
fn episodes(names: &[String], values: Vec<Vec<f64>>) -> Vec<(Option<u64>, Vec<Vec<f64>>)> {
    let numbers = names.iter().position(|name| is_episode(name));
    let numbers = numbers.map_or(&[][..], |column| &values[column]);
    let mut all: Vec<u64> = numbers.iter().filter_map(|cell| number(*cell)).collect();
    all.sort_unstable();
    all.dedup();
    if all.len() < 2 {
        return vec![(None, values)];
    }
    let of = |episode: u64| {
        let rows = |column: &Vec<f64>| -> Vec<f64> {
            let rows = column.iter().zip(numbers);
            rows.filter_map(|(value, own)| (number(*own) == Some(episode)).then_some(*value))
                .collect()
        };
        (Some(episode), values.iter().map(rows).collect())
    };
    all.into_iter().take(MAX_RUNS).map(of).collect()
}

fn size(unit: &str) -> f64 {
    let mut units = UNITS.iter();
    units
        .find(|(own, ..)| *own == unit)
        .map_or(1.0, |(_, size, _)| *size)
}

/// The column of the times: by its name, else the only one that grows steadily.
fn clock(names: &[String], values: &[Vec<f64>]) -> Clock {
    let grows = |index: &usize| is_clock(&values[*index]);
    let named: Vec<usize> = (0..names.len())
        .filter(|index| may_be_time(&names[*index]))
        .collect();
    let growing: Vec<usize> = named.iter().copied().filter(grows).collect();
    let is_named = !growing.is_empty();
    let all: Vec<usize> = if is_named {
        growing
    } else {
        (0..names.len()).filter(grows).collect()
    };
    let preferred = all.iter().find(|index| names[**index] == TIME);
    let Some(&index) = preferred.or(all.first()) else {
        return Clock::Unknown;
    };
    let others = all.len() > 1 && preferred.is_none();
    let stated = unit_of(&names[index]).and_then(|unit| {
        let mut units = UNITS.iter();
        units.find(|(own, ..)| *own == unit.text)
    });
    let (unit, guessed) = match stated {
        Some((unit, ..)) => (*unit, false),
        None => (probable_unit(&values[index]), true),
    };
    let name = &names[index];
    let line = (guessed && unit != "s") || !is_named || named.len() > 1;
    let question = if !is_named {
        Some(format!(
            "no column has the name of a clock; is `{name}` the time, in {unit}?"
        ))
    } else if others {
        let others = all.iter().filter(|own| **own != index);
        let others: Vec<String> = others.map(|own| format!("`{}`", names[*own])).collect();
        Some(format!(
            "several columns may be the time; is it `{name}`, or {}?",
            others.join(", ")
        ))
    } else {
        None
    };
    Clock::Column {
        index,
        unit,
        line,
        question,
    }
}

/// Whether values increase in steps like those of a clock.
fn is_clock(values: &[f64]) -> bool {
    let steps = steps(values);
    if steps.len() + 1 < MIN_ROWS || steps.iter().any(|step| !step.is_finite()) {
        return false;
    }
    let median = median(steps.clone());
    let steady = steps
        .iter()
        .filter(|step| STEADY.contains(&(*step / median)));
    median > 0.0 && steady.count() as f64 >= 0.95 * steps.len() as f64
}

/// The unit of times by their size, as dates, else by the step between rows.
fn probable_unit(times: &[f64]) -> &'static str {
    let largest = times.iter().copied().fold(0.0, f64::max);
    if let Some((unit, ..)) = UNITS.iter().find(|(.., least)| largest > *least)
        && largest > UNITS[2].2
    {
        return unit;
    }
    match median(steps(times)) {
        step if step < 0.8 => "s",
        step if step < 800.0 => "ms",
        step if step < 8e5 => "us",
        _ => "ns",
    }
}

/// The line of the description for the times, if one is needed.
pub(super) fn line(clock: &Clock, names: &[String]) -> Option<String> {
    match clock {
        Clock::Column {
            index,
            unit,
            line: true,
            ..
        } => Some(
            time::line(&names[*index], unit)
                .trim_matches('`')
                .to_owned(),
        ),
        _ => None,
    }
}
