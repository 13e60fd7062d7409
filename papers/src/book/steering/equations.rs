//! Every numbered equation that is a formula or a definition.

use crate::errata::{ERRATA, Erratum, Evidence, Source, Subject};
use crate::steering::{EQUATIONS, Equation, Formulas};
use appell_models::Shipped;

use crate::book::claim::{Claim, Section, Statement};
use crate::book::failed;
use appell::Error;

/// Basis of the agreement of an identical formula.
pub(crate) const IDENTITY: &str = "by the identity test";
/// Why a statement is not comparable.
pub(crate) const DEFINITION: &str = "a definition";

/// Definitions and laws, with the place of their use.
const DEFINITIONS: &[(u32, &str, &str)] = &[
    (1, "v_P = 0: the wheel rolls", "(2)"),
    (8, "steady: ω₁, ω₂, ω₃ and ϑ are constant", "(9)"),
    (17, "the steady motion as a state", "(18), (19)"),
    (32, "r_GA = [0, r, 0] in the tilted frame", "(47), (88)"),
    (
        33,
        "F = [0, u, 0] in the tilted frame, −F on the wheel",
        "(91)",
    ),
    (38, "steady: ω₁, ω₂, ω₃, ϑ, σ and r are constant", "(39)"),
    (61, "y = [ω₁ ϑ σ r ψ y_G]", "table II"),
    (62, "C selects the states 1, 4, 5, 6, 7, 10", "table II"),
    (64, "u = −K (y − y_des)", "figure 8"),
    (65, "y_des = [0 0 0 0 0 y_des(t)]", "figure 8"),
    (68, "y = [ω₁ ϑ σ r ψ]", "table III"),
    (69, "C selects the states 1, 4, 5, 6, 7", "table III"),
    (70, "y_des = [0 0 0 0 ψ_des(t)]", "figure 8"),
    (72, "a in F₀ is T₀₂ a in F₂", "(73)"),
    (74, "v_P = v_G + ω × r_GP", "(2)"),
    (75, "v_G = [ẋ_G ẏ_G ż_G]", "(2)"),
    (77, "r_GP = [0, 0, −R] in the tilted frame", "(2)"),
    (
        78,
        "constraints and pseudo-velocities as one linear system",
        "(79)",
    ),
    (80, "acceleration energy of a rigid body", "(82)"),
    (84, "virtual power of the weight", "(85)"),
    (87, "acceleration energy of wheel and point mass", "(89)"),
    (90, "virtual power of weights and actuator", "(91)"),
];

/// Lists of letters, which must occur in the spec.
const LISTS: &[(u32, &str, &str, &[&str])] = &[
    (
        4,
        "generalised coordinates of the wheel",
        "rolling_wheel",
        &["x_G", "y_G", "psi", "theta", "phi"],
    ),
    (
        7,
        "state of the wheel",
        "rolling_wheel",
        &[
            "omega_1", "omega_2", "omega_3", "theta", "psi", "phi", "x_G", "y_G",
        ],
    ),
    (
        34,
        "generalised coordinates of the unicycle",
        "unicycle",
        &["x_G", "y_G", "theta", "psi", "phi", "r"],
    ),
    (
        37,
        "state of the unicycle",
        "unicycle",
        &[
            "omega_1", "omega_2", "omega_3", "theta", "sigma", "r", "psi", "phi", "x_G", "y_G",
        ],
    ),
];

/// The equations in the order of their numbers.
pub(super) fn section() -> Result<Section, Error> {
    let mut claims: Vec<(u32, Claim)> = Vec::new();
    for equation in EQUATIONS {
        claims.push((first_number(equation.number), typed(equation)));
    }
    for &(number, what, used) in DEFINITIONS {
        let place = format!("({number})");
        let ours = format!("the spec says the same; used in {used}");
        let claim = Statement {
            place: &place,
            published: what,
            command: "appell check unicycle",
        }
        .found(ours, true);
        claims.push((number, claim.unchecked(DEFINITION)));
    }
    for list in LISTS {
        claims.push((list.0, letters(list)?));
    }
    // Errata of a figure are listed with it.
    let of_equations =
        |e: &&Erratum| e.source == Source::Steering && !e.equation.contains("figure");
    let errata = ERRATA.iter().filter(of_equations);
    for erratum in errata {
        claims.push((first_number(erratum.equation), misprint(erratum)));
    }
    claims.sort_by_key(|(number, _)| *number);
    Ok(Section {
        title: "Equations".to_owned(),
        about: "Each formula is typed as the paper prints it, corrected where a row below says so, and \
                compared with the derived one by the identity test: as a function of all its letters, \
                not at points. Rows that say “erratum” show what is printed and what is right; where \
                they are formulas, the printed one fails the test and the right one passes. The paper \
                was read as recognised text: “text recognition” is not the authors’."
            .to_owned(),
        claims: claims.into_iter().map(|(_, claim)| claim).collect(),
        pictures: Vec::new(),
    })
}

