//! `appell schema`

use std::path::PathBuf;

use crate::failure::Error;
use appell::files;

/// Writes the JSON schema of specs, for completion and checks in editors.
///
/// Name the file in the first line of a spec, `#:schema ./appell.schema.json`, and an editor with
/// Taplo (in VS Code the extension Even Better TOML) completes keys and marks errors.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  appell schema --out appell.schema.json")]
pub(crate) struct Schema {
    /// Write to a file instead of standard output
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
}

impl Schema {
    pub(super) fn run(&self) -> Result<(), Error> {
        let schema = appell_spec::schema::json_schema();
        let text = schema.trim_end().to_owned() + "\n";
        files::write(self.out.as_deref().unwrap_or("-".as_ref()), &text)?;
        Ok(())
    }
}
