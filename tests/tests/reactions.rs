//! Reactions against Newton's laws by hand, where geometry or other constraints already satisfy the
//! rows of a contact; and reactions that Newton's laws do not tell.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_codegen::derived;
use appell_codegen::formulations::Against;
use appell_codegen::interpreted::InterpretedModel;
use appell_runtime::model::{At, Model};
use appell_test_kit::Random;
use appell_tests::engine::interpreter;
use appell_tests::formulations::assert_one_answer;
use appell_tests::point::Point;
use appell_tests::shipped;

/// Rounding of some ten operations against some hundred.
const ROUNDING: f64 = 1e-11;
const POINTS: usize = 12;
const G: f64 = 9.81;

/// A spec from its sections, with the gravity of all of them.
fn spec(sections: &str) -> String {
    format!(
        "[mechanism]\nname = 'test'\ntitle = 'test'\n{sections}\n\
         [loads]\nweight = {{ kind = 'gravity', down = '-z', acceleration = '9.81 [m/s^2]' }}\n"
    )
}

/// A sledge on a slope, held by `constraints`.
fn sledge(constraints: &str) -> String {
    spec(&format!(
        "[parameters]\nm = {{ value = 2, unit = 'kg' }}\nalpha = {{ value = 0.4, unit = 'rad' }}\n\
         [coordinates]\ns = {{ unit = 'm' }}\n\
         [frames]\nslope = {{ parent = 'ground', about_axis = 'y', by = 'alpha' }}\n\
         [points]\nG = {{ from = 'O', in = 'slope', at = ['s', 0, 0] }}\n\
         [bodies]\nsledge = {{ centre = 'G', mass = 'm' }}\n\
         [constraints]\n{constraints}\n[pseudo_velocities]\nv = 'dot(s)'"
    ))
}

/// A mass with three coordinates, held by `constraints`.
fn masses(constraints: &str) -> String {
    spec(&format!(
        "[parameters]\nm = {{ value = 2, unit = 'kg' }}\n\
         [coordinates]\nx = {{ unit = 'm' }}\ny = {{ unit = 'm' }}\nz = {{ unit = 'm' }}\n\
         [points]\nG = {{ from = 'O', in = 'ground', at = ['x', 'y', 'z'] }}\n\
         [bodies]\nmass = {{ centre = 'G', mass = 'm' }}\n\
         [constraints]\n{constraints}\n[pseudo_velocities]\nu = 'dot(x)'\nv = 'dot(y)'"
    ))
}

fn model(text: &str) -> InterpretedModel {
    interpreter(&shipped::read("test.toml", text))
}

fn names(model: &InterpretedModel) -> Vec<String> {
    let names = model.info().reactions.iter();
    names.map(|reaction| reaction.name.to_string()).collect()
}

/// The reactions, three components each.
fn reactions(model: &InterpretedModel, at: At<'_>) -> Vec<[f64; 3]> {
    let mut forces = vec![0.0; 3 * model.info().reactions.len()];
    model.constraint_forces(at, &mut forces);
    forces.chunks_exact(3).map(|f| [f[0], f[1], f[2]]).collect()
}

/// The reactions at the initial state.
fn initial(model: &InterpretedModel) -> Vec<[f64; 3]> {
    let info = model.info();
    let (x, p) = (info.initial_state(), info.default_parameters());
    let u = vec![0.0; info.input_len()];
    let (t, x, u, p) = (0.0, &x, &u, &p);
    reactions(model, At { t, x, u, p })
}

fn assert_force(found: [f64; 3], expected: [f64; 3]) {
    let size = expected.iter().fold(1.0_f64, |most, f| most.max(f.abs()));
    let close = |(a, b): (f64, f64)| (a - b).abs() <= ROUNDING * size;
    let same = found.into_iter().zip(expected).all(close);
    assert!(same, "{found:?}, not {expected:?}");
}

