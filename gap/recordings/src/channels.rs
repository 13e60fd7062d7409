//! The section `[channels]`: the column of the times, and a channel for each other line; one line may describe all
//! columns of a pattern.
//!
//! ```toml
//! rate = 250                                                        # Hz, where no column is the time
//! [channels]
//! "q_*" = { measures = "*", unit = "rad" }                          # q_elbow measures elbow
//! "/joint_states.position[*]" = { measures = ["base", "elbow"] }    # by number, in this order
//! ```

use std::borrow::Cow;
use std::cell::LazyCell;

use appell_spec::units::{Dimension, Unit};
use appell_spec::{Code, shown};
use toml::Spanned;
use toml::de::DeTable;

use crate::channel::Channel;
use crate::column::{Line, channel, channel_keys};
use crate::fields::{Fields, Value};
use crate::named::Named;
use crate::time::{self, Stated, TIME, may_be_time};

/// The names of the columns of the first run, which patterns choose from; they are read where there are patterns.
pub(crate) type Columns<'c> = &'c dyn Fn() -> Option<Vec<String>>;

/// Largest number of columns that one pattern describes.
const MOST_COLUMNS: usize = 4096;
/// Largest rate of rows in Hz.
const MOST_RATE: f64 = 1e9;

/// The description of the times, and the channels.
pub(crate) fn channels(
    fields: &mut Fields<'_>,
    table: &DeTable<'_>,
    named: Named<'_>,
    columns: Columns<'_>,
) -> (Stated, Vec<Channel>) {
    let rate = rate(fields, table);
    let help = "write a line for each column, such as x = { measures = \"x\", unit = \"m\" }";
    let Some(table) = fields.needed_section(table, "channels", help) else {
        return (Stated::default(), Vec::new());
    };
    let mut entries: Vec<_> = table.iter().collect();
    entries.sort_by_key(|(key, _)| key.span().start);
    let mut time = Stated {
        rate,
        ..Stated::default()
    };
    if let Some((name, value)) = clock(fields, &entries) {
        entries.retain(|(key, _)| key.get_ref() != name);
        if rate.is_some() {
            let message = format!("`rate` states the times, and so does `{}`", shown(name));
            let help = "remove one of them";
            fields.tell(Code::ConflictingKeys, message, value.span(), help);
        }
        time = Stated {
            column: Some(name.to_owned()),
            unit: unit_of_times(fields, name, value),
            by_name_alone: name != TIME && !is_time(value),
            rate: None,
        };
    }
    let lines = lines(fields, &entries, named, columns);
    let read = lines.iter().filter_map(|line| channel(fields, line, named));
    let channels: Vec<Channel> = read.collect();
    if !fields.is_wrong() && !channels.iter().any(Channel::is_measured) {
        let message = "no channel measures anything";
        let help =
            "at least one needs `measures`, the name of a coordinate, pseudo-velocity or output";
        fields.tell(Code::MissingKey, message, 0..0, help);
    }
    (time, channels)
}

/// The entry of the times: the one with `time = true`, that of `t`, or the only other one with the name of a clock and
/// no other role.
fn clock<'e>(
    fields: &mut Fields<'_>,
    entries: &[(&'e Spanned<Cow<'e, str>>, &'e Value<'e>)],
) -> Option<(&'e str, &'e Value<'e>)> {
    let is_bare = |value: &Value<'_>| {
        let table = value.get_ref().as_table();
        let has = |key: &str| table.is_some_and(|table| table.get(key).is_some());
        !channel_keys().chain(["time"]).any(has)
    };
    let lines = || {
        entries
            .iter()
            .map(|(key, value)| (&**key.get_ref(), *value))
    };
    let mut stated = entries.iter().filter(|(_, value)| is_time(value));
    if let Some((key, value)) = stated.next() {
        if let Some((second, _)) = stated.next() {
            let message = "a second column of the times";
            let help = format!(
                "remove `time = true` here, or at `{}`",
                shown(key.get_ref())
            );
            fields.tell(Code::DuplicateName, message, second.span(), &help);
        }
        return Some((key.get_ref(), value));
    }
    if let Some(own) = lines().find(|(name, _)| *name == TIME) {
        return Some(own);
    }
    let mut clocks =
        (entries.iter()).filter(|(key, value)| may_be_time(key.get_ref()) && is_bare(value));
    let (first, value) = clocks.next()?;
    if let Some((second, _)) = clocks.next() {
        let (first, other) = (first.get_ref(), second.get_ref());
        let message = format!(
            "`{}` and `{}` may both be the times",
            shown(first),
            shown(other)
        );
        let help = format!("write {} for the one that is", time::line(first, "s"));
        fields.tell(Code::ConflictingKeys, message, second.span(), &help);
    }
    Some((first.get_ref(), value))
}

/// Whether an entry has `time = true`.
fn is_time(value: &Value<'_>) -> bool {
    let table = value.get_ref().as_table();
    table.and_then(|table| table.get("time")?.get_ref().as_bool()) == Some(true)
}

/// The unit of the times in their line.
fn unit_of_times(fields: &mut Fields<'_>, name: &str, value: &Value<'_>) -> Option<Unit> {
    let table = fields.table(value, "a table such as { unit = \"ms\" }")?;
    if channel_keys().any(|key| table.get(key).is_some()) {
        let message = format!("`{}` is the time, not a channel", shown(name));
        let help = "remove the line, or state the unit of the times alone: { unit = \"ms\" }";
        fields.tell(Code::ReservedName, message, value.span(), help);
        return None;
    }
    fields.only(table, &["time", "unit"]);
    fields.flag(table, "time");
    fields
        .unit(table, Some((name, &Unit::si(Dimension::TIME))))
        .filter(|_| table.get("unit").is_some())
}

