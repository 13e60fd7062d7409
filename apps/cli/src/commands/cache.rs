//! `appell cache`

use appell::cache::{Cache as Folder, Size};

use crate::failure::Error;
use crate::output;

/// Shows or clears the cache of derived equations.
///
/// Equations of large mechanisms are kept from run to run, in `appell` among the caches of the system or in the folder that
/// `APPELL_CACHE` names. A damaged or missing entry is derived anew; beyond 512 MiB those used longest ago are removed.
/// `--no-cache`, or an empty `APPELL_CACHE`, neither reads nor writes.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  appell cache
  appell cache --clear")]
pub(crate) struct Cache {
    /// Remove all entries
    #[arg(long)]
    clear: bool,
}

impl Cache {
    pub(super) fn run(&self) -> Result<(), Error> {
        let Some(cache) = Folder::of_user() else {
            return output::print(
                "no cache: APPELL_CACHE is empty, or the system has no folder for caches\n",
            );
        };
        let folder = cache.folder().display();
        let failed = |cause| appell::Error::writing(cache.folder())(cause);
        let of = |Size { entries, bytes }: Size| format!("{entries} entries, {} kB", bytes / 1000);
        output::print(&if self.clear {
            format!(
                "removed {} from {folder}\n",
                of(cache.clear().map_err(failed)?)
            )
        } else {
            format!("{folder}: {}\n", of(cache.size().map_err(failed)?))
        })
    }
}
