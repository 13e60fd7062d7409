//! What is prescribed does work: the energy grows by the power of the loads and of what keeps the motion up.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use appell_codegen::jit::JitModel;
use appell_codegen::mechanics::assemble::program;
use appell_codegen::program::FunctionKind;
use appell_codegen::{compile, derived};
use appell_runtime::model::{At, Model};
use appell_test_kit::Random;
use appell_tests::engine::{assert_close, in_process};
use appell_tests::formulations::assert_one_answer;
use appell_tests::shipped::read;

/// A ball that rolls on a table that turns at a given rate: a constraint does work.
const BALL: &str = r#"
[mechanism]
name = "ball_on_driven_table"
title = "Ball on a table that turns at a given rate"
[parameters]
m = { value = 0.3, unit = "kg" }
R = { value = 0.04, unit = "m" }
W = { value = 2, unit = "rad/s" }
[coordinates]
x = { unit = "m" }
y = { unit = "m" }
psi = { unit = "rad" }
theta = { unit = "rad", range = [-1.5, 1.5] }
phi = { unit = "rad" }
[frames]
ball = { parent = "ground", turns = [{ about_axis = "z", by = "psi" }, { about_axis = "x", by = "theta" }, { about_axis = "y", by = "phi" }] }
[points]
C = { from = "O", in = "ground", at = ["x", "y", "R"] }
P = { from = "O", in = "ground", at = ["x", "y", 0] }
[bodies]
ball = { frame = "ball", centre = "C", mass = "m", inertia = { in = "ground", diagonal = ["0.4*m*R^2", "0.4*m*R^2", "0.4*m*R^2"] } }
[constraints]
roll_x = { kind = "fixed_velocity", point = "P", body = "ball", in = "ground", direction = [1, 0, 0], equals = "-W*y" }
roll_y = { kind = "fixed_velocity", point = "P", body = "ball", in = "ground", direction = [0, 1, 0], equals = "W*x" }
[pseudo_velocities]
vx = "dot(x)"
vy = "dot(y)"
wz = "dot(psi) + dot(phi)*sin(theta)"
"#;

/// A bead with a spring on a rod that a motor turns, in gravity and in the air: a frame does work.
const BEAD: &str = r#"
[mechanism]
name = "bead_on_driven_rod"
title = "Bead on a rod that turns at a given rate"
[parameters]
m = { value = 0.5, unit = "kg" }
W = { value = 3, unit = "rad/s" }
k = { value = 8, unit = "N/m" }
c = { value = 0.1, unit = "N*s/m" }
g = { value = 9.81, unit = "m/s^2" }
[coordinates]
r = { unit = "m" }
[frames]
rod = { parent = "ground", about_axis = "y", by = "W*t" }
[points]
B = { from = "O", in = "rod", at = ["r", 0, 0] }
[bodies]
bead = { centre = "B", mass = "m" }
[pseudo_velocities]
v = "dot(r)"
[loads]
weight = { kind = "gravity", down = "-z", acceleration = "g" }
spring = { kind = "spring", coordinate = "r", stiffness = "k" }
air    = { kind = "force", on = "B", in = "ground", vector = ["-c*velocity(B, x)", 0, "-c*velocity(B, z)"] }
"#;

/// A board whose speed is given and whose truck steers: the velocities that follow come from a linear system.
const BOARD: &str = r#"
[mechanism]
name = "board"
title = "Skateboard at a given speed"
[parameters]
m = { value = 70, unit = "kg" }
h = { value = 0.9, unit = "m" }
l = { value = 0.4, unit = "m" }
s = { value = 100, unit = "N*m" }
V = { value = 4, unit = "m/s" }
g = { value = 9.81, unit = "m/s^2" }
[coordinates]
x = { unit = "m" }
y = { unit = "m" }
psi = { unit = "rad" }
b = { unit = "rad", range = [-1.4, 1.4] }
[frames]
board = { parent = "ground", about_axis = "z", by = "psi" }
leaned = { parent = "board", about_axis = "x", by = "b" }
front = { parent = "board", about_axis = "-z", by = "atan(sin(b))" }
rear = { parent = "board", about_axis = "z", by = "atan(sin(b))" }
[points]
C = { from = "O", in = "ground", at = ["x", "y", 0] }
F = { from = "C", in = "board", at = ["l", 0, 0] }
R = { from = "C", in = "board", at = ["-l", 0, 0] }
G = { from = "C", in = "leaned", at = ["0.1*l", 0, "h"] }
[bodies]
skater = { centre = "G", mass = "m" }
[constraints]
front = { kind = "fixed_velocity", point = "F", in = "front", direction = [0, 1, 0] }
rear = { kind = "fixed_velocity", point = "R", in = "rear", direction = [0, 1, 0] }
speed = { kind = "fixed_velocity", point = "C", in = "board", direction = [1, 0, 0], equals = "V" }
[pseudo_velocities]
w = "dot(b)"
[loads]
weight = { kind = "gravity", down = "-z", acceleration = "g" }
trucks = { kind = "spring", coordinate = "b", stiffness = "s" }
"#;

