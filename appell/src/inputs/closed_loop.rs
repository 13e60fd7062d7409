//! Equations of motion with their inputs substituted, for eight motions at once.

use appell_codegen::jit::{Elementary, Sizes};
use appell_codegen::tape::{Seen, Tape};
use appell_runtime::integrate::Places;
use appell_runtime::lanes::{AtLanes, LANES};
use appell_vector::{Target, VectorError, VectorFunction};

use super::law::index;

/// Target of a disturbance in the measurements of laws.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Onto {
    /// A measured state: the disturbance is added.
    Measured(usize),
    /// A parameter of laws alone: the disturbance replaces it.
    Parameter(usize),
}

/// External inputs of a closed loop.
#[derive(Debug, Clone, Copy)]
pub(super) struct Outside {
    /// Number of inputs.
    pub(super) inputs: usize,
    /// Whether any of them is ever nonzero.
    pub(super) is_there: bool,
}

/// The equations with expressions and laws. They call the elementary functions of the runtime, so that results agree
/// bit by bit on every machine.
pub(crate) struct ClosedLoop {
    rates: VectorFunction,
    inputs: usize,
    /// Whether any of the inputs is ever nonzero.
    is_driven: bool,
}

impl ClosedLoop {
    /// From the rates as a function of what is outside, with `seen` disturbances of the measurements.
    pub(super) fn new(
        rates: &Tape,
        sizes: Sizes,
        outside: Outside,
        seen: usize,
    ) -> Result<Self, VectorError> {
        let sizes = Sizes {
            inputs: outside.inputs + seen,
            ..sizes
        };
        let target = Target {
            elementary: Elementary::Own,
            ..Target::default()
        };
        Ok(Self {
            rates: VectorFunction::compile_or_interpret(rates, sizes, target)?,
            inputs: sizes.inputs,
            is_driven: outside.is_there || seen > 0,
        })
    }

    /// The rates of blocks of motions; `fill` writes the inputs of a motion by its index, for a time and a state: external
    /// ones, then disturbances of the measurements.
    pub(crate) fn rates_of(
        &self,
        fill: impl Fn(usize, f64, &[f64], &mut [f64]),
    ) -> impl FnMut(&[usize; LANES], Places<'_>, &mut [[f64; LANES]]) {
        let mut u = vec![[0.0; LANES]; self.inputs];
        let (mut state, mut inputs) = (Vec::new(), vec![0.0; self.inputs]);
        move |which, Places { t, x, p }, rates| {
            let driven = which.iter().enumerate().filter(|_| self.is_driven);
            for (lane, &motion) in driven {
                state.clear();
                state.extend(x.iter().map(|x| x[lane]));
                fill(motion, t[lane], &state, &mut inputs);
                for (u, input) in u.iter_mut().zip(&inputs) {
                    u[lane] = *input;
                }
            }
            let at = AtLanes { t, x, u: &u, p };
            self.rates.call(at, [rates]);
        }
    }
}

impl Onto {
    /// The disturbance as an input of the closed loop.
    pub(super) fn seen(self, by: usize) -> Seen {
        let by = index(by);
        match self {
            Self::Measured(state) => Seen::Disturbed {
                state: index(state),
                by,
            },
            Self::Parameter(parameter) => Seen::Replaced {
                parameter: index(parameter),
                by,
            },
        }
    }
}
