//! The functions of a program behind the trait of all models, whatever evaluates them.

use std::fmt;
use std::slice::from_mut;
use std::sync::Arc;

use appell_runtime::differences;
use appell_runtime::model::{Along, At, Energies, Gradient, Model, ModelInfo, Switching};
use appell_runtime::real::Enclosure;
use appell_runtime::switching::Counts;

use crate::program::FunctionKind;
use crate::tape::{Tape, enclose_along};
use crate::tapes::Tapes;

/// What evaluates functions.
pub trait Engine: Send + Sync {
    /// Writes the results of a tape at a point. `own` is the argument that only some functions have.
    ///
    /// # Panics
    ///
    /// If `out` has slices of other lengths than the results.
    fn call<const N: usize>(
        &self,
        kind: FunctionKind,
        tape: &Tape,
        at: At<'_>,
        own: &[f64],
        out: [&mut [f64]; N],
    );

    /// The tape that is evaluated instead of this one at parameters `p`.
    fn tape<'t>(&'t self, _: FunctionKind, tape: &'t Tape, _: &[f64]) -> &'t Tape {
        tape
    }
}

/// A model made in this process. Its functions are derived and compiled at their first use. Those that it lacks return
/// NaN, or what the trait of models has in their place, such as differences for most derivatives.
pub struct ProgramModel<E> {
    pub(crate) tapes: Arc<Tapes>,
    pub(crate) engine: E,
}

impl<E: Engine> ProgramModel<E> {
    pub(crate) fn of(tapes: Arc<Tapes>, engine: E) -> Self {
        Self { tapes, engine }
    }

    /// Its functions as tapes.
    pub fn tapes(&self) -> &Arc<Tapes> {
        &self.tapes
    }

    fn has(&self, kind: FunctionKind) -> bool {
        self.tapes.get(kind).is_some()
    }

    /// Bounds on the results of a function along a segment, one after the other; unknown where the model lacks it.
    fn bound(&self, kind: FunctionKind, along: &Along<'_>, bounds: &mut [Enclosure]) {
        bounds.fill(Enclosure::UNKNOWN);
        if let Some(tape) = self.tapes.get(kind) {
            enclose_along(self.engine.tape(kind, tape, along.p), along, bounds);
        }
    }

    fn evaluate<const N: usize>(&self, kind: FunctionKind, at: At<'_>, out: [&mut [f64]; N]) {
        self.evaluate_with(kind, at, &[], out);
    }

    fn evaluate_with<const N: usize>(
        &self,
        kind: FunctionKind,
        at: At<'_>,
        own: &[f64],
        mut out: [&mut [f64]; N],
    ) {
        if let Some(tape) = self.tapes.get(kind) {
            self.engine.call(kind, tape, at, own, out);
        } else {
            for result in &mut out {
                result.fill(f64::NAN);
            }
        }
    }
}

impl<E: Engine> Model for ProgramModel<E> {
    fn info(&self) -> &ModelInfo {
        self.tapes.info()
    }

    fn rates(&self, at: At<'_>, rates: &mut [f64]) {
        self.evaluate(FunctionKind::Rates, at, [rates]);
    }

    fn jacobians(&self, at: At<'_>, rates: &mut [f64], a: &mut [f64], b: &mut [f64]) {
        self.evaluate(FunctionKind::Jacobians, at, [rates, a, b]);
    }

    fn parameter_jacobian(&self, at: At<'_>, p: &mut [f64]) {
        if self.has(FunctionKind::ParameterJacobian) {
            self.evaluate(FunctionKind::ParameterJacobian, at, [p]);
        } else {
            differences::parameter_jacobian(self, at, p);
        }
    }

    fn appell(&self, at: At<'_>, mass: &mut [f64], bias: &mut [f64], forces: &mut [f64]) {
        self.evaluate(FunctionKind::MassMatrixAndBias, at, [mass, bias]);
        self.evaluate(FunctionKind::GeneralizedForces, at, [forces]);
    }

    fn energies(&self, at: At<'_>) -> Energies {
        let mut energies = Energies::default();
        let Energies {
            kinetic,
            potential,
            power,
            acceleration,
        } = &mut energies;
        let [kinetic, potential, power] = [kinetic, potential, power].map(from_mut);
        self.evaluate(FunctionKind::Energies, at, [kinetic, potential, power]);
        let acceleration = from_mut(acceleration);
        self.evaluate(FunctionKind::AccelerationEnergy, at, [acceleration]);
        energies
    }

    fn constraint_residual(&self, at: At<'_>, residual: &mut [f64]) {
        self.evaluate(FunctionKind::ConstraintResidual, at, [residual]);
    }

    fn constraint_forces(&self, at: At<'_>, forces: &mut [f64]) {
        self.evaluate(FunctionKind::ConstraintForces, at, [forces]);
    }

