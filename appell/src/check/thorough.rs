//! The comparison of three formulations.

use std::fmt::Write as _;
use std::time::{Duration, Instant};

use appell_codegen::Derived;
use appell_codegen::formulations::{
    Against, Agreement, Comparison, FormulationComparison, compare_while,
};
use serde_json::{Value, json};

use crate::Error;

/// The order of the report.
const AGAINST: [Against; 4] = [
    Against::Spec,
    Against::Kane,
    Against::Lagrange,
    Against::Newton,
];

/// The comparison of one mechanism, and how long it took.
#[derive(Debug)]
pub struct Thorough {
    file: String,
    verdict: FormulationComparison,
    seconds: f64,
    limit: Duration,
}

impl Thorough {
    pub(super) fn new(file: &str, derived: &Derived, limit: Duration) -> Result<Self, Error> {
        let start = Instant::now();
        let is_time = || start.elapsed() < limit;
        let verdict = compare_while(&derived.mechanism, &derived.derivation, &is_time);
        let verdict = verdict.map_err(|findings| {
            let reasons = findings.iter().map(|finding| finding.message.as_str());
            let reasons: Vec<&str> = reasons.collect();
            let reasons = reasons.join("; ");
            Error::computation(format!(
                "{file}: the formulations cannot be compared: {reasons}"
            ))
        })?;
        Ok(Self {
            file: file.to_owned(),
            verdict,
            seconds: start.elapsed().as_secs_f64(),
            limit,
        })
    }

    /// The comparison as text, one line for each formulation and method.
    pub fn text(&self) -> String {
        let all = &self.verdict.comparisons;
        let answer = if self.verdict.agrees() {
            "agree"
        } else if all.iter().any(Comparison::differs) {
            "DO NOT AGREE"
        } else {
            "NOT ALL COMPARED"
        };
        let mut text = format!("  three formulations    {answer}, {:.2} s\n", self.seconds);
        let mut proofs = false;
        // Writing to a string cannot fail.
        let mut line = |against: Against, what: &str| {
            let _ = writeln!(text, "    {:<20}{what}", against.word());
        };
        for against in AGAINST {
            let all = self.verdict.comparisons.iter();
            let (proven, others): (Vec<&Comparison>, Vec<&Comparison>) = all
                .filter(|comparison| comparison.against == against)
                .partition(|comparison| comparison.agreement == Agreement::Identical);
            if !proven.is_empty() {
                proofs = true;
                let proven: Vec<&str> = proven.iter().map(|c| c.quantity).collect();
                line(against, &format!("proved identical: {}", proven.join(", ")));
            }
            for comparison in others {
                line(against, &seen(comparison));
            }
        }
        if proofs {
            let _ = writeln!(
                text,
                "    {:<20}probability that any of them is false: below {:.0e}",
                "proofs", self.verdict.error_bound
            );
        }
        text
    }

    /// The comparison as JSON.
    pub fn to_json(&self) -> Value {
        let comparison = |comparison: &Comparison| {
            let mut entry = json!({
                "against": comparison.against.word(), "quantity": comparison.quantity,
            });
            let result = match &comparison.agreement {
                Agreement::Identical => json!({ "agrees": true, "method": "identity" }),
                Agreement::AtPoints { points, deviation } => json!({
                    "agrees": true, "method": "points", "points": points, "deviation": deviation,
                }),
                Agreement::Different {
                    entry,
                    values,
                    deviation,
                } => json!({
                    "agrees": false, "method": "points", "entry": entry, "values": values,
                    "deviation": deviation,
                }),
                Agreement::Undefined => json!({ "agrees": null, "method": "points", "points": 0 }),
                Agreement::NotReached => json!({ "agrees": null, "method": null }),
            };
            if let (Value::Object(entry), Value::Object(result)) = (&mut entry, result) {
                entry.extend(result);
            }
            entry
        };
        let comparisons: Vec<Value> = self.verdict.comparisons.iter().map(comparison).collect();
        json!({
            "agrees": self.verdict.agrees(), "comparisons": comparisons,
            "error_bound": self.verdict.error_bound, "seconds": self.seconds,
            "time_limit_s": self.limit.as_secs_f64(),
        })
    }

