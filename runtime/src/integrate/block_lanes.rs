//! The lanes of a block, and the motions assigned to them one after the other.

use super::block_stages::Block;
use super::error::{Cause, IntegrationError};
use super::outcome::{Outcome, Statistics};
use super::stops::Stride;
use super::watch::{End, Observer, Watch, Watcher};

/// A motion of a block.
#[derive(Debug)]
pub struct BlockMotion<'a, O> {
    /// Start and end in s.
    pub span: [f64; 2],
    /// The initial state; overwritten with the final one, also after an error.
    pub x: Vec<f64>,
    /// Its parameters.
    pub parameters: &'a [f64],
    /// Switching times, ranges and events.
    pub watch: Watch<'a>,
    /// Receives the accepted steps.
    pub observer: O,
}

/// The parts of a motion.
pub(super) struct Parts<'m, 'a, O> {
    pub(super) span: [f64; 2],
    pub(super) x: &'m mut [f64],
    pub(super) parameters: &'a [f64],
    pub(super) watch: &'m mut Watch<'a>,
    pub(super) observer: &'m mut O,
}

impl<'a, O> BlockMotion<'a, O> {
    pub(super) fn parts(&mut self) -> Parts<'_, 'a, O> {
        Parts {
            span: self.span,
            x: &mut self.x,
            parameters: self.parameters,
            watch: &mut self.watch,
            observer: &mut self.observer,
        }
    }
}

/// An active motion; `S` is the step-size control of the method.
pub(super) struct Lane<'m, 'a, O, S> {
    /// Index of the motion.
    pub(super) motion: usize,
    pub(super) x: &'m mut [f64],
    pub(super) watcher: Watcher<'m, 'a, O>,
    pub(super) statistics: Statistics,
    pub(super) t: f64,
    /// Whether the rates at the start of the step are still to be evaluated.
    pub(super) restart: bool,
    pub(super) stride: Stride,
    pub(super) steps: S,
    pub(super) end: Option<End>,
}

impl<'m, 'a, O: Observer, S> Lane<'m, 'a, O, S> {
    pub(super) fn new(motion: usize, of: Parts<'m, 'a, O>, steps: S) -> Self {
        let Parts {
            span,
            x,
            watch,
            observer,
            ..
        } = of;
        let t = span[0];
        let mut watcher = Watcher::new(watch, observer, span).paced(t);
        let start = watcher.start(t, x);
        let mut lane = Self {
            motion,
            x,
            watcher,
            statistics: Statistics::default(),
            t,
            restart: true,
            stride: Stride::none(t),
            steps,
            end: start.err().map(|cause| End::failed(t, cause)),
        };
        lane.finish_at_end();
        lane
    }

    pub(super) fn finish_at_end(&mut self) {
        if self.end.is_none() && self.t >= self.watcher.stops.end() {
            self.end = Some(End::finished(self.t));
        }
    }

    pub(super) fn fail(&mut self, cause: Cause) {
        self.end = Some(End::failed(self.t, cause));
    }

    fn conclude(self) -> Result<Outcome, IntegrationError> {
        let end = self.end.unwrap_or(End::finished(self.t));
        self.watcher.conclude(end, self.x, self.statistics)
    }
}

/// The lanes of a block; those without a motion are empty.
pub(super) type Lanes<'m, 'a, O, S, const L: usize> = [Option<Lane<'m, 'a, O, S>>; L];

/// Results of the motions that have ended.
pub(super) type Results = [Option<Result<Outcome, IntegrationError>>];

/// Concludes the motions that have ended and assigns waiting ones to their lanes. Returns an active lane, or `None`
/// once all motions have ended.
pub(super) fn refill<'m, 'a, O: Observer, S, const L: usize>(
    lanes: &mut Lanes<'m, 'a, O, S, L>,
    begin: &mut impl FnMut(usize) -> Option<Lane<'m, 'a, O, S>>,
    results: &mut Results,
) -> Option<usize> {
    for (l, lane) in lanes.iter_mut().enumerate() {
        while lane.as_ref().is_none_or(|lane| lane.end.is_some()) {
            if let Some(ended) = lane.take() {
                let motion = ended.motion;
                results[motion] = Some(ended.conclude());
            }
            *lane = begin(l);
            if lane.is_none() {
                break;
            }
        }
    }
    lanes.iter().position(Option::is_some)
}

/// Empty lanes.
pub(super) fn idle_lanes<O, S, const L: usize>(lanes: &Lanes<'_, '_, O, S, L>) -> Vec<usize> {
    (0..L).filter(|&l| lanes[l].is_none()).collect()
}

/// The active motions, with their lanes.
pub(super) fn on_their_way<'l, 'm, 'a, O, S, const L: usize>(
    lanes: &'l mut Lanes<'m, 'a, O, S, L>,
) -> impl Iterator<Item = (usize, &'l mut Lane<'m, 'a, O, S>)> {
    let all = lanes.iter_mut().enumerate();
    all.filter_map(|(l, lane)| Some((l, lane.as_mut()?)))
        .filter(|(_, lane)| lane.end.is_none())
}

/// The results of all motions.
pub(super) fn all(
    results: Vec<Option<Result<Outcome, IntegrationError>>>,
) -> Vec<Result<Outcome, IntegrationError>> {
    // Every motion has a result: lanes are refilled until none is waiting.
    let unseen = || {
        Err(IntegrationError::InvalidArgument {
            what: "motion",
            value: f64::NAN,
        })
    };
    let results = results.into_iter();
    results
        .map(|result| result.unwrap_or_else(unseen))
        .collect()
}

/// Copies the entries of a lane.
pub(super) fn gather<const L: usize>(blocks: &[Block<L>], l: usize, to: &mut [f64]) {
    for (to, block) in to.iter_mut().zip(blocks) {
        *to = block[l];
    }
}

/// Writes the entries of a lane.
pub(super) fn scatter<const L: usize>(from: &[f64], l: usize, blocks: &mut [Block<L>]) {
    for (from, block) in from.iter().zip(blocks) {
        block[l] = *from;
    }
}
