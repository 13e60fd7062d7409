//! The order of steps, changes of inputs and samples along a recording.

use crate::data::layout::Layout;
use crate::data::recording::{Recording, Row};
use crate::data::setup::Setup;

/// An action of the filter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Action {
    /// A step of the motion.
    Advance(Advance),
    /// One delayed input, or all others, take the values of a row.
    Switch { row: Row, input: Option<usize> },
    /// One delayed channel, or all others, were sampled for a row.
    Measure { row: usize, channel: Option<usize> },
}

impl Action {
    /// The time in s of the state after it.
    pub(crate) fn end(self, recording: &Recording) -> f64 {
        match self {
            Self::Advance(advance) => advance.t + advance.h,
            Self::Switch { row, .. } => recording.time_of(row),
            Self::Measure { row, .. } => recording.times()[row],
        }
    }
}

/// A step of the integration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Advance {
    /// Its start in s.
    pub(crate) t: f64,
    /// Its length in s; zero where a delay moves one of its ends only.
    pub(crate) h: f64,
    /// Values that move the ends of the interval which the step is a part of.
    pub(crate) moved_by: [Option<Moved>; 2],
}

/// The effect of a delay on a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Moved {
    /// Place of the delay.
    pub(crate) delay: usize,
    /// Derivative of the start of the step.
    pub(crate) start: f64,
    /// Derivative of its length.
    pub(crate) length: f64,
}

impl Advance {
    /// Cut into equal parts.
    pub(crate) fn parts(self, count: u32) -> impl Iterator<Item = Self> {
        let part = f64::from(count).recip();
        let h = part * self.h;
        (0..count).map(move |i| Self {
            t: self.t + f64::from(i) * h,
            h,
            moved_by: self.moved_by.map(|end| {
                end.map(|own| Moved {
                    start: own.start + f64::from(i) * part * own.length,
                    length: part * own.length,
                    ..own
                })
            }),
        })
    }
}

/// A moment between two steps.
struct Stop {
    t: f64,
    /// The delay that moves it, and in which direction.
    moved_by: Option<(usize, f64)>,
    action: Option<Action>,
}

/// All actions of a run. At equal times inputs change before measurements are taken.
pub(crate) fn timeline(
    setup: &Setup<'_>,
    layout: &Layout,
    recording: &Recording,
    knots: &[f64],
    values: &[f64],
) -> Vec<Action> {
    let stops = stops(setup, layout, recording, knots, values);
    let lags = &values[layout.lag(0)..layout.input_delay(0)];
    let shortest_lag = lags.iter().copied().fold(f64::INFINITY, f64::min);
    let longest = [setup.longest_step, shortest_lag];
    let mut actions = Vec::with_capacity(3 * stops.len());
    let mut last = (recording.times()[0], None);
    for stop in stops {
        advance(&mut actions, longest, last, (stop.t, stop.moved_by));
        actions.extend(stop.action);
        last = (stop.t, stop.moved_by);
    }
    // Actions after the last sample have no effect.
    while !matches!(actions.last(), Some(Action::Measure { .. }) | None) {
        actions.pop();
    }
    actions
}

fn stops(
    setup: &Setup<'_>,
    layout: &Layout,
    recording: &Recording,
    knots: &[f64],
    values: &[f64],
) -> Vec<Stop> {
    let times = recording.times();
    let (start, end) = (times[0], times[times.len() - 1]);
    let is_delayed = |input: usize| setup.delayed.contains(&input);
    let mut stops = Vec::with_capacity(2 * times.len());
    arrivals(setup, layout, recording, values, &mut stops);
    let mut before: Option<&[f64]> = None;
    for (row, &t) in times.iter().enumerate() {
        let now = recording.inputs(row);
        let is_other = |input: usize, last: &[f64]| last[input].to_bits() != now[input].to_bits();
        let changes = |input: usize| {
            recording.is_joined(input) || before.is_none_or(|last| is_other(input, last))
        };
        if (0..now.len()).any(|input| !is_delayed(input) && changes(input)) || row == 0 {
            stops.push(Stop {
                t,
                moved_by: None,
                action: Some(Action::Switch {
                    row: Row::Own(row),
                    input: None,
                }),
            });
        }
        for (index, &input) in setup.delayed.iter().enumerate() {
            let arrives = row > 0 || recording.is_joined(input) || recording.earlier_len() > 0;
            if changes(input) && arrives {
                let delay = layout.input_delay(index);
                let input = Some(input);
                stops.push(Stop {
                    t: t + values[delay],
                    moved_by: Some((delay, 1.0)),
                    action: Some(Action::Switch {
                        row: Row::Own(row),
                        input,
                    }),
                });
            }
        }
        stops.push(Stop {
            t,
            moved_by: None,
            action: Some(Action::Measure { row, channel: None }),
        });
        for (index, channel) in setup.channels.iter().enumerate() {
            let Some(longest) = channel.longest_delay else {
                continue;
            };
            if t >= start + longest && !recording.measured(row)[index].is_nan() {
                let delay = layout.sensor_delay(index);
                let channel = Some(index);
                stops.push(Stop {
                    t: t - values[delay],
                    moved_by: Some((delay, -1.0)),
                    action: Some(Action::Measure { row, channel }),
                });
            }
        }
        before = Some(now);
    }
    let inside = knots.iter().filter(|&&t| start < t && t < end);
    stops.extend(inside.map(|&t| Stop {
        t,
        moved_by: None,
        action: None,
    }));
    // Stable: actions at equal times keep their order.
    stops.sort_by(|a, b| a.t.total_cmp(&b.t));
    stops
}

/// Changes of delayed inputs before the recording that arrive during it.
fn arrivals(
    setup: &Setup<'_>,
    layout: &Layout,
    recording: &Recording,
    values: &[f64],
    stops: &mut Vec<Stop>,
) {
    for (index, &input) in setup.delayed.iter().enumerate() {
        let delay = layout.input_delay(index);
        for earlier in 0..recording.earlier_len() {
            let t = recording.time_of(Row::Earlier(earlier)) + values[delay];
            if t > recording.times()[0] {
                stops.push(Stop {
                    t,
                    moved_by: Some((delay, 1.0)),
                    action: Some(Action::Switch {
                        row: Row::Earlier(earlier),
                        input: Some(input),
                    }),
                });
            }
        }
    }
}

type End = (f64, Option<(usize, f64)>);

/// The steps between two moments. None is longer than `longest` or the shortest lag, whose response
/// to a change of its input is then accurate to a percent; a lag shortens steps to 1/32 at most.
fn advance(
    actions: &mut Vec<Action>,
    [longest, shortest_lag]: [f64; 2],
    (a, moves_a): End,
    (b, moves_b): End,
) {
    const SHORTEST: f64 = 1.0 / 32.0;
    let length = b - a;
    if length <= 0.0 && moves_a == moves_b {
        return;
    }
    let whole = length.min(longest);
    let step = whole.min(shortest_lag.max(SHORTEST * whole));
    let count = (length / step).ceil().max(1.0);
    let (h, part) = (length / count, 1.0 / count);
    let mut step = 0.0;
    while step < count {
        let moved = |(delay, sign): (usize, f64), start: f64, length: f64| Moved {
            delay,
            start: sign * start,
            length: sign * length,
        };
        actions.push(Action::Advance(Advance {
            t: a + step * h,
            h,
            moved_by: [
                moves_a.map(|end| moved(end, 1.0 - step * part, -part)),
                moves_b.map(|end| moved(end, step * part, part)),
            ],
        }));
        step += 1.0;
    }
}
