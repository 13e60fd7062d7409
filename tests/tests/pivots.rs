//! Mechanisms whose velocities are solved with pivoting when they are evaluated, and kinds of
//! constraints and loads that no shipped mechanism has, against Kane's and Lagrange's equations.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_codegen::linearisation::Structure;
use appell_runtime::condition::Conditions;
use appell_runtime::model::Model;
use appell_spec::Mechanism;
use appell_test_kit::Random;
use appell_tests::engine::{Evaluation, assert_close, assert_schedules, in_process, interpreter};
use appell_tests::formulations::assert_one_answer;
use appell_tests::point::Point;
use appell_tests::steady::problem;
use appell_tests::{dual, shipped};
use nalgebra::{DMatrix, DVector};

/// Rounding of a pivoted solution in place of a closed form.
const PIVOTED: f64 = 1e-12;
/// The same, times the condition of the pseudo-velocities.
const MOTION: f64 = 1e-11;
/// See `laws.rs`; times the condition of what is solved on the way, the mass matrix and the systems.
const JACOBIANS: f64 = 1e-11;
const POINTS: usize = 12;

/// The shipped wheel or unicycle with changes to its text, each of which must apply.
fn changed(name: &str, changes: &[(&str, &str)]) -> Mechanism {
    let mut text = shipped::text(name);
    for (from, to) in changes {
        assert!(text.contains(from), "`{from}` is not in {name}");
        text = text.replace(from, to);
    }
    shipped::read("changed", &text)
}

/// No declared range: nothing says that the tilt stays below a right angle.
const NO_RANGE: (&str, &str) = (", range = [-1.5, 1.5]", "");
/// Pseudo-velocities in the frame of the heading: no single coefficient keeps its sign.
const SKEW: [(&str, &str); 2] = [
    (
        "omega_1 = { value = \"dot(theta)\"",
        "omega_1 = { value = \"dot(psi)*sin(theta) + dot(phi)*cos(theta) + dot(theta)\"",
    ),
    (
        "omega_2 = { value = \"dot(psi)*sin(theta) + dot(phi)\"",
        "omega_2 = { value = \"dot(psi)*cos(theta) - dot(phi)*sin(theta)\"",
    ),
];
const SKEW_THIRD: (&str, &str) = (
    "omega_3 = { value = \"dot(psi)*cos(theta)\"",
    "omega_3 = { value = \"dot(theta)*cos(theta) + dot(phi)*sin(theta)\"",
);

/// q̇ and q̈ at a point, q̈ = ∂q̇/∂x ẋ.
fn motion(model: &dyn Model, point: &Point) -> [DVector<f64>; 2] {
    let e = Evaluation::of(model, point.at());
    let (n, s) = (e.rates.len(), model.info().speeds);
    let slopes = DMatrix::from_row_slice(n - s, n, &e.a[s * n..]);
    let rates = DVector::from_column_slice(&e.rates);
    [rates.rows(s, n - s).into_owned(), slopes * rates]
}

/// The motion in coordinates, which no choice of pseudo-velocities changes, at a point of the first.
fn assert_one_motion(first: &dyn Model, second: &dyn Model, point: &Point) {
    let wanted = motion(first, point);
    // The other's pseudo-velocities: q̇ is linear in them.
    let mut other = point.clone();
    let (n, s) = (other.x.len(), second.info().speeds);
    let a = Evaluation::of(second, other.at()).a;
    let partial = DMatrix::from_row_slice(n - s, n, &a[s * n..])
        .columns(0, s)
        .into_owned();
    let normal = (partial.transpose() * &partial).try_inverse().unwrap();
    let speeds = normal * partial.transpose() * &wanted[0];
    other.x[..s].copy_from_slice(speeds.as_slice());
    let got = motion(second, &other);
    for ((what, got), wanted) in ["velocities", "accelerations"]
        .iter()
        .zip(&got)
        .zip(&wanted)
    {
        assert_close(what, got.as_slice(), wanted.as_slice(), MOTION, 1.0);
    }
}

