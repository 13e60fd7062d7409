//! Bodies that turn about every axis and roll, against closed forms.

use appell::{Method, Model, Motion};

/// Columns of a motion by their names.
fn columns<const N: usize>(spec: &str, t_end: f64, names: [&str; N]) -> Vec<[f64; N]> {
    let model = Model::from_spec(spec).unwrap_or_else(|error| panic!("{error}"));
    let mut motion = Motion::new(t_end);
    motion.method = Method::Dop853;
    motion.options.rtol = 1e-12;
    motion.options.atol = 1e-12;
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

fn is_constant(values: impl Iterator<Item = f64>, tolerance: f64) {
    let values: Vec<f64> = values.collect();
    let first = values[0];
    let off = values
        .iter()
        .fold(0.0, |most: f64, v| most.max((v / first - 1.0).abs()));
    assert!(off < tolerance, "{first} changes by {off:e}");
    assert!(values.len() > 10);
}

const BALL: &str = r#"
[parameters]
m = { value = 0.5, unit = "kg" }
r = { value = 0.1, unit = "m" }
I = { value = 0.002, unit = "kg*m^2" }
"#;

const ATTITUDE: &str = r#"
e0 = { unit = "1" }
e1 = { unit = "1" }
e2 = { unit = "1" }
e3 = { unit = "1" }
"#;

#[test]
fn a_ball_rolls_on_a_table_that_spins_freely() {
    let spec = format!(
        r#"
[mechanism]
name = "turntable"
title = "Ball on a freely spinning table"
{BALL}
J = {{ value = 0.05, unit = "kg*m^2" }}
[coordinates]
psi = {{ unit = "rad" }}
x = {{ unit = "m", initial = 0.3 }}
y = {{ unit = "m", initial = -0.1 }}
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
Omega = {{ value = "dot(psi)", unit = "rad/s", initial = 3 }}
w_x = {{ value = "angular_velocity(ball, x)", unit = "rad/s", initial = 4 }}
w_y = {{ value = "angular_velocity(ball, y)", unit = "rad/s", initial = -2 }}
w_z = {{ value = "angular_velocity(ball, z)", unit = "rad/s", initial = 1 }}
[loads]
weight = {{ kind = "gravity", down = "-z", acceleration = "9.81 [m/s^2]" }}
[outputs]
v_x = {{ value = "dot(x)" }}
v_y = {{ value = "dot(y)" }}
"#
    );
    let names = [
        "t",
        "Omega",
        "x",
        "y",
        "v_x",
        "v_y",
        "w_z",
        "kinetic_energy",
    ];
    let rows = columns(&spec, 6.0, names);
    is_constant(rows.iter().map(|row| row[6]), 1e-10);
    is_constant(rows.iter().map(|row| row[7]), 1e-10);
    // The force on the ball is c d(Omega k × p)/dt with 1/c = 1/m + r²/I; its moment slows the table, so that
    // Omega² (J + c p²) stays.
    let c = 1.0 / (1.0 / 0.5 + 0.01 / 0.002);
    is_constant(
        rows.iter()
            .map(|[_, spin, x, y, ..]| spin * spin * (0.05 + c * (x * x + y * y))),
        1e-10,
    );
    // And m v = c Omega k × p + a vector that stays.
    let kept =
        |[_, spin, x, y, vx, vy, ..]: &[f64; 8]| [0.5 * vx + c * spin * y, 0.5 * vy - c * spin * x];
    is_constant(rows.iter().map(|row| kept(row)[0]), 1e-9);
    is_constant(rows.iter().map(|row| kept(row)[1]), 1e-9);
    let turned = rows.iter().map(|row| row[2].hypot(row[3]));
    assert!(turned.fold(0.0, f64::max) > 0.4);
}

#[test]
fn a_ball_in_a_cylinder_comes_back_up() {
    let spec = format!(
        r#"
[mechanism]
name = "cylinder"
title = "Ball inside an upright cylinder"
{BALL}
a = {{ value = 0.4, unit = "m", about = "radius of the circle of the centre" }}
[coordinates]
phi = {{ unit = "rad" }}
z = {{ unit = "m" }}
{ATTITUDE}
[frames]
towards = {{ parent = "ground", about_axis = "z", by = "phi" }}
ball = {{ parent = "ground", quaternion = ["e0", "e1", "e2", "e3"] }}
[points]
C = {{ from = "O", in = "towards", at = ["a", 0, "z"] }}
P = {{ from = "C", in = "towards", at = ["r", 0, 0] }}
[bodies]
ball = {{ frame = "ball", centre = "C", mass = "m", inertia = {{ in = "ball", diagonal = ["I", "I", "I"] }} }}
[constraints]
rolling = {{ kind = "rolling", body = "ball", contact = "P", in = "towards", normal = "-x" }}
[pseudo_velocities]
w_x = {{ value = "angular_velocity(ball, x, towards)", unit = "rad/s", initial = 2 }}
w_y = {{ value = "angular_velocity(ball, y, towards)", unit = "rad/s", initial = -1 }}
w_z = {{ value = "angular_velocity(ball, z, towards)", unit = "rad/s", initial = -24 }}
[loads]
weight = {{ kind = "gravity", down = "-z", acceleration = "9.81 [m/s^2]" }}
[outputs]
phi_dot = {{ value = "dot(phi)" }}
"#
    );
    let rows = columns(&spec, 5.0, ["t", "z", "phi_dot"]);
    is_constant(rows.iter().map(|row| row[2]), 1e-10);
    // The height is harmonic, with the rate of the circle times the root of I/(I + m r²) (E. J. Routh, 1905).
    let rate = rows[0][2] * (0.002 / (0.002 + 0.005_f64)).sqrt();
    let (start, fall) = harmonic(&rows, rate);
    for [t, z, _] in &rows {
        let told = fall[0] + (start - fall[0]) * (rate * t).cos() + fall[1] * (rate * t).sin();
        assert!((z - told).abs() < 1e-9, "at {t}: {z}, not {told}");
    }
    let [low, high] = [f64::min, f64::max].map(|f| rows.iter().map(|row| row[1]).fold(0.0, f));
    assert!(high - low > 0.02, "{low} to {high}");
}

/// Start, and middle and share of the sine, of a harmonic motion from its first quarter.
fn harmonic(rows: &[[f64; 3]], rate: f64) -> (f64, [f64; 2]) {
    let start = rows[0][1];
    // z − z₀ = m (1 − cos) + s sin at two instants.
    let equation = |row: &[f64; 3]| {
        let angle = rate * row[0];
        (1.0 - angle.cos(), angle.sin(), row[1] - start)
    };
    let (a, b, e) = equation(&rows[rows.len() / 7]);
    let (c, d, f) = equation(&rows[rows.len() / 5]);
    let determinant = a * d - b * c;
    let middle = start + (e * d - b * f) / determinant;
    (start, [middle, (a * f - c * e) / determinant])
}

#[test]
fn wheels_take_up_what_a_satellite_turns() {
    let wheels = ["x", "y", "z"];
    let each = |line: &dyn Fn(&str) -> String| wheels.map(line).concat();
    let spec = format!(
        r#"
[mechanism]
name = "satellite"
title = "Satellite with three wheels"
[parameters]
A = {{ value = 2, unit = "kg*m^2" }}
B = {{ value = 3, unit = "kg*m^2" }}
C = {{ value = 4.2, unit = "kg*m^2" }}
J = {{ value = 0.05, unit = "kg*m^2" }}
[coordinates]
{ATTITUDE}
{angles}
[frames]
hull = {{ parent = "ground", quaternion = ["e0", "e1", "e2", "e3"] }}
{frames}
[bodies]
hull = {{ frame = "hull", centre = "O", mass = "100 [kg]", inertia = {{ in = "hull", diagonal = ["A", "B", "C"] }} }}
{bodies}
[pseudo_velocities]
w_x = {{ value = "angular_velocity(hull, x, hull)", unit = "rad/s", initial = 0.4 }}
w_y = {{ value = "angular_velocity(hull, y, hull)", unit = "rad/s", initial = 1.1 }}
w_z = {{ value = "angular_velocity(hull, z, hull)", unit = "rad/s", initial = -0.3 }}
{speeds}
[loads]
{motors}
"#,
        angles = each(&|k| format!("q_{k} = {{ unit = \"rad\" }}\n")),
        frames = each(&|k| format!(
            "wheel_{k} = {{ parent = \"hull\", about_axis = \"{k}\", by = \"q_{k}\" }}\n"
        )),
        bodies = each(&|k| format!(
            "wheel_{k} = {{ frame = \"wheel_{k}\", centre = \"O\", mass = \"1 [kg]\", inertia = {{ in = \"wheel_{k}\", diagonal = [\"J\", \"J\", \"J\"] }} }}\n"
        )),
        speeds = each(&|k| format!(
            "s_{k} = {{ value = \"dot(q_{k})\", unit = \"rad/s\", initial = 5 }}\n"
        )),
        motors = each(&|k| format!(
            "motor_{k} = {{ kind = \"generalized\", coordinate = \"q_{k}\", force = \"0.1 [N*m]\" }}\n"
        )),
    );
    let names = [
        "e0", "e1", "e2", "e3", "w_x", "w_y", "w_z", "s_x", "s_y", "s_z",
    ];
    let rows = columns(&spec, 40.0, names);
    // The angular momentum in the ground, of hull and wheels.
    let momentum = |row: &[f64; 10]| -> [f64; 3] {
        let [w, v @ ..]: [f64; 4] = std::array::from_fn(|k| row[k]);
        let h: [f64; 3] =
            std::array::from_fn(|k| ([2.0, 3.0, 4.2][k] + 0.15) * row[4 + k] + 0.05 * row[7 + k]);
        let once = cross(v, h);
        let inner: [f64; 3] = std::array::from_fn(|k| once[k] + w * h[k]);
        let twice = cross(v, inner);
        std::array::from_fn(|k| h[k] + 2.0 * twice[k])
    };
    for k in 0..3 {
        is_constant(rows.iter().map(|row| momentum(row)[k]), 1e-9);
    }
    let fastest = rows.iter().map(|row| row[7].abs()).fold(0.0, f64::max);
    assert!(fastest > 6.0, "{fastest}");
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        a[i] * b[j] - a[j] * b[i]
    })
}
