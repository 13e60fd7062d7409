//! Times at which a step has to end: the rates jump or lose smoothness there.

/// Values that are constant between times which are not known in advance, such as the truth of
/// `sin(w*t) < 0`.
///
/// The integrators look for changes at eighths of a step and end the step at the first of them;
/// what changes and changes back between is not seen.
pub struct Switches<'a> {
    /// Number of values.
    pub count: usize,
    /// Writes the values at a time in s.
    pub function: SwitchFunction<'a>,
}

/// Values at a time, boxed.
pub type SwitchFunction<'a> = Box<dyn FnMut(f64, &mut [f64]) + 'a>;

impl std::fmt::Debug for Switches<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("Switches")
            .field("count", &self.count)
            .finish_non_exhaustive()
    }
}

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
        Self {
            h: 0.0,
            t_new: t,
            last: t,
            lands: false,
        }
    }

    /// The time from its start `t` to the last time before a stop: what changes at the stop does so after the step.
    pub(super) fn up_to_stop(&self, t: f64) -> f64 {
        if self.lands { self.last - t } else { self.h }
    }
}

/// Parts of a step between which changes are sought.
const PARTS: u8 = 8;

/// All times at which steps have to end.
pub(super) struct Stops<'w, 'a> {
    /// The known ones after the start, increasing.
    times: Vec<f64>,
    end: f64,
    switches: Option<&'w mut Switches<'a>>,
    before: Vec<f64>,
    after: Vec<f64>,
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
        let count = switches.as_ref().map_or(0, |switches| switches.count);
        Self {
            times,
            end,
            switches,
            before: vec![0.0; count],
            after: vec![0.0; count],
        }
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

    /// The first change of the switches after `t` and not after `t_new`, to the last digit.
    fn change_within(&mut self, t: f64, t_new: f64) -> Option<Stop> {
        let switches = self.switches.as_deref_mut()?;
        let (before, after) = (&mut self.before, &mut self.after);
        (switches.function)(t, before);
        let mut changed = |s: f64| {
            (switches.function)(s, after);
            let bits = |value: &f64| value.to_bits();
            !before.iter().map(bits).eq(after.iter().map(bits))
        };
        let part = |i: u8| match i {
            PARTS => t_new,
            _ => t + (t_new - t) * (f64::from(i) / f64::from(PARTS)),
        };
        let first = (1..=PARTS).find(|&i| changed(part(i)))?;
        // Halving until no number lies between.
        let (mut same, mut other) = (part(first - 1), part(first));
        loop {
            let middle = same + (other - same) / 2.0;
            if middle <= same || middle >= other {
                return Some(Stop::before(other));
            }
            let end = if changed(middle) {
                &mut other
            } else {
                &mut same
            };
            *end = middle;
        }
    }
}