/// A pole on a cart whose acceleration is given, with a load on the cart that the drive has to bear.
const CART: &str = r#"
[mechanism]
name = "driven_cart"
title = "Pole on a cart with a given acceleration"
[parameters]
m = { value = 0.2, unit = "kg" }
l = { value = 0.5, unit = "m" }
I = { value = 0.01, unit = "kg*m^2" }
c = { value = 0.3, unit = "N*s/m" }
d = { value = 0.02, unit = "N*m*s/rad" }
A = { value = 2, unit = "m/s^2" }
k = { value = 0.5, unit = "1/s" }
g = { value = 9.81, unit = "m/s^2" }
[coordinates]
x = { unit = "m" }
theta = { unit = "rad" }
[frames]
pole = { parent = "ground", about_axis = "y", by = "theta" }
[points]
C = { from = "O", in = "ground", at = ["x", 0, 0] }
P = { from = "C", in = "pole", at = [0, 0, "l"] }
[bodies]
cart = { centre = "C", mass = "3*m" }
bob = { frame = "pole", centre = "P", mass = "m", inertia = { in = "pole", diagonal = ["I", "I", "I"] } }
[pseudo_velocities]
v = { value = "dot(x)", rate = "A*cos(3 [1/s]*t) - k*v" }
omega = "dot(theta)"
[loads]
weight = { kind = "gravity", down = "-z", acceleration = "g" }
drag = { kind = "damper", coordinate = "x", damping = "c" }
joint = { kind = "damper", coordinate = "theta", damping = "d" }
[outputs]
F = { value = "drive_force(v)", unit = "N" }
"#;

/// Rounding of the differences below and their fifth-order error.
const ENERGY: f64 = 1e-7;
const STEP: f64 = 1e-3;
const POINTS: usize = 20;

#[test]
fn the_energy_grows_by_the_power_of_loads_and_prescribed_motion() {
    for (name, text) in [
        ("ball", BALL),
        ("bead", BEAD),
        ("board", BOARD),
        ("cart", CART),
    ] {
        let derived = derived(name, text).unwrap_or_else(|report| panic!("{}", report.plain()));
        let program = program(derived.derivation, &derived.mechanism, &FunctionKind::ALL).unwrap();
        let model = JitModel::new(&program).unwrap();
        let info = model.info();
        let p = info.default_parameters();
        let mut random = Random::of(name);
        let mut works = false;
        for number in 0..POINTS {
            let x: Vec<f64> = (0..info.state_len())
                .map(|_| random.between(-0.8, 0.8))
                .collect();
            let t = random.between(0.0, 2.0);
            let mut rates = vec![0.0; x.len()];
            let at = At {
                t,
                x: &x,
                u: &[],
                p: &p,
            };
            model.rates(at, &mut rates);
            let moved = |steps: f64| {
                let there: Vec<f64> = x
                    .iter()
                    .zip(&rates)
                    .map(|(x, rate)| x + steps * STEP * rate)
                    .collect();
                let t = t + steps * STEP;
                let energies = model.energies(At {
                    t,
                    x: &there,
                    u: &[],
                    p: &p,
                });
                energies.kinetic + energies.potential
            };
            let growth =
                (8.0 * (moved(1.0) - moved(-1.0)) - (moved(2.0) - moved(-2.0))) / (12.0 * STEP);
            let power = model.energies(at).power;
            works |= power.abs() > 1e-3;
            let scale = growth.abs().max(1.0);
            assert_close(
                &format!("{name} at point {number}"),
                &[growth],
                &[power],
                ENERGY,
                scale,
            );
        }
        assert!(works, "{name}: nothing does work");
    }
}

