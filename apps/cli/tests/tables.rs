//! `appell simulate --inputs`: what runs between the rows of a table.

use std::fmt::Write as _;

use crate::support::{Folder, assert_close, number};

#[test]
fn rows_of_a_continuous_signal_are_joined_by_lines_where_that_is_asked_for() {
    let folder = Folder::new();
    // A force that rises from 0 to 4 N in 2 s on 2 kg: v = 2 m/s, x = 4/3 m.
    folder.write("force.csv", "t,F\n0,0\n0.5,1\n2,4\n");
    let end = |how: &[&str]| {
        let mut arguments = vec![
            "simulate",
            "carriage",
            "--set",
            "m=2000g",
            "--inputs",
            "force.csv",
            "--t-end-s",
            "2",
            "--json",
            "out.json",
        ];
        arguments.extend(how);
        folder.done(&arguments);
        let out = folder.json("out.json");
        (number(&out, "final_state/v"), number(&out, "final_state/x"))
    };
    let (v, x) = end(&["--interpolation", "linear"]);
    assert_close(v, 2.0, 1e-12, "v");
    assert_close(x, 4.0 / 3.0, 1e-12, "x");
    // A spline through a straight line is that line.
    assert_close(end(&["--interpolation", "cubic"]).0, 2.0, 1e-12, "v");
    // Held: nothing for half a second, then 1 N.
    assert_close(end(&["--interpolation", "hold"]).0, 0.75, 1e-12, "v");
    assert_close(end(&[]).0, 0.75, 1e-12, "v");
}

#[test]
fn a_smooth_input_without_a_stated_interpolation_is_remarked_on() {
    let folder = Folder::new();
    let mut rows = String::new();
    for row in 0..100 {
        let (t, force) = (f64::from(row) * 0.02, (f64::from(row) * 0.1).sin());
        let _ = writeln!(rows, "{t},{force}");
    }
    folder.write("force.csv", &format!("t,F\n{rows}"));
    let run = |how: &[&str]| {
        let mut arguments = vec![
            "simulate",
            "carriage",
            "--inputs",
            "force.csv",
            "--t-end-s",
            "1.9",
        ];
        arguments.extend(how);
        folder.run(&arguments).stderr
    };
    assert!(run(&[]).contains("half a row late (`F` by 5.43 % of their size)"));
    for how in ["hold", "linear"] {
        assert!(!run(&["--interpolation", how]).contains("half a row"));
    }
}