/// Kane, Lagrange, duals and the compiled code.
fn assert_sound(mechanism: &Mechanism) {
    assert_one_answer(mechanism);
    let program = shipped::standard_program(mechanism);
    let engines = in_process(program.clone());
    let mut random = Random::of(&format!("pivots {}", mechanism.name));
    let [interpreted, compiled] = engines.as_slice() else {
        panic!("two executions")
    };
    let points: Vec<Point> = (0..POINTS)
        .map(|_| Point::random(interpreted.model.info(), &mut random))
        .collect();
    assert_schedules(&program, &points[..2]);
    for (number, point) in points.iter().enumerate() {
        let e = Evaluation::of(interpreted.model, point.at());
        let others = Evaluation::of(compiled.model, point.at());
        for ((what, wanted), (_, got)) in e.arrays().into_iter().zip(others.arrays()) {
            let what = format!("{what}, compiled, at point {number}");
            assert_close(&what, got, wanted, PIVOTED, 1.0);
        }
        let condition = Conditions::of(interpreted.model, point.at());
        let systems = condition.systems.iter().copied().fold(1.0, f64::max);
        let condition = condition.mass_matrix * systems;
        for ((what, derived), dual) in [("A", &e.a), ("B", &e.b), ("P", &e.p)]
            .into_iter()
            .zip(dual::jacobians(&program, point))
        {
            assert_close(
                &format!("{what} at point {number}"),
                derived,
                &dual,
                JACOBIANS * condition,
                1e-3,
            );
        }
    }
}

fn solved_numerically(mechanism: &Mechanism) -> usize {
    shipped::derive(mechanism)
        .velocities
        .solved_numerically
        .len()
}

#[test]
fn a_wheel_without_a_range_of_tilt_moves_like_the_one_with_a_range() {
    let free = changed("rolling_wheel", &[NO_RANGE]);
    assert_eq!(solved_numerically(shipped::mechanism("rolling_wheel")), 0);
    assert!(
        solved_numerically(&free) > 0,
        "nothing may be divided by the cosine of an unlimited tilt"
    );
    let (a, b) = (shipped::model("rolling_wheel"), interpreter(&free));
    let mut random = Random::of("no range");
    for number in 0..POINTS {
        let point = Point::random(a.info(), &mut random);
        let (wanted, got) = (
            Evaluation::of(a, point.at()),
            Evaluation::of(&b, point.at()),
        );
        for ((what, got), (_, wanted)) in got.arrays().into_iter().zip(wanted.arrays()) {
            if what != "residual" {
                assert_close(
                    &format!("{what} at point {number}"),
                    got,
                    wanted,
                    PIVOTED * 10.0,
                    1.0,
                );
            }
        }
    }
    assert_sound(&free);
}

#[test]
fn a_unicycle_without_a_range_of_tilt_moves_like_the_one_with_a_range() {
    let free = changed("unicycle", &[NO_RANGE]);
    let (a, b) = (shipped::model("unicycle"), interpreter(&free));
    let mut random = Random::of("no range");
    for number in 0..POINTS {
        let point = Point::random(a.info(), &mut random);
        let (wanted, got) = (
            Evaluation::of(a, point.at()),
            Evaluation::of(&b, point.at()),
        );
        assert_close(
            &format!("rates at point {number}"),
            &got.rates,
            &wanted.rates,
            PIVOTED,
            0.0,
        );
        assert_close(
            &format!("A at point {number}"),
            &got.a,
            &wanted.a,
            PIVOTED * 10.0,
            0.0,
        );
    }
    assert_sound(&free);
}

#[test]
fn skew_pseudo_velocities_describe_the_same_motion() {
    let skew = changed("rolling_wheel", &[SKEW[0], SKEW[1], SKEW_THIRD, NO_RANGE]);
    assert!(solved_numerically(&skew) > 0, "no entry keeps its sign");
    assert_sound(&skew);
    let (a, b) = (shipped::model("rolling_wheel"), interpreter(&skew));
    let mut random = Random::of("one motion");
    for _ in 0..POINTS {
        assert_one_motion(a, &b, &Point::random(a.info(), &mut random));
    }
}

