//! Glossary of the names of a recursion, and their paragraphs: link by link.

use super::Recursion;
use crate::program::{Group, Names, Term};

/// Symbols and their meaning; all components are along the axes of the link.
const MEANINGS: [(&str, &str); 24] = [
    ("w", "angular velocity of a link."),
    ("alpha", "angular acceleration of a link."),
    ("alpha0", "the same where ω̇ = 0."),
    ("alphag", "the same where ω̇ = 0."),
    ("a", "acceleration of the origin of a link minus gravity."),
    ("a0", "acceleration of the origin of a link where ω̇ = 0."),
    ("ag", "the same, minus gravity."),
    ("g", "upward acceleration equivalent to gravity."),
    (
        "mass",
        "mass of a link with all that it carries; `own`: of the link alone.",
    ),
    ("h", "its first moment about the origin of the link."),
    ("I", "its inertia about the origin of the link."),
    (
        "n",
        "moment about the origin of a link that a motion, or one ω̇, requires with all that it carries.",
    ),
    ("f", "the corresponding force."),
    ("n0", "this moment where ω̇ = 0."),
    ("f0", "this force where ω̇ = 0."),
    ("ng", "this moment where ω̇ = 0, less weights."),
    ("fg", "this force where ω̇ = 0, less weights."),
    (
        "AJ",
        "with AK and AM the articulated-body inertia of a link: n = AJ α + AK a, f = AKᵀ α + AM a.",
    ),
    (
        "np",
        "bias moment of the articulated body; `fp` its bias force, `nt` and `ft` those beyond its joint.",
    ),
    (
        "rest",
        "remainder of Π that accelerates a speed; `drive` that per inertia.",
    ),
    (
        "d_alpha",
        "angular acceleration of a link beyond that where ω̇ = 0; `d_a` that of its origin.",
    ),
    (
        "I_dot",
        "rate of the inertia of a link with all that it carries, and `h_dot` of its first moment.",
    ),
    (
        "l",
        "angular momentum of all that a link carries, about its origin.",
    ),
    (
        "b",
        "moment along a speed due to an angular velocity of a link.",
    ),
];

impl Recursion {
    /// The meaning of the names.
    pub(in super::super) fn terms() -> Vec<Term> {
        let term = |(symbol, meaning): &(&str, &str)| Term {
            symbol: (*symbol).to_owned(),
            names: Names::Any,
            meaning: (*meaning).to_owned(),
        };
        MEANINGS.iter().map(term).collect()
    }

    /// Headings: motion, composite inertia and forces of each link.
    pub(in super::super) fn groups(&self) -> Vec<Group> {
        let mut named: Vec<&str> = Vec::new();
        let mut groups = Vec::new();
        for link in &self.links.all {
            let name = link.name.as_str();
            if named.contains(&name) {
                continue;
            }
            named.push(name);
            let moves = [
                "w", "alpha", "alpha0", "alphag", "a", "a0", "ag", "g", "d_alpha", "d_a",
            ];
            let carries = [
                "mass", "mass_own", "h", "h_own", "I", "I_own", "AJ", "AK", "AM",
            ];
            let takes = ["n", "f", "n0", "f0", "ng", "fg", "np", "fp", "nt", "ft"];
            for (title, letters, names) in [
                (format!("Motion of `{name}`."), &moves[..], Names::Axes),
                (format!("What `{name}` carries."), &carries, Names::Any),
                (format!("What `{name}` takes."), &takes, Names::Axes),
            ] {
                let named = letters.iter();
                let names = named.map(|letter| (format!("{letter}_{name}"), names));
                groups.push(Group {
                    title,
                    names: names.collect(),
                });
            }
        }
        groups
    }
}
