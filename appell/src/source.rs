//! Specs: shipped ones by name, others by path; robot files as the specs that they become.

use std::path::Path;
use std::sync::Arc;

use appell_models::ALL;
pub use appell_models::Shipped;
use appell_recordings::Spec;
use appell_robots::{Format, Imported, Letters, Options};
use appell_spec::limits::MAX_FILE;

use crate::{Error, Field, files, robot};

/// A spec.
#[derive(Debug)]
pub struct Source {
    /// Name of the file, for messages and emitted code.
    pub file: String,
    /// Its text.
    pub text: String,
    /// The compiled mechanism, if it is shipped.
    pub shipped: Option<&'static Shipped>,
    /// The robot file that it was made from.
    pub robot: Option<Arc<Robot>>,
}

/// A robot file whose spec is a source.
#[derive(Debug)]
pub struct Robot {
    /// Its text.
    pub text: String,
    /// What was read, without the spec.
    pub imported: Imported,
}

impl Robot {
    /// What its equations lack although the motion is another one without it, a sentence each.
    pub fn remarks(&self) -> Vec<String> {
        let filters = self.imported.dictionary.actuators.iter();
        let filters = filters.filter_map(|one| {
            let known = [("filter", one.lag), ("delay", one.delay)].into_iter();
            let known = known.filter(|(_, seconds)| *seconds > 0.0);
            let known: Vec<String> = known
                .map(|(what, seconds)| format!("the {what} of {seconds} s"))
                .collect();
            (!known.is_empty()).then(|| {
                format!(
                    "the actuator {} follows its command at once here; {} of the file acts on the inputs of a data set \
                     alone",
                    one.name,
                    known.join(" with ")
                )
            })
        });
        let left_out = self.imported.left_out.iter().filter_map(|one| {
            let effect = one.effect?;
            let lines: Vec<String> = one.lines.iter().map(ToString::to_string).collect();
            let s = if lines.len() == 1 { "" } else { "s" };
            Some(format!(
                "left out, which changes the motion: {} in line{s} {} ({effect})",
                one.what,
                lines.join(", ")
            ))
        });
        left_out.chain(filters).collect()
    }
}

impl Source {
    /// The text of a spec and the name of its file.
    pub fn of(file: impl Into<String>, text: impl Into<String>) -> Self {
        Self {
            file: file.into(),
            text: text.into(),
            shipped: None,
            robot: None,
        }
    }

    /// A shipped name, or the path of a spec or a robot file; `-` is standard input. A shipped name takes precedence;
    /// `./name` is the file.
    pub fn find(model: &str) -> Result<Self, Error> {
        Self::find_with(model, &[])
    }

    /// The same; these numbers of a robot file, `elbow.damping` or `*.mass`, become parameters.
    pub fn find_with(model: &str, numbers: &[&str]) -> Result<Self, Error> {
        if Shipped::find(model).is_some() {
            return Self::shipped(model);
        }
        let path = Path::new(model);
        if files::is_stdout(path) {
            return Self::read_with(path, numbers);
        }
        let is_path = path.components().count() > 1 || path.extension().is_some() || path.exists();
        if is_path {
            Self::read_with(path, numbers)
        } else {
            Err(Error::request(Field::Model, unknown(model)))
        }
    }

    /// A shipped spec.
    pub fn shipped(name: &str) -> Result<Self, Error> {
        let shipped =
            Shipped::find(name).ok_or_else(|| Error::request(Field::Model, unknown(name)))?;
        Ok(Self {
            shipped: Some(shipped),
            ..Self::of(shipped.file, shipped.spec)
        })
    }

    /// A spec file or a robot file.
    pub fn read(path: &Path) -> Result<Self, Error> {
        Self::read_with(path, &[])
    }

    /// The same; these numbers of a robot file become parameters. Its actuators are inputs.
    pub fn read_with(path: &Path, numbers: &[&str]) -> Result<Self, Error> {
        let text = files::read(path, MAX_FILE as u64)?;
        let file = path.to_string_lossy().replace('\\', "/");
        if Format::of(&text).is_none() {
            return Ok(Self::of(file, text));
        }
        let is_of_file = |name: &&&str| name.contains('.');
        let numbers = numbers.iter().filter(is_of_file);
        let options = Options {
            actuators: true,
            letters: Letters::Matching(numbers.map(|name| (*name).to_owned()).collect()),
            ..Options::default()
        };
        let imported = robot::read_text(path, &text, None, &options);
        let mut imported = imported.map_err(|error| match error {
            Error::Request { message, .. } => Error::request(Field::Set, message),
            error => error,
        })?;
        let spec = std::mem::take(&mut imported.spec);
        Ok(Self {
            robot: Some(Arc::new(Robot { text, imported })),
            ..Self::of(file, spec)
        })
    }
}

/// The same without the compiled mechanism; of a robot the text of its file.
impl From<&Source> for Spec {
    fn from(source: &Source) -> Self {
        let own = &source.text;
        let text = source.robot.as_ref().map_or(own, |robot| &robot.text);
        Self {
            file: source.file.clone(),
            text: text.clone(),
        }
    }
}

/// Names of the shipped mechanisms.
pub fn names() -> impl Iterator<Item = &'static str> {
    ALL.iter().map(|shipped| shipped.name)
}

fn unknown(model: &str) -> String {
    let similar = appell_spec::closest(model, names())
        .map(|name| format!("; did you mean `{name}`?"))
        .unwrap_or_default();
    format!(
        "there is no shipped mechanism and no file `{model}`{similar}\n  shipped: {}\n  or give the \
         path of a spec file; `appell new NAME` writes one to start from",
        names().collect::<Vec<_>>().join(", ")
    )
}
