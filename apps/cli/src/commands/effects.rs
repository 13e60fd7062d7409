//! `appell effects`

use std::path::PathBuf;

use appell::effects::{self, Example};
use serde_json::json;

use crate::failure::Error;
use crate::output;

/// Lists the effects that a diagnosis looks for, or explains one of them.
///
/// An explanation has the law with a picture, the sites at which the effect can act, and its form in a spec.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  appell effects
  appell effects coulomb_friction
  appell effects backlash --model cart_pole")]
pub(crate) struct Effects {
    /// Name of an effect
    name: Option<String>,
    /// Mechanism whose sites are listed: name of a shipped one or path of a spec [default: the first shipped one
    /// with such a site]
    #[arg(long, value_name = "MODEL", requires = "name")]
    model: Option<String>,
    /// Write the effects as JSON; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

impl Effects {
    pub(super) fn run(&self) -> Result<(), Error> {
        let effects = match &self.name {
            Some(name) => effects::named(name)?,
            None => effects::library()?,
        };
        let overview = effects::overview(&effects);
        if self.name.is_none() && self.json.is_none() {
            return output::print(&overview);
        }
        let examples = effects.into_iter();
        let examples = examples.map(|effect| Example::new(effect, self.model.as_deref()));
        let examples = examples.collect::<Result<Vec<_>, _>>()?;
        output::json(self.json.as_deref(), || {
            let entries: Vec<_> = examples.iter().map(Example::json).collect();
            json!({ "schema": "effects/1", "effects": entries })
        })?;
        if self.name.is_none() {
            return output::print_beside(&overview, &[&self.json]);
        }
        let texts: Vec<String> = examples.iter().map(Example::text).collect();
        output::print_beside(&texts.join("\n"), &[&self.json])
    }
}
