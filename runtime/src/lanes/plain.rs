//! Blocks place by place.

use super::{AtLanes, LANES};
use crate::model::At;

/// Calls a function for every place of a block with its numbers and slices for its results. Emitted
/// models override the methods of [`Model`](crate::model::Model) that do this; called directly, it
/// evaluates them in the plain mode, with the functions of the standard library.
pub fn place_by_place<const R: usize>(
    at: AtLanes<'_>,
    mut results: [&mut [[f64; LANES]]; R],
    mut evaluate: impl FnMut(At<'_>, [&mut [f64]; R]),
) {
    let of_lane = |numbers: &[[f64; LANES]], lane: usize| -> Vec<f64> {
        numbers.iter().map(|number| number[lane]).collect()
    };
    let mut found = results.each_ref().map(|result| vec![0.0; result.len()]);
    for lane in 0..LANES {
        let [x, u, p] = [at.x, at.u, at.p].map(|numbers| of_lane(numbers, lane));
        let t = at.t[lane];
        let place = At {
            t,
            x: &x,
            u: &u,
            p: &p,
        };
        evaluate(place, found.each_mut().map(Vec::as_mut_slice));
        for (result, found) in results.iter_mut().zip(&found) {
            for (number, found) in result.iter_mut().zip(found) {
                number[lane] = *found;
            }
        }
    }
}
