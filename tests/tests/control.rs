//! Controllers that the general code designs: those of the paper on steering, and others.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use std::f64::consts::PI;

use appell_analysis::control::attraction::{Axis, Fate, Region};
use appell_analysis::control::controllability::{Controllability, output_rank};
use appell_analysis::control::feedback::Feedback;
use appell_analysis::control::lqr::{self, weights};
use appell_analysis::control::operating_point::{MotionEquations, OperatingPoint};
use appell_analysis::control::placement;
use appell_analysis::control::reduction::{ReductionError, Subsystem, reduce};
use appell_analysis::control::sampled::Sampling;
use appell_analysis::control::sampler::{SampledFeedback, Sampler};
use appell_analysis::control::schedule::{GainSchedule, OperatingLaw};
use appell_models::Shipped;
use appell_runtime::inputs::InputSource;
use appell_runtime::integrate::Options;
use appell_runtime::model::{At, Model};
use appell_runtime::simulate::{Sampling as Recording, Simulation};
use appell_runtime::trajectory::Trajectory;
use appell_tests::engine::assert_close;
use appell_tests::reference::{cases, number, numbers};
use appell_tests::steering;
use nalgebra::{Complex, DMatrix, DVector};

const LANE: &[&str] = &steering::OUTPUTS;
const TURN: &[&str] = LANE.split_at(5).0;
/// All poles of the paper.
const POLE: f64 = -8.0;

/// Ten digits.
const GAINS: f64 = 1e-10;
/// Eight digits of a metre, a radian, a metre per second.
const FINAL_STATE: f64 = 1e-8;
/// A printed gain has two decimals.
const PRINTED_GAIN: f64 = 0.006;

fn model(name: &str) -> &'static dyn Model {
    Shipped::find(name).unwrap().model
}

fn indices(model: &dyn Model, names: &[&str]) -> Vec<usize> {
    let index = |name: &&str| model.info().state_index(name).unwrap();
    names.iter().map(index).collect()
}

/// The steered unicycle rolling straight at a speed in m/s.
fn straight(speed: f64) -> OperatingPoint<'static> {
    let mut point = OperatingPoint::new(model("unicycle"));
    point.x.fill(0.0);
    let [omega_2] = indices(point.model, &["omega_2"])[..] else {
        panic!("one index")
    };
    point.x[omega_2] = speed / 0.3;
    point
}

/// Places of states among those of the equations.
fn places(model: &dyn Model, equations: &MotionEquations, names: &[&str]) -> Vec<usize> {
    let place = |state| equations.states.iter().position(|s| *s == state).unwrap();
    indices(model, names).into_iter().map(place).collect()
}

fn steered(speed: f64, outputs: &[&str]) -> Subsystem {
    let equations = straight(speed).equations(&[0]).unwrap();
    let outputs = places(model("unicycle"), &equations, outputs);
    reduce(&equations.system, &outputs).unwrap()
}

/// The gains of the paper, by the general way.
fn placed(speed: f64, outputs: &[&str]) -> DMatrix<f64> {
    let poles = vec![Complex::from(POLE); outputs.len()];
    let placed = placement::place(&steered(speed, outputs).system, &poles).unwrap();
    assert!(placed.residual < 1e-12, "{}", placed.residual);
    placed.gain
}

#[test]
fn placed_gains_are_the_exact_ones_of_the_reference() {
    let cases = cases("gains.json");
    for case in cases {
        let lane = case["maneuver"] == "lane_change";
        let gain = placed(number(&case["speed_m_s"]), if lane { LANE } else { TURN });
        for (gain, wanted) in gain.iter().zip(numbers(&case["K"])) {
            assert_close("gain", &[*gain], &[wanted], GAINS, 0.0);
        }
    }
}

#[test]
fn tables_2_and_3_are_recomputed_and_one_gain_of_table_3_is_a_misprint() {
    for column in steering::GAINS.iter() {
        let outputs = &steering::OUTPUTS[..column.printed.len()];
        for (gain, printed) in placed(column.speed, outputs).iter().zip(column.mended()) {
            assert!((gain - printed).abs() < PRINTED_GAIN, "{gain}, {printed}");
        }
    }
    let printed: f64 = steering::MISPRINT[0].parse().unwrap();
    assert!((placed(1.0, TURN)[4] - printed).abs() > 26.9);
}

