//! Emitted equations in blocks of eight places, and one place at a time with the same functions.
//!
//! `cargo bench -p appell-tests --bench lanes`. Prints nanoseconds a place, the fastest of many rounds in
//! which all rows take turns: compare rows of one run.

use std::hint::black_box;
use std::time::Instant;

use appell_models::unicycle::Unicycle;
use appell_runtime::lanes::{AtLanes, LANES, Level};
use appell_runtime::model::{At, Model};
use appell_test_kit::Random;

const STATES: usize = 10;
const PARAMETERS: [f64; 4] = [10.0, 5.0, 0.3, 9.81];
/// Blocks in the first cache, in the second, and far beyond all of them: a million places.
const SIZES: [(&str, usize); 3] = [("L1", 16), ("L2", 128), ("memory", 125_000)];
/// Blocks that a round works through at least: short enough to fall into a quiet moment of the machine.
const BLOCKS: usize = 512;
const ROUNDS: usize = 1000;

type Lanes<const LEN: usize> = [[f64; LANES]; LEN];

/// Places with room for what is computed there.
struct Places {
    x: Vec<Lanes<STATES>>,
    u: Vec<Lanes<1>>,
    rates: Vec<Lanes<STATES>>,
    a: Vec<Lanes<{ STATES * STATES }>>,
    b: Vec<Lanes<STATES>>,
}

impl Places {
    fn new(blocks: usize, matrices: bool) -> Self {
        let mut random = Random::of("lanes");
        let mut number = || random.between(-1.0, 1.0);
        let room = if matrices { blocks } else { 1 };
        Self {
            x: (0..blocks)
                .map(|_| std::array::from_fn(|_| std::array::from_fn(|_| number())))
                .collect(),
            u: vec![[[5.0; LANES]]; blocks],
            rates: vec![[[0.0; LANES]; STATES]; blocks],
            a: vec![[[0.0; LANES]; STATES * STATES]; room],
            b: vec![[[0.0; LANES]; STATES]; room],
        }
    }
}

/// What is measured, at a block.
type Task = fn(&mut Places, usize);

const P: Lanes<4> = [
    [PARAMETERS[0]; LANES],
    [PARAMETERS[1]; LANES],
    [PARAMETERS[2]; LANES],
    [PARAMETERS[3]; LANES],
];

