//! A robot file as the mechanism of recordings: its spec, and the names of the file.

use std::path::Path;

use appell_files::FileError;
use appell_robots::{ActuatorName, Dictionary, Entry, Failure, Format, Letters, Options};
use appell_spec::mechanism::Interpolation;
use appell_spec::{Code, Mechanism, shown};
use toml::de::DeTable;

use crate::channel::{Channel, Role};
use crate::fields::Fields;
use crate::{DataError, Run, Spec};

/// Times that differ by less, in s, are equal.
const ROUNDING: f64 = 1e-9;
/// Largest mesh, in bytes.
const MAX_MESH: u64 = 1 << 28;

/// A robot whose file is the mechanism.
#[derive(Debug, Clone)]
pub struct Robot {
    /// Path of the file.
    pub file: String,
    /// Its format.
    pub format: Format,
    /// Joints that are made rigid.
    pub locked: Vec<String>,
    /// Its names in the spec.
    pub dictionary: Dictionary,
}

impl Robot {
    /// Reads a robot; numbers that `keys` name, `elbow.damping` or `*.mass`, become parameters of the spec. `None` if
    /// the text is of no robot.
    pub(crate) fn read(
        path: &Path,
        text: &str,
        mut keys: Vec<String>,
        options: &Options,
    ) -> Result<Option<(Spec, Self)>, DataError> {
        if Format::of(text).is_none() {
            let asked = !options.lock.is_empty() || options.floating || options.grounded;
            let why = "the mechanism is a spec: `lock` and `base` are keys for robot files";
            return if asked {
                Err(DataError::whole(path.to_string_lossy(), why))
            } else {
                Ok(None)
            };
        }
        for key in &mut keys {
            *key = in_words_of_import(key);
        }
        let file = path.to_string_lossy().replace('\\', "/");
        let folder = path.parent().unwrap_or(Path::new(""));
        let others = |name: &str| {
            let path = appell_files::within(folder, folder, name);
            let bytes = path.and_then(|path| appell_files::read(&path, MAX_MESH));
            bytes.map_err(|why: FileError| why.to_string())
        };
        let imported = loop {
            let options = Options {
                letters: Letters::Matching(keys.clone()),
                ..options.clone()
            };
            match appell_robots::import_with(&file, text, &options, &others) {
                Ok(imported) => break imported,
                Err(Failure::File(report)) => return Err(DataError::Report(report)),
                Err(Failure::Lock(why)) => return Err(DataError::whole(&*file, why)),
                // The description has its place, and reports it.
                Err(Failure::Unknown { name, .. }) if keys.contains(&name) => {
                    keys.retain(|key| *key != name);
                }
                Err(Failure::Unknown { name, help }) => {
                    return Err(DataError::whole(
                        &*file,
                        format!("`{name}` is unknown; {help}"),
                    ));
                }
            }
        };
        let spec = Spec {
            file: file.clone(),
            text: imported.spec,
        };
        let robot = Self {
            file,
            format: imported.format,
            locked: options.lock.iter().map(|lock| lock.joint.clone()).collect(),
            dictionary: imported.dictionary,
        };
        Ok(Some((spec, robot)))
    }

