//! Contacts against textbook statics and dynamics: normal forces, friction demand, and the places
//! where a body leaves its surface or slips.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use std::f64::consts::TAU;

use appell_codegen::interpreted::InterpretedModel;
use appell_codegen::jit::JitModel;
use appell_runtime::condition::Conditions;
use appell_runtime::contact::{ContactForce, ContactForces};
use appell_runtime::integrate::{Ending, Options};
use appell_runtime::model::{At, Model};
use appell_runtime::simulate::{Breach, Limit, Response, Validity};
use appell_runtime::{Simulation, Trajectory};
use appell_tests::formulations::assert_one_answer;
use appell_tests::shipped;

/// Rounding of a formula against the derived equations.
const ROUNDING: f64 = 1e-12;
/// A place on the dense output of an integration with tolerances of 1e-12.
const PLACE: f64 = 1e-9;

/// A particle on a sphere, held by its distance.
const SPHERE: &str = r#"
[mechanism]
name = "sphere"
title = "A particle on a sphere"
[parameters]
m = { value = 3, unit = "kg" }
R = { value = 0.8, unit = "m" }
g = { value = 9.81, unit = "m/s^2" }
[coordinates]
x = { unit = "m", initial = 0.08 }
z = { unit = "m", initial = 0.79 }
[points]
G = { from = "O", in = "ground", at = ["x", 0, "z"] }
[bodies]
particle = { centre = "G", mass = "m" }
[constraints]
surface = { kind = "position", zero = "x^2 + z^2 - R^2", one_sided = true, dependent = "z" }
[pseudo_velocities]
v = { value = "(z*dot(x) - x*dot(z))/R", unit = "m/s" }
[loads]
weight = { kind = "gravity", down = "-z", acceleration = "g" }
"#;

/// The same in polar coordinates, held by its radial velocity.
const POLAR: &str = r#"
[mechanism]
name = "polar"
title = "A particle on a sphere"
[parameters]
m = { value = 3, unit = "kg" }
R = { value = 0.8, unit = "m" }
g = { value = 9.81, unit = "m/s^2" }
[coordinates]
theta = { unit = "rad", initial = 0.1 }
r = { unit = "m", initial = 0.8 }
[frames]
radial = { parent = "ground", about_axis = "y", by = "theta" }
[points]
G = { from = "O", in = "radial", at = [0, 0, "r"] }
[bodies]
particle = { centre = "G", mass = "m" }
[constraints]
surface = { kind = "fixed_velocity", point = "G", in = "radial", direction = [0, 0, 2], one_sided = true }
[pseudo_velocities]
omega = "dot(theta)"
[loads]
weight = { kind = "gravity", down = "-z", acceleration = "g" }
"#;

/// Pseudo-velocities along two directions that meet where q is an eighth of a turn.
const CROSSED: &str = r#"
[mechanism]
name = "crossed"
title = "Two directions"
[parameters]
m = { value = 1, unit = "kg" }
[coordinates]
x = { unit = "m" }
y = { unit = "m" }
q = { unit = "rad" }
[points]
A = { from = "O", in = "ground", at = ["x", "y", 0] }
B = { from = "O", in = "ground", at = [0, 0, "q*1[m]"] }
[bodies]
a = { centre = "A", mass = "m" }
b = { centre = "B", mass = "m" }
[pseudo_velocities]
u = { value = "dot(x)*cos(q) + dot(y)*sin(q)", unit = "m/s" }
v = { value = "dot(x)*sin(q) + dot(y)*cos(q)", unit = "m/s" }
w = "dot(q)"
"#;

/// The machine code of a spec and its interpreter.
fn engines(text: &str) -> [Box<dyn Model>; 2] {
    let program = shipped::standard_program(&shipped::read("test.toml", text));
    [
        Box::new(JitModel::new(&program).unwrap()),
        Box::new(InterpretedModel::new(program)),
    ]
}

fn file(path: &str) -> String {
    std::fs::read_to_string(shipped::workspace().join(path)).unwrap()
}

fn slope() -> String {
    file("codegen/tests/audit/right/wheel_down_a_slope.toml")
}