#[test]
fn nothing_is_divided_by_what_vanishes_at_upright() {
    // Upright sin θ = 0; the entries sin θ of both mechanisms are pivots that must not be taken.
    // The shipped ones are regular there by other formulas.
    let wheel = shipped::model("rolling_wheel");
    let unicycle = shipped::model("unicycle");
    for (regular, mechanism) in [
        (wheel, changed("rolling_wheel", &[NO_RANGE])),
        (
            wheel,
            changed("rolling_wheel", &[SKEW[0], SKEW[1], SKEW_THIRD, NO_RANGE]),
        ),
        (unicycle, changed("unicycle", &[NO_RANGE])),
    ] {
        let model = interpreter(&mechanism);
        let mut random = Random::of("upright");
        for number in 0..POINTS {
            let mut point = Point::random(model.info(), &mut random);
            let info = model.info();
            point.x[info.state_index("theta").unwrap()] = 0.0;
            if number % 2 == 0 {
                // Also where yaw leaves one row of the rolling constraint without a velocity.
                point.x[info.state_index("psi").unwrap()] = 0.0;
            }
            let e = Evaluation::of(&model, point.at());
            for (what, array) in e.arrays() {
                assert!(
                    array.iter().all(|entry| entry.is_finite()),
                    "{what}: {array:?}"
                );
            }
            assert_one_motion(regular, &model, &point);
        }
    }
}

/// A planar sledge on a knife edge that is pulled along a curve: a constraint that depends on time,
/// one that follows data, a fixed velocity, springs and dampers between points.
const SLEDGE: &str = r#"
[mechanism]
name = "sledge"
title = "Sledge on a knife edge with a tow"
[parameters]
m = { value = 3, unit = "kg", at_least = 0 }
J = { value = 0.4, unit = "kg*m^2", at_least = 0 }
a = { value = 0.3, unit = "m", at_least = 0 }
k = { value = 20, unit = "N/m", at_least = 0 }
d = { value = 2, unit = "N*s/m", at_least = 0 }
l = { value = 0.5, unit = "m", at_least = 0 }
w = { value = 1.5, unit = "rad/s", at_least = 0 }
n = { value = 0.7, unit = "kg", at_least = 0 }
[coordinates]
x = { unit = "m" }
y = { unit = "m" }
psi = { unit = "rad" }
z = { unit = "m" }
[inputs]
F = { unit = "N" }
[frames]
sledge = { parent = "ground", about_axis = "z", by = "psi" }
[points]
E = { from = "O", in = "ground", at = ["x", "y", 0] }
C = { from = "E", in = "sledge", at = ["a", 0, 0] }
T = { from = "O", in = "ground", at = ["2 [m]", "1 [m]", "z"] }
[bodies]
sledge = { frame = "sledge", centre = "C", mass = "m", inertia = { in = "sledge", diagonal = ["J", "J", "J"] } }
tow = { centre = "T", mass = "n" }
[constraints]
edge = { kind = "fixed_velocity", point = "E", in = "sledge", direction = [0, 1, 0] }
drive = { kind = "velocity", zero = "dot(z) - dot(psi)*a", equals = "a*w*sin(w*t)*z/l" }
[pseudo_velocities]
v = { value = "dot(x)*cos(psi) + dot(y)*sin(psi)", unit = "m/s" }
omega = { value = "dot(psi)", unit = "rad/s" }
[loads]
weight = { kind = "gravity", down = "-z", acceleration = "9.81 [m/s^2]" }
spring = { kind = "spring", between = ["E", "T"], stiffness = "k", relaxed = "l" }
damper = { kind = "damper", between = ["C", "T"], damping = "d" }
turn = { kind = "spring", coordinate = "psi", stiffness = "k*a^2/(1 [rad])" }
brake = { kind = "damper", coordinate = "x", damping = "d" }
push = { kind = "force", on = "C", body = "sledge", in = "sledge", vector = ["F", "F/2", 0] }
"#;

