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
    fn block<const N: usize>(at: AtLanes<'_, N>, results: [&mut [[f64; N]]; 3]) {
        Self::block_at(Level::Avx512, at, results);
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
        // Unknown until it was computed.
        let mut unknown = true;
        let _ = level.run_in_vectors(
            #[inline(always)]
            || unknown = Self::evaluate::<Fast, N>(at.t, x, u, p, first, second, third),
        );
        if unknown {
            Self::places(at, [first, second, third]);
        }
    }

    /// The same place by place: for equations that a loop over lanes does not make vector code of.
    ///
    /// # Panics
    ///
    /// If a slice is shorter than its array.
    #[inline]
    fn places<const N: usize>(at: AtLanes<'_, N>, [first, second, third]: [&mut [[f64; N]]; 3]) {
        for lane in 0..N {
            let (t, x, u, p) = (
                [at.t[lane]],
                only(at.x, lane),
                only(at.u, lane),
                only(at.p, lane),
            );
            let results = alone::<Self, X, U, P, A, B, C>(t, &x, &u, &p);
            put(results.0, first, lane);
            put(results.1, second, lane);
            put(results.2, third, lane);
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
        let [x, u, p] = [at.x, at.u, at.p].map(|numbers| numbers.as_chunks().0);
        let [first, second, third] = results.map(|numbers| numbers.as_chunks_mut().0);
        let found = alone::<Self, X, U, P, A, B, C>([at.t], array(x), array(u), array(p));
        *array_mut(first) = found.0;
        *array_mut(second) = found.1;
        *array_mut(third) = found.2;
    }
}

/// A vector at one place.
type One<const LEN: usize> = [[f64; 1]; LEN];

/// Equations at one place, without branches where that does.
#[inline(never)]
fn alone<
    E: Equations<X, U, P, A, B, C> + ?Sized,
    const X: usize,
    const U: usize,
    const P: usize,
    const A: usize,
    const B: usize,
    const C: usize,
>(
    t: [f64; 1],
    x: &One<X>,
    u: &One<U>,
    p: &One<P>,
) -> (One<A>, One<B>, One<C>) {
    let (mut first, mut second, mut third) = ([[0.0]; A], [[0.0]; B], [[0.0]; C]);
    // Unknown until it was computed.
    let mut unknown = true;
    // One number needs no wider vectors.
    let _ = Level::Avx2.run_in_vectors(
        #[inline(always)]
        || unknown = E::evaluate::<Fast, 1>(&t, x, u, p, &mut first, &mut second, &mut third),
    );
    if unknown {
        E::evaluate::<Lanes<1, Own>, 1>(&t, x, u, p, &mut first, &mut second, &mut third);
    }
    (first, second, third)
}

fn only<const N: usize, const LEN: usize>(of: &[[f64; N]], lane: usize) -> One<LEN> {
    array(of).map(|numbers| [numbers[lane]])
}

fn put<const N: usize, const LEN: usize>(from: One<LEN>, to: &mut [[f64; N]], lane: usize) {
    for ([from], to) in from.into_iter().zip(array_mut::<N, LEN>(to)) {
        to[lane] = from;
    }
}

fn array<const N: usize, const LEN: usize>(slice: &[[f64; N]]) -> &[[f64; N]; LEN] {
    let array = slice.first_chunk();
    array.unwrap_or_else(|| too_short(slice.len(), LEN))
}

fn array_mut<const N: usize, const LEN: usize>(slice: &mut [[f64; N]]) -> &mut [[f64; N]; LEN] {
    let found = slice.len();
    let array = slice.first_chunk_mut();
    array.unwrap_or_else(|| too_short(found, LEN))
}

#[cold]
fn too_short(found: usize, needed: usize) -> ! {
    panic!("{found} numbers for a vector of {needed}")
}
