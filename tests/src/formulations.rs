//! A derivation against Kane's equations and Lagrange's with multipliers.

use appell_codegen::formulations::{Agreement, FormulationComparison, compare};
use appell_codegen::mechanics::Derivation;
use appell_spec::Mechanism;

use crate::shipped;

/// Rounding of two spellings of a thousand operations, where values are compared.
const AT_POINTS: f64 = 1e-12;

/// What the comparison of a derivation tells.
pub fn verdict(mechanism: &Mechanism, derivation: &Derivation) -> FormulationComparison {
    compare(mechanism, derivation)
        .unwrap_or_else(|findings| panic!("{}: {findings:?}", mechanism.file))
}

/// Demands that the three formulations of a mechanism agree.
pub fn assert_one_answer(mechanism: &Mechanism) -> FormulationComparison {
    assert_agreement(mechanism, &shipped::derive(mechanism))
}

/// The same where the derivation is there already.
pub fn assert_agreement(mechanism: &Mechanism, derivation: &Derivation) -> FormulationComparison {
    let verdict = verdict(mechanism, derivation);
    assert!(verdict.agrees(), "{}: {verdict:#?}", mechanism.name);
    for comparison in &verdict.comparisons {
        if let Agreement::AtPoints { deviation, .. } = comparison.agreement {
            let what = format!("{}: {comparison:?}", mechanism.name);
            assert!(deviation <= AT_POINTS, "{what}");
        }
    }
    verdict
}
