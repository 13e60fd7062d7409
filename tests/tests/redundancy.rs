//! Constraints that follow from others are left out with a warning: the motion is that of all of them.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_codegen::derived;
use appell_runtime::model::Model;
use appell_test_kit::Random;
use appell_tests::engine::{Evaluation, interpreter};
use appell_tests::formulations::assert_one_answer;
use appell_tests::point::Point;
use appell_tests::shipped;

const POINTS: usize = 12;

/// A robot on two driven wheels, with the constraints on them.
fn robot(constraints: &str) -> String {
    format!(
        "[mechanism]\nname = 'robot'\ntitle = 'two driven wheels on one axle'\n\
         [parameters]\nm = {{ value = 8, unit = 'kg' }}\nm_w = {{ value = 0.6, unit = 'kg' }}\n\
         R = {{ value = 0.1, unit = 'm' }}\nb = {{ value = 0.2, unit = 'm' }}\n\
         l = {{ value = 0.15, unit = 'm' }}\nJ = {{ value = 0.3, unit = 'kg*m^2' }}\n\
         [coordinates]\nx = {{ unit = 'm' }}\ny = {{ unit = 'm' }}\npsi = {{ unit = 'rad' }}\n\
         left = {{ unit = 'rad' }}\nright = {{ unit = 'rad' }}\n\
         [inputs]\ntau_l = {{ unit = 'N*m' }}\ntau_r = {{ unit = 'N*m' }}\n\
         [frames]\nyawed = {{ parent = 'ground', about_axis = 'z', by = 'psi' }}\n\
         left_wheel = {{ parent = 'yawed', about_axis = 'y', by = 'left' }}\n\
         right_wheel = {{ parent = 'yawed', about_axis = 'y', by = 'right' }}\n\
         [points]\nA = {{ from = 'O', in = 'ground', at = ['x', 'y', 'R'] }}\n\
         C = {{ from = 'A', in = 'yawed', at = ['l', 0, 0] }}\n\
         L = {{ from = 'A', in = 'yawed', at = [0, 'b', 0] }}\n\
         L_ground = {{ from = 'L', in = 'yawed', at = [0, 0, '-R'] }}\n\
         Q = {{ from = 'A', in = 'yawed', at = [0, '-b', 0] }}\n\
         Q_ground = {{ from = 'Q', in = 'yawed', at = [0, 0, '-R'] }}\n\
         [bodies]\nchassis = {{ frame = 'yawed', centre = 'C', mass = 'm', inertia = {{ in = 'yawed', diagonal = ['J', 'J', 'J'] }} }}\n\
         wheel_l = {{ frame = 'left_wheel', centre = 'L', mass = 'm_w', inertia = {{ in = 'yawed', diagonal = ['m_w*R^2/4', 'm_w*R^2/2', 'm_w*R^2/4'] }} }}\n\
         wheel_r = {{ frame = 'right_wheel', centre = 'Q', mass = 'm_w', inertia = {{ in = 'yawed', diagonal = ['m_w*R^2/4', 'm_w*R^2/2', 'm_w*R^2/4'] }} }}\n\
         [constraints]\n{constraints}\n\
         [pseudo_velocities]\nv = 'dot(x)*cos(psi) + dot(y)*sin(psi)'\nw = 'dot(psi)'\n\
         [loads]\nweight = {{ kind = 'gravity', down = '-z', acceleration = '9.81 [m/s^2]' }}\n\
         drive_l = {{ kind = 'torque', on = 'wheel_l', reaction_on = 'chassis', in = 'yawed', vector = [0, 'tau_l', 0] }}\n\
         drive_r = {{ kind = 'torque', on = 'wheel_r', reaction_on = 'chassis', in = 'yawed', vector = [0, 'tau_r', 0] }}\n"
    )
}

const ROLLING: &str = "on_left = { kind = 'rolling', body = 'wheel_l', contact = 'L_ground' }\n\
                       on_right = { kind = 'rolling', body = 'wheel_r', contact = 'Q_ground' }";
/// The same demands without a row too many: along the axle and, for each wheel, across it.
const INDEPENDENT: &str = "along = { kind = 'velocity', zero = '-dot(x)*sin(psi) + dot(y)*cos(psi)' }\n\
     on_left = { kind = 'velocity', zero = 'dot(x)*cos(psi) + dot(y)*sin(psi) - b*dot(psi) - R*dot(left)' }\n\
     on_right = { kind = 'velocity', zero = 'dot(x)*cos(psi) + dot(y)*sin(psi) + b*dot(psi) - R*dot(right)' }";

#[test]
fn two_wheels_on_one_axle_move_as_kane_and_lagrange_say() {
    let mechanism = shipped::read("robot.toml", &robot(ROLLING));
    assert_one_answer(&mechanism);
}

#[test]
fn two_wheels_on_one_axle_move_as_with_the_independent_constraints() {
    let all = shipped::read("robot.toml", &robot(ROLLING));
    let few = shipped::read("robot.toml", &robot(INDEPENDENT));
    let (all, few) = (interpreter(&all), interpreter(&few));
    let mut random = Random::of("robot");
    let mut points: Vec<Point> = (0..POINTS)
        .map(|_| Point::random(all.info(), &mut random))
        .collect();
    // Headings along the axes of the ground, where a component in the ground says nothing.
    let yaw = all.info().speeds + 2;
    for (point, heading) in points.iter_mut().zip([0.0, 0.5, 1.0, 1.5]) {
        point.x[yaw] = heading * std::f64::consts::PI;
    }
    for point in points {
        let (a, b) = (
            Evaluation::of(&all, point.at()).rates,
            Evaluation::of(&few, point.at()).rates,
        );
        for (a, b) in a.iter().zip(&b) {
            assert!((a - b).abs() <= 1e-12 * (1.0 + b.abs()), "{a} is not {b}");
        }
    }
}

#[test]
fn the_warning_names_the_row_that_is_left_out() {
    let derived = derived("robot.toml", &robot(ROLLING)).unwrap();
    let shown = appell_spec::Report::new("robot.toml", robot(ROLLING), derived.warnings).plain();
    assert!(
        shown.contains("`on_right.yawed_y` follows from `on_left.x`, `on_left.y` and is left out"),
        "{shown}"
    );
    assert!(
        shown.contains("`L_ground` and `Q_ground` are not reported"),
        "{shown}"
    );
    let solved = derived.derivation.velocities.solved_numerically;
    assert!(solved.is_empty(), "{solved:?}");
}
