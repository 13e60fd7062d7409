//! Interprets a program, behind the trait of all models.
//!
//! It is slow and portable: the reference for emitted and compiled code, and the fallback where no machine code
//! can be generated.

use std::sync::OnceLock;

use appell_runtime::differences;
use appell_runtime::model::{Along, At, Energies, Gradient, Model, ModelInfo, Switching};
use appell_runtime::real::Enclosure;
use appell_runtime::switching::Counts;

use crate::program::{FunctionKind, Program};
use crate::schedule::schedule;
use crate::tape::{Tape, enclose, enclose_along, interpret_weighted};

/// A model that interprets its tapes. Functions that the program lacks return NaN.
#[derive(Debug)]
pub struct InterpretedModel {
    program: Program,
    /// By function of the program, created on first use.
    tapes: Vec<OnceLock<Tape>>,
}

impl InterpretedModel {
    /// A model of a program.
    pub fn new(program: Program) -> Self {
        let tapes = program.functions.iter().map(|_| OnceLock::new()).collect();
        Self { program, tapes }
    }

    /// The tape of a function, if the program has it.
    fn tape(&self, kind: FunctionKind) -> Option<&Tape> {
        let mut functions = self.program.functions.iter().zip(&self.tapes);
        let (function, lazy) = functions.find(|(function, _)| function.kind == kind)?;
        Some(lazy.get_or_init(|| schedule(&self.program, function)))
    }

    /// Fills each slice with the result of the given name.
    fn evaluate(&self, kind: FunctionKind, at: At<'_>, wanted: &mut [(&str, &mut [f64])]) {
        self.evaluate_weighted(kind, at, &[], wanted);
    }

    fn evaluate_weighted(
        &self,
        kind: FunctionKind,
        at: At<'_>,
        weights: &[f64],
        wanted: &mut [(&str, &mut [f64])],
    ) {
        let Some(tape) = self.tape(kind) else {
            for (_, to) in wanted.iter_mut() {
                to.fill(f64::NAN);
            }
            return;
        };
        let results = interpret_weighted(tape, at, weights);
        for (name, to) in wanted {
            match tape.results.iter().position(|r| r.name == *name) {
                Some(i) => to.copy_from_slice(&results[i]),
                None => to.fill(f64::NAN),
            }
        }
    }

    fn scalar(&self, kind: FunctionKind, at: At<'_>, name: &str) -> f64 {
        let mut value = [f64::NAN];
        self.evaluate(kind, at, &mut [(name, &mut value)]);
        value[0]
    }
}

impl Model for InterpretedModel {
    fn info(&self) -> &ModelInfo {
        &self.program.info
    }

    fn rates(&self, at: At<'_>, rates: &mut [f64]) {
        self.evaluate(FunctionKind::Rates, at, &mut [("rates", rates)]);
    }

    fn jacobians(&self, at: At<'_>, rates: &mut [f64], a: &mut [f64], b: &mut [f64]) {
        let wanted = &mut [("rates", rates), ("a", a), ("b", b)];
        self.evaluate(FunctionKind::Jacobians, at, wanted);
    }

    fn parameter_jacobian(&self, at: At<'_>, p: &mut [f64]) {
        match self.program.function(FunctionKind::ParameterJacobian) {
            Some(_) => self.evaluate(FunctionKind::ParameterJacobian, at, &mut [("p", p)]),
            None => differences::parameter_jacobian(self, at, p),
        }
    }

    fn appell(&self, at: At<'_>, mass: &mut [f64], bias: &mut [f64], forces: &mut [f64]) {
        let left = &mut [("mass_matrix", mass), ("bias", bias)];
        self.evaluate(FunctionKind::MassMatrixAndBias, at, left);
        self.evaluate(
            FunctionKind::GeneralizedForces,
            at,
            &mut [("generalized_forces", forces)],
        );
    }

    fn energies(&self, at: At<'_>) -> Energies {
        Energies {
            kinetic: self.scalar(FunctionKind::Energies, at, "kinetic"),
            potential: self.scalar(FunctionKind::Energies, at, "potential"),
            power: self.scalar(FunctionKind::Energies, at, "power"),
            acceleration: self.scalar(FunctionKind::AccelerationEnergy, at, "total"),
        }
    }

    fn constraint_residual(&self, at: At<'_>, residual: &mut [f64]) {
        self.evaluate(
            FunctionKind::ConstraintResidual,
            at,
            &mut [("residual", residual)],
        );
    }

    fn constraint_forces(&self, at: At<'_>, forces: &mut [f64]) {
        self.evaluate(
            FunctionKind::ConstraintForces,
            at,
            &mut [("forces", forces)],
        );
    }

