//! Quantities that can be prescribed, varied or left free in a steady motion.

use std::borrow::Cow;

use crate::point::Point;
use crate::steady::starts::reach;
use appell_runtime::model::{Model, ModelInfo, Quantity};

/// A quantity of a model, by its index in [`ModelInfo`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Term {
    /// A pseudo-velocity or coordinate.
    State(usize),
    /// The rate of a state, such as that of an ignorable angle; `psi_dot` for a state `psi`.
    Rate(usize),
    /// An input or signal.
    Input(usize),
    /// A parameter.
    Parameter(usize),
    /// An output.
    Output(usize),
}

impl Term {
    /// The term of a name: that of a state, input, parameter or output, or `…_dot` for the rate of a
    /// coordinate.
    pub fn named(info: &ModelInfo, name: &str) -> Option<Self> {
        let rate = || {
            let coordinate = info.state_index(name.strip_suffix("_dot")?)?;
            (coordinate >= info.speeds).then_some(Self::Rate(coordinate))
        };
        info.state_index(name)
            .map(Self::State)
            .or_else(|| info.input_index(name).map(Self::Input))
            .or_else(|| info.parameter_index(name).map(Self::Parameter))
            .or_else(|| info.output_index(name).map(Self::Output))
            .or_else(rate)
    }

    /// All names that [`Term::named`] understands.
    pub fn names(info: &ModelInfo) -> Vec<String> {
        let lists = [&info.states, &info.inputs, &info.parameters, &info.outputs];
        let plain = lists.into_iter().flat_map(|list| list.iter());
        let rates = info.coordinate_quantities().iter();
        plain
            .map(|quantity| quantity.name.to_string())
            .chain(rates.map(|coordinate| format!("{}_dot", coordinate.name)))
            .collect()
    }

    /// Name, unit and range for people.
    pub fn quantity(self, info: &ModelInfo) -> Cow<'_, Quantity> {
        match self {
            Self::State(i) => Cow::Borrowed(&info.states[i]),
            Self::Input(i) => Cow::Borrowed(&info.inputs[i]),
            Self::Parameter(i) => Cow::Borrowed(&info.parameters[i]),
            Self::Output(i) => Cow::Borrowed(&info.outputs[i]),
            Self::Rate(i) => {
                let of = &info.states[i];
                Cow::Owned(Quantity {
                    name: format!("{}_dot", of.name).into(),
                    about: format!("rate of {}", of.about).into(),
                    unit: format!("{}/s", of.unit).into(),
                    scale: of.scale,
                    ..Quantity::new("", "", "")
                })
            }
        }
    }

    /// Its name.
    pub fn name(self, info: &ModelInfo) -> String {
        self.quantity(info).name.to_string()
    }

    /// Its value in SI.
    pub fn value(self, model: &dyn Model, point: &Point) -> f64 {
        match self {
            Self::State(i) => point.x[i],
            Self::Rate(i) => point.rates(model)[i],
            Self::Input(i) => point.u[i],
            Self::Parameter(i) => point.p[i],
            Self::Output(i) => point.outputs(model)[i],
        }
    }

    /// Its entry in a point; `None` for dependent quantities.
    pub(super) fn place(self, point: &mut Point) -> Option<&mut f64> {
        match self {
            Self::State(i) => point.x.get_mut(i),
            Self::Input(i) => point.u.get_mut(i),
            Self::Parameter(i) => point.p.get_mut(i),
            Self::Rate(_) | Self::Output(_) => None,
        }
    }

    /// Its typical change in SI: the scale of the unknown.
    pub(super) fn scale(self, info: &ModelInfo, point: &Point) -> f64 {
        match self {
            Self::Parameter(i) if point.p[i] != 0.0 => point.p[i].abs(),
            Self::Input(_) | Self::Output(_) | Self::Rate(_) => 1.0,
            _ => reach(&self.quantity(info)),
        }
    }
}
