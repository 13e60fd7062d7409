//! The equations of *Steering Control of an Autonomous Unicycle* (Vizi, Orosz, Takács, Stépán),
//! corrected where `docs/errata.md` says so, are the derived ones: as functions, not at points.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_codegen::linearisation::Characteristic;
use appell_tests::paper::{Paper, rolling_wheel, unicycle};
use appell_tests::shipped;

/// Equations that wheel and unicycle share.
const PSEUDO_VELOCITIES: &str = "
    w1 = thd
    w2 = psid*sin(th) + phid
    w3 = psid*cos(th)";
const HIDDEN: &str = "
    psid = w3/cos(th)
    phid = w2 - w3*tan(th)
    xGd = w1*R*sin(psi)*cos(th) + w2*R*cos(psi)
    yGd = -w1*R*cos(psi)*cos(th) + w2*R*sin(psi)";
const ACCELERATIONS: &str = "
    aG1 = R*(w2d + w1*w3)
    aG2 = -R*(w1d - w2*w3)
    aG3 = -R*(w1**2 + w2*w3*tan(th))
    alpha1 = w1d - w2*w3 + w3**2*tan(th)
    alpha2 = w2d
    alpha3 = w3d + w1*w2 - w1*w3*tan(th)";

#[test]
fn steering_paper_equations_2_and_3_velocity_and_height_of_the_wheel_centre() {
    for paper in [rolling_wheel, unicycle] {
        let mut paper = paper();
        paper.assert(
            "vG1 = R*w2
             vG2 = -R*w1
             vG3 = 0
             zG = R*cos(th)
             xGd = R*(psid*sin(th)*cos(psi) + thd*cos(th)*sin(psi) + phid*cos(psi))
             yGd = R*(psid*sin(th)*sin(psi) - thd*cos(th)*cos(psi) + phid*sin(psi))",
        );
    }
}

#[test]
fn steering_paper_equation_5_pseudo_velocities_of_the_wheel() {
    rolling_wheel().assert(PSEUDO_VELOCITIES);
}

#[test]
fn steering_paper_equation_6_rolling_wheel() {
    let mut paper = rolling_wheel();
    paper.assert(
        "w1d = 6/5*w2*w3 - 1/5*w3**2*tan(th) + 4*g/(5*R)*sin(th)
         w2d = -2/3*w1*w3
         w3d = -2*w1*w2 + w1*w3*tan(th)
         thd = w1",
    );
    paper.assert(HIDDEN);
}

#[test]
fn steering_paper_equation_14_steady_motion_of_the_wheel() {
    let mut paper = rolling_wheel();
    let steady = paper.derived("steady_w1d");
    let mut solution = paper.substitution(&[("Fd", "-5/6*Pd*sin(th) - 2*g/(3*R)*tan(th)/Pd")]);
    let rate = solution
        .apply(&mut paper.derivation.algebra.graph, steady)
        .unwrap();
    let zero = paper.formula("0");
    assert!(paper.same(rate, zero));
}

#[test]
fn steering_paper_equations_18_and_19_linear_wheel() {
    rolling_wheel().assert_linearisation(
        "A12 = 6/5*Pd*cos(th)
         A13 = 4/5*Pd*sin(th) + 6/5*Fd
         A14 = -1/5*Pd**2 + 4*g/(5*R)*cos(th)
         A21 = -2/3*Pd*cos(th)
         A31 = -Pd*sin(th) - 2*Fd
         A41 = 1
         A53 = 1/cos(th)
         A54 = Pd*tan(th)
         A62 = 1
         A63 = -tan(th)
         A64 = -Pd/cos(th)
         A71 = R*sin(psi)*cos(th)
         A72 = R*cos(psi)
         A75 = -R*sin(psi)*(Pd*sin(th) + Fd)
         A81 = -R*cos(psi)*cos(th)
         A82 = R*sin(psi)
         A85 = R*cos(psi)*(Pd*sin(th) + Fd)",
    );
}

#[test]
fn steering_paper_equations_20_and_21_eigenvalues_of_the_wheel() {
    let mut paper = rolling_wheel();
    let polynomial = paper.characteristic();
    assert_eq!((polynomial.degree, polynomial.zeros()), (8, 6));
    assert_polynomial(
        &mut paper,
        &polynomial,
        "1",
        &["0", "-(A12*A21 + A13*A31 + A14*A41)"],
    );
    assert_polynomial(
        &mut paper,
        &polynomial,
        "1",
        &[
            "0",
            "Pd**2 + 14/5*Pd*Fd*sin(th) + 12/5*Fd**2 - 4*g/(5*R)*cos(th)",
        ],
    );
}