#[test]
fn a_knife_edge_with_prescribed_velocities_springs_and_dampers() {
    assert_sound(&shipped::read("sledge", SLEDGE));
}

/// A body with a full inertia tensor on a base that follows recorded data.
const GYROSCOPE: &str = r#"
[mechanism]
name = "gyroscope"
title = "Heavy top with a crooked body on a moving base"
[parameters]
m = { value = 2, unit = "kg", at_least = 0 }
A = { value = 0.3, unit = "kg*m^2", at_least = 0 }
B = { value = 0.4, unit = "kg*m^2", at_least = 0 }
C = { value = 0.5, unit = "kg*m^2", at_least = 0 }
D = { value = 0.05, unit = "kg*m^2" }
E = { value = -0.04, unit = "kg*m^2" }
F = { value = 0.03, unit = "kg*m^2" }
l = { value = 0.3, unit = "m", at_least = 0 }
k = { value = 15, unit = "N/m", at_least = 0 }
g = { value = 9.81, unit = "m/s^2", at_least = 0 }
[coordinates]
alpha = { unit = "rad" }
beta = { unit = "rad", range = [-1.4, 1.4] }
gamma = { unit = "rad" }
x = { unit = "m" }
[inputs]
M = { unit = "N*m" }
[signals]
h = { unit = "m", t = [0, 1, 2, 3], value = [0, 0.2, -0.1, 0.3], interpolation = "cubic" }
s = { unit = "m/s", t = [0, 1, 2, 3], value = [0, 0.5, 0.2, 0.4], interpolation = "cubic" }
[frames]
yaw = { parent = "ground", about_axis = "z", by = "alpha" }
body = { parent = "yaw", turns = [{ about_axis = "x", by = "beta" }, { about_axis = "-y", by = "gamma" }] }
[points]
base = { from = "O", in = "ground", at = ["x", 0, "h"] }
G = { from = "base", in = "body", at = ["l/5", "-l/7", "l"] }
H = { from = "O", in = "ground", at = ["0.1 [m]", "0.2 [m]", "1.5 [m]"] }
[bodies]
top = { frame = "body", centre = "G", mass = "m", inertia = { in = "body", matrix = [["A", "D", "E"], ["D", "B", "F"], ["E", "F", "C"]] } }
[constraints]
shake = { kind = "velocity", zero = "dot(x)", equals = "s" }
[pseudo_velocities]
p = { value = "dot(beta)*cos(gamma) + dot(alpha)*cos(beta)*sin(gamma)", unit = "rad/s" }
q = { value = "dot(alpha)*sin(beta) - dot(gamma)", unit = "rad/s" }
r = { value = "dot(alpha)*cos(beta)*cos(gamma) - dot(beta)*sin(gamma)", unit = "rad/s" }
[loads]
weight = { kind = "gravity", down = "-z", acceleration = "g" }
spring = { kind = "spring", between = ["H", "G"], stiffness = "k", relaxed = "l" }
motor = { kind = "torque", on = "top", in = "body", vector = ["M/3", "M", "-M/2"] }
twist = { kind = "generalized", coordinate = "alpha", force = "M*cos(alpha)" }
"#;

#[test]
fn a_crooked_top_on_a_base_that_follows_data() {
    assert_sound(&shipped::read("gyroscope", GYROSCOPE));
}

