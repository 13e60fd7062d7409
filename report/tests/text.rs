//! Readable numbers.

use appell_report::text::{horizon, number, short};

#[test]
fn a_number_has_six_significant_digits_on_both_sides_of_1() {
    for (value, text) in [
        (0.0, "0"),
        (1.0, "1.00000"),
        (-1.5, "-1.50000"),
        (123_456.7, "123457"),
        (0.980_931_4, "0.980931"),
        (0.05, "0.0500000"),
        (2.8e-4, "0.000280000"),
        (0.000_123_456, "0.000123456"),
        (-0.000_123_456, "-0.000123456"),
        (1e-4, "0.000100000"),
        (9.9e-5, "9.900e-5"),
        (2.5e6, "2.500e6"),
    ] {
        assert_eq!(number(value), text);
    }
}

#[test]
fn a_short_number_has_three_significant_digits() {
    for (value, text) in [
        (0.0, "0"),
        (0.41234, "0.412"),
        (-0.041_234, "-0.0412"),
        (1234.5, "1234"),
        (2.5e-7, "2.5e-7"),
        (f64::INFINITY, "∞"),
    ] {
        assert_eq!(short(value), text);
    }
}

#[test]
fn a_horizon_is_a_step_a_time_or_the_whole_run() {
    let texts = [0.0, 0.1, 1.0, f64::INFINITY].map(horizon);
    assert_eq!(texts, ["one step", "0.1 s", "1 s", "free run"]);
}
