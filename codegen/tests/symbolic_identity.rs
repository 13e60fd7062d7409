//! Equality by evaluation: valid identities are proven, near misses rejected.

#![allow(clippy::unwrap_used, reason = "tests")]

use appell_codegen::symbolic::vector::{self, Mat3};
use appell_codegen::symbolic::{Expr, Function, Graph, IdentityTest, Rational, Relation};

struct Bench {
    g: Graph,
    test: IdentityTest,
}

impl Bench {
    fn new() -> Self {
        Self {
            g: Graph::new(),
            test: IdentityTest::new(7),
        }
    }

    fn symbols<const N: usize>(&mut self, names: [&str; N]) -> [Expr; N] {
        names.map(|n| self.g.symbol(n))
    }

    /// Equal by every question, with a negligible chance of being wrong.
    fn equal(&mut self, a: Expr, b: Expr) {
        let difference = self.g.sub(a, b);
        assert!(self.test.are_equal(&self.g, a, b));
        assert!(self.test.is_zero(&self.g, difference));
        assert!(self.test.error_bound(&self.g, difference) < 1e-12);
    }

    fn different(&mut self, a: Expr, b: Expr) {
        let difference = self.g.sub(a, b);
        assert!(!self.test.are_equal(&self.g, a, b));
        assert!(!self.test.is_zero(&self.g, difference));
    }
}

#[test]
fn rational_functions_are_compared_exactly() {
    let mut b = Bench::new();
    let [x, y] = b.symbols(["x", "y"]);
    let g = &mut b.g;
    let (sum, difference) = (g.add(x, y), g.sub(x, y));
    let product = g.mul(sum, difference);
    let (x2, y2) = (g.square(x), g.square(y));
    let squares = g.sub(x2, y2);
    let quotient = g.div(squares, sum);
    let near = g.fraction(1_000_000_007, 1_000_000_006);
    let nearly = g.mul(near, squares);
    b.equal(product, squares);
    b.equal(quotient, difference);
    b.different(nearly, squares);
}

#[test]
fn addition_theorems_hold() {
    let mut b = Bench::new();
    let [x, y] = b.symbols(["x", "y"]);
    let g = &mut b.g;
    let angle = g.add(x, y);
    let (sx, cx, sy, cy) = (g.sin(x), g.cos(x), g.sin(y), g.cos(y));
    let left = g.sin(angle);
    let (one, two) = (g.mul(sx, cy), g.mul(cx, sy));
    let right = g.add(one, two);
    let wrong = g.sub(one, two);
    b.equal(left, right);
    b.different(left, wrong);

    // The same behind a name, and with the sign turned round.
    let g = &mut b.g;
    let named = g.name("alpha", angle);
    let sine = g.sin(named);
    let minus = g.neg(named);
    let negative = g.sin(minus);
    let negated = g.neg(right);
    b.equal(sine, right);
    b.equal(negative, negated);

    // A constant part is an angle too.
    let g = &mut b.g;
    let tenth = g.fraction(1, 10);
    let shifted = g.add(x, tenth);
    let (s, c) = (g.sin(tenth), g.cos(tenth));
    let left = g.cos(shifted);
    let (one, two) = (g.mul(cx, c), g.mul(sx, s));
    let right = g.sub(one, two);
    b.equal(left, right);
}

