//! docs/add-a-mechanism.md tells what happens.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use appell_codegen::interpreted::InterpretedModel;
use appell_codegen::mechanics::derive;
use appell_codegen::program::FunctionKind;
use appell_report::derivation::{self, Stage};
use appell_runtime::model::{At, Model};

const PAGE: &str = include_str!("../../docs/add-a-mechanism.md");
const SPEC: &str = include_str!("../../docs/examples/ball_and_beam.toml");

/// The fenced blocks of a language.
fn blocks(language: &str) -> Vec<&'static str> {
    let fence = format!("```{language}\n");
    PAGE.split(fence.as_str())
        .skip(1)
        .map(|rest| rest.split("\n```").next().unwrap())
        .collect()
}

#[test]
fn the_pieces_of_the_page_are_the_spec() {
    assert_eq!(blocks("toml").join("\n\n"), SPEC.trim_end());
}

#[test]
fn the_equations_of_the_page_are_those_of_the_spec() {
    let checked = appell_spec::load("ball_and_beam.toml", SPEC).unwrap();
    let mut derivation = derive(&checked.mechanism).unwrap();
    let text = derivation::text(
        &derivation::page(&checked.mechanism, &mut derivation, Stage::Equations).unwrap(),
    );
    let equations = blocks("text")[1];
    assert!(equations.contains("sin α"));
    assert!(text.contains(equations), "{text}");
}

#[test]
fn the_ball_on_a_resting_beam_accelerates_with_five_sevenths() {
    let program =
        appell_codegen::compile("ball_and_beam.toml", SPEC, &FunctionKind::STANDARD).unwrap();
    let model = InterpretedModel::new(program);
    let info = model.info();
    let p = info.default_parameters();
    let [m, radius, beam, g] =
        ["m", "R", "J", "g"].map(|name| p[info.parameter_index(name).unwrap()]);
    let alpha = 0.3_f64;
    // With a torque that keeps the beam at rest; it feels the ball's friction at its own height.
    let v_dot = -5.0 / 7.0 * g * alpha.sin();
    let tau = m * g * 0.1 * alpha.cos() - 0.4 * m * radius * v_dot;
    let mut rates = [0.0; 5];
    let x = [0.0, 0.0, 0.1, alpha, 0.0];
    model.rates(
        At {
            t: 0.0,
            x: &x,
            u: &[tau],
            p: &p,
        },
        &mut rates,
    );
    assert!(
        (rates[0] - v_dot).abs() < 1e-12,
        "{} against {v_dot}",
        rates[0]
    );
    assert!((rates[1] * beam).abs() < 1e-14);
}
