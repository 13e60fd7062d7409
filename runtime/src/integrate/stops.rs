//! Times at which steps must end: the rates are discontinuous or not smooth there.

use std::rc::Rc;

use super::crossings::CrossingSearch;
use super::dense_output::{DenseOutput, Ends};
use super::pace::Pace;
use super::switches::{SwitchSearch, Switches};
use crate::real::Enclosure;
use crate::switching::Counts;

/// A time at which a step must end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stop {
    /// Time in s.
    pub(super) t: f64,
    /// The latest time at which stages are evaluated: just before a switching time.
    pub(super) last: f64,
}

impl Stop {
    fn before(t: f64) -> Self {
        let last = t.next_down();
        Self { t, last }
    }
}

/// A trial step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stride {
    /// Its length in s.
    pub(super) h: f64,
    /// End time in s.
    pub(super) t_new: f64,
    /// See [`Stop::last`].
    pub(super) last: f64,
    /// Whether it ends at a stop, after which the rates may be different.
    pub(super) lands: bool,
}

impl Stride {
    /// A step of length zero.
    pub(super) fn none(t: f64) -> Self {
        Self::to(t, t)
    }

    /// A step from one time to another.
    pub(super) fn to(t: f64, t_new: f64) -> Self {
        Self {
            h: t_new - t,
            t_new,
            last: t_new,
            lands: false,
        }
    }
}

/// So many switches of functions of time within this fraction of the motion count as Zeno behaviour.
const MANY_CHANGES: usize = 1000;
const AT_ONE_PLACE: f64 = 1e-6;

/// A negligible step, relative to the time.
const SLIVER: f64 = 1e-9;

/// The longest negligible step that ends at a time.
pub(super) fn sliver(t: f64) -> f64 {
    SLIVER * t.abs().max(1.0)
}

/// Parts of a motion in which changes are sought one after another, and the most times that are listed.
const WINDOWS: u32 = 64;
const MOST_TIMES: usize = 1 << 20;

/// What is known of the steps of a motion before it starts.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Timetable {
    /// Times in s at which a step has to end since the rates change there.
    pub changes: Vec<f64>,
    /// Intervals, by their starts and lengths in s and in the order of the starts: a step that overlaps one of them is
    /// at most twice as long, so that it steps over no pulse.
    pub paces: Vec<[f64; 2]>,
}

impl Timetable {
    /// That of a motion over a span; nothing if it has more than a million changes.
    pub(crate) fn new(
        span: [f64; 2],
        switching_times: &[f64],
        switches: Option<&mut Switches<'_>>,
    ) -> Option<Self> {
        let mut stops = Stops::new(span, switching_times, switches).with_pace(span[0]);
        Some(Self {
            changes: stops.all()?,
            paces: stops.pace.all(),
        })
    }
}

/// All times at which steps have to end.
pub(super) struct Stops<'w, 'a> {
    /// The known ones after the start, in increasing order.
    times: Vec<f64>,
    end: f64,
    switches: Option<(&'w mut Switches<'a>, SwitchSearch)>,
    crossings: CrossingSearch,
    /// An expected switch by a function of the state, in s.
    expected: f64,
    start: f64,
    /// Number of switches by functions of time, the last one, and an earlier one for comparison, in s.
    changes: usize,
    last_change: f64,
    change_before: f64,
    is_endless: bool,
    pace: Rc<Pace>,
}

impl<'w, 'a> Stops<'w, 'a> {
    pub(super) fn new(
        [start, end]: [f64; 2],
        switching_times: &[f64],
        switches: Option<&'w mut Switches<'a>>,
    ) -> Self {
        let inside = |t: &f64| start < *t && *t <= end;
        let mut times: Vec<f64> = switching_times.iter().copied().filter(inside).collect();
        times.sort_by(f64::total_cmp);
        let counts = switches
            .as_ref()
            .map_or(Counts::default(), |switches| switches.counts);
        Self {
            crossings: CrossingSearch::new(counts),
            expected: f64::NEG_INFINITY,
            start,
            changes: 0,
            last_change: f64::NEG_INFINITY,
            change_before: start,
            is_endless: false,
            times,
            end,
            switches: switches.map(|switches| {
                let search = SwitchSearch::new(switches.counts);
                (switches, search)
            }),
            pace: Rc::default(),
        }
    }

