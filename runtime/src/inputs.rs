//! Inputs of a model as functions of time and state.

use crate::model::{Along, Interpolation, ModelInfo, SignalTable, Switching};
use crate::real::{Enclosure, Real};
use crate::signal::{Signal, SignalError, differentiated, enclosed};

/// The declared inputs of a model as functions of time and state.
///
/// At a discontinuity of an input the right-hand limit is required; the integrator evaluates the left-hand limit just
/// before it if the time is among [`InputSource::switching_times`].
pub trait InputSource {
    /// Writes the declared inputs at `t` in s and state `x`, all in SI.
    fn inputs(&self, t: f64, x: &[f64], u: &mut [f64]);

    /// Times in s at which the inputs are discontinuous or not smooth, in any order.
    fn switching_times(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Bounds on the declared inputs along a segment of a motion, whose own inputs are ignored.
    fn bounds(&self, along: &Along<'_>, u: &mut [Enclosure]) {
        let _ = along;
        u.fill(Enclosure::UNKNOWN);
    }

    /// Switching functions of the inputs at times that are not known in advance, if any.
    fn switching(&self) -> Option<&dyn Switching> {
        None
    }
}

/// A smooth function of time and state is an input source.
impl<F: Fn(f64, &[f64], &mut [f64])> InputSource for F {
    fn inputs(&self, t: f64, x: &[f64], u: &mut [f64]) {
        self(t, x, u);
    }
}

/// All inputs zero.
#[derive(Debug, Clone, Copy)]
pub struct ZeroInputs;

impl InputSource for ZeroInputs {
    fn inputs(&self, _: f64, _: &[f64], u: &mut [f64]) {
        u.fill(0.0);
    }

    fn bounds(&self, _: &Along<'_>, u: &mut [Enclosure]) {
        u.fill(Enclosure::constant(0.0));
    }
}

/// A function of time and state, such as a feedback law, with switching times.
#[derive(Debug, Clone)]
pub struct SwitchedInputs<F> {
    /// Writes the inputs, see [`InputSource::inputs`].
    pub function: F,
    /// See [`InputSource::switching_times`].
    pub switching_times: Vec<f64>,
}

impl<F: Fn(f64, &[f64], &mut [f64])> InputSource for SwitchedInputs<F> {
    fn inputs(&self, t: f64, x: &[f64], u: &mut [f64]) {
        (self.function)(t, x, u);
    }

    fn switching_times(&self) -> Vec<f64> {
        self.switching_times.clone()
    }
}

/// One tabulated signal per input; inputs without one are zero.
#[derive(Debug, Clone, PartialEq)]
pub struct TabulatedInputs {
    signals: Vec<Signal>,
}

impl TabulatedInputs {
    /// Inputs in the order of the model.
    pub fn new(signals: Vec<Signal>) -> Self {
        Self { signals }
    }

    /// Zero-order hold: `columns[i][k]` is input i from `times[k]` up to `times[k + 1]`. Before the first and after
    /// the last row the value of that row applies.
    pub fn held(times: &[f64], columns: &[Vec<f64>]) -> Result<Self, SignalError> {
        let signal = |(i, values): (usize, &Vec<f64>)| {
            Signal::new(&SignalTable {
                name: format!("input {i}").into(),
                times: times.to_vec().into(),
                values: values.clone().into(),
                interpolation: Interpolation::Hold,
            })
        };
        let signals = columns
            .iter()
            .enumerate()
            .map(signal)
            .collect::<Result<_, _>>()?;
        Ok(Self { signals })
    }
}

impl InputSource for TabulatedInputs {
    fn inputs(&self, t: f64, _: &[f64], u: &mut [f64]) {
        u.fill(0.0);
        for (u, signal) in u.iter_mut().zip(&self.signals) {
            *u = signal.value(t);
        }
    }

    fn bounds(&self, along: &Along<'_>, u: &mut [Enclosure]) {
        let since = along.t - Enclosure::constant(along.start);
        u.fill(Enclosure::constant(0.0));
        for (u, signal) in u.iter_mut().zip(&self.signals) {
            *u = enclosed(signal.polynomial(along.start), since);
        }
    }

    fn switching_times(&self) -> Vec<f64> {
        let mut times: Vec<f64> = self
            .signals
            .iter()
            .flat_map(Signal::knots)
            .copied()
            .collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        times
    }
}

/// All inputs of a model: the declared ones from a source, the signals from the model's tables.
pub struct ModelInputs<'a> {
    source: &'a dyn InputSource,
    signals: Vec<Signal>,
    /// Signal and order of its derivative for each input after the declared ones.
    signal_inputs: &'a [(usize, u8)],
    declared: usize,
}

impl<'a> ModelInputs<'a> {
    /// Prepares the model's signals.
    pub fn new(info: &'a ModelInfo, source: &'a dyn InputSource) -> Result<Self, SignalError> {
        let signals = info
            .signals
            .iter()
            .map(Signal::new)
            .collect::<Result<_, _>>()?;
        Ok(Self {
            source,
            signals,
            signal_inputs: &info.signal_inputs,
            declared: info.declared_inputs,
        })
    }

    /// Writes all inputs of the model at `t` in s and state `x`, in SI. A missing signal gives NaN.
    pub fn fill(&self, t: f64, x: &[f64], u: &mut [f64]) {
        let (declared, signals) = u.split_at_mut(self.declared.min(u.len()));
        self.source.inputs(t, x, declared);
        for (u, &(signal, order)) in signals.iter_mut().zip(self.signal_inputs) {
            *u = self
                .signals
                .get(signal)
                .map_or(f64::NAN, |signal| signal.derivative(t, order));
        }
    }

    /// Bounds on all inputs of the model along a segment of a motion.
    pub fn bounds(&self, along: &Along<'_>, u: &mut [Enclosure]) {
        let (declared, signals) = u.split_at_mut(self.declared.min(u.len()));
        self.source.bounds(along, declared);
        let since = along.t - Enclosure::constant(along.start);
        for (u, &(signal, order)) in signals.iter_mut().zip(self.signal_inputs) {
            *u = self
                .signals
                .get(signal)
                .map_or(Enclosure::UNKNOWN, |signal| {
                    enclosed(differentiated(signal.polynomial(along.start), order), since)
                });
        }
    }

    /// Switching functions of the declared inputs at times that are not known in advance.
    pub fn switching(&self) -> Option<&dyn Switching> {
        self.source.switching()
    }

    /// Times in s at which an input is discontinuous or not smooth.
    pub fn switching_times(&self) -> Vec<f64> {
        let mut times = self.source.switching_times();
        times.extend(self.signals.iter().flat_map(Signal::knots));
        times
    }
}

impl std::fmt::Debug for ModelInputs<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("ModelInputs")
            .field("signals", &self.signals)
            .field("declared", &self.declared)
            .finish_non_exhaustive()
    }
}