    /// Why the equations cannot be trusted, if they cannot.
    pub fn failure(&self) -> Option<Error> {
        if self.verdict.agrees() {
            return None;
        }
        let mut text = String::new();
        let (mut differs, mut undefined) = (false, false);
        let (mut compared, mut left) = (Vec::new(), Vec::new());
        for comparison in &self.verdict.comparisons {
            let (against, quantity) = (comparison.against.word(), comparison.quantity);
            match &comparison.agreement {
                Agreement::Different {
                    entry,
                    values: [derived, other],
                    deviation,
                } => {
                    differs = true;
                    let _ = write!(
                        text,
                        "\n  {against}: {quantity}, `{entry}` is {derived:e} by Gibbs-Appell and {other:e} \
                         there; relative difference {deviation:.0e}"
                    );
                }
                Agreement::Undefined => {
                    undefined = true;
                    let _ = write!(
                        text,
                        "\n  {against}: {quantity} has no finite value at any random point in the declared \
                         ranges"
                    );
                }
                Agreement::Identical | Agreement::AtPoints { .. } => {
                    compared.push(format!("{against}: {quantity}"));
                }
                Agreement::NotReached => left.push(format!("{against}: {quantity}")),
            }
        }
        if !left.is_empty() {
            let compared = match &compared[..] {
                [] => "nothing".to_owned(),
                all => all.join(", "),
            };
            let _ = write!(
                text,
                "\n  the time limit of {} s was exceeded\n  compared and equal: {compared}\n  not compared: {}\n  \
                 allow more time",
                self.limit.as_secs_f64(),
                left.join(", ")
            );
        }
        let mut verdict = "the formulations were not all compared";
        if undefined {
            verdict = "the formulations could not be compared";
        }
        if differs {
            verdict = "the formulations disagree";
            text += "\n  all formulations must give the same motion, so at least one is derived wrongly: do not use these \
                equations\n  the mistake is in appell, not in the spec; please report it together with the spec";
        }
        if undefined {
            text += "\n  declare a `range` for the coordinates, inside which all expressions are defined";
        }
        let file = &self.file;
        Some(Error::computation(format!("{file}: {verdict}{text}")))
    }
}

/// The result of a comparison at random points.
fn seen(comparison: &Comparison) -> String {
    let quantity = comparison.quantity;
    match &comparison.agreement {
        Agreement::Identical => format!("identical: {quantity}"),
        Agreement::AtPoints { points, deviation } => {
            format!("equal at {points} random points, to {deviation:.0e}: {quantity}")
        }
        Agreement::Different { .. } => format!("DIFFERENT: {quantity}"),
        Agreement::Undefined => format!("not compared: {quantity}"),
        Agreement::NotReached => format!("not compared in time: {quantity}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disagreement_fails_and_says_what_it_means() {
        let bias = Comparison {
            against: Against::Kane,
            quantity: "bias",
            agreement: Agreement::Different {
                entry: "omega".to_owned(),
                values: [1.5, -1.5],
                deviation: 2.0,
            },
        };
        let thorough = Thorough {
            file: "wheel.toml".to_owned(),
            verdict: FormulationComparison {
                comparisons: vec![bias],
                error_bound: 0.0,
            },
            seconds: 0.0,
            limit: Duration::from_secs(1),
        };
        assert!(thorough.text().contains("DO NOT AGREE"));
        assert_eq!(thorough.to_json()["agrees"], false);
        let failure = thorough.failure().expect("a failure");
        assert_eq!(failure.class(), crate::Class::Computation);
        let told = failure.to_string();
        for part in ["Kane: bias, `omega` is 1.5e0", "do not use these equations"] {
            assert!(told.contains(part), "{told}");
        }
    }
}
