//! Eight places at once.
//!
//! A *block* is one number for each of eight places, `[f64; LANES]`. Models are evaluated at a
//! block of places by arrays of blocks, component by component: component `i` of place `l` is
//! `x[i][l]`. There are always eight, whatever the processor does at once, so no result depends on
//! it. Where fewer places are left, the last is repeated.

use std::array::from_fn;

use crate::model::At;

/// Places of a block.
pub const LANES: usize = 8;

/// Where a model is evaluated: [`At`] for eight places.
#[derive(Debug, Clone, Copy)]
pub struct AtLanes<'a> {
    /// Times in seconds.
    pub t: &'a [f64; LANES],
    /// States: pseudo-velocities, coordinates.
    pub x: &'a [[f64; LANES]],
    /// Inputs, then signals.
    pub u: &'a [[f64; LANES]],
    /// Parameters.
    pub p: &'a [[f64; LANES]],
}

/// The numbers of one place.
pub fn lane(blocks: &[[f64; LANES]], lane: usize) -> Vec<f64> {
    blocks.iter().map(|block| block[lane]).collect()
}

/// Evaluates a function of one place at each of eight: by the number of the place, where it is, and
/// its results.
pub fn place_by_place<const N: usize>(
    at: AtLanes<'_>,
    mut results: [&mut [[f64; LANES]]; N],
    mut evaluate: impl FnMut(usize, At<'_>, [&mut [f64]; N]),
) {
    let mut written: [Vec<f64>; N] = from_fn(|result| vec![0.0; results[result].len()]);
    for l in 0..LANES {
        let [x, u, p] = [at.x, at.u, at.p].map(|blocks| lane(blocks, l));
        let (t, x, u, p) = (at.t[l], &x, &u, &p);
        evaluate(l, At { t, x, u, p }, written.each_mut().map(|w| &mut w[..]));
        for (result, written) in results.iter_mut().zip(&written) {
            for (block, number) in result.iter_mut().zip(written) {
                block[l] = *number;
            }
        }
    }
}
