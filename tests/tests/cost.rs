//! Operation counts of every function of every shipped mechanism may not rise.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use std::collections::BTreeMap;
use std::fmt::Write as _;

use appell_codegen::program::{FunctionKind, Program};
use appell_codegen::schedule::schedule;
use appell_codegen::tape::OperationCount;
use appell_tests::shipped;

/// One of the counts.
type Count = fn(&OperationCount) -> usize;

/// What is counted, and how it is called in the baseline.
const COUNTED: [(&str, Count); 6] = [
    ("operations", OperationCount::total),
    ("divisions", |count| count.divide),
    ("sine_cosine_pairs", |count| count.sin_cos),
    ("functions", |count| count.functions),
    ("choices", |count| count.selects),
    ("linear_systems", |count| count.solves),
];

/// Functions that estimation asks for.
const ADJOINTS: [FunctionKind; 3] = [
    FunctionKind::Adjoint,
    FunctionKind::OutputJacobians,
    FunctionKind::OutputAdjoint,
];

type Counts = BTreeMap<String, BTreeMap<String, [usize; 6]>>;

fn name(kind: FunctionKind) -> String {
    let mut name = String::new();
    for letter in format!("{kind:?}").chars() {
        if letter.is_uppercase() && !name.is_empty() {
            name.push('_');
        }
        name.push(letter.to_ascii_lowercase());
    }
    name
}

fn counts() -> Counts {
    let count = |program: &Program| {
        let functions = program.functions.iter();
        let count = functions.map(|function| {
            let count = OperationCount::of(&schedule(program, function));
            (name(function.kind), COUNTED.map(|(_, get)| get(&count)))
        });
        count.collect::<Vec<_>>()
    };
    let of_mechanism = |name: String| {
        let mut counts = count(shipped::program(&name));
        if shipped::WITH_ADJOINTS.contains(&name.as_str()) {
            let program = shipped::program_of(shipped::mechanism(&name), &ADJOINTS);
            counts.extend(count(&program));
        }
        (name, counts.into_iter().collect())
    };
    shipped::names().into_iter().map(of_mechanism).collect()
}

fn write(counts: &Counts) -> String {
    let mut text = String::from(
        "# Operation counts that may not rise. `UPDATE_COSTS=1 cargo test -p appell-tests cost`\n\
         # writes this file; a higher count needs a reason.\n",
    );
    for (mechanism, functions) in counts {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "\n[{mechanism}]");
        for (function, numbers) in functions {
            let entries: Vec<String> = COUNTED
                .iter()
                .zip(numbers)
                .filter(|((word, _), number)| **number > 0 || *word == "operations")
                .map(|((word, _), number)| format!("{word} = {number}"))
                .collect();
            let _ = writeln!(text, "{function} = {{ {} }}", entries.join(", "));
        }
    }
    text
}

#[test]
fn no_function_of_a_shipped_mechanism_takes_more_operations_than_it_did() {
    let file = shipped::workspace().join("tests/cost_baseline.toml");
    let now = counts();
    if std::env::var_os("UPDATE_COSTS").is_some() {
        std::fs::write(&file, write(&now)).unwrap();
    }
    let baseline: toml::Table = std::fs::read_to_string(&file).unwrap().parse().unwrap();
    let mut risen = Vec::new();
    for (mechanism, functions) in &now {
        for (function, numbers) in functions {
            let before = baseline.get(mechanism).and_then(|m| m.get(function));
            let Some(before) = before else {
                risen.push(format!("{mechanism}.{function} has no baseline"));
                continue;
            };
            for ((word, _), &number) in COUNTED.iter().zip(numbers) {
                let allowed = before
                    .get(word)
                    .and_then(toml::Value::as_integer)
                    .unwrap_or(0);
                if i64::try_from(number).unwrap() > allowed {
                    risen.push(format!(
                        "{mechanism}.{function}: {word} {allowed} -> {number}"
                    ));
                }
            }
        }
    }
    assert!(
        risen.is_empty(),
        "{}\nUPDATE_COSTS=1 accepts this",
        risen.join("\n")
    );
}

/// Operations of the rates of the spec that audits try.
fn of_an_ellipsoid(change: impl Fn(&str) -> String) -> usize {
    let path = "codegen/tests/audit/right/rolling_ellipsoid.toml";
    let text = std::fs::read_to_string(shipped::workspace().join(path)).unwrap();
    let mechanism = shipped::read(path, &change(&text));
    let program = shipped::program_of(&mechanism, &[FunctionKind::Rates]);
    OperationCount::of(&schedule(&program, &program.functions[0])).total()
}

#[test]
fn a_rolling_body_turns_about_its_contact() {
    // Twice as many where the centre's velocity is the derivative of its position.
    let from_contact = of_an_ellipsoid(str::to_owned);
    let from_centre = of_an_ellipsoid(|text| {
        let [place, _, rest] = ["P = ", "C = ", "[bodies]"].map(|key| text.find(key).unwrap());
        let reach =
            "sqrt(a^2*cos(alpha)^2*sin(beta)^2 + b^2*sin(alpha)^2 + c^2*cos(alpha)^2*cos(beta)^2)";
        let touched = [
            "a^2*cos(alpha)*sin(beta)",
            "-b^2*sin(alpha)",
            "-c^2*cos(alpha)*cos(beta)",
        ];
        let touched = touched
            .map(|component| format!("\"{component}/{reach}\""))
            .join(", ");
        format!(
            "{}C = {{ from = \"O\", in = \"ground\", at = [\"x\", \"y\", \"{reach}\"] }}\n\
             P = {{ from = \"C\", in = \"body\", at = [{touched}] }}\n{}",
            &text[..place],
            &text[rest..]
        )
    });
    assert!(from_contact <= 284, "{from_contact}");
    // The numbers of the manual.
    assert!(from_centre <= 261, "{from_centre}");
}

/// Operations of a function of the unicycle.
fn of_unicycle(kind: FunctionKind) -> OperationCount {
    let program = shipped::program("unicycle");
    let function = program.functions.iter().find(|f| f.kind == kind).unwrap();
    OperationCount::of(&schedule(program, function))
}

#[test]
fn the_unicycle_takes_at_most_90_operations_for_rates_and_200_with_jacobians() {
    for (kind, most) in [(FunctionKind::Rates, 90), (FunctionKind::Jacobians, 200)] {
        let count = of_unicycle(kind);
        assert!(count.total() <= most, "{count}");
        assert!(count.divide <= 4, "{count}");
        assert_eq!(count.sin_cos, 2, "{count}");
        assert_eq!(
            (count.functions, count.selects, count.solves),
            (0, 0, 0),
            "{count}"
        );
    }
}

#[test]
fn the_bicycle_takes_fewer_operations_than_the_best_published_equations() {
    use FunctionKind::{Jacobians, MassMatrixAndBias, ParameterJacobian};
    let program = shipped::program("bicycle");
    let count = |kind| {
        let function = program.function(kind).unwrap();
        OperationCount::of(&schedule(program, function)).total()
    };
    assert!(count(MassMatrixAndBias) <= 1900);
    assert!(count(Jacobians) <= 6000);
    // Each as a function of its own.
    assert!(count(Jacobians) + count(ParameterJacobian) <= 11_000);
}
