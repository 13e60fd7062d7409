//! A tumbling body whose attitude is a unit quaternion, seen by gyroscopes and by two directions of the ground: in half
//! a minute it passes all attitudes, and each component of the quaternion in turn determines itself worst.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_estimate::{
    Consistency, Coordinate, Effort, Estimation, Fit, Free, Measured, Recording, Setup, Unknown,
    chi_squared_quantile,
};
use appell_runtime::model::{At, Energies, List, Model, ModelInfo, Quantity};

const INERTIA: [f64; 3] = [0.02, 0.03, 0.045];
const START: [f64; 7] = [1.0, 4.0, 0.5, 1.0, 0.0, 0.0, 0.0];
const STEP: f64 = 0.02;
const ROWS: usize = 1000;
/// Torques in N m √s; noise of the gyroscopes in rad/s and of the directions; spreads of speeds and attitude.
const TORQUE: f64 = 0.003;
const NOISE: [f64; 7] = [0.05, 0.05, 0.05, 0.03, 0.03, 0.03, 0.03];
const SPREAD: [f64; 2] = [0.1, 0.05];

/// Euler's equations, and ė = ½ e ω.
struct Body(ModelInfo);

impl Body {
    fn new() -> Self {
        let named = |name: &'static str, value: f64| Quantity::new(name, "", "1").valued(value);
        let states = ["p", "q", "r", "e0", "e1", "e2", "e3"]
            .into_iter()
            .zip(START);
        let inertia = ["A", "B", "C"].into_iter().zip(INERTIA);
        let outputs = ["up_x", "up_y", "north_x", "north_z"];
        Self(ModelInfo {
            name: "body".into(),
            title: "".into(),
            source: "".into(),
            states: states.map(|(name, value)| named(name, value)).collect(),
            speeds: 3,
            inputs: List::default(),
            declared_inputs: 0,
            signals: List::default(),
            signal_inputs: List::default(),
            parameters: inertia.map(|(name, value)| named(name, value)).collect(),
            outputs: outputs.map(|name| named(name, 0.0)).to_vec().into(),
            constraint_rows: List::default(),
            reactions: List::default(),
            contacts: List::default(),
            explicit_time: false,
        })
    }
}

impl Model for Body {
    fn info(&self) -> &ModelInfo {
        &self.0
    }
    fn rates(&self, at: At<'_>, rates: &mut [f64]) {
        let ([p, q, r], [a, b, c]) = ([at.x[0], at.x[1], at.x[2]], [at.p[0], at.p[1], at.p[2]]);
        let [w, x, y, z] = [at.x[3], at.x[4], at.x[5], at.x[6]];
        rates.copy_from_slice(&[
            (b - c) / a * q * r,
            (c - a) / b * r * p,
            (a - b) / c * p * q,
            0.5 * (-x * p - y * q - z * r),
            0.5 * (w * p + y * r - z * q),
            0.5 * (w * q + z * p - x * r),
            0.5 * (w * r + x * q - y * p),
        ]);
    }
    fn jacobians(&self, at: At<'_>, rates: &mut [f64], jacobian: &mut [f64], _: &mut [f64]) {
        self.rates(at, rates);
        let ([p, q, r], [a, b, c]) = ([at.x[0], at.x[1], at.x[2]], [at.p[0], at.p[1], at.p[2]]);
        let [w, x, y, z] = [at.x[3], at.x[4], at.x[5], at.x[6]].map(|e| 0.5 * e);
        let [f, g, h] = [(b - c) / a, (c - a) / b, (a - b) / c];
        let [hp, hq, hr] = [p, q, r].map(|speed| 0.5 * speed);
        let rows = [
            [0.0, f * r, f * q, 0.0, 0.0, 0.0, 0.0],
            [g * r, 0.0, g * p, 0.0, 0.0, 0.0, 0.0],
            [h * q, h * p, 0.0, 0.0, 0.0, 0.0, 0.0],
            [-x, -y, -z, 0.0, -hp, -hq, -hr],
            [w, -z, y, hp, 0.0, hr, -hq],
            [z, w, -x, hq, -hr, 0.0, hp],
            [-y, x, w, hr, hq, -hp, 0.0],
        ];
        jacobian.copy_from_slice(rows.as_flattened());
    }
    fn parameter_jacobian(&self, at: At<'_>, slopes: &mut [f64]) {
        let ([p, q, r], [a, b, c]) = ([at.x[0], at.x[1], at.x[2]], [at.p[0], at.p[1], at.p[2]]);
        slopes.fill(0.0);
        slopes[..9].copy_from_slice(&[
            -(b - c) / (a * a) * q * r,
            q * r / a,
            -q * r / a,
            -r * p / b,
            -(c - a) / (b * b) * r * p,
            r * p / b,
            p * q / c,
            -p * q / c,
            -(a - b) / (c * c) * p * q,
        ]);
    }
    fn appell(&self, at: At<'_>, mass: &mut [f64], bias: &mut [f64], forces: &mut [f64]) {
        mass.fill(0.0);
        forces.fill(0.0);
        let mut rates = [0.0; 7];
        self.rates(at, &mut rates);
        for k in 0..3 {
            mass[4 * k] = at.p[k];
            bias[k] = -at.p[k] * rates[k];
        }
    }
    fn energies(&self, _: At<'_>) -> Energies {
        Energies::default()
    }
    fn constraint_residual(&self, _: At<'_>, _: &mut [f64]) {}
    fn constraint_forces(&self, _: At<'_>, _: &mut [f64]) {}
    fn outputs(&self, at: At<'_>, outputs: &mut [f64]) {
        let [w, x, y, z] = [at.x[3], at.x[4], at.x[5], at.x[6]];
        outputs.copy_from_slice(&[
            2.0 * (x * z - w * y),
            2.0 * (y * z + w * x),
            1.0 - 2.0 * (y * y + z * z),
            2.0 * (x * z + w * y),
        ]);
    }
    fn dependent_coordinates(&self) -> &[usize] {
        &[0]
    }
    fn position_constraints(&self, at: At<'_>, residual: &mut [f64], jacobian: &mut [f64]) {
        let e = &at.x[3..];
        residual[0] = e.iter().map(|e| e * e).sum::<f64>() - 1.0;
        for (slope, e) in jacobian.iter_mut().zip(e) {
            *slope = 2.0 * e;
        }
    }
}

/// Normal numbers, by Box and Muller from a linear congruential generator (D. E. Knuth).
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }
    fn normal(&mut self) -> f64 {
        let (radius, angle) = ((-2.0 * self.uniform().ln()).sqrt(), self.uniform());
        radius * (std::f64::consts::TAU * angle).cos()
    }
}