#[test]
fn a_slider_steers_six_dimensions_while_rolling_and_four_at_rest() {
    for (speed, rank) in [(5.0, 6), (1.0, 6), (0.1, 6), (0.0, 4)] {
        let equations = straight(speed).equations(&[0]).unwrap();
        let reach = Controllability::of(&equations.system).unwrap();
        assert_eq!((reach.rank, reach.lost.len()), (rank, 10 - rank));
        assert!(reach.lost.iter().all(|mode| mode.norm() < 1e-6));
        let outputs = places(model("unicycle"), &equations, LANE);
        assert_eq!(output_rank(&equations.system, &outputs), rank);
        // The spin of the wheel is never touched; while rolling, neither is ω₃ + 2 φ̇ θ.
        let [omega_2, omega_3, theta] =
            indices(model("unicycle"), &["omega_2", "omega_3", "theta"])[..]
        else {
            panic!("three indices")
        };
        let spin = reach.untouched.row(0);
        assert!((spin[omega_2] - 1.0).abs() + (spin.norm() - 1.0).abs() < 1e-12);
        let row = (0..10 - rank).find(|row| (reach.untouched[(*row, omega_3)] - 1.0).abs() < 1e-12);
        assert_close(
            "factor",
            &[reach.untouched[(row.unwrap(), theta)]],
            &[2.0 * speed / 0.3],
            1e-12,
            1.0,
        );
    }
}

#[test]
fn the_reduced_equations_are_those_of_the_paper() {
    // (60), with ω₃ = −2 φ̇ θ.
    let (m, m0, r, g) = (10.0, 5.0, 0.3, 9.81);
    for speed in [0.7, 1.0, 5.0] {
        let rate = speed / r;
        let reduced = steered(speed, LANE);
        #[rustfmt::skip]
        let a = [
            0.0, 4.0 * g / (5.0 * r) - 2.4 * rate * rate, 0.0, -4.0 * m0 * g / (5.0 * m * r * r), 0.0, 0.0,
            1.0, 0.0, 0.0, 0.0, 0.0, 0.0,
            0.0, -(g + 2.0 * r * rate * rate) / 5.0, 0.0, -4.0 * m0 * g / (5.0 * m * r), 0.0, 0.0,
            0.0, 0.0, 1.0, 0.0, 0.0, 0.0,
            0.0, -2.0 * rate, 0.0, 0.0, 0.0, 0.0,
            -r, 0.0, 0.0, 0.0, r * rate, 0.0,
        ];
        let b = [
            4.0 / (5.0 * m * r),
            0.0,
            (5.0 * m + 4.0 * m0) / (5.0 * m * m0),
            0.0,
            0.0,
            0.0,
        ];
        let ours = reduced.system.a.transpose();
        assert_close("A", ours.as_slice(), &a, 1e-13, 1.0);
        assert_close("B", reduced.system.b.as_slice(), &b, 1e-14, 1.0);
        let (state, factors) = &reduced.substituted[0];
        assert_eq!((*state, reduced.substituted.len()), (2, 1));
        let wanted = [0.0, -2.0 * rate, 0.0, 0.0, 0.0, 0.0];
        assert_close("substitution", factors, &wanted, 1e-13, 1.0);
        // Without y_G five states have equations of their own; without ψ, too, but not without r.
        assert_eq!(steered(speed, TURN).system.order(), 5);
        assert_eq!(steered(speed, &TURN[..4]).system.order(), 4);
        let equations = straight(speed).equations(&[0]).unwrap();
        let three = places(model("unicycle"), &equations, &TURN[..3]);
        let open = reduce(&equations.system, &three);
        assert!(
            matches!(open, Err(ReductionError::Open { order: 4, ref missing, .. }) if missing.len() == 1)
        );
    }
}