fn at(x: &Lanes<STATES>, u: &Lanes<1>, evaluate: impl FnOnce(AtLanes<'_>)) {
    let t = &[0.0; LANES];
    evaluate(AtLanes { t, x, u, p: &P });
}

fn rates_in_lanes(places: &mut Places, i: usize) {
    let (x, u, rates) = (&places.x[i], &places.u[i], &mut places.rates[i]);
    at(x, u, |at| Unicycle.rates_lanes(at, rates));
}

fn jacobians_in_lanes(places: &mut Places, i: usize) {
    let (x, u, rates) = (&places.x[i], &places.u[i], &mut places.rates[i]);
    let (a, b) = (&mut places.a[i], &mut places.b[i]);
    at(x, u, |at| Unicycle.jacobians_lanes(at, rates, a, b));
}

/// The same bytes without a computation: what memory allows.
fn copy(places: &mut Places, i: usize) {
    places.rates[i] = places.x[i];
    places.rates[i][0] = places.u[i][0];
}

/// Calls a function of one place for each lane.
fn each_place(places: &mut Places, i: usize, evaluate: impl Fn(At<'_>, &mut [f64; STATES])) {
    for lane in 0..LANES {
        let x = places.x[i].map(|x| x[lane]);
        let at = At {
            t: 0.0,
            x: &x,
            u: &[places.u[i][0][lane]],
            p: &PARAMETERS,
        };
        let mut rates = [0.0; STATES];
        evaluate(at, &mut rates);
        black_box(rates);
    }
}

fn rates_own(places: &mut Places, i: usize) {
    each_place(places, i, |at, rates| Unicycle.rates_own(at, rates));
}

fn rates_standard(places: &mut Places, i: usize) {
    each_place(places, i, |at, rates| Unicycle.rates(at, rates));
}

/// The explicit accelerations of the steering paper as printed, with the standard library.
fn rates_by_hand(places: &mut Places, i: usize) {
    each_place(places, i, |at, rates| {
        *rates = hand(at.x, at.u[0], black_box(&PARAMETERS));
    });
}

#[inline(never)]
fn hand(x: &[f64], u: f64, p: &[f64; 4]) -> [f64; STATES] {
    let (w1, w2, w3, s, psi, theta, r) = (x[0], x[1], x[2], x[3], x[6], x[7], x[9]);
    let [m, m0, radius, g] = *p;
    let (sin, cos) = theta.sin_cos();
    let (sin_psi, cos_psi) = psi.sin_cos();
    let tan = sin / cos;
    let (rr, rad2) = (r * r, radius * radius);
    let d1 = 5.0 * m * rad2 + 4.0 * m0 * rr;
    let d2 = 3.0 * m * rad2 + 2.0 * m0 * rad2 + 12.0 * m0 * rr;
    let tilt = (4.0 * m0 * radius * r * w1 * w1
        - (m * rad2 + 4.0 * m0 * rr) * tan * w3 * w3
        - 8.0 * m0 * r * w1 * s
        + 2.0 * radius * (3.0 * m * radius + 2.0 * m0 * r * tan) * w2 * w3
        - 4.0 * m0 * g * r * cos
        + 4.0 * m * g * radius * sin
        + 4.0 * radius * u)
        / d1;
    let spin = 2.0
        * (-2.0 * m0 * radius * r * w1 * w2 - (m * rad2 + m0 * rad2 + 4.0 * m0 * rr) * w1 * w3
            + 2.0 * m0 * radius * w3 * s)
        / d2;
    let turn = (-2.0 * (3.0 * m + 2.0 * m0) * rad2 * w1 * w2
        + (3.0 * m * rad2 * tan + 2.0 * m0 * (rad2 * tan + 2.0 * radius * r + 6.0 * rr * tan))
            * w1
            * w3
        - 24.0 * m0 * r * w3 * s)
        / d2;
    let slide = ((5.0 * m * rad2 + 4.0 * m0 * (rad2 + rr)) * r * w1 * w1
        + (5.0 * m * rad2 * r - 4.0 * m0 * radius * rr * tan + 4.0 * m0 * rr * r
            - m * rad2 * radius * tan)
            * w3
            * w3
        - 8.0 * m0 * radius * r * w1 * s
        + radius * (m * rad2 + 4.0 * m0 * (radius * r * tan - rr)) * w2 * w3
        - (m * rad2 + 4.0 * m0 * rr) * g * sin
        - 4.0 * m0 * g * radius * r * cos
        + (5.0 * m / m0 * rad2 + 4.0 * rad2 + 4.0 * rr) * u)
        / d1;
    let forward = w1 * radius * sin_psi * cos + w2 * radius * cos_psi;
    let sideways = -w1 * radius * cos_psi * cos + w2 * radius * sin_psi;
    [
        tilt,
        spin,
        turn,
        slide,
        forward,
        sideways,
        w3 / cos,
        w1,
        w2 - w3 * tan,
        s,
    ]
}

fn main() {
    println!("widest vectors of this processor: {:?}", Level::best());
    println!("{:48} {:>8}", "unicycle, ns a place, one core", "fastest");
    for (place, blocks) in SIZES {
        let in_cache = blocks < BLOCKS;
        let mut rows: Vec<(&str, Task)> = vec![
            ("rates in lanes", rates_in_lanes),
            ("copy of the same numbers", copy),
        ];
        if in_cache {
            rows.extend([
                ("rates, A, B in lanes", jacobians_in_lanes as Task),
                ("rates, one place, own functions", rates_own),
                ("rates, one place, standard functions", rates_standard),
                ("rates, one place, typed by hand", rates_by_hand),
            ]);
        }
        let mut places = Places::new(blocks, in_cache);
        let repetitions = BLOCKS.div_ceil(blocks);
        let mut fastest = vec![f64::INFINITY; rows.len()];
        let rounds = if in_cache { ROUNDS } else { ROUNDS / 20 };
        for _ in 0..rounds {
            for ((_, task), fastest) in rows.iter().zip(&mut fastest) {
                let start = Instant::now();
                for _ in 0..repetitions {
                    for i in 0..blocks {
                        task(&mut places, i);
                    }
                    black_box(&mut places);
                }
                let count = (repetitions * blocks * LANES) as f64;
                *fastest = fastest.min(start.elapsed().as_secs_f64() * 1e9 / count);
            }
        }
        for ((name, _), fastest) in rows.iter().zip(&fastest) {
            println!("{:48} {fastest:8.2}", format!("{name}, {place}"));
        }
    }
}
