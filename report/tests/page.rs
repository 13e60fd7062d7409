//! The derivation as a page: what it looks like, and that it is true.

use appell_report::derivation::{self, Block, Math, Page, Stage};
use appell_spec::mechanism::{
    BodyId, CoordinateId, FrameId, LoadId, OutputId, ParameterId, PointId,
};

use crate::support::{EQUATIONS, WHOLE, page_of, page_of_spec, spec};

/// The handouts under snapshot.
const HANDOUTS: [&str; 3] = ["unicycle", "euc_3dof", "pendulum"];
/// Width of the text page, from the module.
const WIDTH: usize = 100;

#[test]
fn handouts_read_as_before() {
    for name in HANDOUTS {
        let page = page_of(name, Stage::Equations);
        insta::assert_snapshot!(format!("{name}_text"), derivation::text(&page));
        insta::assert_snapshot!(format!("{name}_latex"), derivation::latex(&page));
    }
}

#[test]
fn everything_about_a_mechanism_reads_as_before() {
    insta::assert_snapshot!(
        "unicycle_all_text",
        derivation::text(&page_of("unicycle", Stage::All))
    );
}

#[test]
fn two_runs_give_the_same_bytes() {
    for name in HANDOUTS {
        let formats = |page: &Page| {
            [
                derivation::text(page),
                derivation::latex(page),
                derivation::html(page),
            ]
        };
        let (first, second) = (page_of(name, Stage::All), page_of(name, Stage::All));
        assert_eq!(formats(&first), formats(&second), "{name}");
    }
}

#[test]
fn every_stage_holds_the_stages_before_it() {
    use Stage::{All, Energy, Equations, Jacobians, Kinematics};
    let stages = [Kinematics, Energy, Equations, Jacobians, All];
    let pages = stages.map(|stage| page_of("unicycle", stage));
    for (place, pair) in pages.windows(2).enumerate() {
        let (shorter, longer) = (&pair[0].sections, &pair[1].sections);
        assert!(
            stages[place + 1] == Equations || shorter.len() < longer.len(),
            "{:?}",
            stages[place + 1]
        );
        for section in shorter {
            let handout = stages[place + 1] == Equations && is_mass_matrix(section);
            assert!(handout || longer.contains(section), "{section:?}");
        }
    }
}

fn is_mass_matrix(section: &derivation::Section) -> bool {
    matches!(&section.heading[0], derivation::Span::Text(text) if text.starts_with("Mass matrix"))
}

#[test]
fn the_handout_tells_the_mass_matrix_where_it_solves_the_equations() {
    for (name, in_letters) in [("unicycle", false), ("euc_3dof", true)] {
        let page = page_of(name, Stage::Equations);
        assert_eq!(
            page.sections.iter().any(is_mass_matrix),
            in_letters,
            "{name}"
        );
    }
}

#[test]
fn text_keeps_its_width() {
    let mut wide = Vec::new();
    for (name, page) in &*EQUATIONS {
        let text = derivation::text(page);
        let lines: Vec<&str> = text.lines().collect();
        for (number, line) in lines.iter().enumerate() {
            // A quotient is not broken, however wide it is, nor is the power of a sum.
            let beside = number.saturating_sub(1)..(number + 2).min(lines.len());
            let is_quotient = lines[beside].iter().any(|line| line.contains("────"));
            if is_quotient || line.contains(")²") {
                continue;
            }
            let columns = line
                .chars()
                .filter(|c| !('\u{300}'..='\u{36f}').contains(c))
                .count();
            if columns > WIDTH {
                wide.push(format!("{name}, {columns} columns: {line}"));
            }
        }
    }
    assert!(wide.is_empty(), "{wide:#?}");
}

#[test]
fn latex_closes_what_it_opens() {
    for (name, page) in &*WHOLE {
        let latex = derivation::latex(page);
        let mut depth = 0_i32;
        let mut escaped = false;
        for c in latex.chars() {
            match c {
                '{' if !escaped => depth += 1,
                '}' if !escaped => depth -= 1,
                _ => {}
            }
            assert!(depth >= 0, "{name}: a brace closes that was not opened");
            escaped = c == '\\' && !escaped;
        }
        assert_eq!(depth, 0, "{name}");
        for environment in ["align*", "bmatrix", "tabularx", "document", "cases"] {
            let count = |what: &str| latex.matches(&format!("\\{what}{{{environment}}}")).count();
            assert_eq!(count("begin"), count("end"), "{name}: {environment}");
        }
    }
}

