//! The column of the times: which one it is, and in which unit.
//!
//! `[channels]` names it with `time = true`; a line `t = { unit = "ms" }` does so as well. Else it is the only
//! column whose name is one of a clock: `t`, `time` or `timestamp`, with a unit behind it as in `time [ms]`,
//! `t(us)` or `timestamp_ns`; else the only one that is a stamp, `header.stamp`, which may be two columns,
//! `header.stamp.sec` and `header.stamp.nanosec`. Without a unit the times are in seconds. Without a column of the times
//! the description states the `rate` of the rows.

use appell_spec::units::{self, Dimension, Unit};
use appell_spec::{closest, shown};

use crate::channel::Channel;

/// Default name of the column of the times.
pub(crate) const TIME: &str = "t";

/// Names of clocks, in small letters with `_` between words.
const NAMES: &str = "t time times timestamp timestamps time_stamp elapsed_time";
/// Names of stamps, which are the clock where no column has one of the names above.
const STAMPS: &str = "stamp header_stamp field_header_stamp %time sim_time log_time elapsed";
/// Ends of the names of two columns that are one time: in s and in ns.
const PARTS: [[&str; 2]; 4] = [
    [".sec", ".nanosec"],
    [".secs", ".nsecs"],
    ["_sec", "_nanosec"],
    ["_secs", "_nsecs"],
];
/// Symbols of units that may follow a name without brackets, each with words for the unit.
const UNITS: [(&str, &str); 4] = [
    ("s", "sec secs second seconds"),
    ("ms", "msec millis millisecond milliseconds"),
    ("us", "µs μs usec micros microsecond microseconds"),
    ("ns", "nsec nanosecond nanoseconds"),
];

/// Whether a list of words, with blanks between them, has a word.
pub(crate) fn has(list: &str, word: &str) -> bool {
    list.split(' ').any(|own| own == word)
}

/// Times in s from which on they are those of a calendar.
const CALENDAR: f64 = 1e8;

/// The origin of the times of a file, in their unit of `scale` s: its first time where that is one of a calendar, which in
/// seconds would leave no digits for the steps.
pub(crate) fn origin(first: f64, scale: f64) -> f64 {
    if (scale * first).abs() > CALENDAR {
        first
    } else {
        0.0
    }
}

/// Description of the times.
#[derive(Debug, Clone, Default)]
pub(crate) struct Stated {
    /// The column, where it is described.
    pub(crate) column: Option<String>,
    /// Whether it was recognised as the column of the times by its name alone.
    pub(crate) by_name_alone: bool,
    /// The unit, where it is stated.
    pub(crate) unit: Option<Unit>,
    /// Rows per second, where no column is the time.
    pub(crate) rate: Option<f64>,
}

/// Where the times of the rows are.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Times {
    /// In a column.
    Column(usize),
    /// In two columns, in s and in ns.
    Parts([usize; 2]),
    /// Nowhere: rows come at a rate in Hz.
    Rate(f64),
}

/// The column of the times in a file.
#[derive(Debug, Clone)]
pub(crate) struct TimeColumn {
    /// Where they are.
    pub(crate) times: Times,
    /// Its name.
    pub(crate) name: String,
    /// The unit, where the description or the name states it.
    pub(crate) unit: Option<Unit>,
}

impl TimeColumn {
    /// The unit in s.
    pub(crate) fn scale(&self) -> f64 {
        self.unit.as_ref().map_or(1.0, |unit| unit.scale)
    }

    /// Whether the times are in a column.
    pub(crate) fn is_in(&self, column: usize) -> bool {
        match self.times {
            Times::Column(index) => index == column,
            Times::Parts(parts) => parts.contains(&column),
            Times::Rate(_) => false,
        }
    }
}

/// Why a file has no column of the times, with a suggested correction.
pub(crate) struct NoTime {
    pub(crate) message: String,
    pub(crate) help: String,
}