#[test]
fn a_rolling_disc_that_is_pulled_by_a_spring_and_rolls_on_a_driven_plate() {
    // The contact's material point moves along with the signal-free but rheonomic fixed velocity.
    let text = shipped::text("rolling_wheel").replace(
        "rolling = { kind = \"rolling\", body = \"wheel\", contact = \"P\", about = \"the wheel rolls without slipping\" }",
        "along = { kind = \"fixed_velocity\", point = \"P\", body = \"wheel\", in = \"ground\", direction = [1, 0, 0], equals = \"R*sin(2 [1/s]*t)*(1 [1/s])\" }\n\
         across = { kind = \"fixed_velocity\", point = \"P\", body = \"wheel\", in = \"ground\", direction = [0, 1, 0], equals = \"y_G*cos(t*(1 [1/s]))*(1 [1/s])\" }",
    );
    let text = text.replace(
        "[outputs]",
        "pull = { kind = \"spring\", between = [\"O\", \"G\"], stiffness = \"m*g/R\", relaxed = \"2*R\" }\n\
         drag = { kind = \"damper\", between = [\"O\", \"G\"], damping = \"m*1 [1/s]\" }\n[outputs]",
    );
    let plate = shipped::read("plate", &text);
    assert_eq!(plate.constraints.len(), 2);
    assert_sound(&plate);
}

/// A cart with four links: five coupled speeds, more than explicit formulas are made for.
fn chain() -> Mechanism {
    let links = 1..=4;
    let lines =
        |line: &dyn Fn(usize) -> String| links.clone().map(line).collect::<Vec<_>>().join("\n");
    let from = |i: usize| {
        if i == 1 {
            "C".to_owned()
        } else {
            format!("E{}", i - 1)
        }
    };
    let text = format!(
        r#"
[mechanism]
name = "chain"
title = "Cart with four links"
[parameters]
M = {{ value = 3, unit = "kg", at_least = 0 }}
g = {{ value = 9.81, unit = "m/s^2", at_least = 0 }}
c = {{ value = 0.3, unit = "N*m*s/rad", at_least = 0 }}
{}
[coordinates]
x = {{ unit = "m" }}
{}
[inputs]
F = {{ unit = "N" }}
[frames]
{}
[points]
C = {{ from = "O", in = "ground", at = ["x", 0, 0] }}
{}
[bodies]
cart = {{ centre = "C", mass = "M" }}
{}
[pseudo_velocities]
v = {{ value = "dot(x)", unit = "m/s" }}
{}
[loads]
weight = {{ kind = "gravity", down = "-z", acceleration = "g" }}
push = {{ kind = "force", on = "C", in = "ground", vector = ["F", 0, 0] }}
{}
"#,
        lines(&|i| format!(
            "m{i} = {{ value = {i}, unit = \"kg\", at_least = 0 }}\n\
             J{i} = {{ value = 0.{i}, unit = \"kg*m^2\", at_least = 0 }}\n\
             l{i} = {{ value = 0.5, unit = \"m\", at_least = 0 }}"
        )),
        lines(&|i| format!("a{i} = {{ unit = \"rad\" }}")),
        lines(&|i| format!(
            "link{i} = {{ parent = \"ground\", about_axis = \"y\", by = \"a{i}\" }}"
        )),
        lines(&|i| format!(
            "G{i} = {{ from = \"{from}\", in = \"link{i}\", at = [0, 0, \"-l{i}/2\"] }}\n\
             E{i} = {{ from = \"{from}\", in = \"link{i}\", at = [0, 0, \"-l{i}\"] }}",
            from = from(i)
        )),
        lines(&|i| format!(
            "link{i} = {{ frame = \"link{i}\", centre = \"G{i}\", mass = \"m{i}\", \
             inertia = {{ in = \"link{i}\", diagonal = [\"J{i}\", \"J{i}\", \"J{i}\"] }} }}"
        )),
        lines(&|i| format!("w{i} = {{ value = \"dot(a{i})\", unit = \"rad/s\" }}")),
        lines(&|i| format!(
            "joint{i} = {{ kind = \"damper\", coordinate = \"a{i}\", damping = \"c/(1 [rad])\" }}"
        )),
    );
    shipped::read("chain", &text)
}

#[test]
fn five_coupled_speeds_are_solved_by_an_unrolled_factorisation() {
    assert_sound(&chain());
}