#[test]
fn multiples_and_parts_of_angles_are_related() {
    let mut b = Bench::new();
    let [x] = b.symbols(["x"]);
    let g = &mut b.g;
    let double = g.scale(&2.into(), x);
    let (s, c) = (g.sin(x), g.cos(x));
    let product = g.product(&[s, c]);
    let right = g.scale(&2.into(), product);
    let left = g.sin(double);
    b.equal(left, right);

    // tan(x/2) = sin x / (1 + cos x)
    let g = &mut b.g;
    let half = g.scale(&Rational::new(1, 2), x);
    let left = g.tan(half);
    let below = g.add(Graph::ONE, c);
    let right = g.div(s, below);
    b.equal(left, right);

    // sin x = 3 sin(x/3) - 4 sin³(x/3)
    let g = &mut b.g;
    let third = g.scale(&Rational::new(1, 3), x);
    let s3 = g.sin(third);
    let cube = g.pow(s3, 3);
    let right = g.linear_combination(&[(3.into(), s3), ((-4).into(), cube)]);
    b.equal(s, right);

    // cos(7x/12) against the sum of x/3 and x/4
    let g = &mut b.g;
    let quarter = g.scale(&Rational::new(1, 4), x);
    let (s4, c4, c3) = (g.sin(quarter), g.cos(quarter), g.cos(third));
    let (one, two) = (g.mul(c3, c4), g.mul(s3, s4));
    let right = g.sub(one, two);
    let wrong = g.add(one, two);
    let angle = g.scale(&Rational::new(7, 12), x);
    let left = g.cos(angle);
    b.equal(left, right);
    b.different(left, wrong);

    // Beyond any realistic multiple the relation is not modelled, but no false claim is made.
    let g = &mut b.g;
    let far = g.scale(&(1 << 40).into(), x);
    let once_more = g.add(far, x);
    let (left, near) = (g.sin(once_more), g.sin(far));
    b.different(left, near);
    b.different(near, Graph::ZERO);
}

fn turn(g: &mut Graph, axis: usize, angle: Expr) -> Mat3 {
    let (s, c) = (g.sin(angle), g.cos(angle));
    let minus = g.neg(s);
    let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut turn = vector::IDENTITY;
    turn[j][j] = c;
    turn[k][k] = c;
    turn[j][k] = minus;
    turn[k][j] = s;
    turn
}

#[test]
fn rotations_are_orthogonal() {
    let mut b = Bench::new();
    let [yaw, pitch, roll] = b.symbols(["yaw", "pitch", "roll"]);
    let g = &mut b.g;
    let (z, y, x) = (turn(g, 2, yaw), turn(g, 1, pitch), turn(g, 0, roll));
    let first = g.mat_mat(&z, &y);
    let rotation = g.mat_mat(&first, &x);
    let product = g.mat_mat(&vector::transpose(&rotation), &rotation);
    let minors = g.cross(rotation[0], rotation[1]);
    for i in 0..3 {
        for j in 0..3 {
            b.equal(product[i][j], vector::IDENTITY[i][j]);
        }
        b.equal(minors[i], rotation[2][i]);
        let wrong = b.g.neg(rotation[2][i]);
        b.different(minors[i], wrong);
    }
}

#[test]
fn exponentials_multiply() {
    let mut b = Bench::new();
    let [x, y] = b.symbols(["x", "y"]);
    let g = &mut b.g;
    let sum = g.add(x, y);
    let [ex, ey, both] = [x, y, sum].map(|e| g.function(Function::Exp, e));
    let product = g.mul(ex, ey);
    b.equal(product, both);

    let g = &mut b.g;
    let [s, c, t] = [Function::Sinh, Function::Cosh, Function::Tanh].map(|f| g.function(f, x));
    let (s2, c2) = (g.square(s), g.square(c));
    let one = g.sub(c2, s2);
    let quotient = g.div(s, c);
    let half = g.scale(&Rational::new(1, 2), x);
    let root = g.function(Function::Exp, half);
    let squared = g.square(root);
    b.equal(one, Graph::ONE);
    b.equal(quotient, t);
    b.equal(squared, ex);
    b.different(ex, ey);
    b.different(s, c);
}

