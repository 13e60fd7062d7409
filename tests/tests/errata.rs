//! Each erratum that is a formula: what is printed is not derived, what is right is. The page
//! `docs/errata.md` is written from the same table.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use std::fmt::Write as _;

use appell_tests::errata::{ERRATA, Evidence, Source};
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

/// Runs the comparison of a test: the correct formula holds, and the printed one does not.
fn check(test: &str) {
    let mut found = 0;
    for erratum in ERRATA.iter() {
        let Evidence::Test {
            test: name,
            comparison,
        } = &erratum.evidence
        else {
            continue;
        };
        if name == test {
            let [printed, right] = comparison.verdicts();
            assert!(
                right,
                "{}: the corrected formula is not the derived one",
                erratum.equation
            );
            assert!(
                !printed,
                "{}: the printed formula is the derived one, no erratum",
                erratum.equation
            );
            found += 1;
        }
    }
    assert!(found > 0, "no erratum names the test `{test}`");
}

/// The table as a page.
fn markdown() -> String {
    let mut page = String::from(
        "# Errata of the papers\n\n\
         Passages in which a paper differs from the equations of its mechanism. The papers were read \
         as\nrecognised text, so a garbled formula is not always the authors'. This page is \
         written by\n`tests/tests/errata.rs` from `papers/src/errata.toml`: a row with a test is \
         shown by the identity\ntest, which compares functions and not numbers. The printed form \
         fails it, the right one passes.\n",
    );
    for (source, title) in [
        (
            Source::Steering,
            "Steering Control of an Autonomous Unicycle",
        ),
        (
            Source::Euc,
            "Experimental Model Identification of the Longitudinal Dynamics of an Electric Unicycle with a Human Rider",
        ),
    ] {
        // Writing to a string cannot fail.
        let _ = write!(
            page,
            "\n## {title}\n\n| place | printed | right | cause | evidence |\n|---|---|---|---|---|\n"
        );
        for e in ERRATA.iter().filter(|e| e.source == source) {
            let evidence = match &e.evidence {
                Evidence::Test { test, .. } => format!("test `{test}`"),
                Evidence::Context { context } => context.clone(),
            };
            let _ = writeln!(
                page,
                "| {} | {} | {} | {} | {evidence} |",
                e.equation,
                e.printed,
                e.right,
                e.origin.words()
            );
        }
    }
    page
}

#[test]
fn every_erratum_with_a_formula_has_its_test() {
    for erratum in ERRATA.iter() {
        if let Evidence::Test { test, .. } = &erratum.evidence {
            assert!(
                TESTS.contains(&test.as_str()),
                "{}: no test `{test}`",
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
    for erratum in ERRATA.iter() {
        let Evidence::Context { context } = &erratum.evidence else {
            continue;
        };
        for name in context.split('`').skip(1).step_by(2) {
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