/// Frames turned by functions of coordinates and time, smooth and broken functions, loads that
/// depend on velocities, pseudo-velocities that mix them.
const MIXED: &str = r#"
[mechanism]
name = "mixed"
title = "Functions of all kinds"
[parameters]
m = { value = 2, unit = "kg", at_least = 0 }
J = { value = 0.3, unit = "kg*m^2", at_least = 0 }
c = { value = 3, unit = "N", at_least = 0 }
w = { value = 0.2, unit = "m/s", at_least = 0 }
l = { value = 0.4, unit = "m", at_least = 0 }
n = { value = 1.5, unit = "1", at_least = 0 }
[coordinates]
x = { unit = "m" }
a = { unit = "rad" }
b = { unit = "rad" }
[inputs]
F = { unit = "N" }
[frames]
p = { parent = "ground", turns = [{ about_axis = "-z", by = "a*pi/3" }, { about_axis = "x", by = "2*b + 0.1*sin(t*(1 [1/s]))" }] }
q = { parent = "p", about_axis = "-x", by = "b/2" }
[points]
A = { from = "O", in = "ground", at = ["x", "l*sin(2*a)", "l*cos(a)^3"] }
B = { from = "A", in = "p", at = ["l*cos(b)", "l/3", "-l*exp(0.3*sin(b))"] }
C = { from = "B", in = "q", at = ["l*(1 + 0.2*tanh(a))", 0, "l/2"] }
[bodies]
one = { frame = "p", centre = "A", mass = "m", inertia = { in = "p", diagonal = ["J", "2*J", "1.5*J"] } }
two = { frame = "q", centre = "C", mass = "m/2", inertia = { in = "q", diagonal = ["J", "J", "J/2"] } }
dot = { centre = "B", mass = "m*n" }
[pseudo_velocities]
v = { value = "dot(x) + l*dot(a)*sin(b)", unit = "m/s" }
f = { value = "dot(a) - dot(b)/2", unit = "rad/s" }
e = { value = "dot(b) + dot(a)/3", unit = "rad/s" }
[loads]
weight = { kind = "gravity", down = "-z", acceleration = "9.81 [m/s^2]" }
friction = { kind = "force", on = "B", in = "p", vector = ["-c*smooth_sign(v, w)", "if(x < l, F, F/2)", "c*atan2(x, l)/(1 [rad])"] }
couple = { kind = "torque", on = "one", reaction_on = "two", in = "q", vector = ["c*l*abs(sin(a))", "-F*l*hypot(a, b)", "c*l*smooth_max(f, e, 0.3 [1/s])/(2 [1/s])"] }
spring = { kind = "spring", between = ["A", "C"], stiffness = "c/l", relaxed = "l/2" }
[outputs]
o = { value = "min(x, l)*max(a, b)", unit = "m" }
"#;

#[test]
fn smooth_and_broken_functions_in_frames_points_and_loads() {
    assert_sound(&shipped::read("mixed", MIXED));
}

/// A board steered in front; `speed` is the definition of its pseudo-velocity v.
fn steered(speed: &str) -> Mechanism {
    let text = format!(
        "[mechanism]\nname = 'steered'\ntitle = 'Steered board'\n\
         [parameters]\nm = {{ value = 7, unit = 'kg' }}\nI = {{ value = 2, unit = 'kg*m^2' }}\n\
         l = {{ value = 0.4, unit = 'm' }}\n\
         [coordinates]\nx = {{ unit = 'm' }}\ny = {{ unit = 'm' }}\npsi = {{ unit = 'rad' }}\n\
         delta = {{ unit = 'rad', initial = 0.1 }}\n\
         [frames]\nboard = {{ parent = 'ground', about_axis = 'z', by = 'psi' }}\n\
         fork = {{ parent = 'board', about_axis = 'z', by = 'delta' }}\n\
         [points]\nR = {{ from = 'O', in = 'ground', at = ['x', 'y', 0] }}\n\
         F = {{ from = 'R', in = 'board', at = ['2*l', 0, 0] }}\n\
         [bodies]\nboard = {{ frame = 'board', centre = 'F', mass = 'm', \
         inertia = {{ in = 'board', diagonal = ['I', 'I', 'I'] }} }}\n\
         fork = {{ frame = 'fork', centre = 'F', mass = 'm', \
         inertia = {{ in = 'fork', diagonal = ['I', 'I', 'I'] }} }}\n\
         [constraints]\n\
         front = {{ kind = 'fixed_velocity', point = 'F', in = 'fork', direction = [0, 1, 0] }}\n\
         rear = {{ kind = 'fixed_velocity', point = 'R', in = 'board', direction = [0, 1, 0] }}\n\
         [pseudo_velocities]\nv = {{ value = '{speed}', initial = 1 }}\nw = {{ value = 'dot(delta)' }}\n"
    );
    shipped::read("steered", &text)
}