    /// Limits the step size so that no pulse of a function of time is stepped over.
    pub(super) fn with_pace(mut self, start: f64) -> Self {
        let Some((switches, _)) = &mut self.switches else {
            return self;
        };
        let (first, count) = (switches.counts.answers, switches.counts.shapes);
        if let Some(within) = switches.within.as_mut().filter(|_| count > 0) {
            let span = [start, self.end];
            let mut find = || {
                let mut all = vec![Enclosure::UNKNOWN; first + count];
                let mut known = None;
                Pace::new(span, count, |i, part| {
                    if known != Some(part) {
                        within(part, &mut all);
                        known = Some(part);
                    }
                    all[first + i]
                })
            };
            self.pace = match &switches.shared {
                Some(shared) => shared.pace(span, find),
                None => Rc::new(find()),
            };
        }
        self
    }

    /// The first known stop after `t`: a switching time or the end of the interval.
    pub(super) fn known_after(&self, t: f64) -> Stop {
        let next = self.times.partition_point(|&time| time <= t);
        self.times.get(next).map_or(
            Stop {
                t: self.end,
                last: self.end,
            },
            |&t| Stop::before(t),
        )
    }

    /// A step that begins just before this switch is to end just after it.
    pub(super) fn expect(&mut self, switch: f64) {
        self.expected = switch;
    }

    /// A step from `t` of length `h`, shortened to end at a stop.
    pub(super) fn stride(&mut self, t: f64, h: f64) -> Stride {
        let mut h = self.pace.longest(t, h);
        let near = sliver(self.expected);
        if t <= self.expected && self.expected - t <= near {
            h = h.min(self.expected - t + near);
        }
        let known = self.known_after(t);
        // The step is extended to a stop that it would nearly reach.
        let known = (t + 1.01 * h >= known.t).then_some(known);
        let t_new = known.map_or(t + h, |stop| stop.t);
        match self.change_within(t, t_new).or(known) {
            Some(stop) => Stride {
                h: stop.t - t,
                t_new: stop.t,
                last: stop.last,
                lands: true,
            },
            None => Stride {
                h,
                t_new,
                last: t_new,
                lands: false,
            },
        }
    }

    /// All times after the start at which a step has to end that do not depend on the state; nothing if there are too
    /// many.
    fn all(&mut self) -> Option<Vec<f64>> {
        let mut all = self.times.clone();
        let span = self.end - self.start;
        for part in 0..WINDOWS {
            let end = |part: u32| self.start + span * f64::from(part) / f64::from(WINDOWS);
            let (mut t, to) = (end(part), end(part + 1));
            while let Some(change) = self.change_within(t, to) {
                t = change.t;
                all.push(t);
                if all.len() > MOST_TIMES {
                    return None;
                }
            }
        }
        all.sort_by(f64::total_cmp);
        all.dedup();
        Some(all)
    }

    /// The end of the interval in s.
    pub(super) fn end(&self) -> f64 {
        self.end
    }

    /// Whether there are switching functions of the state.
    pub(super) fn has_crossings(&self) -> bool {
        self.crossings.has_crossings()
    }

    /// The first zero of a switching function of the state within a step, with the state there.
    pub(super) fn crossing(
        &mut self,
        ends: &Ends<'_>,
        dense: &DenseOutput,
    ) -> Option<(f64, &[f64])> {
        let (switches, _) = self.switches.as_mut()?;
        self.crossings.first(switches, ends, dense)
    }

    /// The longest step that does not step over a pulse along an interpolant.
    pub(super) fn longest(&mut self, span: [f64; 2], dense: &DenseOutput) -> f64 {
        match &mut self.switches {
            Some((switches, _)) => self.crossings.longest(switches, span, dense),
            None => span[1] - span[0],
        }
    }

    /// Whether there are functions of the state with pulses.
    pub(super) fn has_pulses(&self) -> bool {
        self.crossings.has_pulses()
    }

    /// The first switch by a function of time after `t` and not after `t_new`, to the last digit.
    fn change_within(&mut self, t: f64, t_new: f64) -> Option<Stop> {
        let (switches, search) = self.switches.as_mut()?;
        let change = search.of_time(switches, [t, t_new], self.end)?;
        if change > self.last_change {
            self.last_change = change;
            self.changes += 1;
            if self.changes.is_multiple_of(MANY_CHANGES) {
                let length = self.end - self.start;
                self.is_endless |= change - self.change_before < AT_ONE_PLACE * length;
                self.change_before = change;
            }
        }
        Some(Stop::before(change))
    }

    /// Whether switches by functions of time accumulate, so that the motion does not advance.
    pub(super) fn is_endless(&self) -> bool {
        self.is_endless
    }
}
