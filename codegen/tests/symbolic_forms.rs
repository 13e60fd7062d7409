//! Canonical forms, operation counts and expansion on small examples.

#![allow(clippy::unwrap_used, reason = "tests")]

use appell_codegen::symbolic::{
    Derivatives, Expr, Function, Graph, IdentityTest, Intervals, Node, Rational, Relation,
    Substitution, SymbolId, evaluate,
};

fn symbols<const N: usize>(g: &mut Graph, names: [&str; N]) -> [Expr; N] {
    names.map(|n| g.symbol(n))
}

#[test]
fn sums_and_products_do_not_depend_on_order() {
    let mut g = Graph::new();
    let [x, y, z] = symbols(&mut g, ["x", "y", "z"]);
    assert_eq!(g.sum(&[x, y, z]), g.sum(&[z, x, y]));
    assert_eq!(g.product(&[x, y, z]), g.product(&[z, x, y]));
    let (xy, zy) = (g.add(x, y), g.add(z, y));
    assert_eq!(g.add(xy, z), g.add(x, zy));
    assert_eq!(g.sub(xy, y), x);
    assert_eq!(g.sub(xy, xy), Graph::ZERO);
    assert_eq!(g.div(xy, xy), Graph::ONE);
    let two = g.integer(2);
    let doubled = g.mul(two, xy);
    let (x2, y2) = (g.scale(&2.into(), x), g.scale(&2.into(), y));
    assert_eq!(doubled, g.add(x2, y2), "numbers are distributed over sums");
    // A sum as a factor gives up its content and its sign.
    let (difference, opposite) = (g.sub(x, y), g.sub(y, x));
    let (left, right) = (g.mul(z, difference), g.mul(z, opposite));
    assert_eq!(g.add(left, right), Graph::ZERO);
    let square = g.square(difference);
    assert_eq!(square, g.square(opposite));
}

#[test]
fn powers_beyond_the_largest_exponent_stay_exact() {
    let mut g = Graph::new();
    let [x, y] = symbols(&mut g, ["x", "y"]);
    let high = |g: &mut Graph, e| g.pow(e, i32::MAX);
    let root = {
        let xy = g.mul(x, y);
        high(&mut g, xy)
    };
    let tower = high(&mut g, root);
    assert_ne!(tower, root, "(a^n)^n is not a^n");
    let once = high(&mut g, x);
    let (twice, thrice) = (g.mul(once, once), g.product(&[once, once, once]));
    assert!(once != twice && twice != thrice);
    assert_eq!(g.div(twice, once), once);
    let value = |g: &Graph, e| evaluate(g, &[1.0 + 1e-10, 1.0], &[e])[0];
    let ratio = value(&g, twice) / value(&g, once).powi(2);
    assert!((ratio - 1.0).abs() < 1e-6, "{ratio}");
    let lowest = g.pow(x, i32::MIN);
    let back = g.pow(x, i32::MAX);
    let product = g.product(&[lowest, back, x]);
    assert!((value(&g, product) - 1.0).abs() < 1e-6);
}

#[test]
fn pythagoras_shortens_sums() {
    let mut g = Graph::new();
    let [x, m, l] = symbols(&mut g, ["x", "m", "l"]);
    let (s, c) = (g.sin(x), g.cos(x));
    let (s2, c2) = (g.square(s), g.square(c));
    assert_eq!(g.add(s2, c2), Graph::ONE);
    assert_eq!(g.sub(Graph::ONE, s2), c2);
    let (ms, mc) = (g.product(&[m, l, s2]), g.product(&[m, l, c2]));
    let ml = g.mul(m, l);
    assert_eq!(g.add(ms, mc), ml);
    assert_eq!(g.sub(ml, mc), ms);
    // Expressions that would not become shorter are unchanged.
    let twice = g.scale(&2.into(), s2);
    let kept = g.add(twice, c2);
    assert!(matches!(g.node(kept), Node::Sum(t) if t.len() == 2));
}

