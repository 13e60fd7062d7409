//! Formatted expressions: text, `LaTeX` and `MathML`.

#![allow(clippy::unwrap_used, reason = "tests")]

use appell_codegen::symbolic::print::{self, Math, Setter, Spelled};
use appell_codegen::symbolic::{Derivatives, Expr, Function, Graph, Rational, Relation, SymbolId};

fn symbols<const N: usize>(g: &mut Graph, names: [&str; N]) -> [Expr; N] {
    names.map(|n| g.symbol(n))
}

fn formula(g: &Graph, e: Expr) -> Math {
    Setter::new(Spelled).set(g, e).math
}

fn text(g: &Graph, e: Expr) -> String {
    print::text(&formula(g, e))
}

fn latex(g: &Graph, e: Expr) -> String {
    print::latex(&formula(g, e))
}

#[test]
fn names_become_letters() {
    let mut g = Graph::new();
    let cases = [
        ("theta", "θ", "\\theta"),
        ("omega_1", "ω₁", "\\omega_{1}"),
        ("omega_1_dot", "ω̇₁", "\\dot{\\omega}_{1}"),
        ("phi_dot", "φ̇", "\\dot{\\varphi}"),
        ("x_ddot", "x\u{308}", "\\ddot{x}"),
        ("m_0", "m₀", "m_{0}"),
        ("m_W", "m_W", "m_{\\mathrm{W}}"),
        ("I_12", "I₁₂", "I_{12}"),
        ("I_1_2", "I₁,₂", "I_{1,2}"),
        ("k_rear", "k_rear", "k_{\\mathrm{rear}}"),
        ("wheel_radius", "wheel_radius", "\\mathrm{wheel\\_radius}"),
        (
            "d_lever_d_theta",
            "∂lever/∂θ",
            "\\frac{\\partial \\mathrm{lever}}{\\partial \\theta}",
        ),
    ];
    for (name, expected_text, expected_latex) in cases {
        let symbol = g.symbol(name);
        assert_eq!(text(&g, symbol), expected_text, "{name}");
        assert_eq!(latex(&g, symbol), expected_latex, "{name}");
    }
}

#[test]
fn products_read_from_parameters_to_functions() {
    let mut g = Graph::new();
    let [m, l, omega, theta] = symbols(&mut g, ["m_B", "l", "omega_1", "theta"]);
    let (sin, squared) = (g.sin(theta), g.square(omega));
    let e = g.product(&[sin, squared, l, m]);
    assert_eq!(text(&g, e), "m_B l ω₁² sin θ");
    assert_eq!(
        latex(&g, e),
        "m_{\\mathrm{B}}\\, l\\, {\\omega_{1}}^{2} \\sin \\theta"
    );
    let scaled = g.scale(&Rational::new(-3, 2), e);
    assert_eq!(text(&g, scaled), "−3/2 m_B l ω₁² sin θ");
}

#[test]
fn sums_start_with_what_is_added() {
    let mut g = Graph::new();
    let [a, b, c] = symbols(&mut g, ["a", "b", "c"]);
    let e = g.linear_combination(&[((-2).into(), a), (1.into(), c), (Rational::new(1, 2), b)]);
    assert_eq!(text(&g, e), "½ b − 2 a + c");
    let minus = g.linear_combination(&[((-1).into(), a), ((-1).into(), b)]);
    assert_eq!(text(&g, minus), "−a − b");
    let product = g.mul(c, minus);
    assert_eq!(text(&g, product), "−(a + b) c");
}

