//! Observes the steps of a motion and records the kept quantities.

use std::cell::RefCell;
use std::ops::ControlFlow;

use appell_ensemble::study::{Keep, Kept};
use appell_runtime::inputs::ModelInputs;
use appell_runtime::integrate::{DenseOutput, Observer, Piece, Sought, Step, Walk};
use appell_runtime::model::{Along, At, Model};
use appell_runtime::real::Enclosure;

use super::layout::{Layout, Moment};
use super::noise::Noisy;
use super::spec::Quantity;

/// The kept quantities at a time and state, with a cache of the last evaluation.
pub(super) struct Gauge<'a> {
    model: &'a dyn Model,
    inputs: &'a ModelInputs<'a>,
    source: &'a Noisy<'a>,
    /// Parameters, with the noises of the time.
    p: Vec<f64>,
    kept: &'a [Quantity],
    u: Vec<f64>,
    outputs: Vec<f64>,
    t: f64,
    x: Vec<f64>,
    has_outputs: bool,
    has_inputs: bool,
    bounds: Bounds,
}

/// Bounds on the outputs over an interval of time.
#[derive(Default)]
struct Bounds {
    span: Option<[f64; 2]>,
    x: Vec<Enclosure>,
    u: Vec<Enclosure>,
    outputs: Vec<Enclosure>,
}

impl<'a> Gauge<'a> {
    pub(super) fn new(
        model: &'a dyn Model,
        inputs: &'a ModelInputs<'a>,
        source: &'a Noisy<'a>,
        p: &[f64],
        kept: &'a [Quantity],
    ) -> Self {
        let info = model.info();
        let has_outputs = kept.iter().any(|k| matches!(k, Quantity::Output(..)));
        let has_inputs = kept.iter().any(|k| matches!(k, Quantity::Input(_)));
        Self {
            model,
            inputs,
            source,
            p: p.to_vec(),
            kept,
            u: vec![0.0; info.input_len()],
            outputs: vec![0.0; info.output_len()],
            t: f64::NAN,
            x: Vec::new(),
            has_outputs,
            has_inputs,
            bounds: Bounds {
                u: vec![Enclosure::UNKNOWN; info.input_len()],
                outputs: vec![Enclosure::UNKNOWN; info.output_len()],
                ..Bounds::default()
            },
        }
    }

    /// Whether a kept quantity may vary within a piece of a step more than its sampled values show, unless its bounds
    /// exclude that.
    pub(super) fn hides(
        &mut self,
        keep: usize,
        piece: &Piece,
        start: f64,
        interior: &DenseOutput,
        is_known: impl FnOnce(&Enclosure) -> bool,
        size: f64,
    ) -> bool {
        let Quantity::Output(output, true) = self.kept[keep] else {
            return false;
        };
        let span = piece.span();
        let bounds = &mut self.bounds;
        if bounds.span != Some(span) {
            bounds.span = Some(span);
            self.source.parameters_at(start, &mut self.p);
            interior.within(span, &mut bounds.x);
            let along = Along {
                start,
                t: Enclosure::time(span[0], span[1]),
                x: &bounds.x,
                u: &[],
                p: &self.p,
            };
            self.inputs.bounds(&along, &mut bounds.u);
            let along = Along {
                u: &bounds.u,
                ..along
            };
            self.model.outputs_within(&along, &mut bounds.outputs);
        }
        let [least, most] = piece.ends();
        let of = &bounds.outputs[output];
        !is_known(of) && of.may_hide(most - least, span[1] - span[0], size)
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
                self.source.parameters_at(t, &mut self.p);
                let at = At {
                    t,
                    x,
                    u: &self.u,
                    p: &self.p,
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
            Quantity::Output(output, _) => self.outputs[output],
        }
    }
}

/// Error of a mean and of an extremum for each step, relative to the largest value of the quantity.
const TOLERANCE: f64 = 1e-7;

/// A quantity that is observed during the whole motion.
struct Followed {
    keep: usize,
    kept: Kept,
    /// The largest value so far, with the sign changed for a minimum, and its time; for a mean the integral.
    best: f64,
    when: f64,
    /// The value at the start, which is the mean of a motion without duration.
    first: f64,
    /// The largest absolute value so far.
    size: f64,
    /// Whether it was not finite at some time.
    is_undefined: bool,
}

impl Followed {
    /// Updates the largest value.
    fn raise(&mut self, t: f64, value: f64) {
        if value > self.best {
            (self.best, self.when) = (value, t);
        }
    }
}

/// Observes the steps.
pub(super) struct Keeper<'a> {
    gauge: &'a RefCell<Gauge<'a>>,
    moments: &'a [Moment],
    next: usize,
    followed: Vec<Followed>,
    start: f64,
    x: Vec<f64>,
    /// The longest interval over which quantities are approximated by polynomials.
    longest: f64,
    walk: Walk,
    /// Whether to continue, called at every step.
    go_on: &'a (dyn Fn() -> bool + Sync),
    /// The row; values at given times are written during the motion.
    pub(super) row: &'a mut [f64],
}

