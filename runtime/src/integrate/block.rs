//! The step loop of the embedded pairs for eight motions at once.

use std::array::from_fn;
use std::marker::PhantomData;

use super::block_stages::{Block, BlockStages};
use super::dense_output::{DenseOutput, Ends, HERMITE};
use super::error::{Cause, IntegrationError};
use super::options::Options;
use super::outcome::{Outcome, Statistics};
use super::pairs::EmbeddedPair;
use super::step_size::{StepSize, first_guess, first_step, norm};
use super::stops::Stride;
use super::watch::{End, Observer, Watch, Watcher};
use crate::lanes::LANES;

/// A motion of a block.
#[derive(Debug)]
pub struct BlockMotion<'a, O> {
    /// Start and end in s.
    pub span: [f64; 2],
    /// The initial state; leaves with the last one, also after an error.
    pub x: Vec<f64>,
    /// Switching times, ranges and events.
    pub watch: Watch<'a>,
    /// Who sees the accepted steps.
    pub observer: O,
}

/// An adaptive integrator for up to eight motions of one system, with its work arrays.
///
/// Every operation of a step acts on all motions, and each has a step size, events and an end of its own: it is, bit
/// for bit, the motion that [`Solver`](super::Solver) gives, whichever others are beside it.
#[derive(Debug, Clone)]
pub struct BlockSolver<P> {
    stages: BlockStages,
    scale: Vec<Block>,
    dense: DenseOutput,
    /// States and rates of one motion at both ends of a step.
    ends: [Vec<f64>; 4],
    pair: PhantomData<P>,
}

impl<P> Default for BlockSolver<P> {
    fn default() -> Self {
        Self {
            stages: BlockStages::default(),
            scale: Vec::new(),
            dense: DenseOutput::default(),
            ends: Default::default(),
            pair: PhantomData,
        }
    }
}

/// A motion on its way.
struct Lane<'w, 'a, O> {
    watcher: Watcher<'w, 'a, O>,
    step_size: StepSize,
    statistics: Statistics,
    t: f64,
    /// The step that is suggested.
    next_h: Option<f64>,
    /// Whether the rates at the start of the step are still to be evaluated.
    restart: bool,
    stride: Stride,
    end: Option<End>,
}

impl<O> Lane<'_, '_, O> {
    fn restarts(&self) -> bool {
        self.end.is_none() && self.restart
    }

    /// Start and end of the step.
    fn interval(&self) -> [f64; 2] {
        [self.t, self.stride.t_new]
    }

    fn fail(&mut self, cause: Cause) {
        self.end = Some(End::failed(self.t, cause));
    }
}

impl<P: EmbeddedPair> BlockSolver<P> {
    /// A solver for systems of any size.
    pub fn new() -> Self {
        Self::default()
    }

