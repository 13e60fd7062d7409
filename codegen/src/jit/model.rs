//! A program compiled to machine code that implements the trait `Model`.

use std::fmt;
use std::slice::from_mut;
use std::sync::Arc;

use appell_runtime::differences;
use appell_runtime::model::{Along, At, Energies, Gradient, Model, ModelInfo, Switching};
use appell_runtime::real::Enclosure;
use appell_runtime::switching::Counts;

use super::host::Use;
use super::on_demand::OnDemand;
use super::{JitError, Sizes};
use crate::program::{FunctionKind, Program};
use crate::tape::{Tape, enclose, enclose_along};
use crate::symbolic::Rational;

/// A model compiled in this process.
///
/// The rates are compiled immediately, every other function at its first use: most users need few of them, and
/// finding a short tape for all derivatives takes longer than compiling it. Concurrent calls of the same function
/// wait for its compilation. Functions that are too long to be compiled are interpreted with the same results;
/// [`Self::interpreted`] lists these.
///
/// [`Self::without`] specialises it for parameters that are zero.
pub struct JitModel {
    program: Arc<Program>,
    sizes: Sizes,
    /// By [`FunctionKind`], in the order of its variants.
    parts: Vec<OnDemand>,
    /// The general model, if this one is specialised.
    whole: Option<Whole>,
}

/// The model without specialisation.
struct Whole {
    model: Arc<JitModel>,
    /// The parameters that are zero in the specialised model.
    zeros: Vec<usize>,
}

impl Whole {
    fn is_needed(&self, p: &[f64]) -> bool {
        self.zeros.iter().any(|&index| p[index] != 0.0)
    }

    /// The tape of a function of the specialised model.
    fn tape(&self, kind: FunctionKind) -> Tape {
        let Self { model, zeros } = self;
        let is_zero = |index: usize| zeros.binary_search(&index).is_ok();
        let mut tape = model.part(kind).tape(&model.program).clone();
        let parameters = model.sizes.parameters.max(1);
        let by_parameters = matches!(
            kind,
            FunctionKind::ParameterJacobian | FunctionKind::Adjoint | FunctionKind::OutputAdjoint
        );
        let zero = tape.constant(Rational::ZERO);
        let slopes = tape.results.iter_mut();
        for result in slopes.filter(|result| by_parameters && result.name == "p") {
            for (place, entry) in result.entries.iter_mut().enumerate() {
                if is_zero(place % parameters) {
                    *entry = zero;
                }
            }
        }
        tape.without(is_zero)
    }
}

/// The results required by the trait, with their lengths.
///
/// Other results of a function are omitted from the machine code. The remaining values do not change: the tape is
/// that of the whole function.
fn results(kind: FunctionKind, program: &Program) -> Vec<(&'static str, usize)> {
    let info = &program.info;
    let (n, m, k) = (info.state_len(), info.input_len(), info.parameter_len());
    let speeds = info.speeds;
    match kind {
        // Other functions return them too.
        FunctionKind::Kinematics | FunctionKind::MassMatrix | FunctionKind::Bias => vec![],
        FunctionKind::AccelerationEnergy => vec![("total", 1)],
        FunctionKind::MassMatrixAndBias => {
            vec![("mass_matrix", speeds * speeds), ("bias", speeds)]
        }
        FunctionKind::GeneralizedForces => vec![("generalized_forces", speeds)],
        FunctionKind::Rates => vec![("rates", n)],
        // Derivatives, not needed for simulation; a program may lack them.
        FunctionKind::Jacobians | FunctionKind::ParameterJacobian
            if program.function(kind).is_none() =>
        {
            vec![]
        }
        FunctionKind::Jacobians => vec![("rates", n), ("a", n * n), ("b", n * m)],
        FunctionKind::ParameterJacobian => vec![("p", n * k)],
        FunctionKind::Energies => vec![("kinetic", 1), ("potential", 1), ("power", 1)],
        FunctionKind::ConstraintResidual => vec![("residual", info.constraint_rows.len())],
        FunctionKind::ConstraintForces => vec![("forces", 3 * info.reactions.len())],
        FunctionKind::Outputs => vec![("outputs", info.output_len())],
        FunctionKind::Switches => vec![("switches", program.switch_len())],
        FunctionKind::TimeFunctions => {
            let counts = program.switch_counts();
            vec![("functions", counts.answers), ("shapes", counts.shapes)]
        }
        FunctionKind::Crossings => {
            let counts = program.switch_counts();
            vec![("crossings", counts.crossings), ("pulses", counts.pulses)]
        }
        FunctionKind::PositionConstraints => {
            let count = program.dependent.len();
            let coordinates = info.state_len() - info.speeds;
            vec![("residual", count), ("jacobian", count * coordinates)]
        }
        FunctionKind::Contacts => {
            let count = match program.function(kind) {
                Some(_) => info.contacts.len(),
                None => 0,
            };
            vec![("normals", 3 * count), ("friction", count)]
        }
        FunctionKind::Systems => {
            let entries = program.systems.iter().map(|size| size * size);
            vec![("matrices", entries.sum())]
        }
        // Optional functions that the program lacks.
        _ if program.function(kind).is_none() => vec![],
        FunctionKind::Adjoint | FunctionKind::OutputAdjoint => {
            vec![("x", n), ("u", m), ("p", k)]
        }
        FunctionKind::InverseDynamics => vec![("demand", info.speeds)],
        FunctionKind::InverseDynamicsJacobians => {
            let s = info.speeds;
            vec![
                ("demand", s),
                ("by_state", s * n),
                ("by_inputs", s * m),
                ("mass_matrix", s * s),
            ]
        }
        FunctionKind::Regressor => vec![],
        FunctionKind::OutputJacobians => {
            let l = info.output_len();
            vec![("outputs", l), ("c", l * n), ("d", l * m)]
        }
    }
}

