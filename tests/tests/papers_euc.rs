//! The equations of *Experimental Model Identification of the Longitudinal Dynamics of an Electric
//! Unicycle with a Human Rider* are the derived ones: as functions, not at points.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_codegen::symbolic::{Expr, Graph};
use appell_tests::paper::{Paper, euc_2dof, euc_3dof};

/// Equations of the model with two degrees of freedom, (11), as residuals.
const TWO_DOF_ROW_1: &str =
    "(m + m0 + mw + Jw/R**2)*ddx + m*h*cos(ph)*ddph - (Md/R + m*h*dph**2*sin(ph))";
const TWO_DOF_ROW_2: &str = "m*h*cos(ph)*ddx + (J + m*h**2)*ddph - (m*g*h*sin(ph) - Md)";

#[test]
fn euc_paper_equation_6_mass_matrix() {
    euc_3dof().assert(
        "m11 = m + m0 + mw + Jw/R**2
         m12 = -(m*l0 - m0*h0)*cos(ga)
         m13 = m*h*cos(ph)
         m22 = J0 + m0*h0**2 + m*l0**2
         m23 = -m*h*l0*cos(ph - ga)
         m33 = J + m*h**2
         m21 = -(m*l0 - m0*h0)*cos(ga)
         m31 = m*h*cos(ph)
         m32 = -m*h*l0*cos(ph - ga)",
    );
}

#[test]
fn euc_paper_equation_7_bias() {
    euc_3dof().assert(
        "h1 = -m*h*dph**2*sin(ph) + (m*l0 - m0*h0)*dga**2*sin(ga)
         h2 = m*h*l0*dph**2*sin(ph - ga)
         h3 = -m*h*l0*dga**2*sin(ph - ga)",
    );
}

#[test]
fn euc_paper_equation_8_forces() {
    euc_3dof().assert(
        "Q1 = Md/R
         Q2 = Mh - Md + (m0*h0 - m*l0)*g*sin(ga)
         Q3 = m*g*h*sin(ph) - Mh",
    );
}

#[test]
fn euc_paper_equation_a1_kinetic_energy() {
    euc_3dof().assert(
        "T = 1/2*(m + m0 + mw + Jw/R**2)*dx**2 + 1/2*(J0 + m*l0**2 + m0*h0**2)*dga**2 + 1/2*(J + m*h**2)*dph**2 - (m*l0 - m0*h0)*dx*dga*cos(ga) + m*h*dx*dph*cos(ph) - m*h*l0*dga*dph*cos(ph - ga)",
    );
}

#[test]
fn potential_energy_and_power_of_the_euc() {
    let mut paper = euc_3dof();
    paper.assert("power = Md*(dx/R - dga) + Mh*(dga - dph)");
    paper.assert("energy_rate = Md*(dx/R - dga) + Mh*(dga - dph)");
    // A potential is determined up to a constant: here the heights count from the ground.
    paper.assert("V = m0*g*h0*cos(ga) + m*g*(h*cos(ph) - l0*cos(ga)) + (m + m0 + mw)*g*R");
    drop(paper);
    euc_2dof().assert(
        "power = Md*(dx/R - dph)
         energy_rate = Md*(dx/R - dph)",
    );
}

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
    let mut substitution = paper.substitution(replacements);
    substitution
        .apply(&mut paper.derivation.algebra.graph, expr)
        .unwrap()
}

fn assert_zero(paper: &mut Paper, expr: Expr) {
    assert!(paper.same(expr, Graph::ZERO));
}

#[test]
fn euc_paper_equation_9_driving_torque_from_the_first_row() {
    let mut paper = euc_3dof();
    with_entries(&mut paper);
    paper.assert_solves("row1", &[("Md", TORQUE_1)]);
}

/// Rows 2 and 3 together, free of the ankle torque.
fn rows_2_and_3(paper: &mut Paper) -> Expr {
    let (row2, row3) = (paper.derived("row2"), paper.derived("row3"));
    paper.derivation.algebra.graph.add(row2, row3)
}

