//! A mass on a spring with a damper, written by hand: linear, so that filters can be checked
//! against formulas.

use appell_runtime::model::{At, Energies, List, Model, ModelInfo, Quantity};

/// m v̇ = F − c v − k x, ẋ = v; its output is x + v/2.
pub(crate) struct Oscillator(ModelInfo);

impl Oscillator {
    pub(crate) fn new() -> Self {
        let si = |name: &'static str, unit: &'static str, value: f64| Quantity {
            value,
            ..Quantity::new(name, "", unit)
        };
        Self(ModelInfo {
            name: "oscillator".into(),
            title: "".into(),
            source: "".into(),
            states: vec![si("v", "m/s", 0.0), si("x", "m", 0.0)].into(),
            speeds: 1,
            inputs: vec![si("F", "N", 0.0)].into(),
            declared_inputs: 1,
            signals: List::default(),
            signal_inputs: List::default(),
            parameters: vec![
                si("m", "kg", 1.3),
                si("c", "N*s/m", 0.4),
                si("k", "N/m", 9.0),
            ]
            .into(),
            outputs: vec![Quantity::new("y", "", "m")].into(),
            constraint_rows: List::default(),
            reactions: List::default(),
            contacts: List::default(),
            explicit_time: false,
        })
    }
}

impl Model for Oscillator {
    fn info(&self) -> &ModelInfo {
        &self.0
    }
    fn rates(&self, at: At<'_>, rates: &mut [f64]) {
        let ([v, x], [m, c, k]) = ([at.x[0], at.x[1]], [at.p[0], at.p[1], at.p[2]]);
        rates[0] = (at.u[0] - c * v - k * x) / m;
        rates[1] = v;
    }
    fn jacobians(&self, at: At<'_>, rates: &mut [f64], a: &mut [f64], b: &mut [f64]) {
        let [m, c, k] = [at.p[0], at.p[1], at.p[2]];
        self.rates(at, rates);
        a.copy_from_slice(&[-c / m, -k / m, 1.0, 0.0]);
        b.copy_from_slice(&[1.0 / m, 0.0]);
    }
    fn parameter_jacobian(&self, at: At<'_>, p: &mut [f64]) {
        let mut rates = [0.0; 2];
        self.rates(at, &mut rates);
        let m = at.p[0];
        p.copy_from_slice(&[-rates[0] / m, -at.x[0] / m, -at.x[1] / m, 0.0, 0.0, 0.0]);
    }
    fn appell(&self, at: At<'_>, mass: &mut [f64], bias: &mut [f64], forces: &mut [f64]) {
        mass[0] = at.p[0];
        bias[0] = 0.0;
        forces[0] = at.u[0] - at.p[1] * at.x[0] - at.p[2] * at.x[1];
    }
    fn energies(&self, at: At<'_>) -> Energies {
        Energies {
            kinetic: 0.5 * at.p[0] * at.x[0] * at.x[0],
            ..Energies::default()
        }
    }
    fn constraint_residual(&self, _: At<'_>, _: &mut [f64]) {}
    fn constraint_forces(&self, _: At<'_>, _: &mut [f64]) {}
    fn outputs(&self, at: At<'_>, outputs: &mut [f64]) {
        outputs[0] = at.x[1] + 0.5 * at.x[0];
    }
}

/// Irregular times and an input.
pub(crate) fn drive(rows: i32) -> (Vec<f64>, Vec<f64>) {
    let time = |i: i32| 0.02 * f64::from(i) + 0.006 * (2.3 * f64::from(i)).sin();
    let force = |i: i32| 2.0 * (0.21 * f64::from(i)).sin();
    (
        (0..rows).map(time).collect(),
        (0..rows).map(force).collect(),
    )
}
