//! Unicycles of the literature: each contains a simpler mechanism whose equations are known.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_runtime::model::Model;
use appell_test_kit::Random;
use appell_tests::engine::assert_close;
use appell_tests::place::{Place, assert_contains};
use appell_tests::shipped;

/// Random places per pair of mechanisms.
const PLACES: usize = 20;
/// Rounding of some hundred operations and of a well-conditioned M.
const ROUNDING: f64 = 1e-11;
/// Numbers whose size says nothing are compared as if they had this one.
const FLOOR: f64 = 1e-2;

/// The speeds of a wheel on the ground.
const WHEEL: [(&str, &str, f64); 3] = [
    ("omega_1", "omega_1", 1.0),
    ("omega_2", "omega_2", 1.0),
    ("omega_3", "omega_3", 1.0),
];
const BODY: (&str, &str, f64) = ("omega_b", "omega_b", 1.0);
/// A body without mass.
const NO_BODY: [(&str, f64); 5] = [
    ("m_b", 0.0),
    ("J_bx", 0.0),
    ("J_by", 0.0),
    ("J_bz", 0.0),
    ("M_d", 0.0),
];
const NO_OVERHEAD_FLYWHEEL: [(&str, f64); 4] =
    [("m_o", 0.0), ("J_o", 0.0), ("J_od", 0.0), ("M_o", 0.0)];
const NO_LATERAL_FLYWHEEL: [(&str, f64); 4] =
    [("m_s", 0.0), ("J_s", 0.0), ("J_sd", 0.0), ("M_s", 0.0)];
/// What turns a unicycle into a wheel with a body.
const EXTRAS: [(&str, &[(&str, f64)]); 5] = [
    ("unicycle_overhead_flywheel", &NO_OVERHEAD_FLYWHEEL),
    ("unicycle_slider", &[("m_s", 0.0), ("u", 0.0)]),
    (
        "unicycle_lateral_pendulum",
        &[("m_p", 0.0), ("J_p", 0.0), ("J_pz", 0.0), ("M_p", 0.0)],
    ),
    (
        "unicycle_gyroscope",
        &[
            ("m_g", 0.0),
            ("J_g", 0.0),
            ("J_c", 0.0),
            ("M_c", 0.0),
            ("M_g", 0.0),
        ],
    ),
    (
        "unicycle_linkage_rider",
        &[
            ("m_t", 0.0),
            ("J_t", 0.0),
            ("J_tz", 0.0),
            ("m_u", 0.0),
            ("J_ux", 0.0),
            ("J_uy", 0.0),
            ("J_uz", 0.0),
            ("M_h", 0.0),
            ("M_u", 0.0),
            ("m_h", 0.0),
            ("J_h", 0.0),
            ("J_hz", 0.0),
            ("m_s", 0.0),
            ("J_s", 0.0),
            ("J_sz", 0.0),
            ("M_l", 0.0),
            ("M_r", 0.0),
        ],
    ),
];
/// A rider without mass in the legs.
const NO_LEGS: [(&str, f64); 8] = [
    ("m_h", 0.0),
    ("J_h", 0.0),
    ("J_hz", 0.0),
    ("m_s", 0.0),
    ("J_s", 0.0),
    ("J_sz", 0.0),
    ("M_l", 0.0),
    ("M_r", 0.0),
];

/// Calls `check` with random places of two mechanisms; the second takes what has the same name from
/// the first.
fn pairs(general: &str, special: &str, mut check: impl FnMut(&mut Place<'_>, &mut Place<'_>)) {
    let mut random = Random::of(&format!("{general} {special}"));
    let (general, special) = (shipped::model(general), shipped::model(special));
    for _ in 0..PLACES {
        let mut general = Place::random(general, &mut random);
        let mut special = Place::random(special, &mut random);
        special.follow(&mut general);
        check(&mut general, &mut special);
    }
}

#[test]
fn every_unicycle_without_its_actuator_is_the_same_wheel_with_a_body() {
    let speeds = [WHEEL[0], WHEEL[1], WHEEL[2], BODY];
    for (name, nothing) in EXTRAS {
        pairs("unicycle_lateral_flywheel", name, |flywheel, other| {
            flywheel.set(&NO_LATERAL_FLYWHEEL);
            other.set(nothing);
            let own = speeds.map(|(own, _, factor)| (own, factor));
            let (a, b) = (flywheel.equations(&own), other.equations(&own));
            assert_close(name, &a, &b, ROUNDING, FLOOR);
        });
    }
}

