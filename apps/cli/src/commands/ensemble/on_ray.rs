//! Chunks of a study on a Ray cluster, by the Python package.

use std::io::{BufRead as _, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};

use appell::ensemble::Running;

use crate::failure::Error;
use crate::progress;

/// Environment variable with the Python interpreter that has the package.
const PYTHON: &str = "APPELL_PYTHON";

/// Runs the missing chunks, `left` of them.
pub(super) fn run(
    study: &Path,
    out: &Path,
    address: &str,
    running: Running,
    left: u64,
) -> Result<(), Error> {
    let python = std::env::var(PYTHON).unwrap_or_else(|_| "python3".to_owned());
    let told = |what: &str| {
        Error::Computation(format!(
            "{what}; a cluster is run by the Python package: `pip install appell ray`, and `{PYTHON}` names the \
             interpreter that has them"
        ))
    };
    let shard = running.shard.map(|shard| shard.to_string());
    let chunk = running.chunk.map(|chunk| chunk.to_string());
    let mut child = Command::new(&python)
        .args(["-m", "appell._on_ray"])
        .args([study, out])
        .args([
            address,
            &shard.unwrap_or_default(),
            &chunk.unwrap_or_default(),
        ])
        .stdout(Stdio::piped())
        .spawn()
        .map_err(|error| told(&format!("`{python}` does not start: {error}")))?;
    let bar = progress::cases(left, "chunks");
    let (mut version, mut failure) = (None, None);
    if let Some(output) = child.stdout.take() {
        for line in BufReader::new(output).lines().map_while(Result::ok) {
            match line.split_once(' ') {
                Some(("version", found)) => version = Some(found.to_owned()),
                Some(("chunk", rest)) => {
                    let done = rest.split(' ').next().and_then(|done| done.parse().ok());
                    bar.set_position(done.unwrap_or_default());
                }
                Some(("error", why)) => failure = Some(why.to_owned()),
                _ => {}
            }
        }
    }
    let status = child.wait();
    bar.finish_and_clear();
    let Some(version) = version else {
        return Err(told(&format!("`{python}` has no package appell")));
    };
    let own = env!("CARGO_PKG_VERSION");
    if version != own {
        return Err(told(&format!(
            "the Python package is of version {version}, this program of version {own}"
        )));
    }
    match (failure, status) {
        (Some(why), _) => Err(Error::Computation(why)),
        (None, Ok(status)) if status.success() => Ok(()),
        (None, _) => Err(Error::Computation(
            "the run on the cluster was ended; the same command goes on where it was".to_owned(),
        )),
    }
}
