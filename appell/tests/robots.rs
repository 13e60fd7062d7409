//! Robots from their files, against a recursive Newton-Euler algorithm that knows neither specs nor Gibbs-Appell.

use appell::Model;
use appell::cases::Case;
use appell::evaluation::quantities;
use appell::robot::{self, Letters, Options, Without};
use serde_json::Value;

/// Rounding of sums of some hundred terms.
const ROUNDING: f64 = 1e-13;

type Vector = [f64; 3];
type Matrix = [Vector; 3];

/// A link of a chain, as its file has it.
struct Link {
    position: Vector,
    /// Roll, pitch, yaw.
    orientation: Vector,
    turns: bool,
    axis: Vector,
    parts: &'static [Part],
    damping: f64,
}

/// A rigid part of a link: mass, centre, roll pitch yaw of its axes, xx yy zz xy xz yz.
type Part = (f64, Vector, Vector, [f64; 6]);

/// The numbers of `robot/arm.urdf`. The gripper is on the slide, 0.1 m along and turned by 45°.
const ARM: [Link; 4] = [
    Link {
        position: [0.0, 0.0, 0.3],
        orientation: [0.0; 3],
        turns: true,
        axis: [0.0, 0.0, 1.0],
        parts: &[(
            4.0,
            [0.0, 0.0, 0.06],
            [0.0; 3],
            [0.012, 0.012, 0.009, 0.0, 0.0, 0.0],
        )],
        damping: 0.4,
    },
    Link {
        position: [0.05, 0.0, 0.12],
        orientation: [std::f64::consts::FRAC_PI_2, 0.0, 0.0],
        turns: true,
        axis: [0.0, 0.0, 1.0],
        parts: &[(
            2.4,
            [0.18, 0.0, 0.01],
            [0.0, 0.05, 0.0],
            [0.004, 0.031, 0.03, 0.0, 0.0006, 0.0],
        )],
        damping: 0.3,
    },
    Link {
        position: [0.36, 0.0, 0.0],
        orientation: [0.0, 0.0, -0.2],
        turns: true,
        axis: [0.0, 0.6, 0.8],
        parts: &[(
            1.3,
            [0.14, 0.01, 0.0],
            [0.0; 3],
            [0.0015, 0.011, 0.0112, -0.0002, 0.0, 0.0001],
        )],
        damping: 0.1,
    },
    Link {
        position: [0.3, 0.0, 0.0],
        orientation: [0.0, std::f64::consts::FRAC_PI_2, 0.0],
        turns: false,
        axis: [0.0, 0.0, 1.0],
        parts: &[
            (
                0.4,
                [0.0, 0.0, 0.02],
                [0.0; 3],
                [0.0008, 0.0008, 0.0002, 0.0, 0.0, 0.0],
            ),
            (
                0.25,
                [0.0, 0.0, 0.14],
                [0.0, 0.0, std::f64::consts::FRAC_PI_4 + 0.3],
                [0.0003, 0.0002, 0.0002, 0.0, 0.0, 0.0],
            ),
        ],
        damping: 5.0,
    },
];

