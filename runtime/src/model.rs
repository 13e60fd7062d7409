//! The interface between equations and everything that uses them.

use std::borrow::Cow;

/// A text that is static in emitted models and owned in models made at run time.
pub type Text = Cow<'static, str>;
/// A list that is static in emitted models and owned in models made at run time.
pub type List<T> = Cow<'static, [T]>;

/// A named quantity with its unit. All numbers of a model are in SI; `unit` and `scale` say how
/// people read and write the quantity: `value_in_unit = value / scale`.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// Identifier in the spec.
    pub name: Text,
    /// One sentence for people.
    pub about: Text,
    /// Unit for people, e.g. `rad/s`.
    pub unit: Text,
    /// One of `unit` in SI.
    pub scale: f64,
    /// Parameter value or initial value in SI; 0 for inputs and outputs.
    pub value: f64,
    /// Declared range in SI; infinite where none is declared.
    pub range: [f64; 2],
}

/// What a model is made of, in the order of its vectors.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelInfo {
    /// Name of the mechanism.
    pub name: Text,
    /// One line for people.
    pub title: Text,
    /// Where the model comes from; may be empty.
    pub source: Text,
    /// The state: pseudo-velocities first, then coordinates.
    pub states: List<Quantity>,
    /// How many of the states are pseudo-velocities.
    pub speeds: usize,
    /// Inputs; signals follow the declared inputs.
    pub inputs: List<Quantity>,
    /// How many of the inputs are declared; the others are signals and their rates.
    pub declared_inputs: usize,
    /// Parameters.
    pub parameters: List<Quantity>,
    /// Outputs.
    pub outputs: List<Quantity>,
    /// Velocity constraints, one name per scalar row.
    pub constraint_rows: List<Text>,
    /// Constrained points, or constraints without a point, that have a reaction.
    pub reactions: List<Text>,
    /// Whether the equations depend on time explicitly.
    pub explicit_time: bool,
}

/// Where a model is evaluated. All slices in SI, in the order of [`ModelInfo`].
#[derive(Debug, Clone, Copy)]
pub struct At<'a> {
    /// Time in seconds.
    pub t: f64,
    /// State: pseudo-velocities, coordinates.
    pub x: &'a [f64],
    /// Inputs, then signals.
    pub u: &'a [f64],
    /// Parameters.
    pub p: &'a [f64],
}

/// Energies and the power of the applied loads that are not conservative in the model's books.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Energies {
    /// Kinetic energy in J.
    pub kinetic: f64,
    /// Potential energy of gravity and springs in J.
    pub potential: f64,
    /// Power of all loads that have no potential, in W.
    pub power: f64,
    /// Acceleration energy (Gibbs function) S in W/s, without the terms free of accelerations.
    pub acceleration: f64,
}

/// Equations of motion ẋ = f(t, x, u, p) with their derivatives.
///
/// Matrices are written row by row. Output slices have exactly the stated length.
pub trait Model: Sync {
    /// Names, units and sizes.
    fn info(&self) -> &ModelInfo;
    /// ẋ, `n` numbers.
    fn rates(&self, at: At<'_>, rates: &mut [f64]);
    /// ẋ (`n`), A = ∂ẋ/∂x (`n·n`), B = ∂ẋ/∂u (`n·m`).
    fn jacobians(&self, at: At<'_>, rates: &mut [f64], a: &mut [f64], b: &mut [f64]);
    /// P = ∂ẋ/∂p (`n·k`).
    fn parameter_jacobian(&self, at: At<'_>, p: &mut [f64]);
    /// M, bias and generalised forces of Appell's equations M ω̇ + b = Π (`s·s`, `s`, `s`).
    fn appell(&self, at: At<'_>, mass: &mut [f64], bias: &mut [f64], forces: &mut [f64]);
    /// Energies and power.
    fn energies(&self, at: At<'_>) -> Energies;
    /// Constraint rows evaluated with the generalised velocities of the state; zero up to rounding.
    fn constraint_residual(&self, at: At<'_>, residual: &mut [f64]);
    /// Reactions in the ground, three components per entry of [`ModelInfo::reactions`].
    fn constraint_forces(&self, at: At<'_>, forces: &mut [f64]);
    /// Outputs of the spec.
    fn outputs(&self, at: At<'_>, outputs: &mut [f64]);
}
