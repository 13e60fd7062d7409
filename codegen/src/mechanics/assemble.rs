//! Assembles the derived equations as the functions of a program.

mod functions;
mod labels;

use appell_runtime::model::{ModelInfo, Quantity};
use appell_spec::mechanism::{ConstraintId, FrameId, Mechanism};

use super::Derivation;
use super::arguments::input_symbols;
use super::expressions::Setting;
use super::finding::Outcome;
use super::gibbs_appell::{
    ActualMotion, BodyMotion, acceleration_energies, acceleration_energy,
    kinetic_energy_by_velocity, motions_in_ground,
};
use super::glossary;
use super::letters;
use super::linear::ImplicitMotion;
use super::linear_bound::BoundMotion;
use super::motion::Motion;
use super::positions::Positions;
use super::reactions;
use super::recursion::Recursion;
use super::systems::systems;
use crate::program::{Array, Function, FunctionKind, Layout, Space};
use crate::symbolic::vector::Vec3;
use crate::symbolic::{Expr, Graph};
pub use functions::{Functions, program};
use labels::{Source, embedded};
pub(super) use labels::{by_speed, listed, paired};

impl Derivation {
    /// The results of one function.
    fn results(
        &mut self,
        mechanism: &Mechanism,
        info: &ModelInfo,
        kind: FunctionKind,
    ) -> Outcome<Vec<Array>> {
        let speeds = &info.states[..info.speeds];
        let coordinates = &info.states[info.speeds..];
        Ok(match kind {
            FunctionKind::Kinematics => {
                let rates = self.rolling_rates.clone();
                let all = 0..rates.len();
                let labels = coordinates.iter().map(|q| format!("{}_dot", q.name));
                let layout = Layout::Vector(Space::CoordinateRates);
                let array = Array::new("coordinate_rates", "q̇.", layout, rates);
                vec![array.labelled(labels).under(VELOCITIES, all)]
            }
            FunctionKind::AccelerationEnergy => self.acceleration_energies(),
            FunctionKind::MassMatrix => vec![self.mass_matrix(mechanism, speeds)],
            FunctionKind::Bias => vec![self.bias(speeds)],
            FunctionKind::MassMatrixAndBias => {
                vec![self.mass_matrix(mechanism, speeds), self.bias(speeds)]
            }
            FunctionKind::GeneralizedForces => {
                let forces = self.forces.clone();
                let (name, about) = ("generalized_forces", "Pseudo-forces.");
                vec![by_speed("force", name, about, speeds, forces)]
            }
            FunctionKind::Rates => vec![Array::rates(info, self.rates())],
            FunctionKind::Jacobians => {
                let symbols = &self.symbols;
                let states = [symbols.speeds.as_slice(), &symbols.coordinates].concat();
                let inputs = input_symbols(symbols, info);
                let [a, b] = self.derivatives([&states, &inputs])?;
                let factorized = self.factorized_motion().accelerations;
                let rates = [factorized, self.coordinate_rates.clone()].concat();
                vec![
                    Array::rates(info, rates),
                    Array::jacobian("a", A, info, Space::State, a),
                    Array::jacobian("b", B, info, Space::Inputs, b),
                ]
            }
            FunctionKind::ParameterJacobian => {
                let parameters = self.symbols.parameters.clone();
                let [p] = self.derivatives([&parameters])?;
                vec![Array::jacobian("p", P, info, Space::Parameters, p)]
            }
            FunctionKind::Energies => self.energies(mechanism)?,
            FunctionKind::ConstraintResidual => vec![self.constraint_residual(mechanism)],
            FunctionKind::ConstraintForces => vec![self.constraint_forces(mechanism)?],
            FunctionKind::Outputs => self.outputs(mechanism)?,
            FunctionKind::PositionConstraints => {
                let Positions {
                    names,
                    residual,
                    jacobian,
                    ..
                } = &self.positions;
                let columns = coordinates.iter().map(|q| q.name.to_string());
                let layout = Layout::Matrix(names.len(), coordinates.len());
                let rows = names.iter();
                let labels = rows.flat_map(|name| listed(&format!("d_{name}_d"), coordinates));
                let count = Layout::List(names.len());
                vec![
                    Array::new("residual", "f(q, t).", count, residual.clone())
                        .labelled(names.iter().cloned())
                        .with_names(names.clone(), Vec::new()),
                    Array::new("jacobian", "∂f/∂q, by row.", layout, jacobian.concat())
                        .labelled(labels)
                        .with_names(names.clone(), columns.collect()),
                ]
            }
            FunctionKind::Switches | FunctionKind::TimeFunctions | FunctionKind::Crossings => {
                self.switch_arrays(kind)
            }
            FunctionKind::Contacts => self.surfaces(),
            FunctionKind::Systems => {
                let systems = systems(&self.algebra.graph, &self.rates());
                let matrices: Vec<Expr> = systems.into_iter().flat_map(|(_, m)| m).collect();
                let layout = Layout::List(matrices.len());
                vec![Array::new("matrices", "Matrices.", layout, matrices)]
            }
            FunctionKind::InverseDynamics => vec![self.inverse_dynamics(speeds)],
            FunctionKind::InverseDynamicsJacobians => {
                self.inverse_dynamics_jacobians(mechanism, info)?
            }
            FunctionKind::Adjoint => self.adjoint(info)?,
            // It is derived from other bodies, in `regressor.rs`.
            FunctionKind::Regressor => Vec::new(),
            FunctionKind::OutputJacobians => self.output_jacobians(mechanism, info)?,
            FunctionKind::OutputAdjoint => self.output_adjoint(mechanism, info)?,
        })
    }