    /// Integrates ẋ = f(t, x) for each motion; returns how each ended.
    ///
    /// `f(t, x, rates)` writes the rates of eight motions, component by component: `x[i][l]` is state i of motion l.
    /// Where there are fewer motions, or some have ended, the others are evaluated at states without meaning, and
    /// what is written there is ignored.
    ///
    /// # Panics
    ///
    /// If there are more than eight motions, or their states have different lengths.
    pub fn integrate<F, O>(
        &mut self,
        mut f: F,
        motions: &mut [BlockMotion<'_, O>],
        options: &Options,
    ) -> Vec<Result<Outcome, IntegrationError>>
    where
        F: FnMut(&Block, &[Block], &mut [Block]),
        O: Observer,
    {
        let n = motions.first().map_or(0, |motion| motion.x.len());
        assert!(motions.len() <= LANES, "a block has {LANES} motions");
        assert!(motions.iter().all(|motion| motion.x.len() == n));
        let refused = motions.iter().find_map(|motion| {
            let checked = options.check(motion.span);
            checked.and_then(|()| motion.watch.check(n)).err()
        });
        if let Some(refused) = refused {
            return motions.iter().map(|_| Err(refused.clone())).collect();
        }
        self.prepare(n, motions);
        let mut states: Vec<&mut Vec<f64>> = Vec::with_capacity(motions.len());
        let mut lanes: Vec<Lane<'_, '_, O>> = Vec::with_capacity(motions.len());
        for motion in motions {
            let span = motion.span;
            let mut watcher = Watcher::new(&mut motion.watch, &mut motion.observer, span);
            let start = watcher.start(span[0], &motion.x);
            lanes.push(Lane {
                watcher,
                step_size: StepSize::new(P::CONTROL),
                statistics: Statistics::default(),
                t: span[0],
                next_h: None,
                restart: true,
                stride: Stride::none(span[0]),
                end: start.err().map(|cause| End::failed(span[0], cause)),
            });
            states.push(&mut motion.x);
        }
        while self.start(&mut f, &mut lanes, options) {
            let errors = self.attempt(&mut f, &mut lanes, options);
            self.decide(&mut f, &mut lanes, &mut states, &errors, options);
        }
        let ended = lanes.into_iter().zip(states);
        ended
            .map(|(lane, x)| {
                let end = lane.end.unwrap_or(End::finished(lane.t));
                lane.watcher.conclude(end, x, lane.statistics)
            })
            .collect()
    }

    fn prepare<O>(&mut self, n: usize, motions: &[BlockMotion<'_, O>]) {
        self.stages.prepare(n, P::ALL_STAGES);
        for (i, x) in self.stages.x.iter_mut().enumerate() {
            *x = from_fn(|l| motions.get(l).map_or(0.0, |motion| motion.x[i]));
        }
        self.scale.resize(n, [0.0; LANES]);
        self.dense.prepare(n, P::INTERIOR_COEFFICIENTS);
        for end in &mut self.ends {
            end.resize(n, 0.0);
        }
    }

    /// Rates where motions begin or begin anew, and the step that each tries next. False once all have ended.
    fn start<F, O>(&mut self, f: &mut F, lanes: &mut [Lane<'_, '_, O>], options: &Options) -> bool
    where
        F: FnMut(&Block, &[Block], &mut [Block]),
        O: Observer,
    {
        for (_, lane) in on_their_way(lanes) {
            if lane.t >= lane.watcher.stops.end() {
                lane.end = Some(End::finished(lane.t));
            }
        }
        if lanes.iter().any(Lane::restarts) {
            // Stage 1 serves as a place to write: the rates of the others are known.
            self.stages
                .evaluate_at_start(f, 1, &block(lanes, |lane| lane.t));
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
        self.first_steps(f, lanes, options);
        for (_, lane) in on_their_way(lanes) {
            // Every motion on its way has a step by now.
            let h = lane.next_h.unwrap_or(0.0);
            lane.stride = lane.watcher.stops.stride(lane.t, h);
            lane.next_h = Some(h);
        }
        lanes.iter().any(|lane| lane.end.is_none())
    }

    /// First steps from the sizes of x, ẋ and ẍ, not beyond the next stops.
    fn first_steps<F, O>(&mut self, f: &mut F, lanes: &mut [Lane<'_, '_, O>], options: &Options)
    where
        F: FnMut(&Block, &[Block], &mut [Block]),
        O: Observer,
    {
        let begins = |(_, lane): &(usize, &mut Lane<'_, '_, O>)| lane.next_h.is_none();
        let mut t = block(lanes, |lane| lane.t);
        // Those whose step has to be guessed: guess, longest step.
        let mut guesses: [Option<[f64; 2]>; LANES] = [None; LANES];
        for (l, lane) in on_their_way(lanes).filter(begins) {
            let stop = lane.watcher.stops.known_after(lane.t);
            let longest = options.max_step.min(stop.t - lane.t);
            if let Some(h) = options.first_step {
                lane.next_h = Some(h.min(longest));
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
            lane.next_h = Some(h);
        }
    }

    /// Norms of a state and its rates over the tolerances, which stay in the second of the ends.
    fn sizes(&mut self, l: usize, options: &Options) -> [f64; 2] {
        let [x, scale, ..] = &mut self.ends;
        gather(&self.stages.x, l, x);
        for (scale, x) in scale.iter_mut().zip(&*x) {
            *scale = options.scale(x.abs());
        }
        let rates = self.stages.rates(0).iter().map(|rate| rate[l]);
        [norm(x.iter().copied(), scale), norm(rates, scale)]
    }

    /// All stages of a step; the errors over the tolerances, NaN where a new state is not finite.
    fn attempt<F, O>(
        &mut self,
        f: &mut F,
        lanes: &mut [Lane<'_, '_, O>],
        options: &Options,
    ) -> Block
    where
        F: FnMut(&Block, &[Block], &mut [Block]),
        O: Observer,
    {
        let h = block(lanes, |lane| lane.stride.h);
        self.stages.step(f, &P::TABLEAU, &h, times(lanes));
        let mut valid = [true; LANES];
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
            self.new_rates(f, lanes, [true; LANES]);
        }
        let ends = self.stages.x.iter().zip(&self.stages.x_new);
        for (scale, (x, x_new)) in self.scale.iter_mut().zip(ends) {
            *scale = from_fn(|l| options.scale(x[l].abs().max(x_new[l].abs())));
        }
        let mut errors = P::errors(|row| self.stages.mean_squares(row, &self.scale), &h);
        for (l, error) in errors.iter_mut().enumerate() {
            if !valid[l] || self.stages.state_not_finite(l).is_some() {
                *error = f64::NAN;
            }
        }
        errors
    }

    /// Rates at the ends of the steps.
    fn new_rates<F, O>(&mut self, f: &mut F, lanes: &mut [Lane<'_, '_, O>], of: [bool; LANES])
    where
        F: FnMut(&Block, &[Block], &mut [Block]),
        O: Observer,
    {
        let t = block(lanes, |lane| lane.stride.t_new.min(lane.stride.last));
        self.stages.evaluate_at_end(f, P::TABLEAU.new_rates(), &t);
        for (_, lane) in on_their_way(lanes).filter(|&(l, _)| of[l]) {
            lane.statistics.evaluations += 1;
        }
    }

    /// Accepts the steps that are exact enough and shows them to their watchers; shortens the others.
    fn decide<F, O>(
        &mut self,
        f: &mut F,
        lanes: &mut [Lane<'_, '_, O>],
        states: &mut [&mut Vec<f64>],
        errors: &Block,
        options: &Options,
    ) where
        F: FnMut(&Block, &[Block], &mut [Block]),
        O: Observer,
    {
        let mut accepted = [false; LANES];
        for (l, lane) in on_their_way(lanes) {
            accepted[l] = errors[l] <= 1.0;
            if accepted[l] {
                lane.statistics.steps += 1;
                continue;
            }
            lane.statistics.rejected += 1;
            let shorter = lane.stride.h * lane.step_size.rejected(errors[l]);
            if lane.t + 0.1 * shorter <= lane.t {
                lane.fail(self.stuck(l, shorter, errors[l]));
            }
            (lane.next_h, lane.restart) = (Some(shorter), false);
        }
        if !accepted.contains(&true) {
            return;
        }
        if !P::ERROR_USES_NEW_RATES {
            self.new_rates(f, lanes, accepted);
        }
        let new_rates = P::TABLEAU.new_rates();
        let wanted: [bool; LANES] = from_fn(|l| {
            let lane = lanes.get(l).filter(|_| accepted[l]);
            lane.is_some_and(|lane| {
                let ends = ends(
                    &self.stages,
                    &mut self.ends,
                    l,
                    (lane.interval(), new_rates),
                );
                lane.watcher.wants_interior(&ends)
            })
        });
        if wanted.contains(&true) {
            let (h, time) = (block(lanes, |lane| lane.stride.h), times(lanes));
            for (i, &(node, row)) in P::INTERIOR_STAGES.iter().enumerate() {
                self.stages
                    .evaluate(f, new_rates + 1 + i, &time(node), &h, row);
            }
        }
        for (l, lane) in on_their_way(lanes).filter(|&(l, _)| accepted[l]) {
            let h = lane.stride.h;
            let ends = ends(
                &self.stages,
                &mut self.ends,
                l,
                (lane.interval(), new_rates),
            );
            if wanted[l] {
                lane.statistics.evaluations += P::INTERIOR_STAGES.len();
                self.dense.set_hermite(&ends);
                for (c, &row) in P::INTERIOR.iter().enumerate() {
                    let coefficient = self.dense.coefficient(HERMITE + c);
                    self.stages.combination(l, h, row, coefficient);
                }
            }
            let interior = wanted[l].then_some(&self.dense);
            lane.end = lane.watcher.accept(&ends, interior, states[l]);
            self.stages.advance(l, new_rates);
            let suggested = h * lane.step_size.accepted(errors[l]);
            // A step cut short to land says nothing against the longer one.
            let suggested = match lane.next_h {
                Some(h) if lane.stride.lands => suggested.max(h),
                _ => suggested,
            };
            lane.next_h = Some(suggested.min(options.max_step));
            (lane.t, lane.restart) = (lane.stride.t_new, lane.stride.lands);
        }
    }

    /// Why no step of a motion is accepted.
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

/// The motions that have not ended, by their place in the block.
fn on_their_way<'l, 'w, 'a, O>(
    lanes: &'l mut [Lane<'w, 'a, O>],
) -> impl Iterator<Item = (usize, &'l mut Lane<'w, 'a, O>)> {
    let all = lanes.iter_mut().enumerate();
    all.filter(|(_, lane)| lane.end.is_none())
}

/// A number of each motion; zero where there is none.
fn block<O>(lanes: &[Lane<'_, '_, O>], number: impl Fn(&Lane<'_, '_, O>) -> f64) -> Block {
    from_fn(|l| lanes.get(l).map_or(0.0, &number))
}

/// Times of the nodes of a step. Up to a switching time the rates are those before it.
fn times<O>(lanes: &[Lane<'_, '_, O>]) -> impl Fn(f64) -> Block + use<O> {
    let t = block(lanes, |lane| lane.t);
    let h = block(lanes, |lane| lane.stride.h);
    let last = block(lanes, |lane| lane.stride.last);
    move |node| from_fn(|l| (t[l] + node * h[l]).min(last[l]))
}

/// Both ends of a step of one motion.
fn ends<'e>(
    stages: &BlockStages,
    numbers: &'e mut [Vec<f64>; 4],
    l: usize,
    (t, new_rates): ([f64; 2], usize),
) -> Ends<'e> {
    let [x, x_new, start, end] = numbers;
    gather(&stages.x, l, x);
    gather(&stages.x_new, l, x_new);
    gather(stages.rates(0), l, start);
    gather(stages.rates(new_rates), l, end);
    Ends {
        t,
        x: [x, x_new],
        rates: [start, end],
    }
}

fn gather(blocks: &[Block], l: usize, to: &mut [f64]) {
    for (to, block) in to.iter_mut().zip(blocks) {
        *to = block[l];
    }
}

fn scatter(from: &[f64], l: usize, blocks: &mut [Block]) {
    for (from, block) in from.iter().zip(blocks) {
        block[l] = *from;
    }
}
