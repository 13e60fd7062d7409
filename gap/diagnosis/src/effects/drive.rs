//! The drive of a joint: forces of inputs along a pseudo-velocity, and the driven inertia.

use appell_runtime::model::{At, Model};
use nalgebra::DMatrix;

/// Largest relative variation of a constant lever along the range.
const SAME: f64 = 1e-9;
/// Range of the coordinates, in SI.
const AWAY: f64 = 0.3;

/// The drive along a pseudo-velocity.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Drive {
    /// Force for a unit of each input.
    levers: Vec<f64>,
    /// Inertia along the pseudo-velocity at the initial state, all others free.
    pub(super) inertia: f64,
}

impl Drive {
    /// The drive of a pseudo-velocity; `None` if no input acts along it, or one through a varying lever.
    pub(crate) fn of(model: &dyn Model, p: &[f64], speed: usize) -> Option<Self> {
        let info = model.info();
        let (s, inputs) = (info.speeds, info.declared_inputs);
        let begin = info.initial_state();
        let mut away = begin.clone();
        away[s..].iter_mut().for_each(|q| *q += AWAY);
        let (mut mass, mut bias, mut forces) = (vec![0.0; s * s], vec![0.0; s], vec![0.0; s]);
        let mut force = |x: &[f64], input: Option<usize>| {
            let mut u = vec![0.0; info.input_len()];
            if let Some(input) = input {
                u[input] = 1.0;
            }
            let (t, u) = (0.0, &u);
            model.appell(At { t, x, u, p }, &mut mass, &mut bias, &mut forces);
            forces[speed]
        };
        let mut levers = Vec::new();
        for input in 0..inputs {
            let [here, there] = [&begin, &away].map(|x| force(x, Some(input)) - force(x, None));
            let same = (here - there).abs() <= SAME * here.abs().max(1.0);
            levers.push(same.then_some(here)?);
        }
        force(&begin, None);
        let inverse = DMatrix::from_row_slice(s, s, &mass).try_inverse()?;
        let inertia = inverse[(speed, speed)].recip();
        let drives = levers.iter().any(|lever| lever.abs() > SAME);
        (drives && inertia > 0.0 && inertia.is_finite()).then_some(Self { levers, inertia })
    }

    /// Its force under these inputs.
    pub(crate) fn force(&self, inputs: &[f64]) -> f64 {
        self.levers.iter().zip(inputs).map(|(l, u)| l * u).sum()
    }

    /// Its force as an expression in the names of the inputs.
    pub(super) fn written<'n>(&self, inputs: impl Iterator<Item = &'n str>) -> String {
        let acting = self.levers.iter().zip(inputs);
        let acting = acting.filter(|(lever, _)| lever.abs() > SAME);
        let term = |(lever, input): (&f64, &str)| {
            if (lever - 1.0).abs() <= SAME {
                input.to_owned()
            } else {
                format!("({lever})*{input}")
            }
        };
        acting.map(term).collect::<Vec<_>>().join(" + ")
    }
}
