//! Steady motions of bodies whose attitude is a quaternion: it turns, and nothing else changes.

use appell::control::Request;
use appell::setup::Assignment;
use appell::steady::{Answer, Branch, Question, Stability, SteadyMotion, Verdict};
use appell::{Method, Model, Motion};

const ATTITUDE: &str = r#"
e0 = { unit = "1" }
e1 = { unit = "1" }
e2 = { unit = "1" }
e3 = { unit = "1" }
"#;

/// A body on a ball joint at its origin, its centre at a distance `l` along z, with what else is given.
fn body(
    [a, b, c]: [f64; 3],
    l: f64,
    components: &str,
    [coordinates, frames, bodies, speeds, rest]: [&str; 5],
) -> String {
    format!(
        r#"
[mechanism]
name = "body"
title = "A body on a ball joint"
[parameters]
m = {{ value = 0.5, unit = "kg" }}
l = {{ value = {l:?}, unit = "m" }}
A = {{ value = {a:?}, unit = "kg*m^2" }}
B = {{ value = {b:?}, unit = "kg*m^2" }}
C = {{ value = {c:?}, unit = "kg*m^2" }}
J = {{ value = 0.002, unit = "kg*m^2" }}
[coordinates]
{ATTITUDE}
{coordinates}
[frames]
body = {{ parent = "ground", quaternion = ["e0", "e1", "e2", "e3"] }}
{frames}
[points]
G = {{ from = "O", in = "body", at = [0, 0, "l"] }}
[bodies]
body = {{ frame = "body", centre = "G", mass = "m", inertia = {{ in = "body", diagonal = ["A", "B", "C"] }} }}
{bodies}
[pseudo_velocities]
w_x = {{ value = "angular_velocity(body, x, {components})", unit = "rad/s" }}
w_y = {{ value = "angular_velocity(body, y, {components})", unit = "rad/s" }}
w_z = {{ value = "angular_velocity(body, z, {components})", unit = "rad/s" }}
{speeds}
{rest}
[outputs]
upright = {{ value = "1 - 2*(e1^2 + e2^2)", unit = "1" }}
across = {{ value = "2*(e2*e3 + e0*e1)", unit = "1" }}
"#
    )
}

const WEIGHT: &str = r#"[loads]
weight = { kind = "gravity", down = "-z", acceleration = "9.81 [m/s^2]" }"#;
const NOTHING: [&str; 5] = [""; 5];
const HEAVY: [&str; 5] = ["", "", "", "", WEIGHT];
/// A rotor about z, without a mass of its own.
const ROTOR: [&str; 4] = [
    r#"q = { unit = "rad" }"#,
    r#"rotor = { parent = "body", about_axis = "z", by = "q" }"#,
    r#"rotor = { frame = "rotor", centre = "G", mass = "0.001 [kg]", inertia = { in = "rotor", diagonal = ["J", "J", "J"] } }"#,
    r#"s = { value = "dot(q)", unit = "rad/s" }"#,
];

fn motions(spec: &str, question: &Question) -> Vec<(SteadyMotion, Stability)> {
    let model = Model::from_spec(spec).unwrap_or_else(|error| panic!("{error}"));
    match model.steady(question) {
        Ok(Answer::Motions(motions)) => motions,
        Ok(Answer::Branches(_)) => Vec::new(),
        Err(error) => panic!("{error}"),
    }
}

/// Holds the deciding eigenvalues, those without negative imaginary parts, against real and imaginary parts.
fn assert_eigenvalues(stability: &Stability, wanted: &[[f64; 2]], tolerance: f64) {
    let found = stability.eigenvalues().into_iter().filter(|z| z.im >= 0.0);
    let mut left: Vec<[f64; 2]> = found.map(|z| [z.re, z.im]).collect();
    let told = format!("{left:?}, not {wanted:?}");
    for [re, im] in wanted {
        let near = |z: &[f64; 2]| (z[0] - re).hypot(z[1] - im) < tolerance;
        let place = left.iter().position(near);
        left.remove(place.unwrap_or_else(|| panic!("{told}")));
    }
    assert!(left.is_empty(), "{told}");
}