    /// The solved equations of motion.
    fn equations(&mut self) -> Vec<[Expr; 2]> {
        let graph = &mut self.algebra.graph;
        let right: Vec<Expr> = (self.forces.iter())
            .zip(&self.gibbs.bias)
            .map(|(&force, &bias)| graph.sub(force, bias))
            .collect();
        let unknowns = &self.symbols.accelerations;
        self.motion
            .equations(graph, &self.gibbs.mass_matrix, &right, unknowns)
    }

    pub(super) fn mass_matrix(&self, mechanism: &Mechanism, speeds: &[Quantity]) -> Array {
        let entries = self.gibbs.mass_matrix.concat();
        let all = 0..entries.len();
        let layout = Layout::Matrix(speeds.len(), speeds.len());
        let labels = paired(letters::mass(mechanism), speeds, speeds);
        let array = Array::new("mass_matrix", "M.", layout, entries);
        array.labelled(labels.into_iter()).under("Entries.", all)
    }

    fn bias(&self, speeds: &[Quantity]) -> Array {
        by_speed("bias", "bias", "Bias.", speeds, self.gibbs.bias.clone())
    }

    /// A function with intermediate quantities displayed before its results.
    fn staged(&mut self, mechanism: &Mechanism, function: Function) -> Function {
        use FunctionKind as F;
        let accelerations = self.motion.accelerations.clone();
        match function.kind {
            F::ConstraintResidual => function
                .by_way_of(VELOCITIES, self.rolling_rates.clone())
                .explaining(glossary::of_rows(mechanism, &self.constraints))
                .remarking(embedded(mechanism, &self.constraints)),
            F::Energies => self.staged_by_velocities(mechanism, function),
            F::Bias
            | F::MassMatrixAndBias
            | F::Rates
            | F::Jacobians
            | F::InverseDynamics
            | F::InverseDynamicsJacobians => {
                let bodies = self.bodies.clone();
                self.explained(mechanism, function, &bodies)
            }
            F::ParameterJacobian => {
                let bodies = self.bodies.clone();
                let function = function.by_way_of(SOLVED, accelerations);
                self.explained(mechanism, function, &bodies)
            }
            F::AccelerationEnergy => {
                let bodies = self.bodies.clone();
                let mut function = self.staged_by_accelerations(mechanism, function, &bodies);
                for (id, body) in mechanism.bodies.ids().zip(&bodies) {
                    let parts = acceleration_energies(&mut self.algebra, body, &accelerations);
                    function = function.by_way_of(&Source(mechanism).of_body(id), parts.to_vec());
                }
                function
            }
            F::ConstraintForces => {
                let bodies = self.bodies_in_ground(mechanism);
                self.staged_by_accelerations(mechanism, function, &bodies)
                    .explaining(glossary::of_multipliers(mechanism, &self.constraints))
            }
            F::Kinematics
            | F::Regressor
            | F::MassMatrix
            | F::GeneralizedForces
            | F::Switches
            | F::TimeFunctions
            | F::Crossings
            | F::PositionConstraints
            | F::Contacts
            | F::Systems => function,
            F::Outputs | F::OutputJacobians => {
                if self.outputs_need_accelerations() {
                    let bodies = self.bodies.clone();
                    let function = function.by_way_of(SOLVED, accelerations);
                    self.explained(mechanism, function, &bodies)
                } else {
                    function
                }
            }
            F::Adjoint | F::OutputAdjoint => function.explaining(glossary::of_weights()),
        }
    }

