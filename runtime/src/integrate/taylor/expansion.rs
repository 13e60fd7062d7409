//! The coefficients of one step.

use crate::model::At;
use crate::series::{Cubic, OrderNumber, Series, Sweep, Swept};

/// Work arrays of an expansion. Coefficients of one order follow each other.
#[derive(Debug, Clone, Default)]
pub(super) struct Expansion {
    kept: Vec<f64>,
    /// Inputs at order zero.
    inputs: Vec<f64>,
    /// Inputs at some order, then the numbers of the order.
    order: Vec<f64>,
    products: Products,
    /// Values of the guards where order zero was last computed.
    pub(super) guards_new: Vec<f64>,
    /// Coefficients of the guards by order.
    pub(super) guards: Vec<f64>,
    /// Coefficients beyond the highest order.
    beyond: Vec<f64>,
}

/// The factors of all products, and the sums over them.
#[derive(Debug, Clone, Default)]
struct Products {
    /// How many there are, rounded up to whole blocks.
    width: usize,
    count: usize,
    left: Vec<f64>,
    right: Vec<f64>,
    sums: Vec<f64>,
}

/// Products that are summed together.
const BLOCK: usize = 8;

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
        sized(&mut self.order, shape.inputs + OrderNumber::COUNT);
        sized(&mut self.guards_new, shape.guards.len());
        sized(&mut self.guards, shape.guards.len() * (order + 1));
        sized(&mut self.beyond, shape.states);
        let products = &mut self.products;
        products.count = shape.products;
        products.width = shape.products.next_multiple_of(BLOCK);
        for factors in [&mut products.left, &mut products.right] {
            sized(factors, products.width * (order + 1));
        }
        sized(&mut products.sums, products.width);
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
        let at = At { t, x, u, p };
        series.start(at, rates, &mut self.kept, &mut self.guards_new);
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
        for k in 1..=last {
            self.products.sum(k);
            let Products {
                width,
                count: products,
                left,
                right,
                sums,
            } = &mut self.products;
            for (u, input) in self.order.iter_mut().zip(inputs) {
                *u = input.get(k).copied().unwrap_or(0.0);
            }
            self.order[inputs.len()..].copy_from_slice(&OrderNumber::all(k));
            let (known, rest) = x.split_at_mut((k + 1) * n);
            let next = match k < order {
                true => &mut rest[..n],
                false => &mut self.beyond[..],
            };
            let at = At {
                t: k as f64,
                x: &known[k * n..],
                u: &self.order,
                p: &self.kept,
            };
            let from = Sweep {
                at,
                sums: &sums[..*products],
            };
            series.sweep(
                from,
                Swept {
                    next,
                    left: &mut left[k * *width..][..*products],
                    right: &mut right[k * *width..][..*products],
                    guards: &mut self.guards[k * count..][..count],
                },
            );
        }
    }
}

impl Products {
    /// Σ aⱼ bₖ₋ⱼ over 1 ≤ j < k for all products.
    fn sum(&mut self, k: usize) {
        for start in (0..self.width).step_by(BLOCK) {
            let mut sum = [0.0; BLOCK];
            for j in 1..k {
                let left = &self.left[j * self.width + start..][..BLOCK];
                let right = &self.right[(k - j) * self.width + start..][..BLOCK];
                for lane in 0..BLOCK {
                    sum[lane] += left[lane] * right[lane];
                }
            }
            self.sums[start..][..BLOCK].copy_from_slice(&sum);
        }
    }
}
