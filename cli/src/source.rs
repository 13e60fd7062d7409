//! MODEL: the name of a shipped mechanism or the path of a spec file.

use std::path::Path;

use appell_models::{ALL, Shipped};
use appell_spec::limits::MAX_FILE;

use crate::failure::Failure;
use crate::files;

/// The spec behind a MODEL.
#[derive(Debug)]
pub(crate) struct Source {
    /// Name of the file in messages and in emitted code.
    pub(crate) file: String,
    /// Its text.
    pub(crate) text: String,
    /// The compiled mechanism, if it is shipped.
    pub(crate) shipped: Option<&'static Shipped>,
}

impl Source {
    /// Finds a MODEL. A shipped name wins over a file; `./name` means the file.
    pub(crate) fn find(model: &str) -> Result<Self, Failure> {
        if let Some(shipped) = Shipped::find(model) {
            let (file, text) = (shipped.file.to_owned(), shipped.spec.to_owned());
            return Ok(Self {
                file,
                text,
                shipped: Some(shipped),
            });
        }
        let path = Path::new(model);
        let is_path = path.components().count() > 1 || path.extension().is_some() || path.exists();
        if !is_path {
            return Err(Failure::Usage(unknown(model)));
        }
        let text = files::read(path, MAX_FILE as u64)?;
        Ok(Self {
            file: model.replace('\\', "/"),
            text,
            shipped: None,
        })
    }
}

fn unknown(model: &str) -> String {
    let names = || ALL.iter().map(|shipped| shipped.name);
    let similar = appell_spec::closest(model, names())
        .map(|name| format!("; did you mean `{name}`?"))
        .unwrap_or_default();
    format!(
        "there is no shipped mechanism and no file `{model}`{similar}\n  shipped: {}\n  or give the \
         path of a spec file; `appell new NAME` writes one to start from",
        names().collect::<Vec<_>>().join(", ")
    )
}