    /// A function with a glossary of the names that it may use.
    pub(super) fn explained(
        &self,
        mechanism: &Mechanism,
        function: Function,
        bodies: &[BodyMotion],
    ) -> Function {
        let (terms, groups) = match &self.recursion {
            Some(tree) => (Recursion::terms(), tree.groups()),
            None => (
                glossary::of_motions(mechanism, &self.kinematics, bodies),
                glossary::groups_of_motions(mechanism, bodies),
            ),
        };
        function
            .explaining(terms)
            .explaining(glossary::of_solution(mechanism, &self.motion))
            .grouping(groups)
            .grouping(glossary::groups_of_solution(mechanism, &self.motion))
    }

    /// The velocities of the bodies, then their kinetic energies.
    fn staged_by_velocities(&mut self, mechanism: &Mechanism, mut function: Function) -> Function {
        let letter = letters::kinetic(mechanism);
        for (id, body) in mechanism.bodies.ids().zip(&self.bodies) {
            let (v, energy) = kinetic_energy_by_velocity(&mut self.algebra, body, letter);
            let frame = &mechanism.frames[body.centre.velocity.frame].name;
            let title = format!("Velocity of `{}`, along `{frame}`.", body.centre.point);
            function = function
                .by_way_of(&title, v.to_vec())
                .by_way_of(&Source(mechanism).of_body(id), vec![energy]);
        }
        function
    }

    /// The solved equations, then the accelerations of the bodies.
    fn staged_by_accelerations(
        &mut self,
        mechanism: &Mechanism,
        function: Function,
        bodies: &[BodyMotion],
    ) -> Function {
        let accelerations = self.motion.accelerations.clone();
        let mut function = function.by_way_of(SOLVED, accelerations.clone());
        for body in bodies {
            let motion = ActualMotion::new(&mut self.algebra, body, &accelerations);
            let frame = |frame: FrameId| &mechanism.frames[frame].name;
            let a_in = frame(body.centre.velocity.frame);
            let title = format!("Acceleration of `{}`, along `{a_in}`.", body.centre.point);
            function = function.by_way_of(&title, motion.a.to_vec());
            if let Some(rotation) = &body.rotation {
                let alpha_in = frame(rotation.velocity.frame);
                let title = format!("Rotation of `{}`, along `{alpha_in}`.", body.name);
                let turning = [motion.alpha, motion.momentum_rate].concat();
                function = function.by_way_of(&title, turning);
            }
        }
        self.explained(mechanism, function, bodies)
    }

    /// The constraint rows that geometry does not embed, evaluated at the generalised velocities.
    fn constraint_residual(&mut self, mechanism: &Mechanism) -> Array {
        let graph = &mut self.algebra.graph;
        let residual = reactions::residual(graph, &self.constraints, &self.rolling_rates);
        let rows = || {
            let rows = self.constraints.rows.iter();
            rows.filter(|row| !row.is_embedded())
        };
        let layout = Layout::Vector(Space::ConstraintRows);
        let mut array = Array::new("residual", "Constraint rows.", layout, residual)
            .labelled(rows().map(|row| format!("residual_{}", row.name)));
        let constraints: Vec<ConstraintId> = rows().map(|row| row.constraint).collect();
        let mut start = 0;
        for same in constraints.chunk_by(|a, b| a == b) {
            let title = Source(mechanism).of_constraint(same[0]);
            array = array.under(&title, start..start + same.len());
            start += same.len();
        }
        array
    }

    /// The bodies for the reactions; dependent speeds are not differentiated again.
    pub(super) fn bodies_in_ground(&mut self, mechanism: &Mechanism) -> Vec<BodyMotion> {
        if !self.dependent.values.is_empty() {
            return self.bodies.clone();
        }
        let setting = Setting::new(mechanism, &self.symbols, &self.velocities.rates);
        motions_in_ground(&mut self.algebra, setting, &self.kinematics, &self.bodies)
    }

