//! The classical Runge–Kutta method with a fixed step.

use super::block_stages::{BlockStages, Places};
use super::dense_output::DenseOutput;
use super::error::{Cause, IntegrationError};
use super::options::check_span;
use super::outcome::{Outcome, Statistics};
use super::stops::Stride;
use super::tableau::Tableau;
use super::watch::{End, Observer, Watch, Watcher};

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
    stages: BlockStages<1>,
    dense: DenseOutput,
}

impl Rk4 {
    /// A solver for systems of any size.
    pub fn new() -> Self {
        Self::default()
    }

    /// Integrates ẋ = f(t, x) over `span` with steps of `step` seconds.
    ///
    /// Each interval between switching times is divided into equal steps no longer than `step`.
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
        watch.check(x.len())?;
        if step.is_nan() || step <= 0.0 {
            return Err(IntegrationError::InvalidArgument {
                what: "step",
                value: step,
            });
        }
        self.stages.prepare(x.len(), TABLEAU.new_rates() + 1);
        self.stages.begin(0, x, &[]);
        self.dense.prepare(x.len(), 4);
        let mut watcher = Watcher::new(watch, observer, span).paced(span[0]);
        let mut statistics = Statistics::default();
        let mut counted = |at: Places<'_, 1>, rates: &mut [[f64; 1]]| {
            statistics.evaluations += 1;
            f(at.t[0], at.x.as_flattened(), rates.as_flattened_mut());
        };
        let end = match watcher.start(span[0], x) {
            Ok(()) => self.run(
                &mut counted,
                span[0],
                x,
                step,
                &mut watcher,
                &mut statistics.steps,
            ),
            Err(cause) => End::failed(span[0], cause),
        };
        watcher.conclude(end, x, statistics)
    }

    fn run<F, O>(
        &mut self,
        f: &mut F,
        t_start: f64,
        x: &mut [f64],
        step: f64,
        watcher: &mut Watcher<'_, '_, O>,
        steps: &mut usize,
    ) -> End
    where
        F: FnMut(Places<'_, 1>, &mut [[f64; 1]]),
        O: Observer,
    {
        let new_rates = TABLEAU.new_rates();
        let (mut t, mut h, mut restart) = (t_start, step, true);
        while t < watcher.stops.end() {
            if restart {
                self.stages.evaluate_at_start(f, 0, &[t]);
                h = equal_part(watcher.stops.known_after(t).t - t, step);
            }
            let mut stride = watcher.stops.stride(t, h);
            let mut tries = 0;
            loop {
                if let Err(cause) = self.attempt(f, t, stride, watcher) {
                    return End::failed(t, cause);
                }
                let ends = self.stages.ends([t, stride.t_new], new_rates);
                if let Some(shorter) = watcher.too_long(&ends) {
                    stride = Stride::to(t, t + shorter);
                    continue;
                }
                // Without an error estimate, steps are shortened towards a switch until it is reached.
                if !watcher.stops.has_crossings() {
                    break;
                }
                let ends = self.stages.ends([t, stride.t_new], new_rates);
                self.dense.set_hermite(&ends);
                match watcher.switch_within(&ends, &self.dense) {
                    Some(switch) if switch - t > AT_ONCE * h && tries < MOST_TRIES => {
                        stride = Stride::to(t, t + NEARLY * (switch - t));
                    }
                    _ => break,
                }
                tries += 1;
            }
            *steps += 1;
            let ends = self.stages.ends([t, stride.t_new], new_rates);
            let wanted = watcher.wants_interior(&ends);
            if wanted {
                self.dense.set_hermite(&ends);
            }
            if let Some(end) = watcher.accept(&ends, wanted.then_some(&self.dense), x) {
                return end;
            }
            let switched = watcher.switched();
            if switched.is_some() {
                self.stages.new_state_mut().copy_from_slice(x);
            }
            self.stages.advance([true], new_rates);
            (t, restart) = switched.map_or((stride.t_new, stride.lands), |t| (t, true));
        }
        End::finished(t)
    }

    /// A step and the rates at its end.
    fn attempt<F, O>(
        &mut self,
        f: &mut F,
        t: f64,
        stride: Stride,
        watcher: &mut Watcher<'_, '_, O>,
    ) -> Result<(), Cause>
    where
        F: FnMut(Places<'_, 1>, &mut [[f64; 1]]),
        O: Observer,
    {
        let new_rates = TABLEAU.new_rates();
        let time = |t: f64| [t.min(stride.last)];
        self.stages
            .step(f, &TABLEAU, &[stride.h], |node| time(t + node * stride.h));
        let projected = watcher.project(stride.t_new, self.stages.new_state_mut());
        self.stages
            .evaluate_at_end(f, new_rates, &time(stride.t_new));
        if !projected {
            return Err(Cause::Inconsistent);
        }
        let not_finite = self.stages.rate_not_finite(0, new_rates);
        match not_finite.or_else(|| self.stages.state_not_finite(0)) {
            Some(component) => Err(Cause::NonFinite { component }),
            None => Ok(()),
        }
    }
}

/// Attempts to end a step before a switch.
const MOST_TRIES: usize = 12;
/// Fraction of the distance to a switch at which a step ends, and the distance below which it may pass the switch.
const NEARLY: f64 = 0.999;
const AT_ONCE: f64 = 1e-9;

/// The longest step that is at most `step` and divides `length`.
fn equal_part(length: f64, step: f64) -> f64 {
    // Lengths that fit up to rounding are accepted.
    let count = (length / step * (1.0 - 1e-12)).ceil();
    length / count.max(1.0)
}