/// m l² θ̈ + I θ̈ = m l (g sin θ − v̇ cos θ) − d ω for whatever v̇.
#[test]
fn a_given_rate_moves_the_rest_and_bears_every_load() {
    let program = compile("cart", CART, &FunctionKind::ALL).unwrap();
    for engine in in_process(program) {
        let (model, info) = (engine.model, engine.model.info());
        let p = info.default_parameters();
        let (t, x) = (0.3, [0.7, -1.1, 0.2, 0.9]);
        let at = At {
            t,
            x: &x,
            u: &[],
            p: &p,
        };
        let mut rates = [0.0; 4];
        model.rates(at, &mut rates);
        let [m, l, inertia, drag, d, a, k, g] = p[..] else {
            panic!("{} parameters", p.len());
        };
        let given = a * (3.0 * t).cos() - k * x[0];
        let torque = m * l * (g * x[3].sin() - given * x[3].cos()) - d * x[1];
        let wanted = [given, torque / (m * l * l + inertia), x[0], x[1]];
        assert_close(engine.name, &rates, &wanted, 1e-14, 1.0);
        // What moves cart and bob, and what the drag takes.
        let swing = rates[1] * x[3].cos() - x[1] * x[1] * x[3].sin();
        let force = 4.0 * m * given + m * l * swing + drag * x[0];
        let mut outputs = [0.0];
        model.outputs(at, &mut outputs);
        assert_close(engine.name, &outputs, &[force], 1e-13, 1.0);
        let [mut a, mut by_a] = [(); 2].map(|()| vec![0.0; 16]);
        model.jacobians(at, &mut [0.0; 4], &mut a, &mut []);
        for column in 0..4 {
            let rates_at = |step: f64| {
                let mut there = x;
                there[column] += step;
                let mut rates = [0.0; 4];
                model.rates(At { x: &there, ..at }, &mut rates);
                rates
            };
            let (above, below) = (rates_at(1e-6), rates_at(-1e-6));
            for row in 0..4 {
                by_a[4 * row + column] = (above[row] - below[row]) / 2e-6;
            }
        }
        assert_close(engine.name, &a, &by_a, 1e-8, 1.0);
    }
}

#[test]
fn kane_and_lagrange_agree_with_given_rates() {
    let mechanism = read("cart.toml", CART);
    assert_one_answer(&mechanism);
    // A chain of links that recursion derives where no rate is given.
    let chain = chain(6);
    assert_one_answer(&read("chain.toml", &chain));
}

/// Links in a row, the second at a given acceleration.
fn chain(links: usize) -> String {
    let each = |line: &dyn Fn(usize) -> String| -> String { (1..=links).map(line).collect() };
    let before = |i: usize| match i {
        1 => ("O".to_owned(), "ground".to_owned()),
        i => (format!("P{}", i - 1), format!("f{}", i - 1)),
    };
    format!(
        r#"
[mechanism]
name = "chain"
title = "Chain with a driven joint"
[parameters]
m = {{ value = 0.5, unit = "kg" }}
l = {{ value = 0.3, unit = "m" }}
I = {{ value = 0.01, unit = "kg*m^2" }}
[coordinates]
{}
[inputs]
a = {{ unit = "rad/s^2" }}
[frames]
{}
[points]
{}
[bodies]
{}
[pseudo_velocities]
{}
[loads]
weight = {{ kind = "gravity", down = "-z", acceleration = "9.81 [m/s^2]" }}
"#,
        each(&|i| format!("q{i} = {{ unit = \"rad\" }}\n")),
        each(&|i| format!(
            "f{i} = {{ parent = \"{}\", about_axis = \"y\", by = \"q{i}\" }}\n",
            before(i).1
        )),
        each(&|i| format!(
            "P{i} = {{ from = \"{}\", in = \"f{i}\", at = [\"l\", 0, 0] }}\n",
            before(i).0
        )),
        each(&|i| format!(
            "b{i} = {{ frame = \"f{i}\", centre = \"P{i}\", mass = \"m\", \
             inertia = {{ in = \"f{i}\", diagonal = [\"I\", \"I\", \"I\"] }} }}\n"
        )),
        each(&|i| match i {
            2 => "w2 = { value = \"dot(q2)\", rate = \"a\" }\n".to_owned(),
            i => format!("w{i} = \"dot(q{i})\"\n"),
        }),
    )
}
