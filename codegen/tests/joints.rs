//! Where joints put their frames and points, against rotations and displacements in closed form.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use std::fmt::Write as _;

use appell_codegen::compile;
use appell_codegen::interpreted::InterpretedModel;
use appell_codegen::program::FunctionKind;
use appell_runtime::model::{At, Model};

/// A joint on the ground with a body, its place and those of the ends of the frame's axes.
fn spec(joint: &str) -> String {
    let mut text = format!(
        "\
[mechanism]
name = 'joint'
title = 'a joint'
[parameters]
m = {{ value = 2, unit = 'kg' }}
I = {{ value = 0.1, unit = 'kg*m^2' }}
n = {{ value = -2, unit = '1' }}
[joints]
link = {{ {joint} }}
[bodies]
link = {{ frame = 'link', centre = 'link', mass = 'm', inertia = {{ in = 'link', diagonal = ['I', 'I', 'I'] }} }}
[points]
X = {{ from = 'link', in = 'link', at = [1, 0, 0] }}
Y = {{ from = 'link', in = 'link', at = [0, 1, 0] }}
Z = {{ from = 'link', in = 'link', at = [0, 0, 1] }}
[outputs]
"
    )
    .replace("at = [1, 0, 0]", "at = ['1 [m]', 0, 0]")
    .replace("at = [0, 1, 0]", "at = [0, '1 [m]', 0]")
    .replace("at = [0, 0, 1]", "at = [0, 0, '1 [m]']");
    for point in ["link", "X", "Y", "Z"] {
        for axis in ["x", "y", "z"] {
            let output = format!("value = 'position({point}, {axis})', unit = 'm'");
            writeln!(text, "{point}_{axis} = {{ {output} }}").unwrap();
        }
    }
    text
}

/// The place of the point and the columns of the rotation matrix where the coordinates have some values.
fn placed(joint: &str, coordinates: &[f64]) -> [[f64; 3]; 4] {
    let program = compile("joint.toml", &spec(joint), &FunctionKind::ALL);
    let model =
        InterpretedModel::new(program.unwrap_or_else(|report| panic!("{}", report.plain())));
    let info = model.info();
    let mut x = vec![0.0; info.state_len()];
    x[info.speeds..].copy_from_slice(coordinates);
    let p: Vec<f64> = info.parameters.iter().map(|p| p.value).collect();
    let at = At {
        t: 0.0,
        x: &x,
        u: &[],
        p: &p,
    };
    let mut all = vec![f64::NAN; info.output_len()];
    model.outputs(at, &mut all);
    let mut rows = [[0.0; 3]; 4];
    for (row, three) in rows.iter_mut().zip(all.chunks(3)) {
        row.copy_from_slice(three);
    }
    let origin = rows[0];
    for column in &mut rows[1..] {
        for (part, start) in column.iter_mut().zip(origin) {
            *part -= start;
        }
    }
    rows
}

fn unit(n: [f64; 3]) -> [f64; 3] {
    let length = n.iter().map(|x| x * x).sum::<f64>().sqrt();
    n.map(|x| x / length)
}

/// Columns of the rotation by an angle about an axis: Rodrigues' formula.
fn turned(n: [f64; 3], angle: f64) -> [[f64; 3]; 3] {
    let n = unit(n);
    [0, 1, 2].map(|column| {
        let mut e = [0.0; 3];
        e[column] = 1.0;
        let cross = [
            n[1] * e[2] - n[2] * e[1],
            n[2] * e[0] - n[0] * e[2],
            n[0] * e[1] - n[1] * e[0],
        ];
        let along = n[column];
        [0, 1, 2].map(|i| {
            e[i] * angle.cos() + cross[i] * angle.sin() + n[i] * along * (1.0 - angle.cos())
        })
    })
}

/// The product of two rotations by their columns.
fn after(first: [[f64; 3]; 3], second: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    second.map(|column| [0, 1, 2].map(|i| (0..3).map(|k| first[k][i] * column[k]).sum()))
}

