//! The interface between equations of motion and their users.

use std::borrow::Cow;

use crate::differences;
use crate::real::Enclosure;
use crate::switching::Counts;

/// A text that is static in emitted models and owned in models made at run time.
pub type Text = Cow<'static, str>;
/// A list that is static in emitted models and owned in models made at run time.
pub type List<T> = Cow<'static, [T]>;

/// A named quantity with its unit. All numbers of a model are in SI; `unit` and `scale` define the display unit:
/// `value_in_unit = value / scale`.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Quantity {
    /// Identifier in the spec.
    pub name: Text,
    /// One sentence that describes it.
    pub about: Text,
    /// Display unit, e.g. `rad/s`.
    pub unit: Text,
    /// Size of `unit` in SI.
    pub scale: f64,
    /// Parameter value or initial value in SI; 0 for inputs and outputs.
    pub value: f64,
    /// Declared range in SI; infinite where none is declared.
    pub range: [f64; 2],
}

impl Quantity {
    /// A quantity in SI units whose value is zero, without a range.
    pub const fn new(name: &'static str, about: &'static str, unit: &'static str) -> Self {
        Self {
            name: Text::Borrowed(name),
            about: Text::Borrowed(about),
            unit: Text::Borrowed(unit),
            scale: 1.0,
            value: 0.0,
            range: [f64::NEG_INFINITY, f64::INFINITY],
        }
    }

    /// The same for a unit that is `scale` in SI.
    #[must_use]
    pub const fn scaled(mut self, scale: f64) -> Self {
        self.scale = scale;
        self
    }

    /// The same with a value, in SI.
    #[must_use]
    pub const fn valued(mut self, value: f64) -> Self {
        self.value = value;
        self
    }

    /// The same with a range, in SI.
    #[must_use]
    pub const fn within(mut self, low: f64, high: f64) -> Self {
        self.range = [low, high];
        self
    }

    /// Converts a value from SI to the display unit.
    pub fn to_unit(&self, si: f64) -> f64 {
        si / self.scale
    }

    /// The same without rounding errors of the conversion: 120, not 119.99999999999999.
    pub fn shown(&self, si: f64) -> f64 {
        tidy(self.to_unit(si))
    }

    /// Converts a value from the display unit to SI.
    pub fn to_si(&self, value: f64) -> f64 {
        value * self.scale
    }
}

/// A number without rounding errors of conversions, for display.
pub fn tidy(x: f64) -> f64 {
    format!("{x:.13e}").parse().unwrap_or(x)
}

/// Interpolation of a tabulated signal. Before the first and after the last row the value at that end applies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Interpolation {
    /// Piecewise constant, from a row's time up to the next.
    Hold,
    /// Piecewise linear.
    Linear,
    /// Natural cubic spline: twice continuously differentiable, zero curvature at the ends. If its slope at an end is
    /// not zero, the first derivative is discontinuous there: a body with prescribed motion stops without an impulse
    /// in the equations. Such tables should start and end at rest, or extend beyond the motion.
    Cubic,
}

/// A function of time given by its values, in SI. [`crate::Signal`] evaluates it.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SignalTable {
    /// Identifier in the spec.
    pub name: Text,
    /// Times in seconds, strictly increasing.
    pub times: List<f64>,
    /// Values in SI, one per time.
    pub values: List<f64>,
    /// Interpolation between the times.
    pub interpolation: Interpolation,
}

/// The reaction of a constraint.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Reaction {
    /// Name of the point at which it acts, or of the constraint that has no point.
    pub name: Text,
    /// N for the force on a point. For a multiplier the unit of a power divided by the constrained rate, in SI; empty
    /// if it cannot be written.
    pub unit: Text,
    /// Whether it is the force on a point.
    pub on_point: bool,
}

impl Reaction {
    /// The force on a point, three components in the ground frame.
    pub const fn on_point(name: Text) -> Self {
        Self {
            name,
            unit: Text::Borrowed("N"),
            on_point: true,
        }
    }

    /// The multiplier of a constraint without a point, the first of its three components.
    pub const fn multiplier(name: Text, unit: Text) -> Self {
        Self {
            name,
            unit,
            on_point: false,
        }
    }
}

