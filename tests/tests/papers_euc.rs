//! The equations of *Experimental Model Identification of the Longitudinal Dynamics of an Electric
//! Unicycle with a Human Rider* are the derived ones: as functions, not at points.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_codegen::symbolic::{Expr, Graph};
use appell_papers::euc::EQUATIONS;
use appell_tests::paper::{Paper, Subject};

/// Equations of the model with two degrees of freedom, (11), as residuals.
const TWO_DOF_ROW_1: &str =
    "(m + m0 + mw + Jw/R**2)*ddx + m*h*cos(ph)*ddph - (Md/R + m*h*dph**2*sin(ph))";
const TWO_DOF_ROW_2: &str = "m*h*cos(ph)*ddx + (J + m*h**2)*ddph - (m*g*h*sin(ph) - Md)";

/// Names for the entries of Appell's equations, with measured accelerations.
fn with_entries(paper: &mut Paper) {
    for name in ["m11", "m12", "m13", "m22", "m23", "m33", "h1", "h2", "h3"] {
        let entry = paper.derived(name);
        paper.scope.define(name, entry);
    }
    let k = paper.formula("m12 + m13");
    paper.scope.define("k", k);
}

/// Formulas for the driving torque.
const TORQUE_1: &str = "R*(m11*ddx + m12*ddga + m13*ddph + h1)";
const TORQUE_2: &str = "R*m11/(R*m11 + k)*((m0*h0 - m*l0)*g*sin(ga) + m*g*h*sin(ph) - (m22 + m23)*ddga - (m23 + m33)*ddph - h2 - h3 + k/m11*(m12*ddga + m13*ddph + h1))";
const TORQUE_23: &str = "(m0*h0 - m*l0)*g*sin(ga) + m*g*h*sin(ph) - k*ddx - (m22 + m23)*ddga - (m23 + m33)*ddph - h2 - h3";

fn replaced(paper: &mut Paper, expr: Expr, replacements: &[(&str, &str)]) -> Expr {
    let scope = paper.scope.clone();
    let mut substitution = paper.substitution(&scope, replacements);
    substitution
        .apply(&mut paper.derivation.algebra.graph, expr)
        .unwrap()
}

fn assert_zero(paper: &mut Paper, expr: Expr) {
    assert!(paper.same(expr, Graph::ZERO));
}

/// Rows 2 and 3 together, free of the ankle torque.
fn rows_2_and_3(paper: &mut Paper) -> Expr {
    let (row2, row3) = (paper.derived("row2"), paper.derived("row3"));
    paper.derivation.algebra.graph.add(row2, row3)
}

#[test]
fn every_equation_of_the_paper_is_the_derived_one() {
    for equation in EQUATIONS.iter() {
        let differences = equation.differences();
        assert!(
            differences.is_empty(),
            "{}: {}",
            equation.number,
            differences.join("\n")
        );
    }
}

#[test]
fn a_wrong_formula_is_no_equation_of_the_paper() {
    let wrong = Subject::Euc3.paper().differences("m33 = J + m*h", &[]);
    assert_eq!(wrong.len(), 1);
}

#[test]
fn power_of_the_euc_with_two_degrees_of_freedom() {
    Subject::Euc2.paper().assert(
        "power = Md*(dx/R - dph)
         energy_rate = Md*(dx/R - dph)",
    );
}

#[test]
fn driving_torque_from_rows_2_and_3_with_measured_forward_acceleration() {
    let mut paper = Subject::Euc3.paper();
    with_entries(&mut paper);
    let rows = rows_2_and_3(&mut paper);
    let solved = replaced(&mut paper, rows, &[("Md", TORQUE_23)]);
    assert_zero(&mut paper, solved);
}

#[test]
fn the_three_driving_torques_differ_by_one_identity() {
    let mut paper = Subject::Euc3.paper();
    with_entries(&mut paper);
    let rel =
        format!("({TORQUE_1}) - ({TORQUE_2}) - (({TORQUE_1}) - ({TORQUE_23}))*R*m11/(R*m11 + k)");
    let rel = paper.formula(&rel);
    assert_zero(&mut paper, rel);
}

#[test]
fn euc_paper_equation_12_the_model_of_three_degrees_of_freedom_becomes_that_of_two() {
    let mut paper = Subject::Euc3.paper();
    let simpler = [("J0", "0"), ("h0", "0"), ("l0", "0")];
    // The second row leaves nothing but the balance of the two torques.
    let row = paper.derived("row2");
    let row = replaced(&mut paper, row, &simpler);
    let balance = paper.formula("Md - Mh");
    assert!(paper.same(row, balance));
    for (name, typed) in [("row1", TWO_DOF_ROW_1), ("row3", TWO_DOF_ROW_2)] {
        let row = paper.derived(name);
        let row = replaced(
            &mut paper,
            row,
            &[("J0", "0"), ("h0", "0"), ("l0", "0"), ("Mh", "Md")],
        );
        let typed = paper.formula(typed);
        assert!(paper.same(row, typed), "{name}");
    }
}

#[test]
fn the_derivatives_of_the_acceleration_energy_are_the_left_sides_of_appell() {
    for subject in [Subject::Euc2, Subject::Euc3] {
        let mut paper = subject.paper();
        for k in 1..=paper.derivation.symbols.speeds.len() {
            let (a, b) = (
                paper.derived(&format!("dS{k}")),
                paper.derived(&format!("left{k}")),
            );
            assert!(paper.same(a, b), "{} equation {k}", paper.mechanism.name);
        }
    }
}
