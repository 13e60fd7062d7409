//! Integration by Taylor series of the motion.
//!
//! A step expands the motion about its start to an order that follows from the tolerances and goes as far as
//! the last two terms allow (Jorba and Zou, *Experimental Mathematics* 14, 2005). The polynomial is the solution
//! between the ends: events, ranges and outputs cost no evaluation.

mod block;
mod block_expansion;
mod expansion;
mod guards;
mod products;

use super::dense_output::{DenseOutput, Ends};
use super::error::{Cause, IntegrationError};
use super::options::Options;
use super::outcome::{Outcome, Statistics};
use super::sign_changes::neighbours;
use super::step_size::power_of_all;
use super::stops::Stride;
use super::watch::{End, Observer, Watch, Watcher};
use crate::series::{Cubic, Series};
pub use block::{BlockTaylor, ExpandedTogether, MotionInputs};
use expansion::Expansion;
use guards::{Change, first_change};

/// Equations to be expanded, with what drives them.
pub struct Expanded<'a> {
    /// The equations.
    pub series: &'a dyn Series,
    /// Parameters in SI.
    pub parameters: &'a [f64],
    /// Writes the inputs as functions of the time since a given one in s, where the state is as given. They hold up
    /// to the next switching time.
    pub inputs: InputPolynomials<'a>,
}

/// Inputs from a time in s and a state on.
pub type InputPolynomials<'a> = Box<dyn Fn(f64, &[f64], &mut [Cubic]) + 'a>;

impl std::fmt::Debug for Expanded<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("Expanded")
            .field("shape", self.series.shape())
            .finish_non_exhaustive()
    }
}

/// An integrator by Taylor series with its work arrays.
#[derive(Debug, Clone, Default)]
pub struct Taylor {
    expansion: Expansion,
    dense: DenseOutput,
    inputs: Vec<Cubic>,
    x: Vec<f64>,
    x_new: Vec<f64>,
    rates: Vec<f64>,
    rates_new: Vec<f64>,
    slopes: Vec<f64>,
    order: usize,
    /// Whether the rates after the step are not those up to its end.
    restart: bool,
    /// Steps in a row that were too short to count.
    slivers: usize,
}

/// Limits of the order.
const LEAST_ORDER: usize = 6;
const MOST_ORDER: usize = 30;
/// Rounding leaves no more digits than this.
const LEAST_TOLERANCE: f64 = 1e-16;
/// The last terms of a step in tolerated errors.
const LAST_TERM: f64 = 0.5;
/// Shortening of a step at whose end the equations contradict the polynomial.
const SHORTER: f64 = 0.5;
/// Rounding of a state in a step, relative to it.
const ROUNDING: f64 = 64.0 * f64::EPSILON;
/// How far beyond a change a step may end, in steps.
const FARTHEST: f64 = 1e-6;
/// A step that is hardly one, in parts of the time.
const SLIVER: f64 = 1e-12;
/// So many of these in a row are one place that the motion does not leave.
const MOST_SLIVERS: usize = 100;

impl Taylor {
    /// An integrator for equations of any size.
    pub fn new() -> Self {
        Self::default()
    }

    /// Integrates over `span`, forward in time. `x` holds the initial state and leaves with the last one, also
    /// after an error; the other arguments are those of [`Solver::integrate`](super::Solver::integrate).
    pub fn integrate<O: Observer>(
        &mut self,
        equations: &Expanded<'_>,
        span: [f64; 2],
        x: &mut [f64],
        options: &Options,
        watch: &mut Watch<'_>,
        observer: &mut O,
    ) -> Result<Outcome, IntegrationError> {
        options.check(span)?;
        watch.check(x.len())?;
        self.prepare(equations, x, order(options))?;
        let mut watcher = Watcher::new(watch, observer, span).paced(span[0]);
        // The guards of the series are the same functions.
        watcher.stops.leave_crossings();
        let mut statistics = Statistics::default();
        let end = match watcher.start(span[0], x) {
            Ok(()) => self.run(
                equations,
                span[0],
                x,
                options,
                &mut watcher,
                &mut statistics,
            ),
            Err(cause) => End::failed(span[0], cause),
        };
        watcher.conclude(end, x, statistics)
    }

    /// The coefficients of orders 0 to `order` of the motion that passes `x` at `t` in s: `n` numbers each.
    pub fn coefficients(
        &mut self,
        equations: &Expanded<'_>,
        t: f64,
        x: &[f64],
        order: usize,
    ) -> Result<&[f64], IntegrationError> {
        self.prepare(equations, x, order.max(1))?;
        self.start(equations, t, &mut Statistics::default());
        self.advance(equations, t);
        let count = (order + 1) * x.len();
        Ok(&self.dense.taylor(t)[..count])
    }