    /// The numbers that a key names: one, the components of one, or with `*` those of all elements.
    pub(crate) fn numbers<'s>(&'s self, key: &str) -> impl Iterator<Item = &'s Entry> {
        let key = in_words_of_import(key);
        let (element, attribute) = match key.strip_prefix("*.") {
            Some(attribute) => (None, attribute.to_owned()),
            None => (Some(key), String::new()),
        };
        let is_or_holds = |whole: &str, name: &str| {
            let rest = name.strip_prefix(whole);
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        };
        self.dictionary
            .entries
            .iter()
            .filter(move |entry| match &element {
                Some(key) => is_or_holds(key, &format!("{}.{}", entry.element, entry.attribute)),
                None => is_or_holds(&attribute, entry.attribute),
            })
    }

    /// The quantity of the spec that a channel measures: a joint, its velocity, or its torque.
    pub(crate) fn measured(&self, name: &str) -> Option<&str> {
        self.dictionary.joints.iter().find_map(|joint| {
            match name.strip_prefix(joint.name.as_str())? {
                "" => Some(&*joint.coordinate),
                ".velocity" => Some(&*joint.velocity),
                ".torque" => joint.torque.as_deref(),
                _ => None,
            }
        })
    }

    /// Whether a name is the torque of a joint on which no actuator acts.
    pub(crate) fn is_undriven(&self, name: &str) -> bool {
        let joint = name.strip_suffix(".torque");
        let mut joints = self.dictionary.joints.iter();
        joints.any(|own| Some(own.name.as_str()) == joint && own.torque.is_none())
    }

    /// The input of an actuator.
    pub(crate) fn input(&self, name: &str) -> Option<&str> {
        let mut actuators = self.dictionary.actuators.iter();
        let actuator = actuators.find(|actuator| actuator.name == name)?;
        Some(&actuator.input)
    }

    /// The actuator of an input of the spec.
    fn actuator_of(&self, input: &str) -> Option<&ActuatorName> {
        let mut actuators = self.dictionary.actuators.iter();
        actuators.find(|actuator| actuator.input == input)
    }

    /// Whether an input of the spec is the command of an actuator that is neither a position nor a velocity.
    pub(crate) fn is_ctrl(&self, input: &str) -> bool {
        let mut actuators = self.dictionary.actuators.iter();
        actuators.any(|actuator| actuator.input == input && !actuator.is_servo)
    }

    /// Replaces commands by what the actuators make of them, where these have a filter or a delay. An input with
    /// interpolation is taken as it is.
    pub(crate) fn drive(&self, runs: &mut [Run], channels: &mut [Channel], mechanism: &Mechanism) {
        for (index, channel) in channels.iter_mut().enumerate() {
            let (Role::Input(_), None) = (channel.role, channel.interpolation) else {
                continue;
            };
            let Some(label) = channel.role.label(mechanism) else {
                continue;
            };
            let Some(actuator) = self.actuator_of(&label.name) else {
                continue;
            };
            if actuator.lag <= 0.0 && actuator.delay <= 0.0 {
                continue;
            }
            for run in runs.iter_mut() {
                let command = &run.values[index];
                run.values[index] = followed(&run.times, command, actuator.lag, actuator.delay);
            }
            if actuator.lag > 0.0 {
                channel.interpolation = Some(Interpolation::Linear);
            }
        }
    }

    /// All names that channels may measure.
    pub(crate) fn quantities(&self) -> Vec<String> {
        let joints = self.dictionary.joints.iter();
        let named = joints.flat_map(|joint| {
            let torque = joint
                .torque
                .as_ref()
                .map(|_| format!("{}.torque", joint.name));
            [
                Some(joint.name.clone()),
                Some(format!("{}.velocity", joint.name)),
                torque,
            ]
        });
        named.flatten().collect()
    }

    /// A text with the names of the file for those of the spec. Names with other characters than letters, digits, `_`,
    /// `-`, `.` and `/` stay, for they may mean something in the text.
    pub fn named(&self, text: &str) -> String {
        let is_part = |c: char| c.is_alphanumeric() || c == '_';
        let is_plain = |name: &String| name.chars().all(|c| is_part(c) || "-./".contains(c));
        let mut named = String::with_capacity(text.len());
        let mut rest = text;
        while let Some(start) = rest.find(is_part) {
            named.push_str(&rest[..start]);
            let word = &rest[start..];
            let end = word.find(|c| !is_part(c)).unwrap_or(word.len());
            let (word, after) = word.split_at(end);
            let own = self.name_of(word).filter(is_plain);
            named.push_str(own.as_deref().unwrap_or(word));
            rest = after;
        }
        named + rest
    }

    /// The name in the file of a parameter, an input or a coordinate.
    fn name_of(&self, word: &str) -> Option<String> {
        let Dictionary {
            entries, joints, ..
        } = &self.dictionary;
        let number = entries.iter().find(|entry| entry.parameter == word);
        let number = number.map(|entry| format!("{}.{}", entry.element, entry.attribute));
        let joint = || joints.iter().find(|joint| joint.coordinate == word);
        number
            .or_else(|| self.actuator_of(word).map(|actuator| actuator.name.clone()))
            .or_else(|| joint().map(|joint| joint.name.clone()))
    }
}

