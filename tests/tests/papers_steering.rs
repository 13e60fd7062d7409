//! The equations of *Steering Control of an Autonomous Unicycle* (Vizi, Orosz, Takács, Stépán),
//! corrected where `docs/errata.md` says so, are the derived ones: as functions, not at points. They
//! are typed in `papers/src/steering.toml`.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_tests::paper::Paper;
use appell_tests::paper::Subject::{Unicycle, Wheel};
use appell_tests::shipped;
use appell_tests::steering::{EQUATIONS, Equation};

fn equation(number: &str) -> &'static Equation {
    let mut equations = EQUATIONS.iter();
    equations
        .find(|equation| equation.number == number)
        .unwrap()
}

/// One test per equation, and the list of their numbers.
macro_rules! equations {
    ($($name:ident $number:literal)*) => {
        const TESTED: &[&str] = &[$($number),*];
        $(
            #[test]
            fn $name() {
                let differences = equation($number).differences();
                assert!(differences.is_empty(), "{}", differences.join("\n"));
            }
        )*
    };
}

equations! {
    steering_paper_equation_2_velocity_of_the_wheel_centre "(2)"
    steering_paper_equation_3_height_of_the_wheel_centre "(3)"
    steering_paper_equation_5_pseudo_velocities_of_the_wheel "(5)"
    steering_paper_equation_6_equations_of_motion_of_the_rolling_wheel "(6)"
    steering_paper_equation_9_steady_motion_of_the_wheel_in_pseudo_velocities "(9)"
    steering_paper_equation_10_motion_of_the_ignorable_coordinates_while_the_essential_states_rest "(10)"
    steering_paper_equation_13_steady_motion_of_the_wheel_in_yaw_and_pitch_rate "(13)"
    steering_paper_equation_14_pitch_rate_of_a_turning_wheel "(14)"
    steering_paper_equation_15_straight_rolling_needs_an_upright_wheel "(15)"
    steering_paper_equation_16_spinning_on_the_spot_needs_an_upright_wheel "(16)"
    steering_paper_equations_18_and_19_linearised_wheel "(18), (19)"
    steering_paper_equation_20_characteristic_polynomial_of_the_wheel "(20)"
    steering_paper_equation_21_square_of_the_eigenvalues_of_the_wheel "(21)"
    steering_paper_equation_24_straight_rolling_of_the_wheel "(24)"
    steering_paper_equation_25_linearised_wheel_in_straight_rolling "(25)"
    steering_paper_equation_26_square_of_the_eigenvalues_in_straight_rolling "(26)"
    steering_paper_equation_28_spinning_of_the_wheel "(28)"
    steering_paper_equation_29_linearised_wheel_in_spinning "(29)"
    steering_paper_equation_30_square_of_the_eigenvalues_in_spinning "(30)"
    steering_paper_equation_35_pseudo_velocities_of_the_unicycle "(35)"
    steering_paper_equation_36_equations_of_motion_of_the_unicycle "(36)"
    steering_paper_equation_39_steady_motion_of_the_unicycle_in_pseudo_velocities "(39)"
    steering_paper_equation_40_steady_motion_of_the_unicycle_in_yaw_and_pitch_rate "(40)"
    steering_paper_equation_41_pitch_rate_and_place_of_the_mass_of_a_turning_unicycle "(41)"
    steering_paper_equation_43_straight_rolling_of_the_unicycle "(43)"
    steering_paper_equation_44_turning_upright "(44)"
    steering_paper_equation_45_steady_motion_without_pitch_rate "(45)"
    steering_paper_equation_47_height_of_the_sliding_mass "(47)"
    steering_paper_equation_48_and_appendix_c_linear_unicycle "(48), appendix C"
    steering_paper_equation_49_characteristic_polynomial_of_the_unicycle "(49)"
    steering_paper_equation_50_state_matrix_in_straight_rolling "(50)"
    steering_paper_equations_51_and_52_characteristic_polynomial_in_straight_rolling "(51), (52)"
    steering_paper_equation_53_where_b_and_c_change_sign "(53)"
    steering_paper_equation_55_input_matrix_in_straight_rolling "(55)"
    steering_paper_equations_58_and_59_the_angular_velocity_follows_the_tilt "(58), (59)"
    steering_paper_equation_60_reduced_system_with_2 "(60)"
    steering_paper_equation_73_from_the_tilted_frame_to_the_ground "(73)"
    steering_paper_equation_76_angular_velocity_of_the_wheel "(76)"
    steering_paper_equation_79_generalised_velocities_from_pseudo_velocities "(79)"
    steering_paper_equation_81_accelerations_in_the_tilted_frame "(81)"
    steering_paper_equation_82_acceleration_energy_of_the_wheel "(82)"
    steering_paper_equation_83_appell_s_equations "(83)"
    steering_paper_equation_85_pseudo_forces_on_the_wheel "(85)"
    steering_paper_equation_86_pseudo_accelerations_of_the_wheel "(86)"
    steering_paper_equation_88_acceleration_of_the_sliding_mass "(88)"
    steering_paper_equation_89_acceleration_energy_of_the_unicycle "(89)"
    steering_paper_equation_91_pseudo_forces_on_the_unicycle "(91)"
}

