//! `appell completions`

use clap_complete::env::Shells;

use crate::failure::Error;
use crate::output;

/// The variable by which a shell asks; its value is the shell's name.
const VARIABLE: &str = "COMPLETE";

/// Writes shell completions to standard output: commands, flags, models.
///
/// The shell asks `appell` while you type: write the lines anew after an update.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  appell completions bash > ~/.local/share/bash-completion/completions/appell
  appell completions zsh > ~/.zfunc/_appell
  appell completions fish > ~/.config/fish/completions/appell.fish")]
pub(crate) struct Completions {
    /// The shell
    shell: clap_complete::Shell,
}

impl Completions {
    pub(super) fn run(&self) -> Result<(), Error> {
        let name = self.shell.to_string();
        let shells = Shells::builtins();
        let mut script = Vec::new();
        let written = shells.completer(&name).map(|shell| {
            shell.write_registration(VARIABLE, "appell", "appell", "appell", &mut script)
        });
        match written {
            Some(Ok(())) => output::print(&quoting(&String::from_utf8_lossy(&script))),
            _ => Err(Error::Usage(format!(
                "there are no completions for `{name}`"
            ))),
        }
    }
}

/// The script of bash, which would put names such as `$(reboot).toml` into the line as they are, with the candidates
/// quoted; other shells quote them by themselves.
fn quoting(script: &str) -> String {
    const END: &str = "\n    fi\n}\n";
    const QUOTED: &str = "
    fi
    local candidate place
    for place in \"${!COMPREPLY[@]}\"; do
        printf -v candidate %q \"${COMPREPLY[place]}\"
        COMPREPLY[place]=$candidate
    done
}
";
    if script.contains("COMPREPLY") {
        script.replacen(END, QUOTED, 1)
    } else {
        script.to_owned()
    }
}
