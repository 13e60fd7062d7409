//! The derived equations as the functions of a program.

use appell_runtime::model::{Interpolation, ModelInfo, Quantity, SignalTable};
use appell_spec::mechanism::{self, Label, Mechanism, Signal};

use super::Derivation;
use super::expressions::Lowering;
use super::finding::{Item, Outcome};
use super::gibbs_appell::{acceleration_energy, kinetic_energy};
use super::kinematics::division_by_zero;
use super::linear::ImplicitMotion;
use super::reactions;
use super::switches::switches;
use super::symbols::ids;
use crate::program::{Arguments, Array, Function, FunctionKind, Layout, Program};
use crate::symbolic::Expr;

/// All functions, in the order of emitted code.
pub const ALL: [FunctionKind; 13] = [
    FunctionKind::Kinematics,
    FunctionKind::AccelerationEnergy,
    FunctionKind::MassMatrix,
    FunctionKind::Bias,
    FunctionKind::GeneralizedForces,
    FunctionKind::Rates,
    FunctionKind::Jacobians,
    FunctionKind::AllJacobians,
    FunctionKind::Energies,
    FunctionKind::ConstraintResidual,
    FunctionKind::ConstraintForces,
    FunctionKind::Outputs,
    FunctionKind::Switches,
];

/// The program of a derivation, with the functions `kinds`. Without outputs or switches there is no
/// function for them.
pub fn program(
    mut derivation: Derivation,
    mechanism: &Mechanism,
    kinds: &[FunctionKind],
) -> Outcome<Program> {
    let mut functions = Vec::with_capacity(kinds.len());
    for &kind in kinds {
        let results = derivation.results(mechanism, kind)?;
        let may_lack = matches!(kind, FunctionKind::Outputs | FunctionKind::Switches);
        if !may_lack || results.iter().any(|array| !array.entries.is_empty()) {
            functions.push(Function { kind, results });
        }
    }
    let signals = tabulated_inputs(mechanism);
    let symbols = &derivation.symbols;
    let graph = &derivation.algebra.graph;
    let mut input_symbols = symbols.inputs.clone();
    input_symbols.extend(
        signals
            .iter()
            .map(|&(signal, order)| symbols.signals[signal][usize::from(order)]),
    );
    let arguments = Arguments {
        time: ids(graph, &[symbols.time])[0],
        states: ids(
            graph,
            &[symbols.speeds.as_slice(), &symbols.coordinates].concat(),
        ),
        inputs: ids(graph, &input_symbols),
        parameters: ids(graph, &symbols.parameters),
    };
    let explicit_time = functions
        .iter()
        .flat_map(|f| &f.results)
        .flat_map(|r| &r.entries)
        .any(|&e| graph.mentions(e, &[arguments.time]));
    let info = info(&derivation, mechanism, &signals, explicit_time);
    Ok(Program {
        info,
        file: mechanism.file.clone(),
        graph: derivation.algebra.graph,
        arguments,
        functions,
    })
}

fn array(name: &str, layout: Layout, entries: Vec<Expr>) -> Array {
    let name = name.to_owned();
    Array {
        name,
        layout,
        entries,
    }
}

