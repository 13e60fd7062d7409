//! `appell watch`

use std::path::PathBuf;

use appell::source;
use appell_watch::Watch as Server;

use crate::failure::Error;
use crate::output;

/// Shows equations, drawing and motion of a spec in a browser, and follows it as it is saved.
///
/// The page is served on the loopback address alone, to whoever knows the secret in its address, until
/// Ctrl-C. Sliders set parameters, the initial state and inputs; the spec is read and never written.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  appell watch my_pendulum.toml")]
pub(crate) struct Watch {
    /// Path of a spec
    spec: PathBuf,
    /// Port of the loopback address; 0 is a free one
    #[arg(long, value_name = "N", default_value_t = 0)]
    port: u16,
}

impl Watch {
    pub(super) fn run(&self) -> Result<(), Error> {
        let server = Server::start(&self.spec, self.port).map_err(|error| self.failure(error))?;
        output::print(&format!("{}\n", server.url()))?;
        server.serve().map_err(|error| self.failure(error))
    }

    fn failure(&self, error: appell_watch::Error) -> Error {
        let name = self.spec.to_string_lossy();
        match error {
            // Only a file can be followed.
            appell_watch::Error::File { .. } if source::names().any(|shipped| shipped == name) => {
                Error::Usage(format!(
                    "`{name}` is a shipped mechanism, and a page follows a file that you edit: write its spec first\n  \
                     appell derive {name} --format spec --out {name}.toml\n  appell watch {name}.toml"
                ))
            }
            appell_watch::Error::File { path, cause } => Error::Library(appell::Error::File {
                doing: "read",
                path,
                cause,
            }),
            other => Error::Computation(other.to_string()),
        }
    }
}
