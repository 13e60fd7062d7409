//! A simulated rig: a carriage of 1 kg with a friction that its model does not have.

mod gear;
pub(crate) mod planted;

use std::fmt::Write as _;

use appell_test_kit::is_full;
use gear::{Gear, moved};
use serde_json::Value;

use crate::support::Folder;

const DESCRIPTION: &str = r#"
mechanism   = "carriage"
description = "simulated rig"
[parameters]
m = { value = 1.0, unit = "kg", std = 0.02 }
[channels]
x = { measures = "x", unit = "m", noise_std = 1e-3 }
F = { input = "F", unit = "N" }
[runs]
fit  = ["a.csv", "b.csv"]
test = ["c.csv"]
"#;

const RUNS: [&str; 3] = ["a.csv", "b.csv", "c.csv"];
/// Rows of a recording, a hundred in a second.
const ROWS: u32 = 800;
/// The same of rigs whose diagnosis takes long, in an ordinary run.
const FEWER_ROWS: u32 = 500;
/// Time for which a force is held, in s.
const HELD: f64 = 0.01;
/// Steps of the simulation in a row.
const STEPS: u32 = 10;

/// Noise of variance 1, the same in every recording of this rig: what is found near a threshold depends on
/// it. The sum of twelve uniform numbers (P. L'Ecuyer's 64-bit congruences).
pub(crate) struct Noise(u64);

impl Noise {
    pub(crate) fn seeded(seed: u64) -> Self {
        Self(seed)
    }

