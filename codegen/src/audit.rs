//! Warnings about specs that are valid but probably mistaken, found in the equations and stated in physical
//! terms.
//!
//! The derivation rejects mechanisms without equations of motion. The audit examines the equations of accepted
//! ones; each file is one check. Only findings that are proven, or shown by an example, are reported.

mod bench;
mod contact;
mod determination;
mod idle;
mod integrability;
mod limits;
mod passivity;
mod ranges;
mod reaction;
mod samples;
mod start;
mod work;

use appell_spec::Code;
use appell_spec::mechanism::Mechanism;

use crate::mechanics::Derivation;
use crate::mechanics::algebra::Algebra;
use crate::mechanics::explicit::given_coordinates;
use crate::mechanics::expressions::Setting;
use crate::mechanics::finding::Finding;
use crate::mechanics::symbols::Symbols;
use crate::symbolic::Graph;
use bench::Bench;

pub use bench::Audit;

/// Audits a mechanism whose equations of motion have been derived.
pub fn audit(mechanism: &Mechanism, derivation: &Derivation) -> Audit {
    let Some(mut bench) = Bench::new(mechanism, derivation) else {
        return Audit::default();
    };
    bench.limits = limits::limits(&mut bench);
    if bench.limits.is_none() {
        bench.proposals = ranges::proposals(&mut bench);
    }
    let mut told = Audit::default();
    let free = Setting::free(mechanism, &derivation.symbols);
    let contacts = contact::findings(&mut bench.algebra, free);
    let is_told = |item| contacts.iter().any(|finding| finding.item == item);
    told.notes = integrability::findings(&mut bench);
    told.notes.retain(|note| !is_told(note.item));
    told.warnings = contacts;
    for question in [
        determination::audit,
        limits::audit,
        ranges::audit,
        idle::audit,
        work::audit,
        passivity::audit,
        reaction::audit,
        start::audit,
    ] {
        question(&mut bench, &mut told);
    }
    told
}

/// Possible reasons why a mechanism has no equations of motion: contacts that remove one velocity more than
/// intended.
pub fn reasons(mechanism: &Mechanism, refused: &[Finding]) -> Vec<Finding> {
    if !refused.iter().any(|f| counts_velocities(f.code)) {
        return Vec::new();
    }
    let mut graph = Graph::new();
    let symbols = Symbols::new(&mut graph, mechanism);
    let mut algebra = Algebra::new(graph, mechanism, &symbols);
    let free = Setting::free(mechanism, &symbols);
    algebra.given = given_coordinates(&mut algebra, free);
    contact::findings(&mut algebra, free)
}

/// Whether an error may result from the number of velocities that the constraints leave free.
pub fn counts_velocities(code: Code) -> bool {
    matches!(
        code,
        Code::MissingPseudoVelocities
            | Code::SingularPseudoVelocities
            | Code::DependentConstraints
            | Code::RedundantConstraint
    )
}
