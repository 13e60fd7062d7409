//! Where a motion leaves the range of validity of its model.

use appell_runtime::Trajectory;
use appell_runtime::simulate::Breach;

use appell_report::text::number;

/// Number of breaches listed one by one.
const MOST_SHOWN: usize = 10;

/// One line per breach; empty if there is none.
pub(crate) fn text(trajectory: &Trajectory) -> String {
    let breaches = &trajectory.breaches;
    let line = |breach: &Breach| {
        let what = breach.describe(trajectory.info());
        format!("  at t = {} s {what}\n", number(breach.t))
    };
    let more = breaches.len().saturating_sub(MOST_SHOWN);
    let rest = (more > 0).then(|| format!("  and {more} more; `--json` lists all\n"));
    let shown = breaches.iter().take(MOST_SHOWN).map(line);
    shown.chain(rest).collect()
}
