//! The embedded pairs for one motion.

use super::block::BlockSolver;
use super::block_lanes::Parts;
use super::block_stages::Places;
use super::error::IntegrationError;
use super::options::Options;
use super::outcome::Outcome;
use super::pairs::EmbeddedPair;
use super::watch::{Observer, Watch};

/// An adaptive integrator with its work arrays.
///
/// The arrays are allocated at the first use, so that repeated integrations of the same size allocate only switching
/// times, located events and errors.
///
/// An ensemble with a common step is one system: state i of member k at `x[members * i + k]`, with
/// rates computed in [`Lanes`](crate::Lanes). Its error is the root mean square over all members.
#[derive(Debug, Clone)]
pub struct Solver<P>(BlockSolver<P, 1>);

impl<P> Default for Solver<P> {
    fn default() -> Self {
        Self(BlockSolver::default())
    }
}

impl<P: EmbeddedPair> Solver<P> {
    /// A solver for systems of any size.
    pub fn new() -> Self {
        Self::default()
    }

    /// Integrates ẋ = f(t, x) over `span`, forward in time.
    ///
    /// `f(t, x, rates)` writes ẋ. `x` holds the initial state and is overwritten with the final one, also after an
    /// error. `watch` lists switching times, ranges and events, `observer` receives the accepted steps. To integrate
    /// backward, substitute t = −s.
    pub fn integrate<F, O>(
        &mut self,
        mut f: F,
        span: [f64; 2],
        x: &mut [f64],
        options: &Options,
        watch: &mut Watch<'_>,
        observer: &mut O,
    ) -> Result<Outcome, IntegrationError>
    where
        F: FnMut(f64, &[f64], &mut [f64]),
        O: Observer,
    {
        options.check(span)?;
        watch.check(x.len())?;
        let n = x.len();
        let parts = Parts {
            span,
            x,
            parameters: &[],
            watch,
            observer,
        };
        let mut f = |_: &[usize; 1], at: Places<'_, 1>, rates: &mut [[f64; 1]]| {
            f(at.t[0], at.x.as_flattened(), rates.as_flattened_mut());
        };
        let mut results = self.0.run(&mut f, [parts].into_iter(), n, options);
        // There is a result for the motion.
        results.swap_remove(0)
    }
}
