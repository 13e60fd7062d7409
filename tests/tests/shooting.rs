//! Multiple shooting, against motions that one shot from wrong parameters loses.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_estimate::{
    Coordinate, Effort, Estimation, Fit, Free, Measured, Recording, Setup, Shooting, Shot, Unknown,
};
use appell_models::Shipped;
use appell_runtime::model::Model;
use appell_test_kit::Random;
use appell_tests::recorded::{Drive, record};

/// Rows of a segment.
const SEGMENT: usize = 25;
/// Standard deviation of the angles in rad.
const NOISE: f64 = 0.003;

fn shipped(name: &str) -> &'static dyn Model {
    Shipped::find(name).unwrap().model
}

/// Coordinates as measured, pseudo-velocities unknown.
fn guess(setup: &Setup<'_>) -> impl Fn(&Recording) -> Vec<f64> {
    let channels = setup.channels.clone();
    let rest = vec![0.0; setup.model.info().state_len()];
    move |part| {
        let mut state = rest.clone();
        for (channel, &value) in channels.iter().zip(part.measured(0)) {
            if let Measured::State(index) = channel.measures {
                state[index] = value;
            }
        }
        state
    }
}

/// A motion that nothing disturbs, seen by its angles.
struct Rig<'a> {
    setup: Setup<'a>,
    truth: Vec<f64>,
    recordings: [Recording; 1],
}

impl<'a> Rig<'a> {
    fn of(model: &'a dyn Model, drive: &Drive, initial: &[f64], seed: &str) -> Self {
        let info = model.info();
        let angles: Vec<Measured> = (info.speeds..info.state_len())
            .map(Measured::State)
            .collect();
        let setup = Setup {
            disturbances: Vec::new(),
            ..Setup::new(model, &angles)
        };
        let unseen = [drive.unseen(angles.len())];
        let estimation = Estimation::new(&setup, &unseen).unwrap();
        let (mut truth, layout) = (estimation.nominal(), estimation.layout());
        for channel in 0..angles.len() {
            truth[layout.place(Unknown::Noise(channel)).unwrap()] = NOISE;
        }
        for (state, &value) in initial.iter().enumerate() {
            truth[layout.place(Unknown::Initial { run: 0, state }).unwrap()] = value;
        }
        let recordings = [record(&setup, &truth, drive, &mut Random::of(seed))];
        Self {
            setup,
            truth,
            recordings,
        }
    }

    /// A double pendulum that falls from above and tumbles: errors grow a thousandfold in 2 s.
    fn tumbling(seconds: f64) -> Self {
        // Whole numbers of rows.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let drive = Drive::sines((seconds * 100.0) as usize, 0.01, &[0.8, 0.4]);
        Self::of(
            shipped("double_pendulum"),
            &drive,
            &[0.0, 0.0, 2.8, 0.6],
            "tumbling",
        )
    }

    /// The parameters of some names by their logarithms.
    fn free(&self, names: &[&str]) -> Vec<Free> {
        let info = self.setup.model.info();
        let parameter = |name: &&str| Free {
            coordinate: Coordinate::Logarithm,
            ..Free::of(Unknown::Parameter(info.parameter_index(name).unwrap()))
                .within(0.0, f64::INFINITY)
        };
        names.iter().map(parameter).collect()
    }

    /// The truth with wrong parameters.
    fn wrong(&self, free: &[Free], factors: &[f64]) -> Vec<f64> {
        let mut values = self.truth.clone();
        for (free, factor) in free.iter().zip(factors) {
            let Unknown::Parameter(index) = free.unknown else {
                continue;
            };
            values[index] *= factor;
        }
        values
    }

    fn shots(&self, start: &[f64], free: &[Free], rows: usize) -> Vec<Shot> {
        let estimation = Estimation::new(&self.setup, &self.recordings).unwrap();
        let shooting = Shooting::new(&estimation, start, free, rows, guess(&self.setup)).unwrap();
        shooting.shots().unwrap_or_default()
    }

    /// Largest distance from the truth in standard deviations.
    fn distance(&self, shot: &Shot, free: &[Free]) -> f64 {
        let covariance = shot.information.clone().try_inverse().unwrap();
        let off = |(index, free): (usize, &Free)| {
            let Unknown::Parameter(place) = free.unknown else {
                return 0.0;
            };
            let off = (shot.values[place] / self.truth[place]).ln();
            off.abs() / covariance[(index, index)].sqrt()
        };
        free.iter().enumerate().map(off).fold(0.0, f64::max)
    }
}

const LINKS: [&str; 4] = ["m2", "l1", "r2", "I1"];
/// Errors of 30 %.
const WRONG: [f64; 4] = [1.3, 0.7, 1.3, 0.7];

#[test]
fn a_tumbling_double_pendulum_is_identified_from_parameters_that_are_30_percent_wrong() {
    let rig = Rig::tumbling(8.0);
    let free = rig.free(&LINKS);
    let start = rig.wrong(&free, &WRONG);
    let shots = rig.shots(&start, &free, SEGMENT);
    let last = shots.last().unwrap();
    assert!(last.gap < 1e-6 && rig.distance(last, &free) < 3.5);
    // One shot over the whole recording ends elsewhere, if anywhere.
    let one = rig.shots(&start, &free, usize::MAX);
    assert!(
        one.last()
            .is_none_or(|shot| shot.objective > 10.0 * last.objective)
    );
}

#[test]
fn without_disturbances_the_closed_motion_is_the_most_likely_one() {
    let drive = Drive::sines(300, 0.01, &[0.6]);
    let rig = Rig::of(shipped("pendulum"), &drive, &[0.0, 1.0], "closed");
    let mut free = rig.free(&["l", "I"]);
    let shots = rig.shots(&rig.wrong(&free, &[1.3, 0.7]), &free, SEGMENT);
    let shot = shots.last().unwrap();
    let estimation = Estimation::new(&rig.setup, &rig.recordings).unwrap();
    for state in [0, 1] {
        free.push(Free::of(Unknown::Initial { run: 0, state }));
    }
    let mut begin = shot.values.clone();
    begin[1] *= 1.05;
    begin[2] *= 0.9;
    let fit = Fit::of(&estimation, &begin, &free, Effort::default()).unwrap();
    let covariance = fit.covariance().unwrap();
    for (index, place) in [1, 2].into_iter().enumerate() {
        let deviation = covariance[(index, index)].sqrt();
        let off = (shot.values[place] / fit.values[place]).ln() / deviation;
        assert!(off.abs() < 0.01, "{off} standard deviations");
        let variance = shot.information.clone().try_inverse().unwrap()[(index, index)];
        assert!((variance.sqrt() / deviation - 1.0).abs() < 0.01);
    }
}