    /// Sizes the arrays for expansions to an order.
    fn prepare(
        &mut self,
        equations: &Expanded<'_>,
        x: &[f64],
        order: usize,
    ) -> Result<(), IntegrationError> {
        let shape = equations.series.shape();
        for (what, given, expected) in [
            ("number of states", x.len(), shape.states),
            (
                "number of parameters",
                equations.parameters.len(),
                shape.parameters,
            ),
        ] {
            if given != expected {
                let value = given as f64;
                return Err(IntegrationError::InvalidArgument { what, value });
            }
        }
        self.order = order;
        self.expansion.prepare(equations.series, self.order);
        self.dense.prepare(x.len(), self.order + 1);
        self.inputs.clear();
        self.inputs.resize(shape.inputs, Cubic::default());
        for vector in [
            &mut self.x,
            &mut self.x_new,
            &mut self.rates,
            &mut self.rates_new,
            &mut self.slopes,
        ] {
            vector.clear();
            vector.extend_from_slice(x);
        }
        Ok(())
    }

    /// Steps from stop to stop. `x` becomes the state at the end.
    fn run<O: Observer>(
        &mut self,
        equations: &Expanded<'_>,
        t_start: f64,
        x: &mut [f64],
        options: &Options,
        watcher: &mut Watcher<'_, '_, O>,
        statistics: &mut Statistics,
    ) -> End {
        let mut t = t_start;
        let mut first_step = options.first_step;
        self.slivers = 0;
        self.x_new.copy_from_slice(x);
        self.start(equations, t, statistics);
        while t < watcher.stops.end() {
            if let Some(component) = not_finite(&self.rates_new) {
                return End::failed(t, Cause::NonFinite { component });
            }
            let taken = statistics.steps + statistics.rejected;
            if taken >= options.max_steps {
                return End::failed(t, Cause::TooManySteps { steps: taken });
            }
            self.advance(equations, t);
            let longest = match self.longest(options) {
                Ok(longest) => longest.min(options.max_step),
                Err(cause) => return End::failed(t, cause),
            };
            let h = first_step.take().map_or(longest, |h| h.min(longest));
            let t_new = match self.step(equations, t, h, options, watcher, statistics) {
                Ok(t_new) => t_new,
                Err(cause) => return End::failed(t, cause),
            };
            let ends = Ends {
                t: [t, t_new],
                x: [&self.x, &self.x_new],
                rates: [&self.rates, &self.rates_new],
            };
            let interior = watcher.wants_interior(&ends).then_some(&self.dense);
            if let Some(end) = watcher.accept(&ends, interior, x) {
                return end;
            }
            t = t_new;
            if self.restart && t < watcher.stops.end() {
                self.start(equations, t, statistics);
            }
        }
        End::finished(t)
    }

    /// A step from `t` of length `h` or less, as far as the polynomial and the equations agree; tells where it ends.
    fn step<O: Observer>(
        &mut self,
        equations: &Expanded<'_>,
        t: f64,
        mut h: f64,
        options: &Options,
        watcher: &mut Watcher<'_, '_, O>,
        statistics: &mut Statistics,
    ) -> Result<f64, Cause> {
        let guards = &equations.series.shape().guards;
        loop {
            if t + 0.1 * h <= t || self.slivers > MOST_SLIVERS {
                return Err(Cause::StepTooSmall { h });
            }
            let stride = watcher.stops.stride(t, h);
            let change = first_change(guards, &self.expansion.guards, stride.up_to_stop(t));
            let (end, last) = match change {
                Some(change) => (t + change.before, t + change.before),
                None => (stride.t_new, stride.last),
            };
            let ends = Ends {
                t: [t, end],
                x: [&self.x, &self.x],
                rates: [&self.rates, &self.rates],
            };
            if let Some(shorter) = watcher.stops.shorter_series(&ends, &self.dense) {
                h = shorter;
                continue;
            }
            if self.attempt(equations, [t, end], last, options, watcher, statistics) {
                statistics.steps += 1;
                let end = match change {
                    Some(change) => self.cross(equations, t, stride, change, watcher, statistics),
                    None => end,
                };
                self.restart = change.is_none() && stride.lands;
                let is_sliver = end - t <= SLIVER * t.abs().max(1.0);
                self.slivers = if is_sliver { self.slivers + 1 } else { 0 };
                return Ok(end);
            }
            statistics.rejected += 1;
            h = SHORTER * (end - t);
        }
    }

    /// Beyond a change of an answer by as little as shows in the equations themselves.
    fn cross<O: Observer>(
        &mut self,
        equations: &Expanded<'_>,
        t: f64,
        stride: Stride,
        change: Change,
        watcher: &mut Watcher<'_, '_, O>,
        statistics: &mut Statistics,
    ) -> f64 {
        let guard = equations.series.shape().guards[change.guard];
        let old = guard.answer(self.expansion.guards[change.guard]);
        let mut is_new = |end: f64| {
            self.dense.state(end, &mut self.x_new);
            // Where this fails, the next step does.
            watcher.project(end, &mut self.x_new);
            self.start(equations, end, statistics);
            guard.answer(self.expansion.guards_new[change.guard]) != old
        };
        passed(&mut is_new, t, stride, change)
    }

