//! The functions of a mechanism, each derived on request.

use std::sync::Arc;

use appell_runtime::model::ModelInfo;
use appell_spec::expr;
use appell_spec::mechanism::Mechanism;

use super::super::Derivation;
use super::super::algebra::MOST_OF_PROGRAM;
use super::super::arguments::function_arguments;
use super::super::finding::Outcome;
use super::super::info::{info, tabulated_inputs};
use super::super::systems::systems;
use super::labels::shown_file;
use crate::program::{Arguments, Function, FunctionKind, Hint, Program, Term};

/// The functions of a derived mechanism, each derived on request and from the equations of motion alone.
pub struct Functions {
    derivation: Derivation,
    mechanism: Mechanism,
    info: ModelInfo,
    arguments: Arguments,
    hints: Arc<[Hint]>,
    /// Meanings of the names of hints.
    meanings: Vec<Term>,
    systems: Vec<usize>,
}

impl Functions {
    /// The functions of a derivation.
    pub fn new(mut derivation: Derivation, mechanism: Mechanism) -> Self {
        let signals = tabulated_inputs(&mechanism);
        let mut info = info(&derivation, &mechanism, &signals);
        let graph = &derivation.algebra.graph;
        let mut of_time = graph.has_as_part(derivation.symbols.time);
        for output in &mechanism.outputs {
            output
                .value
                .visit(&mut |quantity| of_time |= quantity == expr::Quantity::Time);
        }
        info.explicit_time = of_time;
        let systems = systems(graph, &derivation.rates());
        let systems = systems.into_iter().map(|(size, _)| size).collect();
        let arguments = function_arguments(&derivation, &info);
        let (hints, meanings) = derivation.hints(&mechanism, &arguments);
        Self {
            derivation,
            mechanism,
            info,
            arguments,
            hints: hints.into(),
            meanings,
            systems,
        }
    }

    /// Names, units and sizes of the model.
    pub fn info(&self) -> &ModelInfo {
        &self.info
    }

    /// The number of expressions of the derivation.
    pub fn expressions(&self) -> usize {
        self.derivation.algebra.graph.len()
    }

    /// The mechanism.
    pub fn mechanism(&self) -> &Mechanism {
        &self.mechanism
    }

    /// Dependent coordinates, one per position constraint.
    pub fn dependent(&self) -> &[usize] {
        &self.derivation.positions.dependent
    }

    /// Sizes of the linear systems of several unknowns that are solved with pivoting to compute the rates.
    pub fn systems(&self) -> &[usize] {
        &self.systems
    }

    /// The program with the functions `kinds`; those of outputs or switches are omitted if there are none.
    pub fn program(&self, kinds: &[FunctionKind]) -> Outcome<Program> {
        let functions = kinds.iter().map(|&kind| self.function(kind));
        let functions: Vec<Option<Function>> = functions.collect::<Outcome<_>>()?;
        Ok(Program {
            info: self.info.clone(),
            systems: self.systems.clone(),
            file: shown_file(&self.mechanism.file).to_owned(),
            arguments: self.arguments.clone(),
            dependent: self.dependent().to_vec(),
            hints: self.hints.clone(),
            functions: functions.into_iter().flatten().collect(),
        })
    }

    /// A function, unless the mechanism has no such results.
    fn function(&self, kind: FunctionKind) -> Outcome<Option<Function>> {
        let mut derivation = self.derivation.clone();
        let results = derivation.results(&self.mechanism, &self.info, kind)?;
        derivation.algebra.holds_at_most(MOST_OF_PROGRAM)?;
        if kind.may_lack() && results.iter().all(|array| array.entries.is_empty()) {
            return Ok(None);
        }
        let function = Function::new(kind, results);
        let mut function = derivation.staged(&self.mechanism, function);
        if kind == FunctionKind::Rates {
            // Last, so that display does not change the order of any computation.
            function.equations = derivation.equations();
        }
        function.glossary.extend(self.meanings.iter().cloned());
        let own = derivation.own_symbols(kind);
        Ok(Some(function.over(Arc::new(derivation.algebra.graph), own)))
    }
}

/// The program of a derivation, with the functions `kinds`; see [`Functions::program`].
pub fn program(
    derivation: Derivation,
    mechanism: &Mechanism,
    kinds: &[FunctionKind],
) -> Outcome<Program> {
    Functions::new(derivation, mechanism.clone()).program(kinds)
}