#[test]
fn powers_share_their_base() {
    let mut b = Bench::new();
    let [x, n] = b.symbols(["x", "n"]);
    let g = &mut b.g;
    let [three_halves, third, four_thirds] =
        [(3, 2), (1, 3), (4, 3)].map(|(p, q)| g.fraction(p, q));
    let power = g.power(x, three_halves);
    let root = g.sqrt(x);
    let cube = g.pow(root, 3);
    b.equal(power, cube);
    let g = &mut b.g;
    let (small, large) = (g.power(x, third), g.power(x, four_thirds));
    let product = g.mul(small, x);
    b.equal(product, large);
    let g = &mut b.g;
    let next = g.add(n, Graph::ONE);
    let (now, then) = (g.power(x, n), g.power(x, next));
    let product = g.mul(now, x);
    b.equal(product, then);
    b.different(now, then);
}

#[test]
fn square_roots_square_and_keep_their_sign() {
    let mut b = Bench::new();
    let [x, y, a] = b.symbols(["x", "y", "a"]);
    let g = &mut b.g;
    let radicand = g.add(x, y);
    let root = g.sqrt(radicand);
    let plus = g.add(root, Graph::ONE);
    let minus = g.sub(root, Graph::ONE);
    let product = g.mul(plus, minus);
    let right = g.sub(radicand, Graph::ONE);
    b.different(plus, minus);
    assert!(b.test.are_equal(&b.g, product, right));

    // 1/√v = √v/v, both with the root.
    let g = &mut b.g;
    let reciprocal = g.pow(root, -1);
    let over = g.div(root, radicand);
    b.equal(reciprocal, over);

    // √(a²) is |a|; the test must not take it for a, and cannot prove that they differ.
    let g = &mut b.g;
    let square = g.square(a);
    let length = g.sqrt(square);
    let twice = g.scale(&2.into(), length);
    b.different(length, a);
    b.different(length, twice);
    let seeds = (0..50).filter(|&seed| {
        let mut test = IdentityTest::new(seed);
        test.are_equal(&b.g, length, a)
    });
    assert_eq!(seeds.count(), 0);

    // The same behind several independent roots.
    let g = &mut b.g;
    let roots: Vec<Expr> = [x, y, a].iter().map(|&e| g.sqrt(e)).collect();
    let sum = g.sum(&roots);
    let squared = g.square(sum);
    let expanded = g.expand(squared, 20).unwrap();
    b.equal(squared, expanded);
    b.different(squared, radicand);
}

#[test]
fn choices_are_linear_and_can_be_turned_round() {
    let mut b = Bench::new();
    let [x, y, u, v] = b.symbols(["x", "y", "u", "v"]);
    let g = &mut b.g;
    let less = g.choice(Relation::Less, [x, y], [u, v]);
    let turned = g.choice(Relation::LessOrEqual, [y, x], [v, u]);
    let swapped = g.choice(Relation::Less, [x, y], [v, u]);
    let sum = g.add(less, swapped);
    let both = g.add(u, v);
    b.equal(less, turned);
    b.equal(sum, both);
    b.different(less, swapped);
    b.different(less, u);
}

#[test]
fn other_functions_depend_on_values_only() {
    let mut b = Bench::new();
    let [x, y] = b.symbols(["x", "y"]);
    for function in [
        Function::Asin,
        Function::Acos,
        Function::Atan,
        Function::Ln,
        Function::Abs,
        Function::Sign,
    ] {
        let g = &mut b.g;
        let (sum, difference) = (g.add(x, y), g.sub(x, y));
        let product = g.mul(sum, difference);
        let (x2, y2) = (g.square(x), g.square(y));
        let squares = g.sub(x2, y2);
        let (left, right) = (g.function(function, product), g.function(function, squares));
        let other = g.function(function, sum);
        let (d, e) = (g.atan2(product, x), g.atan2(squares, x));
        let f = g.atan2(x, squares);
        b.equal(left, right);
        b.equal(d, e);
        b.different(left, other);
        b.different(d, f);
    }
}