    /// The new state and its rates become the start of a step, and are expanded.
    fn advance(&mut self, equations: &Expanded<'_>, t: f64) {
        let n = self.x.len();
        self.x.copy_from_slice(&self.x_new);
        self.rates.copy_from_slice(&self.rates_new);
        let coefficients = self.dense.taylor(t);
        coefficients[..n].copy_from_slice(&self.x);
        coefficients[n..2 * n].copy_from_slice(&self.rates);
        self.expansion
            .expand(equations.series, &self.inputs, coefficients, n, self.order);
    }

    /// Order zero at a time and the new state.
    fn start(&mut self, equations: &Expanded<'_>, t: f64, statistics: &mut Statistics) {
        statistics.evaluations += 1;
        (equations.inputs)(t, &self.x_new, &mut self.inputs);
        self.expansion.start(
            equations.series,
            t,
            &self.x_new,
            &self.inputs,
            equations.parameters,
            &mut self.rates_new,
        );
    }

    /// The step at which the last two terms are as large as the tolerances allow.
    fn longest(&self, options: &Options) -> Result<f64, Cause> {
        let n = self.x.len();
        let mut longest = f64::INFINITY;
        for k in [self.order - 1, self.order] {
            let (mut size, terms) = (0.0, self.dense.all_of_order(k));
            for component in 0..n {
                let term = terms[component].abs();
                if !term.is_finite() {
                    return Err(Cause::NotAnalytic { component });
                }
                size = f64::max(size, term / options.scale(self.x[component].abs()));
            }
            let [length] = power_of_all(&[LAST_TERM / size], 1.0 / k as f64);
            longest = longest.min(length);
        }
        Ok(longest)
    }

    /// The state and the rates at the end of a step, these at the time `last`; false where they contradict the
    /// polynomial.
    fn attempt<O: Observer>(
        &mut self,
        equations: &Expanded<'_>,
        [t, end]: [f64; 2],
        last: f64,
        options: &Options,
        watcher: &mut Watcher<'_, '_, O>,
        statistics: &mut Statistics,
    ) -> bool {
        self.dense.state(end, &mut self.x_new);
        if !watcher.project(end, &mut self.x_new) || not_finite(&self.x_new).is_some() {
            return false;
        }
        self.start(equations, last, statistics);
        self.dense.taylor_slopes(end, &mut self.slopes);
        // The first term that is left out makes a defect of its order over the step.
        let (h, part) = (end - t, (end - t) / (self.order as f64 + 1.0));
        (0..self.x.len()).all(|i| {
            let size = self.x[i].abs().max(self.x_new[i].abs());
            let rounding = ROUNDING * (size + h * self.rates_new[i].abs());
            let off = part * (self.rates_new[i] - self.slopes[i]).abs();
            off <= options.scale(size).max(rounding)
        })
    }
}

/// The order of the expansions. With ε = e⁻ᴸ a step of order L/2 is the longest for its cost where this grows with the
/// square of the order (Jorba and Zou), and one of order L where it grows with the order. Sums over products are
/// cheap here, and a start is not: the truth lies between.
fn order(options: &Options) -> usize {
    let tolerances = [options.rtol, options.atol].map(|tolerance| tolerance.max(LEAST_TOLERANCE));
    let tolerance = tolerances[0].min(tolerances[1]);
    let wanted = (1.0 - 0.7 * tolerance.ln()).ceil();
    // A small number, limited on both sides.
    let orders = (LEAST_ORDER..MOST_ORDER).take_while(|&order| (order as f64) < wanted);
    orders.last().map_or(LEAST_ORDER, |order| order + 1)
}

/// The first time at which the equations themselves give another answer than before a change that a polynomial shows in
/// a step from `t`; the end of the step, or a time not far beyond, where they never do. It is evaluated last.
fn passed(mut is_new: impl FnMut(f64) -> bool, t: f64, stride: Stride, change: Change) -> f64 {
    let (first, mut beyond) = ((t + change.after).max(t.next_up()), 0.0);
    let mut same = t + change.before;
    loop {
        let end = (first + beyond).min(stride.t_new);
        if is_new(end) {
            if beyond == 0.0 {
                return end;
            }
            // The polynomial was early.
            let [_, end] = neighbours(&mut is_new, [same, end]);
            is_new(end);
            return end;
        }
        if end >= stride.t_new || beyond > FARTHEST * stride.h {
            return end;
        }
        same = end;
        beyond = next_beyond(beyond, first);
    }
}

/// How far beyond the first time of another answer the next try is.
fn next_beyond(beyond: f64, first: f64) -> f64 {
    f64::max(2.0 * beyond, first.next_up() - first)
}

fn not_finite(values: &[f64]) -> Option<usize> {
    values.iter().position(|value| !value.is_finite())
}