impl Stated {
    /// The column of the times among those of a file.
    pub(crate) fn find(
        &self,
        names: &[String],
        channels: &[Channel],
    ) -> Result<TimeColumn, NoTime> {
        if let Some(rate) = self.rate {
            return Ok(TimeColumn {
                times: Times::Rate(rate),
                name: "rate".to_owned(),
                unit: Some(Unit::si(Dimension::TIME)),
            });
        }
        if let Some(parts) = self.parts(names, channels) {
            return Ok(parts);
        }
        let clocks = Self::clocks(names, channels);
        if let Some(stated) = &self.column
            && (!self.by_name_alone || clocks.len() < 2)
        {
            let index = names.iter().position(|name| name == stated);
            let index = index.ok_or_else(|| {
                let similar = closest(stated, names.iter().map(String::as_str));
                NoTime {
                    message: format!("there is no column `{}` of the times", shown(stated)),
                    help: similar.map_or_else(
                        || "name the column of the times in `[channels]`".to_owned(),
                        |similar| format!("did you mean `{}`?", shown(similar)),
                    ),
                }
            })?;
            return Ok(self.column_at(index, stated));
        }
        match clocks[..] {
            [index] => Ok(self.column_at(index, &names[index])),
            [] => Err(NoTime {
                message: "there is no column of the times".to_owned(),
                help: format!(
                    "call it `{TIME}`, or name it in `[channels]` of recording.toml: {}; without one, write the rows per \
                     second before the sections: `rate = 100`",
                    line("clock", "s")
                ),
            }),
            ref several => {
                let several: Vec<String> = (several.iter())
                    .map(|&index| format!("`{}`", shown(&names[index])))
                    .collect();
                let first = several[0].trim_matches('`');
                Err(NoTime {
                    message: format!("{} may all be the times", several.join(", ")),
                    help: format!(
                        "name one in `[channels]` of recording.toml, such as {}",
                        line(first, "s")
                    ),
                })
            }
        }
    }

    /// The columns that have the name of a clock and are no channels; if there is none, those with the name of a stamp.
    fn clocks(names: &[String], channels: &[Channel]) -> Vec<usize> {
        let is_channel = |name: &String| channels.iter().any(|own| own.column == *name);
        let known = |is_clock: &dyn Fn(&str) -> bool| -> Vec<usize> {
            let is_free = |index: &usize| is_clock(&names[*index]) && !is_channel(&names[*index]);
            (0..names.len()).filter(is_free).collect()
        };
        let clocks = known(&may_be_time);
        if clocks.is_empty() {
            return known(&|name| split(name, STAMPS).is_some());
        }
        clocks
    }

    /// Two columns of the times: those of the stated name, else the only ones of a clock or a stamp.
    fn parts(&self, names: &[String], channels: &[Channel]) -> Option<TimeColumn> {
        let place = |name: &str| names.iter().position(|own| own == name);
        if let Some(stated) = &self.column {
            if self.by_name_alone || place(stated).is_some() {
                return None;
            }
            let times = PARTS.iter().find_map(|[sec, nanosec]| {
                let seconds = place(&format!("{stated}{sec}"))?;
                Some([seconds, place(&format!("{stated}{nanosec}"))?])
            })?;
            return Some(TimeColumn::of_parts(stated, times));
        }
        let is_channel = |name: &str| channels.iter().any(|own| own.column == name);
        let mut found = names.iter().enumerate().filter_map(|(index, name)| {
            let (base, ends) = PARTS
                .iter()
                .find_map(|ends| Some((name.strip_suffix(ends[0])?, ends)))?;
            let is_stamp = has(NAMES, &plain(base)) || plain(base).ends_with("stamp");
            let nanoseconds = place(&format!("{base}{}", ends[1])).filter(|_| is_stamp)?;
            (!is_channel(name)).then(|| TimeColumn::of_parts(base, [index, nanoseconds]))
        });
        let first = found.next()?;
        // Of several topics each has one; then the line of the times names it.
        let is_only = found.next().is_none();
        let others = Self::clocks(names, channels);
        let others = others.iter().filter(|index| !first.is_in(**index));
        (is_only && others.count() == 0).then_some(first)
    }

    fn column_at(&self, index: usize, name: &str) -> TimeColumn {
        TimeColumn {
            times: Times::Column(index),
            name: name.to_owned(),
            unit: self.unit.clone().or_else(|| unit_of(name)),
        }
    }
}

impl TimeColumn {
    fn of_parts(name: &str, parts: [usize; 2]) -> Self {
        Self {
            times: Times::Parts(parts),
            name: name.to_owned(),
            unit: Some(Unit::si(Dimension::TIME)),
        }
    }
}

