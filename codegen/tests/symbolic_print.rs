//! What people read: text, `LaTeX` and `MathML`.

#![allow(clippy::unwrap_used, reason = "tests")]

use appell_codegen::symbolic::print::{Latex, MathMl, Printer, Text};
use appell_codegen::symbolic::{Derivatives, Expr, Function, Graph, Rational, Relation, SymbolId};

fn symbols<const N: usize>(g: &mut Graph, names: [&str; N]) -> [Expr; N] {
    names.map(|n| g.symbol(n))
}

fn text(g: &Graph, e: Expr) -> String {
    Printer::new(g, Text).expression(e)
}

fn latex(g: &Graph, e: Expr) -> String {
    Printer::new(g, Latex).expression(e)
}

#[test]
fn names_become_letters() {
    let mut g = Graph::new();
    let cases = [
        ("theta", "θ", "\\theta"),
        ("omega_1", "ω₁", "\\omega_1"),
        ("omega_1_dot", "ω̇₁", "\\dot\\omega_1"),
        ("phi_dot", "φ̇", "\\dot\\phi"),
        ("x_ddot", "ẍ", "\\ddot{x}"),
        ("m_0", "m₀", "m_0"),
        ("m_W", "m_W", "m_W"),
        ("I_12", "I₁₂", "I_{12}"),
        ("I_1_2", "I₁,₂", "I_{1,2}"),
        ("k_r", "kᵣ", "k_r"),
        ("k_rear", "k_rear", "k_{\\mathrm{rear}}"),
        ("wheel_radius", "wheel_radius", "\\mathit{wheel\\_radius}"),
        ("mu", "μ", "\\mu"),
        (
            "d_lever_d_theta",
            "∂lever/∂θ",
            "\\frac{\\partial\\mathit{lever}}{\\partial\\theta}",
        ),
    ];
    for (name, expected_text, expected_latex) in cases {
        let symbol = g.symbol(name);
        // Combining marks follow their letter.
        let composed = expected_text.replace('ẍ', "x\u{308}");
        assert_eq!(text(&g, symbol), composed, "{name}");
        assert_eq!(latex(&g, symbol), expected_latex, "{name}");
    }
}

#[test]
fn products_read_from_parameters_to_functions() {
    let mut g = Graph::new();
    let [m, l, omega, theta] = symbols(&mut g, ["m_B", "l", "omega_1", "theta"]);
    let (sin, squared) = (g.sin(theta), g.square(omega));
    let e = g.product(&[sin, squared, l, m]);
    assert_eq!(text(&g, e), "m_B·l·ω₁²·sin θ");
    assert_eq!(latex(&g, e), "m_B\\,l\\,\\omega_1^2\\,\\sin\\theta");
    let half = g.scale(&Rational::new(-3, 2), e);
    assert_eq!(text(&g, half), "−(3·m_B·l·ω₁²·sin θ)/2");
    assert_eq!(
        latex(&g, half),
        "-\\frac{3\\,m_B\\,l\\,\\omega_1^2\\,\\sin\\theta}{2}"
    );
    let ordered = Printer::new(&g, Text)
        .with_order(&[SymbolId(2), SymbolId(1)])
        .expression(e);
    assert_eq!(ordered, "ω₁²·l·m_B·sin θ");
    let renamed = Printer::new(&g, Text)
        .with_name(SymbolId(2), "phi_dot")
        .expression(squared);
    assert_eq!(renamed, "φ̇²");
}

#[test]
fn sums_start_with_what_is_added() {
    let mut g = Graph::new();
    let [a, b, c] = symbols(&mut g, ["a", "b", "c"]);
    let e = g.linear_combination(&[((-2).into(), a), (1.into(), c), (Rational::new(1, 2), b)]);
    assert_eq!(text(&g, e), "b/2 + c − 2·a");
    let minus = g.linear_combination(&[((-1).into(), a), ((-1).into(), b)]);
    assert_eq!(text(&g, minus), "−a − b");
    let product = g.mul(c, minus);
    assert_eq!(text(&g, product), "−c·(a + b)");
    let (cos, square) = (g.cos(a), g.square(b));
    let constant = g.linear_combination(&[
        (1.into(), Graph::ONE),
        ((-1).into(), cos),
        (1.into(), square),
    ]);
    assert_eq!(text(&g, constant), "1 + b² − cos a");
}