#[test]
fn a_unicycle_without_body_and_actuator_is_the_axisymmetric_wheel() {
    pairs(
        "unicycle_lateral_flywheel",
        "axisymmetric_wheel",
        |unicycle, wheel| {
            unicycle.set(&NO_BODY);
            unicycle.set(&NO_LATERAL_FLYWHEEL);
            let [m, r, j, j_d] = unicycle.all(["m_w", "R", "J_w", "J_wd"]);
            wheel.set(&[
                ("m", m),
                ("k_1", j_d / (m * r * r)),
                ("k_2", j / (m * r * r)),
            ]);
            assert_contains("wheel", unicycle, wheel, &WHEEL, ROUNDING);
        },
    );
}

#[test]
fn a_sliding_mass_on_a_body_without_mass_is_the_unicycle_of_the_steering_paper() {
    pairs("unicycle_slider", "unicycle", |slider, unicycle| {
        slider.set(&NO_BODY);
        let [m, r, m_s] = slider.all(["m_w", "R", "m_s"]);
        slider.set(&[
            ("l_s", 0.0),
            ("J_w", m * r * r / 2.0),
            ("J_wd", m * r * r / 4.0),
        ]);
        unicycle.set(&[("m", m), ("m0", m_s)]);
        let speeds = [WHEEL[0], WHEEL[1], WHEEL[2], ("sigma", "sigma", 1.0)];
        assert_contains("unicycle", slider, unicycle, &speeds, ROUNDING);
    });
}

#[test]
fn a_unicycle_with_two_flywheels_is_that_with_the_one_that_has_a_mass() {
    let overhead = [WHEEL[0], WHEEL[1], WHEEL[2], BODY, ("nu_o", "nu_o", 1.0)];
    pairs(
        "unicycle_two_flywheels",
        "unicycle_overhead_flywheel",
        |two, one| {
            two.set(&NO_LATERAL_FLYWHEEL);
            assert_contains("overhead", two, one, &overhead, ROUNDING);
        },
    );
    let lateral = [WHEEL[0], WHEEL[1], WHEEL[2], BODY, ("nu_s", "nu_s", 1.0)];
    pairs(
        "unicycle_two_flywheels",
        "unicycle_lateral_flywheel",
        |two, one| {
            two.set(&NO_OVERHEAD_FLYWHEEL);
            assert_contains("lateral", two, one, &lateral, ROUNDING);
        },
    );
}

#[test]
fn the_wheelbot_is_the_unicycle_with_a_lateral_flywheel_and_parameters_of_its_own() {
    pairs(
        "unicycle_lateral_flywheel",
        "wheelbot",
        |unicycle, wheelbot| {
            let (a, b) = (unicycle.evaluate(), wheelbot.evaluate());
            assert_close("rates", &a.rates, &b.rates, ROUNDING, FLOOR);
        },
    );
}

/// Upright in the plane of the axle: the body leans with the wheel, nothing rolls or yaws.
const UPRIGHT: [(&str, f64); 5] = [
    ("omega_2", 0.0),
    ("omega_3", 0.0),
    ("omega_b", 0.0),
    ("gamma", 0.0),
    ("M_d", 0.0),
];

#[test]
fn a_lateral_flywheel_balances_as_the_reaction_wheel_pendulum() {
    // Spong, Corke and Lozano, Nonlinear control of the reaction wheel pendulum, 2001: a pendulum
    // on the ground with the wheel's inertia about its axis apart, in absolute velocities.
    for name in ["unicycle_lateral_flywheel", "wheelbot"] {
        let (model, mut random) = (shipped::model(name), Random::of(name));
        for _ in 0..PLACES {
            let mut place = Place::random(model, &mut random);
            place.set(&UPRIGHT);
            let [m_w, j_wd, r, g] = place.all(["m_w", "J_wd", "R", "g"]);
            let [m_b, j_bx, l_b] = place.all(["m_b", "J_bx", "l_b"]);
            let [m_s, j_s, l_s] = place.all(["m_s", "J_s", "l_s"]);
            let [theta, torque] = place.all(["theta", "M_s"]);
            let inertia = j_wd
                + m_w * r * r
                + j_bx
                + m_b * (r + l_b) * (r + l_b)
                + m_s * (r + l_s) * (r + l_s);
            let moment = m_w * r + m_b * (r + l_b) + m_s * (r + l_s);
            let wanted = [
                (moment * g * theta.sin() - torque) / inertia,
                torque / j_s,
                0.0,
                0.0,
            ];
            let rates = place.rates(["omega_1", "nu_s", "omega_2", "omega_3"]);
            assert_close(name, &rates, &wanted, ROUNDING, FLOOR);
        }
    }
}

