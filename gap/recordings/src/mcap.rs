//! MCAP, the container that robots log into: messages of many topics with their times.
//!
//! Messages are JSON or those of ROS 2 (CDR with definitions in its message language). Every number of a
//! message is a value of the column `topic.field.field` or `topic.field[2]`; where the message names its joints, as
//! `sensor_msgs/JointState` does, also of `topic.position[elbow]`. Messages of the same time form a row; values without a
//! message are missing. `t` is in s since the first message, by the clock of the logger.

mod cdr;

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{Message, MessageStream};
use serde_json::Value;

use self::cdr::Definitions;
use crate::DataError;
use crate::limits::MAX_BYTES;
use crate::table::{Columns, OwnClock, Wanted, too_many};
use crate::time::TIME;

/// Reads a file; `budget` is the most numbers of all columns together.
pub(crate) fn read(path: &Path, wanted: Wanted<'_>, budget: usize) -> Result<Columns, DataError> {
    let bytes = appell_files::read(path, MAX_BYTES)?;
    let place = path.to_string_lossy();
    let damaged = |error: mcap::McapError| {
        let message = format!("the file is truncated or damaged: {error}; try `mcap recover`");
        DataError::whole(&*place, message)
    };
    check_lengths(&bytes).map_err(damaged)?;
    let mut log = Log::default();
    for message in MessageStream::new(&bytes).map_err(damaged)? {
        let message = message.map_err(damaged)?;
        log.add(&message, wanted).map_err(|what| {
            let message = format!("a message of the topic `{}` {what}", message.channel.topic);
            DataError::whole(&*place, message)
        })?;
        if log.values.len() > budget {
            return Err(too_many(place.into_owned()));
        }
    }
    log.columns(budget)
        .ok_or_else(|| too_many(place.into_owned()))
}

/// Refuses records, and chunks once they are decompressed, of a length that no log has: the lengths in a damaged file
/// are memory that its reader would ask for.
fn check_lengths(bytes: &[u8]) -> Result<(), mcap::McapError> {
    /// Longest record or chunk, in bytes.
    const MOST: usize = 1 << 28;
    let options = LinearReaderOptions::default().with_record_length_limit(MOST);
    let mut reader = LinearReader::new_with_options(options);
    let mut rest = bytes;
    while let Some(event) = reader.next_event() {
        if let LinearReadEvent::ReadRequest(wanted) = event? {
            let (next, later) = rest.split_at(wanted.min(rest.len()));
            reader.insert(next.len()).copy_from_slice(next);
            reader.notify_read(next.len());
            rest = later;
        }
    }
    Ok(())
}

/// Everything that was logged, message by message.
#[derive(Default)]
struct Log {
    /// Place of each column.
    names: BTreeMap<String, usize>,
    /// Definitions of the messages of a channel, by its number; `None` if they cannot be parsed.
    definitions: BTreeMap<u16, Option<Definitions>>,
    /// Time in ns, column and value.
    values: Vec<(u64, usize, f64)>,
}

impl Log {
    fn add(&mut self, message: &Message<'_>, wanted: Wanted<'_>) -> Result<(), &'static str> {
        let channel = &message.channel;
        let (names, values) = (&mut self.names, &mut self.values);
        let mut tell = |name: &str, value: f64| {
            let next = 1 + names.len();
            let place = *names.entry(name.to_owned()).or_insert(next);
            if wanted(name) {
                values.push((message.log_time, place, value));
            }
        };
        match channel.message_encoding.as_str() {
            "json" => {
                let value: Value =
                    serde_json::from_slice(&message.data).map_err(|_| "is not JSON")?;
                let mut paths = [channel.topic.clone(), channel.topic.clone()];
                flatten(&mut paths, &value, &[], &mut tell);
            }
            "cdr" => {
                let definitions = self.definitions.entry(channel.id).or_insert_with(|| {
                    let schema = channel.schema.as_ref()?;
                    let text = str::from_utf8(&schema.data).ok()?;
                    (schema.encoding == "ros2msg").then(|| Definitions::of(text))
                });
                if let Some(definitions) = definitions {
                    definitions
                        .read(&message.data, &channel.topic, &mut tell)
                        .ok_or("does not fit its definition")?;
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// Rows in the order of time; `None` if they exceed the budget.
    fn columns(mut self, budget: usize) -> Option<Columns> {
        self.values.sort_by_key(|(time, ..)| *time);
        let start = self.values.first().map_or(0, |(time, ..)| *time);
        let mut names = vec![TIME.to_owned(); 1 + self.names.len()];
        let mut is_there = vec![false; names.len()];
        for (_, place, _) in &self.values {
            is_there[*place] = true;
        }
        is_there[0] = true;
        for (name, place) in self.names {
            names[place] = name;
        }
        let width = is_there.iter().filter(|there| **there).count();
        let mut columns: Vec<Vec<f64>> = vec![Vec::new(); names.len()];
        for row in self.values.chunk_by(|a, b| a.0 == b.0) {
            if (1 + columns[0].len()).checked_mul(width)? > budget {
                return None;
            }
            for (column, _) in columns
                .iter_mut()
                .zip(&is_there)
                .filter(|(_, there)| **there)
            {
                column.push(f64::NAN);
            }
            let last = columns[0].len() - 1;
            columns[0][last] = (row[0].0 - start) as f64 * 1e-9;
            for (_, place, value) in row {
                columns[*place][last] = *value;
            }
        }
        Some(Columns {
            names,
            values: columns,
            clock: OwnClock::Column,
            findings: Vec::new(),
        })
    }
}

/// Every number of a JSON value with the path that leads to it, and the path with names of joints for numbers in lists.
/// JSON that was read is at most 128 deep.
fn flatten(
    paths: &mut [String; 2],
    value: &Value,
    names: &[String],
    tell: &mut dyn FnMut(&str, f64),
) {
    let lengths = [paths[0].len(), paths[1].len()];
    let mut tell_both = |paths: &[String; 2], value: f64| {
        tell(&paths[0], value);
        if paths[1] != paths[0] {
            tell(&paths[1], value);
        }
    };
    match value {
        Value::Number(number) => tell_both(paths, number.as_f64().unwrap_or(f64::NAN)),
        Value::Bool(value) => tell_both(paths, f64::from(u8::from(*value))),
        Value::Array(values) => {
            for (index, value) in values.iter().enumerate() {
                let name = names.get(index).filter(|_| names.len() == values.len());
                // Writing to a string cannot fail.
                let _ = write!(paths[0], "[{index}]");
                let _ = match name {
                    Some(name) => write!(paths[1], "[{name}]"),
                    None => write!(paths[1], "[{index}]"),
                };
                flatten(paths, value, names, tell);
                cut(paths, lengths);
            }
        }
        Value::Object(fields) => {
            let own = cdr::NAMES.iter().find_map(|key| texts(fields.get(*key)?));
            let names = own.as_deref().unwrap_or(names);
            for (name, value) in fields {
                for path in &mut *paths {
                    path.push('.');
                    path.push_str(name);
                }
                flatten(paths, value, names, tell);
                cut(paths, lengths);
            }
        }
        Value::Null | Value::String(_) => {}
    }
}

fn cut(paths: &mut [String; 2], lengths: [usize; 2]) {
    for (path, length) in paths.iter_mut().zip(lengths) {
        path.truncate(length);
    }
}

/// The texts of a list of nothing else.
fn texts(value: &Value) -> Option<Vec<String>> {
    let texts = value.as_array()?.iter();
    let name = |text: &Value| Some(text.as_str()?.chars().take(cdr::LONGEST_NAME).collect());
    texts.map(name).collect()
}