#[test]
fn negative_powers_are_fractions() {
    let mut g = Graph::new();
    let [a, b, c, theta] = symbols(&mut g, ["a", "b", "c", "theta"]);
    let sum = g.add(a, b);
    let quotient = g.div(sum, c);
    assert_eq!(text(&g, quotient), "(a + b)/c");
    assert_eq!(latex(&g, quotient), "\\frac{a + b}{c}");
    let under = g.mul(b, c);
    let quotient = g.div(a, under);
    assert_eq!(text(&g, quotient), "a/(b·c)");
    assert_eq!(latex(&g, quotient), "\\frac{a}{b\\,c}");
    let (square, tan) = (g.pow(sum, -2), g.tan(theta));
    assert_eq!(text(&g, square), "1/(a + b)²");
    assert_eq!(latex(&g, square), "\\frac{1}{\\left(a + b\\right)^2}");
    assert_eq!(text(&g, tan), "(sin θ)/(cos θ)");
    assert_eq!(latex(&g, tan), "\\frac{\\sin\\theta}{\\cos\\theta}");
    let scaled = g.scale(&Rational::new(2, 3), square);
    assert_eq!(text(&g, scaled), "2/(3·(a + b)²)");
    let number = g.fraction(-981, 100);
    assert_eq!(text(&g, number), "−9.81");
    let small = g.fraction(1, 1000);
    assert_eq!(text(&g, small), "0.001");
    let third = g.fraction(1, 3);
    assert_eq!(text(&g, third), "1/3");
    assert_eq!(text(&g, Graph::ZERO), "0");
    let power = g.pow(quotient, 2);
    assert_eq!(text(&g, power), "a²/(b²·c²)");
}

#[test]
fn functions_are_upright_and_take_parentheses_where_needed() {
    let mut g = Graph::new();
    let [x, y] = symbols(&mut g, ["x", "theta"]);
    let double = g.scale(&2.into(), y);
    let (sin, cos) = (g.sin(double), g.cos(y));
    let (sin2, cos4) = (g.square(sin), g.pow(cos, 4));
    assert_eq!(text(&g, sin2), "sin²(2·θ)");
    assert_eq!(latex(&g, sin2), "\\sin^2\\left(2\\,\\theta\\right)");
    assert_eq!(text(&g, cos4), "cos⁴ θ");
    let sum = g.add(x, y);
    let root = g.sqrt(sum);
    let cube = g.pow(root, -1);
    assert_eq!(text(&g, root), "√(x + θ)");
    assert_eq!(latex(&g, cube), "\\frac{1}{\\sqrt{x + \\theta}}");
    let abs = g.function(Function::Abs, sum);
    let square = g.square(abs);
    assert_eq!(text(&g, square), "|x + θ|²");
    let angle = g.atan2(y, sum);
    assert_eq!(text(&g, angle), "atan2(θ, x + θ)");
    assert_eq!(
        latex(&g, angle),
        "\\operatorname{atan2}\\left(\\theta, x + \\theta\\right)"
    );
    let power = g.power(sum, double);
    assert_eq!(text(&g, power), "(x + θ)^(2·θ)");
    assert_eq!(latex(&g, power), "\\left(x + \\theta\\right)^{2\\,\\theta}");
    let choice = g.choice(Relation::Less, [x, Graph::ZERO], [sum, y]);
    let scaled = g.mul(x, choice);
    assert_eq!(text(&g, scaled), "x·(x + θ if x < 0 else θ)");
    assert_eq!(
        latex(&g, choice),
        "\\begin{cases} x + \\theta & x < 0 \\\\ \\theta & \\text{otherwise} \\end{cases}"
    );
}

#[test]
fn control_words_do_not_swallow_letters() {
    let mut g = Graph::new();
    let [x, y] = symbols(&mut g, ["x", "omega"]);
    let (sin, cos) = (g.sin(x), g.cos(y));
    assert_eq!(latex(&g, sin), "\\sin x");
    assert_eq!(latex(&g, cos), "\\cos\\omega");
}

#[test]
fn named_quantities_have_definitions() {
    let mut g = Graph::new();
    let [m, l, x] = symbols(&mut g, ["m", "l", "theta"]);
    let (sin, cos) = (g.sin(x), g.cos(x));
    let inner = g.product(&[l, sin]);
    let sum = g.add(inner, l);
    let lever = g.name("lever", sum);
    let product = g.product(&[m, lever, cos]);
    let outer = g.name("torque_1", product);
    let squared = g.square(outer);
    let printer = Printer::new(&g, Text);
    assert_eq!(printer.expression(squared), "torque_1²");
    assert_eq!(
        printer.definitions(&[squared], 80),
        "lever = l + l·sin θ\ntorque_1 = m·lever·cos θ"
    );
    let inline = Printer::new(&g, Text).with_definitions_inline();
    assert_eq!(inline.expression(squared), "(m·(l + l·sin θ)·cos θ)²");
    let derivative = Derivatives::with_respect_to(SymbolId(1)).of(&mut g, lever);
    assert_eq!(text(&g, derivative), "∂lever/∂l");
}