fn ball() -> String {
    shipped::text("ball_on_ball")
}

fn forces(model: &dyn Model, x: &[f64], p: &[f64]) -> Vec<ContactForce> {
    let u = vec![0.0; model.info().input_len()];
    let at = At {
        t: 0.0,
        x,
        u: &u,
        p,
    };
    ContactForces::new().at(model, at).to_vec()
}

fn assert_close(found: f64, expected: f64, tolerance: f64, what: &str) {
    let allowed = tolerance * expected.abs().max(1.0);
    let difference = (found - expected).abs();
    assert!(difference <= allowed, "{what}: {found}, not {expected}");
}

/// The motion from the initial state of the spec with changes, all contacts watched.
fn motion(model: &dyn Model, initial: &[(&str, f64)], validity: Validity) -> Trajectory {
    let mut simulation = Simulation {
        span: [0.0, 5.0],
        options: Options::with_tolerances(1e-12, 1e-12),
        validity,
        ..Simulation::new(model)
    };
    for (name, value) in initial {
        simulation.initial_state[model.info().state_index(name).unwrap()] = *value;
    }
    simulation.run().unwrap()
}

const STOP: Validity = Validity {
    ranges: Response::Stop,
    contacts: Response::Stop,
    friction: None,
    conditions: Response::Ignore,
    worst_condition: 1e12,
};

fn state(breach: &Breach, model: &dyn Model, name: &str) -> f64 {
    breach.state[model.info().state_index(name).unwrap()]
}

#[test]
fn a_disc_on_a_slope_asks_for_a_third_of_its_tangent() {
    for model in engines(&slope()) {
        let info = model.info();
        let mut p = info.default_parameters();
        let (m, g) = (10.0, 9.81);
        for degrees in [0.0, 5.0, 20.0, 45.0, 80.0_f64] {
            let alpha = degrees.to_radians();
            p[info.parameter_index("alpha").unwrap()] = alpha;
            p[info.parameter_index("mu").unwrap()] = 0.25;
            let force = forces(&*model, &info.initial_state(), &p)[0];
            let what = format!("at {degrees} degrees");
            assert_close(force.normal, m * g * alpha.cos(), ROUNDING, &what);
            assert_close(force.tangential, m * g * alpha.sin() / 3.0, ROUNDING, &what);
            assert_close(force.demand(), alpha.tan() / 3.0, ROUNDING, &what);
            assert_eq!(force.friction, Some(0.25), "{what}");
            assert_eq!(force.grip(0.25) < 0.0, alpha.tan() / 3.0 > 0.25, "{what}");
        }
    }
}

/// Energy and the radial equation: N = m g (17 cos θ − 10 cos θ₀)/7, F = 2 m g sin θ/7.
#[test]
fn a_ball_slips_on_a_ball_and_leaves_it_at_ten_seventeenths() {
    let start = 0.05_f64;
    for model in engines(&ball()) {
        let initial = [("theta", start)];
        let slips = motion(&*model, &initial, STOP);
        let breach = slips.breaches.last().unwrap();
        assert_eq!(slips.ending, Some(Ending::Stopped));
        assert_eq!(breach.limit, Limit::Friction { contact: 0 });
        assert_close(breach.value, 0.4, PLACE, "friction demand");
        let theta = state(breach, &*model, "theta");
        let demand = 2.0 * theta.sin() / (17.0 * theta.cos() - 10.0 * start.cos());
        assert_close(demand, 0.4, PLACE, "demand by the formula");

        let report = Validity {
            contacts: Response::Report,
            ..STOP
        };
        let falls = motion(&*model, &initial, report);
        assert_eq!(falls.ending, Some(Ending::Finished));
        let limits: Vec<Limit> = falls.breaches.iter().map(|breach| breach.limit).collect();
        let (slip, lost) = (
            Limit::Friction { contact: 0 },
            Limit::Contact { contact: 0 },
        );
        assert_eq!(limits[..2], [slip, lost]);
        let theta = state(&falls.breaches[1], &*model, "theta");
        assert_close(theta.cos(), 10.0 / 17.0 * start.cos(), PLACE, "cosine");
        assert!(falls.breaches[0].t < falls.breaches[1].t);
    }
}

