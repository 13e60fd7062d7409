//! Comments: where the spec comes from, what its file has besides.

use std::fmt::Write as _;

use crate::model::{LeftOut, Robot};
use crate::options::Options;
use crate::tree::Tree;

use super::grouped;

/// Most names that a list gives.
const MOST_NAMES: usize = 12;

/// What stands above a spec.
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

/// What stands below it.
pub(super) fn left_out(left_out: &[LeftOut], options: &Options, text: &mut String) {
    if !options.without.is_empty() {
        let without: Vec<&str> = options.without.iter().map(|one| one.word()).collect();
        let _ = writeln!(text, "\n# Left out as asked: {}.", without.join(", "));
    }
    if left_out.is_empty() {
        return;
    }
    text.push_str("\n# The file also has, without a counterpart here:\n");
    for (what, all) in grouped(left_out) {
        let names: Vec<&str> = all.iter().filter_map(|one| one.name.as_deref()).collect();
        let names = if names.is_empty() {
            String::new()
        } else {
            format!(": {}", line(&some(&names)))
        };
        let _ = writeln!(text, "# - {} {what}{names}", all.len());
    }
}

/// Names, the first ones of many.
fn some(names: &[&str]) -> String {
    let mut unique: Vec<&str> = Vec::new();
    for name in names {
        if !unique.contains(name) {
            unique.push(name);
        }
    }
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
