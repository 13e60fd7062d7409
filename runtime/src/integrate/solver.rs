//! The step loop of the embedded pairs.

use super::dense_output::{DenseOutput, HERMITE};
use super::error::{Cause, IntegrationError};
use super::options::Options;
use super::outcome::{Outcome, Statistics};
use super::pairs::EmbeddedPair;
use super::step_size::{StepSize, first_guess, first_step, next_after_rejection, norm, powers};
use super::stops::{Stop, Stride};
use super::tableau::Stages;
use super::watch::{End, Observer, Watch, Watcher};
use std::marker::PhantomData;

/// An adaptive integrator with its work arrays.
///
/// The arrays are allocated at the first use, so that repeated integrations of the same size allocate only switching
/// times, located events and errors.
///
/// An ensemble with a common step is one system: state i of member k at `x[members * i + k]`, with
/// rates computed in [`Lanes`](crate::Lanes). Its error is the root mean square over all members.
#[derive(Debug, Clone)]
pub struct Solver<P> {
    stages: Stages,
    dense: DenseOutput,
    scale: Vec<f64>,
    pair: PhantomData<P>,
}

impl<P> Default for Solver<P> {
    fn default() -> Self {
        Self {
            stages: Stages::default(),
            dense: DenseOutput::default(),
            scale: Vec::new(),
            pair: PhantomData,
        }
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
        self.stages.prepare(x, P::ALL_STAGES);
        self.dense.prepare(x.len(), P::INTERIOR_COEFFICIENTS);
        self.scale.resize(x.len(), 0.0);
        let mut watcher = Watcher::new(watch, observer, span).paced(span[0]);
        let (mut statistics, mut evaluations) = (Statistics::default(), 0);
        let mut counted = |t: f64, x: &[f64], rates: &mut [f64]| {
            evaluations += 1;
            f(t, x, rates);
        };
        let end = match watcher.start(span[0], x) {
            Ok(()) => {
                let f = &mut counted;
                self.run(f, span[0], x, options, &mut watcher, &mut statistics)
            }
            Err(cause) => End::failed(span[0], cause),
        };
        statistics.evaluations = evaluations;
        watcher.conclude(end, x, statistics)
    }

    /// Integrates from stop to stop. `x` becomes the final state.
    fn run<F, O>(
        &mut self,
        f: &mut F,
        t_start: f64,
        x: &mut [f64],
        options: &Options,
        watcher: &mut Watcher<'_, '_, O>,
        statistics: &mut Statistics,
    ) -> End
    where
        F: FnMut(f64, &[f64], &mut [f64]),
        O: Observer,
    {
        let mut step_size = StepSize::new(P::CONTROL);
        let (mut t, mut next_h, mut restart) = (t_start, None, true);
        let (mut longest, mut is_guess) = (f64::INFINITY, false);
        while t < watcher.stops.end() {
            if restart {
                self.stages.evaluate_at_start(f, 0, t);
                if let Some(component) = self.stages.rate_not_finite(0) {
                    return End::failed(t, Cause::NonFinite { component });
                }
            }
            let steps = statistics.steps + statistics.rejected;
            if steps >= options.max_steps {
                return End::failed(t, Cause::TooManySteps { steps });
            }
            let known = watcher.stops.known_after(t);
            is_guess |= next_h.is_none() && options.first_step.is_none();
            let h = next_h.unwrap_or_else(|| self.first_step(f, t, longest, known, options));
            let stride = watcher.stops.stride(t, h);
            // The old rates apply up to a switching time.
            let mut f = |t: f64, x: &[f64], rates: &mut [f64]| f(t.min(stride.last), x, rates);
            let error = self.attempt(&mut f, t, stride, options, watcher);
            if error <= 1.0 {
                match self.accept(&mut f, t, stride, watcher, x) {
                    Ok(end) => {
                        statistics.steps += 1;
                        if let Some(end) = end {
                            return end;
                        }
                    }
                    Err(shorter) => {
                        statistics.rejected += 1;
                        (next_h, restart) = (Some(shorter), false);
                        continue;
                    }
                }
                let switched = watcher.switched();
                if switched.is_some() {
                    self.stages.x_new_mut().copy_from_slice(x);
                }
                self.stages.advance(P::TABLEAU.new_rates());
                let [power] = powers(P::CONTROL, &[error]);
                let suggested = stride.h * step_size.accepted(error, power);
                // A step shortened to end at a stop is no reason to propose a shorter one.
                let suggested = if stride.lands || switched.is_some() {
                    suggested.max(h)
                } else {
                    suggested
                };
                next_h = Some(suggested.min(options.max_step));
                is_guess = false;
                (t, restart) = switched.map_or((stride.t_new, stride.lands), |t| (t, true));
            } else {
                statistics.rejected += 1;
                let [power] = powers(P::CONTROL, &[error]);
                let shorter = stride.h * step_size.rejected(error, power);
                if t + 0.1 * shorter <= t {
                    return End::failed(t, self.stuck(shorter, error));
                }
                (next_h, longest) = next_after_rejection(restart && !is_guess, shorter);
                restart = false;
            }
        }
        End::finished(t)
    }