/// A double pendulum that stands on the ground: angles count from the hanging position and turn
/// the other way round.
fn stand_up(place: &mut Place<'_>, [m1, i1, r1, l1]: [f64; 4], [m2, i2, r2]: [f64; 3]) {
    place.set(&[("m1", m1), ("I1", i1), ("r1", r1), ("l1", l1)]);
    place.set(&[("m2", m2), ("I2", i2), ("r2", r2), ("tau1", 0.0)]);
}

/// Mass, inertia and height of the centre of mass of several bodies with their masses, inertias and
/// heights.
fn together(bodies: &[[f64; 3]]) -> [f64; 3] {
    let mass: f64 = bodies.iter().map(|[m, ..]| m).sum();
    let height = bodies.iter().map(|[m, _, z]| m * z).sum::<f64>() / mass;
    let steiner = |&[m, i, z]: &[f64; 3]| i + m * (z - height) * (z - height);
    [mass, bodies.iter().map(steiner).sum(), height]
}

#[test]
fn a_lateral_pendulum_upright_is_a_double_pendulum_on_the_ground() {
    pairs(
        "unicycle_lateral_pendulum",
        "double_pendulum",
        |unicycle, double| {
            unicycle.set(&UPRIGHT);
            let [m_w, j_wd, r] = unicycle.all(["m_w", "J_wd", "R"]);
            let [m_b, j_bx, l_b] = unicycle.all(["m_b", "J_bx", "l_b"]);
            let [l_h, m_p, j_p, l_p] = unicycle.all(["l_h", "m_p", "J_p", "l_p"]);
            let [m1, i1, r1] = together(&[[m_w, j_wd, r], [m_b, j_bx, r + l_b]]);
            stand_up(double, [m1, i1, r1, r + l_h], [m_p, j_p, l_p]);
            let [theta, w1, beta, beta_dot, torque] =
                unicycle.all(["theta", "omega_1", "beta", "beta_dot", "M_p"]);
            double.set(&[("theta1", std::f64::consts::PI - theta), ("theta2", -beta)]);
            double.set(&[("omega1", -w1), ("omega2", -beta_dot), ("tau2", -torque)]);
            let speeds = [("omega_1", "omega1", -1.0), ("beta_dot", "omega2", -1.0)];
            assert_contains("upright", unicycle, double, &speeds, ROUNDING);
        },
    );
}

/// Straight ahead: no tilt, no yaw.
const STRAIGHT: [(&str, f64); 3] = [("omega_1", 0.0), ("omega_3", 0.0), ("theta", 0.0)];

#[test]
fn a_rider_as_a_linkage_straight_ahead_is_the_electric_unicycle_of_three_degrees_of_freedom() {
    pairs("unicycle_linkage_rider", "euc_3dof", |linkage, euc| {
        linkage.set(&STRAIGHT);
        linkage.set(&[("delta", 0.0), ("delta_dot", 0.0), ("M_u", 0.0)]);
        linkage.set(&NO_LEGS);
        let [m_t, j_t, l_t] = linkage.all(["m_t", "J_t", "l_t"]);
        let [m_u, j_uy, l_u] = linkage.all(["m_u", "J_uy", "l_u"]);
        let [m, j, h] = together(&[[m_t, j_t, l_t], [m_u, j_uy, l_u]]);
        euc.set(&[("m", m), ("J", j), ("h", h)]);
        let [m_b, j_by, l_b, l_h] = linkage.all(["m_b", "J_by", "l_b", "l_h"]);
        euc.set(&[("m_0", m_b), ("J_0", j_by), ("h_0", l_b), ("l_0", -l_h)]);
        let [r, w2, wb, wt, eta] = linkage.all(["R", "omega_2", "omega_b", "omega_t", "eta"]);
        euc.set(&[
            ("v", r * w2),
            ("gamma_dot", wb),
            ("phi_dot", wt),
            ("phi", eta),
        ]);
        let speeds = [
            ("omega_2", "v", 1.0 / r),
            ("omega_b", "gamma_dot", 1.0),
            ("omega_t", "phi_dot", 1.0),
        ];
        assert_contains("straight", linkage, euc, &speeds, ROUNDING);
    });
}