#[test]
fn a_top_sleeps_where_it_spins_fast_enough() {
    let (a, c, l, weight) = (0.004_f64, 0.001, 0.1, 0.5 * 9.81);
    let about_joint = a + 0.5 * l * l;
    let critical = (4.0 * about_joint * weight * l).sqrt() / c;
    for (components, turned) in [("body", 1.0), ("ground", 0.0)] {
        let spec = body([a, a, c], l, components, HEAVY);
        for spin in [0.8 * critical, 1.2 * critical] {
            // A ν² - i C n ν = m g l in the ground; the body turns with n.
            let square = c * c * spin * spin - 4.0 * about_joint * weight * l;
            let root = square.abs().sqrt() / (2.0 * about_joint);
            let middle = c * spin / (2.0 * about_joint) - turned * spin;
            let pairs = if square > 0.0 {
                [[0.0, (middle + root).abs()], [0.0, (middle - root).abs()]]
            } else {
                [[root, middle.abs()], [-root, middle.abs()]]
            };
            let question = Question::default().fix("w_z", spin);
            let found = motions(&spec, &question);
            let place = found.iter().position(|(motion, _)| {
                (motion.point.x[3].powi(2) + motion.point.x[6].powi(2) - 1.0).abs() < 1e-9
            });
            let (motion, stability) = &found[place.unwrap()];
            assert_eq!((motion.family, found.len()), (0, 2), "{components}");
            assert_eigenvalues(stability, &pairs, 1e-8 * spin);
            let verdict = [Verdict::Unstable, Verdict::Neutral][usize::from(square > 0.0)];
            assert_eq!((stability.verdict, stability.zeros), (verdict, 1));
            // Hanging, it is stable.
            assert_eq!(found[1 - place.unwrap()].1.verdict, Verdict::Neutral);
        }
    }
}

#[test]
fn a_free_body_turns_stably_about_its_longest_and_shortest_axes() {
    let inertia = [0.02, 0.03, 0.045];
    let spec = body(inertia, 0.0, "body", NOTHING);
    for (axis, name) in ["w_x", "w_y", "w_z"].into_iter().enumerate() {
        let [i, j] = [(axis + 1) % 3, (axis + 2) % 3].map(|k| inertia[k]);
        let own = inertia[axis];
        // Squares of the eigenvalues over that of the speed (L. Euler, 1765).
        let square = (j - own) * (own - i) / (i * j);
        let question = Question::default().fix(name, 5.0);
        let [(_, stability)] = &motions(&spec, &question)[..] else {
            panic!("{name}")
        };
        let root = 5.0 * square.abs().sqrt();
        let (wanted, verdict) = if square > 0.0 {
            (vec![[-root, 0.0], [root, 0.0]], Verdict::Unstable)
        } else {
            (vec![[0.0, root]], Verdict::Neutral)
        };
        assert_eigenvalues(stability, &wanted, 1e-9);
        assert_eq!((stability.verdict, stability.states.len()), (verdict, 3));
    }
}

#[test]
fn a_wheel_steadies_a_satellite_about_its_middle_axis() {
    // Middle axis: z.
    let (inertia, wheel) = ([0.02, 0.045, 0.03], 0.002);
    let [a, b, c] = inertia.map(|i| i + wheel);
    let [coordinates, frames, bodies, speeds] = ROTOR;
    let spec = body(
        inertia,
        0.0,
        "body",
        [coordinates, frames, bodies, speeds, ""],
    );
    for (spin, verdict) in [(0.0, Verdict::Unstable), (80.0, Verdict::Neutral)] {
        let question = Question::default().fix("w_z", 5.0).fix("s", spin);
        let [(_, stability)] = &motions(&spec, &question)[..] else {
            panic!()
        };
        let momentum = c * 5.0 + wheel * spin;
        let square = -(momentum - b * 5.0) * (momentum - a * 5.0) / (a * b);
        let root = square.abs().sqrt();
        let wanted = if square > 0.0 {
            vec![[-root, 0.0], [root, 0.0]]
        } else {
            vec![[0.0, root]]
        };
        assert_eigenvalues(stability, &wanted, 1e-9);
        assert_eq!((stability.verdict, stability.zeros), (verdict, 2));
    }
}

