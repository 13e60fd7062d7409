//! Accelerations and forces by name: against the motion, Newton's law and differences.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use appell_codegen::formulations::compare;
use appell_codegen::interpreted::InterpretedModel;
use appell_codegen::jit::JitModel;
use appell_codegen::program::FunctionKind;
use appell_codegen::{compile, derived};
use appell_runtime::differences;
use appell_runtime::model::{At, Gradient, Model};
use appell_test_kit::Random;

/// Rounding, times the condition number of the systems involved.
const ROUNDING: f64 = 1e-9;
/// Differences keep nine digits of ten.
const DIFFERENCES: f64 = 1e-6;

const DOUBLE_PENDULUM: &str = include_str!("../../generated/mechanisms/double_pendulum.toml");
const WHEEL: &str = include_str!("../../generated/mechanisms/rolling_wheel.toml");
const FOUR_BAR: &str = include_str!("../../generated/mechanisms/four_bar.toml");

/// A mechanism, with lines added to sections, each of which must exist.
fn with(text: &str, sections: &[(&str, &str)]) -> String {
    let mut text = text.to_owned();
    for (section, lines) in sections {
        let head = format!("[{section}]\n");
        assert!(text.contains(&head), "{head}");
        text = text.replace(&head, &format!("{head}{lines}\n"));
    }
    text
}

/// The wheel with pseudo-velocities that no formula solves for, in ranges that exclude nothing.
fn pivoted_wheel() -> String {
    WHEEL
        .replace(", range = [-1.5, 1.5]", "")
        .replace(
            "value = \"dot(psi)*sin(theta) + dot(phi)\"",
            "value = \"dot(psi)*cos(theta) - dot(phi)*sin(theta)\"",
        )
        .replace(
            "omega_1 = { value = \"dot(theta)\"",
            "omega_1 = { value = \"dot(psi)*sin(theta) + dot(phi)*cos(theta) + dot(theta)\"",
        )
        .replace(
            "value = \"dot(psi)*cos(theta)\"",
            "value = \"dot(theta)*cos(theta) + dot(phi)*sin(theta)\"",
        )
        .replace(
            "speed = { value = \"R*omega_2\"",
            "speed = { value = \"velocity(G, x)\"",
        )
}

/// Every way in which a spec is executed in the process.
fn engines(text: &str) -> Vec<Box<dyn Model>> {
    let program = compile("spec.toml", text, &FunctionKind::ALL);
    let program = program.unwrap_or_else(|report| panic!("{}", report.plain()));
    let compiled = JitModel::new(&program).unwrap();
    vec![Box::new(InterpretedModel::new(program)), Box::new(compiled)]
}

struct Point {
    x: Vec<f64>,
    u: Vec<f64>,
    p: Vec<f64>,
}

impl Point {
    fn random(model: &dyn Model, random: &mut Random) -> Self {
        let info = model.info();
        let mut numbers = |len: usize, low: f64| -> Vec<f64> {
            (0..len).map(|_| random.between(low, 1.2)).collect()
        };
        // Where motions start, equations are far from singular.
        let off: Vec<f64> = numbers(info.state_len(), -1.2);
        let states = info.states.iter().zip(off);
        Self {
            x: states.map(|(state, off)| state.value + 0.4 * off).collect(),
            u: numbers(info.input_len(), -1.2),
            // Of the order of one, as the steps of the differences are.
            p: numbers(info.parameter_len(), 0.6),
        }
    }

    fn at(&self) -> At<'_> {
        At {
            t: 0.3,
            x: &self.x,
            u: &self.u,
            p: &self.p,
        }
    }

    fn output(&self, model: &dyn Model, name: &str) -> f64 {
        let mut all = vec![f64::NAN; model.info().output_len()];
        model.outputs(self.at(), &mut all);
        all[model.info().output_index(name).unwrap()]
    }

    /// `∂y/∂x ẋ`
    fn rate_of(&self, model: &dyn Model, name: &str) -> f64 {
        let info = model.info();
        let (n, l) = (info.state_len(), info.output_len());
        let fill = |len| vec![f64::NAN; len];
        let [mut y, mut c, mut d] = [fill(l), fill(l * n), fill(l * info.input_len())];
        model.output_jacobians(self.at(), &mut y, &mut c, &mut d);
        let mut rates = fill(n);
        model.rates(self.at(), &mut rates);
        let row = info.output_index(name).unwrap();
        c[row * n..][..n]
            .iter()
            .zip(&rates)
            .map(|(c, r)| c * r)
            .sum()
    }

    /// Reaction at a place.
    fn reaction(&self, model: &dyn Model, place: usize) -> [f64; 3] {
        let mut all = vec![f64::NAN; 3 * model.info().reactions.len()];
        model.constraint_forces(self.at(), &mut all);
        [0, 1, 2].map(|k| all[3 * place + k])
    }
}