/// Demands coefficients after the first, all of them times `factor`. Entries `A12` are the derived.
fn assert_polynomial(
    paper: &mut Paper,
    polynomial: &Characteristic,
    factor: &str,
    coefficients: &[&str],
) {
    let before = paper.scope.clone();
    for name in paper.derived_names() {
        if name.starts_with('A') {
            let entry = paper.derived(&name);
            paper.scope.define(&name, entry);
        }
    }
    for (&derived, typed) in polynomial.coefficients[1..].iter().zip(coefficients) {
        let (factor, right) = (paper.formula(factor), paper.formula(typed));
        let left = paper.derivation.algebra.graph.mul(factor, derived);
        assert!(paper.same(left, right), "{typed}");
    }
    paper.scope = before;
}

#[test]
fn steering_paper_equation_25_straight_rolling_of_the_wheel() {
    let mut paper = Paper::steering(shipped::mechanism("rolling_wheel"));
    paper.linearise(&[("th", "0"), ("Pd", "0"), ("psi", "0")]);
    paper.assert_linearisation(
        "A13 = 6/5*Fd
         A14 = 4*g/(5*R)
         A31 = -2*Fd
         A41 = 1
         A53 = 1
         A62 = 1
         A72 = R
         A81 = -R
         A85 = R*Fd",
    );
    paper.assert("steady_w1d = 0");
}

#[test]
fn steering_paper_equation_29_spinning_wheel() {
    let mut paper = Paper::steering(shipped::mechanism("rolling_wheel"));
    paper.linearise(&[("th", "0"), ("Fd", "0")]);
    paper.assert_linearisation(
        "A12 = 6/5*Pd
         A14 = -1/5*Pd**2 + 4*g/(5*R)
         A21 = -2/3*Pd
         A41 = 1
         A53 = 1
         A62 = 1
         A64 = -Pd
         A71 = R*sin(psi)
         A72 = R*cos(psi)
         A81 = -R*cos(psi)
         A82 = R*sin(psi)",
    );
    paper.assert("steady_w1d = 0");
}

#[test]
fn steering_paper_equation_76_angular_velocity_of_the_wheel() {
    for paper in [rolling_wheel, unicycle] {
        let mut paper = paper();
        paper.assert(
            "omega1 = thd
             omega2 = psid*sin(th) + phid
             omega3 = psid*cos(th)",
        );
    }
}

#[test]
fn steering_paper_equation_79_generalised_velocities() {
    for paper in [rolling_wheel, unicycle] {
        let mut paper = paper();
        paper.assert(HIDDEN);
        paper.assert("thd = w1");
    }
}

#[test]
fn steering_paper_equation_81_accelerations_in_the_tilted_frame() {
    for paper in [rolling_wheel, unicycle] {
        let mut paper = paper();
        paper.assert(ACCELERATIONS);
    }
}

#[test]
fn steering_paper_equation_82_acceleration_energy_of_the_wheel() {
    let mut paper = rolling_wheel();
    assert_acceleration_energy(
        &mut paper,
        "m*R**2/8*(5*w1d**2 + 6*w2d**2 + w3d**2 + (2*w3**2*tan(th) - 12*w2*w3)*w1d
            + 8*w1*w3*w2d + (4*w1*w2 - 2*w1*w3*tan(th))*w3d)",
        &["w1d", "w2d", "w3d"],
    );
    paper.assert(
        "dS1 = m*R**2/4*(5*w1d - 6*w2*w3 + w3**2*tan(th))
         dS2 = m*R**2/2*(3*w2d + 2*w1*w3)
         dS3 = m*R**2/4*(w3d + 2*w1*w2 - w1*w3*tan(th))
         left1 = m*R**2/4*(5*w1d - 6*w2*w3 + w3**2*tan(th))
         left2 = m*R**2/2*(3*w2d + 2*w1*w3)
         left3 = m*R**2/4*(w3d + 2*w1*w2 - w1*w3*tan(th))",
    );
}