#[test]
fn html_is_well_formed_and_needs_no_network() {
    for (name, page) in &*WHOLE {
        let html = derivation::html(page);
        crate::support::assert_well_formed(&html);
        assert!(!html.contains("http"), "{name}: an address");
        assert!(!html.contains("<script"), "{name}: a script");
        assert!(!html.contains("src="), "{name}: a file of its own");
        assert!(html.contains("prefers-color-scheme: dark") && html.contains("@media print"));
        assert!(html.matches("<section>").count() >= 11, "{name}");
        assert!(html.contains("<math display=\"block\">"), "{name}");
    }
}

#[test]
fn texts_of_a_spec_are_shown_and_not_obeyed() {
    // The checks of a spec refuse most of this; the page does not rely on them.
    let hostile = r"</title><script>alert(1)</script> \input{/etc/passwd} $x$ % & # ~ ^ _ {";
    let steering = "\u{1b}[2J \u{202e}abc\u{200f} 漢";
    let page = crate::support::page_after(&spec("pendulum"), |m| {
        m.title = hostile.to_owned();
        m.source = Some(hostile.to_owned());
        m.parameters[ParameterId::new(0)].label.about = hostile.to_owned();
        m.parameters[ParameterId::new(1)].label.name = hostile.to_owned();
        m.parameters[ParameterId::new(2)].label.unit.text = hostile.to_owned();
        m.coordinates[CoordinateId::new(0)].label.name = steering.to_owned();
        m.frames[FrameId::new(1)].name = hostile.to_owned();
        m.points[PointId::new(1)].name = hostile.to_owned();
        m.bodies[BodyId::new(0)].name = hostile.to_owned();
        m.bodies[BodyId::new(0)].about = steering.to_owned();
        m.loads[LoadId::new(0)].name = hostile.to_owned();
        m.outputs[OutputId::new(0)].label.name = hostile.to_owned();
    });

    let html = derivation::html(&page);
    crate::support::assert_well_formed(&html);
    assert!(!html.contains("<script"));
    assert!(html.contains("&lt;script&gt;alert(1)&lt;/script&gt;"));

    let latex = derivation::latex(&page);
    assert!(!latex.contains("\\input"));
    assert!(latex.contains(r"\textbackslash{}input\{/etc/passwd\} \$x\$ \% \& \#"));

    for output in [derivation::text(&page), latex, html] {
        let steers =
            |c: char| (c.is_control() && c != '\n') || ('\u{202a}'..='\u{202e}').contains(&c);
        assert!(!output.contains(steers));
        assert!(!output.contains('\u{200f}'));
    }
}

#[test]
fn every_kind_of_load_is_stated() {
    let text = spec("pendulum")
        .split("[loads]")
        .next()
        .unwrap_or_default()
        .to_owned()
        + r#"
[loads]
weight = { kind = "gravity", down = "-z", acceleration = "g" }
push   = { kind = "force", on = "B", body = "rod", reaction_on = "A", in = "rod", vector = ["tau/l", 0, 0] }
coil   = { kind = "spring", between = ["A", "G"], stiffness = "k", relaxed = "l" }
oil    = { kind = "damper", between = ["A", "G"], damping = "c" }
helix  = { kind = "spring", coordinate = "theta", stiffness = "k*l^2", relaxed = "1 [rad]" }
brake  = { kind = "damper", coordinate = "theta", damping = "c*l^2" }
drag   = { kind = "generalized", coordinate = "theta", force = "-tau" }
"#;
    let text = text
        .replace(
            "[coordinates]",
            "k = { value = 10, unit = \"N/m\" }\nc = { value = 1, unit = \"N*s/m\" }\n[coordinates]",
        )
        .replace(
            "[points]",
            "[points]\nA = { from = \"O\", in = \"ground\", at = [\"2*l\", 0, 0] }\nB = { from = \"O\", in = \"rod\", at = [0, 0, \"-2*l\"] }",
        );
    let page = derivation::text(&crate::support::page_after(&text, |_| {}));
    let words: Vec<&str> = page.split_whitespace().collect();
    let page = words.join(" ");
    for statement in [
        "F_weight = [0, 0, −m g] ground at G; δP_weight = F_weight · δv_G.",
        "F_push = [τ/l, 0, 0] rod at B, fixed in rod, −F_push at A; \
         δP_push = F_push · (δv_G + δω_rod × r_GB − δv_A).",
        "tension F_coil = k (|r_AG| − l) between A and G; \
         δP_coil = F_coil r_AG/|r_AG| · (δv_A − δv_G).",
        "tension F_oil = c r_AG/|r_AG| · (v_G − v_A) between A and G; \
         δP_oil = F_oil r_AG/|r_AG| · (δv_A − δv_G).",
        "F_helix = −l² k (θ − 1) along θ; δP_helix = F_helix δθ̇.",
        "F_brake = −l² c θ̇ along θ; δP_brake = F_brake δθ̇.",
        "F_drag = −τ along θ; δP_drag = F_drag δθ̇.",
    ] {
        assert!(page.contains(statement), "{statement} is not in {page}");
    }
}