#[test]
fn functions_take_out_signs_and_know_exact_values() {
    let mut g = Graph::new();
    let [x] = symbols(&mut g, ["x"]);
    let minus = g.neg(x);
    let (sin, sin_minus) = (g.sin(x), g.sin(minus));
    assert_eq!(sin_minus, g.neg(sin));
    assert_eq!(g.cos(minus), g.cos(x));
    assert_eq!(g.sin(Graph::ZERO), Graph::ZERO);
    assert_eq!(g.cos(Graph::ZERO), Graph::ONE);
    assert_eq!(g.function(Function::Exp, Graph::ZERO), Graph::ONE);
    assert_eq!(g.function(Function::Ln, Graph::ONE), Graph::ZERO);
    let (ratio, root) = (g.fraction(9, 4), g.fraction(3, 2));
    assert_eq!(g.sqrt(ratio), root);
    let three = g.integer(3);
    let irrational = g.sqrt(three);
    assert!(matches!(
        g.node(irrational),
        Node::Function(Function::Sqrt, _)
    ));
    let five = g.integer(-5);
    assert_eq!(g.function(Function::Abs, five), g.integer(5));
    assert_eq!(g.function(Function::Sign, five), g.integer(-1));
}

#[test]
fn even_powers_of_roots_are_powers() {
    let mut g = Graph::new();
    let [x] = symbols(&mut g, ["x"]);
    let root = g.sqrt(x);
    assert_eq!(g.square(root), x);
    let cube = g.pow(root, 3);
    assert_eq!(cube, g.mul(x, root));
    let under = g.pow(root, -2);
    assert_eq!(g.mul(under, x), Graph::ONE);
    let nested = g.sqrt(root);
    assert_eq!(g.pow(nested, 4), x);
    assert_eq!(g.pow(nested, 2), root);
}

#[test]
fn choices_between_numbers_are_decided() {
    let mut g = Graph::new();
    let [x, y] = symbols(&mut g, ["x", "y"]);
    assert_eq!(
        g.choice(Relation::Less, [Graph::ONE, Graph::ONE], [x, y]),
        y
    );
    assert_eq!(
        g.choice(Relation::LessOrEqual, [Graph::ONE, Graph::ONE], [x, y]),
        x
    );
    assert_eq!(g.choice(Relation::Less, [x, y], [y, y]), y);
}

#[test]
fn huge_numbers_stay_factors() {
    let mut g = Graph::new();
    let ten = g.fraction(10, 3);
    let tower = g.pow(ten, 100_000);
    let less = g.pow(ten, -99_999);
    assert_eq!(g.mul(tower, less), ten);
}

#[test]
fn substitution_refuses_to_divide_by_zero() {
    let mut g = Graph::new();
    let [x, y] = symbols(&mut g, ["x", "y"]);
    let quotient = g.div(y, x);
    let half_power = g.power(x, y);
    let id = g.as_symbol(x).unwrap();
    let mut at_zero = Substitution::new(&mut g, &[(id, Graph::ZERO)]);
    assert_eq!(at_zero.apply(&mut g, quotient), None);
    let exponent = g.as_symbol(y).unwrap();
    let minus = g.integer(-2);
    let mut both = Substitution::new(&mut g, &[(id, Graph::ZERO), (exponent, minus)]);
    assert_eq!(both.apply(&mut g, half_power), None);
    let mut swap = Substitution::new(&mut g, &[(id, y), (exponent, x)]);
    let swapped = swap.apply(&mut g, quotient);
    assert_eq!(swapped, Some(g.div(x, y)));
}

#[test]
fn names_keep_their_derivative_together() {
    let mut g = Graph::new();
    let [x, y] = symbols(&mut g, ["x", "y"]);
    let product = g.mul(x, y);
    let (s, square) = (g.sin(x), g.square(x));
    let sum = g.sum(&[product, s, square]);
    let named = g.name("lever", sum);
    let derivative = Derivatives::with_respect_to(SymbolId(0)).of(&mut g, named);
    match g.node(derivative) {
        Node::Named(id) => assert_eq!(g.definition(*id).name, "d_lever_d_x"),
        other => panic!("{other:?}"),
    }
}

