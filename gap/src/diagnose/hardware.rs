//! What hardware is like: how probable sizes are beforehand, by what is there.
//!
//! Student's t with three degrees of freedom: sizes of what is there are likely, some times that are believed where
//! recordings leave nothing else, and tens of times hardly ever. So one absurd number does not beat several true ones.

use std::collections::BTreeMap;

use appell_estimate::{Coordinate, Free, Unknown};
use appell_runtime::model::{At, Model};
use nalgebra::DMatrix;

use crate::effects::EffectModel;

/// ln 1000, the range of the logarithm of d′: effects as large as whole motions come to some thousand.
/// Calibrated with these two digits.
pub(super) const LN_1000: f64 = 6.9;
const DEGREES: f64 = 3.0;
/// Density of Student's t at zero.
const MOST: f64 = 0.367_552_596_947_861_3;
/// What is there of a pure number, such as the relative error of a gain or of a scale.
const PURE: f64 = 0.5;
/// A parameter is no error within so many stated standard deviations.
const WITHIN: f64 = 2.0;
/// Size by which masses are varied to see what they add, in SI.
const SMALL: f64 = 1e-6;

/// Sizes that are there.
#[derive(Debug, Clone)]
pub(super) struct Hardware {
    /// By parameter: the size of an effect that is as large as what it adds to, infinite where nothing is alike.
    alike: Vec<f64>,
    /// Stated standard deviations by parameter.
    tolerances: BTreeMap<usize, f64>,
}

impl Hardware {
    /// `wanted` are the parameters with tolerances.
    pub(super) fn of(effects: &EffectModel, wanted: &[Free]) -> Self {
        let info = effects.info();
        let of_pure = info
            .parameters
            .iter()
            .map(|own| if own.unit == "1" { PURE } else { f64::INFINITY });
        let mut alike: Vec<f64> = of_pure.collect();
        for candidate in &effects.candidates {
            for (index, _) in effects.own(candidate) {
                if alike[index].is_infinite()
                    && let Some(growth) = growth(effects.beside(&[]), index)
                {
                    alike[index] = growth.recip();
                }
            }
        }
        let tolerance = |free: &Free| {
            let (Unknown::Parameter(index), Some([value, deviation])) = (free.unknown, free.prior)
            else {
                return None;
            };
            let stretch = match free.coordinate {
                Coordinate::Plain => 1.0,
                Coordinate::Logarithm => value,
            };
            Some((index, deviation * stretch))
        };
        // What recordings before tell says nothing of how much may change.
        let stated = wanted.iter().filter(|_| !effects.is_of_changes);
        Self {
            alike,
            tolerances: stated.filter_map(tolerance).collect(),
        }
    }

    /// Logarithm of the density of a size, of which the recordings say so much: its logarithm is uniform over a range,
    /// but for what is beyond what is there.
    pub(super) fn of_size(
        &self,
        unknown: Unknown,
        (size, deviation): (f64, f64),
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

    /// The same of how far a parameter is off its stated value, and how many times that is what counts as within its
    /// tolerance; nothing where no tolerance is stated.
    pub(super) fn of_error(&self, unknown: Unknown, error: f64) -> Option<(f64, f64)> {
        let Unknown::Parameter(index) = unknown else {
            return None;
        };
        let tolerance = self.tolerances.get(&index)?;
        let times = error / tolerance;
        Some((
            (MOST / tolerance).ln() + beyond(times),
            times.abs() / WITHIN,
        ))
    }
}

/// Logarithm of the density of Student's t as a part of that at zero.
fn beyond(times: f64) -> f64 {
    -0.5 * (DEGREES + 1.0) * (times * times / DEGREES).ln_1p()
}

/// By what part the mass matrix grows at most for a unit of a parameter.
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
        // 35 rotors cost twelve units of the logarithm, half of one next to nothing.
        assert!((beyond(35.0) + 12.0).abs() < 0.1 && beyond(0.5) > -0.2);
    }
}
