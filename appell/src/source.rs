//! Specs: shipped ones by name, others by path.

use std::path::Path;

use appell_models::ALL;
pub use appell_models::Shipped;
use appell_recordings::Spec;
use appell_spec::limits::MAX_FILE;

use crate::{Error, Field, files};

/// A spec.
#[derive(Debug)]
pub struct Source {
    /// Name of the file, for messages and emitted code.
    pub file: String,
    /// Its text.
    pub text: String,
    /// The compiled mechanism, if it is shipped.
    pub shipped: Option<&'static Shipped>,
}

impl Source {
    /// The text of a spec and the name of its file.
    pub fn of(file: impl Into<String>, text: impl Into<String>) -> Self {
        Self {
            file: file.into(),
            text: text.into(),
            shipped: None,
        }
    }

    /// A shipped name or the path of a spec file; `-` is standard input. A shipped name takes precedence; `./name` is the file.
    pub fn find(model: &str) -> Result<Self, Error> {
        if Shipped::find(model).is_some() {
            return Self::shipped(model);
        }
        let path = Path::new(model);
        if files::is_stdout(path) {
            return Self::read(path);
        }
        let is_path = path.components().count() > 1 || path.extension().is_some() || path.exists();
        if is_path {
            Self::read(path)
        } else {
            Err(Error::request(Field::Model, unknown(model)))
        }
    }

    /// A shipped spec.
    pub fn shipped(name: &str) -> Result<Self, Error> {
        let shipped =
            Shipped::find(name).ok_or_else(|| Error::request(Field::Model, unknown(name)))?;
        Ok(Self {
            file: shipped.file.to_owned(),
            text: shipped.spec.to_owned(),
            shipped: Some(shipped),
        })
    }

    /// A spec file.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let text = files::read(path, MAX_FILE as u64)?;
        Ok(Self::of(path.to_string_lossy().replace('\\', "/"), text))
    }
}

/// The same without the compiled mechanism.
impl From<&Source> for Spec {
    fn from(Source { file, text, .. }: &Source) -> Self {
        let (file, text) = (file.clone(), text.clone());
        Self { file, text }
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