    /// Normals and friction of the contacts, unless they are constant.
    fn surfaces(&self) -> Vec<Array> {
        let graph = &self.algebra.graph;
        let mut contacts = self.contacts.iter();
        if contacts.all(|contact| contact.is_constant(graph)) {
            return Vec::new();
        }
        let places = self.contacts.iter().map(|contact| contact.place);
        let names = places.map(|place| self.constraints.reactions[place].name.to_string());
        let names: Vec<String> = names.collect();
        let normals = self.contacts.iter().flat_map(|contact| contact.normal);
        let friction = self.contacts.iter().map(|contact| contact.friction);
        let friction = friction.map(|friction| friction.unwrap_or(Graph::ZERO));
        let count = names.len();
        let labels = |name: &String| ["x", "y", "z"].map(|axis| format!("n_{name}_{axis}"));
        let axes = ["x", "y", "z"].map(|axis| format!("ground {axis}"));
        let (matrix, list) = (Layout::Matrix(count, 3), Layout::List(count));
        let (of_normals, of_friction) = ("Normals in the ground.", "Coefficients of friction.");
        vec![
            Array::new("normals", of_normals, matrix, normals.collect())
                .labelled(names.iter().flat_map(labels))
                .with_names(names.clone(), axes.to_vec()),
            Array::new("friction", of_friction, list, friction.collect())
                .labelled(names.iter().map(|name| format!("friction_{name}")))
                .with_names(names.clone(), Vec::new()),
        ]
    }

    /// Reactions in ground components, by place.
    pub(super) fn reactions(&mut self, mechanism: &Mechanism) -> Outcome<Vec<Vec3>> {
        let bodies = self.bodies_in_ground(mechanism);
        reactions::reactions(
            &mut self.algebra,
            Setting::free(mechanism, &self.symbols),
            &self.constraints,
            &self.velocities.violating,
            &bodies,
            &self.motion.accelerations,
            &self.reactions_in_loads,
        )
    }

    /// One row per reaction.
    fn constraint_forces(&mut self, mechanism: &Mechanism) -> Outcome<Array> {
        let forces = self.reactions(mechanism)?;
        let layout = Layout::Rows(Space::Reactions, 3);
        let reactions = self.constraints.reactions.iter();
        let places: Vec<String> = reactions.map(|at| at.name.to_string()).collect();
        let force = letters::reaction(mechanism);
        let label = |place: &String| ["x", "y", "z"].map(|axis| format!("{force}_{place}_{axis}"));
        let about = "Reactions in the ground.";
        let mut array = Array::new("forces", about, layout, forces.concat())
            .labelled(places.iter().flat_map(label));
        for (i, place) in places.iter().enumerate() {
            array = array.under(&format!("Reaction `{place}`."), 3 * i..3 * i + 3);
        }
        Ok(array)
    }

    /// S at the actual accelerations: the sum, then the terms by body.
    fn acceleration_energies(&mut self) -> Vec<Array> {
        let mut results = Vec::with_capacity(self.bodies.len() + 1);
        for body in self.bodies.clone() {
            let s = acceleration_energy(&mut self.algebra, &body, &self.motion.accelerations);
            let label = format!("s_{}", body.name);
            let s = self.algebra.graph.name(&label, s);
            let about = format!("Of `{}`, in W/s.", body.name);
            let mut name = body.name.clone();
            while name == "total" || results.iter().any(|other: &Array| other.name == name) {
                name.push('_');
            }
            results.push(Array::scalar(&name, &about, s).labelled(std::iter::once(label)));
        }
        let parts: Vec<Expr> = results.iter().map(|r| r.entries[0]).collect();
        let total = self.algebra.graph.sum(&parts);
        let total = Array::scalar("total", "Sum over the bodies, in W/s.", total);
        results.insert(0, total);
        results
    }