/// Velocity of the front along the fork: the determinant is ±2 l.
const ALONG_FORK: &str =
    "dot(x)*cos(psi + delta) + dot(y)*sin(psi + delta) + 2*l*dot(psi)*sin(delta)";
/// Velocity of the rear along the board: the determinant vanishes where the fork stands across.
const ALONG_BOARD: &str = "dot(x)*cos(psi) + dot(y)*sin(psi)";

#[test]
fn a_determinant_that_is_a_positive_parameter_needs_no_pivoting() {
    let steered = steered(ALONG_FORK);
    assert_eq!(solved_numerically(&steered), 0);
    assert_sound(&steered);
}

/// A body in the air; its velocity is given along its own axes.
const FLYING: &str = "[mechanism]\nname = 'flying'\ntitle = 'Flying body'\n\
    [parameters]\nm = { value = 3, unit = 'kg' }\nI = { value = 2, unit = 'kg*m^2' }\n\
    g = { value = 9.81, unit = 'm/s^2' }\n\
    [coordinates]\nx = { unit = 'm' }\ny = { unit = 'm' }\nz = { unit = 'm' }\n\
    psi = { unit = 'rad' }\nth = { unit = 'rad', range = [-1.5, 1.5] }\nphi = { unit = 'rad' }\n\
    [frames]\nB = { parent = 'ground', turns = [{ about_axis = 'z', by = 'psi' }, \
    { about_axis = 'y', by = 'th' }, { about_axis = 'x', by = 'phi' }] }\n\
    [points]\nC = { from = 'O', in = 'ground', at = ['x', 'y', 'z'] }\n\
    [bodies]\nB = { frame = 'B', centre = 'C', mass = 'm', \
    inertia = { in = 'B', diagonal = ['I', '1.5*I', '2*I'] } }\n\
    [pseudo_velocities]\n\
    u = { value = 'cos(th)*(cos(psi)*dot(x) + sin(psi)*dot(y)) - sin(th)*dot(z)' }\n\
    v = { value = '(sin(phi)*sin(th)*cos(psi) - cos(phi)*sin(psi))*dot(x) + \
    (sin(phi)*sin(th)*sin(psi) + cos(phi)*cos(psi))*dot(y) + sin(phi)*cos(th)*dot(z)' }\n\
    w = { value = '(cos(phi)*sin(th)*cos(psi) + sin(phi)*sin(psi))*dot(x) + \
    (cos(phi)*sin(th)*sin(psi) - sin(phi)*cos(psi))*dot(y) + cos(phi)*cos(th)*dot(z)' }\n\
    p = { value = 'dot(phi) - dot(psi)*sin(th)' }\n\
    q = { value = 'dot(th)*cos(phi) + dot(psi)*cos(th)*sin(phi)' }\n\
    r = { value = 'dot(psi)*cos(th)*cos(phi) - dot(th)*sin(phi)' }\n\
    [loads]\nweight = { kind = 'gravity', down = '-z', acceleration = 'g' }\n";

