//! Laws of the symbolic engine on random expressions of all kinds.

#![allow(clippy::unwrap_used, reason = "tests")]

use std::cell::Cell;

use appell_codegen::symbolic::{
    Derivatives, Expr, Function, Graph, IdentityTest, Intervals, Node, Substitution, evaluate,
};
use proptest::prelude::*;

use crate::symbolic_random::{Kind, SYMBOLS, build, check, graph, programs, show, symbol};

/// Values for the three symbols.
fn values() -> [std::ops::Range<f64>; 3] {
    [0.2..2.0, -2.0..2.0, -1.0..3.0]
}

fn close(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance * (1.0 + a.abs().max(b.abs()))
}

#[test]
fn derivatives_agree_with_finite_differences() {
    let judged = Cell::new(0);
    check(
        3000,
        &(programs(14), values(), 0..SYMBOLS),
        |(program, point, by)| {
            let (mut g, symbols) = graph();
            let expr = build(&mut g, &symbols, Kind::Any, &program);
            let derivative = Derivatives::with_respect_to(symbol(by)).of(&mut g, expr);
            let exact = evaluate(&g, &point, &[derivative])[0];
            let difference = |h: f64| {
                let at = |offset: f64| {
                    let mut moved = point;
                    moved[by as usize] += offset;
                    evaluate(&g, &moved, &[expr])[0]
                };
                (at(h) - at(-h)) / (2.0 * h)
            };
            // A kink, a pole or cancellation shows in the disagreement of two steps.
            let (wide, narrow) = (difference(2e-4), difference(1e-4));
            if !narrow.is_finite() || !close(wide, narrow, 1e-6) || narrow.abs() > 1e6 {
                return Ok(());
            }
            // Rounding hides the derivative of a large value.
            if evaluate(&g, &point, &[expr])[0].abs() > 1e3 {
                return Ok(());
            }
            // Zero times infinity, from parts that leave the range of doubles.
            if exact.is_nan() {
                return Ok(());
            }
            judged.set(judged.get() + 1);
            prop_assert!(
                close(exact, narrow, 1e-5),
                "{} against {}: {}",
                exact,
                narrow,
                show(&g, expr)
            );
            Ok(())
        },
    );
    assert!(
        judged.get() > 1500,
        "only {} cases were smooth",
        judged.get()
    );
}

#[test]
fn derivatives_of_unknowns_agree_with_finite_differences() {
    check(
        300,
        &(programs(6), programs(6), values()),
        |(first, second, point)| {
            let (mut g, symbols) = graph();
            let a = build(&mut g, &symbols, Kind::Circular, &first);
            let b = build(&mut g, &symbols, Kind::Circular, &second);
            let six = g.integer(6);
            let corner = g.sin(b);
            let diagonal = g.add(six, corner);
            let (low, high) = (g.cos(a), g.sin(a));
            let unknowns = g.solve_numerically(vec![six, low, high, diagonal], vec![a, b]);
            let derivative = Derivatives::with_respect_to(symbol(0)).of(&mut g, unknowns[1]);
            let second = Derivatives::with_respect_to(symbol(0)).of(&mut g, derivative);
            for (value, slope) in [(unknowns[1], derivative), (derivative, second)] {
                let at = |h: f64| evaluate(&g, &[point[0] + h, point[1], point[2]], &[value])[0];
                let (wide, narrow) = ((at(2e-4) - at(-2e-4)) / 4e-4, (at(1e-4) - at(-1e-4)) / 2e-4);
                let exact = evaluate(&g, &point, &[slope])[0];
                if narrow.is_finite() && close(wide, narrow, 1e-6) && at(0.0).abs() < 1e3 {
                    prop_assert!(close(exact, narrow, 1e-5), "{} against {}", exact, narrow);
                }
            }
            Ok(())
        },
    );
}

