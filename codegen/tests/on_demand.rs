//! Functions of a model that are derived when they are asked for.
#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_codegen::compile::{compile, derived};
use appell_codegen::program::FunctionKind;
use appell_codegen::schedule::schedule;
use appell_codegen::tapes::Tapes;

const SPECS: [&str; 3] = [
    include_str!("../../generated/mechanisms/unicycle.toml"),
    include_str!("../../generated/mechanisms/pendulum.toml"),
    include_str!("emit_support/block.toml"),
];

fn tapes(text: &str) -> Tapes {
    derived("spec.toml", text).unwrap().functions().into()
}

#[test]
fn a_function_does_not_depend_on_what_else_was_asked_for() {
    for text in SPECS {
        let program = compile("spec.toml", text, &FunctionKind::ALL).unwrap();
        let (forward, backward) = (tapes(text), tapes(text));
        let last_first: Vec<_> = FunctionKind::ALL.into_iter().rev().collect();
        backward.require(&last_first, text).unwrap();
        for kind in FunctionKind::ALL {
            let [one, other] = [&forward, &backward].map(|tapes| tapes.get(kind));
            assert_eq!(one.is_some(), program.function(kind).is_some(), "{kind:?}");
            let (Some(one), Some(other)) = (one, other) else {
                continue;
            };
            assert_eq!(one.operations, other.operations, "{kind:?}");
            let alone = compile("spec.toml", text, &[kind]).unwrap();
            let together = schedule(&program, program.function(kind).unwrap());
            let alone = schedule(&alone, &alone.functions[0]);
            assert_eq!(alone.operations, together.operations, "{kind:?}");
        }
    }
}

#[test]
fn a_program_has_the_functions_that_it_was_made_with() {
    let program = compile("spec.toml", SPECS[1], &[FunctionKind::Rates]).unwrap();
    let tapes = Tapes::from(program);
    assert!(tapes.get(FunctionKind::Rates).is_some());
    assert!(tapes.get(FunctionKind::Jacobians).is_none());
    tapes.require(&[FunctionKind::Jacobians], SPECS[1]).unwrap();
}