/// The rate of the rows in Hz.
fn rate(fields: &mut Fields<'_>, table: &DeTable<'_>) -> Option<f64> {
    let value = table.get("rate")?;
    let rate = fields.number(value)?;
    if rate > 0.0 && rate < MOST_RATE {
        return Some(rate);
    }
    let message = format!("`rate` is the number of rows per second, not {rate}");
    fields.tell(Code::ValueOutsideLimits, message, value.span(), "");
    None
}

/// The lines of the channels, with one for each column of a pattern that no other line describes.
fn lines<'e>(
    fields: &mut Fields<'_>,
    entries: &[(&'e Spanned<Cow<'e, str>>, &'e Value<'e>)],
    named: Named<'_>,
    columns: Columns<'_>,
) -> Vec<Line<'e>> {
    let header = LazyCell::new(columns);
    let mut lines: Vec<Line<'e>> = Vec::new();
    let is_own = |column: &str| entries.iter().any(|(key, _)| key.get_ref() == column);
    for (key, value) in entries {
        let (name, at) = (key.get_ref().as_ref(), key.span());
        let whole = Line {
            column: name.to_owned(),
            value,
            at: at.clone(),
            filling: None,
        };
        if !name.contains('*') {
            lines.push(whole);
            continue;
        }
        let Some(header) = header.as_ref() else {
            let message = "the columns of the first run cannot be read, so the pattern finds none";
            fields.tell(Code::NotAllowedHere, message, at, "");
            continue;
        };
        if header.iter().any(|column| column == name) {
            lines.push(whole);
            continue;
        }
        let is_free = |column: &str| !is_own(column) && !lines.iter().any(|l| l.column == column);
        let mut found: Vec<(String, String)> = header
            .iter()
            .filter(|column| is_free(column))
            .filter_map(|column| Some((column.clone(), filling(name, column)?.to_owned())))
            .take(MOST_COLUMNS)
            .collect();
        number(fields, value, &mut found);
        let all = found.len();
        let first = found.first().cloned();
        // Of all columns of the pattern, those whose filling is a name of the mechanism.
        let fits = |filling: &str| named.is_known(value, filling);
        found.retain(|(_, filling)| fits(filling));
        match (found.is_empty(), first) {
            (true, None) => {
                let message = format!("no column fits the pattern `{}`", shown(name));
                let list: Vec<String> = header.iter().take(8).map(|own| shown(own)).collect();
                let help = format!("the first run has {}", list.join(", "));
                fields.tell(Code::MissingKey, message, at, &help);
            }
            (true, Some((column, filling))) => {
                let message = format!(
                    "of {all} columns of the pattern `{}`, such as `{}`, none names a quantity",
                    shown(name),
                    shown(&column)
                );
                let help = format!("`*` stands for `{}` there", shown(&filling));
                fields.tell(Code::UnknownName, message, at, &help);
            }
            (false, _) => lines.extend(found.into_iter().map(|(column, filling)| Line {
                column,
                value,
                at: at.clone(),
                filling: Some(filling),
            })),
        }
    }
    lines
}

/// What `*` stands for in a name; `None` if the name does not fit the pattern.
fn filling<'n>(pattern: &str, name: &'n str) -> Option<&'n str> {
    let (before, after) = pattern.split_once('*')?;
    let filling = name.strip_prefix(before)?.strip_suffix(after)?;
    (!filling.is_empty()).then_some(filling)
}

/// Replaces the numbers of columns by the names in a list, the least number by the first one.
fn number(fields: &mut Fields<'_>, value: &Value<'_>, found: &mut Vec<(String, String)>) {
    let table = value.get_ref().as_table();
    let list = ["measures", "input"].into_iter().find_map(|key| {
        let list = table?.get(key)?;
        list.get_ref().as_array().map(|_| (key, list.span()))
    });
    let (Some(table), Some((key, at))) = (table, list) else {
        return;
    };
    let names = fields.strings(table, key);
    let numbered = found.iter().filter_map(|(column, filling)| {
        let number: usize = filling.parse().ok()?;
        Some((number, column.clone()))
    });
    let mut numbered: Vec<(usize, String)> = numbered.collect();
    numbered.sort_unstable();
    if numbered.len() != names.len() {
        let message = format!(
            "the list has {} names, but {} numbered columns fit the pattern",
            names.len(),
            numbered.len()
        );
        let help = "write a name for each column, in the order of their numbers";
        fields.tell(Code::WrongType, message, at, help);
        found.clear();
        return;
    }
    let pairs = numbered.into_iter().zip(names);
    *found = pairs
        .map(|((_, column), (name, _))| (column, name))
        .collect();
}

#[cfg(test)]
mod tests {
    use super::filling;

    #[test]
    fn a_pattern_is_filled() {
        assert_eq!(filling("q_*", "q_elbow"), Some("elbow"));
        assert_eq!(filling("state[*]", "state[12]"), Some("12"));
        assert_eq!(filling("aba*aba", "aba"), None);
        assert_eq!(filling("q_*", "q_"), None);
    }
}
