//! A robot file as the mechanism of recordings: its spec, and the names of the file.

use std::path::Path;

use appell_files::FileError;
use appell_robots::{Dictionary, Entry, Failure, Format, Letters, Options};

use crate::{DataError, Spec};

/// Largest mesh, in bytes.
const MAX_MESH: u64 = 1 << 28;

/// A robot whose file is the mechanism.
#[derive(Debug, Clone)]
pub struct Robot {
    /// Path of the file.
    pub file: String,
    /// Its names in the spec.
    pub dictionary: Dictionary,
}

impl Robot {
    /// Reads a robot; numbers that `keys` name, `elbow.damping` or `*.mass`, become parameters of the spec. `None` if
    /// the text is of no robot.
    pub(crate) fn read(
        path: &Path,
        text: &str,
        keys: Vec<String>,
    ) -> Result<Option<(Spec, Self)>, DataError> {
        if Format::of(text).is_none() {
            return Ok(None);
        }
        let file = path.to_string_lossy().replace('\\', "/");
        let folder = path.parent().unwrap_or(Path::new(""));
        let others = |name: &str| {
            let path = appell_files::within(folder, folder, name);
            let bytes = path.and_then(|path| appell_files::read(&path, MAX_MESH));
            bytes.map_err(|why: FileError| why.to_string())
        };
        let options = Options {
            letters: Letters::Matching(keys),
            actuators: true,
            ..Options::default()
        };
        let imported = appell_robots::import_with(&file, text, &options, &others);
        let imported = imported.map_err(|failure| match failure {
            Failure::File(report) => DataError::Report(report),
            Failure::Lock(why) => DataError::whole(&*file, why),
            Failure::Unknown { name, help } => DataError::whole(
                &*file,
                format!("`[parameters]` names `{name}`, which the robot does not have; {help}"),
            ),
        })?;
        let spec = Spec {
            file: file.clone(),
            text: imported.spec,
        };
        let dictionary = imported.dictionary;
        Ok(Some((spec, Self { file, dictionary })))
    }

    /// The numbers that a key names: one, the components of one, or with `*` those of all elements.
    pub(crate) fn numbers<'s>(&'s self, key: &str) -> impl Iterator<Item = &'s Entry> {
        let (element, attribute) = match key.strip_prefix("*.") {
            Some(attribute) => (None, attribute),
            None => (Some(key), ""),
        };
        let attribute = attribute.to_owned();
        let element = element.map(str::to_owned);
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

    /// The input of an actuator.
    pub(crate) fn input(&self, name: &str) -> Option<&str> {
        let mut actuators = self.dictionary.actuators.iter();
        let actuator = actuators.find(|actuator| actuator.name == name)?;
        Some(&actuator.input)
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

    /// A text with the parameters of the spec under the names of their numbers in the file. Names of elements with
    /// other characters than letters, digits, `_`, `-`, `.` and `/` stay, for they may mean something in the text.
    pub fn named(&self, text: &str) -> String {
        let is_part = |c: char| c.is_alphanumeric() || c == '_';
        let is_plain = |c: char| is_part(c) || "-./".contains(c);
        let mut named = String::with_capacity(text.len());
        let mut rest = text;
        while let Some(start) = rest.find(is_part) {
            named.push_str(&rest[..start]);
            let word = &rest[start..];
            let end = word.find(|c| !is_part(c)).unwrap_or(word.len());
            let (word, after) = word.split_at(end);
            let mut entries = self.dictionary.entries.iter();
            match entries.find(|entry| entry.parameter == word) {
                Some(entry) if entry.element.chars().all(is_plain) => {
                    named.push_str(&entry.element);
                    named.push('.');
                    named.push_str(entry.attribute);
                }
                _ => named.push_str(word),
            }
            rest = after;
        }
        named + rest
    }
}