#[test]
fn unknowns_solve_their_system() {
    let mut b = Bench::new();
    let [p, q, r, s, u, v] = b.symbols(["p", "q", "r", "s", "u", "v"]);
    let g = &mut b.g;
    let unknowns = g.solve_numerically(vec![p, q, r, s], vec![u, v]);
    let (first, second) = (g.mul(p, unknowns[0]), g.mul(q, unknowns[1]));
    let left = g.add(first, second);
    let (ps, qr) = (g.mul(p, s), g.mul(q, r));
    let determinant = g.sub(ps, qr);
    let (su, qv) = (g.mul(s, u), g.mul(q, v));
    let numerator = g.sub(su, qv);
    let cramer = g.div(numerator, determinant);
    b.equal(left, u);
    b.equal(unknowns[0], cramer);
    b.different(unknowns[1], cramer);

    // A singular system has no unknowns to compare.
    let none = b.g.solve_numerically(vec![p, p, q, q], vec![u, v])[0];
    assert!(!b.test.is_zero(&b.g, none));
    assert!(!b.test.are_equal(&b.g, none, unknowns[0]));
}

#[test]
fn what_is_undefined_everywhere_is_not_zero() {
    let mut b = Bench::new();
    let [x, y] = b.symbols(["x", "y"]);
    let g = &mut b.g;
    let (sum, difference) = (g.add(x, y), g.sub(x, y));
    let product = g.mul(sum, difference);
    let (x2, y2) = (g.square(x), g.square(y));
    let zero = g.linear_combination(&[(1.into(), product), ((-1).into(), x2), (1.into(), y2)]);
    let bad = g.div(x, zero);
    assert!(b.test.is_zero(&b.g, zero));
    assert!(!b.test.is_zero(&b.g, bad));
    let symbol = b.g.as_symbol(y).unwrap();
    assert!(!b.test.independent_of(&b.g, bad, symbol));
}

#[test]
fn a_symbol_that_does_not_matter_is_recognised() {
    let mut b = Bench::new();
    let [x, y, r] = b.symbols(["x", "y", "r"]);
    let id = |g: &Graph, e: Expr| g.as_symbol(e).unwrap();
    let g = &mut b.g;
    // A rotation and its inverse.
    let (s, c) = (g.sin(x), g.cos(x));
    let (cr, sr) = (g.mul(c, r), g.mul(s, r));
    let named = g.name("east", sr);
    let (c_cr, s_sr) = (g.mul(c, cr), g.mul(s, named));
    let length = g.add(c_cr, s_sr);
    let angle = g.add(x, y);
    let sine = g.sin(angle);
    let (sx, cy) = (g.sin(x), g.cos(y));
    let part = g.mul(sx, cy);
    let rest = g.sub(sine, part);
    let (cx, sy) = (g.cos(x), g.sin(y));
    let whole = g.mul(cx, sy);
    b.equal(length, r);
    b.equal(rest, whole);
    let g = &b.g;
    assert!(b.test.independent_of(g, length, id(g, x)));
    assert!(b.test.independent_of(g, length, id(g, y)));
    assert!(!b.test.independent_of(g, length, id(g, r)));
    assert!(!b.test.independent_of(g, rest, id(g, x)));

    // Behind a square root.
    let g = &mut b.g;
    let squared = g.square(length);
    let more = g.add(squared, y);
    let root = g.sqrt(more);
    let g = &b.g;
    assert!(b.test.independent_of(g, root, id(g, x)));
    assert!(!b.test.independent_of(g, root, id(g, y)));
}

#[test]
fn many_symbols_may_share_a_bit() {
    let mut b = Bench::new();
    let symbols: Vec<Expr> = (0..200).map(|i| b.g.symbol(&format!("s{i}"))).collect();
    let sum = b.g.sum(&symbols[64..]);
    for (i, &s) in symbols.iter().enumerate() {
        let id = b.g.as_symbol(s).unwrap();
        assert_eq!(b.test.independent_of(&b.g, sum, id), i < 64);
    }
}