impl<'a> Keeper<'a> {
    pub(super) fn new(
        gauge: &'a RefCell<Gauge<'a>>,
        keep: &[Keep],
        layout: &'a Layout,
        row: &'a mut [f64],
        t: f64,
        x: &[f64],
        go_on: &'a (dyn Fn() -> bool + Sync),
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
                first: value,
                size: 0.0,
                is_undefined: !value.is_finite(),
            });
        }
        let mut keeper = Self {
            gauge,
            moments: &layout.moments,
            next: 0,
            followed,
            start: t,
            x: x.to_vec(),
            longest: layout.interval,
            walk: Walk::default(),
            go_on,
            row,
        };
        while keeper.moments.get(keeper.next).is_some_and(|m| m.t <= t) {
            keeper.record(t, x);
        }
        keeper
    }

    /// Writes the next value at a given time.
    fn record(&mut self, t: f64, x: &[f64]) {
        let moment = self.moments[self.next];
        self.row[moment.column] = self.gauge.borrow_mut().value(moment.keep, t, x);
        self.next += 1;
    }

    /// Writes the observed quantities at the final time; returns the row.
    pub(super) fn finish(self, layout: &Layout, t: f64) -> &'a mut [f64] {
        for followed in &self.followed {
            let column = layout.first[followed.keep];
            let duration = t - self.start;
            let [value, when] = match followed.kept {
                _ if followed.is_undefined => [f64::NAN; 2],
                Kept::Mean if duration > 0.0 => [followed.best / duration, t],
                Kept::Mean => [followed.first, t],
                Kept::Min => [-followed.best, followed.when],
                _ => [followed.best, followed.when],
            };
            self.row[column] = value;
            if followed.kept != Kept::Mean {
                self.row[column + 1] = when;
            }
        }
        self.row
    }

    fn follow(&mut self, step: &Step<'_>, interior: &DenseOutput) {
        // An input may jump at the end of the step.
        let span = [step.t_old, step.t.next_down()];
        let mut following = Following {
            step,
            interior,
            gauge: &mut self.gauge.borrow_mut(),
            x: &mut self.x,
            followed: &mut self.followed,
        };
        self.walk.walk(span, self.longest, &mut following);
    }
}

/// The observed quantities during a step.
struct Following<'f, 'g> {
    step: &'f Step<'f>,
    interior: &'f DenseOutput,
    gauge: &'f mut Gauge<'g>,
    x: &'f mut [f64],
    followed: &'f mut [Followed],
}

/// The state within a step, up to just before its end.
fn state<'x>(step: &Step<'x>, interior: &DenseOutput, x: &'x mut [f64], t: f64) -> &'x [f64] {
    if t <= step.t_old {
        step.x_old
    } else if t >= step.t.next_down() {
        step.x
    } else {
        interior.state(t, x);
        x
    }
}

impl Sought for Following<'_, '_> {
    fn count(&self) -> usize {
        self.followed.len()
    }

    fn evaluate(&mut self, t: f64, values: &mut [f64]) {
        let x = state(self.step, self.interior, self.x, t);
        for (followed, value) in self.followed.iter().zip(values) {
            *value = self.gauge.value(followed.keep, t, x);
        }
    }

    fn is_enough(&mut self, which: usize, piece: &Piece) -> bool {
        let followed = &self.followed[which];
        let (size, [least, most]) = (followed.size.max(piece.size()), piece.ends());
        let (spread, [from, to]) = (most - least, piece.span());
        // A non-finite value has neither mean nor extremum.
        if !piece.is_finite() {
            return true;
        }
        let is_enough = piece.is_resolved(size)
            || match followed.kept {
                Kept::Max => most + 2.0 * spread < followed.best,
                Kept::Min => 2.0 * spread - least < followed.best,
                _ => spread * (to - from) <= TOLERANCE * size * (self.step.t - self.step.t_old),
            };
        let (kept, best) = (followed.kept, followed.best);
        let is_known = |of: &Enclosure| match kept {
            Kept::Max => of.range().hi <= best,
            Kept::Min => -of.range().lo <= best,
            _ => false,
        };
        let (keep, start, interior) = (followed.keep, self.step.t_old, self.interior);
        is_enough && !(self.gauge).hides(keep, piece, start, interior, is_known, size)
    }

    fn see(&mut self, pieces: &[Piece]) {
        for (place, piece) in pieces.iter().enumerate() {
            let followed = &mut self.followed[place];
            followed.size = followed.size.max(piece.size());
            followed.is_undefined |= !piece.is_finite();
            let [from, to] = piece.span();
            let (sign, piece) = match followed.kept {
                Kept::Mean => {
                    followed.best += (to - from) * piece.mean();
                    continue;
                }
                Kept::Min => (-1.0, piece.negative()),
                _ => (1.0, *piece),
            };
            for (t, value) in piece.points() {
                followed.raise(t, value);
            }
            if let Some(t) = piece.top(followed.best) {
                let x = state(self.step, self.interior, self.x, t);
                followed.raise(t, sign * self.gauge.value(followed.keep, t, x));
            }
        }
    }
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
        if (self.go_on)() {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    }
}