    /// Between zero and one.
    pub(crate) fn uniform(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn next(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

/// A recording under forces that are held, with noise of 1 mm. `advance` gives the position after a force.
fn recording(mut advance: impl FnMut(f64) -> f64, forces: &[f64], noise: &mut Noise) -> String {
    let mut text = "t,x,F\n".to_owned();
    let mut x = 0.0;
    for (row, force) in forces.iter().enumerate() {
        let t = row as f64 / 100.0;
        let _ = writeln!(text, "{t},{},{force}", x + 1e-3 * noise.next());
        x = advance(*force);
    }
    text
}

/// Position and velocity of the carriage; `friction` is a force by velocity.
fn rubbing(friction: impl Fn(f64) -> f64) -> impl FnMut(f64) -> [f64; 2] {
    let (mut x, mut v) = (0.0, 0.0);
    let h = HELD / f64::from(STEPS);
    move |force| {
        for _ in 0..STEPS {
            // The middle of the step, so that the error is of its third order.
            let half = v + 0.5 * h * (force - friction(v));
            x += h * half;
            v += h * (force - friction(half));
        }
        [x, v]
    }
}

/// The motion of the carriage with dry friction that sticks, from stop to stop: while a force is held,
/// all motion between two stops is a parabola.
fn stuck(friction: f64) -> impl FnMut(f64) -> f64 {
    let mut state = [0.0, 0.0];
    move |force| {
        let mut left = HELD;
        while left > 0.0 && (state[1] != 0.0 || force.abs() > friction) {
            let along = if state[1] == 0.0 { force } else { state[1] };
            let acceleration = force - friction * along.signum();
            let stop = -state[1] / acceleration;
            let stops = stop > 0.0 && stop <= left;
            let time = if stops { stop } else { left };
            state = moved(state, acceleration, time);
            if stops {
                state[1] = 0.0;
            }
            left -= time;
        }
        state[0]
    }
}

/// The motion of the carriage with viscous friction under forces that come late: exact, for what is held
/// the velocity decays towards where friction bears the force.
fn sluggish(delay: f64, coefficient: f64) -> impl FnMut(f64) -> f64 {
    let (mut x, mut v, mut before) = (0.0, 0.0, 0.0);
    move |force| {
        for (held, time) in [(before, delay), (force, HELD - delay)] {
            let end = held / coefficient;
            let decayed = (-coefficient * time).exp();
            x += end * time + (v - end) * (1.0 - decayed) / coefficient;
            v = end + (v - end) * decayed;
        }
        before = force;
        x
    }
}

/// The motion of the carriage with dry friction on a rail with a grain, a force by position.
fn grained(friction: f64, grain: f64, per_metre: f64) -> impl FnMut(f64) -> f64 {
    let (mut x, mut v) = (0.0_f64, 0.0_f64);
    let h = HELD / f64::from(STEPS);
    let against =
        move |x: f64, v: f64| friction * (v / 0.02).tanh() + grain * (per_metre * x).sin();
    move |force| {
        for _ in 0..STEPS {
            let half = v + 0.5 * h * (force - against(x, v));
            let middle = x + 0.5 * h * v;
            x += h * half;
            v += h * (force - against(middle, half));
        }
        x
    }
}

/// The motion of the carriage with a part of its mass on a damped spring.
fn swinging(share: f64, rate: f64, damping: f64) -> impl FnMut(f64) -> f64 {
    // Position and lead of the part that swings, and their rates.
    let (mut q, mut v) = ([0.0_f64; 2], [0.0_f64; 2]);
    let h = HELD / f64::from(STEPS);
    move |force| {
        for _ in 0..STEPS {
            let pull = |lead: f64, rate_of_lead: f64| {
                share * (rate * rate * lead + 2.0 * damping * rate * rate_of_lead)
            };
            let accelerations = |lead: f64, rate_of_lead: f64| {
                let pull = pull(lead, rate_of_lead);
                let carriage = (force + pull) / (1.0 - share);
                [carriage, -pull / share - carriage]
            };
            let a = accelerations(q[1], v[1]);
            let half = [v[0] + 0.5 * h * a[0], v[1] + 0.5 * h * a[1]];
            let a = accelerations(q[1] + 0.5 * h * v[1], half[1]);
            for i in 0..2 {
                q[i] += h * half[i];
                v[i] += h * a[i];
            }
        }
        q[0]
    }
}

/// The motion of the carriage with a friction that gives way before it slides: exact while its direction stays.
fn yielding(friction: f64, way: f64) -> impl FnMut(f64) -> f64 {
    let (mut x, mut v, mut strained) = (0.0_f64, 0.0_f64, 0.0_f64);
    let h = HELD / f64::from(STEPS);
    let after = move |strained: f64, moved: f64| {
        let end = moved.signum();
        end + (strained - end) * (-moved.abs() / way).exp()
    };
    move |force| {
        for _ in 0..STEPS {
            let half = v + 0.5 * h * (force - friction * strained);
            let middle = after(strained, 0.5 * h * v);
            x += h * half;
            v += h * (force - friction * middle);
            strained = after(strained, h * half);
        }
        x
    }
}

/// Forces of a run.
fn forces(rows: u32) -> Vec<f64> {
    let force = |t: f64| 2.0 * (3.0 * t).sin() + 1.5 * (7.1 * t).cos();
    (0..rows).map(|row| force(f64::from(row) / 100.0)).collect()
}

/// A rig with a friction.
pub(crate) struct Rig<F> {
    pub(crate) folder: Folder,
    friction: F,
    noise: Noise,
}

impl<F: Fn(f64) -> f64> Rig<F> {
    /// With a data set of three runs.
    pub(crate) fn new(friction: F) -> Self {
        let mut rig = Self {
            folder: Folder::new(),
            friction,
            noise: Noise(7),
        };
        rig.folder.write("recording.toml", DESCRIPTION);
        for name in RUNS {
            rig.record(name, &forces(ROWS));
        }
        rig
    }

    /// Records a run that may be fitted.
    pub(crate) fn record_to_fit(&mut self, name: &str, forces: &[f64]) {
        self.record(name, forces);
        let named = format!("fit  = [\"{name}\", ");
        let description = self.folder.read("recording.toml");
        let description = description.replace("fit  = [", &named);
        self.folder.write("recording.toml", &description);
    }

    fn record(&mut self, name: &str, forces: &[f64]) {
        let mut motion = rubbing(&self.friction);
        let text = recording(|force| motion(force)[0], forces, &mut self.noise);
        self.folder.write(name, &text);
    }
}

/// The report on a spec in which the effect stands says that there is no gap.
pub(crate) fn closed(folder: &Folder, spec: &str) -> Value {
    let asked = ["diagnose", spec, "--data", ".", "--json", "again.json"];
    folder.done(&asked);
    let again = folder.json("again.json");
    assert_eq!(again["verdict"], "no_gap", "{again:#}");
    again
}

/// With viscous friction.
pub(crate) fn viscous(coefficient: f64) -> Folder {
    Rig::new(move |v| coefficient * v).folder
}

/// With dry friction, its sign rounded as filters have to round it.
pub(crate) fn dry(force: f64) -> Folder {
    Rig::new(move |v| force * (v / 0.02).tanh()).folder
}

/// With dry friction and a second sensor, of the velocity; `sensed` gives its readings, row by row.
pub(crate) fn dry_with_two_sensors<S: FnMut(f64) -> f64>(
    friction: f64,
    sensed: impl Fn() -> S,
) -> Folder {
    let (folder, mut noise) = (Folder::new(), Noise(7));
    let second = "F = { input";
    let sensor = format!("v = {{ measures = \"v\", unit = \"m/s\", noise_std = 1e-3 }}\n{second}");
    folder.write("recording.toml", &DESCRIPTION.replace(second, &sensor));
    for name in RUNS {
        let mut motion = rubbing(|v| friction * (v / 0.02).tanh());
        let (mut sensed, mut state) = (sensed(), [0.0; 2]);
        let mut text = "t,x,v,F\n".to_owned();
        for (row, force) in forces(FEWER_ROWS).into_iter().enumerate() {
            let [x, v] = [state[0], sensed(state[1])].map(|value| value + 1e-3 * noise.next());
            let _ = writeln!(text, "{},{x},{v},{force}", row as f64 / 100.0);
            state = motion(force);
        }
        folder.write(name, &text);
    }
    folder
}

/// A low-pass filter of first order from rest, exact for straight lines between rows.
pub(crate) fn low_pass(time_constant: f64) -> impl FnMut(f64) -> f64 {
    let (mut before, mut behind) = (0.0, 0.0);
    let decayed = (-HELD / time_constant).exp();
    move |value| {
        let late = time_constant * (value - before) / HELD;
        behind = late + (behind - late) * decayed;
        before = value;
        value - behind
    }
}

/// With dry friction, and a rail whose grain no library knows.
pub(crate) fn on_grain(friction: f64, grain: f64, per_metre: f64) -> Folder {
    moving(|| grained(friction, grain, per_metre))
}

/// With a load that swings, of a share of the mass.
pub(crate) fn with_load(share: f64, rate: f64, damping: f64) -> Folder {
    moving(|| swinging(share, rate, damping))
}

/// With dry friction that gives way before it slides.
pub(crate) fn on_a_belt(friction: f64, way: f64) -> Folder {
    moving(|| yielding(friction, way))
}

/// With dry friction that sticks.
pub(crate) fn sticking(friction: f64) -> Folder {
    moving(|| stuck(friction))
}

/// With play in its gear, the motor with a part of the mass.
pub(crate) fn geared(share: f64, half_gap: f64) -> Folder {
    moving(|| {
        let mut gear = Gear::new(share, half_gap);
        move |force| gear.advance(force, HELD)
    })
}

/// The same with the encoder on the motor.
pub(crate) fn geared_behind_its_encoder(share: f64, half_gap: f64) -> Folder {
    moving(|| {
        let mut gear = Gear::new(share, half_gap);
        move |force| {
            gear.advance(force, HELD);
            gear.motor()
        }
    })
}

/// With a force that comes late by a part of a row, and with viscous friction.
pub(crate) fn late(delay: f64, coefficient: f64) -> Folder {
    moving(|| sluggish(delay, coefficient))
}

/// The data set of a rig that moves so.
fn moving<A: FnMut(f64) -> f64>(rig: impl Fn() -> A) -> Folder {
    let (folder, mut noise) = (Folder::new(), Noise(7));
    folder.write("recording.toml", DESCRIPTION);
    let rows = if is_full() { ROWS } else { FEWER_ROWS };
    for name in RUNS {
        folder.write(name, &recording(rig(), &forces(rows), &mut noise));
    }
    folder
}
