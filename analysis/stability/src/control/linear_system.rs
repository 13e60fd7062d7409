//! ẏ = A y + B u.

use nalgebra::DMatrix;

/// A linear system with constant coefficients. In discrete time it is y₊ = A y + B u.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearSystem {
    /// A, square.
    pub a: DMatrix<f64>,
    /// B, a column for each input.
    pub b: DMatrix<f64>,
}

impl LinearSystem {
    /// Number of states.
    pub fn order(&self) -> usize {
        self.a.nrows()
    }

    /// Number of inputs.
    pub fn inputs(&self) -> usize {
        self.b.ncols()
    }

    /// A − B K, the loop closed with u = −K y.
    #[must_use]
    pub fn closed(&self, gain: &DMatrix<f64>) -> DMatrix<f64> {
        &self.a - &self.b * gain
    }

    /// The same system in states ỹ = y / d and inputs ũ = u / e, so that rows and columns have
    /// similar norms and ranks do not depend on units. d and e are powers of two, so that scaling
    /// is exact.
    pub fn balanced(&self) -> Balanced {
        let (n, m) = (self.order(), self.inputs());
        let (mut a, mut b) = (self.a.clone(), self.b.clone());
        let (mut states, mut inputs) = (vec![1.0; n], vec![1.0; m]);
        // Inputs first, scaled to the size of A, so that they count in the norms of the rows.
        let size = a.amax().max(f64::MIN_POSITIVE);
        for input in 0..m {
            let factor = power_of_two(size / b.column(input).amax());
            b.column_mut(input).scale_mut(factor);
            inputs[input] = factor;
        }
        for _ in 0..SWEEPS {
            let mut settled = true;
            for i in 0..n {
                let others = (0..n).filter(|&j| j != i);
                let [row, column] = others.fold([0.0, 0.0], |[row, column], j| {
                    [row + a[(i, j)].abs(), column + a[(j, i)].abs()]
                });
                let row = row + b.row(i).iter().map(|entry| entry.abs()).sum::<f64>();
                if row <= 0.0 || column <= 0.0 {
                    continue;
                }
                let factor = power_of_two((row / column).sqrt());
                if (factor - 1.0).abs() > 0.0 {
                    settled = false;
                    a.row_mut(i).scale_mut(factor.recip());
                    b.row_mut(i).scale_mut(factor.recip());
                    a.column_mut(i).scale_mut(factor);
                    states[i] *= factor;
                }
            }
            if settled {
                break;
            }
        }
        Balanced {
            system: Self { a, b },
            states,
            inputs,
        }
    }
}

/// Sweeps of the balancing; a few are enough for the sizes of mechanisms.
const SWEEPS: usize = 30;

/// The nearest power of two; 1 for numbers without a logarithm.
fn power_of_two(value: f64) -> f64 {
    if value.is_finite() && value > 0.0 {
        value.log2().round().exp2()
    } else {
        1.0
    }
}

/// A balanced system with its scales.
#[derive(Debug, Clone, PartialEq)]
pub struct Balanced {
    /// The system in scaled states and inputs.
    pub system: LinearSystem,
    /// y = `states` · ỹ.
    pub states: Vec<f64>,
    /// u = `inputs` · ũ.
    pub inputs: Vec<f64>,
}

impl Balanced {
    /// K for y and u, from K̃ for the scaled ones.
    #[must_use]
    pub fn gain(&self, scaled: &DMatrix<f64>) -> DMatrix<f64> {
        DMatrix::from_fn(scaled.nrows(), scaled.ncols(), |i, j| {
            self.inputs[i] * scaled[(i, j)] / self.states[j]
        })
    }
}