#[test]
fn a_particle_leaves_a_sphere_at_two_thirds() {
    for model in engines(SPHERE) {
        let falls = motion(&*model, &[], STOP);
        let (z, start) = (falls.last_state()[2], falls.state(0)[2]);
        assert_eq!(falls.breaches[0].limit, Limit::Contact { contact: 0 });
        assert_close(
            z,
            2.0 / 3.0 * start,
            PLACE,
            "height of a position constraint",
        );
    }
    for model in engines(POLAR) {
        let falls = motion(&*model, &[], STOP);
        let theta = state(&falls.breaches[0], &*model, "theta");
        let expected = 2.0 / 3.0 * 0.1_f64.cos();
        assert_close(theta.cos(), expected, PLACE, "height of a fixed velocity");
        // The length of the direction scales the velocity, not the force.
        let force = forces(
            &*model,
            &[0.0, 0.1, 0.8],
            &model.info().default_parameters(),
        )[0];
        assert_close(
            force.normal,
            3.0 * 9.81 * 0.1_f64.cos(),
            ROUNDING,
            "at rest",
        );
        assert_close(force.tangential, 0.0, ROUNDING, "without friction");
    }
}

#[test]
fn a_motion_that_begins_beyond_a_limit_says_so_at_once() {
    let [model, _] = engines(&ball());
    let ended = motion(&*model, &[("theta", 1.2), ("omega", 5.0)], STOP);
    assert_eq!((ended.len(), ended.ending), (1, Some(Ending::Stopped)));
    let limits: Vec<Limit> = ended.breaches.iter().map(|breach| breach.limit).collect();
    let both = [
        Limit::Contact { contact: 0 },
        Limit::Friction { contact: 0 },
    ];
    assert_eq!(limits, both);
    let own = Validity {
        friction: Some(1e3),
        ..STOP
    };
    assert!(motion(&*model, &[("theta", 0.1)], own).breaches[0].t > 0.0);
}

/// Newton's law for the centre of mass: N = m (g + z̈), F = m |(ẍ, ÿ)|.
#[test]
fn a_wheel_presses_with_its_weight_and_the_acceleration_of_its_centre() {
    let [model, _] = engines(&shipped::text("rolling_wheel"));
    let (m, radius, g) = (10.0, 0.3, 9.81);
    let p = model.info().default_parameters();
    let n = model.info().state_len();
    let index = |name| model.info().state_index(name).unwrap();
    for number in 0..12 {
        let phase = f64::from(number);
        let mut x: Vec<f64> = (0..n).map(|i| (phase * (i + 1) as f64).sin()).collect();
        x[index("omega_2")] = 5.0 * (phase / 12.0 * TAU).cos();
        let (mut rates, mut a) = (vec![0.0; n], vec![0.0; n * n]);
        let at = At {
            t: 0.0,
            x: &x,
            u: &[],
            p: &p,
        };
        model.jacobians(at, &mut rates, &mut a, &mut []);
        let second = |name| -> f64 {
            let row = &a[index(name) * n..][..n];
            row.iter().zip(&rates).map(|(a, rate)| a * rate).sum()
        };
        let (theta, omega) = (x[index("theta")], x[index("omega_1")]);
        let up = -radius * (theta.sin() * rates[index("omega_1")] + theta.cos() * omega * omega);
        let force = forces(&*model, &x, &p)[0];
        assert_close(force.normal, m * (g + up), ROUNDING, "normal force");
        let along = m * second("x_G").hypot(second("y_G"));
        assert_close(force.tangential, along, ROUNDING, "tangential force");
        assert_eq!(force.friction, None);
    }
}

/// Moments about the rear contact: N w = g Σ m x for the front.
#[test]
fn the_wheels_of_a_bicycle_carry_it_by_its_levers() {
    let [model, _] = engines(&shipped::text("bicycle"));
    let names: Vec<&str> = model
        .info()
        .contacts
        .iter()
        .map(|c| c.name.as_ref())
        .collect();
    assert_eq!(names, ["P", "Q"]);
    let forces = forces(
        &*model,
        &model.info().initial_state(),
        &model.info().default_parameters(),
    );
    let front = 9.81 * (85.0 * 0.3 + 4.0 * 0.9 + 3.0 * 1.02) / 1.02;
    assert_close(forces[1].normal, front, ROUNDING, "front");
    assert_close(forces[0].normal, 94.0 * 9.81 - front, ROUNDING, "rear");
}

