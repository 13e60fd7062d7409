//! Feedback laws: each kind has a file with its keys, its values and its operations.

use std::fmt::Debug;

use appell_analysis::control::sampled::Sampling;
use appell_analysis::control::sampler::Sampler;
use appell_codegen::symbolic::Rational;
use appell_codegen::tape::{Argument, Tape, Value};
use appell_runtime::model::{Along, Model};
use appell_runtime::real::Enclosure;
use appell_spec::expr::Expr;

use crate::formula::StateFunction;

/// A feedback law.
pub trait Law: Debug + Send + Sync {
    /// Desired values as functions of time; their values are arguments of the law, in this order.
    fn desired(&self) -> Vec<&Expr>;

    /// Up to which order the derivatives of a desired value follow it among the arguments.
    fn derivatives(&self) -> usize {
        0
    }

    /// Its place among laws.
    fn stage(&self) -> Stage;

    /// Sampling of a discrete-time law.
    fn sampling(&self) -> Option<Sampling> {
        None
    }

    /// Adds its inputs to the declared inputs of a model.
    fn add(&self, at: &Moment<'_>, u: &mut [f64]);

    /// Adds its inputs as operations, if it can be part of a closed loop.
    fn write(&self, _desired: &[Value], _tape: &mut Tape, _inputs: &mut [Value]) {}

    /// Adds bounds on its inputs along a segment of a motion.
    fn bounds(&self, _desired: &[Enclosure], _along: &Along<'_>, u: &mut [Enclosure]) {
        u.fill(Enclosure::UNKNOWN);
    }
}

/// The order in which laws are added. Inputs of sampled laws and of those by inverse dynamics are external to a closed
/// loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Constant gains in continuous time.
    Gains,
    /// Scheduled gains.
    Schedule,
    /// Constant gains in discrete time.
    Sampled,
    /// Inverse dynamics, which depends on the other inputs.
    Model,
}

/// Arguments of a law.
pub struct Moment<'m> {
    pub(crate) model: &'m dyn Model,
    pub(crate) t: f64,
    pub(crate) x: &'m [f64],
    pub(crate) p: &'m [f64],
    /// Its desired values, each with its derivatives.
    pub(crate) desired: &'m [f64],
    /// Has the signals of the model.
    pub(crate) function: &'m StateFunction,
    /// Measurements of a discrete-time law.
    pub(crate) sampler: Option<&'m Sampler>,
}

/// A state as an argument of operations.
pub(super) fn state(tape: &mut Tape, place: usize) -> Value {
    tape.argument(Argument::State(index(place)))
}

/// A number of a law, which is finite.
pub(super) fn number(tape: &mut Tape, value: f64) -> Value {
    tape.constant(Rational::from_f64(value).unwrap_or(Rational::ZERO))
}

pub(crate) fn index(place: usize) -> u32 {
    u32::try_from(place).unwrap_or(u32::MAX)
}