#[test]
fn a_gyroscope_precesses_slowly_and_fast() {
    let (a, c, l, wheel, weight) = (0.004_f64, 0.003, 0.1, 0.002, 0.501 * 9.81);
    let [coordinates, frames, bodies, speeds] = ROTOR;
    let spec = body(
        [a, a, c],
        l,
        "body",
        [coordinates, frames, bodies, speeds, WEIGHT],
    );
    let about_joint = a + wheel + 0.501 * l * l;
    let (upright, spin) = (0.6, 60.0);
    let question = Question::default()
        .fix("s", spin)
        .fix("upright", upright)
        .fix("w_x", 0.0);
    // ((C + J - A) Ω cos θ + J s) Ω = m g l.
    let second = (c + wheel - about_joint) * upright;
    let root = ((wheel * spin).powi(2) + 4.0 * second * weight * l).sqrt();
    let rates = [1.0, -1.0].map(|sign| (-wheel * spin + sign * root) / (2.0 * second));
    for rate in rates {
        // Fast precession is far from rest.
        let near = [("y", 0.8 * rate), ("z", upright * rate)];
        let near = near.iter().fold(spec.clone(), |spec, (axis, speed)| {
            let line = format!("angular_velocity(body, {axis}, body)\"");
            spec.replace(&line, &format!("{line}, initial = {:?}", speed.round()))
        });
        let found = motions(&near, &question);
        let alike = found
            .iter()
            .filter(|(motion, _)| (motion.point.x[2] / upright - rate).abs() < 1e-8 * rate.abs());
        let alike: Vec<_> = alike.collect();
        assert!(!alike.is_empty(), "{rate}: {} motions", found.len());
        // Nutation: A² Ω² ν² = A² Ω⁴ - 2 A m g l cos θ Ω² + (m g l)² (F. Klein and A. Sommerfeld).
        let share = weight * l / (about_joint * rate);
        let nutation =
            (rate * rate - 2.0 * weight * l * upright / about_joint + share * share).sqrt();
        for (_, stability) in alike {
            assert_eigenvalues(stability, &[[0.0, nutation]], 1e-6 * nutation);
        }
    }
}

#[test]
fn a_spinning_top_precesses_in_a_frame_that_does_not_spin() {
    let (a, c, l, weight) = (0.004_f64, 0.001, 0.1, 0.5 * 9.81);
    let (about_joint, upright, spin) = (a + 0.5 * l * l, 0.6, 150.0);
    // Along the body the motion is periodic.
    let along_body = body([a, a, c], l, "body", HEAVY);
    let model = Model::from_spec(&along_body).unwrap();
    let question = Question::default().fix("upright", upright);
    let Err(error) = model.steady(&question.clone().fix("w_z", spin)) else {
        panic!()
    };
    assert!(error.to_string().contains("periodic"), "{error}");
    // The axis x of a frame that carries the axis of the top stays horizontal.
    let spec = along_body
        .replace("[frames]", "q = { unit = \"rad\" }\n[frames]\ntop = { parent = \"body\", about_axis = \"z\", by = \"q\" }")
        .replace("{ frame = \"body\"", "{ frame = \"top\"")
        .replace("in = \"body\", diagonal", "in = \"top\", diagonal")
        .replace("\"A\", \"B\", \"C\"", "\"A\", \"A\", \"C\"")
        .replace("angular_velocity(body, z, body)", "angular_velocity(top, z, top)")
        .replace(
            "[pseudo_velocities]",
            "[constraints]\nlevel = { kind = \"position\", zero = \"e1*e3 - e0*e2\", dependent = \"e3\" }\n[pseudo_velocities]",
        )
        .replace("e1 = { unit = \"1\"", "e1 = { unit = \"1\", initial = 0.5");
    let found = motions(&spec, &question.fix("w_z", spin));
    // (C n - A Ω cos θ) Ω = m g l.
    let root = ((c * spin).powi(2) - 4.0 * about_joint * upright * weight * l).sqrt();
    for rate in [1.0, -1.0].map(|sign| (c * spin + sign * root) / (2.0 * about_joint * upright)) {
        let has_rate = |(motion, _): &&(SteadyMotion, Stability)| {
            let [x, y] = [motion.point.x[0], motion.point.x[1]];
            (x.hypot(y) - 0.8 * rate).abs() < 1e-8 * rate
        };
        let alike: Vec<_> = found.iter().filter(has_rate).collect();
        assert!(!alike.is_empty(), "{rate}: {} motions", found.len());
        let share = weight * l / (about_joint * rate);
        let nutation =
            (rate * rate - 2.0 * weight * l * upright / about_joint + share * share).sqrt();
        for (_, stability) in alike {
            assert_eigenvalues(stability, &[[0.0, nutation]], 1e-6 * nutation);
            assert_eq!(stability.verdict, Verdict::Neutral);
        }
    }
}

