//! Long motions of the shipped models: the free ones keep their energy, the controlled ones are
//! those of the paper.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use appell_codegen::symbolic::{Graph, evaluate};
use appell_models::Shipped;
use appell_report::figure::Figure;
use appell_runtime::inputs::SwitchedInputs;
use appell_runtime::integrate::Options;
use appell_runtime::model::Model;
use appell_runtime::simulate::{Sampling, Simulation};
use appell_runtime::trajectory::Trajectory;
use appell_tests::engine::assert_close;
use appell_tests::formula::{Scope, definitions};
use appell_tests::reference::{cases, number};
use appell_tests::steering;

/// Relative to the energy at the start, over a minute.
const ENERGY: f64 = 1e-10;
/// Tolerance per step.
const TOLERANCE: f64 = 1e-12;
/// Printed digits of the final states.
const FINAL_STATE: f64 = 5e-8;
/// Maxima between samples 1 ms apart are flat: half a unit of the last printed digit remains.
const MAXIMA: f64 = 1e-4;
/// A printed gain has two decimals.
const PRINTED_GAIN: f64 = 0.006;

fn model(name: &str) -> &'static dyn Model {
    Shipped::find(name).unwrap().model
}

/// A state of zeros but for these.
fn state(model: &dyn Model, values: &[(&str, f64)]) -> Vec<f64> {
    let mut x = vec![0.0; model.info().state_len()];
    for (name, value) in values {
        x[model.info().state_index(name).unwrap()] = *value;
    }
    x
}

/// Fast rolling, which keeps upright, with tilt and yaw.
const FAST: &[(&str, f64)] = &[
    ("omega_1", 0.1),
    ("omega_2", 16.0),
    ("omega_3", 0.3),
    ("theta", 0.05),
    ("psi", 0.2),
];

fn assert_energy_is_kept(name: &str, more: &[(&str, f64)]) {
    let model = model(name);
    let mut simulation = Simulation::new(model);
    simulation.initial_state = state(model, &[FAST, more].concat());
    simulation.span = [0.0, 60.0];
    simulation.options = Options::with_tolerances(TOLERANCE, TOLERANCE);
    simulation.sampling = Sampling::Every(0.1);
    simulation.extras.energies = true;
    let motion = simulation.run().unwrap();
    assert_eq!(motion.len(), 601);
    let energy = |row: usize| {
        let at = appell_runtime::model::At {
            t: motion.times()[row],
            x: motion.state(row),
            u: motion.inputs(row),
            p: motion.parameters(),
        };
        let energies = model.energies(at);
        energies.kinetic + energies.potential
    };
    let start = energy(0);
    for row in 0..motion.len() {
        assert_close(
            &format!("{name} at {} s", motion.times()[row]),
            &[energy(row)],
            &[start],
            ENERGY,
            0.0,
        );
    }
    // It moved: tilt and yaw oscillate.
    let tilt = motion.column("theta").unwrap();
    assert!(
        tilt.iter().any(|t| *t < 0.0) || tilt.iter().any(|t| *t > 0.06),
        "no motion"
    );
}

#[test]
fn a_free_rolling_wheel_keeps_its_energy_for_a_minute() {
    assert_energy_is_kept("rolling_wheel", &[]);
}

#[test]
fn a_free_unicycle_keeps_its_energy_for_a_minute() {
    assert_energy_is_kept("unicycle", &[("r", 0.01), ("sigma", 0.02)]);
}