    fn outputs(&self, at: At<'_>, outputs: &mut [f64]) {
        self.evaluate(FunctionKind::Outputs, at, &mut [("outputs", outputs)]);
    }

    fn inverse_dynamics(&self, at: At<'_>, accelerations: &[f64], demand: &mut [f64]) {
        let kind = FunctionKind::InverseDynamics;
        match self.program.function(kind) {
            Some(_) => {
                self.evaluate_weighted(kind, at, accelerations, &mut [("demand", demand)]);
            }
            None => differences::inverse_dynamics(self, at, accelerations, demand),
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
        if self.program.function(kind).is_none() {
            let results = [demand, by_state, by_inputs, mass];
            differences::inverse_dynamics_jacobians(self, at, accelerations, results);
            return;
        }
        let wanted = &mut [
            ("demand", demand),
            ("by_state", by_state),
            ("by_inputs", by_inputs),
            ("mass_matrix", mass),
        ];
        self.evaluate_weighted(kind, at, accelerations, wanted);
    }

    fn has_adjoint(&self) -> bool {
        self.program.function(FunctionKind::Adjoint).is_some()
    }

    fn adjoint(&self, at: At<'_>, weights: &[f64], by: Gradient<'_>) {
        if self.has_adjoint() {
            let wanted = &mut [("x", by.x), ("u", by.u), ("p", by.p)];
            self.evaluate_weighted(FunctionKind::Adjoint, at, weights, wanted);
        } else {
            differences::adjoint(self, at, weights, by);
        }
    }

    fn output_jacobians(&self, at: At<'_>, outputs: &mut [f64], c: &mut [f64], d: &mut [f64]) {
        let wanted = &mut [("outputs", &mut *outputs), ("c", &mut *c), ("d", &mut *d)];
        match self.program.function(FunctionKind::OutputJacobians) {
            Some(_) => self.evaluate(FunctionKind::OutputJacobians, at, wanted),
            None => differences::output_jacobians(self, at, [outputs, c, d]),
        }
    }

    fn output_adjoint(&self, at: At<'_>, weights: &[f64], by: Gradient<'_>) {
        match self.program.function(FunctionKind::OutputAdjoint) {
            Some(_) => {
                let wanted = &mut [("x", by.x), ("u", by.u), ("p", by.p)];
                self.evaluate_weighted(FunctionKind::OutputAdjoint, at, weights, wanted);
            }
            None => differences::output_adjoint(self, at, weights, by),
        }
    }

    fn dependent_coordinates(&self) -> &[usize] {
        &self.program.dependent
    }

    fn position_constraints(&self, at: At<'_>, residual: &mut [f64], jacobian: &mut [f64]) {
        let wanted = &mut [("residual", residual), ("jacobian", jacobian)];
        self.evaluate(FunctionKind::PositionConstraints, at, wanted);
    }

    fn switching(&self) -> Option<&dyn Switching> {
        (!self.counts().is_none()).then_some(self)
    }

    fn contacts(&self, at: At<'_>, normals: &mut [f64], friction: &mut [f64]) {
        let wanted = &mut [("normals", &mut *normals), ("friction", &mut *friction)];
        match self.program.function(FunctionKind::Contacts) {
            Some(_) => self.evaluate(FunctionKind::Contacts, at, wanted),
            None => self.info().initial_contacts(normals, friction),
        }
    }

    fn system_sizes(&self) -> &[usize] {
        &self.program.systems
    }

    fn systems(&self, at: At<'_>, matrices: &mut [f64]) {
        self.evaluate(FunctionKind::Systems, at, &mut [("matrices", matrices)]);
    }
}

impl Switching for InterpretedModel {
    fn counts(&self) -> Counts {
        self.program.switch_counts()
    }

    fn answers(&self, at: At<'_>, answers: &mut [f64]) {
        self.evaluate(FunctionKind::Switches, at, &mut [("switches", answers)]);
    }

    fn within(&self, time: Enclosure, p: &[f64], functions: &mut [Enclosure]) {
        if let Some(tape) = self.tape(FunctionKind::TimeFunctions) {
            enclose(tape, time, p, functions);
        }
    }

    fn crossings(&self, at: At<'_>, crossings: &mut [f64]) {
        let count = self.program.switch_counts().crossings;
        let (crossings, pulses) = crossings.split_at_mut(count);
        let all = &mut [("crossings", crossings), ("pulses", pulses)];
        self.evaluate(FunctionKind::Crossings, at, all);
    }

    fn crossings_within(&self, along: &Along<'_>, crossings: &mut [Enclosure]) {
        if let Some(tape) = self.tape(FunctionKind::Crossings) {
            enclose_along(tape, along, crossings);
        }
    }
}