#[test]
fn the_spin_from_which_a_top_sleeps_is_found_along_its_branch() {
    let (a, c, l) = (0.004_f64, 0.001, 0.1);
    let critical = (4.0 * (a + 0.5 * l * l) * 0.5 * 9.81 * l).sqrt() / c;
    let model = Model::from_spec(&body([a, a, c], l, "body", HEAVY)).unwrap();
    let question = Question::default().along("w_z", 0.5 * critical, 1.5 * critical);
    let Answer::Branches(branches) = model.steady(&question).unwrap() else {
        panic!()
    };
    let changes = branches.iter().flat_map(Branch::changes);
    let values: Vec<f64> = changes.map(|special| special.motion.value).collect();
    let near = values
        .iter()
        .filter(|value| (*value - critical).abs() < 1e-6 * critical);
    assert_eq!(near.count(), 1, "{values:?}, not {critical}");
}

#[test]
fn a_ball_in_place_on_a_spinning_table_circles_when_pushed() {
    let spec = format!(
        r#"
[mechanism]
name = "turntable"
title = "Ball on a freely spinning table"
[parameters]
m = {{ value = 0.5, unit = "kg" }}
r = {{ value = 0.1, unit = "m" }}
I = {{ value = 0.002, unit = "kg*m^2" }}
J = {{ value = 0.05, unit = "kg*m^2" }}
[coordinates]
psi = {{ unit = "rad" }}
x = {{ unit = "m" }}
y = {{ unit = "m" }}
{ATTITUDE}
[frames]
table = {{ parent = "ground", about_axis = "z", by = "psi" }}
ball = {{ parent = "ground", quaternion = ["e0", "e1", "e2", "e3"] }}
[points]
C = {{ from = "O", in = "ground", at = ["x", "y", "r"] }}
P = {{ from = "C", in = "ground", at = [0, 0, "-r"] }}
[bodies]
table = {{ frame = "table", centre = "O", mass = "1 [kg]", inertia = {{ in = "table", diagonal = ["J", "J", "J"] }} }}
ball = {{ frame = "ball", centre = "C", mass = "m", inertia = {{ in = "ball", diagonal = ["I", "I", "I"] }} }}
[constraints]
rolling = {{ kind = "rolling", body = "ball", contact = "P", on = "table" }}
[pseudo_velocities]
Omega = {{ value = "dot(psi)", unit = "rad/s" }}
w_x = {{ value = "angular_velocity(ball, x)", unit = "rad/s" }}
w_y = {{ value = "angular_velocity(ball, y)", unit = "rad/s" }}
w_z = {{ value = "angular_velocity(ball, z)", unit = "rad/s" }}
"#
    );
    let place = Question::default().fix("x", 0.3).fix("y", 0.0);
    let found = motions(&spec, &place.fix("Omega", 3.0).fix("w_z", 1.0));
    let [(motion, stability)] = &found[..] else {
        panic!("{} motions", found.len())
    };
    // It turns as the table below it moves: r w = Ω p.
    assert!((motion.point.x[1] - 9.0).abs() < 1e-9, "{motion:?}");
    // m v' = c Ω k × p, where 1/c = 1/m + r²/I, and Ω² (J + c p²) stays.
    let c = 1.0 / (1.0 / 0.5 + 0.01 / 0.002);
    let rate = 3.0 * c / 0.5 * (0.05 / (0.05 + c * 0.09_f64)).sqrt();
    assert_eigenvalues(stability, &[[0.0, rate]], 1e-9);
}

#[test]
fn components_of_an_attitude_that_turns_cannot_be_prescribed() {
    let model = Model::from_spec(&body([0.02, 0.03, 0.045], 0.1, "body", HEAVY)).unwrap();
    for name in ["e1", "e1_dot"] {
        let Err(error) = model.steady(&Question::default().fix(name, 0.1)) else {
            panic!("{name}")
        };
        let text = error.to_string();
        assert!(
            text.contains("quaternion turns") && text.contains("upright"),
            "{text}"
        );
    }
}

