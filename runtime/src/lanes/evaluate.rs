//! Equations over blocks and places.

use super::AtLanes;
use super::dispatch::Level;
use super::fast::Fast;
use super::lane::Lane;
#[cfg(feature = "std")]
use crate::model::At;
use crate::real::{Lanes, Own};

/// Equations for any scalar, with `X` states, `U` inputs and `P` parameters, and up to three arrays of
/// results.
///
/// Emitted models implement it for the functions that are evaluated in lanes. What is not inlined is not
/// compiled for the processor's vectors: mark `evaluate` `#[inline(always)]`.
pub trait Equations<
    const X: usize,
    const U: usize,
    const P: usize,
    const A: usize,
    const B: usize,
    const C: usize,
>
{
    /// For all lanes in a loop: reads time, states, inputs and parameters and writes the results. Whether
    /// one of them is NaN.
    // References of their own, which tell the compiler that they do not overlap; arrays, so that no index
    // is checked: the loop becomes vector code.
    fn evaluate<T: Lane, const N: usize>(
        t: &[f64; N],
        x: &[[f64; N]; X],
        u: &[[f64; N]; U],
        p: &[[f64; N]; P],
        first: &mut [[f64; N]; A],
        second: &mut [[f64; N]; B],
        third: &mut [[f64; N]; C],
    ) -> bool;

    /// Evaluates every place of a block with the functions of [`crate::elementary`].
    ///
    /// # Panics
    ///
    /// If a slice is shorter than its array.
    #[inline]
    fn block<const N: usize>(at: AtLanes<'_, N>, [first, second, third]: [&mut [[f64; N]]; 3]) {
        Self::block_at(Level::Avx512, at, [first, second, third]);
    }

    /// [`Equations::block`] with vectors no wider than a level; the results are the same bits.
    ///
    /// # Panics
    ///
    /// If a slice is shorter than its array.
    #[inline]
    fn block_at<const N: usize>(
        level: Level,
        at: AtLanes<'_, N>,
        [first, second, third]: [&mut [[f64; N]]; 3],
    ) {
        let (x, u, p) = (array(at.x), array(at.u), array(at.p));
        let (first, second, third) = (array_mut(first), array_mut(second), array_mut(third));
        let mut unknown = false;
        level.run(
            #[inline(always)]
            || unknown = Self::evaluate::<Fast, N>(at.t, x, u, p, first, second, third),
        );
        if unknown {
            // What `Fast` numbers cannot do.
            Self::evaluate::<Lanes<1, Own>, N>(at.t, x, u, p, first, second, third);
        }
    }

    /// Evaluates one place: what [`Equations::block`] gives there.
    ///
    /// # Panics
    ///
    /// If a slice is shorter than its array.
    #[cfg(feature = "std")]
    #[inline]
    fn place(at: At<'_>, results: [&mut [f64]; 3]) {
        let at = AtLanes {
            t: &[at.t],
            x: at.x.as_chunks().0,
            u: at.u.as_chunks().0,
            p: at.p.as_chunks().0,
        };
        Self::block::<1>(at, results.map(|numbers| numbers.as_chunks_mut().0));
    }
}

fn array<const N: usize, const LEN: usize>(slice: &[[f64; N]]) -> &[[f64; N]; LEN] {
    slice
        .first_chunk()
        .expect("as many numbers as the model has")
}

fn array_mut<const N: usize, const LEN: usize>(slice: &mut [[f64; N]]) -> &mut [[f64; N]; LEN] {
    slice
        .first_chunk_mut()
        .expect("as many numbers as the model has")
}
