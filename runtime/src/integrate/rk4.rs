//! The classical Runge–Kutta method with a fixed step.

use super::dense_output::DenseOutput;
use super::error::IntegrationError;
use super::tableau::{Stages, Tableau};
use super::watch::{Ending, Observer, Step, Watch, Watcher};
use super::{Outcome, Segments, Statistics, check_span};

/// Hairer, Nørsett and Wanner, table II.1.2.
const TABLEAU: Tableau = Tableau {
    nodes: &[0.5, 0.5, 1.0],
    rows: &[&[(0, 0.5)], &[(1, 0.5)], &[(2, 1.0)]],
    weights: &[
        (0, 1.0 / 6.0),
        (1, 1.0 / 3.0),
        (2, 1.0 / 3.0),
        (3, 1.0 / 6.0),
    ],
};

/// Order 4 with a fixed step, without an estimate of the error. Its interpolant is the cubic
/// Hermite polynomial.
#[derive(Debug, Clone, Default)]
pub struct Rk4 {
    stages: Stages,
    dense: DenseOutput,
}

impl Rk4 {
    /// A solver for systems of any size.
    pub fn new() -> Self {
        Self::default()
    }

    /// Integrates ẋ = f(t, x) over `span` with steps of `step` seconds.
    ///
    /// Each stretch between switching times is divided into equal steps no longer than `step`.
    /// The arguments are those of [`Solver::integrate`](super::Solver::integrate).
    pub fn integrate<F, O>(
        &mut self,
        mut f: F,
        span: [f64; 2],
        x: &mut [f64],
        step: f64,
        watch: &mut Watch<'_>,
        observer: &mut O,
    ) -> Result<Outcome, IntegrationError>
    where
        F: FnMut(f64, &[f64], &mut [f64]),
        O: Observer,
    {
        check_span(span)?;
        if step.is_nan() || step <= 0.0 {
            return Err(IntegrationError::InvalidArgument {
                what: "step",
                value: step,
            });
        }
        self.stages.prepare(x, TABLEAU.new_rates() + 1);
        self.dense.prepare(x.len(), 4);
        let segments = Segments::new(span, watch.switching_times);
        let mut watcher = Watcher::start(watch, observer, span[0], x)?;
        let mut statistics = Statistics::default();
        match self.run(
            &mut f,
            span[0],
            segments,
            step,
            &mut watcher,
            &mut statistics,
        ) {
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
        step: f64,
        watcher: &mut Watcher<'_, '_, O>,
        statistics: &mut Statistics,
    ) -> Result<(Ending, f64), IntegrationError>
    where
        F: FnMut(f64, &[f64], &mut [f64]),
        O: Observer,
    {
        let new_rates = TABLEAU.new_rates();
        let mut t = t_start;
        for segment in segments {
            let mut f = |t: f64, x: &[f64], rates: &mut [f64]| f(t.min(segment.last), x, rates);
            let start = t;
            // A step that fits all but rounding fits.
            let count = ((segment.end - start) / step * (1.0 - 1e-12))
                .ceil()
                .max(1.0);
            let h = (segment.end - start) / count;
            self.stages.evaluate_at_start(&mut f, 0, t);
            statistics.evaluations += 1;
            let mut done = 0.0;
            while done < count {
                done += 1.0;
                let t_new = if done < count {
                    start + done * h
                } else {
                    segment.end
                };
                self.stages.step(&mut f, &TABLEAU, t, h);
                self.stages.evaluate_at_end(&mut f, new_rates, t_new);
                statistics.evaluations += TABLEAU.new_rates();
                if let Some(component) = self.stages.first_not_finite(new_rates) {
                    let state = self.stages.x().to_vec();
                    return Err(IntegrationError::NonFinite {
                        t,
                        state,
                        component,
                    });
                }
                statistics.steps += 1;
                let (x_old, x) = (self.stages.x(), self.stages.x_new());
                let rates = [self.stages.rates(0), self.stages.rates(new_rates)];
                let wanted = watcher.wants_interior(t, t_new, x);
                if wanted {
                    self.dense.set_hermite(t, t_new - t, [x_old, x], rates);
                }
                let interior = wanted.then_some(&self.dense);
                let end = watcher.accept(&Step {
                    t_old: t,
                    t: t_new,
                    x_old,
                    x,
                    interior,
                })?;
                if let Some(end) = end {
                    return Ok(end);
                }
                self.stages.advance(new_rates);
                t = t_new;
            }
        }
        Ok((Ending::Finished, t))
    }
}