#[test]
fn a_turn_in_space_is_solved_by_its_own_entries() {
    let flying = shipped::read("flying", FLYING);
    let derivation = shipped::derive(&flying);
    assert!(derivation.velocities.solved_numerically.is_empty());
    // Its columns, and the turn of the rates of the angles.
    let operations = derivation
        .algebra
        .graph
        .operations(&derivation.velocities.rates);
    assert!(operations <= 60, "{operations} operations");
    assert_sound(&flying);
}

#[test]
fn essential_and_ignorable_states_are_the_same_in_formulas_and_in_numbers() {
    let mechanisms = [
        steered(ALONG_FORK),
        steered(ALONG_BOARD),
        shipped::read("flying", FLYING),
        changed("rolling_wheel", &[NO_RANGE]),
    ];
    for mechanism in mechanisms {
        let formulas = Structure::of(&mut shipped::derive(&mechanism));
        let model = interpreter(&mechanism);
        let numbers = problem(&model, &[]);
        let numbers = numbers.structure();
        assert_eq!(formulas.ignorable, numbers.ignorable, "{}", mechanism.name);
        assert_eq!(formulas.essential, numbers.essential, "{}", mechanism.name);
    }
}

/// A top about a fixed point by z-x-z angles, which have a pole where it stands upright.
const TOP: &str = "[mechanism]\nname = 'top'\ntitle = 'Top'\n\
    [parameters]\nm = { value = 1, unit = 'kg' }\nl = { value = 0.1, unit = 'm' }\n\
    A = { value = 0.002, unit = 'kg*m^2' }\nC = { value = 0.001, unit = 'kg*m^2' }\n\
    g = { value = 9.81, unit = 'm/s^2' }\n\
    [coordinates]\npsi = { unit = 'rad' }\ntheta = { unit = 'rad' }\nphi = { unit = 'rad' }\n\
    [frames]\ntop = { parent = 'ground', turns = [{ about_axis = 'z', by = 'psi' }, \
    { about_axis = 'x', by = 'theta' }, { about_axis = 'z', by = 'phi' }] }\n\
    [points]\nG = { from = 'O', in = 'top', at = [0, 0, 'l'] }\n\
    [bodies]\ntop = { frame = 'top', centre = 'G', mass = 'm', \
    inertia = { in = 'top', diagonal = ['A', 'A', 'C'] } }\n\
    [pseudo_velocities]\n\
    w1 = { value = 'dot(psi)*sin(theta)*sin(phi) + dot(theta)*cos(phi)' }\n\
    w2 = { value = 'dot(psi)*sin(theta)*cos(phi) - dot(theta)*sin(phi)' }\n\
    w3 = { value = 'dot(psi)*cos(theta) + dot(phi)' }\n\
    [loads]\nweight = { kind = 'gravity', down = '-z', acceleration = 'g' }\n";

#[test]
fn energies_and_accelerations_are_finite_at_the_pole_of_the_angles() {
    let top = shipped::read("top", TOP);
    assert!(solved_numerically(&top) > 0);
    assert_sound(&top);
    let model = interpreter(&top);
    let mut point = Point::random(model.info(), &mut Random::of("pole"));
    point.x = vec![0.3, -0.2, 30.0, 0.0, 0.0, 0.0];
    let energies = model.energies(point.at());
    let p = &point.p;
    let (m, l, a, c, g) = (p[0], p[1], p[2], p[3], p[4]);
    let across = (a + m * l * l) * (0.3_f64.powi(2) + 0.2_f64.powi(2));
    let kinetic = 0.5 * (across + c * 30.0 * 30.0);
    assert_close(
        "kinetic energy",
        &[energies.kinetic],
        &[kinetic],
        PIVOTED,
        1.0,
    );
    assert_close(
        "potential energy",
        &[energies.potential],
        &[m * g * l],
        PIVOTED,
        1.0,
    );
    let rates = Evaluation::of(&model, point.at()).rates;
    assert!(rates[..3].iter().all(|rate| rate.is_finite()), "{rates:?}");
}
