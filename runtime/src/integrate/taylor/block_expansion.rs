//! The coefficients of a step of eight motions.

// What is not inlined is not compiled for the vectors of the processor.
#![allow(clippy::inline_always)]

use super::products::Products;
use crate::integrate::block_stages::Block;
use crate::lanes::{AtLanes, LANES, dispatch};
use crate::series::{Cubic, OrderNumber, SeriesInLanes, Shape};

/// Work arrays of an expansion. Coefficients of one order follow each other.
#[derive(Debug, Clone, Default)]
pub(super) struct BlockExpansion {
    /// States at the start of the step, and their rates.
    pub(super) x: Vec<Block>,
    pub(super) rates: Vec<Block>,
    /// The same where order zero was last computed.
    pub(super) x_new: Vec<Block>,
    pub(super) rates_new: Vec<Block>,
    p: Vec<Block>,
    kept: Vec<Block>,
    kept_new: Vec<Block>,
    /// Inputs as polynomials, one power after the other.
    inputs: Vec<Block>,
    inputs_new: Vec<Block>,
    /// Inputs at each order, then the numbers of the order.
    orders: Vec<Block>,
    coefficients: Vec<Block>,
    products: Products,
    pub(super) guards_new: Vec<Block>,
    /// Coefficients of the guards by order.
    pub(super) guards: Vec<Block>,
    /// Coefficients beyond the highest order.
    beyond: Vec<Block>,
    order: usize,
}

/// Powers of an input.
const POWERS: usize = 4;

impl BlockExpansion {
    /// Sizes the arrays for expansions up to an order.
    pub(super) fn prepare(&mut self, shape: &Shape, order: usize) {
        let guards = shape.guards.len();
        let width = shape.inputs + OrderNumber::COUNT;
        for (blocks, count) in [
            (&mut self.x, shape.states),
            (&mut self.rates, shape.states),
            (&mut self.x_new, shape.states),
            (&mut self.rates_new, shape.states),
            (&mut self.p, shape.parameters),
            (&mut self.kept, shape.kept),
            (&mut self.kept_new, shape.kept),
            (&mut self.inputs, POWERS * shape.inputs),
            (&mut self.inputs_new, POWERS * shape.inputs),
            (&mut self.orders, width * (order + 1)),
            (&mut self.coefficients, shape.states * (order + 1)),
            (&mut self.guards_new, guards),
            (&mut self.guards, guards * (order + 1)),
            (&mut self.beyond, shape.states),
        ] {
            blocks.clear();
            blocks.resize(count, [0.0; LANES]);
        }
        for (k, numbers) in self.orders.chunks_exact_mut(width).enumerate() {
            for (number, of_order) in numbers[shape.inputs..].iter_mut().zip(OrderNumber::all(k)) {
                *number = [of_order; LANES];
            }
        }
        self.products.prepare(shape.products * LANES, order);
        self.order = order;
    }

    /// The highest order.
    pub(super) fn order(&self) -> usize {
        self.order
    }

    /// The orders by which steps are measured.
    pub(super) fn last_orders(&self) -> [usize; 2] {
        [self.order - 1, self.order]
    }

    /// All coefficients of the states.
    pub(super) fn coefficients(&self) -> &[Block] {
        &self.coefficients
    }

    /// Coefficients of an order.
    pub(super) fn terms(&self, order: usize) -> &[Block] {
        let n = self.x.len();
        &self.coefficients[order * n..][..n]
    }

    /// A motion begins in a lane.
    pub(super) fn begin(&mut self, lane: usize, x: &[f64], p: &[f64]) {
        let blocks = self.x.iter_mut().chain(&mut self.p);
        for (block, number) in blocks.zip(x.iter().chain(p)) {
            block[lane] = *number;
        }
    }

    /// A lane takes over what another one has.
    pub(super) fn copy(&mut self, from: usize, to: usize) {
        for blocks in [
            &mut self.x,
            &mut self.rates,
            &mut self.p,
            &mut self.kept,
            &mut self.inputs,
            &mut self.guards,
        ] {
            for block in blocks {
                block[to] = block[from];
            }
        }
    }

    /// The states at the start of some motions are where order zero is wanted next.
    pub(super) fn new_states_where(&mut self, which: [bool; LANES]) {
        select(&mut self.x_new, &self.x, which);
    }

    /// Inputs of a lane where order zero is computed next.
    pub(super) fn set_inputs(&mut self, lane: usize, inputs: &[Cubic]) {
        for (power, blocks) in self
            .inputs_new
            .chunks_exact_mut(inputs.len().max(1))
            .enumerate()
        {
            for (block, input) in blocks.iter_mut().zip(inputs) {
                block[lane] = input[power];
            }
        }
    }

    /// Order zero at times and the new states.
    pub(super) fn evaluate(&mut self, series: &dyn SeriesInLanes, t: &Block) {
        let count = self.inputs_new.len() / POWERS;
        let at = AtLanes {
            t,
            x: &self.x_new,
            u: &self.inputs_new[..count],
            p: &self.p,
        };
        series.start(
            at,
            [
                &mut self.rates_new,
                &mut self.kept_new,
                &mut self.guards_new,
            ],
        );
    }