/// The acceleration energy up to terms free of accelerations.
fn assert_acceleration_energy(paper: &mut Paper, typed: &str, accelerations: &[&str]) {
    let (derived, typed) = (paper.derived("S"), paper.formula(typed));
    let graph = &mut paper.derivation.algebra.graph;
    let rest = graph.sub(derived, typed);
    for name in accelerations {
        let symbol = paper
            .derivation
            .algebra
            .graph
            .as_symbol(paper.scope.get(name).unwrap())
            .unwrap();
        let algebra = &mut paper.derivation.algebra;
        assert!(
            algebra.test.independent_of(&algebra.graph, rest, symbol),
            "{name}"
        );
    }
}

#[test]
fn steering_paper_equation_85_forces_on_the_wheel() {
    rolling_wheel().assert(
        "Pi1 = m*g*R*sin(th)
         Pi2 = 0
         Pi3 = 0",
    );
}

#[test]
fn steering_paper_equation_86_pseudo_accelerations_of_the_wheel() {
    rolling_wheel().assert(
        "w1d = 6/5*w2*w3 - 1/5*w3**2*tan(th) + 4*g/(5*R)*sin(th)
         w2d = -2/3*w1*w3
         w3d = -2*w1*w2 + w1*w3*tan(th)",
    );
}

#[test]
fn a_wheel_with_any_axisymmetric_inertia_follows_the_general_equations() {
    Paper::steering(shipped::mechanism("axisymmetric_wheel")).assert(
        "w1d = ((1 + k_2)*w2*w3 - k_1*w3**2*tan(th) + g/R*sin(th))/(1 + k_1)
         w2d = -w1*w3/(1 + k_2)
         w3d = w1*(k_1*w3*tan(th) - k_2*w2)/k_1",
    );
}

#[test]
fn steering_paper_equation_35_pseudo_velocities_of_the_unicycle() {
    let mut paper = unicycle();
    paper.assert(PSEUDO_VELOCITIES);
    paper.assert("s = rd");
}

const D1: &str = "let D1 = 5*m*R**2 + 4*m0*r**2";
const D2: &str = "let D2 = 3*m*R**2 + 2*m0*R**2 + 12*m0*r**2";

#[test]
fn steering_paper_equation_36_line_1_tilt_acceleration() {
    unicycle().assert(&format!(
        "{D1}
        w1d = (4*m0*R*r*w1**2 - (m*R**2 + 4*m0*r**2)*tan(th)*w3**2 - 8*m0*r*w1*s + 2*R*(3*m*R + 2*m0*r*tan(th))*w2*w3 - 4*m0*g*r*cos(th) + 4*m*g*R*sin(th) + 4*R*u)/D1"
    ));
}

#[test]
fn steering_paper_equation_36_line_2_acceleration_about_the_axle() {
    unicycle().assert(&format!(
        "{D2}
        w2d = 2*(-2*m0*R*r*w1*w2 - (m*R**2 + m0*R**2 + 4*m0*r**2)*w1*w3 + 2*m0*R*w3*s)/D2"
    ));
}

#[test]
fn steering_paper_equation_36_line_3_acceleration_about_the_upright_diameter() {
    unicycle().assert(&format!(
        "{D2}
        w3d = (-2*(3*m + 2*m0)*R**2*w1*w2 + (3*m*R**2*tan(th) + 2*m0*(R**2*tan(th) + 2*R*r + 6*r**2*tan(th)))*w1*w3 - 24*m0*r*w3*s)/D2"
    ));
}

#[test]
fn steering_paper_equation_36_line_4_tilt_rate() {
    unicycle().assert("thd = w1");
}

#[test]
fn steering_paper_equation_36_line_5_lateral_acceleration() {
    let mut paper = unicycle();
    paper.assert(&format!(
        "{D1}
        sd = ((5*m*R**2 + 4*m0*(R**2 + r**2))*r*w1**2 + (5*m*R**2*r - 4*m0*R*r**2*tan(th) + 4*m0*r**3 - m*R**3*tan(th))*w3**2 - 8*m0*R*r*w1*s + R*(m*R**2 + 4*m0*(R*r*tan(th) - r**2))*w2*w3 - (m*R**2 + 4*m0*r**2)*g*sin(th) - 4*m0*g*R*r*cos(th) + (5*m/m0*R**2 + 4*R**2 + 4*r**2)*u)/D1"
    ));
}

#[test]
fn the_lateral_acceleration_is_also_the_short_row_of_appell() {
    let mut paper = unicycle();
    let solved = paper.derived("w1d");
    paper.scope.define("solved", solved);
    paper.assert("sd = R*solved + r*w1**2 - R*w2*w3 + r*w3**2 - g*sin(th) + u/m0");
}

