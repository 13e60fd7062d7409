//! Letters of derived quantities, unless a quantity of the spec uses them.

use appell_spec::mechanism::Mechanism;

/// `letter`, or `word` if a name of the spec is that letter or starts with it: next to moments `M_d` and `M_h`,
/// the entry `M_v_v` of the mass matrix would be mistaken for one of them.
fn letter(mechanism: &Mechanism, letter: &'static str, word: &'static str) -> &'static str {
    let continues = |name: &str| {
        let rest = name.strip_prefix(letter);
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('_'))
    };
    let coordinates = mechanism.coordinates.iter().map(|q| &q.label);
    let labels = coordinates
        .chain(mechanism.pseudo_velocities.iter().map(|w| &w.label))
        .chain(mechanism.parameters.iter().map(|p| &p.label))
        .chain(mechanism.inputs.iter().map(|u| &u.label))
        .chain(mechanism.signals.iter().map(|s| &s.label));
    let taken = labels.into_iter().any(|label| continues(&label.name));
    if taken { word } else { letter }
}

/// Letter of the mass matrix.
pub(super) fn mass(mechanism: &Mechanism) -> &'static str {
    letter(mechanism, "M", "mass")
}

/// Letter of the triangular factor.
pub(super) fn lower(mechanism: &Mechanism) -> &'static str {
    letter(mechanism, "L", "lower")
}

/// Letter of the diagonal factor.
pub(super) fn diagonal(mechanism: &Mechanism) -> &'static str {
    letter(mechanism, "D", "diagonal")
}

/// Letter of the solution of the forward elimination.
pub(super) fn forward(mechanism: &Mechanism) -> &'static str {
    letter(mechanism, "z", "forward")
}

/// Letter of the kinetic energy of a body.
pub(super) fn kinetic(mechanism: &Mechanism) -> &'static str {
    letter(mechanism, "T", "kinetic")
}

/// Letter of reactions.
pub(super) fn reaction(mechanism: &Mechanism) -> &'static str {
    letter(mechanism, "F", "reaction")
}
