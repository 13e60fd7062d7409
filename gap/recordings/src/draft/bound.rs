//! Which column is which quantity, by names: of joints and actuators, else by number and kind.

use std::collections::BTreeMap;

use super::evidence::{follows, rate_of};
use super::log::Log;
use super::quantities::Quantity;
use super::words::{Kind, kind, unknown, without, words};

/// A column with its quantity.
#[derive(Debug, Clone)]
pub(super) struct Bound {
    pub(super) column: usize,
    pub(super) quantity: usize,
    /// What the name leaves open.
    pub(super) doubt: Option<String>,
}

/// A column that may be a quantity.
struct Candidate {
    score: i32,
    bound: Bound,
}

/// Least correlation by which the numbers alone tell a quantity.
const ALIKE: f64 = 0.95;

/// Binds columns to quantities, each to one at most.
pub(super) fn bind(log: &Log, columns: &[usize], quantities: &[Quantity]) -> Vec<Bound> {
    let mut candidates: Vec<Candidate> = Vec::new();
    for &column in columns {
        let words = words(&log.names[column]);
        for (index, quantity) in quantities.iter().enumerate() {
            candidates.extend(by_name(column, &words, index, quantity));
        }
    }
    candidates.sort_by_key(|own| (-own.score, own.bound.column));
    let mut bound: Vec<Bound> = Vec::new();
    for Candidate { bound: own, .. } in candidates {
        take(&mut bound, own);
    }
    for own in by_number(log, columns, quantities, &bound) {
        take(&mut bound, own);
    }
    torques_or_commands(log, quantities, &mut bound);
    for own in by_numbers_alone(log, columns, quantities, &bound) {
        take(&mut bound, own);
    }
    bound.sort_by_key(|own| own.column);
    bound
}

/// Adds a pair whose column and quantity are free.
fn take(bound: &mut Vec<Bound>, own: Bound) {
    let is_taken = |other: &Bound| other.column == own.column || other.quantity == own.quantity;
    if !bound.iter().any(is_taken) {
        bound.push(own);
    }
}

/// A column that contains the name of a quantity.
fn by_name(
    column: usize,
    words: &[String],
    index: usize,
    quantity: &Quantity,
) -> Option<Candidate> {
    let own_words = super::words::words(&quantity.name);
    let fits = |(place, alias): (usize, &Vec<String>)| {
        let rest = without(words, alias)?;
        let said = kind(&rest);
        let strange = unknown(&rest);
        let is_whole = *alias == own_words;
        let is_bare = said.is_none() && strange == 0 && is_whole;
        // The name of an actuator alone says that it is a command, that of its joint does not.
        let is_said = said == Some(quantity.kind)
            && (quantity.kind != Kind::Command || place == 0 || strange == 0);
        let length = i32::try_from(alias.len()).unwrap_or(0);
        let doubts = i32::try_from(strange).unwrap_or(0);
        let score = 10 * length + if is_said { 4 } else { 0 } + if rest.is_empty() { 5 } else { 0 }
            - 3 * doubts
            + i32::from(quantity.kind == Kind::Position);
        let is_candidate = is_bare || is_said;
        is_candidate.then_some((score, strange))
    };
    let all = quantity.words.iter().enumerate().filter_map(fits);
    let (score, strange) = all.max_by_key(|(score, _)| *score)?;
    let doubt = (strange > 0).then(|| format!("is this `{}`?", quantity.name));
    Some(Candidate {
        score,
        bound: Bound {
            column,
            quantity: index,
            doubt,
        },
    })
}

