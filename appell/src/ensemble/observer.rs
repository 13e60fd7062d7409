//! Sees the steps of a motion and keeps what a study wants.

use std::cell::RefCell;
use std::ops::ControlFlow;

use appell_ensemble::study::{Keep, Kept};
use appell_runtime::inputs::ModelInputs;
use appell_runtime::integrate::{DenseOutput, Observer, Step};
use appell_runtime::model::{At, Model};

use super::layout::{Layout, Moment};
use super::spec::Quantity;

/// The kept quantities at a time and state, of which the last ones are remembered.
pub(super) struct Gauge<'a> {
    model: &'a dyn Model,
    inputs: &'a ModelInputs<'a>,
    p: &'a [f64],
    kept: &'a [Quantity],
    u: Vec<f64>,
    outputs: Vec<f64>,
    t: f64,
    x: Vec<f64>,
    has_outputs: bool,
    has_inputs: bool,
}

impl<'a> Gauge<'a> {
    pub(super) fn new(
        model: &'a dyn Model,
        inputs: &'a ModelInputs<'a>,
        p: &'a [f64],
        kept: &'a [Quantity],
    ) -> Self {
        let info = model.info();
        let has_outputs = kept.iter().any(|k| matches!(k, Quantity::Output(_)));
        let has_inputs = kept.iter().any(|k| matches!(k, Quantity::Input(_)));
        Self {
            model,
            inputs,
            p,
            kept,
            u: vec![0.0; info.input_len()],
            outputs: vec![0.0; info.output_len()],
            t: f64::NAN,
            x: Vec::new(),
            has_outputs,
            has_inputs,
        }
    }

    /// A kept quantity.
    pub(super) fn value(&mut self, keep: usize, t: f64, x: &[f64]) -> f64 {
        if let Quantity::State(state) = self.kept[keep] {
            return x[state];
        }
        if self.t.to_bits() != t.to_bits() || self.x != x {
            if self.has_outputs || self.has_inputs {
                self.inputs.fill(t, x, &mut self.u);
            }
            if self.has_outputs {
                let at = At {
                    t,
                    x,
                    u: &self.u,
                    p: self.p,
                };
                self.model.outputs(at, &mut self.outputs);
            }
            self.t = t;
            self.x.clear();
            self.x.extend_from_slice(x);
        }
        match self.kept[keep] {
            Quantity::State(state) => x[state],
            Quantity::Input(input) => self.u[input],
            Quantity::Output(output) => self.outputs[output],
        }
    }
}

/// Parts of a step between which extrema are sought and means taken.
const PARTS: usize = 4;
/// Weights of Boole's rule for the mean over them.
const WEIGHTS: [f64; PARTS + 1] = [
    7.0 / 90.0,
    32.0 / 90.0,
    12.0 / 90.0,
    32.0 / 90.0,
    7.0 / 90.0,
];

/// A quantity that is followed all the time.
struct Followed {
    keep: usize,
    kept: Kept,
    /// The best value so far, counted so that larger is better, and its time; of a mean the integral.
    best: f64,
    when: f64,
    /// Values at the parts of the present step.
    values: [f64; PARTS + 1],
}

/// Sees the steps.
pub(super) struct Keeper<'a> {
    gauge: &'a RefCell<Gauge<'a>>,
    moments: &'a [Moment],
    next: usize,
    followed: Vec<Followed>,
    start: f64,
    x: Vec<f64>,
    /// The row, whose columns of moments are written on the way.
    pub(super) row: &'a mut [f64],
}

impl<'a> Keeper<'a> {
    pub(super) fn new(
        gauge: &'a RefCell<Gauge<'a>>,
        keep: &[Keep],
        layout: &'a Layout,
        row: &'a mut [f64],
        (t, x): (f64, &[f64]),
    ) -> Self {
        let mut followed = Vec::new();
        for (index, keep) in keep.iter().enumerate() {
            if !matches!(keep.kept, Kept::Max | Kept::Min | Kept::Mean) {
                continue;
            }
            let value = gauge.borrow_mut().value(index, t, x);
            let best = match keep.kept {
                Kept::Max => value,
                Kept::Min => -value,
                _ => 0.0,
            };
            followed.push(Followed {
                keep: index,
                kept: keep.kept,
                best,
                when: t,
                values: [value; PARTS + 1],
            });
        }
        let mut keeper = Self {
            gauge,
            moments: &layout.moments,
            next: 0,
            followed,
            start: t,
            x: x.to_vec(),
            row,
        };
        while keeper.moments.get(keeper.next).is_some_and(|m| m.t <= t) {
            keeper.record(t, x);
        }
        keeper
    }

    /// Writes the next moment.
    fn record(&mut self, t: f64, x: &[f64]) {
        let moment = self.moments[self.next];
        self.row[moment.column] = self.gauge.borrow_mut().value(moment.keep, t, x);
        self.next += 1;
    }

