//! The numbers of a run: columns as in the file, and the table in SI.

use appell_spec::units::{Dimension, Unit};
use appell_spec::{closest, shown};

use crate::channel::Channel;
use crate::clock::{Clock, Sampling};
use crate::episode::{self, is_episode};
use crate::finding::{counted, listed};
use crate::limits::{MAX_NUMBERS, MAX_TIME, MAX_VALUE, MIN_ROWS, MIN_STEP};
use crate::time::{NoTime, Stated, TIME, TimeColumn, Times, origin};
use crate::{DataError, Finding, FindingKind, topics};

/// The numbers of a run.
pub(crate) struct Table {
    /// Times in s, strictly increasing.
    pub(crate) times: Vec<f64>,
    /// Values in SI, a column for each channel; NaN where one is missing.
    pub(crate) columns: Vec<Vec<f64>>,
    /// Omitted rows.
    pub(crate) findings: Vec<Finding>,
}

/// Named columns in the units of the file.
pub(crate) struct Columns {
    /// Names of all columns of the file.
    pub(crate) names: Vec<String>,
    /// Values of the requested ones; the others are empty. NaN where a value is missing.
    pub(crate) values: Vec<Vec<f64>>,
    /// The clock of the format itself.
    pub(crate) clock: OwnClock,
}

/// The times of the rows, as given by a format.
pub(crate) enum OwnClock {
    /// Not at all.
    None,
    /// By the column `t`, in s.
    Column,
    /// By time stamps: the unit in s of the columns that hold such.
    #[cfg_attr(
        not(feature = "parquet"),
        expect(dead_code, reason = "only Parquet has time stamps")
    )]
    Stamps(Vec<Option<f64>>),
}

impl OwnClock {
    /// The unit in s of the numbers of a column, where the format states it.
    fn unit(&self, index: usize, name: &str) -> Option<f64> {
        match self {
            Self::None => None,
            Self::Column => (name == TIME).then_some(1.0),
            Self::Stamps(units) => units.get(index).copied().flatten(),
        }
    }
}

/// The requested columns.
pub(crate) type Wanted<'w> = &'w dyn Fn(&str) -> bool;

impl Columns {
    /// Names and values of all columns, with time stamps in s.
    pub(crate) fn in_seconds(mut self) -> (Vec<String>, Vec<Vec<f64>>) {
        for (index, (name, values)) in self.names.iter().zip(&mut self.values).enumerate() {
            let unit = self.clock.unit(index, name).unwrap_or(1.0);
            for value in values {
                *value *= unit;
            }
        }
        (self.names, self.values)
    }

    /// The columns of the channels in SI, in rows of increasing times.
    pub(crate) fn table(
        self,
        file: &str,
        time: &Stated,
        channels: &[Channel],
        episode: Option<u64>,
        budget: &mut usize,
    ) -> Result<Table, DataError> {
        let time = time.find(&self.names, channels);
        let time = time.map_err(|NoTime { message, help }| {
            DataError::whole(file, format!("{message}; {help}"))
        })?;
        let (time, times) = self.times(file, time)?;
        let episode = self.episode(file, episode)?;
        let place = |name: &str| {
            let place = self.names.iter().position(|own| own == name);
            place.ok_or_else(|| {
                let similar = closest(name, self.names.iter().map(String::as_str));
                let similar = similar.map_or(String::new(), |s| format!("; did you mean `{s}`?"));
                let message = format!("there is no column `{}`{similar}", shown(name));
                DataError::whole(file, message)
            })
        };
        let places: Result<Vec<usize>, _> = channels.iter().map(|c| place(&c.column)).collect();
        let places = places?;
        let mut findings = Vec::from_iter(ignored(&self.names, &time, &places));
        let mut clock = Clock::default();
        // Formats in columns may be damaged so that these differ.
        if let Some(place) = places
            .iter()
            .find(|&&i| self.values[i].len() != times.len())
        {
            let message = format!(
                "the file is damaged: {} times, but {} values of `{}`",
                times.len(),
                self.values[*place].len(),
                shown(&self.names[*place])
            );
            return Err(DataError::whole(file, message));
        }
        // A log of several topics has rows without the clock of one of them.
        let is_of_topic = matches!(self.clock, OwnClock::Column) && time.name != TIME;
        let rows: Vec<usize> = (0..times.len())
            .filter(|&row| !(is_of_topic && times[row].is_nan()))
            .filter(|&row| episode.as_ref().is_none_or(|rows| rows[row]))
            .filter(|&row| clock.accept(times[row], row + 1, &format!("row {}", row + 1)))
            .collect();
        findings.extend(clock.findings(file)?);
        let numbers = rows.len().saturating_mul(1 + channels.len());
        *budget = budget
            .checked_sub(numbers)
            .ok_or_else(|| too_many(file.to_owned()))?;
        let column = |(place, channel): (&usize, &Channel)| {
            let values = &self.values[*place];
            let stamp = match self.clock {
                OwnClock::Stamps(_) => self.clock.unit(*place, &channel.column),
                OwnClock::Column | OwnClock::None => None,
            };
            let stamp = stamp.unwrap_or(1.0);
            let in_si = |&row: &usize| finite(channel.in_si(stamp * values[row]));
            rows.iter().map(in_si).collect()
        };
        let mut columns: Vec<Vec<f64>> = places.iter().zip(channels).map(column).collect();
        let mut times: Vec<f64> = rows.iter().map(|&row| times[row]).collect();
        if matches!(self.clock, OwnClock::Column) {
            findings.extend(topics::joined(&mut times, &mut columns, channels));
        }
        checked(file, &time, times, channels, columns, findings)
    }

