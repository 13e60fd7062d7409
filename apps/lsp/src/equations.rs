//! The equations that each item contributes to, read from the derivation.

use std::collections::BTreeMap;

use appell_codegen::mechanics::algebra::Algebra;
use appell_codegen::mechanics::row::Row;
use appell_codegen::mechanics::{Derivation, contributions};
use appell_codegen::symbolic::Expr;
use appell_spec::mechanism::{ConstraintId, Mechanism};
use appell_spec::occurrences::Namespace;

/// A sentence for each item.
pub(crate) type Contributions = BTreeMap<(Namespace, String), String>;

/// The contributions of each item. There is one equation of motion for each pseudo-velocity.
pub(crate) fn contributions(mechanism: &Mechanism, mut derivation: Derivation) -> Contributions {
    let mut told = Contributions::new();
    quantities(mechanism, &mut derivation, &mut told);
    let of_loads = contributions::of_loads(&mut derivation);
    for (load, works) in mechanism.loads.iter().zip(of_loads) {
        let sentence = in_equations(mechanism, "Its generalised force appears", |i| works[i])
            .unwrap_or_else(|| "It does no work and appears in no equation of motion".to_owned());
        told.insert((Namespace::Load, load.name.clone()), sentence);
    }
    let of_bodies = contributions::of_bodies(&derivation);
    for (body, moves) in mechanism.bodies.iter().zip(of_bodies) {
        let sentence = in_equations(mechanism, "Its inertia appears", |i| moves[i]);
        if let Some(sentence) = sentence {
            told.insert((Namespace::Body, body.name.clone()), sentence);
        }
    }
    for (id, constraint) in mechanism.constraints.entries() {
        let key = (Namespace::Constraint, constraint.name.clone());
        told.insert(key, rows(&derivation, id));
    }
    told
}

/// The equations of motion and the rates that depend on each quantity.
fn quantities(mechanism: &Mechanism, derivation: &mut Derivation, told: &mut Contributions) {
    let Derivation {
        algebra,
        symbols,
        gibbs,
        forces,
        coordinate_rates,
        ..
    } = derivation;
    let labels = mechanism.parameters.iter().map(|p| &p.label);
    let labels = labels.chain(mechanism.coordinates.iter().map(|q| &q.label));
    let labels = labels.chain(mechanism.pseudo_velocities.iter().map(|w| &w.label));
    let labels = labels.chain(mechanism.inputs.iter().map(|u| &u.label));
    let of_quantity = [
        &symbols.parameters,
        &symbols.coordinates,
        &symbols.speeds,
        &symbols.inputs,
    ];
    let Algebra { graph, test, .. } = algebra;
    for (label, &symbol) in labels.zip(of_quantity.into_iter().flatten()) {
        let Some(symbol) = graph.as_symbol(symbol) else {
            continue;
        };
        let mut depends = |expr: Expr| !test.independent_of(graph, expr, symbol);
        let equations = in_equations(mechanism, "It appears", |i| {
            let mut row = gibbs.mass_matrix[i].iter().copied();
            depends(gibbs.bias[i]) || depends(forces[i]) || row.any(&mut depends)
        });
        let rates = mechanism.coordinates.iter().zip(&*coordinate_rates);
        let rates = rates.filter(|(_, rate)| depends(**rate));
        let rates = listed(rates.map(|(q, _)| format!("dot({})", q.label.name)));
        let rates = rates.map(|rates| format!("{rates} depend on it"));
        let sentences: Vec<String> = equations.into_iter().chain(rates).collect();
        if !sentences.is_empty() {
            let key = (Namespace::Quantity, label.name.clone());
            told.insert(key, sentences.join("; "));
        }
    }
}

/// The rows of a constraint: restricting, embedded or redundant.
fn rows(derivation: &Derivation, id: ConstraintId) -> String {
    let named = |what: &str, wanted: &dyn Fn(&Row) -> bool| {
        let rows = derivation.constraints.rows.iter();
        let rows = rows.filter(|row| row.constraint == id && wanted(row));
        listed(rows.map(|row| row.name.clone())).map(|names| format!("{names} {what}"))
    };
    let parts = [
        named("restrict the velocities", &Row::is_active),
        named("hold by the geometry alone", &Row::is_embedded),
        named("follow from others", &|row| {
            !row.is_active() && !row.is_embedded()
        }),
    ];
    let parts: Vec<String> = parts.into_iter().flatten().collect();
    format!("Rows: {}", parts.join("; "))
}

fn in_equations(
    mechanism: &Mechanism,
    what: &str,
    mut is_in: impl FnMut(usize) -> bool,
) -> Option<String> {
    let speeds = mechanism.pseudo_velocities.iter().enumerate();
    let named = speeds.filter(|(i, _)| is_in(*i));
    let names = listed(named.map(|(_, speed)| speed.label.name.clone()))?;
    Some(format!("{what} in the equations of motion of {names}"))
}

/// Names in a sentence; nothing for none.
fn listed(names: impl Iterator<Item = String>) -> Option<String> {
    let names: Vec<String> = names.map(|name| format!("`{name}`")).collect();
    (!names.is_empty()).then(|| names.join(", "))
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;
    use appell_codegen::derived;

    /// No two loads of a shipped spec cancel.
    #[test]
    fn an_equation_has_a_generalised_force_where_some_load_says_so() {
        for (file, text) in appell_test_kit::shipped() {
            let mut derived = derived(&file, &text).ok().unwrap();
            let Algebra { graph, test, .. } = &mut derived.derivation.algebra;
            let forces = derived.derivation.forces.iter();
            let vanish: Vec<bool> = forces.map(|&force| test.is_zero(graph, force)).collect();
            let told = contributions(&derived.mechanism, derived.derivation);
            let of_loads: Vec<&String> = told
                .iter()
                .filter(|(key, _)| key.0 == Namespace::Load)
                .map(|(_, sentence)| sentence)
                .collect();
            for (speed, vanishes) in derived.mechanism.pseudo_velocities.iter().zip(vanish) {
                let name = format!("`{}`", speed.label.name);
                let is_told = of_loads.iter().any(|sentence| sentence.contains(&name));
                assert!(is_told != vanishes, "{file}: {name}");
            }
        }
    }
}
