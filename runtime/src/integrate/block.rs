//! The step loop of the embedded pairs, for one motion or for eight at once.

use std::array::from_fn;
use std::marker::PhantomData;

use super::block_lanes::{
    self, BlockMotion, Parts, all, gather, idle_lanes, on_their_way, refill, scatter,
};
use super::block_stages::{Block, BlockStages, Places};
use super::dense_output::{DenseOutput, Ends, HERMITE};
use super::error::{Cause, IntegrationError};
use super::options::Options;
use super::outcome::Outcome;
use super::pairs::EmbeddedPair;
use super::step_size::{
    Control, StepSize, first_guess, first_step, next_after_rejection, norm, powers,
};
use super::stops::Stride;
use super::watch::Observer;
use crate::lanes::LANES;

/// An adaptive integrator for many motions of one system, `L` at a time, with its work arrays.
///
/// Every operation of a step acts on all motions of a block. Each motion has its own step size, events and end, and agrees bit
/// for bit with that of [`Solver`](super::Solver), whatever the other lanes contain. When one ends, the next takes
/// its lane.
#[derive(Debug, Clone)]
pub struct BlockSolver<P, const L: usize = LANES> {
    stages: BlockStages<L>,
    clock: Clock<L>,
    dense: DenseOutput,
    /// State and rates of one motion at both ends of a step.
    ends: [Vec<f64>; 4],
    pair: PhantomData<P>,
}

impl<P, const L: usize> Default for BlockSolver<P, L> {
    fn default() -> Self {
        Self {
            stages: BlockStages::default(),
            clock: Clock::default(),
            dense: DenseOutput::default(),
            ends: Default::default(),
            pair: PhantomData,
        }
    }
}

/// Times of the steps of all lanes.
#[derive(Debug, Clone, Copy)]
struct Clock<const L: usize> {
    t: Block<L>,
    h: Block<L>,
    t_new: Block<L>,
    last: Block<L>,
}

impl<const L: usize> Default for Clock<L> {
    fn default() -> Self {
        let [t, h, t_new, last] = [[0.0; L]; 4];
        Self { t, h, t_new, last }
    }
}

impl<const L: usize> Clock<L> {
    /// Times of a node, not beyond a switching time, before which the old rates apply.
    fn at(&self, node: f64) -> Block<L> {
        let mut times = self.last;
        for (l, time) in times.iter_mut().enumerate() {
            *time = (self.t[l] + node * self.h[l]).min(*time);
        }
        times
    }

    /// Times of the ends.
    fn at_end(&self) -> Block<L> {
        let mut times = self.last;
        for (time, t_new) in times.iter_mut().zip(self.t_new) {
            *time = t_new.min(*time);
        }
        times
    }

    /// Sets the step of a lane.
    fn set(&mut self, l: usize, t: f64, stride: Stride) {
        (self.t[l], self.h[l]) = (t, stride.h);
        (self.t_new[l], self.last[l]) = (stride.t_new, stride.last);
    }

    /// An empty lane copies the time of another one, with a step of zero.
    fn idle(&mut self, l: usize, beside: usize) {
        let t = self.t[beside];
        self.set(l, t, Stride::none(t));
    }
}

/// Step-size control of one motion.
struct Steps {
    size: StepSize,
    /// The proposed step; estimated as a first step if unknown.
    next_h: Option<f64>,
    /// Upper bound on an estimated first step after a rejection.
    longest: f64,
    /// Whether the current step is an estimated first step.
    is_guess: bool,
}

impl Steps {
    fn new(control: Control) -> Self {
        Self {
            size: StepSize::new(control),
            next_h: None,
            longest: f64::INFINITY,
            is_guess: false,
        }
    }
}

type Lane<'m, 'a, O> = block_lanes::Lane<'m, 'a, O, Steps>;
type Lanes<'m, 'a, O, const L: usize> = block_lanes::Lanes<'m, 'a, O, Steps, L>;

impl<P: EmbeddedPair, const L: usize> BlockSolver<P, L> {
    /// A solver for systems of any size.
    pub fn new() -> Self {
        Self::default()
    }