    /// The times in s. The unit that the format states is not stated otherwise; time stamps count from the first row
    /// on.
    fn times(&self, file: &str, time: TimeColumn) -> Result<(TimeColumn, Vec<f64>), DataError> {
        let index = match time.times {
            Times::Column(index) => index,
            Times::Parts([seconds, nanoseconds]) => {
                let parts = self.values[seconds].iter().zip(&self.values[nanoseconds]);
                let start = self.values[seconds].iter().copied().find(|t| t.is_finite());
                let start = start.unwrap_or(0.0);
                let times = parts.map(|(s, ns)| s - start + 1e-9 * ns).collect();
                return Ok((time, times));
            }
            Times::Rate(rate) => {
                let rows = self.values.iter().map(Vec::len).max().unwrap_or(0);
                let times = (0..rows).map(|row| row as f64 / rate).collect();
                return Ok((time, times));
            }
        };
        let times = &self.values[index];
        let Some(unit) = self.clock.unit(index, &time.name) else {
            let (first, scale) = (times.iter().find(|t| t.is_finite()), time.scale());
            let start = first.map_or(0.0, |first| origin(*first, scale));
            let times = times.iter().map(|t| scale * (t - start)).collect();
            return Ok((time, times));
        };
        if time.unit.as_ref().is_some_and(|unit| !unit.is_si()) {
            let message = format!(
                "the file itself states the unit of the times `{}`; remove the other one",
                shown(&time.name)
            );
            return Err(DataError::whole(file, message));
        }
        let first = match self.clock {
            OwnClock::Stamps(_) => times.iter().copied().find(|t| t.is_finite()),
            OwnClock::Column | OwnClock::None => None,
        };
        let first = first.unwrap_or(0.0);
        let times = times.iter().map(|t| unit * (t - first)).collect();
        let unit = Some(Unit::si(Dimension::TIME));
        Ok((TimeColumn { unit, ..time }, times))
    }

    /// Which rows are of an episode, where one is chosen.
    fn episode(&self, file: &str, chosen: Option<u64>) -> Result<Option<Vec<bool>>, DataError> {
        let Some(chosen) = chosen else {
            return Ok(None);
        };
        let rows = self.values[episode::column(&self.names, file)?].iter();
        let is_chosen = |own: &f64| episode::number(*own) == Some(chosen);
        Ok(Some(rows.map(is_chosen).collect()))
    }
}

/// The columns that are neither the times nor a channel.
pub(crate) fn ignored(names: &[String], time: &TimeColumn, channels: &[usize]) -> Option<Finding> {
    let is_known = |i: usize| time.is_in(i) || channels.contains(&i) || is_episode(&names[i]);
    let unknown = (0..names.len()).filter(|&i| !is_known(i));
    let unknown: Vec<String> = unknown.map(|i| shown(&names[i])).collect();
    (!unknown.is_empty()).then(|| {
        let list = listed(&unknown);
        let message = format!("columns without a description are ignored: {list}");
        Finding::new(FindingKind::UnknownColumn, message)
    })
}

/// Non-finite values count as missing.
fn finite(value: f64) -> f64 {
    if value.is_finite() { value } else { f64::NAN }
}

/// The error of a data set that is too large.
pub(crate) fn too_many(place: String) -> DataError {
    let message =
        format!("the data set holds more than {MAX_NUMBERS} numbers; leave out rows or channels");
    DataError::whole(place, message)
}

/// The reason why times are invalid, if they are.
fn no_clock(times: &[f64]) -> Option<String> {
    let far = times.iter().find(|t| t.abs() > MAX_TIME);
    let near = times.windows(2).find(|pair| pair[1] - pair[0] < MIN_STEP);
    far.map(|t| format!("a row has the time {t:e} s"))
        .or_else(|| near.map(|pair| format!("rows are {:e} s apart", pair[1] - pair[0])))
}

/// Checks that a table has enough rows and that no column is empty.
pub(crate) fn checked(
    file: &str,
    clock: &TimeColumn,
    times: Vec<f64>,
    channels: &[Channel],
    columns: Vec<Vec<f64>>,
    mut findings: Vec<Finding>,
) -> Result<Table, DataError> {
    if times.len() < MIN_ROWS {
        let rows = counted(times.len(), "row");
        let message =
            format!("the file has {rows}; a run needs {MIN_ROWS} for a rate and a noise level");
        if times.len() < 2 {
            return Err(DataError::whole(file, message));
        }
        findings.push(Finding::new(FindingKind::FewRows, message));
    }
    if let Some(message) = no_clock(&times) {
        let message = format!(
            "{message}, which no clock shows; is `{}` the column of the times, and its unit the one stated?",
            shown(&clock.name)
        );
        return Err(DataError::whole(file, message));
    }
    // A stated unit is trusted.
    if clock.unit.is_none() {
        findings.extend(Sampling::of(&times).doubt(&clock.name));
    }
    for (channel, values) in channels.iter().zip(&columns) {
        if values.iter().all(|value| value.is_nan()) {
            let message = format!("the column `{}` holds no value", channel.column);
            return Err(DataError::whole(file, message));
        }
        if let Some(row) = values.iter().position(|value| value.abs() > MAX_VALUE) {
            let message = format!(
                "the column `{}` holds {:e} at t = {} s, which no rig measures; leave the cell empty \
                 where nothing was measured",
                channel.column,
                channel.unit.from_si(values[row]),
                times[row]
            );
            return Err(DataError::whole(file, message));
        }
    }
    Ok(Table {
        times,
        columns,
        findings,
    })
}
