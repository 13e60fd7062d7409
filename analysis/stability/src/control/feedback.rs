//! `u = u₀ − K (y − y_des(t))` as the inputs of a simulation.

use nalgebra::DMatrix;

use appell_runtime::inputs::InputSource;

/// Feedback of states. `desired` writes `y_des` at a time in s, in the order of `states`.
#[derive(Debug, Clone)]
pub struct Feedback<D> {
    /// The inputs, by their index in the model; the others stay zero.
    pub inputs: Vec<usize>,
    /// The states y, by their index in the model.
    pub states: Vec<usize>,
    /// K, a row for each input, a column for each state.
    pub gain: DMatrix<f64>,
    /// u₀, a number for each input.
    pub offset: Vec<f64>,
    /// `y_des(t)`.
    pub desired: D,
    /// Times in s at which `y_des` jumps or kinks.
    pub switching_times: Vec<f64>,
}

impl<D: Fn(f64, &mut [f64])> InputSource for Feedback<D> {
    fn inputs(&self, t: f64, x: &[f64], u: &mut [f64]) {
        u.fill(0.0);
        let mut desired = vec![0.0; self.states.len()];
        (self.desired)(t, &mut desired);
        for (row, &input) in self.inputs.iter().enumerate() {
            let terms = self.states.iter().zip(&desired).enumerate();
            let terms = terms
                .map(|(place, (&state, desired))| self.gain[(row, place)] * (x[state] - desired));
            u[input] = self.offset[row] - terms.sum::<f64>();
        }
    }

    fn switching_times(&self) -> Vec<f64> {
        self.switching_times.clone()
    }
}