#[test]
fn every_equation_has_its_test() {
    for equation in EQUATIONS.iter() {
        assert!(
            TESTED.contains(&equation.number.as_str()),
            "{}",
            equation.number
        );
    }
}

#[test]
fn a_wrong_formula_is_told_with_both_values() {
    let differences = Wheel.paper().differences("zG = R*sin(th)", &[]);
    assert_eq!(differences.len(), 1);
    assert!(differences[0].contains("zG = R*sin(th)"), "{differences:?}");
    let missing = Wheel.paper().matrix_differences("A41 = 1", &[]);
    assert!(
        missing.iter().any(|line| line.starts_with("A62 = 0")),
        "{missing:?}"
    );
}

#[test]
fn linear_equations_under_conditions_are_those_of_the_special_motion() {
    for (mechanism, number, conditions) in [
        (
            "rolling_wheel",
            "(25)",
            &[("th", "0"), ("Pd", "0"), ("psi", "0")][..],
        ),
        ("rolling_wheel", "(29)", &[("th", "0"), ("Fd", "0")]),
        (
            "unicycle",
            "(50)",
            &[("th", "0"), ("r", "0"), ("Pd", "0"), ("psi", "0")],
        ),
    ] {
        let mut paper = Paper::steering(shipped::mechanism(mechanism).clone());
        paper.linearise(conditions);
        let entries = equation(number).claims[0].formulas.text();
        let differences = paper.matrix_differences(entries, &[]);
        assert!(differences.is_empty(), "{}", differences.join("\n"));
        paper.assert("steady_w1d = 0");
    }
}

#[test]
fn a_wheel_with_any_axisymmetric_inertia_follows_the_general_equations() {
    Paper::steering(shipped::mechanism("axisymmetric_wheel").clone()).assert(
        "w1d = ((1 + k_2)*w2*w3 - k_1*w3**2*tan(th) + g/R*sin(th))/(1 + k_1)
         w2d = -w1*w3/(1 + k_2)
         w3d = w1*(k_1*w3*tan(th) - k_2*w2)/k_1",
    );
}

#[test]
fn the_lateral_acceleration_is_also_the_short_row_of_appell() {
    let mut paper = Unicycle.paper();
    let before = paper.scope.clone();
    let solved = paper.derived("w1d");
    paper.scope.define("solved", solved);
    paper.assert("sd = R*solved + r*w1**2 - R*w2*w3 + r*w3**2 - g*sin(th) + u/m0");
    paper.scope = before;
}

#[test]
fn velocity_of_the_sliding_mass_in_the_tilted_frame() {
    Unicycle.paper().assert(
        "vA1 = R*w2 - r*w3
         vA2 = -R*w1 + s
         vA3 = r*w1",
    );
}

#[test]
fn the_energy_of_the_unicycle_grows_by_the_power_of_the_actuator() {
    Unicycle.paper().assert(
        "V = (m + m0)*g*R*cos(th) + m0*g*r*sin(th)
         power = u*s
         energy_rate = u*s",
    );
    Wheel.paper().assert(
        "V = m*g*R*cos(th)
         energy_rate = 0",
    );
}