impl JitModel {
    /// Compiles the rates of a program and prepares its other functions.
    pub fn new(program: &Program) -> Result<Self, JitError> {
        let sizes = Sizes::from(&program.info);
        let parts = FunctionKind::ALL
            .iter()
            .map(|&kind| OnDemand::new(program, kind, results(kind, program), Use::Lasting))
            .collect::<Result<_, _>>()?;
        let model = Self {
            program: Arc::new(program.clone()),
            sizes,
            parts,
            whole: None,
        };
        // An unsupported processor is detected here and not during a simulation.
        model.part(FunctionKind::Rates).compile(program, sizes)?;
        Ok(model)
    }

    /// The same model, specialised for zero parameters. Derivatives with respect to these are omitted and read as
    /// zero. If one of them is not zero, the general model is evaluated.
    pub fn without(self: &Arc<Self>, zeros: &[usize]) -> Result<Self, JitError> {
        let parts = FunctionKind::ALL
            .iter()
            .map(|&kind| {
                let wanted = results(kind, &self.program);
                OnDemand::new(&self.program, kind, wanted, Use::Brief)
            })
            .collect::<Result<_, _>>()?;
        let mut zeros = zeros.to_vec();
        zeros.sort_unstable();
        Ok(Self {
            program: self.program.clone(),
            sizes: self.sizes,
            parts,
            whole: Some(Whole {
                model: self.clone(),
                zeros,
            }),
        })
    }

    /// Compiles all functions now instead of at their first use.
    pub fn compile_all(&self) {
        for part in &self.parts {
            part.prepare(&self.program, self.sizes);
        }
    }

    /// The functions used so far that are interpreted, with the reason.
    pub fn interpreted(&self) -> impl Iterator<Item = (FunctionKind, &JitError)> {
        FunctionKind::ALL
            .into_iter()
            .zip(&self.parts)
            .filter_map(|(kind, part)| Some((kind, part.reason()?)))
    }

    fn part(&self, kind: FunctionKind) -> &OnDemand {
        let part = &self.parts[kind as usize];
        if let Some(whole) = &self.whole {
            part.follow(|| whole.tape(kind));
        }
        part
    }

    /// The model to be evaluated at given parameters.
    fn at(&self, p: &[f64]) -> &Self {
        match &self.whole {
            Some(whole) if whole.is_needed(p) => &whole.model,
            _ => self,
        }
    }

    fn evaluate<const N: usize>(&self, kind: FunctionKind, at: At<'_>, results: [&mut [f64]; N]) {
        self.evaluate_weighted(kind, at, &[], results);
    }

