//! Emitted equations beside the closed form of the unicycle as a person types it.
//!
//! `cargo bench -p appell-tests --bench equations`. The rows of one run belong together: compare
//! ratios, not times of different runs.

use std::hint::black_box;

use appell_models::unicycle::{self, Inputs, Parameters, Rates, State};
use appell_test_kit::Random;
use criterion::{Criterion, criterion_group, criterion_main};

/// States that are worked through in turn, so that no call is predicted from the last.
const STATES: usize = 256;

/// The explicit accelerations of the steering paper, equations (36) and (86), as printed after
/// correction: one sine-cosine pair per angle, common squares named, nothing else rearranged.
fn typed_by_hand(x: &State<f64>, u: f64, p: &Parameters<f64>) -> Rates<f64> {
    let State {
        omega_1: w1,
        omega_2: w2,
        omega_3: w3,
        sigma: s,
        r,
        ..
    } = *x;
    let Parameters {
        m,
        m0,
        R: radius,
        g,
    } = *p;
    let (sin, cos) = x.theta.sin_cos();
    let (sin_psi, cos_psi) = x.psi.sin_cos();
    let tan = sin / cos;
    let (rr, rad2) = (r * r, radius * radius);
    let d1 = 5.0 * m * rad2 + 4.0 * m0 * rr;
    let d2 = 3.0 * m * rad2 + 2.0 * m0 * rad2 + 12.0 * m0 * rr;
    let omega_1_dot = (4.0 * m0 * radius * r * w1 * w1
        - (m * rad2 + 4.0 * m0 * rr) * tan * w3 * w3
        - 8.0 * m0 * r * w1 * s
        + 2.0 * radius * (3.0 * m * radius + 2.0 * m0 * r * tan) * w2 * w3
        - 4.0 * m0 * g * r * cos
        + 4.0 * m * g * radius * sin
        + 4.0 * radius * u)
        / d1;
    let omega_2_dot = 2.0
        * (-2.0 * m0 * radius * r * w1 * w2 - (m * rad2 + m0 * rad2 + 4.0 * m0 * rr) * w1 * w3
            + 2.0 * m0 * radius * w3 * s)
        / d2;
    let omega_3_dot = (-2.0 * (3.0 * m + 2.0 * m0) * rad2 * w1 * w2
        + (3.0 * m * rad2 * tan + 2.0 * m0 * (rad2 * tan + 2.0 * radius * r + 6.0 * rr * tan))
            * w1
            * w3
        - 24.0 * m0 * r * w3 * s)
        / d2;
    let sigma_dot = ((5.0 * m * rad2 + 4.0 * m0 * (rad2 + rr)) * r * w1 * w1
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
    Rates {
        omega_1_dot,
        omega_2_dot,
        omega_3_dot,
        sigma_dot,
        x_G_dot: w1 * radius * sin_psi * cos + w2 * radius * cos_psi,
        y_G_dot: -w1 * radius * cos_psi * cos + w2 * radius * sin_psi,
        psi_dot: w3 / cos,
        theta_dot: w1,
        phi_dot: w2 - w3 * tan,
        r_dot: s,
    }
}

fn states() -> Vec<(State<f64>, f64)> {
    let mut dice = Random::of("states");
    let mut next = || dice.between(-1.0, 1.0);
    (0..STATES)
        .map(|_| {
            let x = State {
                omega_1: next(),
                omega_2: 5.0 * next(),
                omega_3: next(),
                sigma: next(),
                x_G: next(),
                y_G: next(),
                psi: 3.0 * next(),
                theta: next(),
                phi: 3.0 * next(),
                r: 0.3 * next(),
            };
            (x, 10.0 * next())
        })
        .collect()
}

fn equations(criterion: &mut Criterion) {
    let p = Parameters::default();
    let states = states();
    for (x, u) in &states {
        let (hand, ours) = (
            typed_by_hand(x, *u, &p),
            unicycle::rates(&p, x, &Inputs { u: *u }),
        );
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-9 * (1.0 + a.abs());
        assert!(
            close(hand.omega_1_dot, ours.omega_1_dot) && close(hand.omega_2_dot, ours.omega_2_dot)
        );
        assert!(close(hand.omega_3_dot, ours.omega_3_dot) && close(hand.sigma_dot, ours.sigma_dot));
    }
    let mut group = criterion.benchmark_group("unicycle");
    group.throughput(criterion::Throughput::Elements(STATES as u64));
    group.bench_function("rates, typed by hand", |bencher| {
        bencher.iter(|| {
            for (x, u) in &states {
                black_box(typed_by_hand(black_box(x), *u, black_box(&p)));
            }
        });
    });
    group.bench_function("rates, emitted", |bencher| {
        bencher.iter(|| {
            for (x, u) in &states {
                black_box(unicycle::rates(
                    black_box(&p),
                    black_box(x),
                    &Inputs { u: *u },
                ));
            }
        });
    });
    group.bench_function(
        "rates and Jacobians in state and input, emitted",
        |bencher| {
            bencher.iter(|| {
                for (x, u) in &states {
                    black_box(unicycle::jacobians(
                        black_box(&p),
                        black_box(x),
                        &Inputs { u: *u },
                    ));
                }
            });
        },
    );
    group.finish();
}

criterion_group!(benches, equations);
criterion_main!(benches);
