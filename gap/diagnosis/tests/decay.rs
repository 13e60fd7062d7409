//! A swing that decays to rest, where one step ahead more is seen than matters.

#![expect(clippy::unwrap_used, reason = "a test may stop here")]

use std::fmt::Write as _;

use crate::common::Folder;
use appell_gap::diagnose::{GapVerdict, Options, diagnose};

const RECORDED: &str = r#"mechanism = "pendulum"
[parameters]
m = { value = 0.14,   unit = "kg",     std = 0.015 }
l = { value = 0.135,  unit = "m",      std = 0.01 }
I = { value = 0.0004, unit = "kg m^2", std = 0.0002 }
g = { value = 9.81,   unit = "m/s^2",  std = 0.002 }
[channels]
theta = { measures = "theta", unit = "rad", noise_std = 4.5e-5 }
[runs]
fit = ["a.csv"]
test = ["b.csv"]
"#;

/// Dry friction of the bearing in N m, and the way in rad over which it turns round.
const FRICTION: f64 = 4.7e-4;
const WAY: f64 = 1e-3;

/// Let go at an angle; the bearing gives way a little before it slides (P. R. Dahl), and an encoder shows whole steps.
fn decay(begin: f64, seconds: f64) -> String {
    let (gravity, inertia) = (0.14 * 9.81 * 0.148, 0.003_12);
    let (step, each) = (2e-5, 200);
    let encoder = 1.57e-4;
    let mut text = "t,theta\n".to_owned();
    let (mut angle, mut rate, mut bent) = (begin, 0.0_f64, 0.0_f64);
    let mut t = 0.0;
    while t < seconds {
        writeln!(text, "{t:.4},{:.7}", (angle / encoder).round() * encoder).unwrap();
        for _ in 0..each {
            bent += step * rate * (1.0 - rate.signum() * bent) / WAY;
            rate -= step * (gravity * angle.sin() + FRICTION * bent) / inertia;
            angle += step * rate;
            t += step;
        }
    }
    text
}

/// One step ahead the bearing that gives way is a law which nobody has named; over swings dry friction leaves hardly
/// anything of the gap.
#[test]
fn what_hardly_matters_over_many_swings_does_not_hide_dry_friction() {
    let folder = Folder::new();
    folder.write("recording.toml", RECORDED);
    folder.write("a.csv", decay(-0.066, 3.0));
    folder.write("b.csv", decay(0.07, 4.5));
    let set = folder.read().unwrap();
    let effects = appell_gap::effects::shipped().unwrap();
    let report = diagnose(&set, &effects, &Options::default(), |_| ()).unwrap();
    let first = &report.which[0];
    assert_eq!(first.effects, ["coulomb_friction@theta"]);
    assert_eq!(report.verdict, GapVerdict::Explained);
    let force = &first.parameters[0];
    // Only ratios to the mass are told: its tolerance is a tenth.
    let off = (force.value - FRICTION).abs();
    assert!(off < 2.0 * force.std && off < 0.2 * FRICTION, "{force:?}");
    let closed = report.how_far.unwrap().closed;
    assert!(closed > 0.9, "{closed}");
}