    fn evaluate_weighted<const N: usize>(
        &self,
        kind: FunctionKind,
        at: At<'_>,
        weights: &[f64],
        results: [&mut [f64]; N],
    ) {
        let part = self.at(at.p).part(kind);
        part.call(&self.program, self.sizes, at, weights, results);
    }
}

/// Every method panics if a slice does not have the length required by the trait.
impl Model for JitModel {
    fn info(&self) -> &ModelInfo {
        &self.program.info
    }

    fn rates(&self, at: At<'_>, rates: &mut [f64]) {
        self.evaluate(FunctionKind::Rates, at, [rates]);
    }

    fn jacobians(&self, at: At<'_>, rates: &mut [f64], a: &mut [f64], b: &mut [f64]) {
        self.evaluate(FunctionKind::Jacobians, at, [rates, a, b]);
    }

    fn parameter_jacobian(&self, at: At<'_>, p: &mut [f64]) {
        match self.program.function(FunctionKind::ParameterJacobian) {
            Some(_) => self.evaluate(FunctionKind::ParameterJacobian, at, [p]),
            None => differences::parameter_jacobian(self, at, p),
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
        let scalars = [kinetic, potential, power].map(from_mut);
        self.evaluate(
            FunctionKind::Energies,
            at,
            scalars.map(|scalar| &mut scalar[..]),
        );
        self.evaluate(
            FunctionKind::AccelerationEnergy,
            at,
            [from_mut(acceleration)],
        );
        energies
    }

    fn constraint_residual(&self, at: At<'_>, residual: &mut [f64]) {
        self.evaluate(FunctionKind::ConstraintResidual, at, [residual]);
    }

    fn constraint_forces(&self, at: At<'_>, forces: &mut [f64]) {
        self.evaluate(FunctionKind::ConstraintForces, at, [forces]);
    }

    fn outputs(&self, at: At<'_>, outputs: &mut [f64]) {
        self.evaluate(FunctionKind::Outputs, at, [outputs]);
    }

    fn outputs_within(&self, along: &Along<'_>, outputs: &mut [Enclosure]) {
        let part = self.at(along.p).part(FunctionKind::Outputs);
        enclose_along(part.tape(&self.program), along, outputs);
    }

    fn inverse_dynamics(&self, at: At<'_>, accelerations: &[f64], demand: &mut [f64]) {
        let kind = FunctionKind::InverseDynamics;
        match self.program.function(kind) {
            Some(_) => self.evaluate_weighted(kind, at, accelerations, [demand]),
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
        let results = [demand, by_state, by_inputs, mass];
        match self.program.function(kind) {
            Some(_) => self.evaluate_weighted(kind, at, accelerations, results),
            None => differences::inverse_dynamics_jacobians(self, at, accelerations, results),
        }
    }

    fn has_adjoint(&self) -> bool {
        self.program.function(FunctionKind::Adjoint).is_some()
    }

    fn adjoint(&self, at: At<'_>, weights: &[f64], by: Gradient<'_>) {
        if self.has_adjoint() {
            let by = [by.x, by.u, by.p];
            self.evaluate_weighted(FunctionKind::Adjoint, at, weights, by);
        } else {
            differences::adjoint(self, at, weights, by);
        }
    }

    fn output_jacobians(&self, at: At<'_>, outputs: &mut [f64], c: &mut [f64], d: &mut [f64]) {
        match self.program.function(FunctionKind::OutputJacobians) {
            Some(_) => self.evaluate(FunctionKind::OutputJacobians, at, [outputs, c, d]),
            None => differences::output_jacobians(self, at, [outputs, c, d]),
        }
    }

    fn output_adjoint(&self, at: At<'_>, weights: &[f64], by: Gradient<'_>) {
        match self.program.function(FunctionKind::OutputAdjoint) {
            Some(_) => {
                let by = [by.x, by.u, by.p];
                self.evaluate_weighted(FunctionKind::OutputAdjoint, at, weights, by);
            }
            None => differences::output_adjoint(self, at, weights, by),
        }
    }

    fn dependent_coordinates(&self) -> &[usize] {
        &self.program.dependent
    }

    fn position_constraints(&self, at: At<'_>, residual: &mut [f64], jacobian: &mut [f64]) {
        self.evaluate(FunctionKind::PositionConstraints, at, [residual, jacobian]);
    }

    fn switching(&self) -> Option<&dyn Switching> {
        (!self.counts().is_none()).then_some(self)
    }

    fn contacts(&self, at: At<'_>, normals: &mut [f64], friction: &mut [f64]) {
        match self.program.function(FunctionKind::Contacts) {
            Some(_) => self.evaluate(FunctionKind::Contacts, at, [normals, friction]),
            None => self.info().initial_contacts(normals, friction),
        }
    }

    fn system_sizes(&self) -> &[usize] {
        &self.program.systems
    }

    fn systems(&self, at: At<'_>, matrices: &mut [f64]) {
        self.evaluate(FunctionKind::Systems, at, [matrices]);
    }
}

impl Switching for JitModel {
    fn counts(&self) -> Counts {
        self.program.switch_counts()
    }

    fn answers(&self, at: At<'_>, answers: &mut [f64]) {
        self.evaluate(FunctionKind::Switches, at, [answers]);
    }

    fn within(&self, time: Enclosure, p: &[f64], functions: &mut [Enclosure]) {
        let part = self.at(p).part(FunctionKind::TimeFunctions);
        enclose(part.tape(&self.program), time, p, functions);
    }

    fn crossings(&self, at: At<'_>, crossings: &mut [f64]) {
        let count = self.program.switch_counts().crossings;
        let (crossings, pulses) = crossings.split_at_mut(count);
        self.evaluate(FunctionKind::Crossings, at, [crossings, pulses]);
    }

    fn crossings_within(&self, along: &Along<'_>, crossings: &mut [Enclosure]) {
        let part = self.at(along.p).part(FunctionKind::Crossings);
        enclose_along(part.tape(&self.program), along, crossings);
    }
}

impl fmt::Debug for JitModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("JitModel")
            .field("name", &self.program.info.name)
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The kind after another one. A new kind needs an arm here, and with it an entry in the list.
    fn after(kind: FunctionKind) -> Option<FunctionKind> {
        use FunctionKind as Kind;
        Some(match kind {
            Kind::Kinematics => Kind::AccelerationEnergy,
            Kind::AccelerationEnergy => Kind::MassMatrix,
            Kind::MassMatrix => Kind::Bias,
            Kind::Bias => Kind::MassMatrixAndBias,
            Kind::MassMatrixAndBias => Kind::GeneralizedForces,
            Kind::GeneralizedForces => Kind::Rates,
            Kind::Rates => Kind::Jacobians,
            Kind::Jacobians => Kind::ParameterJacobian,
            Kind::ParameterJacobian => Kind::Energies,
            Kind::Energies => Kind::ConstraintResidual,
            Kind::ConstraintResidual => Kind::ConstraintForces,
            Kind::ConstraintForces => Kind::Outputs,
            Kind::Outputs => Kind::Switches,
            Kind::Switches => Kind::TimeFunctions,
            Kind::TimeFunctions => Kind::Crossings,
            Kind::Crossings => Kind::PositionConstraints,
            Kind::PositionConstraints => Kind::Contacts,
            Kind::Contacts => Kind::Systems,
            Kind::Systems => Kind::InverseDynamics,
            Kind::InverseDynamics => Kind::InverseDynamicsJacobians,
            Kind::InverseDynamicsJacobians => Kind::Adjoint,
            Kind::Adjoint => Kind::OutputJacobians,
            Kind::OutputJacobians => Kind::OutputAdjoint,
            Kind::OutputAdjoint | Kind::Regressor => return None,
        })
    }

    #[test]
    fn the_list_of_kinds_lacks_none_and_has_each_at_its_index() {
        let all: Vec<_> =
            std::iter::successors(Some(FunctionKind::Kinematics), |&k| after(k)).collect();
        assert_eq!(FunctionKind::ALL.to_vec(), all);
        for (index, kind) in all.into_iter().enumerate() {
            assert_eq!(kind as usize, index);
        }
    }

    #[test]
    fn models_are_shared_between_threads() {
        fn shared<T: Send + Sync>() {}
        shared::<JitModel>();
    }
}
