//! The variables of an FMU, in the order of their value references.

use appell_runtime::model::Quantity;

use crate::program::{FunctionKind, Program};

/// Value references: time, parameters, declared inputs, states, their rates, outputs, switches.
#[derive(Debug)]
pub(super) struct Variables {
    /// Name of the independent variable.
    pub(super) time: &'static str,
    pub(super) parameters: usize,
    pub(super) inputs: usize,
    pub(super) states: usize,
    pub(super) rates: usize,
    pub(super) outputs: usize,
    pub(super) switches: usize,
    pub(super) end: usize,
    /// Whether each parameter is fixed: those of position constraints are, since changing them would violate
    /// the constraints during a simulation.
    pub(super) fixed: Vec<bool>,
}

impl Variables {
    pub(super) const TIME: usize = 0;

    pub(super) fn of(program: &Program) -> Self {
        let info = &program.info;
        let parameters = 1;
        let inputs = parameters + info.parameters.len();
        let states = inputs + info.declared_inputs;
        let rates = states + info.states.len();
        let outputs = rates + info.states.len();
        let switches = outputs + info.outputs.len();
        let lists: [&[Quantity]; 4] = [&info.parameters, &info.inputs, &info.states, &info.outputs];
        // The names of a spec are unique, and none of them is `t`.
        let is_taken = lists
            .concat()
            .iter()
            .any(|quantity| quantity.name == "time");
        let constraints = program.function(FunctionKind::PositionConstraints);
        let fixed = program.arguments.parameters.iter().map(|&parameter| {
            constraints.is_some_and(|function| {
                let mut residuals = function.results[0].entries.iter();
                residuals.any(|&residual| function.graph.mentions(residual, &[parameter]))
            })
        });
        Self {
            time: if is_taken { "t" } else { "time" },
            parameters,
            inputs,
            states,
            rates,
            outputs,
            switches,
            end: switches + program.switch_len(),
            fixed: fixed.collect(),
        }
    }
}