#[test]
fn divisions_that_can_fail_are_told_with_the_declared_range() {
    let page = derivation::text(&page_of("unicycle", Stage::Kinematics));
    let told = "They are valid where cos θ ≠ 0; the spec declares θ from −1.5 to 1.5 rad.";
    assert!(page.contains(told), "{page}");
}

#[test]
fn what_the_page_says_is_true() {
    // Read as a program, every page of a shipped mechanism is free of contradictions: definitions,
    // constraints, Appell's equations and their solution hold together.
    for (name, page) in &*EQUATIONS {
        let checked = crate::support::check(page, 7);
        // What a system determines has no value that a reader of the page could compute.
        let by_system = derivation::text(page).contains("solved with pivoting");
        assert!(checked > 0 || by_system, "{name}: nothing was checked");
    }
}

/// A quotient by a sum in a rate, and a root that loads share.
const SCOOTER: &str = include_str!("scooter.toml");

#[test]
fn a_page_that_is_too_long_keeps_quotients_and_roots_as_letters() {
    let page = page_of_spec(SCOOTER, Stage::Equations);
    let text = derivation::text(&page);
    // With both written out everywhere it has three times as many.
    assert!(text.len() < 20_000, "{}", text.len());
    assert_eq!(text.matches("√((").count(), 1, "{text}");
    for shown in ["ψ̇ = ", "∂ψ̇/∂v = ", "where n − L cos δ ≠ 0"] {
        assert!(text.contains(shown), "{shown} is not in {text}");
    }
    assert!(crate::support::check(&page, 7) > 0);
    let mechanism = appell_spec::load("scooter.toml", SCOOTER)
        .expect("a spec")
        .mechanism;
    let in_letters = appell_codegen::mechanics::derive_in_letters(&mechanism).expect("equations");
    let verdict = appell_codegen::formulations::compare(&mechanism, &in_letters).expect("others");
    assert!(verdict.agrees(), "{verdict:#?}");
}

#[test]
fn parts_and_unknowns_are_numbered_as_they_are_defined() {
    let mut counted = 0;
    for name in ["four_bar", "bicycle", "unicycle_linkage_rider"] {
        let page = page_of(name, Stage::All);
        let mut last = 0;
        for block in page.sections.iter().flat_map(|section| &section.blocks) {
            let Block::Equations(equations) = block else {
                continue;
            };
            for equation in equations {
                let Math::Letter(letter) = &equation.left else {
                    continue;
                };
                if letter.base == "c" && letter.below.len() == 1 && letter.dots == 0 {
                    let Ok(number) = letter.below[0].parse::<usize>() else {
                        continue;
                    };
                    assert_eq!(number, last + 1, "{name}");
                    last = number;
                    counted += 1;
                }
            }
        }
        // z is the forward elimination; unknowns of systems have a letter of their own.
        let shown = derivation::text(&page);
        assert!(!shown.contains("z₁,₁"), "{name}");
    }
    assert!(counted > 0);
}

#[test]
fn brackets_are_as_high_as_matrices_and_descriptions_have_room() {
    let html = derivation::html(&page_of("bicycle", Stage::All));
    assert!(html.contains("<mtable class=\"matrix\">"));
    assert!(!html.contains("<mo>[</mo>"));
    assert!(html.contains("<td colspan=\"2\">"));
}
