//! Signs of channels that the motion contradicts.

#![expect(clippy::unwrap_used, reason = "a test may stop here")]

use std::fmt::Write as _;

use crate::between_rows::{SPEC, run};
use crate::common::Folder;
use appell_gap::effects::EffectModel;
use appell_gap::units::doubts;

/// What is asked about a driven oscillator, some of whose columns have the other sign.
fn asked(reversed: [bool; 2], lines: [&str; 2]) -> Vec<String> {
    let sign = |is: bool| if is { -1.0 } else { 1.0 };
    let table = run(7, 0.02, true);
    let mut rows = table.lines();
    let mut text = format!("{}\n", rows.next().unwrap());
    for row in rows {
        let mut numbers = row.split(',').map(|cell| cell.parse::<f64>().unwrap());
        let [t, y, u] = [(); 3].map(|()| numbers.next().unwrap());
        let [y, u] = [sign(reversed[0]) * y, sign(reversed[1]) * u];
        writeln!(text, "{t},{y},{u}").unwrap();
    }
    let [of_y, of_u] = lines;
    let folder = Folder::new();
    folder
        .write("oscillator.toml", SPEC)
        .write("a.csv", text)
        .write(
            "recording.toml",
            format!(
                "mechanism = \"oscillator.toml\"\n[channels]\n{of_y}\n{of_u}\n[runs]\nfit = [\"a.csv\"]\n"
            ),
        );
    let set = folder.read().unwrap();
    let model = EffectModel::new(&set.spec, Vec::new()).unwrap();
    let doubts = doubts(&set, model.with(&[]));
    doubts.into_iter().map(|doubt| doubt.message).collect()
}

const PLAIN: [&str; 2] = [
    "y = { measures = \"y\", unit = \"m\" }",
    "u = { input = \"u\", unit = \"N\" }",
];

#[test]
fn a_reversed_channel_and_a_reversed_input_are_asked_about() {
    assert!(asked([false, false], PLAIN).is_empty());
    for reversed in [[true, false], [false, true]] {
        let asked = asked(reversed, PLAIN);
        assert_eq!(asked.len(), 1, "{asked:?}");
        // Either of them would do.
        assert!(
            asked[0].contains("`y`") && asked[0].contains("`u`"),
            "{asked:?}"
        );
        assert!(asked[0].contains("reversed = true"), "{asked:?}");
    }
}

#[test]
fn a_sign_that_is_stated_or_that_no_motion_tells_is_not_asked_about() {
    let stated = [
        PLAIN[0],
        "u = { input = \"u\", unit = \"N\", reversed = true }",
    ];
    assert!(asked([false, true], stated).is_empty());
    let vouched = [
        "y = { measures = \"y\", unit = \"m\", reversed = false }",
        "u = { input = \"u\", unit = \"N\", reversed = false }",
    ];
    assert!(asked([false, true], vouched).is_empty());
    // The whole rig as in a mirror.
    assert!(asked([true, true], PLAIN).is_empty());
    // Nothing but the motion is known, and that has a mirror image.
    let unknown = [PLAIN[0], "u = { unit = \"N\" }"];
    assert!(asked([true, false], unknown).is_empty());
}