impl Derivation {
    /// The results of one function.
    fn results(&mut self, mechanism: &Mechanism, kind: FunctionKind) -> Outcome<Vec<Array>> {
        let speeds = self.symbols.speeds.len();
        Ok(match kind {
            FunctionKind::Kinematics => {
                vec![array(
                    "coordinate_rates",
                    Layout::Coordinates,
                    self.coordinate_rates.clone(),
                )]
            }
            FunctionKind::AccelerationEnergy => self.acceleration_energies(mechanism),
            FunctionKind::MassMatrix => {
                let entries = self.gibbs.mass_matrix.concat();
                vec![array(
                    "mass_matrix",
                    Layout::Matrix(speeds, speeds),
                    entries,
                )]
            }
            FunctionKind::Bias => vec![array("bias", Layout::Speeds, self.gibbs.bias.clone())],
            FunctionKind::GeneralizedForces => {
                vec![array(
                    "generalized_forces",
                    Layout::Speeds,
                    self.forces.clone(),
                )]
            }
            FunctionKind::Rates => vec![array("rates", Layout::State, self.rates())],
            FunctionKind::Jacobians => self.jacobians(mechanism, false)?,
            FunctionKind::AllJacobians => self.jacobians(mechanism, true)?,
            FunctionKind::Energies => self.energies(),
            FunctionKind::ConstraintResidual => {
                let graph = &mut self.algebra.graph;
                let residual =
                    reactions::residual(graph, &self.constraints, &self.coordinate_rates);
                vec![array("residual", Layout::Vector(residual.len()), residual)]
            }
            FunctionKind::ConstraintForces => {
                let forces = reactions::reactions(
                    &mut self.algebra,
                    mechanism,
                    &self.symbols,
                    &self.constraints,
                    &self.velocities.violating,
                    &self.bodies,
                    &self.motion.accelerations,
                )?;
                vec![array(
                    "forces",
                    Layout::Matrix(forces.len(), 3),
                    forces.concat(),
                )]
            }
            FunctionKind::Outputs => {
                let lowering = Lowering {
                    symbols: &self.symbols,
                    rates: &self.coordinate_rates,
                };
                let mut values = Vec::with_capacity(mechanism.outputs.len());
                for (index, output) in mechanism.outputs.iter().enumerate() {
                    let value = lowering
                        .lower(&mut self.algebra.graph, &output.value)
                        .map_err(|_| vec![division_by_zero(Item::Output(index))])?;
                    values.push(value);
                }
                vec![array("outputs", Layout::Outputs, values)]
            }
            FunctionKind::Switches => {
                let rates = self.rates();
                let switches = switches(&mut self.algebra.graph, &self.symbols, &rates);
                vec![array("switches", Layout::Vector(switches.len()), switches)]
            }
        })
    }

    /// S at the actual accelerations: the sum, then body by body.
    fn acceleration_energies(&mut self, mechanism: &Mechanism) -> Vec<Array> {
        let mut results = Vec::with_capacity(self.bodies.len() + 1);
        for body in self.bodies.clone() {
            let s = acceleration_energy(&mut self.algebra, &body, &self.motion.accelerations);
            let s = self.algebra.graph.name(&format!("s_{}", body.name), s);
            results.push(array(&body.name, Layout::Scalar, vec![s]));
        }
        let parts: Vec<Expr> = results.iter().map(|r| r.entries[0]).collect();
        let total = self.algebra.graph.sum(&parts);
        let taken = mechanism.bodies.iter().any(|body| body.name == "total");
        let name = if taken { "total_of_bodies" } else { "total" };
        results.insert(0, array(name, Layout::Scalar, vec![total]));
        results
    }

    /// T, V and the power of the loads without a potential.
    fn energies(&mut self) -> Vec<Array> {
        let bodies = self.bodies.clone();
        let kinetic: Vec<Expr> = bodies
            .iter()
            .map(|body| kinetic_energy(&mut self.algebra, body))
            .collect();
        let graph = &mut self.algebra.graph;
        let potential: Vec<Expr> = self
            .loads
            .iter()
            .filter_map(|load| load.potential)
            .collect();
        let others = self.loads.iter().filter(|load| load.potential.is_none());
        let power: Vec<Expr> = others.map(|load| load.power(graph)).collect();
        [
            ("kinetic", kinetic),
            ("potential", potential),
            ("power", power),
        ]
        .map(|(name, parts)| array(name, Layout::Scalar, vec![graph.sum(&parts)]))
        .into()
    }

    /// ẋ: pseudo-accelerations, then generalised velocities.
    fn rates(&self) -> Vec<Expr> {
        [self.motion.accelerations.as_slice(), &self.coordinate_rates].concat()
    }

