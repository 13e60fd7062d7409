//! Names of columns: their words, and what these say of kind and unit.

use crate::time::has;

/// What a column is, by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Position,
    Rate,
    Torque,
    Command,
}

/// Words of commands, of whatever quantity.
const COMMANDS: &str = "cmd cmds command commands commanded u ctrl control des desired target goal ref reference setpoint \
    action actions";
/// Words of commands that stand in names of measured quantities as well, as in `motor_position`.
const DRIVES: &str = "act actuator servo motor drive input current currents amps";
const RATES: &str =
    "dq qd qdot dot vel velocity velocities rate rates speed speeds omega qvel dtheta rpm gyro";
const TORQUES: &str = "tau torque torques trq eff effort efforts moment force forces load qfrc";
const POSITIONS: &str = "q pos position positions angle angles ang theta enc encoder encoders qpos state present actual \
    counts";
/// Words that say nothing.
const PLAIN: &str = "joint joints states observation obs robot arm data meas measured msg the of value values j m points";
/// Units that names end with, in the notation of descriptions.
const UNITS: [(&str, &str); 4] = [
    ("deg degs degree degrees", "deg"),
    ("rad rads radian radians", "rad"),
    ("rpm", "rpm"),
    ("mm", "mm"),
];

/// The words of a name, in small letters: `leftKnee_pos[3]` is `left`, `knee`, `pos`, `3`.
pub(super) fn words(name: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut last = ' ';
    for c in name.chars() {
        if c.is_alphanumeric() {
            let changes = last.is_ascii_digit() != c.is_ascii_digit();
            let is_hump = last.is_lowercase() && c.is_uppercase();
            let begins = !last.is_alphanumeric() || changes || is_hump;
            let small = c.to_lowercase();
            match words.last_mut() {
                Some(word) if !begins => word.extend(small),
                _ => words.push(small.collect()),
            }
        }
        last = c;
    }
    words
}

/// What is left of the words of a column without those of a name; `None` if it lacks one of them.
pub(super) fn without<'w>(words: &'w [String], name: &[String]) -> Option<Vec<&'w str>> {
    let mut rest: Vec<&str> = words.iter().map(String::as_str).collect();
    for word in name {
        let place = rest.iter().position(|own| own == word)?;
        rest.remove(place);
    }
    Some(rest)
}

/// The kind that words say; `None` if they say none.
pub(super) fn kind(words: &[&str]) -> Option<Kind> {
    let kinds = [
        (COMMANDS, Kind::Command),
        (RATES, Kind::Rate),
        (TORQUES, Kind::Torque),
        (POSITIONS, Kind::Position),
        (DRIVES, Kind::Command),
    ];
    let is_said = |list: &str| words.iter().any(|word| has(list, word));
    let said = kinds.into_iter().find(|(list, _)| is_said(list));
    said.map(|(_, kind)| kind)
}

/// The unit that a word states.
fn unit_of(word: &str) -> Option<&'static str> {
    let mut units = UNITS.iter();
    let found = units.find(|(words, _)| has(words, word));
    found.map(|(_, unit)| *unit)
}

/// The unit that a name states.
pub(super) fn unit(words: &[String]) -> Option<&'static str> {
    words.iter().rev().find_map(|word| unit_of(word))
}

/// Whether words say that a command is a current.
pub(super) fn is_current(words: &[String]) -> bool {
    words
        .iter()
        .any(|word| has("current currents amps amp", word))
}

/// How many words say nothing that is known.
pub(super) fn unknown(words: &[&str]) -> usize {
    let lists = [COMMANDS, DRIVES, RATES, TORQUES, POSITIONS, PLAIN];
    let is_unit = |word: &str| unit_of(word).is_some() || word == "s";
    let is_known = |word: &str| lists.iter().any(|list| has(list, word)) || is_unit(word);
    words.iter().filter(|word| !is_known(word)).count()
}

#[cfg(test)]
mod tests {
    use super::{Kind, kind, words};

    #[test]
    fn names_are_split_and_understood() {
        assert_eq!(words("leftKnee_pos[3]"), ["left", "knee", "pos", "3"]);
        assert_eq!(words("dq12"), ["dq", "12"]);
        for (name, expected) in [
            ("q1", Some(Kind::Position)),
            ("q_dot_1", Some(Kind::Rate)),
            ("q_des", Some(Kind::Command)),
            ("motor_position", Some(Kind::Position)),
            ("motor", Some(Kind::Command)),
            ("room", None),
        ] {
            let words = words(name);
            let words: Vec<&str> = words.iter().map(String::as_str).collect();
            assert_eq!(kind(&words), expected, "{name}");
        }
    }
}