fn setup(body: &Body) -> Setup<'_> {
    let gyroscopes = (0..3).map(Measured::State);
    let measured: Vec<Measured> = gyroscopes.chain((0..4).map(Measured::Output)).collect();
    Setup::new(body, &measured)
}

fn values(estimation: &Estimation<'_>) -> Vec<f64> {
    let (mut values, layout) = (estimation.nominal(), estimation.layout());
    let mut set = |unknown, value| values[layout.place(unknown).unwrap()] = value;
    for state in 0..7 {
        set(Unknown::Noise(state), NOISE[state]);
        set(Unknown::Initial { run: 0, state }, START[state]);
        set(
            Unknown::Spread { run: 0, state },
            SPREAD[usize::from(state > 2)],
        );
    }
    for k in 0..3 {
        set(Unknown::Disturbance(k), TORQUE);
    }
    values
}

fn normalise(x: &mut [f64; 7]) {
    let norm = x[3..].iter().map(|e| e * e).sum::<f64>().sqrt();
    x[3..].iter_mut().for_each(|e| *e /= norm);
}

/// One step of the classical method of Runge and Kutta.
fn advance(body: &Body, x: &mut [f64; 7], h: f64) {
    let rates = |x: &[f64; 7]| {
        let mut rates = [0.0; 7];
        let at = At {
            t: 0.0,
            x,
            u: &[],
            p: &INERTIA,
        };
        body.rates(at, &mut rates);
        rates
    };
    let moved = |k: &[f64; 7], h: f64| -> [f64; 7] { std::array::from_fn(|i| x[i] + h * k[i]) };
    let first = rates(x);
    let second = rates(&moved(&first, 0.5 * h));
    let third = rates(&moved(&second, 0.5 * h));
    let fourth = rates(&moved(&third, h));
    let mean = std::array::from_fn(|i| (first[i] + 2.0 * (second[i] + third[i]) + fourth[i]) / 6.0);
    *x = moved(&mean, h);
    normalise(x);
}