    /// ẋ, A, B and, when asked for, P.
    fn jacobians(&mut self, mechanism: &Mechanism, parameters: bool) -> Outcome<Vec<Array>> {
        let implicit = ImplicitMotion {
            gibbs: &self.gibbs,
            forces: &self.forces,
            motion: &self.motion,
            coordinate_rates: &self.coordinate_rates,
        };
        let rates = self.rates();
        let residual = implicit.residual(&mut self.algebra, &self.symbols);
        let states = [self.symbols.speeds.as_slice(), &self.symbols.coordinates].concat();
        let tabulated = tabulated_inputs(mechanism);
        let tabulated = tabulated
            .iter()
            .map(|&(signal, order)| self.symbols.signals[signal][usize::from(order)]);
        let inputs: Vec<Expr> = self
            .symbols
            .inputs
            .iter()
            .copied()
            .chain(tabulated)
            .collect();
        let mut variables = vec![("a", states), ("b", inputs)];
        if parameters {
            variables.push(("p", self.symbols.parameters.clone()));
        }
        let mut results = vec![Array {
            name: "rates".to_owned(),
            layout: Layout::State,
            entries: rates.clone(),
        }];
        for (name, variables) in variables {
            let columns =
                implicit.jacobian(&mut self.algebra, &self.symbols, &residual, &variables)?;
            let entries = (0..rates.len())
                .flat_map(|row| columns.iter().map(move |column| column[row]))
                .collect();
            let layout = Layout::Matrix(rates.len(), variables.len());
            results.push(Array {
                name: name.to_owned(),
                layout,
                entries,
            });
        }
        Ok(results)
    }
}

/// Signals with those of their derivatives that equations may contain.
fn tabulated_inputs(mechanism: &Mechanism) -> Vec<(usize, u8)> {
    let orders = |signal: &Signal| 0..=signal.interpolation.derivatives();
    let signals = mechanism.signals.iter().enumerate();
    signals
        .flat_map(|(index, signal)| orders(signal).map(move |order| (index, order)))
        .collect()
}

fn info(
    derivation: &Derivation,
    mechanism: &Mechanism,
    signals: &[(usize, u8)],
    explicit_time: bool,
) -> ModelInfo {
    let everywhere = [f64::NEG_INFINITY, f64::INFINITY];
    let speeds = mechanism
        .pseudo_velocities
        .iter()
        .map(|w| quantity(&w.label, w.initial, everywhere));
    let coordinates = mechanism
        .coordinates
        .iter()
        .map(|q| quantity(&q.label, q.initial, q.range.unwrap_or(everywhere)));
    let declared = mechanism
        .inputs
        .iter()
        .map(|u| quantity(&u.label, 0.0, everywhere));
    let tabulated = signals.iter().map(|&(signal, order)| {
        let mut input = quantity(&mechanism.signals[signal].label, 0.0, everywhere);
        if order > 0 {
            input.name = mechanism::Interpolation::derivative_name(&input.name, order).into();
            input.unit = format!("({})/s^{order}", input.unit).into();
        }
        input
    });
    let parameters = mechanism.parameters.iter().map(|p| {
        let range = [
            p.at_least.unwrap_or(f64::NEG_INFINITY),
            p.at_most.unwrap_or(f64::INFINITY),
        ];
        quantity(&p.label, p.value, range)
    });
    let rows = derivation
        .constraints
        .rows
        .iter()
        .filter(|r| !r.is_embedded());
    ModelInfo {
        name: mechanism.name.clone().into(),
        title: mechanism.title.clone().into(),
        source: mechanism.source.clone().unwrap_or_default().into(),
        states: speeds.chain(coordinates).collect(),
        speeds: mechanism.pseudo_velocities.len(),
        inputs: declared.chain(tabulated).collect(),
        declared_inputs: mechanism.inputs.len(),
        signals: mechanism.signals.iter().map(signal_table).collect(),
        signal_inputs: signals.to_vec().into(),
        parameters: parameters.collect(),
        outputs: mechanism
            .outputs
            .iter()
            .map(|y| quantity(&y.label, 0.0, everywhere))
            .collect(),
        constraint_rows: rows.map(|r| r.name.clone().into()).collect(),
        reactions: derivation
            .constraints
            .reactions
            .iter()
            .map(|r| r.clone().into())
            .collect(),
        explicit_time,
    }
}

fn quantity(label: &Label, value: f64, range: [f64; 2]) -> Quantity {
    Quantity {
        name: label.name.clone().into(),
        about: label.about.clone().into(),
        unit: label.unit.text.clone().into(),
        scale: label.unit.scale,
        value,
        range,
    }
}

fn signal_table(signal: &Signal) -> SignalTable {
    SignalTable {
        name: signal.label.name.clone().into(),
        times: signal.times.clone().into(),
        values: signal.values.clone().into(),
        interpolation: match signal.interpolation {
            mechanism::Interpolation::Hold => Interpolation::Hold,
            mechanism::Interpolation::Linear => Interpolation::Linear,
            mechanism::Interpolation::Cubic => Interpolation::Cubic,
        },
    }
}