#[test]
fn substitution_commutes_with_evaluation() {
    check(
        1500,
        &(programs(12), programs(5), values()),
        |(program, inner, point)| {
            let (mut g, symbols) = graph();
            let expr = build(&mut g, &symbols, Kind::Any, &program);
            let value = build(&mut g, &symbols, Kind::Circular, &inner);
            let replaced = Substitution::new(&mut g, &[(symbol(0), value)]).apply(&mut g, expr);
            let Some(replaced) = replaced else {
                return Ok(());
            };
            let mut moved = point;
            moved[0] = evaluate(&g, &point, &[value])[0];
            let (direct, indirect) = (
                evaluate(&g, &moved, &[expr])[0],
                evaluate(&g, &point, &[replaced])[0],
            );
            // Cancellation and functions at a jump: judged where the neighbourhood is tame.
            moved[0] *= 1.0 + 1e-9;
            let nearby = evaluate(&g, &moved, &[expr])[0];
            if direct.is_finite() && indirect.is_finite() && close(direct, nearby, 1e-6) {
                prop_assert!(
                    close(direct, indirect, 1e-5),
                    "{} against {}",
                    direct,
                    indirect
                );
            }
            Ok(())
        },
    );
}

#[test]
fn values_stay_in_their_intervals() {
    let bounded = Cell::new(0);
    let strategy = (
        programs(12),
        prop::array::uniform3((-3.0..3.0, 0.0..2.0)),
        prop::array::uniform3(0.0..1.0),
    );
    check(3000, &strategy, |(program, boxes, place)| {
        let (mut g, symbols) = graph();
        let expr = build(&mut g, &symbols, Kind::Any, &program);
        let ranges = (0..3).map(|i| {
            (
                symbol(i),
                boxes[i as usize].0,
                boxes[i as usize].0 + boxes[i as usize].1,
            )
        });
        let mut intervals = Intervals::new(&g, ranges.collect());
        let point: Vec<f64> = (0..3).map(|i| boxes[i].0 + place[i] * boxes[i].1).collect();
        let order = g.in_order(&[expr]);
        let found = evaluate(&g, &point, &order);
        for (&part, value) in order.iter().zip(found) {
            // Infinite: something overflowed or was divided by a zero.
            if !value.is_finite() {
                break;
            }
            let interval = intervals.of(&g, part);
            prop_assert!(
                interval.contains(value),
                "{:?} misses {}: {}",
                interval,
                value,
                show(&g, part)
            );
            if interval.lo > -1e3 && interval.hi < 1e3 {
                bounded.set(bounded.get() + 1);
            }
            if value == 0.0 && !can_underflow(&g, part) {
                prop_assert!(!intervals.cannot_vanish(&g, part), "{}", show(&g, part));
            }
        }
        Ok(())
    });
    assert!(bounded.get() > 3000);
}

/// Exponentials and high powers, which underflow.
fn can_underflow(g: &Graph, root: Expr) -> bool {
    g.in_order(&[root]).iter().any(|&e| match g.node(e) {
        Node::Power(..) | Node::Function(Function::Exp, _) => true,
        Node::Product(factors) => factors.iter().any(|f| f.exponent.abs() > 16),
        _ => false,
    })
}

/// Random pairs that differ in double precision must differ in the field, and pairs that are equal in
/// the field must be so in double precision.
#[test]
fn unequal_expressions_are_never_called_equal() {
    let (unequal, equal) = (Cell::new(0), Cell::new(0));
    let strategy = (
        programs(9),
        programs(9),
        prop::array::uniform4(values()),
        any::<u64>(),
    );
    check(4000, &strategy, |(first, second, points, seed)| {
        let (mut g, symbols) = graph();
        let a = build(&mut g, &symbols, Kind::Any, &first);
        let b = build(&mut g, &symbols, Kind::Any, &second);
        let mut test = IdentityTest::new(seed);
        let claimed = test.are_equal(&g, a, b);
        for point in points {
            let pair = evaluate(&g, &point, &[a, b]);
            if pair.iter().all(|v| v.is_finite() && v.abs() < 1e6) && !close(pair[0], pair[1], 1e-6)
            {
                unequal.set(unequal.get() + 1);
                prop_assert!(!claimed, "{:?}", pair);
            }
        }
        if claimed {
            equal.set(equal.get() + 1);
        }
        Ok(())
    });
    assert!(
        unequal.get() > 5000 && equal.get() > 0,
        "{} {}",
        unequal.get(),
        equal.get()
    );
}