/// A cosine from 0 at 2 s to `end` at 7 s; `amplitude` is half of the way.
fn smooth_step(t: f64, amplitude: f64, end: f64) -> f64 {
    if t < 2.0 {
        0.0
    } else if t < 7.0 {
        amplitude * ((PI * (t - 2.0) / 5.0).cos() - 1.0)
    } else {
        end
    }
}

fn simulate(point: &OperatingPoint<'_>, inputs: &dyn InputSource, until: f64) -> Trajectory {
    let mut simulation = Simulation::new(point.model);
    simulation.initial_state.clone_from(&point.x);
    simulation.parameters.clone_from(&point.p);
    simulation.inputs = inputs;
    simulation.span = [0.0, until];
    simulation.options = Options::with_tolerances(1e-12, 1e-12);
    simulation.sampling = Recording::Every(0.001);
    simulation.run().unwrap()
}

#[test]
fn manoeuvres_with_designed_gains_end_as_in_the_reference() {
    let cases = cases("maneuvers.json");
    let exact = |case: &&serde_json::Value| {
        let [gains, path] = ["gains", "reference"].map(|key| case[key].as_str().unwrap());
        gains.starts_with("exact") && !path.contains("literally")
    };
    let mut runs = 0;
    for case in cases.iter().filter(exact) {
        let speed = number(&case["speed_m_s"]);
        let outputs = if case["maneuver"] == "lane_change" {
            LANE
        } else {
            TURN
        };
        let [amplitude, end] = ["ref_amplitude", "ref_final"].map(|key| number(&case[key]));
        let point = straight(speed);
        let law = Feedback {
            inputs: vec![0],
            states: indices(point.model, outputs),
            gain: placed(speed, outputs),
            offset: vec![0.0],
            // The last output follows the path.
            desired: |t: f64, y: &mut [f64]| {
                if let [others @ .., last] = y {
                    others.fill(0.0);
                    *last = smooth_step(t, amplitude, end);
                }
            },
            switching_times: vec![2.0, 7.0],
        };
        let motion = simulate(&point, &law, 10.0);
        let force = motion.column("u").unwrap();
        let force = force.into_iter().fold(0.0_f64, |most, u| most.max(u.abs()));
        // Between samples 1 ms apart the maximum is flat.
        assert_close("force", &[force], &[number(&case["max_abs_u"])], 1e-5, 0.0);
        for (file, state) in [
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
        ] {
            let got = motion.last_state()[indices(point.model, &[state])[0]];
            let wanted = number(&case["final_state_t10"][file]);
            assert_close(state, &[got], &[wanted], FINAL_STATE, 1.0);
        }
        runs += 1;
    }
    assert_eq!(runs, 6);
}

/// A law that keeps y at zero.
fn regulator(
    model: &dyn Model,
    inputs: Vec<usize>,
    outputs: &[&str],
    gain: DMatrix<f64>,
) -> Feedback<impl Fn(f64, &mut [f64]) + Sync + Clone> {
    Feedback {
        offset: vec![0.0; inputs.len()],
        inputs,
        states: indices(model, outputs),
        gain,
        desired: |_: f64, y: &mut [f64]| y.fill(0.0),
        switching_times: Vec::new(),
    }
}

/// Gains of a quadratic regulator about a steady motion.
fn optimal(
    point: &OperatingPoint<'_>,
    inputs: &[usize],
    outputs: &[&str],
    q: &[f64],
    r: &[f64],
) -> DMatrix<f64> {
    let equations = point.equations(inputs).unwrap();
    let outputs = places(point.model, &equations, outputs);
    let system = reduce(&equations.system, &outputs).unwrap().system;
    let regulator = lqr::continuous(&system, &weights(q), &weights(r)).unwrap();
    assert!(regulator.residual < 1e-12, "{}", regulator.residual);
    assert!(regulator.poles.iter().all(|pole| pole.re < 0.0));
    regulator.gain
}