#[test]
fn parts_come_before_wholes() {
    let mut g = Graph::new();
    let [x, y] = symbols(&mut g, ["x", "y"]);
    let mut deep = x;
    // Deep enough to overflow the stack of a recursion.
    for i in 0..200_000 {
        let next = if i % 2 == 0 {
            g.sin(deep)
        } else {
            g.add(deep, y)
        };
        deep = next;
    }
    let order = g.in_order(&[deep]);
    assert_eq!(order.last(), Some(&deep));
    let value = evaluate(&g, &[0.3, 0.1], &[deep])[0];
    assert!(value.is_finite());
    let derivative = Derivatives::with_respect_to(SymbolId(1)).of(&mut g, x);
    assert_eq!(derivative, Graph::ZERO);
    assert!(g.operations(&[deep]) == 200_000);
    assert!(!appell_codegen::symbolic::IdentityTest::new(1).is_zero(&g, deep));
    assert!(Intervals::new(&g, vec![]).of(&g, deep).contains(value));
}

#[test]
fn operations_count_shared_parts_once() {
    let mut g = Graph::new();
    let [a, b, c] = symbols(&mut g, ["a", "b", "c"]);
    assert_eq!(g.operations(&[a]), 0);
    let sum = g.add(a, b);
    assert_eq!(g.operations(&[sum]), 1);
    let product = g.mul(sum, c);
    let s = g.sin(sum);
    assert_eq!(g.operations(&[product, s, sum]), 3);
    let minus = g.sub(a, b);
    assert_eq!(g.operations(&[minus]), 1);
    let scaled = g.linear_combination(&[
        (2.into(), a),
        (Rational::new(-1, 3), b),
        (5.into(), Graph::ONE),
    ]);
    assert_eq!(g.operations(&[scaled]), 4);
    let power = g.pow(a, 5);
    assert_eq!(g.operations(&[power]), 3);
    let under = g.product(&[b, c]);
    let quotient = g.div(a, under);
    assert_eq!(g.operations(&[quotient]), 2);
    let reciprocal = g.pow(a, -2);
    assert_eq!(g.operations(&[reciprocal]), 2);
    let named = g.name("n", product);
    let squared = g.square(named);
    assert_eq!(g.operations(&[squared]), 3);
    assert_eq!(g.shorter(power, sum), sum);
    assert_eq!(g.shorter(sum, minus), sum);
}

#[test]
fn expansion_collects_like_terms_and_stops_at_its_limit() {
    let mut g = Graph::new();
    let [a, b, c] = symbols(&mut g, ["a", "b", "c"]);
    let (plus, minus) = (g.add(a, b), g.sub(a, b));
    let product = g.mul(plus, minus);
    let (a2, b2) = (g.square(a), g.square(b));
    assert_eq!(g.expand(product, 10), Some(g.sub(a2, b2)));
    let sum = g.sum(&[a, b, c]);
    let power = g.pow(sum, 6);
    assert_eq!(g.expand(power, 27), None);
    let expanded = g.expand(power, 28).unwrap();
    assert!(matches!(g.node(expanded), Node::Sum(terms) if terms.len() == 28));
    let huge = g.pow(sum, 1_000_000);
    assert_eq!(g.expand(huge, 100), None);
    // Inside functions, names and denominators nothing changes.
    let s = g.sin(product);
    let reciprocal = g.pow(power, -1);
    let named = g.name("n", product);
    for kept in [s, reciprocal, named] {
        assert_eq!(g.expand(kept, 10), Some(kept));
    }
}

