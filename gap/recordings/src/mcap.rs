//! MCAP, the container that robots log into: messages of many topics with their times.
//!
//! Messages are JSON or those of ROS 2 (CDR with definitions in its message language). Every number of a
//! message is a value of the column `topic.field.field` or `topic.field[2]`; where the message names its joints, as
//! `sensor_msgs/JointState` does, also of `topic.position[elbow]`. Messages of the same time form a row; values without a
//! message are missing. `t` is in s since the first message, by the clock of the logger.

mod cdr;
mod names;

use std::collections::BTreeMap;
use std::path::Path;

use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{Message, MessageStream};
use serde_json::Value;

use self::cdr::Definitions;
use self::names::{LONGEST, NAMES, Names};
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
                let mut names = Names::of(&channel.topic, &mut tell);
                flatten(&mut names, &value, &[]);
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
        })
    }
}

/// Tells every number of a JSON value; `joints` are the names of numbers in lists. JSON that was read is at most 128 deep.
fn flatten(names: &mut Names<'_>, value: &Value, joints: &[String]) {
    let here = names.place();
    match value {
        Value::Number(number) => names.tell(number.as_f64().unwrap_or(f64::NAN)),
        Value::Bool(value) => names.tell(f64::from(u8::from(*value))),
        Value::Array(values) => {
            for (index, value) in values.iter().enumerate() {
                names.element(index, values.len(), joints);
                flatten(names, value, joints);
                names.back(here);
            }
        }
        Value::Object(fields) => {
            let own = NAMES.iter().find_map(|key| texts(fields.get(*key)?));
            let joints = own.as_deref().unwrap_or(joints);
            for (name, value) in fields {
                names.field(name);
                flatten(names, value, joints);
                names.back(here);
            }
        }
        Value::Null | Value::String(_) => {}
    }
}

/// The texts of a list of nothing else.
fn texts(value: &Value) -> Option<Vec<String>> {
    let texts = value.as_array()?.iter();
    let name = |text: &Value| Some(text.as_str()?.chars().take(LONGEST).collect());
    texts.map(name).collect()
}
