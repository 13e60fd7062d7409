//! The spec that has what was found, beside the same recordings.

#![expect(clippy::unwrap_used, reason = "a test may stop here")]

use crate::common::{Folder, SWING, pendulum, swing};
use appell_gap::diagnose::{Options, diagnose};
use appell_recordings::Spec;

/// What a value is off by the digits that are written, in its deviations; and these themselves.
const WRITTEN: f64 = 0.01;

#[test]
fn a_size_that_was_found_is_a_parameter_with_its_deviation_as_tolerance() {
    let folder = Folder::new();
    folder.write("recording.toml", pendulum(SWING, &["a.csv"], &[]));
    folder.write("a.csv", swing(300, 1, 1e-3));
    let mut effects = appell_gap::effects::shipped().unwrap();
    effects.retain(|effect| effect.name == "spring");
    let set = folder.read().unwrap();
    let report = diagnose(&set, &effects, &Options::default(), |_| ()).unwrap();
    let mut which = report.which.iter();
    let found = which.find(|one| one.effects == ["spring@theta"]).unwrap();
    let changes = found.changes.as_ref().unwrap();
    let better = Spec {
        file: "better.toml".to_owned(),
        text: changes.improved(&set.spec.text, "found").unwrap(),
    };
    let set = set.rebound(&better).unwrap();
    let mut own = set.mechanism.parameters.iter();
    let place = own.position(|one| one.label.name == "spring_theta_stiffness");
    let stiffness = set.parameters[place.unwrap()];
    let told = &found.parameters[0];
    let off = (stiffness.value - told.value).abs();
    assert!(off < WRITTEN * told.std, "{stiffness:?} for {told:?}");
    let ratio = stiffness.std.unwrap() / told.std;
    assert!((ratio - 1.0).abs() < WRITTEN, "{stiffness:?} for {told:?}");
}
