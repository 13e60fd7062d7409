//! The four-bar linkage against Eksergian's equation, with the loop closed by intersecting circles.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use appell_codegen::interpreted::InterpretedModel;
use appell_runtime::Simulation;
use appell_runtime::model::{At, Model};
use appell_tests::shipped;

/// Fourth-order differences over a step of a milliradian.
const DIFFERENCES: f64 = 1e-8;

/// The parameters by name.
struct Linkage {
    model: &'static InterpretedModel,
}

impl Linkage {
    fn new() -> Self {
        Self {
            model: shipped::model("four_bar"),
        }
    }

    fn all<const N: usize>(&self, names: [&str; N]) -> [f64; N] {
        let info = self.model.info();
        let values = info.default_parameters();
        names.map(|name| values[info.parameter_index(name).unwrap()])
    }

    /// Angles of coupler and rocker: pin B lies on two circles, above the line between their
    /// centres.
    fn closed(&self, theta1: f64) -> [f64; 2] {
        let [a, b, c, d] = self.all(["a", "b", "c", "d"]);
        let pin = [a * theta1.cos(), a * theta1.sin()];
        let to_pivot = [d - pin[0], -pin[1]];
        let span = to_pivot[0].hypot(to_pivot[1]);
        let between = ((b * b + span * span - c * c) / (2.0 * b * span)).acos();
        let theta2 = to_pivot[1].atan2(to_pivot[0]) + between;
        let (x, z) = (pin[0] + b * theta2.cos() - d, pin[1] + b * theta2.sin());
        [theta2, z.atan2(x)]
    }

    /// Generalised inertia and potential energy at a crank angle.
    fn inertia_and_potential(&self, theta1: f64) -> [f64; 2] {
        let [a, b, c, g] = self.all(["a", "b", "c", "g"]);
        let [m1, m2, m3, i1, i2, i3] = self.all(["m1", "m2", "m3", "I1", "I2", "I3"]);
        let [theta2, theta3] = self.closed(theta1);
        // Velocity coefficients of coupler and rocker.
        let turn = (theta2 - theta3).sin();
        let k2 = -a * (theta1 - theta3).sin() / (b * turn);
        let k3 = -a * (theta1 - theta2).sin() / (c * turn);
        let x2 = -a * theta1.sin() - k2 * b / 2.0 * theta2.sin();
        let z2 = a * theta1.cos() + k2 * b / 2.0 * theta2.cos();
        let inertia = m1 * a * a / 4.0
            + i1
            + m2 * (x2 * x2 + z2 * z2)
            + (i2 * k2 * k2)
            + (m3 * c * c / 4.0 + i3) * k3 * k3;
        let heights = m1 * a / 2.0 * theta1.sin()
            + m2 * (a * theta1.sin() + b / 2.0 * theta2.sin())
            + m3 * c / 2.0 * theta3.sin();
        [inertia, g * heights]
    }

    fn state(&self, omega: f64, theta1: f64) -> Vec<f64> {
        let [theta2, theta3] = self.closed(theta1);
        vec![omega, theta1, theta2, theta3]
    }
}

#[test]
fn the_crank_accelerates_as_eksergian_says() {
    // I(θ) θ'' + I'(θ) θ'²/2 + V'(θ) = τ (Eksergian, Dynamical Analysis of Machines, 1930).
    let linkage = Linkage::new();
    let p = linkage.model.info().default_parameters();
    for step in 0..24 {
        let theta1 = f64::from(step) * 0.27;
        let (omega, tau) = (3.0 - 0.2 * f64::from(step), 0.4);
        let h = 1e-3;
        let at = |k: f64| linkage.inertia_and_potential(theta1 + k * h);
        let slope =
            |i: usize| (8.0 * (at(1.0)[i] - at(-1.0)[i]) - at(2.0)[i] + at(-2.0)[i]) / (12.0 * h);
        let [inertia, _] = at(0.0);
        let wanted = (tau - 0.5 * slope(0) * omega * omega - slope(1)) / inertia;
        let mut rates = [0.0; 4];
        let x = linkage.state(omega, theta1);
        let at = At {
            t: 0.0,
            x: &x,
            u: &[tau],
            p: &p,
        };
        linkage.model.rates(at, &mut rates);
        let off = (rates[0] - wanted).abs() / wanted.abs().max(1.0);
        assert!(
            off < DIFFERENCES,
            "θ₁ = {theta1}: {} against {wanted}",
            rates[0]
        );
    }
}

#[test]
fn the_loop_stays_closed_and_the_energy_stays() {
    let linkage = Linkage::new();
    let [_, potential] = linkage.inertia_and_potential(1.0);
    let [inertia, _] = linkage.inertia_and_potential(1.0);
    let mut simulation = Simulation::new(linkage.model);
    simulation.initial_state = linkage.state(12.0, 1.0);
    simulation.span = [0.0, 10.0];
    simulation.options.rtol = 1e-12;
    simulation.options.atol = 1e-12;
    let motion = simulation.run().unwrap();
    let start = 0.5 * inertia * 144.0 + potential;
    for row in 0..motion.len() {
        let [omega, theta1, theta2, theta3] = *motion.state(row) else {
            panic!("four states")
        };
        let closed = linkage.closed(theta1);
        for (found, wanted) in [theta2, theta3].iter().zip(closed) {
            let off = ((found - wanted) / 2.0).sin().abs();
            assert!(off < 1e-12, "the loop is open by {off:e} rad");
        }
        let [inertia, potential] = linkage.inertia_and_potential(theta1);
        let energy = 0.5 * inertia * omega * omega + potential;
        let drift = (energy / start - 1.0).abs();
        assert!(drift < 1e-9, "energy drifts by {drift:e}");
    }
    // The crank turns around: the rocker's angle is no function of small swings.
    assert!(motion.last_state()[1] > 20.0);
}

#[test]
fn a_guess_of_the_dependent_angles_closes_the_loop() {
    let linkage = Linkage::new();
    let mut simulation = Simulation::new(linkage.model);
    simulation.span = [0.0, 0.01];
    let motion = simulation.run().unwrap();
    let [_, theta1, theta2, theta3] = *motion.state(0) else {
        panic!("four states")
    };
    let closed = linkage.closed(theta1);
    assert!((theta2 - closed[0]).abs() < 1e-14 && (theta3 - closed[1]).abs() < 1e-14);
}