    /// What order zero gave last becomes the start of the next step of some motions.
    pub(super) fn take_over(&mut self, which: [bool; LANES]) {
        select(&mut self.x, &self.x_new, which);
        select(&mut self.rates, &self.rates_new, which);
        select(&mut self.kept, &self.kept_new, which);
        select(&mut self.inputs, &self.inputs_new, which);
        select(&mut self.guards, &self.guards_new, which);
    }

    /// Orders 0 to the highest of the states, and of the guards.
    pub(super) fn expand(&mut self, series: &dyn SeriesInLanes) {
        let (n, guards) = (self.x.len(), self.guards_new.len());
        self.coefficients[..n].copy_from_slice(&self.x);
        self.coefficients[n..2 * n].copy_from_slice(&self.rates);
        let inputs = self.inputs.len() / POWERS;
        let width = inputs + OrderNumber::COUNT;
        let powers = self.inputs.chunks_exact(inputs.max(1));
        for (numbers, power) in self.orders.chunks_exact_mut(width).zip(powers) {
            numbers[..inputs].copy_from_slice(power);
        }
        let last = if guards == 0 {
            self.order - 1
        } else {
            self.order
        };
        for k in 1..=last {
            let (sums, factors) = self.products.summed(k);
            let [left, right] = factors.map(in_blocks);
            let (known, rest) = self.coefficients.split_at_mut((k + 1) * n);
            let next = if k < self.order {
                &mut rest[..n]
            } else {
                &mut self.beyond[..]
            };
            let at = AtLanes {
                t: &[k as f64; LANES],
                x: &known[k * n..],
                u: &self.orders[k * width..][..width],
                p: &self.kept,
            };
            let of_guards = &mut self.guards[k * guards..][..guards];
            series.sweep(at, sums.as_chunks().0, [next, left, right, of_guards]);
        }
    }

    /// The polynomials and their slopes so long after the start; the states are the new ones.
    pub(super) fn polynomials(&mut self, since: &Block, slopes: &mut [Block]) {
        let n = self.x.len();
        dispatch(
            #[inline(always)]
            || {
                self.x_new
                    .copy_from_slice(&self.coefficients[self.order * n..]);
                slopes.fill([0.0; LANES]);
                for order in (1..=self.order).rev() {
                    let terms = &self.coefficients[order * n..][..n];
                    let lower = &self.coefficients[(order - 1) * n..][..n];
                    for (slope, term) in slopes.iter_mut().zip(terms) {
                        for l in 0..LANES {
                            slope[l] = order as f64 * term[l] + since[l] * slope[l];
                        }
                    }
                    for (x, lower) in self.x_new.iter_mut().zip(lower) {
                        for l in 0..LANES {
                            x[l] = lower[l] + since[l] * x[l];
                        }
                    }
                }
            },
        );
    }

    /// In which lanes a guard may change its sign within a time: where its first term does not outweigh the others, or is
    /// no number.
    pub(super) fn may_change(&self, within: &Block) -> [bool; LANES] {
        let guards = self.guards_new.len();
        let mut keeps = [true; LANES];
        dispatch(
            #[inline(always)]
            || {
                let mut outweighs = [true; LANES];
                for guard in 0..guards {
                    let mut most = [0.0; LANES];
                    for order in (1..=self.order).rev() {
                        let term = self.guards[order * guards + guard];
                        for l in 0..LANES {
                            most[l] = within[l] * (term[l].abs() + most[l]);
                        }
                    }
                    for l in 0..LANES {
                        outweighs[l] &= self.guards[guard][l].abs() > most[l];
                    }
                }
                keeps = outweighs;
            },
        );
        keeps.map(|keeps| !keeps)
    }

    /// Which new states are finite.
    pub(super) fn finite(&self) -> [bool; LANES] {
        let mut zero = [0.0; LANES];
        for x in &self.x_new {
            for l in 0..LANES {
                zero[l] += x[l] * 0.0;
            }
        }
        zero.map(|zero| zero == 0.0)
    }

    /// The first state of a motion whose rate is infinite or not a number.
    pub(super) fn rate_not_finite(&self, lane: usize) -> Option<usize> {
        self.rates.iter().position(|rate| !rate[lane].is_finite())
    }

    /// The first state of a motion of whose last two coefficients one is infinite or not a number.
    pub(super) fn term_not_finite(&self, lane: usize) -> usize {
        let mut orders = self.last_orders().into_iter();
        let first = orders.find_map(|k| {
            self.terms(k)
                .iter()
                .position(|term| !term[lane].is_finite())
        });
        first.unwrap_or(0)
    }
}

fn in_blocks(numbers: &mut [f64]) -> &mut [Block] {
    numbers.as_chunks_mut().0
}

/// Numbers of some lanes.
fn select(to: &mut [Block], from: &[Block], which: [bool; LANES]) {
    // By their bits: a choice of addresses goes number by number.
    let taken = which.map(|is_taken| if is_taken { u64::MAX } else { 0 });
    dispatch(
        #[inline(always)]
        || {
            for (to, from) in to.iter_mut().zip(from) {
                for l in 0..LANES {
                    let bits = (from[l].to_bits() & taken[l]) | (to[l].to_bits() & !taken[l]);
                    to[l] = f64::from_bits(bits);
                }
            }
        },
    );
}