/// Angles of a thigh and its knee: the knee lies on two circles, about hip and pedal, before them.
fn leg([hip, pedal]: [[f64; 2]; 2], [thigh, shank]: [f64; 2]) -> [f64; 2] {
    let down = [pedal[0] - hip[0], pedal[1] - hip[1]];
    let span = down[0].hypot(down[1]);
    let opposite = |a: f64, b: f64, c: f64| ((a * a + b * b - c * c) / (2.0 * a * b)).acos();
    let forward = down[0].atan2(-down[1]) + opposite(thigh, span, shank);
    [forward, std::f64::consts::PI - opposite(thigh, shank, span)]
}

#[test]
fn the_legs_of_the_rider_follow_the_pedals() {
    const STEP: f64 = 1e-3;
    let model = shipped::model("unicycle_linkage_rider");
    let mut random = Random::of("legs");
    for _ in 0..PLACES {
        let mut place = Place::random(model, &mut random);
        // The pedals within reach of the feet.
        place.set(&[("l_h", 0.6), ("a_h", 0.35), ("a_s", 0.4), ("a_c", 0.1)]);
        let [phi, gamma, theta] = place.all(["phi", "gamma", "theta"]);
        let [w2, w3, wb] = place.all(["omega_2", "omega_3", "omega_b"]);
        let yaw = w3 / theta.cos() * theta.sin();
        let angles = |t: f64, side: f64| {
            let (phi, gamma) = (phi + t * (w2 - yaw), gamma + t * (wb - yaw));
            let hip = [0.6 * gamma.sin(), 0.6 * gamma.cos()];
            leg(
                [hip, [side * 0.1 * phi.cos(), -side * 0.1 * phi.sin()]],
                [0.35, 0.4],
            )
        };
        for (names, side) in [(["thigh_l", "knee_l"], 1.0), (["thigh_r", "knee_r"], -1.0)] {
            let now = angles(0.0, side);
            place.set(&[(names[0], now[0]), (names[1], now[1])]);
            let at = |steps: f64| angles(steps * STEP, side);
            let slope = |i: usize| {
                let [one, two] = [1.0, 2.0].map(|k| at(k)[i] - at(-k)[i]);
                (8.0 * one - two) / (12.0 * STEP)
            };
            let rates = place.rates(names);
            assert_close("legs", &rates, &[slope(0), slope(1)], 1e-8, FLOOR);
        }
        let mut open = [0.0; 4];
        let mut slopes = vec![0.0; 4 * model.info().coordinate_quantities().len()];
        model.position_constraints(place.point.at(), &mut open, &mut slopes);
        assert_close("loops", &open, &[0.0; 4], ROUNDING, 1.0);
    }
}

#[test]
fn the_electric_unicycle_in_space_straight_ahead_is_that_of_three_degrees_of_freedom() {
    pairs("euc_spatial", "euc_3dof", |space, euc| {
        space.set(&STRAIGHT);
        space.set(&[("psi", 0.0), ("beta", 0.0), ("beta_dot", 0.0), ("M_r", 0.0)]);
        euc.follow(space);
        let speeds = ["v", "gamma_dot", "phi_dot"].map(|speed| (speed, speed, 1.0));
        assert_contains("straight", space, euc, &speeds, ROUNDING);
        let names = ["v", "gamma_dot", "phi_dot", "gamma", "phi"];
        assert_close(
            "rates",
            &space.rates(names),
            &euc.rates(names),
            ROUNDING,
            FLOOR,
        );
        let [x, stays @ ..] = space.rates(["x_C", "y_C", "omega_1", "omega_3", "beta_dot"]);
        assert_close("along x", &[x], &euc.rates(["x"]), ROUNDING, FLOOR);
        assert_close("planar", &stays, &[0.0; 4], ROUNDING, FLOOR);
    });
}

