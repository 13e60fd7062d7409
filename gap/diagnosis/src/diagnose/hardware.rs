//! Priors of sizes relative to the hardware.
//!
//! Student's t with three degrees of freedom: sizes up to the scale of the hardware are probable, a few times that
//! possible, and tens of times very improbable. One implausible size is therefore less probable than several plausible
//! ones.

use std::collections::BTreeMap;

use appell_estimate::{Free, Unknown};
use appell_runtime::model::{At, Model};
use nalgebra::DMatrix;

use crate::effects::{Candidate, EffectModel, Family};

/// ln 1000, the range of ln d′, where d′ is the size of an effect over its standard deviation: about 1000 for an effect
/// that dominates the motion. Rounded to two digits, as in the calibration.
pub(super) const LN_1000: f64 = 6.9;
const DEGREES: f64 = 3.0;
/// Density of Student's t at zero.
const MOST: f64 = 0.367_552_596_947_861_3;
/// Scale of a dimensionless size, such as the relative error of a gain or of the scale of a channel.
const PURE: f64 = 0.5;
/// Number of stated standard deviations within which a parameter is not in error.
const WITHIN: f64 = 2.0;
/// Step of the numerical derivative of the mass matrix, in SI.
const SMALL: f64 = 1e-6;

/// Scales of sizes.
#[derive(Debug, Clone)]
pub(super) struct Hardware {
    /// Scale by parameter: for an added mass or inertia, the one that doubles the mass matrix in some direction; infinite
    /// without a scale.
    alike: Vec<f64>,
    /// Stated standard deviations.
    tolerances: BTreeMap<Unknown, f64>,
}

impl Hardware {
    /// `wanted` are the values with tolerances.
    pub(super) fn of(effects: &EffectModel, wanted: &[Free]) -> Self {
        let info = effects.info();
        let scale = |pure: bool| if pure { PURE } else { f64::INFINITY };
        let of_pure = info.parameters.iter().map(|own| scale(own.unit == "1"));
        let mut alike: Vec<f64> = of_pure.collect();
        // The offset of an encoder changes the mass matrix, but is no inertia.
        let may_add = |own: &&Candidate| own.family != Family::Sensor;
        for candidate in effects.candidates.iter().filter(may_add) {
            for (index, _) in effects.own(candidate) {
                if alike[index].is_infinite()
                    && let Some(growth) = growth(effects.beside(&[]), index)
                {
                    alike[index] = growth.recip();
                }
            }
        }
        let tolerance = |free: &Free| {
            let [value, deviation] = free.prior?;
            Some((free.unknown, deviation * free.stretch(value)))
        };
        // The uncertainty of earlier estimates is no prior for changes.
        let stated = wanted.iter().filter(|_| !effects.is_of_changes);
        Self {
            alike,
            tolerances: stated.filter_map(tolerance).collect(),
        }
    }

    /// Log prior density of a size with this estimate and deviation: log-uniform, times Student's t relative to its
    /// scale.
    pub(super) fn of_size(
        &self,
        unknown: Unknown,
        size: f64,
        deviation: f64,
        is_two_sided: bool,
    ) -> f64 {
        let alike = match unknown {
            Unknown::Scale(_) => PURE,
            Unknown::Parameter(index) => self.alike[index],
            _ => f64::INFINITY,
        };
        let sides = if is_two_sided { 2.0 } else { 1.0 };
        -(size.abs().max(deviation) * sides * LN_1000).ln() + beyond(size / alike)
    }

    /// Log prior density of an error, and that error relative to the threshold of an error;
    /// `None` without a stated tolerance.
    pub(super) fn of_error(&self, unknown: Unknown, error: f64) -> Option<(f64, f64)> {
        let tolerance = self.tolerances.get(&unknown)?;
        let times = error / tolerance;
        Some((
            (MOST / tolerance).ln() + beyond(times),
            times.abs() / WITHIN,
        ))
    }
}

/// Logarithm of the density of Student's t relative to that at zero.
fn beyond(times: f64) -> f64 {
    -0.5 * (DEGREES + 1.0) * (times * times / DEGREES).ln_1p()
}

/// Largest relative increase of the mass matrix per unit of a parameter.
fn growth(model: &dyn Model, index: usize) -> Option<f64> {
    let info = model.info();
    let s = info.speeds;
    let mass = |size: f64| {
        let mut p = info.default_parameters();
        *p.get_mut(index)? += size;
        let (mut mass, mut bias, mut forces) = (vec![0.0; s * s], vec![0.0; s], vec![0.0; s]);
        let (x, u) = (info.initial_state(), vec![0.0; info.input_len()]);
        let (t, x, u, p) = (0.0, &x, &u, &p);
        model.appell(At { t, x, u, p }, &mut mass, &mut bias, &mut forces);
        Some(DMatrix::from_row_slice(s, s, &mass))
    };
    let (there, more) = (mass(0.0)?, mass(SMALL)?);
    let factor = there.clone().cholesky()?;
    let half = factor.l().solve_lower_triangular(&(more - &there))?;
    let grown = factor.l().solve_lower_triangular(&half.transpose())?;
    let most = grown.symmetric_eigen().eigenvalues.amax() / SMALL;
    (most.is_finite() && most > SMALL).then_some(most)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::{Scales, candidates, shipped};

    const SPEC: &str = r#"[mechanism]
name = "rotor"
title = "A rotor on a shaft"
[parameters]
J = { value = 0.04, unit = "kg*m^2", at_least = 0 }
[coordinates]
phi = { unit = "rad" }
[frames]
rotor = { parent = "ground", about_axis = "z", by = "phi" }
[bodies]
rotor = { frame = "rotor", centre = "O", mass = "1 [kg]", inertia = { in = "rotor", diagonal = ["J", "J", "J"] } }
[pseudo_velocities]
omega = { value = "dot(phi)", unit = "rad/s" }
"#;

    #[test]
    fn an_added_inertia_is_measured_by_the_inertia_that_is_there() {
        let spec = appell_recordings::Spec {
            file: "rotor.toml".to_owned(),
            text: SPEC.to_owned(),
        };
        let mechanism = appell_spec::load(&spec.file, &spec.text)
            .expect("a spec")
            .mechanism;
        let scales = Scales {
            rates: vec![1.0],
            narrow: vec![0.005],
            largest: Vec::new(),
            reached: vec![None; mechanism.coordinates.len()],
            loads: vec![0.0; mechanism.loads.len()],
            channels: vec!["phi".to_owned()],
            coordinates: vec![Some(0)],
            speeds: vec![None],
            uncertain: vec![0],
        };
        let effects = shipped().expect("a library");
        let all = candidates(&mechanism, &spec, &effects, &scales).expect("candidates");
        let model = EffectModel::new(&spec, all).expect("a model");
        let hardware = Hardware::of(&model, &[]);
        let of = |name: &str| {
            let mut candidates = model.candidates.iter();
            let own = candidates.find(|own| own.name() == name).expect(name);
            hardware.alike[model.own(own)[0].0]
        };
        let added = of("added_inertia@phi");
        assert!((added - 0.04).abs() < 1e-6, "{added}");
        assert!(of("viscous_friction@phi").is_infinite());
        // A size of 35 scales reduces the log density by twelve, half a scale hardly at all.
        assert!((beyond(35.0) + 12.0).abs() < 0.1 && beyond(0.5) > -0.2);
    }
}
