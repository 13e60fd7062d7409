//! Appell's equations, Kane's and Lagrange's with multipliers are three ways to one motion.

use appell_tests::engine::interpreter;
use appell_tests::independent::compare::compare;
use appell_tests::shipped;

/// Random points per mechanism.
const POINTS: usize = 12;

#[test]
fn appell_kane_and_lagrange_agree_for_every_shipped_mechanism() {
    for name in shipped::names() {
        let mechanism = shipped::mechanism(&name);
        compare(&mechanism, &interpreter(&mechanism), POINTS);
    }
}