#[test]
fn euc_paper_equation_10_driving_torque_without_the_forward_acceleration() {
    let mut paper = euc_3dof();
    with_entries(&mut paper);
    let rows = rows_2_and_3(&mut paper);
    let no_acceleration = "(Md/R - m12*ddga - m13*ddph - h1)/m11";
    let without = replaced(&mut paper, rows, &[("ddx", no_acceleration)]);
    for unknown in ["ddx", "Mh"] {
        let symbol = paper
            .derivation
            .algebra
            .graph
            .as_symbol(paper.scope.get(unknown).unwrap())
            .unwrap();
        let algebra = &mut paper.derivation.algebra;
        assert!(
            algebra.test.independent_of(&algebra.graph, without, symbol),
            "{unknown}"
        );
    }
    let solved = replaced(&mut paper, without, &[("Md", TORQUE_2)]);
    assert_zero(&mut paper, solved);
}

#[test]
fn driving_torque_from_rows_2_and_3_with_measured_forward_acceleration() {
    let mut paper = euc_3dof();
    with_entries(&mut paper);
    let rows = rows_2_and_3(&mut paper);
    let solved = replaced(&mut paper, rows, &[("Md", TORQUE_23)]);
    assert_zero(&mut paper, solved);
}

#[test]
fn the_three_driving_torques_differ_by_one_identity() {
    let mut paper = euc_3dof();
    with_entries(&mut paper);
    let rel =
        format!("({TORQUE_1}) - ({TORQUE_2}) - (({TORQUE_1}) - ({TORQUE_23}))*R*m11/(R*m11 + k)");
    let rel = paper.formula(&rel);
    assert_zero(&mut paper, rel);
}

#[test]
fn euc_paper_equation_11_two_degrees_of_freedom() {
    let mut paper = euc_2dof();
    paper.assert(
        "m11 = m + m0 + mw + Jw/R**2
         m12 = m*h*cos(ph)
         m22 = J + m*h**2
         h1 = -m*h*dph**2*sin(ph)
         h2 = 0
         Q1 = Md/R
         Q2 = m*g*h*sin(ph) - Md",
    );
    paper.assert(&format!("row1 = {TWO_DOF_ROW_1}\nrow2 = {TWO_DOF_ROW_2}"));
}

#[test]
fn euc_paper_equation_12_the_model_of_three_degrees_of_freedom_becomes_that_of_two() {
    let mut paper = euc_3dof();
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

/// The two formulas (13) for the driving torque.
const MEAN_TORQUE_1: &str = "-m*h*R*sin(ph)*dph**2 + meq*R*ddx + m*h*R*cos(ph)*ddph";
const MEAN_TORQUE_2: &str = "(meq*m*g*h*R*sin(ph) - m**2*h**2*R*sin(ph)*cos(ph)*dph**2 + (m**2*h**2*R*cos(ph)**2 - meq*R*(J + m*h**2))*ddph)/(m*h*cos(ph) + meq*R)";

#[test]
fn euc_paper_equation_13_driving_torque_of_the_model_of_two_degrees_of_freedom() {
    let mut paper = euc_2dof();
    let mass = paper.formula("m + m0 + mw + Jw/R**2");
    paper.scope.define("meq", mass);
    paper.assert_solves("row1", &[("Md", MEAN_TORQUE_1)]);
    let row2 = paper.derived("row2");
    let no_acceleration = "(Md/R + m*h*dph**2*sin(ph) - m*h*cos(ph)*ddph)/meq";
    let row2 = replaced(&mut paper, row2, &[("ddx", no_acceleration)]);
    let solved = replaced(&mut paper, row2, &[("Md", MEAN_TORQUE_2)]);
    assert_zero(&mut paper, solved);
}

#[test]
fn the_derivatives_of_the_acceleration_energy_are_the_left_sides_of_appell() {
    for paper in [euc_2dof, euc_3dof] {
        let mut paper = paper();
        for k in 1..=paper.derivation.symbols.speeds.len() {
            let (a, b) = (
                paper.derived(&format!("dS{k}")),
                paper.derived(&format!("left{k}")),
            );
            assert!(paper.same(a, b), "{} equation {k}", paper.mechanism.name);
        }
    }
}
