//! Every numbered equation.

use crate::errata::{ERRATA, Source};
use crate::euc::EQUATIONS;
use appell_recordings::motion_capture::Axes;

use crate::book::claim::{Claim, Section, Statement};
use crate::book::steering::equations::{DEFINITION, IDENTITY, misprint};

/// Rounding of products of sines and cosines.
const ROUNDING: f64 = 1e-14;

/// Definitions and laws, with the place of their use.
const DEFINITIONS: [(&str, &str, &str); 3] = [
    (
        "(3)",
        "ϕ = arctan(x_CG/z_CG)",
        "lean = [\"C\", \"G\"] of the skeleton",
    ),
    (
        "(4)",
        "Lagrange's equations of the second kind",
        "(6)-(8); appell check --thorough compares with them",
    ),
    ("(5)", "M q̈ + h = Q", "(6)-(8)"),
];

pub(super) fn section() -> Section {
    let mut claims = vec![transformations()];
    for (place, what, used) in DEFINITIONS {
        let ours = format!("put to use in {used}");
        let claim = Statement {
            place,
            published: what,
            command: "appell check euc_3dof --thorough",
        }
        .found(ours, true);
        claims.push(claim.unchecked(DEFINITION));
    }
    for equation in EQUATIONS {
        let differences = equation.differences();
        let holds = differences.is_empty();
        let ours = if holds {
            "identical to the derived formulas".to_owned()
        } else {
            differences.join("\n")
        };
        let published = format!("{}\n{}", equation.about, equation.text);
        let command = format!("appell derive {} --stage all", equation.mechanism());
        let claim = Statement {
            place: equation.number,
            published: &published,
            command: &command,
        }
        .found(ours, holds);
        claims.push(claim.exactly().noted(IDENTITY));
    }
    let errata = ERRATA
        .iter()
        .filter(|erratum| erratum.source == Source::Euc);
    claims.extend(errata.map(misprint));
    Section {
        title: "Equations".to_owned(),
        about: "Each formula is typed as the paper prints it, corrected where a row below says so, and compared with \
                the derived one by the identity test: as a function of all its letters, not at points."
            .to_owned(),
        claims,
        pictures: Vec::new(),
    }
}

/// (1) and (2), by the axes that the pipeline uses.
fn transformations() -> Claim {
    let (psi, theta): (f64, f64) = (0.7, -0.3);
    let (s, c, u, d) = (psi.sin(), psi.cos(), theta.sin(), theta.cos());
    // T_ψ T_ϑ, row by row.
    let typed = [[c, -s * d, s * u], [s, c * d, -c * u], [0.0, u, d]];
    let axes = Axes::turned([psi, theta, 0.0]);
    let mut off: f64 = 0.0;
    for k in 0..3 {
        let mut unit = [0.0; 3];
        unit[k] = 1.0;
        let column = axes.to_ground(unit);
        for i in 0..3 {
            off = off.max((column[i] - typed[i][k]).abs());
        }
    }
    Statement {
        place: "(1), (2)",
        published: "r_CG = T_ϑᵀ T_ψᵀ R_CG, yaw about z, then tilt about x",
        command: "appell motion SKELETON ride.csv",
    }
    .found(
        format!("the axes of the moving frame differ by {off:.0e}"),
        off < ROUNDING,
    )
    .exactly()
}
