//! Integration by Taylor series of many motions, eight at a time.

// What is not inlined is not compiled for the vectors of the processor.
#![allow(clippy::inline_always)]

use super::block_expansion::BlockExpansion;
use super::guards::{Change, first_change};
use super::{LAST_TERM, MOST_SLIVERS, ROUNDING, SHORTER, SLIVER, not_finite, order, passed};
use crate::integrate::block_lanes::{
    self, BlockMotion, all, gather, idle_lanes, on_their_way, refill, scatter,
};
use crate::integrate::block_stages::Block;
use crate::integrate::dense_output::{DenseOutput, Ends};
use crate::integrate::error::{Cause, IntegrationError};
use crate::integrate::options::Options;
use crate::integrate::outcome::Outcome;
use crate::integrate::step_size::power_of_all;
use crate::integrate::stops::Stride;
use crate::integrate::watch::Observer;
use crate::lanes::{LANES, dispatch};
use crate::series::{Cubic, SeriesInLanes};

/// An integrator by Taylor series for many motions of one system, with its work arrays. Each is, bit for bit, the
/// motion that [`Taylor`](super::Taylor) gives, whichever others are beside it.
#[derive(Debug, Clone, Default)]
pub struct BlockTaylor {
    expansion: BlockExpansion,
    slopes: Vec<Block>,
    dense: DenseOutput,
    /// States and rates of one motion at both ends of a step.
    ends: [Vec<f64>; 4],
    /// Guards and inputs of one motion.
    guards: Vec<f64>,
    inputs: Vec<Cubic>,
}

/// Equations of many motions, with what drives them.
pub struct ExpandedTogether<'a> {
    /// The equations.
    pub series: &'a dyn SeriesInLanes,
    /// Writes the inputs of a motion, by its number, as functions of the time since a given one in s, where its state is
    /// as given. They hold up to the next switching time. Without it all inputs are zero.
    pub inputs: Option<&'a MotionInputs<'a>>,
}

/// Inputs of a motion from a time in s and a state on.
pub type MotionInputs<'a> = dyn Fn(usize, f64, &[f64], &mut [Cubic]) + 'a;

impl std::fmt::Debug for ExpandedTogether<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("ExpandedTogether")
            .field("shape", self.series.shape())
            .finish_non_exhaustive()
    }
}

/// What a motion remembers of its steps.
struct Steps {
    /// The step to be tried; as long as the expansion allows where it is not known.
    h: Option<f64>,
    first_step: Option<f64>,
    change: Option<Change>,
    /// Where the step ends, and the latest time at which rates are evaluated.
    until: [f64; 2],
    /// Steps in a row that were too short to count.
    slivers: usize,
}

impl Steps {
    fn new(first_step: Option<f64>) -> Self {
        Self {
            h: None,
            first_step,
            change: None,
            until: [0.0; 2],
            slivers: 0,
        }
    }
}

type Lane<'m, 'a, O> = block_lanes::Lane<'m, 'a, O, Steps>;
type Lanes<'m, 'a, O> = block_lanes::Lanes<'m, 'a, O, Steps>;

impl BlockTaylor {
    /// An integrator for equations of any size.
    pub fn new() -> Self {
        Self::default()
    }