/// One expression written twice: multiplied out, and with a symbol moved there and back.
#[test]
fn other_spellings_are_found_equal() {
    let changed = Cell::new(0);
    check(1500, &(programs(8), programs(8)), |(first, second)| {
        let (mut g, symbols) = graph();
        let a = build(&mut g, &symbols, Kind::Circular, &first);
        let b = build(&mut g, &symbols, Kind::Circular, &second);
        let (left, right) = (g.add(a, symbols[0]), g.sub(b, symbols[1]));
        let expr = g.mul(left, right);
        let mut test = IdentityTest::new(3);
        // What is undefined at every point equals nothing.
        let parts = [g.mul(a, right), g.mul(symbols[0], right)];
        let apart = g.sum(&parts);
        if !test.are_equal(&g, expr, apart) {
            return Ok(());
        }
        if let Some(expanded) = g.expand(expr, 300) {
            changed.set(changed.get() + u32::from(expanded != expr));
            prop_assert!(test.are_equal(&g, expr, expanded), "{}", show(&g, expr));
        }
        let taken_out = g.take_out_common_factors(expr);
        prop_assert!(test.are_equal(&g, expr, taken_out), "{}", show(&g, expr));
        let shift = g.add(symbols[0], symbols[1]);
        let back = g.sub(symbols[0], symbols[1]);
        let moved = Substitution::new(&mut g, &[(symbol(0), shift)]).apply(&mut g, expr);
        let Some(moved) = moved else { return Ok(()) };
        let returned = Substitution::new(&mut g, &[(symbol(0), back)]).apply(&mut g, moved);
        // Angles are not multiplied out: products in them may keep the detour.
        if let Some(returned) = returned
            && !angles_hold_products(&g, &[expr, moved])
        {
            prop_assert!(test.are_equal(&g, expr, returned), "{}", show(&g, expr));
        }
        Ok(())
    });
    assert!(changed.get() > 1000, "{}", changed.get());
}

fn angles_hold_products(g: &Graph, roots: &[Expr]) -> bool {
    g.in_order(roots).iter().any(|&e| match g.node(e) {
        Node::Function(_, x) => g
            .in_order(&[*x])
            .iter()
            .any(|&p| matches!(g.node(p), Node::Product(_))),
        _ => false,
    })
}

#[test]
fn expansion_leaves_no_product_of_sums() {
    check(500, &programs(10), |program| {
        let (mut g, symbols) = graph();
        let expr = build(&mut g, &symbols, Kind::Rational, &program);
        let Some(expanded) = g.expand(expr, 100) else {
            return Ok(());
        };
        let terms = match g.node(expanded) {
            Node::Sum(terms) => terms.iter().map(|t| t.expr).collect(),
            _ => vec![expanded],
        };
        prop_assert!(terms.len() <= 100);
        for term in terms {
            if let Node::Product(factors) = g.node(term) {
                let open = |e: Expr| matches!(g.node(e), Node::Sum(_));
                prop_assert!(!factors.iter().any(|f| f.exponent > 0 && open(f.base)));
            }
        }
        Ok(())
    });
}

#[test]
fn dependence_is_what_finite_differences_see() {
    check(
        1500,
        &(programs(10), prop::array::uniform2(values()), 0..SYMBOLS),
        |(program, points, by)| {
            let (mut g, symbols) = graph();
            let expr = build(&mut g, &symbols, Kind::Any, &program);
            let mut test = IdentityTest::new(5);
            if !test.independent_of(&g, expr, symbol(by)) {
                return Ok(());
            }
            let [point, other] = points;
            let mut moved = point;
            moved[by as usize] = other[by as usize];
            let (before, after) = (
                evaluate(&g, &point, &[expr])[0],
                evaluate(&g, &moved, &[expr])[0],
            );
            if before.is_finite() && after.is_finite() && before.abs() < 1e6 {
                prop_assert!(close(before, after, 1e-6), "{} against {}", before, after);
            }
            Ok(())
        },
    );
}
