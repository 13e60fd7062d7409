//! How disturbances enter the covariance of a step.

use super::square_root::triangularise;
use crate::data::setup::{Disturbance, Setup};
use crate::matrix::{multiply, pieces};
use crate::motion::plant::{Place, Plant, Scratch};

/// The root of P⁺ = F (P + N) Fᵀ + N, from F, the root of P and the columns of the disturbances; `noise` are the roots of N
/// along these.
pub(super) fn disturbed(
    [f, before, columns]: [&[f64]; 3],
    [n, d]: [usize; 2],
    noise: impl Fn(usize) -> f64,
    [spread, wide]: [&mut [f64]; 2],
    root: &mut [f64],
) {
    // [S, N½], then [F S, F N½, N½].
    let [joint, moved] = pieces(spread, [n * (n + d), n * (n + d)]);
    for (i, joint) in joint.chunks_exact_mut(n + d).enumerate() {
        joint[..n].copy_from_slice(&before[i * n..(i + 1) * n]);
        for j in 0..d {
            joint[n + j] = noise(j) * columns[i * d + j];
        }
    }
    multiply(f, joint, n, moved);
    let rows = wide.chunks_exact_mut(n + 2 * d);
    let parts = moved.chunks_exact(n + d).zip(joint.chunks_exact(n + d));
    for (wide, (moved, joint)) in rows.zip(parts) {
        wide[..n + d].copy_from_slice(moved);
        wide[n + d..].copy_from_slice(&joint[n..]);
    }
    triangularise(wide, n, root);
}

/// Columns along which the disturbances act on ż: n rows, a column each.
pub(super) fn directions(
    setup: &Setup<'_>,
    plant: &Plant<'_>,
    place: Place<'_>,
    scratch: &mut Scratch,
    columns: &mut [f64],
) {
    let (d, s) = (setup.disturbances.len(), plant.speeds);
    columns.fill(0.0);
    let mut forces = false;
    for (j, disturbance) in setup.disturbances.iter().enumerate() {
        match *disturbance {
            Disturbance::Force(speed) => {
                columns[speed * d + j] = 1.0;
                forces = true;
            }
            Disturbance::Rate(_) => {}
        }
    }
    if forces {
        plant.accelerations(place, scratch, &mut columns[..s * d]);
    }
    for (j, disturbance) in setup.disturbances.iter().enumerate() {
        if let Disturbance::Rate(state) = *disturbance {
            columns[state * d + j] = 1.0;
        }
    }
}
