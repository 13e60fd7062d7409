//! Laws that compute inputs from the equations of motion, against what they promise: errors that are those of
//! an oscillator, and rest.

use appell::{Method, Model, Motion};

/// Two links in a vertical plane, a motor at each joint.
const ARM: &str = r#"
[mechanism]
name = "arm"
title = "Two links"

[parameters]
m1 = { value = 2, unit = "kg" }
m2 = { value = 1, unit = "kg" }
l = { value = 0.5, unit = "m" }
I = { value = 0.03, unit = "kg*m^2" }
c = { value = 0.1, unit = "N*m*s/rad" }

[coordinates]
q1 = { unit = "rad", initial = 0.4 }
q2 = { unit = "rad", initial = -0.9 }

[inputs]
tau1 = { unit = "N*m" }
tau2 = { unit = "N*m" }

[frames]
upper = { parent = "ground", about_axis = "-y", by = "q1" }
lower = { parent = "upper", about_axis = "-y", by = "q2" }

[points]
G1 = { from = "O", in = "upper", at = ["l/2", 0, 0] }
E = { from = "O", in = "upper", at = ["l", 0, 0] }
G2 = { from = "E", in = "lower", at = ["l/2", 0, 0] }

[bodies]
upper = { frame = "upper", centre = "G1", mass = "m1", inertia = { in = "upper", diagonal = ["I", "I", "I"] } }
lower = { frame = "lower", centre = "G2", mass = "m2", inertia = { in = "lower", diagonal = ["I", "I", "I"] } }

[pseudo_velocities]
w1 = "dot(q1)"
w2 = "dot(q2)"

[loads]
weight = { kind = "gravity", down = "-z", acceleration = "9.81 [m/s^2]" }
slack = { kind = "damper", coordinate = "q2", damping = "c" }
drive1 = { kind = "generalized", coordinate = "q1", force = "tau1" }
drive2 = { kind = "generalized", coordinate = "q2", force = "tau2" }
"#;

const FOLLOW: &str = r#"
law = "computed torque"
inputs = ["tau1", "tau2"]
follow = { q1 = "0.3*sin(2*t)", q2 = "0.1*t^2 - 0.5" }
natural_frequency = 6
damping_ratio = 1
"#;

/// Columns of a motion under a law.
fn columns<const N: usize>(spec: &str, law: &str, names: [&str; N]) -> Vec<[f64; N]> {
    let model = Model::from_spec(spec).unwrap_or_else(|error| panic!("{error}"));
    let mut motion = Motion::new(1.5).feedback(law);
    motion.method = Method::Dop853;
    (motion.options.rtol, motion.options.atol) = (1e-11, 1e-11);
    let done = model
        .simulate(&motion)
        .unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(done.failure, None);
    let columns = names.map(|name| match name {
        "t" => done.trajectory.times().to_vec(),
        name => done.trajectory.column(name).unwrap(),
    });
    (0..columns[0].len())
        .map(|row| std::array::from_fn(|place| columns[place][row]))
        .collect()
}

/// The solution of ë + 2ωė + ω²e = 0.
fn critically_damped(t: f64, frequency: f64, [e, rate]: [f64; 2]) -> f64 {
    (e + (rate + frequency * e) * t) * (-frequency * t).exp()
}

fn assert_near(got: f64, wanted: f64, tolerance: f64, t: f64) {
    assert!(
        (got - wanted).abs() < tolerance,
        "{got} against {wanted} at {t}"
    );
}

#[test]
fn errors_under_computed_torque_are_those_of_an_oscillator() {
    let rows = columns(ARM, FOLLOW, ["t", "q1", "q2"]);
    for &[t, q1, q2] in &rows {
        let e1 = critically_damped(t, 6.0, [0.4, -0.6]);
        let e2 = critically_damped(t, 6.0, [-0.4, 0.0]);
        assert_near(q1, 0.3 * (2.0 * t).sin() + e1, 1e-8, t);
        assert_near(q2, 0.1 * t * t - 0.5 + e2, 1e-8, t);
    }
    assert!(rows.len() > 100);
}

#[test]
fn a_law_that_believes_in_another_mass_is_off() {
    let believes = format!("{FOLLOW}believes = {{ m2 = \"1.5kg\" }}\n");
    let rows = columns(ARM, &believes, ["t", "q1"]);
    let &[t, q1] = rows.last().unwrap();
    let off = q1 - 0.3 * (2.0 * t).sin();
    assert!(off.abs() > 0.01 && off.abs() < 0.5, "{off}");
}

#[test]
fn compensated_gravity_leaves_an_arm_at_rest() {
    let law = "law = \"gravity compensation\"\ninputs = [\"tau1\", \"tau2\"]\n";
    for [q1, q2] in columns(ARM, law, ["q1", "q2"]) {
        assert_near(q1, 0.4, 1e-12, 0.0);
        assert_near(q2, -0.9, 1e-12, 0.0);
    }
}