#[test]
fn the_electric_unicycle_in_space_upright_is_a_double_pendulum_on_the_ground() {
    pairs("euc_spatial", "double_pendulum", |space, double| {
        let rest = [
            "v",
            "omega_3",
            "gamma_dot",
            "phi_dot",
            "gamma",
            "phi",
            "M_d",
            "M_h",
        ];
        space.set(&rest.map(|name| (name, 0.0)));
        let [m_w, j_w, r, m_0, j_0x] = space.all(["m_w", "J_w", "R", "m_0", "J_0x"]);
        let [h_0, l_0, m, j_x, h] = space.all(["h_0", "l_0", "m", "J_x", "h"]);
        let [m1, i1, r1] = together(&[[m_w, j_w / 2.0, r], [m_0, j_0x, r + h_0]]);
        stand_up(double, [m1, i1, r1, r - l_0], [m, j_x, h]);
        let [theta, w1, beta, beta_dot, torque] =
            space.all(["theta", "omega_1", "beta", "beta_dot", "M_r"]);
        double.set(&[("theta1", std::f64::consts::PI - theta), ("theta2", -beta)]);
        double.set(&[("omega1", -w1), ("omega2", -beta_dot), ("tau2", -torque)]);
        let speeds = [("omega_1", "omega1", -1.0), ("beta_dot", "omega2", -1.0)];
        assert_contains("upright", space, double, &speeds, ROUNDING);
    });
}

#[test]
fn a_gyroscope_that_is_turned_in_tilt_pushes_in_yaw_and_the_other_way_round() {
    // Euler: the moment that turns a spin h about an axis ω is ω × h. With the spin along the axle
    // a rate of tilt, or of the gimbal, asks for a moment about z, a yaw rate for one about -x.
    let (model, mut random) = (
        shipped::model("unicycle_gyroscope"),
        Random::of("gyroscope"),
    );
    for _ in 0..PLACES {
        let mut place = Place::random(model, &mut random);
        place.set(&UPRIGHT);
        place.set(&[("theta", 0.0), ("beta", 0.0), ("omega_1", 0.0)]);
        let [j_g, nu, gimbal_rate] = place.all(["J_g", "nu", "beta_dot"]);
        let speeds = [("omega_1", 1.0), ("omega_3", 1.0), ("beta_dot", 1.0)];
        let bias = |place: &Place<'_>| [3, 8, 13].map(|entry| place.equations(&speeds)[entry]);
        let turned = [0.0, j_g * nu * gimbal_rate, 0.0];
        assert_close("gimbal", &bias(&place), &turned, ROUNDING, FLOOR);
        // What the speed of the yaw adds beyond its square is the moment of the gyroscope.
        place.set(&[("beta_dot", 0.0), ("omega_3", 1.5)]);
        let left = bias(&place);
        place.set(&[("omega_3", -1.5)]);
        let right = bias(&place);
        let odd = [0, 1, 2].map(|i| (left[i] - right[i]) / 2.0);
        let wanted = [-j_g * nu * 1.5, 0.0, -j_g * nu * 1.5];
        assert_close("yaw", &odd, &wanted, ROUNDING, FLOOR);
    }
}

/// A motion of the published unicycle with a turntable: `dynamics_unicycle.m` of PILCO, 2013, by
/// Deisenroth and others after D. Forster.
///
/// The published equations have the wheel's `C_w` in six places where the pitch inertia `C_f` of the
/// frame belongs, which spoils `ψ_w''` and `ψ_f''` alone. Where the two are equal this says nothing,
/// and all five agree.
struct Turntable {
    /// `θ', φ', ψ_w', ψ_f', ψ_t', θ, ψ_f`.
    state: [f64; 7],
    /// `V, U`.
    torques: [f64; 2],
    /// `θ'', φ'', ψ_t''` by the published equations with the published `C_f`.
    unspoilt: [f64; 3],
    /// `θ'', φ'', ψ_w'', ψ_f'', ψ_t''` by the published equations with `C_f = C_w`.
    equal_inertias: [f64; 5],
}

