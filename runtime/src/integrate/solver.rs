//! The step loop of the embedded pairs.

use super::dense_output::DenseOutput;
use super::error::IntegrationError;
use super::pairs::EmbeddedPair;
use super::step_size::{StepSize, first_guess, first_step, norm};
use super::tableau::Stages;
use super::watch::{Ending, Observer, Step, Watch, Watcher};
use super::{Options, Outcome, Segments, Statistics};
use std::marker::PhantomData;

/// An adaptive integrator with its work arrays.
///
/// The arrays are sized at the first use and kept, so that repeated integrations of the same size
/// allocate nothing but switching times, events found and errors.
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
    /// `f(t, x, rates)` writes ẋ. `x` holds the initial state and leaves with the last one, also
    /// after an error. `watch` names switching times, ranges and events, `observer` sees the
    /// accepted steps. To integrate backward, substitute t = −s.
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
        self.stages.prepare(x, P::ALL_STAGES);
        self.dense.prepare(x.len(), P::INTERIOR_COEFFICIENTS);
        self.scale.resize(x.len(), 0.0);
        let segments = Segments::new(span, watch.switching_times);
        let mut watcher = Watcher::start(watch, observer, span[0], x)?;
        let mut statistics = Statistics::default();
        let result = self.run(
            &mut f,
            span[0],
            segments,
            options,
            &mut watcher,
            &mut statistics,
        );
        match result {
            Ok((ending, t)) => {
                let end = if ending == Ending::Finished {
                    self.stages.x()
                } else {
                    watcher.x_end()
                };
                x.copy_from_slice(end);
                Ok(Outcome {
                    ending,
                    t,
                    hits: watcher.hits,
                    statistics,
                })
            }
            Err(error) => {
                x.copy_from_slice(error.state());
                Err(error)
            }
        }
    }

    fn run<F, O>(
        &mut self,
        f: &mut F,
        t_start: f64,
        segments: Segments,
        options: &Options,
        watcher: &mut Watcher<'_, '_, O>,
        statistics: &mut Statistics,
    ) -> Result<(Ending, f64), IntegrationError>
    where
        F: FnMut(f64, &[f64], &mut [f64]),
        O: Observer,
    {
        let new_rates = P::TABLEAU.new_rates();
        let mut step_size = StepSize::new(P::CONTROL);
        let mut t = t_start;
        let mut h = None;
        for segment in segments {
            // Up to a switching time the rates are those before it.
            let mut f = |t: f64, x: &[f64], rates: &mut [f64]| f(t.min(segment.last), x, rates);

            self.stages.evaluate_at_start(&mut f, 0, t);
            statistics.evaluations += 1;
            if let Some(component) = self
                .stages
                .rates(0)
                .iter()
                .position(|rate| !rate.is_finite())
            {
                return Err(self.not_finite(t, component));
            }
            let mut next_h = match h {
                Some(h) => h,
                None => self.first_step(&mut f, t, segment.end - t, options, statistics),
            };

            while t < segment.end {
                if statistics.steps + statistics.rejected >= options.max_steps {
                    let steps = statistics.steps + statistics.rejected;
                    return Err(IntegrationError::TooManySteps {
                        t,
                        steps,
                        state: self.state(),
                    });
                }

                // The step ends at the segment's end rather than a sliver before it.
                let lands = t + 1.01 * next_h >= segment.end;
                let step = if lands { segment.end - t } else { next_h };
                let t_new = if lands { segment.end } else { t + step };

                self.stages.step(&mut f, &P::TABLEAU, t, step);
                statistics.evaluations += P::TABLEAU.rows.len();
                if P::ERROR_USES_NEW_RATES {
                    self.stages.evaluate_at_end(&mut f, new_rates, t_new);
                    statistics.evaluations += 1;
                }
                self.set_scale(options);
                let error = P::error(&self.stages, step, &self.scale);

                if error <= 1.0 && self.stages.x_new().iter().all(|x| x.is_finite()) {
                    statistics.steps += 1;
                    if !P::ERROR_USES_NEW_RATES {
                        self.stages.evaluate_at_end(&mut f, new_rates, t_new);
                        statistics.evaluations += 1;
                    }
                    if let Some(end) = self.accept(&mut f, t, t_new, watcher, statistics)? {
                        return Ok(end);
                    }
                    self.stages.advance(new_rates);
                    t = t_new;
                    let suggested = step * step_size.accepted(error);
                    // A step cut short to land says nothing against the longer one.
                    let suggested = if lands {
                        suggested.max(next_h)
                    } else {
                        suggested
                    };
                    next_h = suggested.min(options.max_step);
                } else {
                    statistics.rejected += 1;
                    next_h = step * step_size.rejected(error);
                    if t + 0.1 * next_h.abs() <= t {
                        return Err(self.stuck(t, next_h, error, new_rates));
                    }
                }
            }
            h = Some(next_h);
        }
        Ok((Ending::Finished, t))
    }

    /// Interpolates if anyone asks for it and shows the step to the watcher.
    fn accept<F, O>(
        &mut self,
        f: &mut F,
        t: f64,
        t_new: f64,
        watcher: &mut Watcher<'_, '_, O>,
        statistics: &mut Statistics,
    ) -> Result<Option<(Ending, f64)>, IntegrationError>
    where
        F: FnMut(f64, &[f64], &mut [f64]),
        O: Observer,
    {
        let wanted = watcher.wants_interior(t, t_new, self.stages.x_new());
        if wanted {
            let h = t_new - t;
            let states = [self.stages.x(), self.stages.x_new()];
            let rates = [
                self.stages.rates(0),
                self.stages.rates(P::TABLEAU.new_rates()),
            ];
            self.dense.set_hermite(t, h, states, rates);
            statistics.evaluations += P::interior(f, t, h, &mut self.stages, &mut self.dense);
        }
        watcher.accept(&Step {
            t_old: t,
            t: t_new,
            x_old: self.stages.x(),
            x: self.stages.x_new(),
            interior: wanted.then_some(&self.dense),
        })
    }

    /// A first step from the sizes of x, ẋ and ẍ, within the segment.
    fn first_step<F>(
        &mut self,
        f: &mut F,
        t: f64,
        length: f64,
        options: &Options,
        statistics: &mut Statistics,
    ) -> f64
    where
        F: FnMut(f64, &[f64], &mut [f64]),
    {
        let largest = options.max_step.min(length);
        if let Some(h) = options.first_step {
            return h.min(largest);
        }
        for (scale, x) in self.scale.iter_mut().zip(self.stages.x()) {
            *scale = options.scale(x.abs());
        }
        let x_norm = norm(self.stages.x().iter().copied(), &self.scale);
        let rates_norm = norm(self.stages.rates(0).iter().copied(), &self.scale);
        let guess = first_guess(x_norm, rates_norm).min(largest);
        self.stages.euler_step(guess);
        self.stages.evaluate_at_end(f, 1, t + guess);
        statistics.evaluations += 1;
        let (start, end) = (self.stages.rates(0), self.stages.rates(1));
        let change = start.iter().zip(end).map(|(start, end)| end - start);
        let second_norm = norm(change, &self.scale) / guess;
        first_step(guess, rates_norm, second_norm, P::ORDER).min(largest)
    }

    fn set_scale(&mut self, options: &Options) {
        let (x, x_new) = (self.stages.x(), self.stages.x_new());
        for (scale, (x, x_new)) in self.scale.iter_mut().zip(x.iter().zip(x_new)) {
            *scale = options.scale(x.abs().max(x_new.abs()));
        }
    }

    /// Why no step from `t` on is accepted.
    fn stuck(&self, t: f64, h: f64, error: f64, new_rates: usize) -> IntegrationError {
        let mut stages = 1..new_rates;
        let component = stages.find_map(|stage| self.stages.first_not_finite(stage));
        match component.filter(|_| !error.is_finite()) {
            Some(component) => self.not_finite(t, component),
            None => IntegrationError::StepTooSmall {
                t,
                h,
                state: self.state(),
            },
        }
    }

    fn not_finite(&self, t: f64, component: usize) -> IntegrationError {
        IntegrationError::NonFinite {
            t,
            state: self.state(),
            component,
        }
    }

    fn state(&self) -> Vec<f64> {
        self.stages.x().to_vec()
    }
}
