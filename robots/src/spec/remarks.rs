//! Comments of the spec: its source, and parts of the file without a counterpart.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use crate::letters::plain;
use crate::model::{LeftOut, Robot};
use crate::options::Options;
use crate::tree::Tree;

/// Most names that a list gives.
const MOST_NAMES: usize = 12;

/// The comment at the beginning of a spec.
pub(super) fn head(file: &str, kind: &str, robot: &Robot, tree: &Tree) -> String {
    let links = robot.links.iter().filter(|link| link.written).count();
    let mut head = format!(
        "# {}, imported from {} ({kind}: {links} links, {} moving joints).\n",
        line(&robot.name),
        line(file),
        tree.bodies.len()
    );
    head.push_str(
        "# Links that are fixed together are one body; each link's name is that of the point at its origin.\n\
         # Lengths are in m, angles in rad.\n",
    );
    let ground: Vec<&str> = tree
        .ground
        .iter()
        .map(|part| robot.links[part.link].name.as_str())
        .collect();
    if !ground.is_empty() {
        let _ = writeln!(head, "# Fixed to the ground: {}.", line(&some(&ground)));
    }
    head
}

/// The comment at its end.
pub(super) fn left_out(left_out: &[LeftOut], options: &Options, text: &mut String) {
    if !options.without.is_empty() {
        let without: Vec<&str> = options.without.iter().map(|one| one.word()).collect();
        let _ = writeln!(text, "\n# Left out as asked: {}.", without.join(", "));
    }
    if left_out.is_empty() {
        return;
    }
    text.push_str("\n# The file also has, without a counterpart here:\n");
    let mut kinds: Vec<(&LeftOut, Vec<&str>, usize)> = Vec::new();
    let mut index = BTreeMap::new();
    for one in left_out {
        let at = *index.entry((&one.what, one.effect)).or_insert(kinds.len());
        if at == kinds.len() {
            kinds.push((one, Vec::new(), 0));
        }
        kinds[at].1.extend(one.name.as_deref());
        kinds[at].2 += 1;
    }
    // Omissions that change the motion come first.
    kinds.sort_by_key(|(one, ..)| one.effect.is_none());
    for (one, names, count) in kinds {
        let names = if names.is_empty() {
            String::new()
        } else {
            format!(": {}", some(&names))
        };
        let effect = one
            .effect
            .map_or(String::new(), |effect| format!(" ({effect})"));
        let _ = writeln!(
            text,
            "# - {count} {}{}{effect}",
            line(&one.what),
            line(&names)
        );
    }
}

/// Lags and delays of actuators, which are not in the spec.
pub(super) fn late(robot: &Robot, text: &mut String) {
    let late = robot.drives.iter().flatten();
    let late: Vec<String> = late
        .filter(|drive| drive.lag != 0.0 || drive.delay != 0.0)
        .map(|drive| {
            let lag = [("lags by", drive.lag), ("is delayed by", drive.delay)];
            let lag = lag.iter().filter(|(_, time)| *time != 0.0);
            let lag: Vec<String> = lag
                .map(|(what, time)| format!("{what} {} s", plain(*time)))
                .collect();
            format!("# - {} {}", line(&drive.name), lag.join(" and "))
        })
        .collect();
    if !late.is_empty() {
        let _ = writeln!(
            text,
            "\n# Forces of actuators follow their inputs at once; in the file, the command of\n{}",
            late.join("\n")
        );
    }
}

/// Names, the first ones of many.
fn some(names: &[&str]) -> String {
    let mut seen = BTreeSet::new();
    let unique = names.iter().copied().filter(|name| seen.insert(*name));
    let unique: Vec<&str> = unique.collect();
    let more = unique.len().saturating_sub(MOST_NAMES);
    let shown = unique
        .iter()
        .take(MOST_NAMES)
        .copied()
        .collect::<Vec<_>>()
        .join(", ");
    if more == 0 {
        shown
    } else {
        format!("{shown} and {more} more")
    }
}

/// A text that stays in one line of a comment.
fn line(text: &str) -> String {
    text.chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .take(400)
        .collect()
}