#[test]
fn steering_paper_equation_36_lines_6_to_10_hidden_motion() {
    let mut paper = unicycle();
    paper.assert("rd = s");
    paper.assert(HIDDEN);
}

#[test]
fn steering_paper_equations_39_and_40_steady_motion_of_the_unicycle() {
    unicycle().assert(&format!(
        "{D1}
        steady_w1d = (5*m*R**2*Pd**2*sin(th)*cos(th) + 4*m0*R*Pd**2*r*sin(th)**2 - 4*m0*Pd**2*r**2*sin(th)*cos(th) + 6*m*R**2*Pd*Fd*cos(th) + 4*m0*R*Pd*Fd*r*sin(th) - 4*m0*g*r*cos(th) + 4*m*g*R*sin(th))/D1
        steady_sd = (m*R**3*Pd*Fd*cos(th) + 4*m0*R**2*Pd*Fd*r*sin(th) - 4*m0*R*Pd*Fd*r**2*cos(th) + 5*m*R**2*Pd**2*r*cos(th)**2 + 4*m0*R**2*Pd**2*r*sin(th)**2 - 8*m0*R*Pd**2*r**2*sin(th)*cos(th) + 4*m0*Pd**2*r**3*cos(th)**2 - m*g*R**2*sin(th) - 4*m0*g*R*r*cos(th) - 4*m0*g*r**2*sin(th))/D1
        let rotation = m*R**3 - 4*m0*R*r**2 + 4*m0*R**2*r*tan(th)
        let w2s = Pd*sin(th) + Fd
        let w3s = Pd*cos(th)
        steady_sd = (m0*w2s*w3s*rotation + m0*w3s**2*(5*m*R**2*r + 4*m0*r**3 - (m*R**3 + 4*m0*R*r**2)*tan(th)) - m0*(4*m0*g*r**2 + m*g*R**2)*sin(th) - 4*m0**2*g*R*r*cos(th))/(m0*D1)"
    ));
}

#[test]
fn steering_paper_equation_41_solves_the_steady_motion_of_the_unicycle() {
    let mut paper = unicycle();
    let radius = "m*R*(Pd**2*R*cos(th) + 2*g)*sin(th)*cos(th)/(6*Pd**2*m*R*cos(th)**3 - 4*m0*g)";
    let rate = format!("Pd*({radius}*cos(th)/R - sin(th)) - g*tan(th)/(Pd*R)");
    for name in ["steady_w1d", "steady_sd"] {
        paper.assert_solves(name, &[("r", radius), ("Fd", &rate)]);
    }
}