fn assert_close(what: &str, got: &[f64], wanted: &[f64], tolerance: f64) {
    assert_eq!(got.len(), wanted.len(), "{what}");
    let largest = wanted.iter().fold(1.0_f64, |size, w| size.max(w.abs()));
    for (place, (got, wanted)) in got.iter().zip(wanted).enumerate() {
        let error = (got - wanted).abs() / largest;
        assert!(error < tolerance, "{what}, {place}: {got} and {wanted}");
    }
}

/// Calls a check at random points of every execution.
fn everywhere(text: &str, check: impl Fn(&dyn Model, &Point)) {
    let mut random = Random::of(text);
    for model in engines(text) {
        for _ in 0..4 {
            let point = Point::random(&*model, &mut random);
            check(&*model, &point);
        }
    }
}

fn gradient(model: &dyn Model, write: impl FnOnce(Gradient<'_>)) -> [Vec<f64>; 3] {
    let info = model.info();
    let lengths = [info.state_len(), info.input_len(), info.parameter_len()];
    let mut all = lengths.map(|len| vec![f64::NAN; len]);
    let [x, u, p] = &mut all;
    write(Gradient { x, u, p });
    all
}

/// C, D and the gradients with respect to states, inputs and parameters against differences.
fn assert_jacobians(text: &str) {
    let mut random = Random::of(text);
    for model in engines(text) {
        let model = &*model;
        let point = Point::random(model, &mut random);
        let info = model.info();
        let (n, m, l) = (info.state_len(), info.input_len(), info.output_len());
        let fill = |len| vec![f64::NAN; len];
        let [mut y, mut c, mut d] = [fill(l), fill(l * n), fill(l * m)];
        model.output_jacobians(point.at(), &mut y, &mut c, &mut d);
        let [mut y_wanted, mut c_wanted, mut d_wanted] = [fill(l), fill(l * n), fill(l * m)];
        let wanted = [&mut y_wanted[..], &mut c_wanted, &mut d_wanted];
        differences::output_jacobians(model, point.at(), wanted);
        assert_close("outputs", &y, &y_wanted, 1e-12);
        assert_close("C", &c, &c_wanted, DIFFERENCES);
        assert_close("D", &d, &d_wanted, DIFFERENCES);
        let weights = l + l * n + l * m;
        let weights: Vec<f64> = (0..weights).map(|_| random.between(-1.0, 1.0)).collect();
        let got = gradient(model, |by| model.output_adjoint(point.at(), &weights, by));
        let wanted = gradient(model, |by| {
            differences::output_adjoint(model, point.at(), &weights, by);
        });
        assert_close("adjoint", &got.concat(), &wanted.concat(), DIFFERENCES);
    }
}

/// Velocities and accelerations of a point.
fn accelerometer(point: &str) -> String {
    ["x", "y", "z"]
        .map(|axis| {
            format!(
                "v_{axis} = {{ value = \"velocity({point}, {axis})\" }}\n\
                 a_{axis} = {{ value = \"acceleration({point}, {axis})\" }}\n"
            )
        })
        .concat()
}

fn accelerometers() -> [(&'static str, String); 4] {
    let outputs = |text: &str, point: &str| with(text, &[("outputs", &accelerometer(point))]);
    [
        ("tree", outputs(DOUBLE_PENDULUM, "G2")),
        ("rolling", outputs(WHEEL, "G")),
        ("pivoted", outputs(&pivoted_wheel(), "G")),
        ("closed", outputs(FOUR_BAR, "G2")),
    ]
}

#[test]
fn accelerations_are_the_rates_of_velocities() {
    for (what, text) in accelerometers() {
        everywhere(&text, |model, point| {
            for axis in ["x", "y", "z"] {
                let got = point.output(model, &format!("a_{axis}"));
                let wanted = point.rate_of(model, &format!("v_{axis}"));
                assert_close(what, &[got], &[wanted], ROUNDING);
            }
        });
    }
}

#[test]
fn accelerometers_have_exact_jacobians() {
    for (_, text) in accelerometers() {
        assert_jacobians(&text);
    }
}

#[test]
fn an_accelerometer_on_a_link_measures_in_its_frame() {
    let outputs = "\
a_x = { value = \"acceleration(G2, x)\" }
a_z = { value = \"acceleration(G2, z)\" }
along = { value = \"acceleration(G2, x, link2)\" }
by_hand = { value = \"cos(theta1 + theta2)*acceleration(G2, x) + sin(theta1 + theta2)*acceleration(G2, z)\" }
turn = { value = \"angular_velocity(link2, y)\" }
turning = { value = \"angular_acceleration(link2, y)\" }
turning_there = { value = \"angular_acceleration(link2, y, link1)\" }
";
    let text = with(DOUBLE_PENDULUM, &[("outputs", outputs)]);
    everywhere(&text, |model, point| {
        let of = |name: &str| point.output(model, name);
        assert_close("along", &[of("along")], &[of("by_hand")], ROUNDING);
        let turning = point.rate_of(model, "turn");
        assert_close("turning", &[of("turning")], &[turning], ROUNDING);
        assert_close("turning", &[of("turning_there")], &[turning], ROUNDING);
    });
    assert_jacobians(&text);
}

#[test]
fn reactions_are_those_that_are_reported() {
    let outputs = "\
n = { value = \"normal_force(rolling)\" }
r_x = { value = \"reaction(rolling, x)\" }
r_y = { value = \"reaction(rolling, y)\" }
r_z = { value = \"reaction(rolling, z)\" }
across = { value = \"reaction(rolling, x, yawed)\" }
by_hand = { value = \"cos(psi)*reaction(rolling, x) + sin(psi)*reaction(rolling, y)\" }
a_x = { value = \"m*acceleration(G, x)\" }
a_y = { value = \"m*acceleration(G, y)\" }
a_z = { value = \"m*acceleration(G, z) + m*g\" }
";
    for text in [WHEEL.to_owned(), pivoted_wheel()] {
        let text = with(&text, &[("outputs", outputs)]);
        everywhere(&text, |model, point| {
            let of = |name: &str| point.output(model, name);
            let reported = point.reaction(model, 0);
            let named = [of("r_x"), of("r_y"), of("r_z")];
            assert_close("reported", &named, &reported, ROUNDING);
            assert_close("normal", &[of("n")], &[reported[2]], ROUNDING);
            assert_close("in a frame", &[of("across")], &[of("by_hand")], ROUNDING);
            // Newton's law: the contact alone carries the wheel.
            let needed = [of("a_x"), of("a_y"), of("a_z")];
            assert_close("Newton", &named, &needed, ROUNDING);
        });
        assert_jacobians(&text);
    }
}

#[test]
fn multipliers_of_a_closed_loop_are_those_that_are_reported() {
    let outputs = "\
along = { value = \"reaction(along)\" }
upwards = { value = \"reaction(upwards)\" }
a_x = { value = \"m2*acceleration(G2, x) + m1*acceleration(G1, x)\" }
";
    let text = with(FOUR_BAR, &[("outputs", outputs)]);
    everywhere(&text, |model, point| {
        let reported = [0, 1].map(|place| point.reaction(model, place)[0]);
        let named = ["along", "upwards"].map(|name| point.output(model, name));
        assert_close("multipliers", &named, &reported, ROUNDING);
    });
    assert_jacobians(&text);
}

/// A block on a rough slope, driven by an input, with a hook on a spring.
const BLOCK: &str = include_str!("emit_support/block.toml");

#[test]
fn friction_follows_the_normal_force() {
    everywhere(BLOCK, |model, point| {
        let (v, s, f) = (point.x[0], point.x[1], point.u[0]);
        let p = |name| point.p[model.info().parameter_index(name).unwrap()];
        let (m, beta, g) = (p("m"), p("beta"), p("g"));
        let normal = m * g * beta.cos() + f * beta.sin();
        let rubbing = -p("mu") * normal * (v / p("eps")).tanh();
        let pulling = p("k") * s;
        let pushing = f * beta.cos();
        let a = (pushing - m * g * beta.sin() - pulling + rubbing) / m;
        let names = ["n", "across", "rubbing", "pulling", "pushing", "a"];
        let got = names.map(|name| point.output(model, name));
        let wanted = [normal, normal, rubbing, pulling, pushing, a];
        assert_close("by hand", &got, &wanted, ROUNDING);
        let mut rates = [f64::NAN; 2];
        model.rates(point.at(), &mut rates);
        assert_close("rates", &rates, &[a, v], ROUNDING);
        // The reported power is that of push and friction; the other loads have potentials.
        let power = model.energies(point.at()).power;
        assert_close("power", &[power], &[v * (pushing + rubbing)], ROUNDING);
    });
    assert_jacobians(BLOCK);
}

/// The wheel with a moment that resists rolling in proportion to the load on the contact.
fn rolling_resistance(text: &str) -> String {
    let parameters = "c_r = { value = 0.7, unit = \"1\" }";
    let load = "resist = { kind = \"torque\", on = \"wheel\", in = \"tilted\", vector = \
                [\"-0.3*c_r*R*normal_force(rolling)*smooth_sign(omega_1, 0.5 [rad/s])\", \
                 \"-c_r*R*normal_force(rolling)*smooth_sign(omega_2, 0.5 [rad/s])\", 0] }";
    with(text, &[("parameters", parameters), ("loads", load)])
}

const CELLS: &str = "\
n = { value = \"normal_force(rolling)\" }
r_x = { value = \"reaction(rolling, x, yawed)\" }
";
const RESISTING: &str = "resisting = { value = \"force(resist, y, tilted)\" }";

/// `∂y/∂z` by differences, a column for each entry of `z`.
fn slopes(z: &[f64], mut of: impl FnMut(&[f64]) -> Vec<f64>) -> Vec<Vec<f64>> {
    let mut varied = z.to_vec();
    let mut columns = Vec::new();
    for j in 0..z.len() {
        let mut at = |offset: f64| {
            varied[j] = z[j] + offset;
            let values = of(&varied);
            varied[j] = z[j];
            values
        };
        let h = 1e-5;
        let (above, below) = (at(h), at(-h));
        let column = above.iter().zip(&below).map(|(a, b)| (a - b) / (2.0 * h));
        columns.push(column.collect());
    }
    columns
}

/// A, B and P against differences of the rates; the work of the loads against the change of the energy.
fn assert_motion(what: &str, model: &dyn Model, point: &Point) {
    let info = model.info();
    let (n, m, k) = (info.state_len(), info.input_len(), info.parameter_len());
    let fill = |len| vec![f64::NAN; len];
    let rates = |at: At<'_>| {
        let mut rates = fill(n);
        model.rates(at, &mut rates);
        rates
    };
    let [mut a, mut b, mut p, mut x_dot] = [fill(n * n), fill(n * m), fill(n * k), fill(n)];
    model.jacobians(point.at(), &mut x_dot, &mut a, &mut b);
    model.parameter_jacobian(point.at(), &mut p);
    let at = point.at();
    let by_row = |columns: Vec<Vec<f64>>| -> Vec<f64> {
        let row = |row| columns.iter().map(move |column: &Vec<f64>| column[row]);
        (0..n).flat_map(row).collect()
    };
    let wanted = by_row(slopes(at.x, |x| rates(At { x, ..at })));
    assert_close(&format!("{what}: A"), &a, &wanted, DIFFERENCES);
    let wanted = by_row(slopes(at.u, |u| rates(At { u, ..at })));
    assert_close(&format!("{what}: B"), &b, &wanted, DIFFERENCES);
    let wanted = by_row(slopes(at.p, |p| rates(At { p, ..at })));
    assert_close(&format!("{what}: P"), &p, &wanted, DIFFERENCES);

    let energy = |x: &[f64]| {
        let energies = model.energies(At { x, ..at });
        vec![energies.kinetic + energies.potential]
    };
    let gradient = slopes(at.x, energy);
    let change: f64 = gradient.iter().zip(&x_dot).map(|(e, x)| e[0] * x).sum();
    let power = model.energies(at).power;
    assert_close(&format!("{what}: energy"), &[change], &[power], DIFFERENCES);
}

fn assert_one_answer(text: &str) {
    let derived = derived("spec.toml", text).unwrap_or_else(|report| panic!("{}", report.plain()));
    let verdict = compare(&derived.mechanism, &derived.derivation).unwrap();
    assert!(verdict.agrees(), "{verdict:#?}");
}

#[test]
fn a_reaction_in_a_load_is_that_of_the_motion_with_the_load() {
    for text in [WHEEL.to_owned(), pivoted_wheel()] {
        let text = with(&rolling_resistance(&text), &[("outputs", CELLS)]);
        let text = with(&text, &[("outputs", RESISTING)]);
        everywhere(&text, |model, point| {
            let p = |name| point.p[model.info().parameter_index(name).unwrap()];
            let n = point.output(model, "n");
            let resisting = -p("c_r") * p("R") * n * (point.x[1] / 0.5).tanh();
            let got = point.output(model, "resisting");
            assert_close("the moment", &[got], &[resisting], ROUNDING);
            let reported = point.reaction(model, 0);
            assert_close("reported", &[n], &[reported[2]], ROUNDING);
            assert_motion("wheel", model, point);
        });
        assert_jacobians(&text);
        assert_one_answer(&text);
    }
}

/// A slider-crank with friction on its slider, a given function of its normal force.
fn slider_crank(law: &str) -> String {
    include_str!("emit_support/slider_crank.toml").replace("LAW", law)
}

/// The friction law, the relation of force and multiplier, and states with accelerations of the crank and
/// multipliers.
type Rubbing = (&'static str, fn(f64) -> f64, [[f64; 5]; 3]);

/// By another program: Lagrange's multiplier of `M q̈ = Q + Jᵀ λ`, found by bracketing so that the load has it.
const RUBBING: [Rubbing; 2] = [
    (
        "smooth_abs(reaction(guide), 0.001 [N])",
        |n| n.hypot(1e-3),
        [
            [
                40.0,
                12.0,
                1.0,
                114.522_621_783_277_27,
                4.434_417_437_734_13,
            ],
            [
                130.0,
                -20.0,
                0.5,
                338.839_874_260_500_5,
                5.617_966_055_364_278_5,
            ],
            [
                250.0,
                30.0,
                -1.0,
                -536.881_195_142_024_6,
                8.189_510_087_366_635,
            ],
        ],
    ),
    (
        "reaction(guide)",
        |n| n,
        [
            [
                40.0,
                12.0,
                1.0,
                114.522_622_141_418_1,
                4.434_417_442_818_405,
            ],
            [
                130.0,
                -20.0,
                0.5,
                338.839_873_984_390_75,
                5.617_966_050_857_084,
            ],
            [
                250.0,
                30.0,
                -1.0,
                -536.881_194_949_735_5,
                8.189_510_090_436_322,
            ],
        ],
    ),
];

#[test]
fn friction_in_a_closed_loop_has_the_multiplier_of_its_own_motion() {
    for (law, of_normal, places) in RUBBING {
        let text = slider_crank(law);
        for model in engines(&text) {
            let p: Vec<f64> = model.info().parameters.iter().map(|p| p.value).collect();
            for [degrees, omega, tau, turning, normal] in places {
                let phi = degrees.to_radians();
                let psi = (0.06 * phi.sin() / 0.2).asin();
                let x = vec![omega, phi, psi];
                let (u, p) = (vec![tau], p.clone());
                let point = Point { x, u, p };
                let mut rates = [f64::NAN; 3];
                model.rates(point.at(), &mut rates);
                assert_close("turning", &rates[..1], &[turning], ROUNDING);
                let got = point.output(&*model, "normal");
                assert_close("normal", &[got], &[normal], ROUNDING);
            }
        }
        everywhere(&text, |model, point| {
            let of = |name| point.output(model, name);
            let mu = point.p[model.info().parameter_index("mu").unwrap()];
            let rubbing = -mu * of_normal(of("normal")) * (of("v") / 0.01).tanh();
            assert_close("rubbing", &[of("rubbing")], &[rubbing], ROUNDING);
            assert_motion("slider-crank", model, point);
        });
        assert_jacobians(&text);
        assert_one_answer(&text);
    }
}

#[test]
fn several_reactions_in_one_load_are_those_of_one_motion() {
    let load = "\
pins = { kind = \"generalized\", velocity = \"omega\", force = \"-0.05 [m]*(smooth_abs(reaction(along), 1 [N]) + 0.5*reaction(upwards))*smooth_sign(omega, 0.5 [rad/s])\" }
rocker = { kind = \"generalized\", velocity = \"omega\", force = \"-0.02 [m]*reaction(along) + 0.1*force(pins)\" }
";
    let outputs = "\
along = { value = \"reaction(along)\" }
upwards = { value = \"reaction(upwards)\" }
pins = { value = \"force(pins)\" }
rocker = { value = \"force(rocker)\" }
turns = { value = \"smooth_sign(omega, 0.5 [rad/s])\" }
";
    let text = with(FOUR_BAR, &[("loads", load), ("outputs", outputs)]);
    everywhere(&text, |model, point| {
        let of = |name| point.output(model, name);
        let pins = -0.05 * (of("along").hypot(1.0) + 0.5 * of("upwards")) * of("turns");
        assert_close("pins", &[of("pins")], &[pins], ROUNDING);
        let rocker = -0.02 * of("along") + 0.1 * of("pins");
        assert_close("rocker", &[of("rocker")], &[rocker], ROUNDING);
        let reported = [0, 1].map(|place| point.reaction(model, place)[0]);
        assert_close("told", &[of("along"), of("upwards")], &reported, ROUNDING);
        assert_motion("four-bar", model, point);
    });
    assert_one_answer(&text);
}

#[test]
fn loads_name_multipliers_and_the_forces_of_other_loads() {
    let loads = "\
pin = { kind = \"generalized\", velocity = \"omega\", force = \"-0.1 [m]*smooth_abs(reaction(along), 1 [N])*smooth_sign(omega, 0.5 [rad/s])\" }
spring = { kind = \"spring\", between = [\"O\", \"B\"], stiffness = \"30 [N/m]\", relaxed = \"0.1 [m]\" }
oil = { kind = \"damper\", between = [\"D\", \"B\"], damping = \"2 [N*s/m]\" }
guide = { kind = \"torque\", on = \"rocker\", in = \"rocker\", vector = [0, \"0.2 [m]*(force(spring) + force(oil)) + 0.3*force(pin)\", 0] }
";
    let outputs = "\
measured = { value = \"force(guide, y, coupler)\" }
spring = { value = \"force(spring)\" }
oil = { value = \"force(oil)\" }
pin = { value = \"force(pin)\" }
";
    let text = with(FOUR_BAR, &[("loads", loads), ("outputs", outputs)]);
    everywhere(&text, |model, point| {
        let of = |name| point.output(model, name);
        let guide = 0.2 * (of("spring") + of("oil")) + 0.3 * of("pin");
        assert_close("guide", &[of("measured")], &[guide], ROUNDING);
        assert_motion("four-bar", model, point);
    });
    assert_jacobians(&text);
    assert_one_answer(&text);
}

#[test]
fn what_cannot_be_told_is_refused_where_it_is_named() {
    // Two contacts are redundant: their individual reactions are indeterminate.
    let text = with(
        BLOCK,
        &[
            (
                "constraints",
                "also = { kind = \"fixed_velocity\", point = \"D\", in = \"slope\", direction = [0, 0, 1] }",
            ),
            (
                "points",
                "D = { from = \"C\", in = \"slope\", at = [\"1 [m]\", 0, 0] }",
            ),
        ],
    );
    let refused = compile("spec.toml", &text, &FunctionKind::ALL)
        .err()
        .unwrap();
    let shown = refused.plain();
    for part in [
        "undetermined-reaction",
        "`normal_force(ground)`",
        "friction = ",
    ] {
        assert!(shown.contains(part), "{part} is not in {shown}");
    }
    // A coordinate lifts the wheel off the ground: the normal of the surface is unknown.
    let text = with(
        &WHEEL
            .replace("R*cos(theta)\"], about", "h\"], about")
            .replace(
                "psi   = {",
                "h = { unit = \"m\", initial = 0.3 }\npsi   = {",
            ),
        &[("outputs", "n = { value = \"normal_force(rolling)\" }")],
    );
    let refused = compile("spec.toml", &text, &FunctionKind::ALL)
        .err()
        .unwrap();
    let shown = refused.plain();
    assert!(
        shown.contains("n = {") && shown.contains("contact-not-judged"),
        "{shown}"
    );
}

/// Each load doubles the degree of the one before.
#[test]
fn chains_of_forces_stay_within_limits() {
    let chain = |length: usize, force: &str| {
        let links: Vec<String> = (1..length)
            .map(|i| {
                let last = format!("force(f{})", i - 1);
                let force = force.replace("{}", &last);
                format!(
                    "f{i} = {{ kind = \"generalized\", velocity = \"v\", force = \"{force}\" }}\n"
                )
            })
            .collect();
        let first = "f0 = { kind = \"generalized\", velocity = \"v\", force = \"v*1 [N*s/m]\" }\n";
        with(BLOCK, &[("loads", &format!("{first}{}", links.concat()))])
    };
    let refused = compile(
        "spec.toml",
        &chain(40, "{}*{}/(1 [N])"),
        &FunctionKind::STANDARD,
    );
    let shown = refused.err().unwrap().plain();
    assert!(shown.contains("limit-exceeded"), "{shown}");
    let sums = compile("spec.toml", &chain(200, "{} + {}"), &FunctionKind::STANDARD);
    assert!(sums.is_ok());
}
