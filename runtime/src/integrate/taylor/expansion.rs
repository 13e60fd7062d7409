//! The coefficients of one step.

use super::products::Products;
use crate::series::{Cubic, OrderNumber, Series, Start, Started, Sweep, Swept};

/// Work arrays of an expansion. Coefficients of one order follow each other.
#[derive(Debug, Clone, Default)]
pub(super) struct Expansion {
    kept: Vec<f64>,
    /// Inputs at order zero.
    inputs: Vec<f64>,
    /// Inputs at each order, then the numbers of the order.
    orders: Vec<f64>,
    products: Products,
    /// Values of the guards where order zero was last computed.
    pub(super) guards_new: Vec<f64>,
    /// Coefficients of the guards by order.
    pub(super) guards: Vec<f64>,
    /// Coefficients beyond the highest order.
    beyond: Vec<f64>,
}

impl Expansion {
    /// Sizes the arrays for a series up to an order.
    pub(super) fn prepare(&mut self, series: &dyn Series, order: usize) {
        let shape = series.shape();
        let sized = |vector: &mut Vec<f64>, length| {
            vector.clear();
            vector.resize(length, 0.0);
        };
        sized(&mut self.kept, shape.kept);
        sized(&mut self.inputs, shape.inputs);
        let width = shape.inputs + OrderNumber::COUNT;
        sized(&mut self.orders, width * (order + 1));
        for (k, numbers) in self.orders.chunks_exact_mut(width).enumerate() {
            numbers[shape.inputs..].copy_from_slice(&OrderNumber::all(k));
        }
        sized(&mut self.guards_new, shape.guards.len());
        sized(&mut self.guards, shape.guards.len() * (order + 1));
        sized(&mut self.beyond, shape.states);
        self.products.prepare(shape.products, order);
    }

    /// Order zero at a time and state: writes the rates.
    pub(super) fn start(
        &mut self,
        series: &dyn Series,
        t: f64,
        x: &[f64],
        inputs: &[Cubic],
        p: &[f64],
        rates: &mut [f64],
    ) {
        for (u, input) in self.inputs.iter_mut().zip(inputs) {
            *u = input[0];
        }
        let u = &self.inputs;
        let (kept, guards) = (&mut self.kept, &mut self.guards_new);
        let to = Started {
            next: rates,
            kept,
            guards,
        };
        series.start(Start { t, x, u, p }, to);
    }

    /// Orders 2 to `order` of the states, `n` numbers each, and all of the guards; orders 0 and 1 of the states
    /// are there.
    pub(super) fn expand(
        &mut self,
        series: &dyn Series,
        inputs: &[Cubic],
        x: &mut [f64],
        n: usize,
        order: usize,
    ) {
        let count = series.shape().guards.len();
        self.guards[..count].copy_from_slice(&self.guards_new);
        let last = if count == 0 { order - 1 } else { order };
        let width = inputs.len() + OrderNumber::COUNT;
        for (k, of_order) in self.orders.chunks_exact_mut(width).enumerate().take(4) {
            for (u, input) in of_order.iter_mut().zip(inputs) {
                *u = input[k];
            }
        }
        for (k, of_order) in self
            .orders
            .chunks_exact(width)
            .enumerate()
            .take(last + 1)
            .skip(1)
        {
            let (sums, [left, right]) = self.products.summed(k);
            let (known, rest) = x.split_at_mut((k + 1) * n);
            let next = if k < order {
                &mut rest[..n]
            } else {
                &mut self.beyond[..]
            };
            let from = Sweep {
                k: k as f64,
                x: &known[k * n..],
                u: of_order,
                kept: &self.kept,
                sums,
            };
            series.sweep(
                from,
                Swept {
                    next,
                    left,
                    right,
                    guards: &mut self.guards[k * count..][..count],
                },
            );
        }
    }
}