/// Whether a key of TOML needs no quotes.
pub(crate) fn is_bare(key: &str) -> bool {
    let is_bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    !key.is_empty() && key.chars().all(is_bare)
}

/// The line of `[channels]` that names the column of the times.
pub(crate) fn line(name: &str, unit: &str) -> String {
    let name = if is_bare(name) {
        name.to_owned()
    } else {
        format!("\"{name}\"")
    };
    format!("`{name} = {{ time = true, unit = \"{unit}\" }}`")
}

/// Whether a column has the name of a clock.
pub(crate) fn may_be_time(name: &str) -> bool {
    split(name, NAMES).is_some()
}

/// Whether a column may be the times, or a part of them.
pub(crate) fn may_be_needed(name: &str) -> bool {
    let ends = PARTS.as_flattened().iter();
    let mut bases = ends.filter_map(|end| name.strip_suffix(end));
    let is_part = bases.any(|base| has(NAMES, &plain(base)) || plain(base).ends_with("stamp"));
    is_part || may_be_time(name) || split(name, STAMPS).is_some()
}

/// Whether a column is a part of the times of this name.
pub(crate) fn is_part(name: &str, of: &str) -> bool {
    let end = name.strip_prefix(of);
    end.is_some_and(|end| PARTS.as_flattened().contains(&end))
}

/// The unit of the times that the name of a column states.
pub(crate) fn unit_of(name: &str) -> Option<Unit> {
    let named = split(name, NAMES).or_else(|| split(name, STAMPS));
    named?.unit
}

/// What stands behind the name of a clock.
struct Behind {
    unit: Option<Unit>,
}

/// What stands behind the name of a clock; nothing for other names.
fn split(name: &str, known: &str) -> Option<Behind> {
    let name = name.trim();
    if let Some((clock, unit)) = bracketed(name) {
        let unit = unit_by(unit)?;
        let unit = Some(unit);
        return has(known, &plain(clock)).then_some(Behind { unit });
    }
    let whole = plain(name);
    if has(known, &whole) {
        return Some(Behind { unit: None });
    }
    let (clock, last) = whole.rsplit_once('_')?;
    let mut units = UNITS.iter();
    let is_unit = units.any(|(symbol, words)| *symbol == last || has(words, last));
    (is_unit && has(known, clock)).then(|| Behind {
        unit: unit_by(last),
    })
}

/// Splits a name into the part before and the part within trailing brackets.
fn bracketed(name: &str) -> Option<(&str, &str)> {
    let ends = [('[', ']'), ('(', ')')];
    ends.into_iter().find_map(|(open, close)| {
        let inner = name.strip_suffix(close)?;
        inner.split_once(open)
    })
}

/// Small letters, words with `_` between them.
fn plain(name: &str) -> String {
    let name = name.trim().to_lowercase();
    name.replace([' ', '-', '.'], "_")
}

/// A unit of time by its symbol or in words.
fn unit_by(text: &str) -> Option<Unit> {
    let text = text.trim();
    let lower = text.to_lowercase();
    let word = UNITS.iter().find(|(_, words)| has(words, &lower));
    let unit = units::parse(word.map_or(text, |(symbol, _)| symbol)).ok()?;
    (unit.dimension == Dimension::TIME).then_some(unit)
}

#[cfg(test)]
mod tests {
    use super::{may_be_time, unit_of};

    #[test]
    fn clocks_are_known_by_name_and_unit() {
        for (name, unit) in [
            ("t", None),
            ("Time", None),
            ("time_stamp", None),
            ("Time [s]", Some("s")),
            ("t[ms]", Some("ms")),
            ("time(us)", Some("us")),
            ("time [µs]", Some("us")),
            ("timestamp_ns", Some("ns")),
            ("Time (Seconds)", Some("s")),
            ("time_milliseconds", Some("ms")),
            ("time [min]", Some("min")),
        ] {
            assert!(may_be_time(name), "{name}");
            let found = unit_of(name).map(|unit| unit.text);
            assert_eq!(found.as_deref(), unit, "{name}");
        }
        for name in [
            "theta",
            "t_wheel",
            "t [N]",
            "time [frames]",
            "rise_time",
            "ts",
            "",
            "[s]",
            "t_m",
        ] {
            assert!(!may_be_time(name), "{name}");
        }
    }
}
