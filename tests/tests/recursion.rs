//! Equations by recursion over links: against Kane's and Lagrange's, dual numbers, and each other.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_codegen::program::FunctionKind as F;
use appell_codegen::schedule::schedule;
use appell_codegen::tape::OperationCount;
use appell_runtime::model::Model as _;
use appell_spec::Mechanism;
use appell_test_kit::Random;
use appell_tests::dual;
use appell_tests::engine::{Evaluation, assert_close, interpreter};
use appell_tests::formulations::assert_one_answer;
use appell_tests::point::Point;
use appell_tests::shipped;

const TOLERANCE: f64 = 1e-9;
const POINTS: usize = 3;

/// A free body with a branch of a turning and a sliding link with a ball joint and a point mass, a fixed turn,
/// and two links that one coordinate moves.
const TREE: &str = r#"
[mechanism]
name = "tree"
title = "Free body with branches"
[parameters]
g = { value = 9.81, unit = "m/s^2" }
m = { value = 2, unit = "kg" }
l = { value = 0.4, unit = "m" }
A = { value = 0.03, unit = "kg*m^2" }
C = { value = 0.05, unit = "kg*m^2" }
D = { value = 0.002, unit = "kg*m^2" }
k = { value = 20, unit = "N/m" }
c = { value = 0.3, unit = "N*s/m" }
[coordinates]
x = { unit = "m" }
y = { unit = "m" }
z = { unit = "m" }
ATTITUDE
q1 = { unit = "rad" }
s = { unit = "m" }
h0 = { unit = "1" }
h1 = { unit = "1" }
h2 = { unit = "1" }
h3 = { unit = "1" }
q2 = { unit = "rad" }
[inputs]
tau = { unit = "N*m" }
push = { unit = "N" }
[frames]
hull = { parent = "ground", FRAME }
arm = { parent = "hull", about_axis = "y", by = "q1" }
bent = { parent = "arm", turns = [{ about_axis = "z", by = "30 [deg]" }, { about_axis = "x", by = "90 [deg]" }] }
hand = { parent = "bent", quaternion = ["h0", "h1", "h2", "h3"] }
left = { parent = "hull", about_axis = "x", by = "q2" }
right = { parent = "hull", about_axis = "x", by = "-2*q2" }
[points]
B = { from = "O", in = "ground", at = ["x", "y", "z"] }
G = { from = "B", in = "hull", at = [0, "l/5", "l/7"] }
S = { from = "B", in = "hull", at = ["l", 0, "l/4"] }
E = { from = "S", in = "arm", at = ["s", "l/3", 0] }
H = { from = "E", in = "bent", at = [0, 0, "l/2"] }
T = { from = "H", in = "hand", at = ["l/4", "l/5", 0] }
L = { from = "S", in = "left", at = [0, "l", 0] }
R = { from = "G", in = "right", at = [0, 0, "-l"] }
[bodies]
hull = { frame = "hull", centre = "G", mass = "2*m", inertia = { in = "hull", moments = ["A", "A", "C"], products = ["D", 0, "-D"] } }
arm = { frame = "bent", centre = "E", mass = "m", inertia = { in = "bent", diagonal = ["A", "C", "C"] } }
hand = { frame = "hand", centre = "T", mass = "m/2", inertia = { in = "hand", moments = ["A", "C", "C"], products = [0, "D", 0] } }
left = { frame = "left", centre = "L", mass = "m/3", inertia = { in = "left", diagonal = ["A", "A", "D"] } }
right = { centre = "R", mass = "m/4" }
[pseudo_velocities]
SPEEDS
v1 = { value = "dot(q1)", unit = "rad/s" }
vs = { value = "dot(s)", unit = "m/s" }
h_x = { value = "angular_velocity(hand, x, hand) - angular_velocity(bent, x, hand)", unit = "rad/s" }
h_y = { value = "angular_velocity(hand, y, hand) - angular_velocity(bent, y, hand)", unit = "rad/s" }
h_z = { value = "angular_velocity(hand, z, hand) - angular_velocity(bent, z, hand)", unit = "rad/s" }
v2 = { value = "2*dot(q2)", unit = "rad/s" }
[loads]
weight = { kind = "gravity", down = "-z", acceleration = "g" }
motor = { kind = "torque", on = "arm", reaction_on = "hull", in = "arm", vector = [0, "tau", 0] }
spring = { kind = "spring", between = ["T", "L"], stiffness = "k", relaxed = "l" }
damper = { kind = "damper", coordinate = "s", damping = "c" }
wind = { kind = "force", on = "R", in = "ground", vector = ["push", 0, "-c*velocity(R, z)"] }
"#;