/// A recording and the states behind it.
fn record(body: &Body, seed: u64) -> (Recording, Vec<[f64; 7]>) {
    let mut random = Random(seed);
    let mut x: [f64; 7] = std::array::from_fn(|k| match k {
        3 => START[k],
        _ => START[k] + SPREAD[usize::from(k > 2)] * random.normal(),
    });
    normalise(&mut x);
    let (mut states, mut measurements) = (Vec::new(), Vec::new());
    for _ in 0..ROWS {
        let mut outputs = [0.0; 4];
        let at = At {
            t: 0.0,
            x: &x,
            u: &[],
            p: &INERTIA,
        };
        body.outputs(at, &mut outputs);
        let seen = x[..3].iter().chain(&outputs).zip(NOISE);
        measurements.extend(seen.map(|(value, noise)| value + noise * random.normal()));
        states.push(x);
        for part in 0..2 {
            for k in 0..3 {
                x[k] += TORQUE / INERTIA[k] * (0.5 * STEP).sqrt() * random.normal();
            }
            if part == 0 {
                for _ in 0..10 {
                    advance(body, &mut x, 0.1 * STEP);
                }
            }
        }
    }
    let times = (0..ROWS).map(|row| STEP * row as f64).collect();
    (
        Recording::new(times, Vec::new(), measurements).unwrap(),
        states,
    )
}

#[test]
fn innovations_of_a_tumbling_body_are_white_and_of_the_right_size() {
    let body = Body::new();
    let setup = setup(&body);
    let (recording, states) = record(&body, 1);
    for component in 3..7 {
        // Each component is nearly zero and nearly one somewhere.
        let sizes = states.iter().map(|x| x[component].abs());
        assert!(sizes.clone().fold(1.0, f64::min) < 0.05 && sizes.fold(0.0, f64::max) > 0.8);
    }
    let recordings = [recording];
    let estimation = Estimation::new(&setup, &recordings).unwrap();
    let innovations = estimation
        .innovations(&values(&estimation))
        .unwrap()
        .remove(0);
    for channel in 0..7 {
        let own = innovations.iter().filter(|one| one.channel == channel);
        let consistency = Consistency::of(own, 0.999);
        let [low, high] = consistency.band;
        assert!(
            (low..=high).contains(&consistency.squares) && consistency.is_white(),
            "{channel}: {consistency:?}"
        );
    }
}

#[test]
fn a_moment_of_inertia_of_a_tumbling_body_is_found() {
    let body = Body::new();
    let setup = setup(&body);
    let recordings = [record(&body, 2).0];
    let estimation = Estimation::new(&setup, &recordings).unwrap();
    let mut start = values(&estimation);
    let free = [Free {
        coordinate: Coordinate::Logarithm,
        ..Free::of(Unknown::Parameter(2)).within(0.0, f64::INFINITY)
    }];
    start[2] *= 1.2;
    let fit = Fit::of(&estimation, &start, &free, Effort::default()).unwrap();
    let deviation = fit.covariance().unwrap()[(0, 0)].sqrt();
    let off = (fit.values[2] / INERTIA[2]).ln();
    assert!(
        deviation < 0.01 && off.abs() < 3.0 * deviation,
        "{off} of {deviation}"
    );
}

#[test]
fn smoothed_attitudes_err_as_much_as_is_told() {
    let body = Body::new();
    let setup = setup(&body);
    let mut sum = 0.0;
    let mut farthest = 0.0_f64;
    let (runs, every) = (10, 100);
    for seed in 0..runs {
        let (recording, states) = record(&body, 10 + seed);
        let recordings = [recording];
        let estimation = Estimation::new(&setup, &recordings).unwrap();
        let smoothed = estimation.smoothed(&values(&estimation), 0).unwrap();
        for (told, truth) in smoothed.iter().zip(&states).skip(every / 2).step_by(every) {
            let [w, x, y, z] = [truth[3], truth[4], truth[5], truth[6]];
            // Rows of the vector part of ē e.
            let rows = [[-x, w, z, -y], [-y, -z, w, x], [-z, y, -x, w]];
            let sign = if (0..4)
                .map(|k| truth[3 + k] * told.state[3 + k])
                .sum::<f64>()
                < 0.0
            {
                -1.0
            } else {
                1.0
            };
            let turn = nalgebra::Vector3::from(rows.map(|row| {
                (0..4)
                    .map(|k| 2.0 * sign * row[k] * told.state[3 + k])
                    .sum::<f64>()
            }));
            let spread = nalgebra::Matrix3::from_fn(|i, j| {
                let pairs = (0..4).flat_map(|k| (0..4).map(move |l| (k, l)));
                pairs
                    .map(|(k, l)| 4.0 * rows[i][k] * rows[j][l] * told.covariance(3 + k, 3 + l))
                    .sum::<f64>()
            });
            sum += turn.dot(&spread.cholesky().unwrap().solve(&turn));
            farthest = farthest.max(turn.norm());
        }
    }
    let count = 3.0 * runs as f64 * (ROWS / every) as f64;
    let band = [0.001, 0.999].map(|part| chi_squared_quantile(part, count));
    assert!((band[0]..band[1]).contains(&sum), "{sum} in {band:?}");
    assert!(farthest < 0.1, "{farthest}");
}