fn times(a: Matrix, b: Matrix) -> Matrix {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

fn on(a: Matrix, v: Vector) -> Vector {
    a.map(|row| dot(row, v))
}

fn transposed(a: Matrix) -> Matrix {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| a[j][i]))
}

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vector, b: Vector) -> Vector {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn plus(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn scaled(a: Vector, factor: f64) -> Vector {
    a.map(|one| one * factor)
}

/// Rodrigues' formula.
fn about(axis: Vector, angle: f64) -> Matrix {
    let (s, c) = angle.sin_cos();
    let [x, y, z] = axis;
    let v = 1.0 - c;
    [
        [c + x * x * v, x * y * v - z * s, x * z * v + y * s],
        [y * x * v + z * s, c + y * y * v, y * z * v - x * s],
        [z * x * v - y * s, z * y * v + x * s, c + z * z * v],
    ]
}

fn roll_pitch_yaw([roll, pitch, yaw]: Vector) -> Matrix {
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    times(about(z, yaw), times(about(y, pitch), about(x, roll)))
}

/// Joint forces that a motion takes, without those of damping: everything in the axes of the ground.
fn newton_euler(arm: &[Link], q: [f64; 4], v: [f64; 4], a: [f64; 4]) -> [f64; 4] {
    let mut rotation = roll_pitch_yaw([0.0; 3]);
    let (mut origin, mut omega, mut alpha) = ([0.0; 3], [0.0; 3], [0.0; 3]);
    // The ground accelerates upwards in place of gravity.
    let mut acceleration = [0.0, 0.0, 9.81];
    let mut places = Vec::new();
    for (i, link) in arm.iter().enumerate() {
        let arm = on(rotation, link.position);
        let carried = |arm: Vector, omega: Vector, alpha: Vector| {
            plus(cross(alpha, arm), cross(omega, cross(omega, arm)))
        };
        acceleration = plus(acceleration, carried(arm, omega, alpha));
        origin = plus(origin, arm);
        rotation = times(rotation, roll_pitch_yaw(link.orientation));
        let axis = on(rotation, link.axis);
        if link.turns {
            alpha = plus(
                alpha,
                plus(scaled(axis, a[i]), cross(omega, scaled(axis, v[i]))),
            );
            omega = plus(omega, scaled(axis, v[i]));
            rotation = times(rotation, about(link.axis, q[i]));
        } else {
            let way = scaled(axis, q[i]);
            let coriolis = scaled(cross(omega, scaled(axis, v[i])), 2.0);
            let sliding = plus(scaled(axis, a[i]), coriolis);
            acceleration = plus(acceleration, plus(carried(way, omega, alpha), sliding));
            origin = plus(origin, way);
        }
        let (mut force, mut moment) = ([0.0; 3], [0.0; 3]);
        for (mass, centre, turned, [xx, yy, zz, xy, xz, yz]) in link.parts {
            let lever = on(rotation, *centre);
            let inertial = scaled(plus(acceleration, carried(lever, omega, alpha)), *mass);
            let own = times(rotation, roll_pitch_yaw(*turned));
            let tensor = [[*xx, *xy, *xz], [*xy, *yy, *yz], [*xz, *yz, *zz]];
            let tensor = times(own, times(tensor, transposed(own)));
            force = plus(force, inertial);
            let spin = plus(on(tensor, alpha), cross(omega, on(tensor, omega)));
            moment = plus(moment, plus(cross(plus(origin, lever), inertial), spin));
        }
        places.push((origin, axis, force, moment));
    }
    // Forces and their moments about the ground's origin, from the tip to the base.
    let (mut force, mut moment) = ([0.0; 3], [0.0; 3]);
    let mut taken = [0.0; 4];
    for (i, (origin, axis, own, about_ground)) in places.into_iter().enumerate().rev() {
        force = plus(force, own);
        moment = plus(moment, about_ground);
        let here = plus(moment, scaled(cross(origin, force), -1.0));
        taken[i] = if arm[i].turns {
            dot(axis, here)
        } else {
            dot(axis, force)
        };
    }
    taken
}

/// A model of a robot file, and its values at states in the order speeds, coordinates.
/// What the equations have at a state; the matrix by rows.
struct Values {
    mass_matrix: Vec<f64>,
    bias: Vec<f64>,
    forces: Vec<f64>,
    potential: f64,
}

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(values) => values.iter().flat_map(numbers).collect(),
        value => value.as_f64().into_iter().collect(),
    }
}

fn values(spec: &str, states: &[[f64; 8]]) -> Vec<Values> {
    let model = Model::from_spec(spec).expect("a spec");
    let names: Vec<&str> = model
        .info()
        .states
        .iter()
        .map(|state| &*state.name)
        .collect();
    let expected = ["turn", "shoulder", "elbow", "reach"];
    let order: Vec<usize> = (expected.iter().map(|q| format!("v_{q}")))
        .chain(expected.iter().map(|q| (*q).to_owned()))
        .map(|name| {
            names
                .iter()
                .position(|state| *state == name)
                .expect("a state")
        })
        .collect();
    let cases = states.iter().map(|state| {
        let mut x = vec![0.0; 8];
        for (value, place) in state.iter().zip(&order) {
            x[*place] = *value;
        }
        Case {
            t: 0.0,
            x,
            u: vec![None; model.info().input_len()],
            p: model.info().default_parameters(),
            accelerations: None,
        }
    });
    let evaluation = model.evaluation(quantities().collect()).expect("values");
    let values = cases.map(|case| {
        let fields = evaluation.at(&case).fields;
        let of = |key: &str| numbers(&fields[key]);
        Values {
            mass_matrix: of("mass_matrix"),
            bias: of("bias"),
            forces: of("generalized_forces"),
            potential: of("potential_energy")[0],
        }
    });
    values.collect()
}