#[test]
fn a_regulator_keeps_an_electric_unicycle_and_its_rider_upright() {
    let mut point = OperatingPoint::new(model("euc_3dof"));
    let outputs = ["v", "gamma_dot", "phi_dot", "x", "gamma", "phi"];
    let equations = point.equations(&[0, 1]).unwrap();
    let reach = Controllability::of(&equations.system).unwrap();
    assert_eq!(reach.rank, 6);
    assert!(
        reach.modes.iter().any(|mode| mode.value.re > 1.0),
        "it falls by itself"
    );
    let gain = optimal(&point, &[0, 1], &outputs, &[1.0; 6], &[0.01; 2]);
    let law = regulator(point.model, vec![0, 1], &outputs, gain);
    let phi = indices(point.model, &["phi"])[0];
    point.x[phi] = 0.15;
    let motion = simulate(&point, &law, 30.0);
    let end = motion
        .last_state()
        .iter()
        .fold(0.0_f64, |most, x| most.max(x.abs()));
    assert!(end < 1e-4, "{end}");
}

#[test]
fn a_unicycle_with_a_flywheel_survives_a_push_from_the_side_and_from_behind() {
    let mut point = OperatingPoint::new(model("unicycle_lateral_flywheel"));
    let outputs = ["omega_1", "omega_2", "omega_b", "nu_s", "theta", "gamma"];
    let q = [1.0, 0.1, 1.0, 1e-4, 1.0, 1.0];
    let gain = optimal(&point, &[0, 1], &outputs, &q, &[1.0, 1.0]);
    let law = regulator(point.model, vec![0, 1], &outputs, gain);
    // An impulse of 1 N s at the body's centre of mass, 0.55 m above the ground, to the side and
    // 1 N s forwards: M Δω = impulse along the velocities of that point.
    let (info, n) = (point.model.info(), point.model.info().speeds);
    let mut mass = vec![0.0; n * n];
    let [mut bias, mut forces] = [vec![0.0; n], vec![0.0; n]];
    let at = At {
        t: 0.0,
        x: &point.x,
        u: &[0.0; 2],
        p: &point.p,
    };
    point.model.appell(at, &mut mass, &mut bias, &mut forces);
    let mut impulse = DVector::zeros(n);
    for (speed, lever) in [("omega_1", 0.55), ("omega_2", 0.2), ("omega_b", 0.35)] {
        impulse[info.state_index(speed).unwrap()] = lever;
    }
    let jump = DMatrix::from_row_slice(n, n, &mass)
        .lu()
        .solve(&impulse)
        .unwrap();
    for (x, jump) in point.x.iter_mut().zip(jump.iter()) {
        *x += jump;
    }
    let standing = simulate(&point, &law, 60.0);
    let end =
        |motion: &Trajectory, name: &str| motion.last_state()[indices(point.model, &[name])[0]];
    let tilt = standing.column("theta").unwrap();
    let tilt = tilt
        .into_iter()
        .fold(0.0_f64, |most, tilt| most.max(tilt.abs()));
    assert!(tilt > 0.01, "the push is felt: {tilt}");
    for name in ["omega_1", "omega_2", "omega_b", "theta", "gamma"] {
        assert!(
            end(&standing, name).abs() < 1e-3,
            "{name}: {}",
            end(&standing, name)
        );
    }
    // Without the law it falls.
    let mut falling = Simulation::new(point.model);
    falling.initial_state.clone_from(&point.x);
    let fallen = falling.run().unwrap_err().to_string();
    assert!(fallen.contains("range"), "{fallen}");
}

#[test]
fn a_sampled_law_with_a_delay_keeps_the_unicycle_where_the_continuous_gains_fail() {
    let (speed, until) = (5.0, 10.0);
    let mut point = straight(speed);
    let states = indices(point.model, LANE);
    let sampling = Sampling::new(0.06, 0.05).unwrap();
    let system = steered(speed, LANE).system;
    let designed = sampling.place(&system, &[Complex::from(POLE); 6]).unwrap();
    assert!(designed.residual < 1e-9, "{}", designed.residual);
    let law = |gain: DMatrix<f64>| SampledFeedback {
        inputs: vec![0],
        states: states.clone(),
        gain,
        offset: vec![0.0],
        desired: |_: f64, y: &mut [f64]| y.fill(0.0),
        sampler: Sampler::new(sampling, until),
    };
    let lateral = indices(point.model, &["y_G"])[0];
    point.x[lateral] = 0.01;
    let motion = simulate(&point, &law(designed.gain), until);
    assert!(
        motion.last_state()[lateral].abs() < 1e-3,
        "{:?}",
        motion.last_state()
    );
    // The linear sampled loop tells the motion at the measurements, as long as it is small.
    let mut ignorant = placed(speed, LANE).resize_horizontally(7, 0.0);
    let closed = sampling.discretise(&system).closed(&ignorant);
    let poles = appell_spectra::spectrum::eigenvalues(&closed).unwrap();
    assert!(poles.iter().any(|pole| pole.norm() > 1.0), "{poles:?}");
    ignorant.fill_column(6, 0.0);
    let mut simulation = Simulation::new(point.model);
    simulation.initial_state.clone_from(&point.x);
    let ignorant = law(ignorant);
    simulation.inputs = &ignorant;
    let lost = simulation
        .run()
        .map_or(true, |motion| motion.last_state()[lateral].abs() > 0.1);
    assert!(lost);
}