#[test]
fn answers_depend_on_seed_and_graph_only() {
    let build = || {
        let mut b = Bench::new();
        let [x, y] = b.symbols(["x", "y"]);
        let sum = b.g.add(x, y);
        let sine = b.g.sin(sum);
        let root = b.g.sqrt(sine);
        (b, root, x)
    };
    let (mut first, root, _) = build();
    let (mut second, same, x) = build();
    // Other questions in between change nothing.
    second.test.is_zero(&second.g, x);
    let answers = |b: &mut Bench, e: Expr, x: Expr| {
        let symbol = b.g.as_symbol(x).unwrap();
        let test = &mut b.test;
        [test.is_zero(&b.g, e), test.independent_of(&b.g, e, symbol)]
    };
    assert_eq!(answers(&mut first, root, x), answers(&mut second, same, x));
}

#[test]
fn roots_of_numbers_are_constants() {
    let mut b = Bench::new();
    let [x] = b.symbols(["x"]);
    let g = &mut b.g;
    let (two, three, six) = (g.integer(2), g.integer(3), g.integer(6));
    let [r2, r3, r6] = [two, three, six].map(|n| g.sqrt(n));
    let product = g.mul(r2, r3);
    b.equal(product, r6);
    b.different(r2, r3);
    // (x + √3)(x - √3) = x² - 3
    let g = &mut b.g;
    let (plus, minus) = (g.add(x, r3), g.sub(x, r3));
    let product = g.mul(plus, minus);
    let square = g.square(x);
    let right = g.sub(square, three);
    b.equal(product, right);
    b.different(plus, minus);
    // 47 has no root in the field: less is known, nothing wrong is claimed.
    let g = &mut b.g;
    let prime = g.integer(47);
    let root = g.sqrt(prime);
    let (left, right) = (g.mul(root, plus), g.mul(root, minus));
    b.different(left, right);
    let minus_three = b.g.integer(-3);
    let imaginary = b.g.sqrt(minus_three);
    let twice = b.g.add(imaginary, imaginary);
    assert!(!b.test.are_equal(&b.g, imaginary, twice));
}

#[test]
fn multiples_of_pi_are_constants() {
    let mut b = Bench::new();
    let [pi, x] = b.symbols(["pi", "x"]);
    let id = b.g.as_symbol(pi).unwrap();
    b.test = IdentityTest::new(11).with_pi(id);
    let g = &mut b.g;
    let part = |g: &mut Graph, n: i64, d: i64| g.scale(&Rational::new(n, d), pi);
    let (third, quarter, sixth) = (part(g, 1, 3), part(g, 1, 4), part(g, 1, 6));
    let [half, minus_one] = [(1, 2), (-1, 1)].map(|(n, d)| g.fraction(n, d));
    let (three, two) = (g.integer(3), g.integer(2));
    let (r3, r2) = (g.sqrt(three), g.sqrt(two));
    let (half_r3, half_r2) = (
        g.scale(&Rational::new(1, 2), r3),
        g.scale(&Rational::new(1, 2), r2),
    );
    let [cos_pi, cos3, sin3, cos4, sin4, sin6] = [
        g.cos(pi),
        g.cos(third),
        g.sin(third),
        g.cos(quarter),
        g.sin(quarter),
        g.sin(sixth),
    ];
    b.equal(cos_pi, minus_one);
    b.equal(cos3, half);
    b.equal(sin3, half_r3);
    b.equal(cos4, half_r2);
    b.equal(sin4, half_r2);
    b.equal(sin6, half);

    // Three directions, a third of a turn apart.
    let g = &mut b.g;
    let directions: Vec<Expr> = (0..3)
        .map(|k| {
            let offset = g.scale(&Rational::new(2 * k, 3), pi);
            let angle = g.add(x, offset);
            g.cos(angle)
        })
        .collect();
    let sum = g.sum(&directions);
    b.equal(sum, Graph::ZERO);
    b.different(directions[0], directions[1]);

    // π itself is a number like any other, and its fifth is not confused with it.
    let g = &mut b.g;
    let fifth = part(g, 1, 5);
    let cos5 = g.cos(fifth);
    b.different(cos5, minus_one);
    b.different(pi, three);
}