/// A unilateral contact with a surface, which can push a body but not pull it.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Contact {
    /// Name of its reaction.
    pub name: Text,
    /// Index into [`ModelInfo::reactions`].
    pub reaction: usize,
    /// Surface normal towards the body, in the ground frame, at the initial state of the spec; [`Model::contacts`]
    /// evaluates it at any state.
    pub normal: [f64; 3],
    /// Whether friction constrains the body along the surface, so that it could slip.
    pub grips: bool,
    /// Coefficient of friction at the initial state, if the spec gives one.
    pub friction: Option<f64>,
}

/// Names, units and sizes of a model, in the order of its vectors.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ModelInfo {
    /// Name of the mechanism.
    pub name: Text,
    /// Title in one line.
    pub title: Text,
    /// Reference for the model; may be empty.
    pub source: Text,
    /// The state: pseudo-velocities first, then coordinates.
    pub states: List<Quantity>,
    /// Number of pseudo-velocities among the states.
    pub speeds: usize,
    /// Inputs; signals follow the declared inputs.
    pub inputs: List<Quantity>,
    /// Number of declared inputs; the others are signals and their derivatives.
    pub declared_inputs: usize,
    /// Tabulated functions of time.
    pub signals: List<SignalTable>,
    /// The inputs after the declared ones: an index into `signals` and the order of the time derivative, 0, 1 or 2.
    pub signal_inputs: List<(usize, u8)>,
    /// Parameters.
    pub parameters: List<Quantity>,
    /// Outputs.
    pub outputs: List<Quantity>,
    /// Velocity constraints, one name per scalar row.
    pub constraint_rows: List<Text>,
    /// Reactions of constrained points, or of constraints without a point.
    pub reactions: List<Reaction>,
    /// Unilateral contacts among the reactions.
    pub contacts: List<Contact>,
    /// Whether the equations depend on time explicitly.
    pub explicit_time: bool,
}

impl ModelInfo {
    /// Number of states, n.
    pub fn state_len(&self) -> usize {
        self.states.len()
    }

    /// Number of inputs including the signals, m.
    pub fn input_len(&self) -> usize {
        self.inputs.len()
    }

    /// Number of parameters, k.
    pub fn parameter_len(&self) -> usize {
        self.parameters.len()
    }

    /// Number of outputs.
    pub fn output_len(&self) -> usize {
        self.outputs.len()
    }

    /// The spec's parameter values in SI.
    pub fn default_parameters(&self) -> Vec<f64> {
        self.parameters
            .iter()
            .map(|parameter| parameter.value)
            .collect()
    }

    /// The spec's initial state in SI.
    pub fn initial_state(&self) -> Vec<f64> {
        self.states.iter().map(|state| state.value).collect()
    }

    /// Index of a pseudo-velocity or coordinate in the state.
    pub fn state_index(&self, name: &str) -> Option<usize> {
        index_of(&self.states, name)
    }

    /// Index of an input or signal in the inputs.
    pub fn input_index(&self, name: &str) -> Option<usize> {
        index_of(&self.inputs, name)
    }

    /// Index of a parameter.
    pub fn parameter_index(&self, name: &str) -> Option<usize> {
        index_of(&self.parameters, name)
    }

    /// Index of an output.
    pub fn output_index(&self, name: &str) -> Option<usize> {
        index_of(&self.outputs, name)
    }

    /// Normals and friction of the contacts at the initial state, as [`Model::contacts`] writes
    /// them.
    pub fn initial_contacts(&self, normals: &mut [f64], friction: &mut [f64]) {
        for (contact, normal) in self.contacts.iter().zip(normals.chunks_mut(3)) {
            normal.copy_from_slice(&contact.normal[..normal.len()]);
        }
        for (contact, friction) in self.contacts.iter().zip(friction) {
            *friction = contact.friction.unwrap_or(0.0);
        }
    }

    /// The pseudo-velocities, the first part of the state.
    pub fn speed_quantities(&self) -> &[Quantity] {
        &self.states[..self.speeds.min(self.states.len())]
    }

    /// The coordinates, the last part of the state.
    pub fn coordinate_quantities(&self) -> &[Quantity] {
        &self.states[self.speeds.min(self.states.len())..]
    }
}

fn index_of(quantities: &[Quantity], name: &str) -> Option<usize> {
    quantities.iter().position(|quantity| quantity.name == name)
}