    fn contacts(&self, at: At<'_>, normals: &mut [f64], friction: &mut [f64]) {
        if self.has(FunctionKind::Contacts) {
            self.evaluate(FunctionKind::Contacts, at, [normals, friction]);
        } else {
            self.info().initial_contacts(normals, friction);
        }
    }

    fn system_sizes(&self) -> &[usize] {
        self.tapes.systems()
    }

    fn systems(&self, at: At<'_>, matrices: &mut [f64]) {
        self.evaluate(FunctionKind::Systems, at, [matrices]);
    }

    fn outputs(&self, at: At<'_>, outputs: &mut [f64]) {
        self.evaluate(FunctionKind::Outputs, at, [outputs]);
    }

    fn outputs_within(&self, along: &Along<'_>, outputs: &mut [Enclosure]) {
        self.bound(FunctionKind::Outputs, along, outputs);
    }

    fn inverse_dynamics(&self, at: At<'_>, accelerations: &[f64], demand: &mut [f64]) {
        let kind = FunctionKind::InverseDynamics;
        if self.has(kind) {
            self.evaluate_with(kind, at, accelerations, [demand]);
        } else {
            differences::inverse_dynamics(self, at, accelerations, demand);
        }
    }

    fn inverse_dynamics_jacobians(
        &self,
        at: At<'_>,
        accelerations: &[f64],
        demand: &mut [f64],
        by_state: &mut [f64],
        by_inputs: &mut [f64],
        mass: &mut [f64],
    ) {
        let kind = FunctionKind::InverseDynamicsJacobians;
        let results = [demand, by_state, by_inputs, mass];
        if self.has(kind) {
            self.evaluate_with(kind, at, accelerations, results);
        } else {
            differences::inverse_dynamics_jacobians(self, at, accelerations, results);
        }
    }

    fn has_adjoint(&self) -> bool {
        self.has(FunctionKind::Adjoint)
    }

    fn adjoint(&self, at: At<'_>, weights: &[f64], by: Gradient<'_>) {
        if self.has_adjoint() {
            let by = [by.x, by.u, by.p];
            self.evaluate_with(FunctionKind::Adjoint, at, weights, by);
        } else {
            differences::adjoint(self, at, weights, by);
        }
    }

    fn output_jacobians(&self, at: At<'_>, outputs: &mut [f64], c: &mut [f64], d: &mut [f64]) {
        if self.has(FunctionKind::OutputJacobians) {
            self.evaluate(FunctionKind::OutputJacobians, at, [outputs, c, d]);
        } else {
            differences::output_jacobians(self, at, [outputs, c, d]);
        }
    }

    fn output_adjoint(&self, at: At<'_>, weights: &[f64], by: Gradient<'_>) {
        if self.has(FunctionKind::OutputAdjoint) {
            let by = [by.x, by.u, by.p];
            self.evaluate_with(FunctionKind::OutputAdjoint, at, weights, by);
        } else {
            differences::output_adjoint(self, at, weights, by);
        }
    }

    fn dependent_coordinates(&self) -> &[usize] {
        self.tapes.dependent()
    }

    fn position_constraints(&self, at: At<'_>, residual: &mut [f64], jacobian: &mut [f64]) {
        self.evaluate(FunctionKind::PositionConstraints, at, [residual, jacobian]);
    }

    fn switching(&self) -> Option<&dyn Switching> {
        (!self.counts().is_none()).then_some(self)
    }
}

impl<E: Engine> Switching for ProgramModel<E> {
    fn counts(&self) -> Counts {
        self.tapes.switch_counts()
    }

    fn is_of_time_alone(&self) -> bool {
        let of_time = self.tapes.get(FunctionKind::TimeFunctions);
        of_time.is_none_or(|tape| !tape.has_parameters())
    }

    fn answers(&self, at: At<'_>, answers: &mut [f64]) {
        self.evaluate(FunctionKind::Switches, at, [answers]);
    }

    fn within(&self, time: Enclosure, p: &[f64], functions: &mut [Enclosure]) {
        let along = Along {
            start: f64::NAN,
            t: time,
            x: &[],
            u: &[],
            p,
        };
        self.bound(FunctionKind::TimeFunctions, &along, functions);
    }

    fn crossings(&self, at: At<'_>, crossings: &mut [f64]) {
        let count = self.tapes.switch_counts().crossings;
        let (crossings, pulses) = crossings.split_at_mut(count);
        self.evaluate(FunctionKind::Crossings, at, [crossings, pulses]);
    }

    fn crossings_within(&self, along: &Along<'_>, crossings: &mut [Enclosure]) {
        self.bound(FunctionKind::Crossings, along, crossings);
    }
}

impl<E> fmt::Debug for ProgramModel<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ProgramModel")
            .field("name", &self.tapes.info().name)
            .finish_non_exhaustive()
    }
}
