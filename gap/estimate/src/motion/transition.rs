//! One step of the classical Runge–Kutta method on z and on ∂z⁺/∂z together, and its adjoint.
//!
//! The transition matrix F is the derivative of the numerical step, not of the exact flow: filter
//! and gradient then belong to the same function of the values, whatever the step.

use super::command;
use super::plant::{Place, Plant, Scratch, Sums};
use super::timeline::Advance;
use crate::data::layout::Layout;
use crate::matrix::{
    add, add_scaled, dot, multiply, multiply_transposed, pieces, scale, set_identity,
    transposed_multiply,
};

/// Positions of the stages after the first, as fractions of the step.
pub(crate) const STAGES: [f64; 3] = [0.5, 0.5, 1.0];
/// Weights of the rates.
pub(crate) const WEIGHTS: [f64; 4] = [1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0];

/// Largest number of parts of a step.
pub(crate) const MOST_PARTS: u32 = 256;
/// Relative error of a rate, beyond that of a linear system, at which a step is halved; and the relative change of a rate
/// at which one with process noise is.
const UNEVEN: f64 = 0.1;
const FAST: f64 = 0.5;
/// Largest step relative to the shortest decay time: longer ones are unstable.
const STIFF: f64 = 2.3;

/// Numbers of a step for the adjoint, a part of a tape.
pub(crate) struct Stages<'a> {
    /// States of the four stages; the first is the state before the step.
    pub(crate) z: &'a mut [f64],
    /// Rates there.
    pub(crate) k: &'a mut [f64],
    /// ∂ż/∂z there.
    pub(crate) a: &'a mut [f64],
    /// Derivatives of the stages with respect to the state before the step; the first is the unit
    /// matrix.
    pub(crate) x: &'a mut [f64],
}

/// Position of a stage as a fraction of the step.
fn part(stage: usize) -> f64 {
    if stage == 0 { 0.0 } else { STAGES[stage - 1] }
}

/// Number of numbers for the stages of `n` states.
pub(crate) fn stages_len(n: usize) -> usize {
    8 * n + 8 * n * n
}

impl<'a> Stages<'a> {
    pub(crate) fn cut(tape: &'a mut [f64], n: usize) -> Self {
        let [z, k, a, x] = pieces(tape, [4 * n, 4 * n, 4 * n * n, 4 * n * n]);
        Self { z, k, a, x }
    }
}

/// Time, length, inputs and parameters of a step.
#[derive(Clone, Copy)]
pub(crate) struct Span<'a> {
    /// Its start, without a state.
    start: Place<'a>,
    h: f64,
}

impl<'a> Span<'a> {
    pub(crate) fn new(
        layout: Layout,
        values: &'a [f64],
        advance: Advance,
        held: &'a [f64],
    ) -> Self {
        Self {
            start: Place::new(layout, values, advance.t, &[], held),
            h: advance.h,
        }
    }