const TURNTABLE: [Turntable; 3] = [
    Turntable {
        state: [-0.19, 0.24, 1.7, -0.14, 0.03, 0.1, -0.38],
        torques: [0.1, 5.2],
        unspoilt: [
            1.051_308_493_881_435_4,
            -0.018_822_016_020_190_326,
            0.160_315_664_639_172_52,
        ],
        equal_inertias: [
            1.031_251_523_365_861_2,
            -0.084_123_457_562_115_8,
            55.523_560_710_676_11,
            -21.918_371_014_975_13,
            0.228_095_381_868_437_22,
        ],
    },
    Turntable {
        state: [1.17, -1.62, -0.79, -1.64, 1.24, 0.23, -0.55],
        torques: [4.8, 18.6],
        unspoilt: [
            -4.231_401_617_211_654,
            -11.871_246_749_988_956,
            32.709_404_706_965_17,
        ],
        equal_inertias: [
            -2.804_696_746_987_158_7,
            -8.654_757_061_877_964,
            48.628_145_649_610_05,
            -27.929_953_802_160_515,
            29.293_758_292_842_21,
        ],
    },
    Turntable {
        state: [0.62, 0.46, -1.37, -1.94, 0.11, -0.53, -0.37],
        torques: [-2.6, -18.8],
        unspoilt: [
            -3.215_460_818_783_859_6,
            2.339_034_260_412_011_3,
            -14.696_194_314_149_453,
        ],
        equal_inertias: [
            -2.862_206_363_171_725_6,
            3.889_465_512_270_472,
            -22.873_713_848_907_084,
            1.828_101_619_121_978_5,
            -16.071_132_353_762_426,
        ],
    },
];
/// `C_w`, and `C_f` as published, in kg m².
const PITCH_INERTIAS: [f64; 2] = [0.0484, 0.8292];
const TURNTABLE_PARAMETERS: [(&str, f64); 13] = [
    ("m_w", 1.0),
    ("J_w", 0.0484),
    ("J_wd", 0.0242),
    ("R", 0.225),
    ("m_b", 23.5),
    ("J_bx", 0.4608),
    ("J_bz", 0.4248),
    ("l_b", 0.54),
    ("m_o", 10.0),
    ("J_o", 0.2),
    ("J_od", 1.3),
    ("l_o", 0.81),
    ("g", 9.82),
];

/// Second derivatives of tilt, heading, wheel, frame and turntable in the published angles, which
/// count heading and turntable to the right.
fn turntable(place: &mut Place<'_>, motion: &Turntable) -> [f64; 5] {
    let [tilt_rate, right, wheel, frame, table, theta, gamma] = motion.state;
    let [on_table, on_wheel] = motion.torques;
    let (yaw, delta) = (-right, -table);
    let ((s, c), (s_g, c_g)) = (theta.sin_cos(), gamma.sin_cos());
    place.set(&[("theta", theta), ("gamma", gamma), ("omega_1", tilt_rate)]);
    place.set(&[("omega_2", yaw * s + wheel), ("omega_3", yaw * c)]);
    place.set(&[("omega_b", yaw * s + frame)]);
    place.set(&[("nu_o", delta + tilt_rate * s_g + yaw * c * c_g)]);
    place.set(&[("M_o", -on_table), ("M_d", on_wheel)]);
    let [w1, w2, w3, wb, nu] = place.rates(["omega_1", "omega_2", "omega_3", "omega_b", "nu_o"]);
    let yaw_dot = (w3 + yaw * s * tilt_rate) / c;
    let sideways = yaw_dot * s + yaw * c * tilt_rate;
    let of_body = w1 * s_g + tilt_rate * c_g * frame + w3 * c_g - yaw * c * s_g * frame;
    [w1, -yaw_dot, w2 - sideways, wb - sideways, of_body - nu]
}

#[test]
fn an_overhead_flywheel_turns_the_unicycle_as_published_for_a_turntable() {
    let (model, mut random) = (
        shipped::model("unicycle_overhead_flywheel"),
        Random::of("table"),
    );
    let mut place = Place::random(model, &mut random);
    place.set(&TURNTABLE_PARAMETERS);
    let [of_wheel, of_frame] = PITCH_INERTIAS;
    for motion in TURNTABLE {
        place.set(&[("J_by", of_wheel)]);
        let all = turntable(&mut place, &motion);
        assert_close("equal", &all, &motion.equal_inertias, ROUNDING, FLOOR);
        place.set(&[("J_by", of_frame)]);
        let [tilt, heading, .., table] = turntable(&mut place, &motion);
        let unspoilt = [tilt, heading, table];
        assert_close("unspoilt", &unspoilt, &motion.unspoilt, ROUNDING, FLOOR);
    }
}
