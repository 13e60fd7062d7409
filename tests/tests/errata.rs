//! Each erratum that is a formula: what is printed is not derived, what is right is. The page
//! `docs/errata.md` is written from the same table.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_tests::errata::{ERRATA, Evidence, check, markdown};
use appell_tests::shipped::workspace;

/// One test per name, and the list of the names.
macro_rules! errata {
    ($($name:ident)*) => {
        const TESTS: &[&str] = &[$(stringify!($name)),*];
        $(
            #[test]
            fn $name() {
                check(stringify!($name));
            }
        )*
    };
}

errata! {
    equation_21_has_the_pitch_rate_in_two_terms
    equation_35_defines_the_first_pseudo_velocity_as_tilt_rate
    equation_36_line_5_has_no_mass_in_its_prefactor
    equation_36_line_5_has_the_third_pseudo_velocity_squared
    equation_36_line_5_has_the_sliding_mass_in_its_coriolis_term
    equation_36_last_line_is_the_lateral_velocity
    equation_50_has_gravity_in_entry_54
    equation_50_has_the_forward_speed_in_entry_107
    equation_50_has_the_radius_in_entry_92
    equation_55_has_both_masses_in_the_denominator
    equation_89_couples_tilt_and_slider_by_one_mass_times_radius
    appendix_c_entry_13_has_the_pitch_rate_in_two_terms
    appendix_c_entry_14_has_gravity
    appendix_c_entry_16_has_products_of_yaw_and_pitch_rate
    appendix_c_entry_56_has_products_of_yaw_and_pitch_rate
    appendix_c_entry_21_has_the_pitch_rate
    appendix_c_entry_52_is_a_quotient
    appendix_c_names_entry_97_by_the_name_of_entry_91
    appendix_c_entry_107_is_cut
    equation_10_depends_on_the_angular_acceleration_of_the_rider
    equation_13_has_rates_of_the_rider_angle
}

#[test]
fn every_erratum_with_a_formula_has_its_test() {
    for erratum in ERRATA {
        if let Evidence::Test(name, _) = erratum.evidence {
            assert!(
                TESTS.contains(&name),
                "{}: no test `{name}`",
                erratum.equation
            );
        }
    }
}

#[test]
fn a_test_that_an_erratum_mentions_exists() {
    let folder = workspace().join("tests/tests");
    let sources: String = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| std::fs::read_to_string(entry.unwrap().path()).unwrap_or_default())
        .collect();
    for erratum in ERRATA {
        let Evidence::Context(words) = erratum.evidence else {
            continue;
        };
        for name in words.split('`').skip(1).step_by(2) {
            assert!(
                sources.contains(name),
                "{}: no test `{name}`",
                erratum.equation
            );
        }
    }
}

/// `UPDATE_ERRATA=1 cargo test -p appell-tests errata` writes the page.
#[test]
fn the_page_of_errata_is_the_table() {
    let file = workspace().join("docs/errata.md");
    let fresh = markdown();
    if std::env::var_os("UPDATE_ERRATA").is_some() {
        std::fs::write(&file, &fresh).unwrap();
    }
    let committed = std::fs::read_to_string(&file).unwrap_or_default();
    assert!(
        committed == fresh,
        "docs/errata.md is not the table; write it with UPDATE_ERRATA=1"
    );
}
