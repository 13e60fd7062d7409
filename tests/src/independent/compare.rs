//! A derived model against Kane's and Lagrange's equations.

use appell_runtime::model::Model;
use appell_spec::Mechanism;
use appell_spec::mechanism::ConstraintKind;

use super::kane::kane;
use super::lagrange::lagrange;
use super::{Point, Setting};
use crate::engine::{Evaluation, assert_close};
use crate::random::Random;

/// Rounding of numeric linear algebra on positions differentiated twice, with condition numbers
/// up to a thousand.
pub const FORMULATIONS: f64 = 1e-10;
/// Entries below this size, in SI, are compared as if they had it: exact zeros of the derivation
/// are rounding errors in the numeric formulations.
pub const FLOOR: f64 = 1e-2;

/// Ratio of the largest to the smallest singular value.
fn condition(matrix: &nalgebra::DMatrix<f64>) -> f64 {
    let values = matrix.singular_values();
    if values.is_empty() {
        return 1.0;
    }
    values.max() / values.min()
}

/// Compares at random points.
pub fn compare(mechanism: &Mechanism, model: &dyn Model, points: usize) {
    let mut random = Random::of(&mechanism.name);
    for number in 0..points {
        let point = Point::random(model.info(), &mut random);
        compare_at(
            mechanism,
            model,
            &point,
            &format!("{} at point {number}", mechanism.name),
        );
    }
}

/// Compares at one point.
pub fn compare_at(mechanism: &Mechanism, model: &dyn Model, point: &Point, place: &str) {
    let info = model.info();
    let setting = Setting::new(mechanism, info, point);
    let derived = Evaluation::of(model, point.at());
    let close = |what: &str, got: &[f64], wanted: &[f64]| {
        assert_close(
            &format!("{place}, {what}"),
            got,
            wanted,
            FORMULATIONS,
            FLOOR,
        );
    };
    let (accelerations, rates) = derived.rates.split_at(info.speeds);

    let kane = kane(&setting);
    close(
        "generalised velocities by Kane",
        rates,
        &kane.coordinate_rates,
    );
    close(
        "mass matrix by Kane",
        &derived.mass_matrix,
        kane.mass_matrix.as_slice(),
    );
    close("bias by Kane", &derived.bias, kane.bias.as_slice());
    close("forces by Kane", &derived.forces, kane.forces.as_slice());
    // Solving M ω̇ = Π - b amplifies rounding by the condition of M.
    let amplified = f64::EPSILON * condition(&kane.mass_matrix);
    let close_solved = |what: &str, wanted: &[f64]| {
        let what = format!("{place}, accelerations by {what}");
        let tolerance = FORMULATIONS.max(amplified);
        assert_close(&what, accelerations, wanted, tolerance, FLOOR);
    };
    close_solved("Kane", kane.accelerations.as_slice());
    let lagrange = lagrange(&setting);
    close_solved("Lagrange", &lagrange.accelerations);

    // Reactions: each component that Lagrange's multipliers know, and the sum of all by Newton.
    assert_eq!(
        lagrange.reactions.len(),
        info.reactions.len(),
        "{place}: places with reactions"
    );
    let (mut got, mut wanted) = (Vec::new(), Vec::new());
    for ((name, force), (place, derived)) in lagrange
        .reactions
        .iter()
        .zip(info.reactions.iter().zip(derived.reactions.chunks(3)))
    {
        assert_eq!(name, place);
        for (known, derived) in force.iter().zip(derived) {
            if let Some(known) = known {
                wanted.push(*known);
                got.push(*derived);
            }
        }
    }
    close("reactions by Lagrange", &got, &wanted);
    let rolling = |kind: &ConstraintKind| matches!(kind, ConstraintKind::Rolling { .. });
    if !mechanism.constraints.is_empty() && mechanism.constraints.iter().all(|c| rolling(&c.kind)) {
        let mut sum = [0.0; 3];
        for reaction in derived.reactions.chunks(3) {
            for (sum, component) in sum.iter_mut().zip(reaction) {
                *sum += component;
            }
        }
        close("sum of the reactions by Newton", &sum, &kane.total_reaction);
    }
}