/// Gains in closed form with all poles at -p.
const LANE: &str = "
    q = 12*Fd**2*R*m + 8*Fd**2*R*m0 + g*m
    Dth = -5*R*m*p*(-36*Fd**2*R*g*m - 24*Fd**2*R*g*m0 + 15*R**2*m*p**4 + 12*R**2*m0*p**4 + 50*R*g*m*p**2 + 40*R*g*m0*p**2 + 12*g**2*m + 12*g**2*m0)/(2*g*q)
    Pth = m*(-288*Fd**6*R**2*g*m - 192*Fd**6*R**2*g*m0 + 1800*Fd**4*R**2*g*m*p**2 + 1200*Fd**4*R**2*g*m0*p**2 + 192*Fd**4*R*g**2*m + 144*Fd**4*R*g**2*m0 + 10*Fd**2*R**3*m*p**6 - 750*Fd**2*R**2*g*m*p**4 - 600*Fd**2*R**2*g*m0*p**4 - 600*Fd**2*R*g**2*m*p**2 - 600*Fd**2*R*g**2*m0*p**2 - 32*Fd**2*g**3*m - 40*Fd**2*g**3*m0 + 5*R**2*g*m*p**6)/(8*Fd**2*g*q)
    Dr = 10*m*m0*p*(R*p**2 + 3*g)*(3*R*p**2 + g)/(g*q)
    Pr = m0*(-12*Fd**2*R*g**2*m - 8*Fd**2*R*g**2*m0 + 5*R**3*m*p**6 + 75*R**2*g*m*p**4 + 75*R*g**2*m*p**2 + 4*g**3*m)/(R*g*q)
    Ppsi = 15*R**2*m*p**5/(4*Fd*g)
    Py = 5*R*m*p**6/(8*Fd**2*g)";
const TURN: &str = "
    q = 12*Fd**2*R*m + 8*Fd**2*R*m0 + g*m
    Dth = -5*R*m*p*(-60*Fd**2*R*g*m - 40*Fd**2*R*g*m0 + 5*R**2*m*p**4 + 4*R**2*m0*p**4 + 50*R*g*m*p**2 + 40*R*g*m0*p**2 + 20*g**2*m + 20*g**2*m0)/(4*g*q)
    Pth = -m*(144*Fd**4*R**2*m + 96*Fd**4*R**2*m0 - 600*Fd**2*R**2*m*p**2 - 400*Fd**2*R**2*m0*p**2 - 96*Fd**2*R*g*m - 72*Fd**2*R*g*m0 + 125*R**2*m*p**4 + 100*R**2*m0*p**4 + 200*R*g*m*p**2 + 200*R*g*m0*p**2 + 16*g**2*m + 20*g**2*m0)/(4*q)
    Dr = 5*m*m0*p*(R**2*p**4 + 10*R*g*p**2 + 5*g**2)/(g*q)
    Pr = m0*(-12*Fd**2*R*g*m - 8*Fd**2*R*g*m0 + 25*R**2*m*p**4 + 50*R*g*m*p**2 + 4*g**2*m)/(R*q)
    Ppsi = 5*R**2*m*p**5/(8*Fd*g)";
const POLE: f64 = 8.0;

/// Gains for table I at a speed in m/s, in the order of the formulas.
fn gains(text: &str, speed: f64) -> Vec<f64> {
    let mut graph = Graph::new();
    let mut scope = Scope::default();
    let values = [
        ("m", 10.0),
        ("m0", 5.0),
        ("R", 0.3),
        ("g", 9.81),
        ("p", POLE),
        ("Fd", speed / 0.3),
    ];
    for (name, _) in values {
        let symbol = graph.symbol(name);
        scope.define(name, symbol);
    }
    let roots: Vec<_> = definitions(&mut graph, &mut scope, text)
        .into_iter()
        .skip(1)
        .map(|(_, e)| e)
        .collect();
    evaluate(&graph, &values.map(|(_, value)| value), &roots)
}

#[test]
fn the_printed_gains_are_the_closed_forms_but_for_one() {
    for column in steering::GAINS.iter() {
        let lane = column.printed.len() == steering::OUTPUTS.len();
        let closed = gains(if lane { LANE } else { TURN }, column.speed);
        for (gain, printed) in closed.into_iter().zip(column.mended()) {
            assert!(
                (gain - printed).abs() < PRINTED_GAIN,
                "{printed} in {} at {} m/s, computed {gain}",
                column.table,
                column.speed
            );
        }
    }
}

/// A cosine from 0 at 2 s to `end` at 7 s; `amplitude` is half of the way.
fn smooth_step(amplitude: f64, end: f64) -> impl Fn(f64) -> f64 {
    move |t| {
        if t < 2.0 {
            0.0
        } else if t < 7.0 {
            amplitude * ((PI * (t - 2.0) / 5.0).cos() - 1.0)
        } else {
            end
        }
    }
}