#[test]
fn negative_powers_are_quotients() {
    let mut g = Graph::new();
    let [a, b, c, theta] = symbols(&mut g, ["a", "b", "c", "theta"]);
    let sum = g.add(a, b);
    let quotient = g.div(sum, c);
    assert_eq!(text(&g, quotient), "(a + b)/c");
    assert_eq!(latex(&g, quotient), "\\frac{a + b}{c}");
    let under = g.mul(b, c);
    let quotient = g.div(a, under);
    assert_eq!(text(&g, quotient), "a/(b c)");
    assert_eq!(latex(&g, quotient), "\\frac{a}{b\\, c}");
    let (square, tan) = (g.pow(sum, -2), g.tan(theta));
    assert_eq!(text(&g, square), "1/(a + b)²");
    assert_eq!(latex(&g, square), "\\frac{1}{(a + b)^{2}}");
    assert_eq!(text(&g, tan), "tan θ");
    assert_eq!(latex(&g, tan), "\\tan \\theta");
    let scaled = g.scale(&Rational::new(2, 3), square);
    assert_eq!(text(&g, scaled), "2/(3 (a + b)²)");
    let power = g.pow(quotient, 2);
    assert_eq!(text(&g, power), "a²/(b² c²)");
    let cos = g.cos(theta);
    let over = g.div(cos, a);
    assert_eq!(text(&g, over), "(cos θ)/a");
}

#[test]
fn numbers_are_whole_or_fractions() {
    let mut g = Graph::new();
    for (n, d, written) in [(-3, 4, "−¾"), (1, 3, "⅓"), (7, 5, "7/5"), (0, 1, "0")] {
        let number = g.fraction(n, d);
        assert_eq!(text(&g, number), written);
    }
}

#[test]
fn functions_are_upright_and_take_brackets_where_needed() {
    let mut g = Graph::new();
    let [x, y] = symbols(&mut g, ["x", "theta"]);
    let double = g.scale(&2.into(), y);
    let (sin, cos) = (g.sin(double), g.cos(y));
    let (sin2, cos4) = (g.square(sin), g.pow(cos, 4));
    assert_eq!(text(&g, sin2), "sin²(2 θ)");
    assert_eq!(latex(&g, sin2), "\\sin^{2}(2\\, \\theta)");
    assert_eq!(text(&g, cos4), "cos⁴ θ");
    let sum = g.add(x, y);
    let root = g.sqrt(sum);
    let reciprocal = g.pow(root, -1);
    assert_eq!(text(&g, root), "√(x + θ)");
    assert_eq!(latex(&g, reciprocal), "\\frac{1}{\\sqrt{x + \\theta}}");
    let abs = g.function(Function::Abs, sum);
    let square = g.square(abs);
    assert_eq!(text(&g, square), "|x + θ|²");
    let angle = g.atan2(y, sum);
    assert_eq!(text(&g, angle), "atan2(θ, x + θ)");
    assert_eq!(
        latex(&g, angle),
        "\\operatorname{atan2}(\\theta,\\, x + \\theta)"
    );
    let power = g.power(sum, double);
    assert_eq!(text(&g, power), "(x + θ)^(2 θ)");
    assert_eq!(latex(&g, power), "(x + \\theta)^{2\\, \\theta}");
    let choice = g.choice(Relation::Less, [x, Graph::ZERO], [sum, y]);
    assert_eq!(text(&g, choice), "(x + θ if x < 0, else θ)");
    assert_eq!(
        latex(&g, choice),
        "\\begin{cases} x + \\theta & x< 0 \\\\ \\theta & \\text{otherwise} \\end{cases}"
    );
}

#[test]
fn named_quantities_stay_names_unless_written_inline() {
    let mut g = Graph::new();
    let [m, l, x] = symbols(&mut g, ["m", "l", "theta"]);
    let (sin, cos) = (g.sin(x), g.cos(x));
    let inner = g.product(&[l, sin]);
    let sum = g.add(inner, l);
    let lever = g.name("lever", sum);
    let product = g.product(&[m, lever, cos]);
    let torque = g.name("torque_1", product);
    let squared = g.square(torque);
    let set = Setter::new(Spelled).set(&g, squared);
    assert_eq!(print::text(&set.math), "torque₁²");
    assert_eq!(set.wants, [torque]);
    let inline = Setter::new(Spelled)
        .with_definitions_inline()
        .set(&g, squared);
    assert_eq!(print::text(&inline.math), "(m (l + l sin θ) cos θ)²");
    assert!(inline.wants.is_empty());
    let derivative = Derivatives::with_respect_to(SymbolId(1)).of(&mut g, lever);
    assert_eq!(text(&g, derivative), "∂lever/∂l");
}