/// What is told of a spec.
fn told(text: &str) -> String {
    let derived = derived("test.toml", text).unwrap();
    appell_spec::Report::new("test.toml", text.to_owned(), derived.warnings).plain()
}

/// Newton's law for the centre of mass: F = m (a + g).
#[test]
fn a_wheel_on_a_slope_presses_with_its_weight_and_its_acceleration() {
    let file = "codegen/tests/audit/right/wheel_on_a_slope.toml";
    let text = std::fs::read_to_string(shipped::workspace().join(file)).unwrap();
    let model = model(&text);
    let info = model.info();
    let index = |name| info.state_index(name).unwrap();
    let n = info.state_len();
    let mut random = Random::of("slope");
    for _ in 0..POINTS {
        let point = Point::random(info, &mut random);
        let at = point.at();
        let (mut rates, mut a) = (vec![0.0; n], vec![0.0; n * n]);
        model.jacobians(at, &mut rates, &mut a, &mut []);
        let second = |name| -> f64 {
            let row = &a[index(name) * n..][..n];
            row.iter().zip(&rates).map(|(a, rate)| a * rate).sum()
        };
        let [m, radius, g, alpha] =
            ["m", "R", "g", "alpha"].map(|name| at.p[info.parameter_index(name).unwrap()]);
        let (theta, omega) = (at.x[index("theta")], at.x[index("omega_1")]);
        let up = -radius * (theta.sin() * rates[index("omega_1")] + theta.cos() * omega * omega);
        let (along, across) = (second("x_G"), second("y_G"));
        let (sin, cos) = alpha.sin_cos();
        let expected = [
            m * (cos * along + sin * up),
            m * across,
            m * (g - sin * along + cos * up),
        ];
        assert_force(reactions(&model, at)[0], expected);
    }
}

#[test]
fn newtons_law_holds_for_every_mechanism_that_rests_on_contacts() {
    let mut mechanisms = shipped::mechanisms_in("generated/mechanisms");
    mechanisms.extend(shipped::mechanisms_in("codegen/tests/audit/right"));
    let mut balanced = Vec::new();
    for mechanism in mechanisms {
        let verdict = assert_one_answer(&mechanism);
        let mut claims = verdict.comparisons.iter();
        if claims.any(|claim| claim.against == Against::Newton) {
            balanced.push(mechanism.name);
        }
    }
    for name in ["unicycle", "two_wheeled_pendulum", "bicycle", "wheel"] {
        assert!(balanced.iter().any(|known| known == name), "{balanced:?}");
    }
}

/// N = m g cos α, whichever way the constraint is written.
#[test]
fn what_geometry_keeps_on_a_slope_presses_across_it() {
    let across =
        "surface = { kind = 'fixed_velocity', point = 'G', in = 'slope', direction = [0, 0, 1] }";
    let doubled = across.replace("0, 0, 1", "0, 0, 3");
    let (sin, cos) = 0.4_f64.sin_cos();
    let normal = 2.0 * G * cos;
    for constraint in [across, &doubled] {
        let found = initial(&model(&sledge(constraint)));
        assert_force(found[0], [normal * sin, 0.0, normal * cos]);
    }
}

/// The same said twice is one force at one point.
#[test]
fn constraints_at_one_point_tell_the_force_there() {
    let twice = "one = { kind = 'fixed_velocity', point = 'G', in = 'ground', direction = [0, 0, 1] }\n\
                 two = { kind = 'fixed_velocity', point = 'G', in = 'ground', direction = [0, 0, 2] }";
    assert_force(initial(&model(&masses(twice)))[0], [0.0, 0.0, 2.0 * G]);
    assert!(!told(&masses(twice)).contains("undetermined-reaction"));
}