fn assert_placed(joint: &str, coordinates: &[f64], origin: [f64; 3], frame: [[f64; 3]; 3]) {
    let got = placed(joint, coordinates);
    let wanted = [origin, frame[0], frame[1], frame[2]];
    for (got, wanted) in got.iter().flatten().zip(wanted.iter().flatten()) {
        assert!((got - wanted).abs() < 1e-13, "{joint}: {got} and {wanted}");
    }
}

const AXES: &[(&str, [f64; 3])] = &[
    ("'z'", [0.0, 0.0, 1.0]),
    ("'-x'", [-1.0, 0.0, 0.0]),
    ("[0, -3, 0]", [0.0, -3.0, 0.0]),
    ("[1, -2, 0]", [1.0, -2.0, 0.0]),
    ("[0, -1, 0.5]", [0.0, -1.0, 0.5]),
    ("[-0.3, 0, '1/5']", [-0.3, 0.0, 0.2]),
    ("[1, 2, -3]", [1.0, 2.0, -3.0]),
    ("[-1, 'n', '-n/4']", [-1.0, -2.0, 0.5]),
    ("[0, 'n', 0]", [0.0, -2.0, 0.0]),
    ("[-6e-1, 0.8, 0.0]", [-0.6, 0.8, 0.0]),
];

#[test]
fn joints_turn_about_their_axes_and_move_along_them() {
    for (axis, n) in AXES {
        let joint =
            format!("kind = 'revolute', at = [0, '2 [m]', 0], axis = {axis}, offset = '-0.3'");
        assert_placed(&joint, &[0.7], [0.0, 2.0, 0.0], turned(*n, 0.4));
        let joint =
            format!("kind = 'prismatic', at = ['3 [m]', 0, 0], axis = {axis}, offset = '-1 [m]'");
        let moved = unit(*n).map(|x| x * -0.6);
        assert_placed(
            &joint,
            &[0.4],
            [3.0 + moved[0], moved[1], moved[2]],
            turned(*n, 0.0),
        );
        let joint = format!("kind = 'screw', axis = {axis}, pitch = '0.1 [m]'");
        let moved = unit(*n).map(|x| x * 0.1 * 2.5 / std::f64::consts::TAU);
        assert_placed(&joint, &[2.5], moved, turned(*n, 2.5));
        let joint = format!(
            "kind = 'cylindrical', axis = {axis}, turns = [{{ about_axis = 'y', by = 0.9 }}], at = [0, 0, '1 [m]']"
        );
        let before = turned([0.0, 1.0, 0.0], 0.9);
        let along = unit(*n).map(|x| x * 0.2);
        let moved = [0, 1, 2].map(|i| (0..3).map(|k| before[k][i] * along[k]).sum::<f64>());
        let place = [moved[0], moved[1], 1.0 + moved[2]];
        assert_placed(&joint, &[-1.1, 0.2], place, after(before, turned(*n, -1.1)));
        let joint = format!("kind = 'universal', axis = [1, 1, 5], second_axis = {axis}");
        let frame = after(turned([1.0, 1.0, 5.0], 0.3), turned(*n, 0.5));
        assert_placed(&joint, &[0.3, 0.5], [0.0; 3], frame);
    }
}

#[test]
fn planar_and_free_joints_move_as_they_say() {
    let joint = "kind = 'planar', axis = '-x', at = [0, 0, '1 [m]']";
    assert_placed(
        joint,
        &[0.2, 0.3, 0.4],
        [0.0, 0.2, 1.3],
        turned([-1.0, 0.0, 0.0], 0.4),
    );
    let joint = "kind = 'free', at = ['1 [m]', 0, 0]";
    let (s, c) = 0.35_f64.sin_cos();
    let n = unit([1.0, -1.0, 2.0]);
    let attitude = [c, s * n[0], s * n[1], s * n[2]];
    let coordinates = [&[0.1, 0.2, 0.3], attitude.as_slice()].concat();
    assert_placed(joint, &coordinates, [1.1, 0.2, 0.3], turned(n, 0.7));
}