#[test]
fn the_reference_paths_are_continuous_as_corrected_and_not_as_printed() {
    let jump = |path: &dyn Fn(f64) -> f64| (path(7.0) - path(7.0_f64.next_down())).abs();
    for length in [2.5, 10.0] {
        assert!(jump(&smooth_step(length / 2.0, -length)) < 1e-12);
        assert!(jump(&smooth_step(length, -length)) > 1.0);
    }
    assert!(jump(&smooth_step(FRAC_PI_4, -FRAC_PI_2)) < 1e-12);
    assert!(jump(&smooth_step(FRAC_PI_4, FRAC_PI_2)) > 1.0);
}

/// Runs the closed loop: feedback of tilt, slider, yaw and, for a lane change, lateral position.
fn closed_loop(gains: Vec<f64>, speed: f64, amplitude: f64, end: f64) -> Trajectory {
    let model = model("unicycle");
    let info = model.info();
    let fed_back = ["omega_1", "theta", "sigma", "r", "psi", "y_G"];
    let selected = fed_back[..gains.len()]
        .iter()
        .map(|name| info.state_index(name).unwrap());
    let terms: Vec<(f64, usize)> = gains.into_iter().zip(selected).collect();
    let &(last, _) = terms.last().unwrap();
    let path = smooth_step(amplitude, end);
    // u = −K (y − y_des), where the last state follows the path and the others stay at zero.
    let feedback = SwitchedInputs {
        function: |t: f64, x: &[f64], u: &mut [f64]| {
            u[0] = last * path(t) - terms.iter().map(|(k, i)| k * x[*i]).sum::<f64>();
        },
        switching_times: vec![2.0, 7.0],
    };
    let mut simulation = Simulation::new(model);
    simulation.initial_state = state(model, &[("omega_2", speed / 0.3)]);
    simulation.inputs = &feedback;
    simulation.options = Options::with_tolerances(TOLERANCE, TOLERANCE);
    simulation.sampling = Sampling::Every(0.001);
    simulation.run().unwrap()
}

/// What the sheet of results says about a run.
struct Run {
    manoeuvre: &'static str,
    speed: f64,
    amplitude: f64,
    end: f64,
    force: f64,
    tilt_deg: f64,
    slider: f64,
    friction: f64,
    x: f64,
    y: f64,
    psi: f64,
}

fn assert_run(run: &Run) -> Trajectory {
    let text = if run.manoeuvre == "lane_change" {
        LANE
    } else {
        TURN
    };
    let motion = closed_loop(gains(text, run.speed), run.speed, run.amplitude, run.end);
    let column = |name: &str| motion.column(name).unwrap();
    let largest = |values: Vec<f64>| {
        values
            .into_iter()
            .fold(0.0_f64, |largest, v| largest.max(v.abs()))
    };
    let mut forces = [0.0; 3];
    let friction = (0..motion.len()).map(|row| {
        let at = appell_runtime::model::At {
            t: motion.times()[row],
            x: motion.state(row),
            u: motion.inputs(row),
            p: motion.parameters(),
        };
        model("unicycle").constraint_forces(at, &mut forces);
        forces[0].hypot(forces[1]) / forces[2]
    });
    for (what, got, wanted) in [
        ("force", largest(column("u")), run.force),
        ("tilt", largest(column("theta")).to_degrees(), run.tilt_deg),
        ("slider", largest(column("r")), run.slider),
    ] {
        assert_close(what, &[got], &[wanted], MAXIMA, 0.0);
    }
    // Four decimals are given.
    assert_close(
        "friction",
        &[largest(friction.collect())],
        &[run.friction],
        1e-4,
        1.0,
    );
    let end = motion.last_state();
    let place = |name: &str| end[motion.info().state_index(name).unwrap()];
    let got = [place("x_G"), place("y_G"), place("psi")];
    assert_close(
        "final state",
        &got,
        &[run.x, run.y, run.psi],
        FINAL_STATE,
        1.0,
    );
    assert_reference(run, &motion);
    motion
}