/// By a quaternion with velocities in the ground; by angles with velocities along the hull.
fn trees() -> [Mechanism; 2] {
    let places = ["x", "y", "z"];
    let w = places.map(|k| {
        format!("w{k} = {{ value = \"angular_velocity(hull, {k}, hull)\", unit = \"rad/s\" }}\n")
    });
    let in_ground = places.map(|k| format!("v{k} = {{ value = \"dot({k})\", unit = \"m/s\" }}\n"));
    let along = places
        .map(|k| format!("v{k} = {{ value = \"velocity(B, {k}, hull)\", unit = \"m/s\" }}\n"));
    let four = "e0 = { unit = \"1\" }\ne1 = { unit = \"1\" }\ne2 = { unit = \"1\" }\ne3 = { unit = \"1\" }";
    let three = "psi = { unit = \"rad\" }\ntheta = { unit = \"rad\", range = [-1.2, 1.2] }\nphi = { unit = \"rad\" }";
    let turns = "turns = [{ about_axis = \"z\", by = \"psi\" }, { about_axis = \"y\", by = \"theta\" }, { about_axis = \"x\", by = \"phi\" }]";
    let quaternion = "quaternion = [\"e0\", \"e1\", \"e2\", \"e3\"]";
    [
        (four, quaternion, [in_ground.concat(), w.concat()]),
        (three, turns, [w.concat(), along.concat()]),
    ]
    .map(|(attitude, frame, speeds)| {
        let text = TREE.replace("ATTITUDE", attitude).replace("FRAME", frame);
        shipped::read("tree.toml", &text.replace("SPEEDS", &speeds.concat()))
    })
}

/// A planar chain.
fn chain(links: usize) -> Mechanism {
    let each = |line: &dyn Fn(usize) -> String| (1..=links).map(line).collect::<String>();
    let before = |k: usize, first: &str, name: &str| match k {
        1 => first.to_owned(),
        _ => format!("{name}{}", k - 1),
    };
    let text = format!(
        r#"
[mechanism]
name = "chain"
title = "Chain"
[parameters]
m = {{ value = 0.7, unit = "kg" }}
l = {{ value = 0.3, unit = "m" }}
I = {{ value = 0.01, unit = "kg*m^2" }}
[coordinates]
{}[frames]
{}[points]
{}[bodies]
{}[pseudo_velocities]
{}[loads]
weight = {{ kind = "gravity", down = "-z", acceleration = "9.81 [m/s^2]" }}
"#,
        each(&|k| format!("q{k} = {{ unit = \"rad\" }}\n")),
        each(&|k| format!(
            "f{k} = {{ parent = \"{}\", about_axis = \"y\", by = \"q{k}\" }}\n",
            before(k, "ground", "f")
        )),
        each(&|k| format!(
            "G{k} = {{ from = \"{0}\", in = \"f{k}\", at = [0, 0, \"-l/2\"] }}\nE{k} = {{ from = \"{0}\", in = \"f{k}\", at = [0, 0, \"-l\"] }}\n",
            before(k, "O", "E")
        )),
        each(&|k| format!(
            "b{k} = {{ frame = \"f{k}\", centre = \"G{k}\", mass = \"m\", inertia = {{ in = \"f{k}\", diagonal = [\"I\", \"I\", \"I\"] }} }}\n"
        )),
        each(&|k| format!("w{k} = {{ value = \"dot(q{k})\", unit = \"rad/s\" }}\n")),
    );
    shipped::read("chain.toml", &text)
}

/// Quaternions at a point with norm 1.
fn normalised(mechanism: &Mechanism, point: &mut Point) {
    for quaternion in quaternions(mechanism) {
        let norm = quaternion
            .iter()
            .map(|&q| point.x[q] * point.x[q])
            .sum::<f64>()
            .sqrt();
        for q in quaternion {
            point.x[q] /= norm;
        }
    }
}

/// By their places in the state.
fn quaternions(mechanism: &Mechanism) -> Vec<[usize; 4]> {
    let speeds = mechanism.pseudo_velocities.len();
    let frames = mechanism.frames.iter();
    let all = frames.filter_map(|frame| frame.quaternion);
    all.map(|q| q.map(|id| speeds + id.index())).collect()
}

/// Takes out of the columns of A what changes the norm of a quaternion.
fn along_the_sphere(mechanism: &Mechanism, point: &Point, a: &mut [f64]) {
    for row in a.chunks_exact_mut(point.x.len()) {
        for quaternion in quaternions(mechanism) {
            let across: f64 = quaternion.iter().map(|&q| row[q] * point.x[q]).sum();
            for q in quaternion {
                row[q] -= across * point.x[q];
            }
        }
    }
}

#[test]
fn trees_agree_with_kane_and_lagrange() {
    for mechanism in &trees() {
        assert!(shipped::derive(mechanism).recursion.is_some());
        assert_one_answer(mechanism);
    }
}