/// A key of `[parameters]`: URDF calls dry friction `friction`.
fn in_words_of_import(key: &str) -> String {
    match key.strip_suffix(".friction") {
        Some(element) => format!("{element}.frictionloss"),
        None => key.to_owned(),
    }
}

/// The options of a description: `lock = ["wrist"]` and `base = "floating"` or `"fixed"`.
pub(crate) fn options(fields: &mut Fields<'_>, table: &DeTable<'_>) -> Options {
    let mut options = Options {
        actuators: true,
        ..Options::default()
    };
    for (text, at) in fields.strings(table, "lock") {
        match text.parse() {
            Ok(lock) => options.lock.push(lock),
            Err(why) => fields.tell(Code::WrongType, why, at, ""),
        }
    }
    match fields.string(table, "base") {
        Some((word, _)) if word == "floating" => options.floating = true,
        Some((word, _)) if word == "fixed" => options.grounded = true,
        Some((word, at)) => {
            let message = format!("`{}` is no kind of base", shown(&word));
            let help = "write \"fixed\" or \"floating\"";
            fields.tell(Code::UnknownName, message, at, help);
        }
        None => {}
    }
    options
}

/// What an actuator makes of its command: after its delay, the output of its filter. The command is held from each row
/// to the next; the output is to be joined by lines, which have the mean of the filter's output in each interval.
pub(crate) fn followed(times: &[f64], command: &[f64], lag: f64, delay: f64) -> Vec<f64> {
    let held: Vec<f64> = times
        .iter()
        .map(|time| {
            let since = times.partition_point(|own| *own <= time - delay + ROUNDING);
            command[since.saturating_sub(1)]
        })
        .collect();
    if lag <= 0.0 {
        return held;
    }
    let mut output = Vec::with_capacity(held.len());
    output.extend(held.first());
    // By how much the mean in an interval exceeds that of a line.
    let mut excess = Vec::with_capacity(held.len());
    for (row, pair) in times.windows(2).enumerate() {
        let step = pair[1] - pair[0];
        let (from, to) = (output[row], held[row]);
        let left = (-step / lag).exp();
        let next = to + (from - to) * left;
        let mean = to + (from - to) * (1.0 - left) * lag / step;
        output.push(next);
        excess.push(mean - f64::midpoint(from, next));
    }
    for (row, value) in output.iter_mut().enumerate() {
        let before = row.checked_sub(1).and_then(|row| excess.get(row));
        let sides = [before, excess.get(row)];
        let sides: Vec<f64> = sides.into_iter().flatten().copied().collect();
        *value += sides.iter().sum::<f64>() / sides.len().max(1) as f64;
    }
    output
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_output_of_a_filter_has_its_mean_in_every_interval() {
        let (step, lag, slope) = (0.01, 0.025, 3.0);
        let times: Vec<f64> = (0..200).map(|row| f64::from(row) * step).collect();
        let command: Vec<f64> = times.iter().map(|time| slope * time).collect();
        let output = followed(&times, &command, lag, 0.0);
        // Behind a ramp that is held, the mean output lags by the time constant and half a step.
        for row in 100..199 {
            let mean = f64::midpoint(output[row], output[row + 1]);
            let expected = slope * (times[row] - lag);
            assert!((mean - expected).abs() < 1e-9, "{mean} {expected}");
        }
        let late = followed(&times, &command, 0.0, 0.02);
        assert!((late[50] - command[48]).abs() < 1e-12);
    }
}
