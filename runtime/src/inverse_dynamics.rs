//! Inverse dynamics of models that have no formulas of their own for it.

use crate::differences::columns;
use crate::model::{At, Model};

/// What [`Model::inverse_dynamics`] writes, from M, b and Π.
pub fn demand<M: Model + ?Sized>(model: &M, at: At<'_>, accelerations: &[f64], demand: &mut [f64]) {
    let s = demand.len();
    let (mut mass, mut bias, mut forces) = (vec![0.0; s * s], vec![0.0; s], vec![0.0; s]);
    model.appell(at, &mut mass, &mut bias, &mut forces);
    for (i, demand) in demand.iter_mut().enumerate() {
        let inertial = mass[i * s..].iter().zip(accelerations);
        *demand = inertial.map(|(m, a)| m * a).sum::<f64>() + bias[i] - forces[i];
    }
}

/// What [`Model::inverse_dynamics_jacobians`] writes, by differences: to about nine digits.
pub fn jacobians<M: Model + ?Sized>(
    model: &M,
    at: At<'_>,
    accelerations: &[f64],
    [demand, by_state, by_inputs, mass]: [&mut [f64]; 4],
) {
    model.inverse_dynamics(at, accelerations, demand);
    columns(at.x, by_state, at.x.len(), |x, column| {
        model.inverse_dynamics(At { x, ..at }, accelerations, column);
    });
    columns(at.u, by_inputs, at.u.len(), |u, column| {
        model.inverse_dynamics(At { u, ..at }, accelerations, column);
    });
    let s = demand.len();
    model.appell(at, mass, &mut vec![0.0; s], &mut vec![0.0; s]);
}