#[test]
fn steering_paper_equation_48_and_appendix_c_linear_unicycle() {
    unicycle().assert_linearisation(&format!(
        "{D1}
        {D2}
        A12 = 2*R*Pd/D1*(3*m*R*cos(th) + 2*m0*r*sin(th))
        A13 = 2/D1*(2*m*R**2*Pd*sin(th) + 3*m*R**2*Fd + 2*m0*R*r*Pd*sin(th)*tan(th) + 2*m0*R*r*Fd*tan(th) - 4*m0*r**2*Pd*sin(th))
        A14 = 4*m0*R*r*Pd*(Fd + Pd*sin(th))/(D1*cos(th)) + (-m*R**2*Pd**2 + 4*m*g*R*cos(th) - 4*m0*r**2*Pd**2 + 4*m0*g*r*sin(th))/D1
        A16 = 4*m0/D1**2*(5*m*R**3*Pd**2*sin(th)**2 + 5*m*R**3*Pd*Fd*sin(th) - 20*m*R**2*r*Pd**2*sin(th)*cos(th) - 12*m*R**2*r*Pd*Fd*cos(th) - 5*m*g*R**2*cos(th) - 4*m0*R*r**2*Pd**2*sin(th)**2 - 4*m0*R*r**2*Pd*Fd*sin(th) - 8*m*g*R*r*sin(th) + 4*m0*g*r**2*cos(th))
        A21 = -(2*m*R**2*Pd*cos(th) + 2*m0*R**2*Pd*cos(th) + 4*m0*R*r*Pd*sin(th) + 4*m0*R*r*Fd + 8*m0*r**2*Pd*cos(th))/D2
        A25 = 4*m0*R*Pd*cos(th)/D2
        A31 = (-3*m*R**2*Pd*sin(th) - 2*m0*R**2*Pd*sin(th) - 6*m*R**2*Fd - 4*m0*R**2*Fd + 4*m0*R*r*Pd*cos(th) + 12*m0*r**2*Pd*sin(th))/D2
        A35 = -24*m0*r*Pd*cos(th)/D2
        A41 = 1
        A52 = R*Pd*cos(th)/D1*(m*R**2 + 4*m0*R*r*tan(th) - 4*m0*r**2)
        A53 = (m*R**3*Fd - m*R**3*Pd*sin(th) + 10*m*R**2*r*Pd*cos(th) + 4*m0*R**2*r*Pd*sin(th)*tan(th) + 4*m0*R**2*r*Fd*tan(th) - 12*m0*R*r**2*Pd*sin(th) - 4*m0*R*r**2*Fd + 8*m0*r**3*Pd*cos(th))/D1
        A54 = (-2*m*R**3*Pd**2*cos(th) + 8*m0*R**2*r*Pd**2*sin(th) + 8*m0*R**2*r*Pd*Fd - 2*m*g*R**2*cos(th)**2 - 8*m0*R*r**2*Pd**2*cos(th) + 8*m0*g*R*r*sin(th)*cos(th) - 8*m0*g*r**2*cos(th)**2)/(2*D1*cos(th))
        A56 = (25*m**2*R**4*Pd**2*cos(th)**2 + 20*m*m0*R**4*Pd**2*sin(th)**2 + 20*m*m0*R**4*Pd*Fd*sin(th) - 80*m*m0*R**3*r*Pd**2*sin(th)*cos(th) - 48*m*m0*R**3*r*Pd*Fd*cos(th) - 20*m*m0*g*R**3*cos(th) + 40*m*m0*R**2*r**2*Pd**2*cos(th)**2 - 16*m0**2*R**2*r**2*Pd**2*sin(th)**2 - 16*m0**2*R**2*r**2*Pd*Fd*sin(th) - 32*m*m0*g*R**2*r*sin(th) + 16*m0**2*g*R*r**2*cos(th) + 16*m0**2*r**4*Pd**2*cos(th)**2)/D1**2
        A65 = 1
        A73 = 1/cos(th)
        A74 = Pd*tan(th)
        A82 = 1
        A83 = -tan(th)
        A84 = -Pd/cos(th)
        A91 = R*sin(psi)*cos(th)
        A92 = R*cos(psi)
        A97 = -R*(Pd*sin(th) + Fd)*sin(psi)
        A101 = -R*cos(psi)*cos(th)
        A102 = R*sin(psi)
        A107 = R*(Pd*sin(th) + Fd)*cos(psi)
        B1 = 4*R/D1
        B5 = (5*m/m0*R**2 + 4*R**2 + 4*r**2)/D1"
    ));
}

#[test]
fn steering_paper_equation_49_characteristic_polynomial_of_the_unicycle() {
    let mut paper = unicycle();
    let polynomial = paper.characteristic();
    assert_eq!((polynomial.degree, polynomial.zeros()), (10, 6));
    // λ² times tilt and slide rates, the other states put in.
    let (tilt, slide) = ("(A12*A21 + A13*A31 + A14)", "(A52*A25 + A53*A35 + A56)");
    let (to_tilt, to_slide) = ("(A12*A25 + A13*A35 + A16)", "(A52*A21 + A53*A31 + A54)");
    assert_polynomial(
        &mut paper,
        &polynomial,
        "1",
        &[
            "0",
            &format!("-{tilt} - {slide}"),
            "0",
            &format!("{tilt}*{slide} - {to_tilt}*{to_slide}"),
        ],
    );
}

fn straight_unicycle() -> Paper {
    let mut paper = Paper::steering(shipped::mechanism("unicycle"));
    paper.linearise(&[("th", "0"), ("r", "0"), ("Pd", "0"), ("psi", "0")]);
    paper
}

#[test]
fn steering_paper_equations_50_and_55_straight_rolling_of_the_unicycle() {
    let mut paper = straight_unicycle();
    paper.assert_linearisation(
        "A13 = 6/5*Fd
         A14 = 4*g/(5*R)
         A16 = -4*m0*g/(5*m*R**2)
         A31 = -2*Fd
         A41 = 1
         A53 = R*Fd/5
         A54 = -g/5
         A56 = -4*m0*g/(5*m*R)
         A65 = 1
         A73 = 1
         A82 = 1
         A92 = R
         A101 = -R
         A107 = R*Fd
         B1 = 4/(5*m*R)
         B5 = (5*m + 4*m0)/(5*m*m0)",
    );
    paper.assert("steady_w1d = 0\nsteady_sd = 0");
}