#[test]
fn common_factors_come_out() {
    let mut g = Graph::new();
    let [a, b, c, x] = symbols(&mut g, ["a", "b", "c", "x"]);
    let (ab, ac) = (g.mul(a, b), g.mul(a, c));
    let sum = g.add(ab, ac);
    let rest = g.add(b, c);
    assert_eq!(g.take_out_common_factors(sum), g.mul(a, rest));
    let (once, twice) = (g.pow(x, -1), g.pow(x, -2));
    let (bx, cx) = (g.mul(b, once), g.mul(c, twice));
    let sum = g.add(bx, cx);
    let over = g.div(c, x);
    let rest = g.add(b, over);
    assert_eq!(g.take_out_common_factors(sum), g.div(rest, x));
}

#[test]
fn quotients_of_quotients_become_one_fraction() {
    let mut g = Graph::new();
    let mut test = IdentityTest::new(1);
    let [m, l, theta, k] = symbols(&mut g, ["m", "l", "theta", "k"]);
    let l2 = g.square(l);
    let ml2 = g.mul(m, l2);
    let inertia = g.add(ml2, k);
    // 1/k - m l²/(k (m l² + k)) = 1/(m l² + k)
    let (first, below) = (g.pow(k, -1), g.mul(k, inertia));
    let second = g.div(ml2, below);
    let sum = g.sub(first, second);
    let fraction = g.one_fraction(&mut test, sum, 100);
    assert_eq!(fraction, Some(g.pow(inertia, -1)));
    // (m² l⁴ - k²)/(m l² + k) = m l² - k
    let (a, b) = (g.square(ml2), g.square(k));
    let difference = g.sub(a, b);
    let quotient = g.div(difference, inertia);
    let fraction = g.one_fraction(&mut test, quotient, 100);
    assert_eq!(fraction, Some(g.sub(ml2, k)));
    // (1 - cos² θ)/sin θ = sin θ
    let (sin, cos) = (g.sin(theta), g.cos(theta));
    let cos2 = g.square(cos);
    let rest = g.linear_combination(&[(1.into(), Graph::ONE), (2.into(), cos2)]);
    let rest = g.linear_combination(&[(1.into(), rest), ((-3).into(), cos2)]);
    let quotient = g.div(rest, sin);
    let fraction = g.one_fraction(&mut test, quotient, 100);
    assert_eq!(fraction, Some(sin));
    let long = g.square(inertia);
    assert_eq!(g.one_fraction(&mut test, long, 2), None);
}

#[test]
fn positive_parts_make_positive_wholes() {
    let mut g = Graph::new();
    let [m, l, theta, any] = symbols(&mut g, ["m", "l", "theta", "any"]);
    let ranges = vec![
        (SymbolId(0), f64::MIN_POSITIVE, f64::INFINITY),
        (SymbolId(1), 0.0, f64::INFINITY),
        (SymbolId(2), -1.0, 1.0),
    ];
    let mut intervals = Intervals::new(&g, ranges);
    let (m2, l2) = (g.square(m), g.square(l));
    let any2 = g.square(any);
    let (cos, sin) = (g.cos(theta), g.sin(theta));
    let inertia = g.linear_combination(&[(1.into(), m), (3.into(), l2), (1.into(), any2)]);
    let reciprocal = g.pow(inertia, -1);
    let exponential = g.function(Function::Exp, any);
    let named = g.name("inertia", inertia);
    let scaled = g.product(&[m2, cos, named]);
    let below = g.neg(inertia);
    let tiny = g.pow(m, 9);
    for positive in [
        m,
        m2,
        inertia,
        reciprocal,
        exponential,
        cos,
        scaled,
        below,
        tiny,
    ] {
        assert!(intervals.cannot_vanish(&g, positive));
    }
    let two = g.integer(2);
    let (difference, shifted) = (g.sub(m, l), g.sub(two, sin));
    let solution = g.solve_numerically(vec![m], vec![l])[0];
    for open in [l, sin, any, any2, difference, solution] {
        assert!(!intervals.cannot_vanish(&g, open));
    }
    assert!(intervals.cannot_vanish(&g, shifted));
    let range = intervals.of(&g, cos);
    assert!(range.contains(1.0) && range.contains(1f64.cos()) && range.lo > 0.54);
}