#[test]
fn long_sums_break_before_signs() {
    let mut g = Graph::new();
    let names: Vec<String> = (1..=8).map(|i| format!("term_{i}")).collect();
    let terms: Vec<Expr> = names.iter().map(|n| g.symbol(n)).collect();
    let sum = g.sum(&terms);
    let printer = Printer::new(&g, Text);
    assert_eq!(
        printer.equation("M_11", sum, 36),
        "M₁₁ = term_1 + term_2 + term_3\n    + term_4 + term_5 + term_6\n    + term_7 + term_8"
    );
    for line in printer.equation("M_11", sum, 36).lines() {
        assert!(line.chars().count() <= 36);
    }
    // Inside parentheses only where nothing else is left.
    let factor = g.mul(terms[0], sum);
    let broken = Printer::new(&g, Text).equation("x", factor, 40);
    assert_eq!(
        broken,
        "x = term_1·(term_1 + term_2 + term_3\n    + term_4 + term_5 + term_6 + term_7\n    + term_8)"
    );
    let source = Printer::new(&g, Latex).equation("x", sum, 30);
    assert!(
        source.starts_with("\\begin{aligned}\nx ={}& \\mathit{term}_1 {}+ "),
        "{source}"
    );
    assert_eq!(source.matches("\\\\").count(), 3, "{source}");
    let markup = Printer::new(&g, MathMl).equation("x", sum, 30);
    assert_eq!(markup.matches("<mtr>").count(), 2, "{markup}");
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
    let markup = Printer::new(&g, MathMl).equation("y", whole, 40);
    assert!(well_formed(&markup), "{markup}");
    let simple = Printer::new(&g, MathMl).expression(square);
    assert_eq!(
        simple,
        "<mrow><msup><mi>sin</mi><mn>2</mn></msup><mo>&#x2061;</mo>\
         <mover accent=\"true\"><mi>θ</mi><mo>&#x2d9;</mo></mover></mrow>"
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
        } else {
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
    assert!(
        !Printer::new(&g, MathMl)
            .expression(markup)
            .contains("<script")
    );
    for name in ["", "_", "__dot", "dot_dot_dot", "d__d_", "d_d_d_d_d"] {
        let symbol = g.symbol(name);
        text(&g, symbol);
        latex(&g, symbol);
    }
}

#[test]
fn shared_parts_do_not_explode() {
    let mut g = Graph::new();
    let mut e = g.symbol("x");
    for _ in 0..100 {
        let (s, square) = (g.sin(e), g.square(e));
        let product = g.mul(s, square);
        e = g.add(product, e);
    }
    assert!(text(&g, e).len() < 1 << 22);
    // Depth is no trouble either.
    let mut deep = g.symbol("y");
    for _ in 0..5_000 {
        deep = g.sin(deep);
    }
    assert!(!text(&g, deep).is_empty());
}

#[test]
fn systems_are_written_row_by_row() {
    let mut g = Graph::new();
    let [a, b, u] = symbols(&mut g, ["a", "b", "u"]);
    let sum = g.add(a, b);
    let unknowns = g.solve_numerically(vec![sum, b, Graph::ZERO, Graph::ONE], vec![u, a]);
    let scaled = g.mul(u, unknowns[1]);
    assert_eq!(text(&g, scaled), "u·solution_1_2");
    assert_eq!(
        Printer::new(&g, Text).system(0, 80),
        "(a + b)·solution_1_1 + b·solution_1_2 = u\nsolution_1_2 = a"
    );
}

#[test]
fn lists_stand_below_each_other() {
    let mut g = Graph::new();
    let [x, y] = symbols(&mut g, ["x", "y"]);
    let sum = g.add(x, y);
    let list = [("omega_1_dot", sum), ("b", x)];
    assert_eq!(
        Printer::new(&g, Text).equations(&list, 80),
        "ω̇₁ = x + y\nb = x"
    );
    assert_eq!(
        Printer::new(&g, Latex).equations(&list, 80),
        "\\begin{gathered}\n\\dot\\omega_1 = x + y \\\\\nb = x\n\\end{gathered}"
    );
}