#[test]
fn a_law_steadies_a_spinning_body() {
    let torque = r#"[inputs]
tau_x = { unit = "N*m" }
tau_y = { unit = "N*m" }
tau_z = { unit = "N*m" }
[loads]
motors = { kind = "torque", on = "body", in = "body", vector = ["tau_x", "tau_y", "tau_z"] }"#;
    let model = Model::from_spec(&body(
        [0.02, 0.03, 0.045],
        0.0,
        "body",
        ["", "", "", "", torque],
    ))
    .unwrap();
    let request = Request::default().at("w_y", 5).poles("-2,-3,-4");
    let design = model
        .control(&request)
        .unwrap_or_else(|error| panic!("{error}"));
    let named: Vec<&str> = design
        .outputs
        .iter()
        .map(|&x| &*model.info().states[x].name)
        .collect();
    assert_eq!(named, ["w_x", "w_y", "w_z"]);
    // The whole attitude can be steered: its equations are the same all along.
    assert!(design.equations.varying.is_empty());
    assert_eq!(
        (
            design.equations.states.len(),
            design.equations.turning.len()
        ),
        (6, 3)
    );
    assert_eq!(design.controllability.rank, 6);
    let refused = model.control(&request.outputs(&["w_x", "w_y", "w_z", "e1"]));
    assert!(
        refused
            .unwrap_err()
            .to_string()
            .contains("turns along this motion")
    );
    let law = model.law(&design).unwrap();
    let mut motion = Motion::new(8.0).feedback(&law);
    motion.initial.push(Assignment::new("w_x", "0.5"));
    let done = model.simulate(&motion).unwrap();
    let last = done.trajectory.last_state();
    for (speed, wanted) in last.iter().zip([0.0, 5.0, 0.0]) {
        assert!((speed - wanted).abs() < 1e-4, "{last:?}");
    }
}

#[test]
fn a_gyroscope_keeps_its_integrals_and_its_nutation() {
    let (a, c, l, weight) = (0.004_f64, 0.001, 0.1, 0.5 * 9.81);
    let about_joint = a + 0.5 * l * l;
    let spec = body([a, a, c], l, "body", HEAVY);
    // Tilted and let go while it spins: a cusp, where the tilt begins to grow.
    let (tilt, spin) = (0.7_f64, 300.0);
    let model = Model::from_spec(&spec).unwrap();
    let (u, axial) = (tilt.cos(), c * spin);
    let (vertical, energy) = (axial * u, weight * l * u);
    // u̇² = k (u - u₁) (u - u₂) (u - u₃), with u₂ = cos(tilt); the others from a quadratic equation.
    let k = 2.0 * weight * l / about_joint;
    // u̇² = (1 - u²) k (u₂ - u) - p² (u₂ - u)², p = C n/A.
    let p = axial / about_joint;
    let half = p * p / (2.0 * k);
    let root = (half * half - (p * p * u / k - 1.0)).sqrt();
    let [lowest, beyond] = [half - root, half + root];
    let modulus = ((u - lowest) / (beyond - lowest)).sqrt();
    let quarter = std::f64::consts::FRAC_PI_2 / mean(1.0, (1.0 - modulus * modulus).sqrt());
    let period = 4.0 * quarter / (k * (beyond - lowest)).sqrt();
    for (periods, wanted) in [(0.5, lowest), (100.0, u), (200.5, lowest)] {
        let mut motion = Motion::new(periods * period);
        motion.method = Method::Dop853;
        (motion.options.rtol, motion.options.atol) = (1e-13, 1e-13);
        motion.initial = [
            ("e0", (0.5 * tilt).cos()),
            ("e1", (0.5 * tilt).sin()),
            ("w_z", spin),
        ]
        .map(|(name, value)| Assignment::new(name, value))
        .to_vec();
        let done = model.simulate(&motion).unwrap();
        let column = |name: &str| done.trajectory.column(name).unwrap();
        let [e0, e1, e2, e3, wx, wy, wz] =
            ["e0", "e1", "e2", "e3", "w_x", "w_y", "w_z"].map(column);
        let [kinetic, potential, height] =
            ["kinetic_energy", "potential_energy", "upright"].map(column);
        for row in 0..e0.len() {
            assert!((wz[row] - spin).abs() < 1e-9 * spin);
            let up = [
                2.0 * (e1[row] * e3[row] - e0[row] * e2[row]),
                2.0 * (e2[row] * e3[row] + e0[row] * e1[row]),
                height[row],
            ];
            let momentum = about_joint * (wx[row] * up[0] + wy[row] * up[1]) + c * wz[row] * up[2];
            assert!((momentum - vertical).abs() < 1e-9 * vertical, "{momentum}");
            let total = kinetic[row] + potential[row] - 0.5 * c * spin * spin;
            assert!(
                (total - energy).abs() < 1e-9 * energy,
                "{total} and {energy}"
            );
        }
        let last = height[height.len() - 1];
        assert!(
            (last - wanted).abs() < 1e-7,
            "after {periods}: {last}, not {wanted}"
        );
    }
}

/// The arithmetic-geometric mean (C. F. Gauss).
fn mean(a: f64, b: f64) -> f64 {
    if (a - b).abs() < 1e-15 * a {
        a
    } else {
        mean(0.5 * (a + b), (a * b).sqrt())
    }
}