/// Columns that differ by a number alone, `q1`, `q2` …, in the order of the joints or actuators.
fn by_number(log: &Log, columns: &[usize], quantities: &[Quantity], bound: &[Bound]) -> Vec<Bound> {
    let mut groups: BTreeMap<Vec<String>, Vec<(usize, usize)>> = BTreeMap::new();
    let is_free = |column: &&usize| !bound.iter().any(|own| own.column == **column);
    for &column in columns.iter().filter(is_free) {
        let mut words = words(&log.names[column]);
        let place = words.iter().rposition(|word| word.parse::<usize>().is_ok());
        let number = place.and_then(|place| words.remove(place).parse().ok());
        groups
            .entry(words)
            .or_default()
            .push((number.unwrap_or(0), column));
    }
    let mut found = Vec::new();
    for (words, mut members) in groups {
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let Some(kind) = kind(&words).filter(|_| unknown(&words) == 0) else {
            continue;
        };
        members.sort_unstable();
        let of = |kind: Kind| -> Vec<usize> {
            let all = quantities.iter().enumerate();
            let own = all.filter(|(_, quantity)| quantity.kind == kind);
            own.map(|(index, _)| index).collect()
        };
        let mut wanted = of(kind);
        if wanted.is_empty() && kind == Kind::Torque {
            // The torques of joints without actuators in the file are the inputs.
            wanted = of(Kind::Command);
            wanted.retain(|&input| !quantities[input].has_angle);
        }
        let mut pair = |column: usize, quantity: Option<&usize>, doubt: Option<String>| {
            found.extend(quantity.map(|&quantity| Bound {
                column,
                quantity,
                doubt,
            }));
        };
        let order = "the columns are taken in the order of the file";
        if members.len() == wanted.len() {
            for ((_, column), quantity) in members.iter().zip(&wanted) {
                pair(*column, Some(quantity), None);
            }
        } else if kind == Kind::Position && members.len() % wanted.len().max(1) == 0 {
            let parts = [Kind::Position, Kind::Rate, Kind::Torque];
            for (part, kind) in members.chunks(wanted.len().max(1)).zip(parts) {
                for ((_, column), quantity) in part.iter().zip(&of(kind)) {
                    let doubt = format!("positions, then rates and torques: {order}; is it right?");
                    pair(*column, Some(quantity), Some(doubt));
                }
            }
        } else {
            let base = usize::from(members.iter().all(|(number, _)| *number > 0));
            for (number, column) in &members {
                let name = number.checked_sub(base).and_then(|place| wanted.get(place));
                let doubt = format!(
                    "{} columns, but {} such quantities: {order}; is it right?",
                    members.len(),
                    wanted.len()
                );
                pair(*column, name, Some(doubt));
            }
        }
    }
    found
}

/// Torques of motors whose command has no column are probably those commands.
fn torques_or_commands(log: &Log, quantities: &[Quantity], bound: &mut [Bound]) {
    let has = |bound: &[Bound], quantity: usize| bound.iter().any(|own| own.quantity == quantity);
    for (index, command) in quantities.iter().enumerate() {
        let is_motor = command.kind == Kind::Command && !command.has_angle;
        if !is_motor || command.axis.is_none() || has(bound, index) {
            continue;
        }
        let is_torque = |own: &&mut Bound| {
            let quantity = &quantities[own.quantity];
            quantity.kind == Kind::Torque && quantity.axis == command.axis
        };
        if let Some(own) = bound.iter_mut().find(is_torque) {
            let name = &log.names[own.column];
            own.doubt = Some(format!(
                "no other column is the command of `{}`; is `{name}` commanded, or measured?",
                command.name
            ));
            own.quantity = index;
        }
    }
}

/// Rates and commands of positions that numbers alone tell.
fn by_numbers_alone(
    log: &Log,
    columns: &[usize],
    quantities: &[Quantity],
    bound: &[Bound],
) -> Vec<Bound> {
    let is_bound = |quantity: usize| bound.iter().any(|own| own.quantity == quantity);
    let mut free = columns.to_vec();
    free.retain(|column| !bound.iter().any(|own| own.column == *column));
    free.retain(|column| !log.is_constant(*column));
    // Every pair is compared over all delays; a log with very many unknown columns is left to the person.
    free.truncate(32);
    let mut found = Vec::new();
    for (index, quantity) in quantities.iter().enumerate() {
        let is_command = quantity.is_position_command();
        if is_bound(index) || !(quantity.kind == Kind::Rate || is_command) {
            continue;
        }
        let position = bound.iter().find(|own| {
            let other = &quantities[own.quantity];
            other.kind == Kind::Position && quantity.axis.is_some() && other.axis == quantity.axis
        });
        let Some(position) = position else { continue };
        let likeness = |column: usize| {
            let relation = if is_command {
                let (relation, delay) = follows(log, column, position.column)?;
                (delay >= 0.0).then_some(relation)
            } else {
                rate_of(log, position.column, column)
            }?;
            Some(relation.correlation.abs()).filter(|own| *own > ALIKE)
        };
        let best = free
            .iter()
            .filter_map(|&column| Some((likeness(column)?, column)))
            .max_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((_, column)) = best {
            free.retain(|own| *own != column);
            found.push(Bound {
                column,
                quantity: index,
                doubt: Some(format!(
                    "by its motion alone it is `{}`; is it?",
                    quantity.name
                )),
            });
        }
    }
    found
}
