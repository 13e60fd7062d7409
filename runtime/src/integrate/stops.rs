//! Times at which a step has to end: the rates jump or lose smoothness there.

use super::pace::Pace;
use super::switches::{SwitchSearch, Switches};
use crate::real::Enclosure;

/// Where a step has to end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stop {
    /// When, in s.
    pub(super) t: f64,
    /// The latest time at which rates on the way are evaluated: just before a switching time.
    pub(super) last: f64,
}

impl Stop {
    fn before(t: f64) -> Self {
        let last = t.next_down();
        Self { t, last }
    }
}

/// A step to be tried.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stride {
    /// Its length in s.
    pub(super) h: f64,
    /// Where it ends, in s.
    pub(super) t_new: f64,
    /// See [`Stop::last`].
    pub(super) last: f64,
    /// Whether it ends at a stop, after which the rates may be others.
    pub(super) lands: bool,
}

impl Stride {
    /// No step at all.
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

    /// The time from its start `t` to the last time before a stop: what changes at the stop does so after the step.
    pub(super) fn up_to_stop(&self, t: f64) -> f64 {
        if self.lands { self.last - t } else { self.h }
    }
}

/// All times at which steps have to end.
pub(super) struct Stops<'w, 'a> {
    /// The known ones after the start, increasing.
    times: Vec<f64>,
    end: f64,
    pub(super) switches: Option<(&'w mut Switches<'a>, SwitchSearch)>,
    pace: Pace,
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
        Self {
            times,
            end,
            switches: switches.map(|switches| {
                let search = SwitchSearch::new(switches.counts);
                (switches, search)
            }),
            pace: Pace::default(),
        }
    }

    /// Lets no step pass over what functions of time do.
    pub(super) fn with_pace(mut self, start: f64) -> Self {
        let Some((switches, _)) = &mut self.switches else {
            return self;
        };
        let (first, count) = (switches.counts.answers, switches.counts.shapes);
        if let Some(within) = switches.within.as_mut().filter(|_| count > 0) {
            let mut all = vec![Enclosure::UNKNOWN; first + count];
            let mut known = None;
            self.pace = Pace::new([start, self.end], count, |i, part| {
                if known != Some(part) {
                    within(part, &mut all);
                    known = Some(part);
                }
                all[first + i]
            });
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

    /// A step from `t` of length `h`, or less where there is a stop before.
    pub(super) fn stride(&mut self, t: f64, h: f64) -> Stride {
        let h = self.pace.longest(t, h);
        let known = self.known_after(t);
        // The step ends at the stop rather than a sliver before it.
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

    /// The end of the interval in s.
    pub(super) fn end(&self) -> f64 {
        self.end
    }

    /// Whether the state switches the equations.
    pub(super) fn has_crossings(&self) -> bool {
        let switches = self.switches.as_ref();
        switches.is_some_and(|(_, search)| search.has_crossings())
    }

    /// Leaves switches by the state to whoever finds them otherwise.
    pub(super) fn ignore_crossings(&mut self) {
        if let Some((_, search)) = &mut self.switches {
            search.ignore_crossings();
        }
    }

    /// The first change of the switches after `t` and not after `t_new`, to the last digit.
    fn change_within(&mut self, t: f64, t_new: f64) -> Option<Stop> {
        let (switches, search) = self.switches.as_mut()?;
        search.of_time(switches, [t, t_new]).map(Stop::before)
    }
}