/// A mass on a rail has a constant acceleration while its force is held.
#[test]
fn a_sampled_law_holds_what_it_computed() {
    let rail = r#"
mechanism = { name = "rail", title = "A mass on a rail" }
parameters.m = { value = 3, unit = "kg" }
coordinates.q = { unit = "m", initial = 0.2 }
inputs.F = { unit = "N" }
points.C = { from = "O", in = "ground", at = ["q", 0, 0] }
bodies.mass = { centre = "C", mass = "m" }
pseudo_velocities.v = "dot(q)"
loads.drive = { kind = "generalized", coordinate = "q", force = "F" }
"#;
    let law = r#"
law = "computed torque"
inputs = ["F"]
follow = { q = "0.1*t" }
natural_frequency = 8
sampled_ms = 50
delay_ms = 20
"#;
    let rows = columns(rail, law, ["t", "q", "v"]);
    let (period, delay) = (0.05, 0.02);
    let mut sampled = [[0.2, 0.0]];
    let mut acceleration = 0.0;
    for k in 0..30 {
        let start = f64::from(k) * period;
        let [[q, v]] = sampled;
        let next = -16.0 * (v - 0.1) - 64.0 * (q - 0.1 * start);
        let at = |t: f64| {
            let (before, after) = (t.min(delay), (t - delay).max(0.0));
            let turned = v + acceleration * before;
            [
                q + v * before
                    + 0.5 * acceleration * before * before
                    + turned * after
                    + 0.5 * next * after * after,
                turned + next * after,
            ]
        };
        for &[t, q, v] in rows
            .iter()
            .filter(|row| (start..start + period).contains(&row[0]))
        {
            let [wanted_q, wanted_v] = at(t - start);
            assert_near(q, wanted_q, 1e-9, t);
            assert_near(v, wanted_v, 1e-8, t);
        }
        (sampled, acceleration) = ([at(period)], next);
    }
    assert!(rows.len() > 100);
}

#[test]
fn a_cart_follows_while_its_pole_swings_freely() {
    let cart = r#"
[mechanism]
name = "cart"
title = "Cart with a pole"

[parameters]
m = { value = 0.5, unit = "kg" }
l = { value = 0.4, unit = "m" }

[coordinates]
x = { unit = "m", initial = 0.2 }
theta = { unit = "rad", initial = 1 }

[inputs]
F = { unit = "N" }
wind = { unit = "N" }

[frames]
pole = { parent = "ground", about_axis = "y", by = "theta" }

[points]
C = { from = "O", in = "ground", at = ["x", 0, 0] }
P = { from = "C", in = "pole", at = [0, 0, "l"] }

[bodies]
cart = { centre = "C", mass = "2*m" }
bob = { centre = "P", mass = "m" }

[pseudo_velocities]
v = "dot(x)"
omega = "dot(theta)"

[loads]
weight = { kind = "gravity", down = "-z", acceleration = "9.81 [m/s^2]" }
drive = { kind = "generalized", coordinate = "x", force = "F" }
gust = { kind = "force", on = "P", in = "ground", vector = ["wind", 0, 0] }
"#;
    let law = r#"
law = "computed torque"
inputs = ["F"]
follow = { x = 0 }
natural_frequency = 4
"#;
    let model = Model::from_spec(cart).unwrap();
    let mut motion = Motion::new(1.0).feedback(law).input("wind", "0.3*sin(5*t)");
    (motion.options.rtol, motion.options.atol) = (1e-11, 1e-11);
    let done = model
        .simulate(&motion)
        .unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(done.failure, None);
    let x = done.trajectory.column("x").unwrap();
    for (&t, &x) in done.trajectory.times().iter().zip(&x) {
        assert_near(x, critically_damped(t, 4.0, [0.2, 0.0]), 1e-8, t);
    }
    let theta = done.trajectory.column("theta").unwrap();
    assert!((theta.last().unwrap() - 1.0).abs() > 0.5, "the pole falls");
}

#[test]
fn what_is_wrong_with_a_law_is_told_at_its_place() {
    let model = Model::from_spec(ARM).unwrap();
    let refused = |law: &str| {
        let error = model.simulate(&Motion::new(1.0).feedback(law));
        error.map(|_| ()).unwrap_err().to_string()
    };
    for (law, told) in [
        (
            FOLLOW.replace("computed", "computer"),
            "there is no law `computer torque`",
        ),
        (
            FOLLOW.replace("q1 = \"0.3*sin(2*t)\", ", ""),
            "1 coordinate for 2 inputs",
        ),
        (
            FOLLOW.replace("natural_frequency = 6", ""),
            "the key `natural_frequency` is missing",
        ),
        (
            FOLLOW.replace("= 6", "= -6"),
            "`natural_frequency` must be positive",
        ),
        (
            FOLLOW.replace("q1 =", "w1 ="),
            "no pseudo-velocity is the rate of `w1`",
        ),
        (format!("{FOLLOW}gains = [1]"), "unknown key `gains`"),
        (
            format!("{FOLLOW}believes = {{ m3 = 1 }}"),
            "there is no parameter `m3`",
        ),
        (
            "law = \"gravity compensation\"".to_owned(),
            "the key `inputs` is missing",
        ),
    ] {
        let message = refused(&law);
        assert!(message.contains(told), "{told}: {message}");
    }
}
