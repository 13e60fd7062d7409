//! Glossary of the names of a recursion, and their paragraphs: link by link.

use super::Recursion;
use crate::program::{Group, Names, Term};

/// Symbols and their meaning; all components are along the axes of the link.
const MEANINGS: [(&str, &str); 24] = [
    ("w", "angular velocity of a link."),
    ("alpha", "angular acceleration of a link."),
    ("alpha0", "the same where ω̇ = 0."),
    ("alphag", "the same where ω̇ = 0."),
    ("a", "acceleration of the origin of a link, less free fall."),
    ("a0", "acceleration of the origin of a link where ω̇ = 0."),
    ("ag", "the same, less free fall."),
    (
        "g",
        "free fall upwards, the acceleration that weighs as much.",
    ),
    (
        "mass",
        "mass of a link with all that it carries; `own`: of the link alone.",
    ),
    ("h", "its first moment about the origin of the link."),
    ("I", "its inertia about the origin of the link."),
    (
        "n",
        "moment about the origin of a link that a motion, or one ω̇ alone, takes of all that it carries.",
    ),
    ("f", "the force beside this moment."),
    ("n0", "this moment where ω̇ = 0."),
    ("f0", "this force where ω̇ = 0."),
    ("ng", "this moment where ω̇ = 0, less weights."),
    ("fg", "this force where ω̇ = 0, less weights."),
    (
        "AJ",
        "with AK and AM what accelerates a link while all that it carries moves freely: n = AJ α + AK a, f = AKᵀ α + AM a.",
    ),
    (
        "np",
        "moment of a link so carried where it does not accelerate; `fp` the force, `nt` and `ft` beyond its joint.",
    ),
    (
        "rest",
        "what is left of Π to accelerate a speed; `drive` that per inertia.",
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
        "moment along a speed that an angular velocity of a link brings about.",
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
            let all = |letters: &[&str], names: Names| -> Vec<(String, Names)> {
                letters
                    .iter()
                    .map(|letter| (format!("{letter}_{name}"), names))
                    .collect()
            };
            let moves = [
                "w", "alpha", "alpha0", "alphag", "a", "a0", "ag", "g", "d_alpha", "d_a",
            ];
            groups.push(Group {
                title: format!("Motion of `{name}`."),
                names: all(&moves, Names::Axes),
            });
            let carries = [
                "mass", "mass_own", "h", "h_own", "I", "I_own", "AJ", "AK", "AM",
            ];
            groups.push(Group {
                title: format!("What `{name}` carries."),
                names: all(&carries, Names::Any),
            });
            let takes = ["n", "f", "n0", "f0", "ng", "fg", "np", "fp", "nt", "ft"];
            groups.push(Group {
                title: format!("What `{name}` takes."),
                names: all(&takes, Names::Axes),
            });
        }
        groups
    }
}