    /// The point of a stage.
    pub(crate) fn place(&self, stage: usize, z: &'a [f64]) -> Place<'a> {
        Place {
            t: self.start.t + part(stage) * self.h,
            z,
            ..self.start
        }
    }
}

/// Fills the stages from the state in the first one; writes z⁺ and F. Returns the number of equal parts in which the
/// step has to be taken instead, where the rates of the first `own` states have a kink, such as that of regularised dry
/// friction, or decay fast; 1 otherwise. Process noise, half of which enters before a step and half of it after, asks for
/// steps in which the rates change little.
pub(crate) fn step(
    plant: &Plant<'_>,
    span: Span<'_>,
    scratch: &mut Scratch,
    stages: &mut Stages<'_>,
    [after, f]: [&mut [f64]; 2],
    own: usize,
    is_disturbed: bool,
) -> u32 {
    let (n, h) = (plant.n, span.h);
    let nn = n * n;
    after.copy_from_slice(&stages.z[..n]);
    set_identity(f, n);
    set_identity(&mut stages.x[..nn], n);
    for i in 0..4 {
        let (z, k) = (
            &stages.z[i * n..(i + 1) * n],
            &mut stages.k[i * n..(i + 1) * n],
        );
        let a = &mut stages.a[i * nn..(i + 1) * nn];
        plant.jacobian(span.place(i, z), scratch, k, a);
        let stiff = decays(a, n, own, h);
        if stiff > 1 {
            return stiff;
        }
        add_scaled(h * WEIGHTS[i], k, after);
        let (x, next_x) = stages.x.split_at_mut((i + 1) * nn);
        let x = &x[i * nn..];
        if i == 3 {
            add_product(h * WEIGHTS[i], a, x, n, f);
            break;
        }
        let (first, next) = stages.z.split_at_mut((i + 1) * n);
        next[..n].copy_from_slice(&first[..n]);
        add_scaled(h * STAGES[i], k, &mut next[..n]);
        // K_i = A_i X_i, in the place of X_{i+1} = 1 + h c K_i.
        let next = &mut next_x[..nn];
        if i == 0 {
            next.copy_from_slice(a);
        } else {
            multiply(a, x, n, next);
        }
        add_scaled(h * WEIGHTS[i], next, f);
        let part = h * STAGES[i];
        for entry in next.iter_mut() {
            *entry *= part;
        }
        next.iter_mut()
            .step_by(n + 1)
            .for_each(|entry| *entry += 1.0);
    }
    let is_cut = is_uneven(stages.z, stages.k, &stages.a[..nn], own);
    1 + u32::from(is_cut || is_disturbed && change(stages.k, n, own))
}

/// Number of parts of a step that are shorter than the decay time of the first `own` states.
pub(crate) fn decays(a: &[f64], n: usize, own: usize, h: f64) -> u32 {
    // The trace of A² is the sum of the squares of the eigenvalues.
    let pairs = (0..own).flat_map(|i| (0..own).map(move |j| a[i * n + j] * a[j * n + i]));
    let fastest = pairs.sum::<f64>().abs().sqrt();
    // A small count.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let parts = (h * fastest / STIFF).ceil() as u32;
    parts.clamp(1, MOST_PARTS)
}

/// The parts into which a part of a step, one of `of`, is cut.
pub(crate) fn within(parts: u32, of: u32) -> u32 {
    parts.min(MOST_PARTS / of).max(2)
}

/// Increments of a step by a constant additional rate of each state, a column for each.
pub(crate) fn by_constant_rates(stages: &Stages<'_>, n: usize, h: f64, added: &mut [f64]) {
    let nn = n * n;
    added.fill(0.0);
    let (mut moved, mut k) = (vec![0.0; nn], vec![0.0; nn]);
    for (i, weight) in WEIGHTS.into_iter().enumerate() {
        multiply(&stages.a[i * nn..(i + 1) * nn], &moved, n, &mut k);
        k.iter_mut().step_by(n + 1).for_each(|entry| *entry += 1.0);
        add_scaled(h * weight, &k, added);
        if let Some(part) = STAGES.get(i) {
            std::mem::swap(&mut moved, &mut k);
            scale(part * h, &mut moved);
        }
    }
}

/// Increment of a step by an additional rate of one state, given at each stage.
pub(crate) fn added_by_rate(
    stages: &Stages<'_>,
    n: usize,
    h: f64,
    along: usize,
    rates: [f64; 4],
) -> Vec<f64> {
    let (mut added, mut moved) = (vec![0.0; n], vec![0.0; n]);
    for (i, rate) in rates.into_iter().enumerate() {
        let a = &stages.a[i * n * n..(i + 1) * n * n];
        let mut k: Vec<f64> = a.chunks_exact(n).map(|row| dot(row, &moved)).collect();
        k[along] += rate;
        add_scaled(h * WEIGHTS[i], &k, &mut added);
        if let Some(part) = STAGES.get(i) {
            moved = k.iter().map(|k| part * h * k).collect();
        }
    }
    added
}

/// Whether the rates of the first `own` states at the stages are far from those of a linear system, however fast it is,
/// with the slopes of the first stage and an input that grows with time.
pub(crate) fn is_uneven(z: &[f64], k: &[f64], slopes: &[f64], own: usize) -> bool {
    let n = z.len() / WEIGHTS.len();
    differ(k, n, own, UNEVEN, |stage, i| {
        let row = &slopes[i * n..(i + 1) * n];
        let moved = (0..n).map(|j| row[j] * (z[stage * n + j] - z[j]));
        k[i] + moved.sum::<f64>()
    })
}

/// Whether the rates of the first `own` states change by more than a part between the stages.
fn change(k: &[f64], n: usize, own: usize) -> bool {
    differ(k, n, own, FAST, |_, i| k[i])
}

/// Whether rates at the stages differ from expected ones and a part that grows with time by more than a part of them.
fn differ(
    k: &[f64],
    n: usize,
    own: usize,
    part: f64,
    expected: impl Fn(usize, usize) -> f64,
) -> bool {
    (0..own).any(|i| {
        let [second, third, last] = [1, 2, 3].map(|stage| k[stage * n + i] - expected(stage, i));
        let odds = (last - third - second).abs() + (third - second).abs();
        let most = k.iter().skip(i).step_by(n).map(|rate| rate.abs());
        odds > part * most.fold(0.0, f64::max)
    })
}

/// `c += factor a b`
fn add_product(factor: f64, a: &[f64], b: &[f64], n: usize, c: &mut [f64]) {
    let rows = b.chunks_exact(n);
    for (a, c) in a.chunks_exact(n).zip(c.chunks_exact_mut(n)) {
        for (&entry, b) in a.iter().zip(rows.clone()) {
            if entry != 0.0 {
                add_scaled(factor * entry, b, c);
            }
        }
    }
}

/// Work arrays of the reverse sweep.
#[derive(Debug, Clone)]
pub(crate) struct Reverse {
    k: Vec<f64>,
    kk: Vec<f64>,
    a: Vec<f64>,
    x: Vec<f64>,
    product: Vec<f64>,
    no_mass: Vec<f64>,
    /// Of the stage.
    sums: Sums,
}

impl Reverse {
    pub(crate) fn new(plant: &Plant<'_>) -> Self {
        let (n, zeros) = (plant.n, |len| vec![0.0; len]);
        Self {
            k: zeros(n),
            kk: zeros(n * n),
            a: zeros(n * n),
            x: zeros(n * n),
            product: zeros(n * n),
            no_mass: zeros(plant.speeds * plant.speeds),
            sums: Sums::zeros(plant),
        }
    }
}

/// Gradients of a scalar: `after` with respect to z⁺, `f` to F, `mass` to the mass matrix before
/// the step.
#[derive(Clone, Copy)]
pub(crate) struct Effects<'a> {
    pub(crate) after: &'a [f64],
    pub(crate) f: &'a [f64],
    pub(crate) mass: &'a [f64],
    /// Whether the derivatives with respect to the ends of the step are computed.
    pub(crate) by_ends: bool,
}