#[test]
fn their_jacobians_are_those_of_dual_numbers() {
    for mechanism in trees().iter().chain([&chain(6)]) {
        let model = interpreter(mechanism);
        let program = shipped::standard_program(mechanism);
        let mut random = Random::of(&mechanism.name);
        for _ in 0..POINTS {
            let mut point = Point::random(model.info(), &mut random);
            normalised(mechanism, &mut point);
            let mut e = Evaluation::of(&model, point.at());
            let [mut a, b, p] = dual::jacobians(&program, &point);
            for a in [&mut e.a, &mut a] {
                along_the_sphere(mechanism, &point, a);
            }
            for (what, derived, dual) in [("A", &e.a, &a), ("B", &e.b, &b), ("P", &e.p, &p)] {
                assert_close(what, derived, dual, TOLERANCE, TOLERANCE);
            }
        }
    }
}

#[test]
fn articulated_links_and_a_factorised_mass_matrix_give_one_motion() {
    let mechanism = chain(14);
    let derivation = shipped::derive(&mechanism);
    let tree = derivation.recursion.as_ref().unwrap();
    assert_ne!(tree.factorized, derivation.motion.accelerations);
    let model = interpreter(&mechanism);
    let mut random = Random::of("articulated");
    let point = Point::random(model.info(), &mut random);
    let e = Evaluation::of(&model, point.at());
    // M ω̇ + b = Π
    let speeds = model.info().speeds;
    let taken: Vec<f64> = (e.mass_matrix.chunks_exact(speeds).zip(&e.bias))
        .map(|(row, bias)| bias + row.iter().zip(&e.rates).map(|(m, a)| m * a).sum::<f64>())
        .collect();
    assert_close("Π", &taken, &e.forces, 1e-9, 1e-9);
}

#[test]
fn the_rates_of_a_chain_cost_as_much_more_as_it_is_longer() {
    let cost = |links: usize| {
        let program = shipped::program_of(&chain(links), &[F::Rates]);
        let count = OperationCount::of(&schedule(&program, &program.functions[0]));
        f64::from(u32::try_from(count.total()).unwrap())
    };
    let growth = (cost(24) / cost(12)).log2();
    assert!(growth < 1.2, "operations grow as n^{growth}");
}

/// A carriage on a free body, and a wheel that turns on it about another axis than the one along which it is placed; what
/// moves the carriage has no inertia, so the constraint has no force.
const CARRIAGE: &str = r#"
[mechanism]
name = "carriage_on_a_body"
title = "Carriage on a free body"
[coordinates]
X = { unit = "m" }
e0 = { unit = "1" }
e1 = { unit = "1" }
e2 = { unit = "1" }
e3 = { unit = "1" }
j = { unit = "rad" }
k = { unit = "m" }
l = { unit = "rad" }
[frames]
b = { parent = "ground", quaternion = ["e0", "e1", "e2", "e3"] }
e = { parent = "b", about_axis = "y", by = "l" }
[points]
P = { from = "O", in = "ground", at = ["X", 0, 0] }
D = { from = "P", in = "b", at = ["k", 0, 0] }
E = { from = "D", in = "e", at = [0, 0, 0] }
[bodies]
b = { frame = "b", centre = "P", mass = "1 [kg]", inertia = { in = "b", diagonal = ["0.1 [kg*m^2]", "0.1 [kg*m^2]", "0.1 [kg*m^2]"] } }
e = { frame = "e", centre = "CENTRE", mass = "1 [kg]", inertia = { in = "e", diagonal = ["0.1 [kg*m^2]", "0.1 [kg*m^2]", "0.1 [kg*m^2]"] } }
[constraints]
k_follows = { kind = "position", zero = "k - 0.1 [m]*j", dependent = "k" }
[pseudo_velocities]
V = "dot(X)"
wx = "angular_velocity(b, x, b)"
wy = "angular_velocity(b, y, b)"
wz = "angular_velocity(b, z, b)"
vj = "dot(j)"
vl = "dot(l)"
"#;

#[test]
fn a_centre_placed_in_other_axes_than_its_bodys_feels_the_same_forces() {
    let [in_body, beside] = ["E", "D"]
        .map(|centre| shipped::read("carriage.toml", &CARRIAGE.replace("CENTRE", centre)));
    assert!(shipped::derive(&beside).recursion.is_some());
    assert_one_answer(&beside);
    let models = [interpreter(&in_body), interpreter(&beside)];
    let mut random = Random::of("carriage");
    for _ in 0..POINTS {
        let mut point = Point::random(models[0].info(), &mut random);
        normalised(&in_body, &mut point);
        let [e, other] = models
            .each_ref()
            .map(|model| Evaluation::of(model, point.at()));
        // The acceleration energy among them.
        assert_close(
            "energies",
            &other.energies,
            &e.energies,
            TOLERANCE,
            TOLERANCE,
        );
        assert!(other.reactions.iter().all(|force| force.abs() < TOLERANCE));
    }
}