#[test]
fn steering_paper_equations_51_and_52_characteristic_polynomial_of_straight_rolling() {
    let mut paper = straight_unicycle();
    let polynomial = paper.characteristic();
    assert_eq!((polynomial.degree, polynomial.zeros()), (10, 6));
    assert_polynomial(
        &mut paper,
        &polynomial,
        "5*m*R**2",
        &[
            "0",
            "12*Fd**2*m*R**2 + 4*(m0 - m)*g*R",
            "0",
            "4*m0*g*(2*Fd**2*R - g)",
        ],
    );
}

#[test]
fn steering_paper_equation_88_acceleration_of_the_sliding_mass() {
    unicycle().assert(
        "aA1 = R*w2d - r*w3d + w1*w3*(R + r*tan(th)) - 2*w3*s
         aA2 = -R*w1d + sd - w1**2*r + w2*w3*R - w3**2*r
         aA3 = r*w1d - w1**2*R + 2*w1*s - w2*w3*R*tan(th) + w3**2*r*tan(th)",
    );
}

#[test]
fn velocity_of_the_sliding_mass_in_the_tilted_frame() {
    unicycle().assert(
        "vA1 = R*w2 - r*w3
         vA2 = -R*w1 + s
         vA3 = r*w1",
    );
}

#[test]
fn steering_paper_equation_89_acceleration_energy_of_the_unicycle() {
    let mut paper = unicycle();
    assert_acceleration_energy(
        &mut paper,
        appell_tests::errata::ACCELERATION_ENERGY,
        &["w1d", "w2d", "w3d", "sd"],
    );
}

#[test]
fn steering_paper_equation_89_mass_matrix() {
    unicycle().assert(
        "M11 = (5*m*R**2 + 4*m0*(R**2 + r**2))/4
         M14 = -m0*R
         M22 = (3*m + 2*m0)*R**2/2
         M23 = -m0*R*r
         M33 = (m*R**2 + 4*m0*r**2)/4
         M44 = m0
         M41 = -m0*R
         M32 = -m0*R*r
         M12 = 0
         M13 = 0
         M24 = 0
         M34 = 0",
    );
}

#[test]
fn steering_paper_equation_89_bias() {
    unicycle().assert(
        "b1 = (8*w1*s*m0*r + w3**2*(4*m0*r**2*tan(th) + 4*m0*R*r + m*R**2*tan(th)) - w2*w3*(6*m*R**2 + 4*m0*R**2 + 4*m0*R*r*tan(th)))/4
         b2 = w1*w3*(m*R**2 + m0*R**2 + m0*R*r*tan(th)) - 2*w3*s*m0*R
         b3 = (2*w1*w2*m*R**2 - w1*w3*(m*R**2 + 4*m0*r**2)*tan(th) - 4*w1*w3*m0*R*r + 8*w3*s*m0*r)/4
         b4 = -m0*(w1**2*r - w2*w3*R + w3**2*r)",
    );
}

#[test]
fn the_derivatives_of_the_acceleration_energy_are_the_left_sides_of_appell() {
    for paper in [rolling_wheel, unicycle] {
        let mut paper = paper();
        for k in 1..=paper.derivation.symbols.speeds.len() {
            let (a, b) = (
                paper.derived(&format!("dS{k}")),
                paper.derived(&format!("left{k}")),
            );
            assert!(paper.same(a, b), "{} equation {k}", paper.mechanism.name);
        }
    }
}

#[test]
fn steering_paper_equation_91_forces_on_the_unicycle() {
    unicycle().assert(
        "Pi1 = (m + m0)*g*R*sin(th) - m0*g*r*cos(th)
         Pi2 = 0
         Pi3 = 0
         Pi4 = u - m0*g*sin(th)",
    );
}

#[test]
fn the_energy_of_the_unicycle_grows_by_the_power_of_the_actuator() {
    unicycle().assert(
        "V = (m + m0)*g*R*cos(th) + m0*g*r*sin(th)
         power = u*s
         energy_rate = u*s",
    );
    rolling_wheel().assert(
        "V = m*g*R*cos(th)
         energy_rate = 0",
    );
}
