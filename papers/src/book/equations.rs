//! Typed equations and errata as claims.

use crate::equations::{Equation, Formulas};
use crate::errata::{Erratum, Evidence};

use super::claim::{Claim, Reproduction, Statement};

/// The comparison of an equation with the derived one.
pub(super) fn typed(equation: &Equation) -> Claim {
    let first = equation.claims.first();
    let (kind, stage) = match first.map(|claim| &claim.formulas) {
        Some(Formulas::Matrix(_)) => ("; entries that are not listed are zero", "jacobians"),
        Some(Formulas::Energy(_)) => ("; up to terms without accelerations", "all"),
        _ => ("", "all"),
    };
    let differences = equation.differences();
    let ours = if differences.is_empty() {
        format!("identical to the derived formulas{kind}")
    } else {
        differences.join("\n")
    };
    let mechanism = first.and_then(|claim| claim.of.first());
    let mechanism = mechanism.map_or("unicycle", |subject| subject.mechanism());
    Statement {
        place: equation.number.clone(),
        published: format!("{}\n{}", equation.about, equation.text()),
        command: format!("appell derive {mechanism} --stage {stage}"),
        agreement: Some(Reproduction::Exact),
        note: "by the identity test".to_owned(),
        ..Statement::default()
    }
    .found(ours, differences.is_empty())
}

/// The printed and the correct formula.
pub(super) fn misprint(erratum: &Erratum) -> Claim {
    let kind = erratum.origin.words();
    let (note, evidence, as_expected) = match &erratum.evidence {
        Evidence::Test { comparison, .. } => {
            let [printed, right] = comparison.verdicts();
            let verb = |holds: bool| if holds { "is" } else { "is not" };
            let evidence = format!(
                "what is printed {} what is derived; what is right {} so",
                verb(printed),
                verb(right)
            );
            (String::new(), evidence, right && !printed)
        }
        Evidence::Context { context } => {
            // Names of tests are for readers of the source.
            let words = context.split("; tested").next().unwrap_or(context);
            let words = words.split("simulated:").next().unwrap_or(words);
            let note = format!("erratum: {kind}, by the context");
            (note, words.to_owned(), true)
        }
    };
    let ours = format!("right: {}\n{evidence}", erratum.right);
    Statement {
        place: erratum.equation.clone(),
        published: format!("printed: {}", erratum.printed),
        command: "docs/errata.md".to_owned(),
        note,
        erratum: Some(kind.to_owned()),
        ..Statement::default()
    }
    .found(ours.trim_end(), as_expected)
}
