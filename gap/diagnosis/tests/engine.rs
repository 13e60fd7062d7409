//! The numbers of one report, beside the version of the engine that finds them.

#![expect(clippy::unwrap_used, reason = "a test may stop here")]

use std::fmt::Write as _;

use crate::common::{Folder, SWING, pendulum, swing};
use appell_gap::diagnose::{ENGINE, Options, diagnose};

/// Another text here means another engine: raise [`ENGINE`] and diagnose the cases of `tests/blind` anew.
const NUMBERS: &str = "\
engine 30
viscous_friction@theta+spring@theta 15.2
spring@theta 9.6
unknown NaN
 0.0
coulomb_friction@theta+spring@theta -40.3
";

#[test]
fn a_report_with_other_numbers_is_one_of_another_engine() {
    let folder = Folder::new();
    folder.write(
        "recording.toml",
        pendulum(SWING, &["a.csv", "b.csv"], &["c.csv"]),
    );
    for (seed, name) in [(1, "a.csv"), (1000, "b.csv"), (2000, "c.csv")] {
        folder.write(name, swing(300, seed, 1e-3));
    }
    let mut effects = appell_gap::effects::shipped().unwrap();
    let few = ["viscous_friction", "coulomb_friction", "spring"];
    effects.retain(|effect| few.contains(&effect.name.as_str()));
    let set = folder.read().unwrap();
    let report = diagnose(&set, &effects, &Options::default(), |_| ()).unwrap();
    let mut numbers = format!("engine {ENGINE}\n");
    for one in &report.which {
        let log = one.log_bayes_factor.unwrap_or(f64::NAN);
        writeln!(numbers, "{} {log:.1}", one.effects.join("+")).unwrap();
    }
    assert_eq!(numbers, NUMBERS);
}
