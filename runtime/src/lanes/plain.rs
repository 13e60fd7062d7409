//! Blocks place by place.

use super::{AtLanes, LANES};

/// Calls a function for every place of a block: with its time, its states, inputs and parameters, and
/// slices for its results. Models do so that have no code for blocks; called directly, it evaluates
/// any model in the plain mode, with the functions of the standard library.
pub fn place_by_place<const R: usize>(
    at: AtLanes<'_>,
    mut results: [&mut [[f64; LANES]]; R],
    mut evaluate: impl FnMut(f64, [&[f64]; 3], [&mut [f64]; R]),
) {
    let of_lane = |numbers: &[[f64; LANES]], lane: usize| -> Vec<f64> {
        numbers.iter().map(|number| number[lane]).collect()
    };
    let mut found = results.each_ref().map(|result| vec![0.0; result.len()]);
    for lane in 0..LANES {
        let numbers = [at.x, at.u, at.p].map(|numbers| of_lane(numbers, lane));
        let numbers = numbers.each_ref().map(Vec::as_slice);
        evaluate(at.t[lane], numbers, found.each_mut().map(Vec::as_mut_slice));
        for (result, found) in results.iter_mut().zip(&found) {
            for (number, found) in result.iter_mut().zip(found) {
                number[lane] = *found;
            }
        }
    }
}
