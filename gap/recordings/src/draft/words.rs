//! Names of columns: their words, and what these say of kind and unit.

/// What a column is, by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Position,
    Rate,
    Torque,
    Command,
}

/// Words of commands, of whatever quantity.
const COMMANDS: [&str; 17] = [
    "cmd",
    "cmds",
    "command",
    "commands",
    "commanded",
    "u",
    "ctrl",
    "control",
    "des",
    "desired",
    "target",
    "goal",
    "ref",
    "reference",
    "setpoint",
    "action",
    "actions",
];
/// Words of commands that stand in names of measured quantities as well, as in `motor_position`.
const DRIVES: [&str; 9] = [
    "act", "actuator", "servo", "motor", "drive", "input", "current", "currents", "amps",
];
const RATES: [&str; 16] = [
    "dq",
    "qd",
    "qdot",
    "dot",
    "vel",
    "velocity",
    "velocities",
    "rate",
    "rates",
    "speed",
    "speeds",
    "omega",
    "qvel",
    "dtheta",
    "rpm",
    "gyro",
];
const TORQUES: [&str; 12] = [
    "tau", "torque", "torques", "trq", "eff", "effort", "efforts", "moment", "force", "forces",
    "load", "qfrc",
];
const POSITIONS: [&str; 16] = [
    "q",
    "pos",
    "position",
    "positions",
    "angle",
    "angles",
    "ang",
    "theta",
    "enc",
    "encoder",
    "encoders",
    "qpos",
    "state",
    "present",
    "actual",
    "counts",
];
/// Words that say nothing.
const PLAIN: [&str; 18] = [
    "joint",
    "joints",
    "states",
    "observation",
    "obs",
    "robot",
    "arm",
    "data",
    "meas",
    "measured",
    "msg",
    "the",
    "of",
    "value",
    "values",
    "j",
    "m",
    "points",
];
/// Units that names end with, in the notation of descriptions.
const UNITS: [(&str, &str); 10] = [
    ("deg", "deg"),
    ("degs", "deg"),
    ("degree", "deg"),
    ("degrees", "deg"),
    ("rad", "rad"),
    ("rads", "rad"),
    ("radian", "rad"),
    ("radians", "rad"),
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
    let has = |list: &[&str]| words.iter().any(|word| list.contains(word));
    if has(&COMMANDS) {
        return Some(Kind::Command);
    }
    if has(&RATES) {
        return Some(Kind::Rate);
    }
    if has(&TORQUES) {
        return Some(Kind::Torque);
    }
    if has(&POSITIONS) {
        return Some(Kind::Position);
    }
    has(&DRIVES).then_some(Kind::Command)
}

/// The unit that a name states.
pub(super) fn unit(words: &[String]) -> Option<&'static str> {
    let known = |word: &String| UNITS.iter().find(|(own, _)| own == word);
    words.iter().rev().find_map(known).map(|(_, unit)| *unit)
}

/// Whether words say that a command is a current.
pub(super) fn is_current(words: &[String]) -> bool {
    let known = ["current", "currents", "amps", "amp"];
    words.iter().any(|word| known.contains(&word.as_str()))
}

/// How many words say nothing that is known.
pub(super) fn unknown(words: &[&str]) -> usize {
    let lists: [&[&str]; 6] = [&COMMANDS, &DRIVES, &RATES, &TORQUES, &POSITIONS, &PLAIN];
    let is_unit = |word: &str| UNITS.iter().any(|(own, _)| *own == word) || word == "s";
    let is_known = |word: &str| lists.iter().any(|list| list.contains(&word)) || is_unit(word);
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