/// Speeds and coordinates, within the limits.
const STATES: [[f64; 8]; 3] = [
    [0.0, 0.0, 0.0, 0.0, 0.3, 0.7, -0.4, 0.1],
    [1.1, -0.6, 0.8, 0.3, -2.0, 1.9, 1.7, 0.02],
    [-0.4, 1.5, -2.2, -0.25, 0.9, -0.3, -2.1, 0.24],
];

const URDF: &str = include_str!("../robot/arm.urdf");
const MJCF: &str = include_str!("../robot/arm.xml");

fn imported(file: &str, text: &str, letters: &str, without: &[Without]) -> String {
    let options = Options {
        letters: Letters::read(letters),
        without: without.to_vec(),
        ..Options::default()
    };
    robot::import(file, text, &options).expect("a robot").spec
}

fn agree(what: &str, ours: f64, theirs: f64, scale: f64) {
    assert!(
        (ours - theirs).abs() <= ROUNDING * scale,
        "{what}: {ours} {theirs}"
    );
}

#[test]
fn an_arm_from_its_urdf_moves_as_newton_and_euler_say() {
    for letters in ["none", "all"] {
        let spec = imported("arm.urdf", URDF, letters, &[Without::Friction]);
        for (state, values) in STATES.iter().zip(values(&spec, &STATES)) {
            let (v, q) = state.split_at(4);
            let [v, q] = [v, q].map(|part| <[f64; 4]>::try_from(part).expect("four numbers"));
            let weight = newton_euler(&ARM, q, [0.0; 4], [0.0; 4]);
            let bias = newton_euler(&ARM, q, v, [0.0; 4]);
            for i in 0..4 {
                let ours = values.bias[i] - values.forces[i];
                agree("bias", ours, bias[i] + ARM[i].damping * v[i], 60.0);
                let mut unit = [0.0; 4];
                unit[i] = 1.0;
                let column = newton_euler(&ARM, q, [0.0; 4], unit);
                for j in 0..4 {
                    agree(
                        "M",
                        values.mass_matrix[4 * j + i],
                        column[j] - weight[j],
                        10.0,
                    );
                }
            }
        }
    }
}

#[test]
fn letters_and_what_is_left_out_change_what_they_name_alone() {
    let rigid = [
        Without::Damping,
        Without::Armature,
        Without::Springs,
        Without::Friction,
        Without::Compensation,
    ];
    let [all, bare] = [&[][..], &rigid]
        .map(|without| values(&imported("arm.xml", MJCF, "none", without), &STATES));
    let letters = values(&imported("arm.xml", MJCF, "inertias", &[]), &STATES);
    let armature = [0.05, 0.05, 0.05, 1.5];
    let damping = [0.2, 0.2, 0.2, 5.0];
    for ((state, all), (bare, letters)) in STATES.iter().zip(&all).zip(bare.iter().zip(&letters)) {
        for i in 0..4 {
            for j in 0..4 {
                let at = 4 * i + j;
                let added = if i == j { armature[i] } else { 0.0 };
                agree("M", all.mass_matrix[at], bare.mass_matrix[at] + added, 10.0);
                agree(
                    "M with letters",
                    letters.mass_matrix[at],
                    all.mass_matrix[at],
                    10.0,
                );
            }
            agree("bias", all.bias[i], bare.bias[i], 10.0);
        }
        // The elbow has dampers and a spring, 45° from where it is relaxed; its weight and that of what it carries
        // differ by the gripper's, which is compensated.
        let reach = all.forces[3] - bare.forces[3] + damping[3] * state[3];
        let carried = 1200.0 * 4.0 / 3.0 * std::f64::consts::PI * 0.03_f64.powi(3) * 9.81;
        assert!(reach.abs() <= carried, "{reach} {carried}");
        let spring = 2.0 * (state[6] - std::f64::consts::FRAC_PI_4).powi(2) / 2.0;
        agree("energy", all.potential - bare.potential, spring, 60.0);
    }
}

#[test]
fn what_is_chosen_in_vain_is_told() {
    let options = Options {
        letters: Letters::read("upperarm"),
        ..Options::default()
    };
    let error = robot::import("arm.urdf", URDF, &options)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("`upperarm`") && error.contains("`upper_arm`"),
        "{error}"
    );
}