#[test]
fn mathml_is_well_formed() {
    let mut g = Graph::new();
    let [x, theta, odd] = symbols(&mut g, ["x_1", "theta_dot", "<b>&\"x\""]);
    let (sin, sum) = (g.sin(theta), g.add(x, odd));
    let (root, square) = (g.sqrt(sum), g.square(sin));
    let choice = g.choice(Relation::LessOrEqual, [x, theta], [root, square]);
    let power = g.power(sum, theta);
    let abs = g.function(Function::Abs, theta);
    let angle = g.atan2(x, theta);
    let named = g.name("d_a_d_b", sum);
    let reciprocal = g.pow(sum, -3);
    let all = g.product(&[choice, power, abs, angle, named, reciprocal, square]);
    let half = g.scale(&Rational::new(-1, 2), all);
    let whole = g.sum(&[half, x, Graph::ONE]);
    let markup = print::mathml(&formula(&g, whole));
    assert!(well_formed(&markup), "{markup}");
    assert_eq!(
        print::mathml(&formula(&g, square)),
        "<mrow><msup><mi>sin</mi><mn>2</mn></msup><mo>\u{2061}</mo><mspace width=\"0.16em\"/>\
         <mover accent=\"true\"><mi>θ</mi><mo class=\"dot\" stretchy=\"false\">˙</mo></mover></mrow>"
    );
}

/// Tags are nested, and nothing else looks like one.
fn well_formed(markup: &str) -> bool {
    let mut open = Vec::new();
    let mut rest = markup;
    while let Some(start) = rest.find('<') {
        let Some(end) = rest[start..].find('>') else {
            return false;
        };
        let tag = &rest[start + 1..start + end];
        if let Some(name) = tag.strip_prefix('/') {
            if open.pop() != Some(name.to_owned()) {
                return false;
            }
        } else if !tag.ends_with('/') {
            open.push(tag.split(' ').next().unwrap().to_owned());
        }
        rest = &rest[start + end + 1..];
    }
    open.is_empty() && !rest.contains('>')
}

#[test]
fn hostile_names_stay_names() {
    let mut g = Graph::new();
    let hostile = g.symbol("a}\\input{x}$%\n\u{202e}");
    let (t, l) = (text(&g, hostile), latex(&g, hostile));
    assert!(!t.contains('\n') && !t.contains('\u{202e}'));
    assert!(!l.contains("\\input") && !l.contains('\n'), "{l}");
    let markup = g.symbol("<script>");
    assert!(!print::mathml(&formula(&g, markup)).contains("<script"));
    for name in ["", "_", "__dot", "dot_dot_dot", "d__d_", "d_d_d_d_d"] {
        let symbol = g.symbol(name);
        text(&g, symbol);
        latex(&g, symbol);
    }
}

#[test]
fn shared_and_deep_parts_get_letters() {
    let mut g = Graph::new();
    let mut e = g.symbol("x");
    for _ in 0..100 {
        let (s, square) = (g.sin(e), g.square(e));
        let product = g.mul(s, square);
        e = g.add(product, e);
    }
    let mut deep = g.symbol("y");
    for _ in 0..5_000 {
        deep = g.sin(deep);
    }
    for root in [e, deep] {
        let set = Setter::new(Spelled).set(&g, root);
        assert!(print::text(&set.math).len() < 1 << 12);
        assert!(!set.wants.is_empty());
    }
}

#[test]
fn unknowns_of_systems_have_two_indices() {
    let mut g = Graph::new();
    let [a, b, u] = symbols(&mut g, ["a", "b", "u"]);
    let sum = g.add(a, b);
    let unknowns = g.solve_numerically(vec![sum, b, Graph::ZERO, Graph::ONE], vec![u, a]);
    let scaled = g.mul(u, unknowns[1]);
    assert_eq!(text(&g, scaled), "u s₁,₂");
}