/// A cart and its wheel, both placed from the origin, with the same coordinate.
#[test]
fn a_wheel_carries_what_a_common_coordinate_ties_to_it() {
    let text = spec(
        "[parameters]\nm = { value = 3, unit = 'kg' }\nM = { value = 20, unit = 'kg' }\n\
         R = { value = 0.2, unit = 'm' }\n\
         [coordinates]\nx = { unit = 'm' }\nphi = { unit = 'rad' }\n\
         [frames]\nwheel = { parent = 'ground', about_axis = 'y', by = 'phi' }\n\
         [points]\nG = { from = 'O', in = 'ground', at = ['x', 0, '3*R'] }\n\
         W = { from = 'O', in = 'ground', at = ['x', 0, 'R'] }\n\
         P = { from = 'W', in = 'ground', at = [0, 0, '-R'] }\n\
         [bodies]\ncart = { centre = 'G', mass = 'M' }\n\
         wheel = { frame = 'wheel', centre = 'W', mass = 'm', inertia = { in = 'ground', diagonal = ['m*R^2/4', 'm*R^2/2', 'm*R^2/4'] } }\n\
         [constraints]\nrolling = { kind = 'rolling', body = 'wheel', contact = 'P' }\n\
         [pseudo_velocities]\nv = 'dot(x)'",
    );
    assert_force(initial(&model(&text))[0], [0.0, 0.0, 23.0 * G]);
}

#[test]
fn shares_that_no_law_of_motion_tells_are_not_reported() {
    let file = "codegen/tests/audit/undetermined-reaction.axle.toml";
    let axle = std::fs::read_to_string(shipped::workspace().join(file)).unwrap();
    assert!(names(&model(&axle)).is_empty());
    let report = told(&axle);
    let expected = "the reactions of `on_left` and `on_right` are statically indeterminate";
    assert!(report.contains(expected), "{report}");
    assert!(
        report.contains("`L_c` and `Q_c` are not reported"),
        "{report}"
    );

    // The other reactions are.
    let row = "sideways = { kind = 'velocity', zero = 'dot(y)' }";
    let held =
        "floor = { kind = 'fixed_velocity', point = 'G', in = 'ground', direction = [0, 0, 1] }";
    let text = masses(&format!(
        "{row}\nagain = {{ kind = 'velocity', zero = '2*dot(y)' }}\n{held}"
    ))
    .replace("v = 'dot(y)'", "");
    let model = model(&text);
    assert_eq!(names(&model), ["G"]);
    assert_force(initial(&model)[0], [0.0, 0.0, 2.0 * G]);
}

/// One wheel of the axle rolls, the other resists no sideways slip and no fall.
#[test]
fn one_constraint_for_each_prevented_motion_tells_all_reactions() {
    let file = "codegen/tests/audit/undetermined-reaction.axle.toml";
    let axle = std::fs::read_to_string(shipped::workspace().join(file)).unwrap();
    let rolling = "{ kind = \"rolling\", body = \"right_wheel\", contact = \"Q_c\" }";
    let along = "{ kind = \"fixed_velocity\", body = \"right_wheel\", point = \"Q_c\", in = \"yawed\", direction = [1, 0, 0] }";
    assert!(axle.contains(rolling));
    let text = axle.replace(rolling, along);
    let model = model(&text);
    assert_eq!(names(&model), ["L_c", "Q_c"]);
    let [left, right] = [0, 1].map(|wheel| initial(&model)[wheel]);
    assert_force(left, [0.0, 0.0, 8.0 * G]);
    assert_force(right, [0.0; 3]);
    let verdict = assert_one_answer(&shipped::read("axle.toml", &text));
    let mut claims = verdict.comparisons.iter();
    assert!(claims.any(|claim| claim.against == Against::Newton));
}

#[test]
fn position_constraints_that_say_the_same_share_untold_forces() {
    let text = masses(
        "one = { kind = 'position', zero = 'z + x', dependent = 'z' }\n\
         two = { kind = 'position', zero = '2*z + 2*x', dependent = 'x' }",
    );
    assert!(names(&model(&text)).is_empty());
    let report = told(&text);
    assert!(
        report.contains("the reactions of `one` and `two` are statically indeterminate"),
        "{report}"
    );
}