/// Arguments of a model. All slices in SI, in the order of [`ModelInfo`].
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

/// The gradient of a scalar at a point: as many numbers as states, inputs and parameters.
#[derive(Debug)]
pub struct Gradient<'a> {
    /// With respect to the state.
    pub x: &'a mut [f64],
    /// With respect to the inputs.
    pub u: &'a mut [f64],
    /// With respect to the parameters.
    pub p: &'a mut [f64],
}

/// Energies, and the power supplied to their sum.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Energies {
    /// Kinetic energy in J.
    pub kinetic: f64,
    /// Potential energy of gravity and springs in J.
    pub potential: f64,
    /// Power of all non-conservative loads and of prescribed motions, in W.
    pub power: f64,
    /// Acceleration energy (Gibbs function) S in W/s, without the terms independent of accelerations.
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
    /// P = ∂ẋ/∂p (`n·k`). Models with many parameters may have no formulas for it: the default implementation uses
    /// differences, accurate to about nine digits.
    fn parameter_jacobian(&self, at: At<'_>, p: &mut [f64]) {
        differences::parameter_jacobian(self, at, p);
    }
    /// M, bias and pseudo-forces of Appell's equations M ω̇ + b = Π (`s·s`, `s`, `s`).
    fn appell(&self, at: At<'_>, mass: &mut [f64], bias: &mut [f64], forces: &mut [f64]);
    /// Energies and power.
    fn energies(&self, at: At<'_>) -> Energies;
    /// Constraint rows evaluated with the generalised velocities of the state; zero up to rounding.
    fn constraint_residual(&self, at: At<'_>, residual: &mut [f64]);
    /// Reactions in the ground frame, three components per entry of [`ModelInfo::reactions`].
    fn constraint_forces(&self, at: At<'_>, forces: &mut [f64]);
    /// Surfaces at the contacts: normals towards the body, in the ground frame and of any length (three components
    /// per entry of [`ModelInfo::contacts`]), and coefficients of friction (one per entry; 0 if the spec gives none).
    /// Most are constant.
    fn contacts(&self, at: At<'_>, normals: &mut [f64], friction: &mut [f64]) {
        let _ = at;
        self.info().initial_contacts(normals, friction);
    }
    /// Sizes of the linear systems of several unknowns that are solved with pivoting to obtain the rates; most models
    /// have none.
    fn system_sizes(&self) -> &[usize] {
        &[]
    }
    /// Their matrices one after the other, row by row: the sum of the squares of
    /// [`Model::system_sizes`].
    fn systems(&self, at: At<'_>, matrices: &mut [f64]) {
        let _ = at;
        matrices.fill(0.0);
    }
    /// Outputs of the spec.
    fn outputs(&self, at: At<'_>, outputs: &mut [f64]);
    /// Bounds on the outputs along a segment of a motion, if the model has them.
    fn outputs_within(&self, along: &Along<'_>, outputs: &mut [Enclosure]) {
        let _ = along;
        outputs.fill(Enclosure::UNKNOWN);
    }
    /// Inverse dynamics: the pseudo-forces M ω̇ + b − Π required for given pseudo-accelerations in addition to the
    /// loads (`s`).
    fn inverse_dynamics(&self, at: At<'_>, accelerations: &[f64], demand: &mut [f64]) {
        differences::inverse_dynamics(self, at, accelerations, demand);
    }
    /// [`Model::inverse_dynamics`] with its Jacobians with respect to the state (`s·n`), the inputs (`s·m`) and the
    /// pseudo-accelerations, which is M (`s·s`). The default implementation uses differences, accurate to about nine
    /// digits.
    fn inverse_dynamics_jacobians(
        &self,
        at: At<'_>,
        accelerations: &[f64],
        demand: &mut [f64],
        by_state: &mut [f64],
        by_inputs: &mut [f64],
        mass: &mut [f64],
    ) {
        let results = [demand, by_state, by_inputs, mass];
        differences::inverse_dynamics_jacobians(self, at, accelerations, results);
    }
    /// Whether the derivatives below are formulas. The default implementations use differences of the functions
    /// above: slower, and accurate to about nine digits.
    fn has_adjoint(&self) -> bool {
        false
    }
    /// Gradient of ⟨λ, ẋ⟩ + ⟨Λ, A⟩ + ⟨Γ, B⟩ + ⟨K, M⟩, where brackets are sums over all products of entries. `weights`
    /// are λ (`n`), Λ (`n·n`), Γ (`n·m`), K (`s·s`), one after the other. It provides the adjoint equations of a
    /// motion and of its variation.
    fn adjoint(&self, at: At<'_>, weights: &[f64], by: Gradient<'_>) {
        differences::adjoint(self, at, weights, by);
    }
    /// Outputs y (`l`), C = ∂y/∂x (`l·n`), D = ∂y/∂u (`l·m`).
    fn output_jacobians(&self, at: At<'_>, outputs: &mut [f64], c: &mut [f64], d: &mut [f64]) {
        differences::output_jacobians(self, at, [outputs, c, d]);
    }
    /// Gradient of ⟨μ, y⟩ + ⟨Γ, C⟩ + ⟨Δ, D⟩; `weights` are μ (`l`), Γ (`l·n`), Δ (`l·m`).
    fn output_adjoint(&self, at: At<'_>, weights: &[f64], by: Gradient<'_>) {
        differences::output_adjoint(self, at, weights, by);
    }
    /// Dependent coordinates, one per position constraint; most models have none.
    fn dependent_coordinates(&self) -> &[usize] {
        &[]
    }
    /// Position constraints f(q, t) (`c`, as many as dependent coordinates) and ∂f/∂q (`c` rows,
    /// one column per coordinate).
    fn position_constraints(&self, at: At<'_>, residual: &mut [f64], jacobian: &mut [f64]) {
        let _ = at;
        residual.fill(0.0);
        jacobian.fill(0.0);
    }
    /// Switching functions of the equations, if any: an integrator ends a step at each switch, where the rates are
    /// discontinuous or not smooth.
    fn switching(&self) -> Option<&dyn Switching> {
        None
    }
}

/// Discontinuities and kinks of equations or inputs: zeros of the differences that relations compare and of the
/// arguments of signs and absolute values.
pub trait Switching {
    /// Numbers of functions of each kind.
    fn counts(&self) -> Counts;
    /// Whether the functions of time are the same for all parameters.
    fn is_of_time_alone(&self) -> bool {
        false
    }
    /// Signs and truth values that depend on time alone, such as that of `t < t_brake`: 1 or 0, or a sign. `x` and
    /// `u` are ignored.
    fn answers(&self, at: At<'_>, answers: &mut [f64]);
    /// Over an interval of time, the functions whose signs are the answers, followed by the other functions of time
    /// alone that have pulses.
    fn within(&self, time: Enclosure, p: &[f64], functions: &mut [Enclosure]);
    /// The switching functions that depend on the state or the inputs, followed by the functions of them that have
    /// pulses, within a small part of their arguments' range.
    fn crossings(&self, at: At<'_>, crossings: &mut [f64]);
    /// Bounds on these along a segment of a motion.
    fn crossings_within(&self, along: &Along<'_>, crossings: &mut [Enclosure]);
}

/// A segment of a motion within a step; otherwise as [`At`].
#[derive(Debug, Clone, Copy)]
pub struct Along<'a> {
    /// Start of the step in s, from which tables are polynomials.
    pub start: f64,
    /// Time.
    pub t: Enclosure,
    /// State.
    pub x: &'a [Enclosure],
    /// Inputs, then signals.
    pub u: &'a [Enclosure],
    /// Parameters.
    pub p: &'a [f64],
}

/// A model with named vector entries, such as an emitted one.
pub trait Named: Model {
    /// Pseudo-velocities and coordinates.
    type State;
    /// Inputs, then signals.
    type Inputs;
    /// Outputs of the spec.
    type Outputs;
    /// The entries of the vectors at a point, and the outputs there.
    ///
    /// # Panics
    ///
    /// If a slice is shorter than the model's vector.
    fn named(&self, at: At<'_>) -> Row<Self>;
}

/// A time with the named entries of the vectors, in SI.
pub struct Row<M: Named + ?Sized> {
    /// Time in seconds.
    pub t: f64,
    /// State.
    pub state: M::State,
    /// Inputs, then signals.
    pub inputs: M::Inputs,
    /// Outputs.
    pub outputs: M::Outputs,
}