/// The same run with all digits.
fn assert_reference(run: &Run, motion: &Trajectory) {
    let cases = cases("maneuvers.json");
    let case = cases
        .iter()
        .find(|case| {
            case["maneuver"] == run.manoeuvre
                && (number(&case["speed_m_s"]) - run.speed).abs() < 0.5
                && case["gains"].as_str().unwrap().starts_with("exact")
                && case["reference"].as_str().unwrap().contains("corrected")
        })
        .expect("the run has its case");
    let names = [
        ("w1", "omega_1"),
        ("w2", "omega_2"),
        ("w3", "omega_3"),
        ("theta", "theta"),
        ("sigma", "sigma"),
        ("r", "r"),
        ("psi", "psi"),
        ("phi", "phi"),
        ("xG", "x_G"),
        ("yG", "y_G"),
    ];
    let end = motion.last_state();
    for (file, spec) in names {
        let got = end[motion.info().state_index(spec).unwrap()];
        let wanted = number(&case["final_state_t10"][file]);
        // Eight digits of a metre, a radian, a metre per second.
        assert_close(spec, &[got], &[wanted], 1e-8, 1.0);
    }
}

#[test]
fn lane_change_at_1_metre_per_second() {
    let run = Run {
        manoeuvre: "lane_change",
        speed: 1.0,
        amplitude: 1.25,
        end: -2.5,
        force: 3.01502,
        tilt_deg: 4.97131,
        slider: 0.017_703_3,
        friction: 0.0522,
        x: 9.187_490_87,
        y: -2.500_027_77,
        psi: 8.8e-8,
    };
    assert_run(&run);
}

#[test]
fn lane_change_at_5_metres_per_second_needs_more_force_than_the_paper_says() {
    let run = Run {
        manoeuvre: "lane_change",
        speed: 5.0,
        amplitude: 5.0,
        end: -10.0,
        force: 10.35025,
        tilt_deg: 1.31447,
        slider: 0.217_708_2,
        friction: 0.1954,
        x: 47.511_097_4,
        y: -10.000_050_3,
        psi: 2.5e-7,
    };
    let motion = assert_run(&run);
    let force = motion
        .column("u")
        .unwrap()
        .into_iter()
        .fold(0.0_f64, |largest, u| largest.max(u.abs()));
    assert!(force > 10.0, "the paper says less than 10 N: {force}");
}

#[test]
fn right_turn_at_1_metre_per_second() {
    let run = Run {
        manoeuvre: "right_turn",
        speed: 1.0,
        amplitude: FRAC_PI_4,
        end: -FRAC_PI_2,
        force: 1.15882,
        tilt_deg: 4.19384,
        slider: 0.006_530_6,
        friction: 0.0494,
        x: 5.666_071_75,
        y: -5.408_815_31,
        psi: -1.570_795_88,
    };
    assert_run(&run);
}

const RIGHT_TURN_AT_5: Run = Run {
    manoeuvre: "right_turn",
    speed: 5.0,
    amplitude: FRAC_PI_4,
    end: -FRAC_PI_2,
    force: 16.79120,
    tilt_deg: 1.98652,
    slider: 0.269_939_3,
    friction: 0.2490,
    x: 28.332_414_4,
    y: -27.113_357_3,
    psi: -1.570_799_39,
};

#[test]
fn right_turn_at_5_metres_per_second() {
    assert_run(&RIGHT_TURN_AT_5);
}

#[test]
fn a_figure_keeps_small_motions_apart_from_large_ones() {
    let trajectory = assert_run(&RIGHT_TURN_AT_5);
    let figure = Figure::of_states_and_inputs(&trajectory);
    let panels: Vec<String> = figure
        .panels
        .iter()
        .map(|panel| {
            let labels: Vec<&str> = panel.series.iter().map(|series| &*series.label).collect();
            format!("{} [{}]", labels.join(" "), panel.unit)
        })
        .collect();
    assert_eq!(
        panels,
        [
            "x_G y_G [m]",
            "psi [rad]",
            "theta [rad]",
            "phi [rad]",
            "r [m]",
            "omega_1 omega_3 [rad/s]",
            "omega_2 [rad/s]",
            "sigma [m/s]",
            "u [N]",
        ]
    );
    let path = Figure::path(&trajectory, "x_G", "y_G").unwrap();
    assert_eq!((path.x_label.as_str(), path.equal_axes), ("x_G [m]", true));
    assert_eq!(Figure::path(&trajectory, "x_G", "nowhere"), None);
}
