//! Estimation of a closed loop: what the filter believes lies on the position constraints.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_estimate::{
    Consistency, Coordinate, Effort, Estimation, Fit, Free, Measured, Recording, Setup, Shooting,
    Unknown, chi_squared_quantile,
};
use appell_models::Shipped;
use appell_runtime::model::{At, Model};
use appell_test_kit::Random;
use appell_tests::recorded::{Drive, record_with_states};

/// Recordings, and the rows at which each is looked at.
const SETS: usize = 60;
const ROWS: [usize; 3] = [0, 75, 149];
/// Newton's method ends in rounding.
const CLOSED: f64 = 1e-9;

fn linkage() -> &'static dyn Model {
    Shipped::find("four_bar").unwrap().model
}

/// Crank and rocker are seen, the coupler is not.
fn setup() -> Setup<'static> {
    let model = linkage();
    let state = |name: &str| Measured::State(model.info().state_index(name).unwrap());
    Setup::new(model, &[state("theta1"), state("theta3")])
}

fn values(setup: &Setup<'_>, drive: &Drive) -> Vec<f64> {
    let unseen = [drive.unseen(2)];
    let estimation = Estimation::new(setup, &unseen).unwrap();
    let (mut values, layout) = (estimation.nominal(), estimation.layout());
    let mut set = |unknown, value| values[layout.place(unknown).unwrap()] = value;
    set(Unknown::Disturbance(0), 0.02);
    for channel in 0..2 {
        set(Unknown::Noise(channel), 0.004);
    }
    for state in 0..4 {
        set(Unknown::Spread { run: 0, state }, 0.05);
    }
    values
}

/// Largest constraint residual of a state.
fn open(x: &[f64], p: &[f64]) -> f64 {
    let (mut residual, mut jacobian) = ([0.0; 2], [0.0; 6]);
    let at = At {
        t: 0.0,
        x,
        u: &[0.0],
        p,
    };
    linkage().position_constraints(at, &mut residual, &mut jacobian);
    residual.iter().fold(0.0, |most, f| most.max(f.abs()))
}

#[test]
fn states_lie_on_the_constraints_and_their_errors_have_the_size_that_is_told() {
    let (setup, drive) = (setup(), Drive::sines(150, 0.01, &[0.4]));
    let values = values(&setup, &drive);
    let p = linkage().info().default_parameters();
    let mut random = Random::of("loops");
    let mut squares = [0.0; ROWS.len()];
    for _ in 0..SETS {
        let (recording, truth) = record_with_states(&setup, &values, &drive, &mut random);
        let recordings = [recording];
        let estimation = Estimation::new(&setup, &recordings).unwrap();
        let states = estimation.smoothed(&values, 0).unwrap();
        let farthest = states
            .iter()
            .map(|one| open(&one.state, &p))
            .fold(0.0, f64::max);
        assert!(farthest < CLOSED, "off by {farthest}");
        for (sum, row) in squares.iter_mut().zip(ROWS) {
            // Angular velocity and angle of the crank; the rest follows.
            let (told, truth) = (&states[row], &truth[row]);
            let off = [0, 1].map(|i| told.state[i] - truth[i]);
            let [a, b, c] = [(0, 0), (0, 1), (1, 1)].map(|(i, j)| told.covariance(i, j));
            let form = c * off[0] * off[0] - 2.0 * b * off[0] * off[1] + a * off[1] * off[1];
            *sum += form / (a * c - b * b);
        }
    }
    let count = 2.0 * SETS as f64;
    let band = [0.005, 0.995].map(|part| chi_squared_quantile(part, count));
    for square in squares {
        assert!((band[0]..band[1]).contains(&square), "{square} in {band:?}");
    }
}

#[test]
fn innovations_are_white_and_of_the_right_size_where_all_angles_are_seen() {
    let (setup, drive) = (setup(), Drive::sines(600, 0.01, &[0.4]));
    let values = values(&setup, &drive);
    let mut random = Random::of("white loops");
    let recordings = [record_with_states(&setup, &values, &drive, &mut random).0];
    let estimation = Estimation::new(&setup, &recordings).unwrap();
    let innovations = estimation.innovations(&values).unwrap().remove(0);
    for channel in 0..2 {
        let own = innovations.iter().filter(|one| one.channel == channel);
        let consistency = Consistency::of(own, 0.99);
        let [low, high] = consistency.band;
        assert!(
            (low..=high).contains(&consistency.squares) && consistency.is_white(),
            "{consistency:?}"
        );
    }
}

#[test]
fn lengths_and_masses_of_a_linkage_are_found_from_afar() {
    let (setup, drive) = (setup(), Drive::sines(300, 0.01, &[0.4]));
    let truth = values(&setup, &drive);
    let mut random = Random::of("lengths and masses");
    let recordings = [record_with_states(&setup, &truth, &drive, &mut random).0];
    let estimation = Estimation::new(&setup, &recordings).unwrap();
    let parameter = |name: &str| Free {
        coordinate: Coordinate::Logarithm,
        ..Free::of(Unknown::Parameter(
            linkage().info().parameter_index(name).unwrap(),
        ))
        .within(0.0, f64::INFINITY)
    };
    let free = ["c", "m2"].map(parameter);
    let places = free.map(|one| estimation.layout().place(one.unknown).unwrap());
    let mut start = truth.clone();
    start[places[0]] *= 0.9;
    start[places[1]] *= 1.4;
    let guess = |part: &Recording| {
        let [crank, rocker] = [part.measured(0)[0], part.measured(0)[1]];
        vec![0.0, crank, 0.5, rocker]
    };
    let shooting = Shooting::new(&estimation, &start, &free, 25, guess).unwrap();
    let shots = shooting.shots().unwrap();
    let begin = shots.iter().map(|shot| {
        let mut values = truth.clone();
        for place in places {
            values[place] = shot.values[place];
        }
        values
    });
    let likelihood = |values: &Vec<f64>| estimation.log_likelihood(values).unwrap();
    let begin = begin
        .max_by(|a, b| likelihood(a).total_cmp(&likelihood(b)))
        .unwrap();
    let fit = Fit::of(&estimation, &begin, &free, Effort::default()).unwrap();
    for (index, place) in places.into_iter().enumerate() {
        let deviation = fit.covariance().unwrap()[(index, index)].sqrt();
        let off = (fit.values[place] / truth[place]).ln() / deviation;
        assert!(off.abs() < 3.0, "{off} standard deviations of {deviation}");
    }
}