    /// All stages of a step; returns the weighted error, NaN if the new state is not finite.
    fn attempt<F, O>(
        &mut self,
        f: &mut F,
        t: f64,
        stride: Stride,
        options: &Options,
        watcher: &mut Watcher<'_, '_, O>,
    ) -> f64
    where
        F: FnMut(f64, &[f64], &mut [f64]),
        O: Observer,
    {
        self.stages.step(f, &P::TABLEAU, t, stride.h);
        if !watcher.project(stride.t_new, self.stages.x_new_mut()) {
            return f64::NAN;
        }
        if P::ERROR_USES_NEW_RATES {
            self.stages
                .evaluate_at_end(f, P::TABLEAU.new_rates(), stride.t_new);
        }
        if self.stages.state_not_finite().is_some() {
            return f64::NAN;
        }
        let (x, x_new) = (self.stages.x(), self.stages.x_new());
        for (scale, (x, x_new)) in self.scale.iter_mut().zip(x.iter().zip(x_new)) {
            *scale = options.scale(x.abs().max(x_new.abs()));
        }
        let mean_square = |row| [self.stages.mean_square(row, &self.scale)];
        let [error] = P::errors(mean_square, &[stride.h]);
        error
    }

    /// Computes dense output if needed and passes the step to the watcher, or returns a shorter step to be tried.
    fn accept<F, O>(
        &mut self,
        f: &mut F,
        t: f64,
        stride: Stride,
        watcher: &mut Watcher<'_, '_, O>,
        x: &mut [f64],
    ) -> Result<Option<End>, f64>
    where
        F: FnMut(f64, &[f64], &mut [f64]),
        O: Observer,
    {
        let (new_rates, span) = (P::TABLEAU.new_rates(), [t, stride.t_new]);
        if !P::ERROR_USES_NEW_RATES {
            self.stages.evaluate_at_end(f, new_rates, stride.t_new);
        }
        let ends = self.stages.ends(span, new_rates);
        if let Some(shorter) = watcher.too_long(&ends) {
            return Err(shorter);
        }
        if !watcher.wants_interior(&ends) {
            return Ok(watcher.accept(&ends, None, x));
        }
        self.dense.set_hermite(&ends);
        for (i, &(node, row)) in P::INTERIOR_STAGES.iter().enumerate() {
            let (stage, t) = (new_rates + 1 + i, t + node * stride.h);
            self.stages.evaluate(f, stage, t, stride.h, row);
        }
        for (c, &row) in P::INTERIOR.iter().enumerate() {
            let coefficient = self.dense.coefficient(HERMITE + c);
            self.stages.combination(stride.h, row, coefficient);
        }
        let ends = self.stages.ends(span, new_rates);
        match watcher.shorter(&ends, &self.dense) {
            Some(shorter) => Err(shorter),
            None => Ok(watcher.accept(&ends, Some(&self.dense), x)),
        }
    }

    /// A first step from the norms of x, ẋ and ẍ, limited by the next stop and `longest`.
    fn first_step<F>(
        &mut self,
        f: &mut F,
        t: f64,
        longest: f64,
        stop: Stop,
        options: &Options,
    ) -> f64
    where
        F: FnMut(f64, &[f64], &mut [f64]),
    {
        let longest = options.max_step.min(stop.t - t).min(longest);
        if let Some(h) = options.first_step {
            return h.min(longest);
        }
        for (scale, x) in self.scale.iter_mut().zip(self.stages.x()) {
            *scale = options.scale(x.abs());
        }
        let x_norm = norm(self.stages.x().iter().copied(), &self.scale);
        let rates_norm = norm(self.stages.rates(0).iter().copied(), &self.scale);
        let guess = first_guess(x_norm, rates_norm).min(longest);
        self.stages.euler_step(guess);
        self.stages
            .evaluate_at_end(f, 1, (t + guess).min(stop.last));
        let (start, end) = (self.stages.rates(0), self.stages.rates(1));
        let change = start.iter().zip(end).map(|(start, end)| end - start);
        let second_norm = norm(change, &self.scale) / guess;
        first_step(guess, rates_norm, second_norm, P::ORDER).min(longest)
    }

    /// The cause of failure if no step is accepted.
    fn stuck(&self, h: f64, error: f64) -> Cause {
        let mut stages = 1..P::TABLEAU.new_rates();
        let not_finite = stages
            .find_map(|stage| self.stages.rate_not_finite(stage))
            .or_else(|| self.stages.state_not_finite());
        match not_finite.filter(|_| !error.is_finite()) {
            Some(component) => Cause::NonFinite { component },
            None => Cause::StepTooSmall { h },
        }
    }
}
