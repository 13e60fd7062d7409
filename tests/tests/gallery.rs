//! Mechanisms of textbooks against their closed equations, written down by hand.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_test_kit::Random;
use appell_tests::engine::assert_close;
use appell_tests::place::{Place, assert_contains};
use appell_tests::shipped;

/// Random places per mechanism.
const PLACES: usize = 20;
/// Rounding of some hundred operations and of a well-conditioned M.
const ROUNDING: f64 = 1e-12;
/// Numbers whose size says nothing are compared as if they had this one.
const FLOOR: f64 = 1e-2;
/// The tilt at the edge of stability in degrees: a bisection of a smooth function.
const CRITICAL_TILT: f64 = 1e-9;

/// Calls `check` with random places of a mechanism.
fn everywhere(name: &str, mut check: impl FnMut(&mut Place<'_>)) {
    let (model, mut random) = (shipped::model(name), Random::of(name));
    for _ in 0..PLACES {
        check(&mut Place::random(model, &mut random));
    }
}

/// Demands that the rates of these states are these numbers.
fn assert_rates<const N: usize>(place: &Place<'_>, names: [&str; N], wanted: [f64; N]) {
    assert_close(
        &names.join(", "),
        &place.rates(names),
        &wanted,
        ROUNDING,
        FLOOR,
    );
}

#[test]
fn chaplygin_sleigh_moves_as_chaplygin_says() {
    // Neimark and Fufaev, Dynamics of Nonholonomic Systems, chapter III: the reduced equations.
    everywhere("chaplygin_sleigh", |place| {
        let [m, i, a] = place.all(["m", "I", "a"]);
        let [v, w, psi] = place.all(["v", "omega", "psi"]);
        assert_rates(
            place,
            ["v", "omega", "x", "y", "psi"],
            [
                a * w * w,
                -m * a * v * w / (i + m * a * a),
                v * psi.cos(),
                v * psi.sin(),
                w,
            ],
        );
    });
}

#[test]
fn rolling_ball_keeps_its_angular_velocity_and_moves_as_a_heavier_point() {
    // Routh, Advanced Rigid Dynamics, chapter V: the angular momentum about the contact grows by
    // the moment of the force at the centre alone, and v = ω × R e_z.
    everywhere("rolling_ball", |place| {
        let [m, r, j] = place.all(["m", "R", "J"]);
        let [f_x, f_y] = place.all(["F_x", "F_y"]);
        let [w_x, w_y] = place.all(["omega_x", "omega_y"]);
        let about_contact = j + m * r * r;
        assert_rates(
            place,
            ["omega_x", "omega_y", "omega_z", "x", "y"],
            [
                -r * f_y / about_contact,
                r * f_x / about_contact,
                0.0,
                r * w_y,
                -r * w_x,
            ],
        );
        // A homogeneous ball: v' = 5/7 F/m.
        place.set(&[("J", 0.4 * m * r * r)]);
        let [w_y_dot] = place.rates(["omega_y"]);
        assert_close(
            "5/7",
            &[r * w_y_dot],
            &[5.0 / 7.0 * f_x / m],
            ROUNDING,
            FLOOR,
        );
    });
}

#[test]
fn two_wheeled_pendulum_moves_as_derived_by_hand() {
    // The model of Kim and Kwon 2015; equations by hand with Boltzmann and Hamel: T with the sideways velocity w of the
    // axle kept has ∂T/∂w = m_b l sin θ ψ' at w = 0, which enters the rows of v and ψ'.
    everywhere("two_wheeled_pendulum", |place| {
        let [m_b, m_w, i_x, i_y, i_z] = place.all(["m_b", "m_w", "I_x", "I_y", "I_z"]);
        let [j, k, r, d, l, g] = place.all(["J", "K", "R", "d", "l", "g"]);
        let [v, w, pitch_rate, theta] = place.all(["v", "omega", "theta_dot", "theta"]);
        let [tau_l, tau_r] = place.all(["tau_l", "tau_r"]);
        let (s, c) = theta.sin_cos();
        let upright = i_x + m_b * l * l;
        let yaw = upright * s * s + i_z * c * c + 2.0 * (k + (m_w + j / (r * r)) * d * d);
        let m_11 = m_b + 2.0 * (m_w + j / (r * r));
        let m_12 = m_b * l * c;
        let wanted = [
            m_11,
            0.0,
            m_12,
            -m_b * l * s * (pitch_rate * pitch_rate + w * w),
            (tau_l + tau_r) / r,
            0.0,
            yaw,
            0.0,
            2.0 * (upright - i_z) * s * c * pitch_rate * w + m_b * l * s * v * w,
            (tau_r - tau_l) * d / r,
            m_12,
            0.0,
            i_y + m_b * l * l,
            -(upright - i_z) * s * c * w * w,
            m_b * g * l * s - tau_l - tau_r,
        ];
        let derived = place.equations(&[("v", 1.0), ("omega", 1.0), ("theta_dot", 1.0)]);
        assert_close("M, b, Π", &derived, &wanted, ROUNDING, FLOOR);
        assert_rates(
            place,
            ["phi_l", "phi_r"],
            [(v - d * w) / r, (v + d * w) / r],
        );
    });
}

#[test]
fn two_wheeled_pendulum_straight_ahead_is_the_electric_unicycle_of_two_degrees_of_freedom() {
    let planar = shipped::model("euc_2dof");
    everywhere("two_wheeled_pendulum", |place| {
        let [m_w, j, tau] = place.all(["m_w", "J", "tau_l"]);
        place.set(&[("omega", 0.0), ("tau_r", tau)]);
        let [m_b, l, i_y, r] = place.all(["m_b", "l", "I_y", "R"]);
        let [v, theta, pitch_rate] = place.all(["v", "theta", "theta_dot"]);
        let mut planar = Place::random(planar, &mut Random::of("planar"));
        planar.follow(place);
        planar.set(&[
            ("m", m_b),
            ("m_0", 0.0),
            ("m_w", 2.0 * m_w),
            ("J_w", 2.0 * j),
        ]);
        planar.set(&[("h", l), ("J", i_y), ("R", r), ("M_d", 2.0 * tau)]);
        planar.set(&[("v", v), ("phi", theta), ("phi_dot", pitch_rate)]);
        let speeds = [("v", "v", 1.0), ("theta_dot", "phi_dot", 1.0)];
        assert_contains("straight", place, &planar, &speeds, ROUNDING);
    });
}

#[test]
fn furuta_pendulum_moves_as_cazzolato_and_prime_say() {
    // On the Dynamics of the Furuta Pendulum, 2011, equations (33), (34).
    everywhere("furuta_pendulum", |place| {
        let [m1, m2, arm, l1, l2] = place.all(["m1", "m2", "L1", "l1", "l2"]);
        let [j1, j2, b1, b2, g] = place.all(["J1", "J2", "c1", "c2", "g"]);
        let [w1, w2, theta2] = place.all(["omega1", "omega2", "theta2"]);
        let [tau1, tau2] = place.all(["tau1", "tau2"]);
        let (s, c) = theta2.sin_cos();
        let hat_2 = j2 + m2 * l2 * l2;
        let hat_0 = j1 + m1 * l1 * l1 + m2 * arm * arm;
        let wanted = [
            hat_0 + hat_2 * s * s,
            m2 * arm * l2 * c,
            -m2 * arm * l2 * s * w2 * w2 + w1 * w2 * (2.0 * theta2).sin() * hat_2,
            tau1 - b1 * w1,
            m2 * arm * l2 * c,
            hat_2,
            -0.5 * w1 * w1 * (2.0 * theta2).sin() * hat_2,
            tau2 - b2 * w2 - g * m2 * l2 * s,
        ];
        let derived = place.equations(&[("omega1", 1.0), ("omega2", 1.0)]);
        assert_close("M, b, Π", &derived, &wanted, ROUNDING, FLOOR);
    });
}

#[test]
fn cart_double_pendulum_moves_as_bogdanov_says() {
    // Optimal Control of a Double Inverted Pendulum on a Cart, 2004: D θ'' + C θ' + G = H u in
    // angles of both links from the upright, clockwise.
    everywhere("cart_double_pendulum", |place| {
        let [m0, m1, m2] = place.all(["m_cart", "m1", "m2"]);
        let [length, r1, r2, i1, i2, g] = place.all(["l1", "r1", "r2", "I1", "I2", "g"]);
        let [w1, w2, theta1, theta2, f] = place.all(["omega1", "omega2", "theta1", "theta2", "F"]);
        let (a1, a2) = (
            std::f64::consts::PI - theta1,
            std::f64::consts::PI - theta1 - theta2,
        );
        let (u1, u2) = (-w1, -w1 - w2);
        let (d2, d3) = (m1 * r1 + m2 * length, m2 * r2);
        let (d4, d5) = (m1 * r1 * r1 + m2 * length * length + i1, m2 * length * r2);
        let d6 = m2 * r2 * r2 + i2;
        let cross = (a1 - a2).sin();
        let [v, w1_dot, w2_dot] = place.rates(["v", "omega1", "omega2"]);
        let (e1, e2) = (-w1_dot, -w1_dot - w2_dot);
        let residual = [
            (m0 + m1 + m2) * v + d2 * a1.cos() * e1 + d3 * a2.cos() * e2
                - d2 * a1.sin() * u1 * u1
                - d3 * a2.sin() * u2 * u2
                - f,
            d2 * a1.cos() * v + d4 * e1 + d5 * (a1 - a2).cos() * e2 + d5 * cross * u2 * u2
                - d2 * g * a1.sin(),
            d3 * a2.cos() * v + d5 * (a1 - a2).cos() * e1 + d6 * e2
                - d5 * cross * u1 * u1
                - d3 * g * a2.sin(),
        ];
        let scale = 1.0 + v.abs() + e1.abs() + e2.abs();
        assert_close("residual", &residual, &[0.0; 3], ROUNDING, 10.0 * scale);
    });
}

#[test]
fn cart_double_pendulum_on_a_heavy_cart_is_the_double_pendulum() {
    let fixed = shipped::model("double_pendulum");
    everywhere("cart_double_pendulum", |place| {
        place.set(&[("m_cart", 1e12), ("F", 0.0)]);
        let mut fixed = Place::random(fixed, &mut Random::of("fixed"));
        fixed.follow(place);
        fixed.set(&[("tau1", 0.0), ("tau2", 0.0)]);
        let states = ["omega1", "omega2", "theta1", "theta2"];
        // The cart moves by the ratio of the masses.
        assert_close(
            "rates",
            &place.rates(states),
            &fixed.rates(states),
            1e-9,
            FLOOR,
        );
    });
}

#[test]
fn axisymmetric_wheel_with_the_inertia_of_a_disc_is_the_rolling_wheel() {
    let disc = shipped::model("rolling_wheel");
    everywhere("axisymmetric_wheel", |place| {
        place.set(&[("k_1", 0.25), ("k_2", 0.5)]);
        let mut disc = Place::random(disc, &mut Random::of("disc"));
        disc.follow(place);
        let (general, disc) = (place.evaluate(), disc.evaluate());
        assert_close("rates", &general.rates, &disc.rates, ROUNDING, FLOOR);
        assert_close("A", &general.a, &disc.a, ROUNDING, FLOOR);
        assert_close(
            "M",
            &general.mass_matrix,
            &disc.mass_matrix,
            ROUNDING,
            FLOOR,
        );
        assert_close("b", &general.bias, &disc.bias, ROUNDING, FLOOR);
        assert_close(
            "forces",
            &general.reactions,
            &disc.reactions,
            ROUNDING,
            FLOOR,
        );
        assert_close(
            "energies",
            &general.energies,
            &disc.energies,
            ROUNDING,
            FLOOR,
        );
    });
}

/// λ² of small changes about steady turning with a tilt and a yaw rate; all other roots are zero.
/// In the states ω₁, ω₂, ω₃, θ the characteristic polynomial is λ²(λ² - tr A²/2).
fn square_of_the_root(wheel: &mut Place<'_>, omega_3: f64) -> f64 {
    wheel.set(&[("omega_1", 0.0), ("omega_2", 0.0), ("omega_3", omega_3)]);
    let [at_0] = wheel.rates(["omega_1"]);
    wheel.set(&[("omega_2", 1.0)]);
    let [at_1] = wheel.rates(["omega_1"]);
    wheel.set(&[("omega_2", at_0 / (at_0 - at_1))]);
    let states = ["omega_1", "omega_2", "omega_3", "theta"].map(|name| wheel.index(name));
    let (a, n) = (wheel.evaluate().a, wheel.point.x.len());
    let products = states.map(|i| states.map(|j| a[i * n + j] * a[j * n + i]));
    products.iter().flatten().sum::<f64>() / 2.0
}

/// The least stable yaw rate at a tilt: λ² is a + b ω₃² + c/ω₃² with b, c < 0.
fn largest_root(wheel: &mut Place<'_>, tilt: f64) -> f64 {
    wheel.set(&[("theta", tilt)]);
    let [one, two, three] = [1.0, 2.0, 3.0].map(|w3| square_of_the_root(wheel, w3));
    // Differences free of a: 3b - 3c/4 and 8b - 8c/9.
    let (d2, d3) = ((two - one) / 3.0, (three - one) / 8.0);
    let c = (d3 - d2) / (1.0 / 4.0 - 1.0 / 9.0);
    let b = d2 + c / 4.0;
    assert!(b < 0.0 && c < 0.0, "b = {b}, c = {c}");
    one - b - c - 2.0 * (b * c).sqrt()
}

/// The tilt below which some yaw rates are unstable.
fn critical_tilt_deg(k_1: f64, k_2: f64) -> f64 {
    let model = shipped::model("axisymmetric_wheel");
    let mut wheel = Place::random(model, &mut Random::of("tilt"));
    wheel.set(&[("k_1", k_1), ("k_2", k_2)]);
    let (mut low, mut high) = (0.05_f64, 1.0_f64);
    assert!(largest_root(&mut wheel, low) > 0.0 && largest_root(&mut wheel, high) < 0.0);
    while high - low > 1e-14 {
        let middle = f64::midpoint(low, high);
        if largest_root(&mut wheel, middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    low.to_degrees()
}

#[test]
fn turning_of_a_disc_beyond_18_62_and_of_a_hoop_beyond_19_20_degrees_is_always_stable() {
    // The steering paper, (23), for the disc; the hoop by the same calculation with k_1 = 1/2,
    // k_2 = 1, docs/errata.md.
    let disc = (12.0 / 19.0 - 9.0 * 5.0_f64.sqrt() / 38.0).sqrt().asin();
    let disc = disc.to_degrees();
    assert!((disc - 18.623_570_746_969_177).abs() < CRITICAL_TILT);
    for (k_1, k_2, wanted) in [(0.25, 0.5, disc), (0.5, 1.0, 19.203_773_871_3)] {
        let tilt = critical_tilt_deg(k_1, k_2);
        assert!(
            (tilt - wanted).abs() < CRITICAL_TILT,
            "{tilt} is not {wanted}"
        );
    }
}
