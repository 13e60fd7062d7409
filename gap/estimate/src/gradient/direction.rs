//! Directions of differentiation of the innovations, and the derivatives.

use nalgebra::DMatrix;

use appell_runtime::model::At;

use crate::data::unknown::Unknown;
use crate::kalman::filter::Innovation;

/// Direction of differentiation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// A value. Levels and spreads do not affect the mean.
    Value(Unknown),
    /// A delay in s of a declared input; for a lag it is the same to first order.
    LateInput(usize),
    /// A delay in s of a channel; for a lag that the channel does not have it is the same to first
    /// order.
    LateChannel(usize),
}

/// Where shapes are added.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Along {
    /// The force of each disturbance.
    Disturbances,
    /// The reading of each channel.
    Channels,
}

/// Candidate additions to the model: functions of run, time, state and inputs, each along each
/// disturbance, or as an error of each channel.
#[derive(Clone, Copy)]
pub struct Shapes<'s> {
    /// Where they are added.
    pub along: Along,
    /// Their number.
    pub count: usize,
    /// Writes the values of all shapes.
    pub values: &'s (dyn Fn(usize, At<'_>, &mut [f64]) + Sync),
}

/// Derivatives of the whitened innovations.
#[derive(Debug, Clone)]
pub struct Tangent {
    /// The samples in the order of runs, rows and channels, with the run of each.
    pub samples: Vec<(usize, Innovation)>,
    /// A column for each sample; a row for each direction, then for each shape along the first
    /// disturbance or channel, and so on.
    pub slopes: DMatrix<f64>,
    /// For each shape along a disturbance, in the order of their columns: the mean square of its contribution per
    /// row, in standard deviations of the prediction of that row.
    pub added_squares: Vec<f64>,
}