#[test]
fn bodies_on_slopes_and_balls_have_the_reactions_of_kane_and_lagrange() {
    for text in [slope(), ball()] {
        let mechanism = shipped::read("test.toml", &text);
        assert_one_answer(&mechanism);
    }
}

#[test]
fn contacts_that_share_their_reactions_are_not_judged() {
    let row = r#"kind = "fixed_velocity", point = "P_r", body = "right_wheel", in = "yawed", direction = [1, 0, 0]"#;
    let rolling = r#"kind = "rolling", body = "right_wheel", contact = "P_r""#;
    let text = shipped::text("two_wheeled_pendulum");
    assert!(text.contains(row));
    let [model, _] = engines(&text.replace(row, rolling));
    assert!(model.info().reactions.is_empty());
    assert!(model.info().contacts.is_empty());
}

/// The matrix [cos q, sin q; sin q, cos q] has the condition number (cos q + sin q)/|cos q − sin q|.
#[test]
fn a_system_near_its_singular_configuration_has_a_large_condition_number() {
    for model in engines(CROSSED) {
        assert_eq!(model.system_sizes(), [2]);
        let p = model.info().default_parameters();
        for q in [0.0, 0.5, 0.785, 1.0_f64] {
            let x = [0.0, 0.0, 0.0, 0.1, 0.2, q];
            let at = At {
                t: 0.0,
                x: &x,
                u: &[],
                p: &p,
            };
            let found = Conditions::of(&*model, at).systems[0];
            let (sin, cos) = q.sin_cos();
            let expected = (cos + sin) / (cos - sin).abs();
            assert_close(found / expected, 1.0, PLACE, &format!("at q = {q}"));
        }
    }
}

/// dψ/dt = ω₃/cos θ: the norms of ∂q̇/∂ω and of its pseudo-inverse in closed form.
#[test]
fn velocities_lose_digits_where_a_wheel_lies_flat() {
    let [model, _] = engines(&shipped::text("rolling_wheel"));
    let p = model.info().default_parameters();
    let radius = 0.3_f64;
    for theta in [0.0, 1.0, 1.5, 1.57_f64] {
        let mut x = model.info().initial_state();
        x[model.info().state_index("theta").unwrap()] = theta;
        let at = At {
            t: 0.0,
            x: &x,
            u: &[],
            p: &p,
        };
        let found = Conditions::of(&*model, at).velocities;
        // ω₁ moves θ and y_G, ω₂ moves φ and x_G, ω₃ moves ψ and φ.
        let (sin, cos) = theta.sin_cos();
        let [one, two] = [1.0 + (radius * cos).powi(2), 1.0 + radius * radius];
        let three = (1.0 + sin * sin) / (cos * cos);
        let determinant = two * three - (sin / cos).powi(2);
        let squares = one + two + three;
        let inverse_squares = 1.0 / one + (two + three) / determinant;
        let expected = (squares * inverse_squares).sqrt() / 3.0;
        assert_close(found / expected, 1.0, PLACE, &format!("at {theta}"));
    }
}

#[test]
fn a_motion_into_a_singular_configuration_tells_its_condition_number() {
    let [model, _] = engines(CROSSED);
    let validity = Validity {
        conditions: Response::Stop,
        worst_condition: 1e3,
        ..Validity::default()
    };
    let ended = motion(&*model, &[("w", 0.5)], validity);
    let breach = &ended.breaches[0];
    // M is proportional to [1, −a; −a, 1] with a = sin 2q: (1 + a)/(1 − a) = 1000.
    assert_eq!(breach.limit, Limit::Condition { of: 0 });
    assert_close(breach.value / 1e3, 1.0, PLACE, "condition number");
    let q = state(breach, &*model, "q");
    assert_close((2.0 * q).sin(), 999.0 / 1001.0, PLACE, "sine");
}