/// Derivatives with respect to the start of a step and to its length; zero if they are not computed.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct ByEnds {
    pub(crate) start: f64,
    pub(crate) length: f64,
}

/// The gradient of that scalar: added to `sums`, where `sums.z` is that of the state before the
/// step and `sums.u` that of delays of the declared inputs.
pub(crate) fn adjoint(
    plant: &Plant<'_>,
    span: Span<'_>,
    scratch: &mut Scratch,
    stages: &Stages<'_>,
    effects: Effects<'_>,
    back: &mut Reverse,
    sums: &mut Sums,
) -> ByEnds {
    let (n, h) = (plant.n, span.h);
    let nn = n * n;
    let mut by = ByEnds::default();
    add(effects.after, &mut sums.z);
    // Stages add to the same sums, but for states and inputs.
    std::mem::swap(&mut back.sums.p, &mut sums.p);
    std::mem::swap(&mut back.sums.lags, &mut sums.lags);
    for i in (0..4).rev() {
        let (z, k) = (&stages.z[i * n..(i + 1) * n], &stages.k[i * n..(i + 1) * n]);
        let a = &stages.a[i * nn..(i + 1) * nn];
        let x = &stages.x[i * nn..(i + 1) * nn];
        // z⁺ and F hold the rates of this stage; so does the next stage, whose gradients are in
        // `back.sums.z` and `back.x`.
        back.k.fill(0.0);
        back.kk.fill(0.0);
        if i < 3 {
            add_scaled(h * STAGES[i], &back.sums.z, &mut back.k);
            add_scaled(h * STAGES[i], &back.x, &mut back.kk);
        }
        if effects.by_ends {
            multiply(a, x, n, &mut back.product);
            by.length += WEIGHTS[i] * (dot(effects.after, k) + dot(effects.f, &back.product));
            if i < 3 {
                by.length += STAGES[i] * (dot(&back.sums.z, k) + dot(&back.x, &back.product));
            }
        }
        add_scaled(h * WEIGHTS[i], effects.after, &mut back.k);
        add_scaled(h * WEIGHTS[i], effects.f, &mut back.kk);
        let mass = if i == 0 {
            back.a.copy_from_slice(&back.kk);
            effects.mass
        } else {
            multiply_transposed(&back.kk, x, n, &mut back.a);
            transposed_multiply(a, &back.kk, n, &mut back.x);
            &back.no_mass
        };
        back.sums.z.fill(0.0);
        back.sums.u.fill(0.0);
        let weights = [back.k.as_slice(), &back.a, mass];
        let place = span.place(i, z);
        plant.adjoint(place, scratch, weights, &mut back.sums);
        add(&back.sums.z, &mut sums.z);
        let later = sums.u.iter_mut().zip(&back.sums.u).enumerate();
        for (input, (later, by)) in later {
            *later -= by * command::slope(place.held, input, place.t);
        }
        if effects.by_ends {
            let by_t = command::by_time(place.held, &back.sums.u, place.t);
            by.start += by_t;
            by.length += part(i) * by_t;
        }
    }
    std::mem::swap(&mut back.sums.p, &mut sums.p);
    std::mem::swap(&mut back.sums.lags, &mut sums.lags);
    by
}