/// The first number in a reference; references without one come last.
fn first_number(place: &str) -> u32 {
    let place = match place {
        "appendix C" => "(48)",
        other => other,
    };
    let digits = place.split(|c: char| !c.is_ascii_digit());
    let number = digits
        .filter(|d| !d.is_empty())
        .find_map(|d| d.parse().ok());
    match number {
        Some(number) if place.contains('(') => number,
        _ if place.starts_with("appendix C") => 48,
        _ => u32::MAX,
    }
}

fn typed(equation: &Equation) -> Claim {
    let differences = equation.differences();
    let formulas: Vec<&str> = equation.claims.iter().map(|c| c.formulas.text()).collect();
    let mut lines: Vec<&str> = Vec::new();
    for line in formulas.iter().flat_map(|text| text.lines()).map(str::trim) {
        if !line.is_empty() && !lines.contains(&line) {
            lines.push(line);
        }
    }
    let kind = match equation.claims.first().map(|claim| &claim.formulas) {
        Some(Formulas::Matrix(_)) => "; entries that are not listed are zero",
        Some(Formulas::Energy(_)) => "; up to terms without accelerations",
        _ => "",
    };
    let ours = if differences.is_empty() {
        format!("identical to the derived formulas{kind}")
    } else {
        differences.join("\n")
    };
    let subject = equation.claims.first().map(|claim| claim.subject);
    let mechanism = subject.map_or("unicycle", Subject::mechanism);
    let stage = if kind.contains("zero") {
        "jacobians"
    } else {
        "all"
    };
    let published = format!("{}\n{}", equation.about, lines.join("\n"));
    let command = format!("appell derive {mechanism} --stage {stage}");
    let claim = Statement {
        place: equation.number,
        published: &published,
        command: &command,
    }
    .found(ours, differences.is_empty());
    claim.exactly().noted(IDENTITY)
}

fn letters((number, what, mechanism, names): &(u32, &str, &str, &[&str])) -> Result<Claim, Error> {
    let shipped = Shipped::find(mechanism).ok_or_else(|| failed("a mechanism is missing"))?;
    let info = shipped.model.info();
    let has = |name: &&str| info.states.iter().any(|state| state.name == **name);
    let coordinates = info.coordinate_quantities().len();
    let whole = names.len() == coordinates || names.len() == info.state_len();
    let published = format!("{what}: {}", names.join(", "));
    let ours = "the spec has the same".to_owned();
    let holds = names.iter().all(has) && whole;
    let command = format!("appell check {mechanism}");
    let claim = Statement {
        place: &format!("({number})"),
        published: &published,
        command: &command,
    }
    .found(ours, holds);
    Ok(claim.exactly())
}

/// The printed and the correct formula.
pub(crate) fn misprint(erratum: &Erratum) -> Claim {
    let kind = erratum.origin.words();
    let mut note = format!("erratum: {kind}");
    let (evidence, as_expected) = match &erratum.evidence {
        Evidence::Test(_, comparison) => {
            let [printed, right] = comparison.verdicts();
            let verb = |holds: bool| if holds { "is" } else { "is not" };
            let ours = format!(
                "what is printed {} what is derived; what is right {} so",
                verb(printed),
                verb(right)
            );
            (ours, right && !printed)
        }
        Evidence::Context(words) => {
            // Names of tests are for readers of the source.
            let words = words.split("; tested").next().unwrap_or(words);
            let words = words.split("simulated:").next().unwrap_or(words);
            note.push_str(", by the context");
            (words.to_owned(), true)
        }
    };
    let published = format!("printed: {}", erratum.printed);
    let ours = format!("right: {}\n{evidence}", erratum.right);
    let claim = Statement {
        place: erratum.equation,
        published: &published,
        command: "docs/errata.md",
    }
    .found(ours.trim_end(), as_expected);
    claim.erratum(kind).noted(note)
}