#[test]
fn gains_over_the_speed_hold_the_unicycle_between_the_speeds_of_the_design() {
    let design = |speed: f64| OperatingLaw {
        gain: placed(speed, LANE),
        states: DVector::zeros(6),
        inputs: DVector::zeros(1),
    };
    let speeds = (10..=50).map(|k| f64::from(k) / 10.0);
    let schedule = GainSchedule::new(speeds.map(|speed| (speed, design(speed))).collect()).unwrap();
    assert_eq!(schedule.at(2.0).gain, placed(2.0, LANE));
    assert_eq!(schedule.at(0.1).gain, placed(1.0, LANE));
    assert_eq!(schedule.at(9.0).gain, placed(5.0, LANE));
    for speed in [1.63, 2.97, 4.44] {
        let mut point = straight(speed);
        let omega_2 = indices(point.model, &["omega_2"])[0];
        let lateral = indices(point.model, &["y_G"])[0];
        point.x[lateral] = 0.05;
        let states = indices(point.model, LANE);
        let law = |_: f64, x: &[f64], u: &mut [f64]| {
            let y = DVector::from_fn(states.len(), |i, _| x[states[i]]);
            u[0] = schedule.at(0.3 * x[omega_2]).asked(&y)[0];
        };
        let motion = simulate(&point, &law, 10.0);
        assert!(
            motion.last_state()[lateral].abs() < 1e-4,
            "{speed}: {:?}",
            motion.last_state()
        );
    }
}

#[test]
fn the_region_of_attraction_ends_where_motions_are_lost() {
    let point = straight(5.0);
    let law = regulator(point.model, vec![0], TURN, placed(5.0, TURN));
    // Neither disturbance touches ω₃ + 2 φ̇ θ, which no law brings back.
    let [theta, omega_1, r] = indices(point.model, &["theta", "omega_1", "r"])[..] else {
        panic!("three indices")
    };
    let grid = |most: f64| {
        (-3..=3)
            .map(|k| f64::from(k) * most / 3.0)
            .collect::<Vec<_>>()
    };
    let axis = |state, most| Axis {
        state,
        values: grid(most),
    };
    let region = Region {
        model: point.model,
        parameters: &point.p,
        state: &point.x,
        inputs: &|| Box::new(law.clone()),
        duration: 8.0,
        axes: vec![axis(omega_1, 6.0), axis(r, 0.15)],
        settled: &|motion| motion.last_state()[theta].abs() < 0.01,
    };
    let count = std::sync::atomic::AtomicUsize::new(0);
    let fates = region
        .explore(&|_| {
            count.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        })
        .unwrap();
    assert_eq!((fates.fates.len(), count.into_inner()), (49, 49));
    assert_eq!(fates.fates[24], Fate::Settled);
    assert!(
        fates
            .fates
            .iter()
            .any(|fate| matches!(fate, Fate::Lost { .. }))
    );
    // Left and right are alike: the equations do not know them apart.
    for (fate, mirrored) in fates.fates.iter().zip(fates.fates.iter().rev()) {
        assert_eq!(*fate == Fate::Settled, *mirrored == Fate::Settled);
    }
    assert_close("part", &[fates.safe_part()], &[1.0 / 3.0], 1e-12, 0.0);
}