    /// Integrates ẋ = f(t, x) for each motion; returns how each ended.
    ///
    /// `f(which, places, rates)` writes the rates of the motions `which`, component by component in the layout of
    /// their states. With fewer than eight motions, empty lanes hold copies and their rates are ignored.
    ///
    /// # Panics
    ///
    /// If the states of the motions have different lengths, or their parameters.
    pub fn integrate<F, O>(
        &mut self,
        mut f: F,
        motions: &mut [BlockMotion<'_, O>],
        options: &Options,
    ) -> Vec<Result<Outcome, IntegrationError>>
    where
        F: FnMut(&[usize; L], Places<'_, L>, &mut [Block<L>]),
        O: Observer,
    {
        let n = motions.first().map_or(0, |motion| motion.x.len());
        let parameters = motions.first().map_or(0, |motion| motion.parameters.len());
        let alike = |motion: &BlockMotion<'_, O>| {
            [motion.x.len(), motion.parameters.len()] == [n, parameters]
        };
        assert!(motions.iter().all(alike), "motions of one system");
        let refused = motions.iter().find_map(|motion| {
            let checked = options.check(motion.span);
            checked.and_then(|()| motion.watch.check(n)).err()
        });
        if let Some(refused) = refused {
            return motions.iter().map(|_| Err(refused.clone())).collect();
        }
        self.run(
            &mut f,
            motions.iter_mut().map(BlockMotion::parts),
            n,
            options,
        )
    }

    /// Integrates valid motions of `n` states.
    pub(super) fn run<'m, 'a: 'm, F, O>(
        &mut self,
        f: &mut F,
        motions: impl ExactSizeIterator<Item = Parts<'m, 'a, O>>,
        n: usize,
        options: &Options,
    ) -> Vec<Result<Outcome, IntegrationError>>
    where
        F: FnMut(&[usize; L], Places<'_, L>, &mut [Block<L>]),
        O: Observer + 'm,
    {
        self.stages.prepare(n, P::ALL_STAGES);
        self.dense.prepare(n, P::INTERIOR_COEFFICIENTS);
        for end in &mut self.ends {
            end.resize(n, 0.0);
        }
        let mut results: Vec<_> = (0..motions.len()).map(|_| None).collect();
        let mut waiting = motions.enumerate();
        let mut lanes: Lanes<'_, '_, O, L> = from_fn(|_| None);
        let mut which = [0; L];
        loop {
            let mut begin = |l: usize| {
                let (motion, of) = waiting.next()?;
                which[l] = motion;
                self.stages.begin(l, of.x, of.parameters);
                let lane = Lane::new(motion, of, Steps::new(P::CONTROL));
                self.clock.set(l, lane.t, lane.stride);
                Some(lane)
            };
            let Some(beside) = refill(&mut lanes, &mut begin, &mut results) else {
                break;
            };
            for l in idle_lanes(&lanes) {
                self.clock.idle(l, beside);
                self.stages.copy(beside, l);
            }
            let mut f = |at: Places<'_, L>, rates: &mut [Block<L>]| f(&which, at, rates);
            self.start(&mut f, &mut lanes, options);
            let errors = self.attempt(&mut f, &mut lanes, options);
            self.decide(&mut f, &mut lanes, &errors, options);
        }
        all(results)
    }

    /// Evaluates the rates at starts and restarts, and sets the next step of each motion.
    fn start<F, O>(&mut self, f: &mut F, lanes: &mut Lanes<'_, '_, O, L>, options: &Options)
    where
        F: FnMut(Places<'_, L>, &mut [Block<L>]),
        O: Observer,
    {
        if on_their_way(lanes).any(|(_, lane)| lane.restart) {
            // Stage 1 is used as scratch space: the rates of the others are known.
            for (l, lane) in on_their_way(lanes) {
                self.clock.t[l] = lane.t;
            }
            self.stages.evaluate_at_start(f, 1, &self.clock.t);
        }
        for (l, lane) in on_their_way(lanes) {
            if lane.restart {
                lane.statistics.evaluations += 1;
                self.stages.copy_rates(l, 1, 0);
                if let Some(component) = self.stages.rate_not_finite(l, 0) {
                    lane.fail(Cause::NonFinite { component });
                    continue;
                }
            }
            let steps = lane.statistics.steps + lane.statistics.rejected;
            if steps >= options.max_steps {
                lane.fail(Cause::TooManySteps { steps });
            }
        }
        if on_their_way(lanes).any(|(_, lane)| lane.steps.next_h.is_none()) {
            self.first_steps(f, lanes, options);
        }
        for (l, lane) in on_their_way(lanes) {
            // Every active motion has a step by now.
            let h = lane.steps.next_h.unwrap_or(0.0);
            lane.stride = lane.watcher.stops.stride(lane.t, h);
            lane.steps.next_h = Some(h);
            self.clock.set(l, lane.t, lane.stride);
        }
    }

    /// First steps from the norms of x, ẋ and ẍ, limited by the next stops.
    fn first_steps<F, O>(&mut self, f: &mut F, lanes: &mut Lanes<'_, '_, O, L>, options: &Options)
    where
        F: FnMut(Places<'_, L>, &mut [Block<L>]),
        O: Observer,
    {
        let begins = |(_, lane): &(usize, &mut Lane<'_, '_, O>)| lane.steps.next_h.is_none();
        let mut t = self.clock.t;
        // Lanes that need a first step: initial estimate, longest step.
        let mut guesses: [Option<[f64; 2]>; L] = [None; L];
        for (l, lane) in on_their_way(lanes).filter(begins) {
            let stop = lane.watcher.stops.known_after(lane.t);
            let longest = options
                .max_step
                .min(stop.t - lane.t)
                .min(lane.steps.longest);
            if let Some(h) = options.first_step {
                lane.steps.next_h = Some(h.min(longest));
                continue;
            }
            let [x_norm, rates_norm] = self.sizes(l, options);
            let guess = first_guess(x_norm, rates_norm).min(longest);
            self.stages.euler_step(l, guess);
            t[l] = (lane.t + guess).min(stop.last);
            guesses[l] = Some([guess, longest]);
        }
        if guesses.iter().all(Option::is_none) {
            return;
        }
        self.stages.evaluate_at_end(f, 1, &t);
        for (l, lane) in on_their_way(lanes) {
            let Some([guess, longest]) = guesses[l] else {
                continue;
            };
            lane.statistics.evaluations += 1;
            let [_, rates_norm] = self.sizes(l, options);
            let [_, scale, ..] = &self.ends;
            let (start, end) = (self.stages.rates(0), self.stages.rates(1));
            let change = start.iter().zip(end).map(|(start, end)| end[l] - start[l]);
            let second_norm = norm(change, scale) / guess;
            let h = first_step(guess, rates_norm, second_norm, P::ORDER).min(longest);
            (lane.steps.next_h, lane.steps.is_guess) = (Some(h), true);
        }
    }

    /// Weighted norms of a state and its rates, with the weights in the second of the ends.
    fn sizes(&mut self, l: usize, options: &Options) -> [f64; 2] {
        let [x, scale, ..] = &mut self.ends;
        gather(&self.stages.x, l, x);
        for (scale, x) in scale.iter_mut().zip(&*x) {
            *scale = options.scale(x.abs());
        }
        let rates = self.stages.rates(0).iter().map(|rate| rate[l]);
        [norm(x.iter().copied(), scale), norm(rates, scale)]
    }

    /// All stages of a step; the weighted errors, NaN where a new state is not finite.
    fn attempt<F, O>(
        &mut self,
        f: &mut F,
        lanes: &mut Lanes<'_, '_, O, L>,
        options: &Options,
    ) -> Block<L>
    where
        F: FnMut(Places<'_, L>, &mut [Block<L>]),
        O: Observer,
    {
        let clock = self.clock;
        self.stages
            .step(f, &P::TABLEAU, &clock.h, |node| clock.at(node));
        let mut valid = [true; L];
        for (l, lane) in on_their_way(lanes) {
            lane.statistics.evaluations += P::TABLEAU.nodes.len();
            if lane.watcher.projects() {
                let x = &mut self.ends[0];
                gather(&self.stages.x_new, l, x);
                valid[l] = lane.watcher.project(lane.stride.t_new, x);
                scatter(x, l, &mut self.stages.x_new);
            }
        }
        if P::ERROR_USES_NEW_RATES {
            self.new_rates(f, lanes, [true; L]);
        }
        let finite = self.stages.scale_by(options);
        let mut errors = P::errors(|row| self.stages.mean_squares(row), &clock.h);
        for l in 0..L {
            if !(valid[l] && finite[l]) {
                errors[l] = f64::NAN;
            }
        }
        errors
    }

    /// Rates at the ends of the steps.
    fn new_rates<F, O>(&mut self, f: &mut F, lanes: &mut Lanes<'_, '_, O, L>, of: [bool; L])
    where
        F: FnMut(Places<'_, L>, &mut [Block<L>]),
        O: Observer,
    {
        let t = self.clock.at_end();
        self.stages.evaluate_at_end(f, P::TABLEAU.new_rates(), &t);
        for (_, lane) in on_their_way(lanes).filter(|&(l, _)| of[l]) {
            lane.statistics.evaluations += 1;
        }
    }

    /// Accepts steps with errors within the tolerances and passes them to their watchers; rejects the others.
    fn decide<F, O>(
        &mut self,
        f: &mut F,
        lanes: &mut Lanes<'_, '_, O, L>,
        errors: &Block<L>,
        options: &Options,
    ) where
        F: FnMut(Places<'_, L>, &mut [Block<L>]),
        O: Observer,
    {
        let powers = powers(P::CONTROL, errors);
        let mut accepted = [false; L];
        for (l, lane) in on_their_way(lanes) {
            accepted[l] = errors[l] <= 1.0;
            if accepted[l] {
                continue;
            }
            lane.statistics.rejected += 1;
            let shorter = lane.stride.h * lane.steps.size.rejected(errors[l], powers[l]);
            if lane.t + 0.1 * shorter <= lane.t {
                lane.fail(self.stuck(l, shorter, errors[l]));
            }
            (lane.steps.next_h, lane.steps.longest) =
                next_after_rejection(lane.restart && !lane.steps.is_guess, shorter);
            lane.restart = false;
        }
        if !accepted.contains(&true) {
            return;
        }
        if !P::ERROR_USES_NEW_RATES {
            self.new_rates(f, lanes, accepted);
        }
        // Whether the step is accepted; `None` if dense output is needed to decide.
        let accept = |this: &mut Self, l: usize, lane: &mut Lane<'_, '_, O>, within: bool| {
            let ends = ends::<P, L>(&this.stages, &mut this.ends, l, lane);
            if within {
                lane.statistics.evaluations += P::INTERIOR_STAGES.len();
                this.dense.set_hermite(&ends);
                for (c, &row) in P::INTERIOR.iter().enumerate() {
                    let coefficient = this.dense.coefficient(HERMITE + c);
                    this.stages.combination(l, lane.stride.h, row, coefficient);
                }
                if let Some(shorter) = lane.watcher.shorter(&ends, &this.dense) {
                    lane.statistics.rejected += 1;
                    (lane.steps.next_h, lane.restart) = (Some(shorter), false);
                    return Some(false);
                }
            } else if let Some(shorter) = lane.watcher.too_long(&ends) {
                lane.statistics.rejected += 1;
                (lane.steps.next_h, lane.restart) = (Some(shorter), false);
                return Some(false);
            } else if lane.watcher.wants_interior(&ends) {
                return None;
            }
            lane.statistics.steps += 1;
            let interior = within.then_some(&this.dense);
            lane.end = lane.watcher.accept(&ends, interior, lane.x);
            let switched = lane.watcher.switched();
            if switched.is_some() {
                scatter(lane.x, l, &mut this.stages.x_new);
            }
            let suggested = lane.stride.h * lane.steps.size.accepted(errors[l], powers[l]);
            // A step shortened to end at a stop is no reason to propose a shorter one.
            let suggested = match lane.steps.next_h {
                Some(h) if lane.stride.lands || switched.is_some() => suggested.max(h),
                _ => suggested,
            };
            lane.steps.next_h = Some(suggested.min(options.max_step));
            lane.steps.is_guess = false;
            let end = (lane.stride.t_new, lane.stride.lands);
            (lane.t, lane.restart) = switched.map_or(end, |t| (t, true));
            lane.finish_at_end();
            Some(true)
        };
        let mut wanted = [false; L];
        let exact = accepted;
        for (l, lane) in on_their_way(lanes).filter(|&(l, _)| exact[l]) {
            let outcome = accept(self, l, lane, false);
            (wanted[l], accepted[l]) = (outcome.is_none(), outcome != Some(false));
        }
        let (clock, new_rates) = (self.clock, P::TABLEAU.new_rates());
        if wanted.contains(&true) {
            for (i, &(node, row)) in P::INTERIOR_STAGES.iter().enumerate() {
                let (stage, t) = (new_rates + 1 + i, clock.at(node));
                self.stages.evaluate(f, stage, &t, &clock.h, row);
            }
        }
        for (l, lane) in on_their_way(lanes).filter(|&(l, _)| wanted[l]) {
            accepted[l] = accept(self, l, lane, true) == Some(true);
        }
        self.stages.advance(accepted, new_rates);
    }

    /// The cause of failure if no step of a motion is accepted.
    fn stuck(&self, l: usize, h: f64, error: f64) -> Cause {
        let mut stages = 1..P::TABLEAU.new_rates();
        let not_finite = stages
            .find_map(|stage| self.stages.rate_not_finite(l, stage))
            .or_else(|| self.stages.state_not_finite(l));
        match not_finite.filter(|_| !error.is_finite()) {
            Some(component) => Cause::NonFinite { component },
            None => Cause::StepTooSmall { h },
        }
    }
}

/// Both ends of a step of one motion.
fn ends<'e, P: EmbeddedPair, const L: usize>(
    stages: &BlockStages<L>,
    numbers: &'e mut [Vec<f64>; 4],
    l: usize,
    lane: &Lane<'_, '_, impl Observer>,
) -> Ends<'e> {
    let [x, x_new, start, end] = numbers;
    gather(&stages.x, l, x);
    gather(&stages.x_new, l, x_new);
    gather(stages.rates(0), l, start);
    gather(stages.rates(P::TABLEAU.new_rates()), l, end);
    Ends {
        t: [lane.t, lane.stride.t_new],
        x: [x, x_new],
        rates: [start, end],
    }
}