    /// T, V, the power of non-conservative loads and the power of prescribed motions.
    fn energies(&mut self, mechanism: &Mechanism) -> Outcome<Vec<Array>> {
        let letter = letters::kinetic(mechanism);
        let bodies = self.bodies.clone();
        let kinetic: Vec<Expr> = bodies
            .iter()
            .map(|body| kinetic_energy_by_velocity(&mut self.algebra, body, letter).1)
            .collect();
        let accelerations = self.motion.accelerations.clone();
        let prescribed = self.prescribed_power(&accelerations)?;
        let graph = &mut self.algebra.graph;
        let potential: Vec<Expr> = self
            .loads
            .iter()
            .filter_map(|load| load.potential)
            .collect();
        let loads = self.loads.iter();
        let mut power: Vec<Expr> = loads.map(|l| l.power_without_potential(graph)).collect();
        power.push(prescribed);
        let about_power = if prescribed == Graph::ZERO {
            "Power of the loads without a potential, in W."
        } else {
            "Power of the loads without a potential and of the prescribed motion, in W."
        };
        let arrays = [
            ("kinetic", "Kinetic energy, in J.", kinetic),
            ("potential", "Potential energy, in J.", potential),
            ("power", about_power, power),
        ]
        .map(|(name, about, parts)| {
            Array::scalar(name, about, graph.sum(&parts)).under(about, 0..1)
        });
        Ok(arrays.into())
    }

    /// ẋ: pseudo-accelerations, then generalised velocities.
    pub(super) fn rates(&self) -> Vec<Expr> {
        [self.motion.accelerations.as_slice(), &self.coordinate_rates].concat()
    }

    /// The motion with ω̇ from the factorised M, which the derivatives of ω̇ also use.
    fn factorized_motion(&self) -> Motion {
        let mut motion = self.motion.clone();
        if let Some(tree) = &self.recursion {
            motion.accelerations.clone_from(&tree.factorized);
        }
        motion
    }

    /// Derivatives of ẋ with respect to each list of variables, row by row.
    pub(super) fn derivatives<const N: usize>(
        &mut self,
        variables: [&[Expr]; N],
    ) -> Outcome<[Vec<Expr>; N]> {
        let motion = self.factorized_motion();
        let (algebra, symbols) = (&mut self.algebra, &self.symbols);
        let rows = motion.accelerations.len() + self.coordinate_rates.len();
        let mut columns_of: Vec<Vec<Vec<Expr>>> = Vec::with_capacity(N);
        if self.dependent.values.is_empty() {
            let implicit = ImplicitMotion {
                gibbs: &self.gibbs,
                forces: &self.forces,
                motion: &motion,
                coordinate_rates: &self.coordinate_rates,
            };
            let tree = self.recursion.as_ref();
            let residual = match tree {
                Some(tree) => tree.residual(algebra, &symbols.accelerations),
                None => implicit.residual(algebra, symbols),
            };
            for variables in variables {
                let are_parameters = variables.iter().all(|z| symbols.parameters.contains(z));
                columns_of.push(match tree {
                    Some(tree) if !are_parameters => {
                        implicit.jacobian_along(algebra, symbols, tree, variables)
                    }
                    _ => implicit.jacobian(algebra, symbols, &residual, variables)?,
                });
            }
        } else {
            let (unbound, dependent) = (&self.unbound, &self.dependent);
            let mut bound = BoundMotion::new(algebra, symbols, unbound, dependent, &motion)?;
            for variables in variables {
                let columns = variables.iter().map(|&z| bound.column(algebra, z));
                columns_of.push(columns.collect::<Outcome<_>>()?);
            }
        }
        // In a recursion no terms cancel.
        let written_out = self.recursion.is_none();
        for (columns, variables) in columns_of.iter_mut().zip(variables).filter(|_| written_out) {
            for (column, variable) in columns.iter_mut().zip(variables) {
                if symbols.coordinates.contains(variable) {
                    for entry in column {
                        *entry = algebra.unless_zero(*entry);
                    }
                }
            }
        }
        let by_row = |columns: Vec<Vec<Expr>>| {
            let row = |row| columns.iter().map(move |column: &Vec<Expr>| column[row]);
            (0..rows).flat_map(row).collect()
        };
        let mut columns_of = columns_of.into_iter().map(by_row);
        Ok(std::array::from_fn(|_| {
            columns_of.next().unwrap_or_default()
        }))
    }
}

const VELOCITIES: &str = "Generalised velocities.";
const SOLVED: &str = "Appell's equations, solved.";
const A: &str = "A = ∂ẋ/∂x: one row per rate, one column per state.";
const B: &str = "B = ∂ẋ/∂u: one row per rate, one column per input.";
const P: &str = "P = ∂ẋ/∂p: one row per rate, one column per parameter.";