    /// Integrates each motion; returns how each ended. The other arguments are those of
    /// [`BlockSolver::integrate`](crate::integrate::BlockSolver::integrate).
    pub fn integrate<O: Observer>(
        &mut self,
        equations: &ExpandedTogether<'_>,
        motions: &mut [BlockMotion<'_, O>],
        options: &Options,
    ) -> Vec<Result<Outcome, IntegrationError>> {
        let shape = equations.series.shape();
        let refused = motions.iter().find_map(|motion| {
            let fits = [
                ("number of states", motion.x.len(), shape.states),
                (
                    "number of parameters",
                    motion.parameters.len(),
                    shape.parameters,
                ),
            ];
            let wrong = fits
                .into_iter()
                .find(|(_, given, expected)| given != expected);
            let wrong = wrong.map(|(what, given, _)| {
                let value = given as f64;
                IntegrationError::InvalidArgument { what, value }
            });
            let checked = options.check(motion.span);
            wrong.or(checked
                .and_then(|()| motion.watch.check(shape.states))
                .err())
        });
        if let Some(refused) = refused {
            return motions.iter().map(|_| Err(refused.clone())).collect();
        }
        self.prepare(equations, order(options));
        let mut results: Vec<_> = motions.iter().map(|_| None).collect();
        let mut waiting = motions.iter_mut().enumerate();
        let mut lanes: Lanes<'_, '_, O> = std::array::from_fn(|_| None);
        loop {
            let mut begin = |l: usize| {
                let (motion, of) = waiting.next()?;
                self.expansion.begin(l, &of.x, of.parameters);
                let mut lane = Lane::new(motion, of, Steps::new(options.first_step));
                // The guards of the series are the same functions.
                lane.watcher.stops.leave_crossings();
                Some(lane)
            };
            let Some(beside) = refill(&mut lanes, &mut begin, &mut results) else {
                break;
            };
            for l in idle_lanes(&lanes) {
                self.expansion.copy(beside, l);
            }
            self.start(equations, &mut lanes, options);
            self.expansion.expand(equations.series);
            self.choose(equations, &mut lanes, options);
            let valid = self.attempt(equations, &mut lanes, options);
            self.decide(equations, &mut lanes, valid);
        }
        all(results)
    }

    fn prepare(&mut self, equations: &ExpandedTogether<'_>, order: usize) {
        let shape = equations.series.shape();
        self.expansion.prepare(shape, order);
        self.slopes.clear();
        self.slopes.resize(shape.states, [0.0; LANES]);
        self.dense.prepare(shape.states, order + 1);
        for end in &mut self.ends {
            end.resize(shape.states, 0.0);
        }
        self.guards.clear();
        self.guards.resize(shape.guards.len() * (order + 1), 0.0);
        self.inputs.clear();
        self.inputs.resize(shape.inputs, Cubic::default());
    }

    /// Rates where motions begin or begin anew.
    fn start<O: Observer>(
        &mut self,
        equations: &ExpandedTogether<'_>,
        lanes: &mut Lanes<'_, '_, O>,
        options: &Options,
    ) {
        let mut restarts = [false; LANES];
        let mut t = [0.0; LANES];
        for (l, lane) in on_their_way(lanes) {
            (t[l], restarts[l]) = (lane.t, lane.restart);
        }
        if restarts.contains(&true) {
            self.expansion.new_states_where(restarts);
            for (l, lane) in on_their_way(lanes).filter(|&(l, _)| restarts[l]) {
                self.fill_inputs(equations, l, lane.motion, lane.t);
                lane.statistics.evaluations += 1;
                lane.restart = false;
            }
            self.expansion.evaluate(equations.series, &t);
            self.expansion.take_over(restarts);
        }
        for (l, lane) in on_their_way(lanes).filter(|(_, lane)| lane.steps.h.is_none()) {
            if let Some(component) = self.expansion.rate_not_finite(l) {
                lane.fail(Cause::NonFinite { component });
                continue;
            }
            let steps = lane.statistics.steps + lane.statistics.rejected;
            if steps >= options.max_steps {
                lane.fail(Cause::TooManySteps { steps });
            }
        }
    }

    /// Inputs of a motion at a time and its new state.
    fn fill_inputs(&mut self, equations: &ExpandedTogether<'_>, l: usize, motion: usize, t: f64) {
        if let Some(inputs) = equations.inputs {
            let x = &mut self.ends[1];
            gather(&self.expansion.x_new, l, x);
            inputs(motion, t, x, &mut self.inputs);
            self.expansion.set_inputs(l, &self.inputs);
        }
    }

    /// How far each step is tried: as far as the last two terms allow, up to the next stop or change.
    fn choose<O: Observer>(
        &mut self,
        equations: &ExpandedTogether<'_>,
        lanes: &mut Lanes<'_, '_, O>,
        options: &Options,
    ) {
        let longest = self.longest(options);
        let mut within = [0.0; LANES];
        let guards = &equations.series.shape().guards;
        for (l, lane) in on_their_way(lanes) {
            let h = match lane.steps.h {
                Some(h) => h,
                None if longest[l].is_nan() => {
                    let component = self.expansion.term_not_finite(l);
                    lane.fail(Cause::NotAnalytic { component });
                    continue;
                }
                None => {
                    let longest = longest[l].min(options.max_step);
                    lane.steps
                        .first_step
                        .take()
                        .map_or(longest, |h| h.min(longest))
                }
            };
            if lane.t + 0.1 * h <= lane.t || lane.steps.slivers > MOST_SLIVERS {
                lane.fail(Cause::StepTooSmall { h });
                continue;
            }
            lane.stride = lane.watcher.stops.stride(lane.t, h);
            within[l] = lane.stride.up_to_stop(lane.t);
        }
        let may_change = self.expansion.may_change(&within);
        for (l, lane) in on_their_way(lanes) {
            if may_change[l] {
                gather(&self.expansion.guards, l, &mut self.guards);
            }
            loop {
                let within = lane.stride.up_to_stop(lane.t);
                let change = may_change[l].then(|| first_change(guards, &self.guards, within));
                lane.steps.change = change.flatten();
                lane.steps.until = match lane.steps.change {
                    Some(change) => [lane.t + change.before; 2],
                    None => [lane.stride.t_new, lane.stride.last],
                };
                if !lane.watcher.stops.has_switches() {
                    break;
                }
                gather(self.expansion.coefficients(), l, self.dense.taylor(lane.t));
                let x = &mut self.ends[0];
                gather(&self.expansion.x, l, x);
                let ends = Ends {
                    t: [lane.t, lane.steps.until[0]],
                    x: [x, x],
                    rates: [x, x],
                };
                match lane.watcher.stops.shorter_series(&ends, &self.dense) {
                    Some(shorter) => lane.stride = Stride::to(lane.t, lane.t + shorter),
                    None => break,
                }
            }
        }
    }

    /// The steps at which the last two terms are as large as the tolerances allow; NaN where terms are not finite.
    fn longest(&self, options: &Options) -> Block {
        let mut longest = [f64::INFINITY; LANES];
        for k in self.expansion.last_orders() {
            let mut parts = [0.0; LANES];
            dispatch(
                #[inline(always)]
                || {
                    // The zero becomes NaN with any term that is not finite.
                    let (mut size, mut zero) = ([0.0_f64; LANES], [0.0; LANES]);
                    for (term, x) in self.expansion.terms(k).iter().zip(&self.expansion.x) {
                        for l in 0..LANES {
                            let term = term[l].abs();
                            zero[l] += term * 0.0;
                            size[l] = size[l].max(term / options.scale(x[l].abs()));
                        }
                    }
                    for l in 0..LANES {
                        parts[l] = LAST_TERM / size[l] + zero[l];
                    }
                },
            );
            let lengths = power_of_all(&parts, 1.0 / k as f64);
            for l in 0..LANES {
                let is_known = !(longest[l].is_nan() || lengths[l].is_nan());
                longest[l] = if is_known {
                    longest[l].min(lengths[l])
                } else {
                    f64::NAN
                };
            }
        }
        longest
    }

    /// The new states and their rates; tells where these agree with the polynomial.
    fn attempt<O: Observer>(
        &mut self,
        equations: &ExpandedTogether<'_>,
        lanes: &mut Lanes<'_, '_, O>,
        options: &Options,
    ) -> [bool; LANES] {
        let (mut since, mut last) = ([0.0; LANES], [0.0; LANES]);
        for (l, lane) in on_their_way(lanes) {
            (since[l], last[l]) = (lane.steps.until[0] - lane.t, lane.steps.until[1]);
        }
        self.expansion.polynomials(&since, &mut self.slopes);
        let mut valid = self.expansion.finite();
        for (l, lane) in on_their_way(lanes) {
            if lane.watcher.projects() {
                let x = &mut self.ends[0];
                gather(&self.expansion.x_new, l, x);
                valid[l] = lane.watcher.project(lane.steps.until[0], x) && not_finite(x).is_none();
                scatter(x, l, &mut self.expansion.x_new);
            }
            if valid[l] {
                lane.statistics.evaluations += 1;
                self.fill_inputs(equations, l, lane.motion, lane.steps.until[1]);
            }
        }
        self.expansion.evaluate(equations.series, &last);
        let order = self.expansion.order() as f64;
        dispatch(
            #[inline(always)]
            || {
                let (states, slopes) = (
                    self.expansion.x.iter().zip(&self.expansion.x_new),
                    &self.slopes,
                );
                for (((x, x_new), rate), slope) in states.zip(&self.expansion.rates_new).zip(slopes)
                {
                    for l in 0..LANES {
                        // The first term that is left out makes a defect of its order over the step.
                        let (h, part) = (since[l], since[l] / (order + 1.0));
                        let size = x[l].abs().max(x_new[l].abs());
                        let rounding = ROUNDING * (size + h * rate[l].abs());
                        let off = part * (rate[l] - slope[l]).abs();
                        valid[l] &= off <= options.scale(size).max(rounding);
                    }
                }
            },
        );
        valid
    }

    /// Shows steps to their watchers where equations and polynomial agree; shortens the others.
    fn decide<O: Observer>(
        &mut self,
        equations: &ExpandedTogether<'_>,
        lanes: &mut Lanes<'_, '_, O>,
        valid: [bool; LANES],
    ) {
        let (mut accepted, mut crossing) = ([false; LANES], [false; LANES]);
        for (l, lane) in on_their_way(lanes) {
            if !valid[l] {
                lane.statistics.rejected += 1;
                lane.steps.h = Some(SHORTER * (lane.steps.until[0] - lane.t));
                continue;
            }
            lane.steps.h = None;
            lane.statistics.steps += 1;
            crossing[l] = lane.steps.change.is_some();
            accepted[l] = !crossing[l];
            if accepted[l] {
                let end = lane.steps.until[0];
                self.accept(l, lane, end);
            }
        }
        self.expansion.take_over(accepted);
        for (l, lane) in on_their_way(lanes).filter(|&(l, _)| crossing[l]) {
            let Some(change) = lane.steps.change else {
                continue;
            };
            let end = self.cross(equations, l, lane, change);
            self.accept(l, lane, end);
            let mut alone = [false; LANES];
            alone[l] = true;
            self.expansion.take_over(alone);
        }
    }

    /// The step of a motion is done.
    fn accept<O: Observer>(&mut self, l: usize, lane: &mut Lane<'_, '_, O>, end: f64) {
        lane.restart = lane.steps.change.is_none() && lane.stride.lands;
        let is_sliver = end - lane.t <= SLIVER * lane.t.abs().max(1.0);
        lane.steps.slivers = if is_sliver { lane.steps.slivers + 1 } else { 0 };
        let [x, x_new, rates, rates_new] = &mut self.ends;
        gather(&self.expansion.x, l, x);
        gather(&self.expansion.x_new, l, x_new);
        gather(&self.expansion.rates, l, rates);
        gather(&self.expansion.rates_new, l, rates_new);
        let ends = Ends {
            t: [lane.t, end],
            x: [x, x_new],
            rates: [rates, rates_new],
        };
        let interior = if lane.watcher.wants_interior(&ends) {
            gather(self.expansion.coefficients(), l, self.dense.taylor(lane.t));
            Some(&self.dense)
        } else {
            None
        };
        lane.end = lane.watcher.accept(&ends, interior, lane.x);
        lane.t = end;
        lane.finish_at_end();
    }

    /// Beyond a change of an answer by as little as shows in the equations themselves.
    fn cross<O: Observer>(
        &mut self,
        equations: &ExpandedTogether<'_>,
        l: usize,
        lane: &mut Lane<'_, '_, O>,
        change: Change,
    ) -> f64 {
        let guard = equations.series.shape().guards[change.guard];
        let old = guard.answer(self.expansion.guards[change.guard][l]);
        gather(self.expansion.coefficients(), l, self.dense.taylor(lane.t));
        let (t, stride) = (lane.t, lane.stride);
        let is_new = |end: f64| {
            let x = &mut self.ends[1];
            self.dense.state(end, x);
            // Where this fails, the next step does.
            lane.watcher.project(end, x);
            scatter(x, l, &mut self.expansion.x_new);
            lane.statistics.evaluations += 1;
            self.fill_inputs(equations, l, lane.motion, end);
            self.expansion.evaluate(equations.series, &[end; LANES]);
            guard.answer(self.expansion.guards_new[change.guard][l]) != old
        };
        passed(is_new, t, stride, change)
    }
}
