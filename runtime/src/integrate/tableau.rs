//! Coefficients of explicit Runge–Kutta methods.

/// Pairs of a stage and its weight; stages that are not listed have weight zero.
pub type Row = &'static [(usize, f64)];

/// A Butcher tableau without the embedded solutions. Stages count from 0.
pub(super) struct Tableau {
    /// Nodes c of stages 1, 2, …
    pub(super) nodes: &'static [f64],
    /// Rows a of stages 1, 2, …
    pub(super) rows: &'static [Row],
    /// Weights b of the new state.
    pub(super) weights: Row,
}

impl Tableau {
    /// Index of the stage that holds the rates at the new state.
    pub(super) const fn new_rates(&self) -> usize {
        self.rows.len() + 1
    }
}