    /// Writes what was followed up to a time; returns the row.
    pub(super) fn finish(self, layout: &Layout, t: f64) -> &'a mut [f64] {
        for followed in &self.followed {
            let column = layout.first[followed.keep];
            let sign = match followed.kept {
                Kept::Min => -1.0,
                _ => 1.0,
            };
            if followed.kept == Kept::Mean {
                let duration = t - self.start;
                let constant = followed.values[PARTS];
                self.row[column] = if duration > 0.0 {
                    followed.best / duration
                } else {
                    constant
                };
            } else {
                self.row[column] = sign * followed.best;
                self.row[column + 1] = followed.when;
            }
        }
        self.row
    }

    fn follow(&mut self, step: &Step<'_>, interior: &DenseOutput) {
        let time = |part: usize| match part {
            0 => step.t_old,
            PARTS => step.t,
            part => step.t_old + (step.t - step.t_old) * (part as f64 / PARTS as f64),
        };
        let mut gauge = self.gauge.borrow_mut();
        for part in 0..=PARTS {
            let t = time(part);
            let x = match part {
                // An input may jump where the last step ended.
                0 => step.x_old,
                PARTS => step.x,
                _ => {
                    interior.state(t, &mut self.x);
                    &self.x
                }
            };
            for followed in &mut self.followed {
                followed.values[part] = gauge.value(followed.keep, t, x);
            }
        }
        for followed in &mut self.followed {
            if followed.kept == Kept::Mean {
                let mean: f64 = WEIGHTS
                    .iter()
                    .zip(followed.values)
                    .map(|(w, v)| w * v)
                    .sum();
                followed.best += (step.t - step.t_old) * mean;
                continue;
            }
            let sign = if followed.kept == Kept::Min {
                -1.0
            } else {
                1.0
            };
            let values = followed.values.map(|value| sign * value);
            let (part, largest) = largest(&values);
            if largest > followed.best {
                (followed.best, followed.when) = (largest, time(part));
            }
            let Some([from, to]) = bracket(&values, part).filter(|_| {
                // A parabola rises above its largest sample by less than the samples differ.
                let low = values.iter().copied().fold(f64::INFINITY, f64::min);
                largest + (largest - low) > followed.best
            }) else {
                continue;
            };
            let keep = followed.keep;
            let x = &mut self.x;
            let place = |s: f64| step.t_old + (step.t - step.t_old) * s;
            let found = maximum([from, to], |s| {
                let t = place(s);
                interior.state(t, x);
                sign * gauge.value(keep, t, x)
            });
            if found.1 > followed.best {
                (followed.best, followed.when) = (found.1, place(found.0));
            }
        }
    }
}

fn largest(values: &[f64]) -> (usize, f64) {
    let mut best = (0, values[0]);
    for (part, &value) in values.iter().enumerate() {
        if value > best.1 {
            best = (part, value);
        }
    }
    best
}

/// The part of a step, 0 to 1, in which the largest value lies if that is between samples.
fn bracket(values: &[f64; PARTS + 1], part: usize) -> Option<[f64; 2]> {
    let ends = |from: usize, to: usize| Some([from, to].map(|k| k as f64 / PARTS as f64));
    match part {
        // The parabola through the last three samples turns before the end.
        PARTS => (3.0 * values[PARTS] + values[PARTS - 2] < 4.0 * values[PARTS - 1])
            .then(|| ends(PARTS - 1, PARTS))
            .flatten(),
        0 => (3.0 * values[0] + values[2] < 4.0 * values[1])
            .then(|| ends(0, 1))
            .flatten(),
        part => ends(part - 1, part + 1),
    }
}

/// Section ratio, and sections after which the top is found to rounding of the value.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
const SECTIONS: usize = 30;

/// Place and value of the largest value in an interval with one top, by golden sections with a last parabola.
fn maximum([mut from, mut to]: [f64; 2], mut f: impl FnMut(f64) -> f64) -> (f64, f64) {
    let (mut a, mut b) = (to - GOLDEN * (to - from), from + GOLDEN * (to - from));
    let (mut at_a, mut at_b) = (f(a), f(b));
    for _ in 0..SECTIONS {
        if at_a > at_b {
            (to, b, at_b) = (b, a, at_a);
            a = to - GOLDEN * (to - from);
            at_a = f(a);
        } else {
            (from, a, at_a) = (a, b, at_b);
            b = from + GOLDEN * (to - from);
            at_b = f(b);
        }
    }
    if at_a > at_b { (a, at_a) } else { (b, at_b) }
}

impl Observer for Keeper<'_> {
    fn wants_interior(&self, _: f64, t: f64) -> bool {
        let between = self.moments.get(self.next).is_some_and(|m| m.t < t);
        between || !self.followed.is_empty()
    }

    fn step(&mut self, step: &Step<'_>) -> ControlFlow<()> {
        if let (Some(interior), false) = (step.interior, self.followed.is_empty()) {
            self.follow(step, interior);
        }
        while let Some(moment) = self.moments.get(self.next).filter(|m| m.t <= step.t) {
            let t = moment.t;
            match step.interior {
                Some(interior) if t < step.t => {
                    let mut x = std::mem::take(&mut self.x);
                    interior.state(t, &mut x);
                    self.record(t, &x);
                    self.x = x;
                }
                _ => self.record(t, step.x),
            }
        }
        ControlFlow::Continue(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_top_of_a_curve_is_found_between_samples() {
        let (place, value) = maximum([0.2, 0.6], |s| -(s - 0.37_f64).powi(2) + 2.0);
        assert!((place - 0.37).abs() < 1e-6, "{place}");
        assert!((value - 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_rising_step_has_no_top_inside() {
        assert_eq!(bracket(&[0.0, 1.0, 2.0, 3.0, 4.0], 4), None);
        assert_eq!(bracket(&[0.0, 2.0, 3.0, 3.5, 3.51], 4), Some([0.75, 1.0]));
    }
}
