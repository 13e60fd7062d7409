//! The inputs of a simulation as one function of time and state.

use std::cell::Cell;
use std::ops::Range;
use std::sync::Arc;

use appell_analysis::control::sampler::Sampler;
use appell_codegen::jit::Sizes;
use appell_codegen::symbolic::Expr as Lowered;
use appell_codegen::tape::{Argument, Arithmetic, ResultArray, Seen, Tape, Value, closed_loop};
use appell_runtime::inputs::{InputSource, TabulatedInputs};
use appell_runtime::model::{Along, Model, ModelInfo, Switching};
use appell_runtime::real::{Enclosure, Real};
use appell_spec::Scope;
use appell_spec::expr::Expr;

use crate::formula::{StateFunction, Workbench};
use crate::inputs::closed_loop::{ClosedLoop, Onto, Outside};
use crate::inputs::feedback::Feedback;
use crate::inputs::law::{Law, Moment, Stage};
use crate::inputs::switching::InputSwitches;
use crate::inputs::tabulated::{Remarks, Table};
use crate::motion::Driven;
use crate::setup::{Assignment, Setup, expression};
use crate::{Error, Field};

/// The sum of expressions, feedback laws and recordings in one motion.
pub struct Controller<'w> {
    wiring: &'w Wiring,
    model: &'w dyn Model,
    parameters: Vec<f64>,
    /// Measurements of each law; nothing for one in continuous time.
    samplers: Vec<Option<Sampler>>,
    switching_times: Vec<f64>,
    /// Buffer for the values of the function.
    values: Cell<Vec<f64>>,
}

/// The common parts of all motions under the same expressions, laws and recordings.
pub struct Wiring {
    /// Terms of inputs and desired values of laws.
    function: StateFunction,
    terms: Vec<Term>,
    laws: Vec<PlacedLaw>,
    recorded: Option<TabulatedInputs>,
    driven: Vec<DrivenInputs>,
    switching_times: Vec<f64>,
    /// Switching functions of the expressions.
    switches: Option<InputSwitches>,
}

/// A term of an input: a value of the function.
#[derive(Clone, Copy)]
struct Term {
    input: usize,
    value: usize,
}

/// A law with the places of its desired values among those of the function.
struct PlacedLaw {
    law: Box<dyn Law>,
    desired: Range<usize>,
}

/// Inputs computed by a program, with their indices.
type DrivenInputs = (Vec<usize>, Arc<dyn InputSource + Send + Sync>);

/// Collects the sources of the inputs.
pub struct Plan {
    bench: Workbench,
    exprs: Vec<Lowered>,
    terms: Vec<Term>,
    laws: Vec<PlacedLaw>,
    recorded: Option<TabulatedInputs>,
    /// Remarks on a recording.
    pub(crate) remarks: Remarks,
    driven: Vec<DrivenInputs>,
    switching_times: Vec<f64>,
    /// Inputs set by an expression or a recording.
    set: Vec<usize>,
}

impl Plan {
    /// No inputs.
    pub fn new(setup: &Setup<'_>) -> Self {
        Self {
            bench: Workbench::new(&setup.mechanism),
            exprs: Vec::new(),
            terms: Vec::new(),
            laws: Vec::new(),
            recorded: None,
            remarks: Remarks::default(),
            driven: Vec::new(),
            switching_times: Vec::new(),
            set: Vec::new(),
        }
    }

    /// Whether there is no source.
    pub fn is_empty(&self) -> bool {
        let given = self.recorded.is_some() || !self.driven.is_empty();
        self.terms.is_empty() && self.laws.is_empty() && !given
    }

    fn take(&mut self, field: Field, input: usize, setup: &Setup<'_>) -> Result<(), Error> {
        if self.set.contains(&input) {
            let name = &setup.declared_inputs()[input].name;
            let message = format!("the input `{name}` is given twice");
            return Err(Error::request(field, message));
        }
        self.set.push(input);
        Ok(())
    }

    /// Adds a term of an input, which may not divide by the number zero.
    fn term(&mut self, input: usize, expr: &Expr) -> Result<(), &'static str> {
        let lowered = self.bench.lower(expr).ok_or(DIVIDES_BY_ZERO)?;
        let value = self.exprs.len();
        self.terms.push(Term { input, value });
        self.exprs.push(lowered);
        Ok(())
    }

    /// Adds an expression to an input.
    pub fn expression(&mut self, assignment: &Assignment, setup: &Setup<'_>) -> Result<(), Error> {
        let Assignment { name, value } = assignment;
        let input = setup.input(Field::Input, name)?;
        let unit = setup.unit_of_input(input);
        let expr = expression(setup.spec, Field::Input, name, value, Scope::Law, unit)?;
        self.input(input, &expr, setup)
    }

    /// Adds an expression that has been read.
    pub fn input(&mut self, input: usize, expr: &Expr, setup: &Setup<'_>) -> Result<(), Error> {
        self.take(Field::Input, input, setup)?;
        let name = &setup.declared_inputs()[input].name;
        self.term(input, expr)
            .map_err(|reason| Error::request(Field::Input, format!("{name}: {reason}")))
    }

    /// Adds the inputs of a recording.
    pub fn recording(&mut self, table: Table, setup: &Setup<'_>) -> Result<(), Error> {
        for &input in &table.given {
            self.take(Field::Recorded, input, setup)?;
        }
        self.switching_times.extend(table.values.switching_times());
        (self.recorded, self.remarks) = (Some(table.values), table.remarks);
        Ok(())
    }

    /// Adds inputs computed by a program.
    pub fn driven(&mut self, driven: &Driven, setup: &Setup<'_>) -> Result<(), Error> {
        let mut inputs = Vec::new();
        for name in &driven.inputs {
            let input = setup.input(Field::Input, name)?;
            self.take(Field::Input, input, setup)?;
            inputs.push(input);
        }
        self.switching_times.extend(driven.source.switching_times());
        self.driven.push((inputs, Arc::clone(&driven.source)));
        Ok(())
    }

    /// Adds a feedback law.
    pub fn feedback(&mut self, feedback: Feedback) -> Result<(), Error> {
        let told = |reason: &str| Error::data(&feedback.file, reason);
        for (input, offset) in &feedback.offsets {
            self.term(*input, offset).map_err(told)?;
        }
        self.switching_times.extend(&feedback.switching_times);
        self.law(feedback.law).map_err(told)
    }

    /// Adds a law after the others of its stage.
    fn law(&mut self, law: Box<dyn Law>) -> Result<(), &'static str> {
        let first = self.exprs.len();
        for desired in law.desired() {
            let mut value = self.bench.lower(desired).ok_or(DIVIDES_BY_ZERO)?;
            self.exprs.push(value);
            for _ in 0..law.derivatives() {
                value = self.bench.rate(value);
                self.exprs.push(value);
            }
        }
        let desired = first..self.exprs.len();
        self.laws.push(PlacedLaw { law, desired });
        self.laws.sort_by_key(|placed| placed.law.stage());
        Ok(())
    }

    /// The inputs as functions of time and state, for motions of at most `until` in s.
    pub fn wiring(self, setup: &Setup<'_>, until: f64) -> Result<Wiring, Error> {
        let switches = InputSwitches::new(&self.bench, setup.info, &self.exprs)?;
        let function = self.bench.function(setup.info, self.exprs)?;
        let samplings = self.laws.iter().filter_map(|placed| placed.law.sampling());
        for sampling in samplings {
            let measurements = until / sampling.period();
            if measurements > MOST_MEASUREMENTS {
                let message = format!(
                    "{measurements} measurements are too many; choose a larger `sampled_ms` (at most \
                     {MOST_MEASUREMENTS:.0} measurements)"
                );
                return Err(Error::request(Field::Feedback, message));
            }
        }
        Ok(Wiring {
            function,
            terms: self.terms,
            laws: self.laws,
            recorded: self.recorded,
            driven: self.driven,
            switching_times: self.switching_times,
            switches,
        })
    }
}

/// Why an expression has no value.
const DIVIDES_BY_ZERO: &str = "an expression divides by the number zero";

/// Maximum number of measurements in a motion.
const MOST_MEASUREMENTS: f64 = 1e6;

impl PlacedLaw {
    /// Whether its inputs are external ones of a closed loop.
    fn is_outside(&self) -> bool {
        self.law.stage() >= Stage::Sampled
    }
}

impl Wiring {
    /// The inputs of a motion of a model from 0 to `until` in s.
    pub fn controller<'w>(
        &'w self,
        model: &'w dyn Model,
        parameters: Vec<f64>,
        until: f64,
    ) -> Controller<'w> {
        let mut times = self.switching_times.clone();
        let samplings = self.laws.iter().map(|placed| placed.law.sampling());
        let samplers = samplings.map(|sampling| Some(Sampler::new(sampling?, until)));
        let samplers: Vec<Option<Sampler>> = samplers.collect();
        times.extend(samplers.iter().flatten().flat_map(Sampler::switching_times));
        Controller {
            wiring: self,
            model,
            parameters,
            samplers,
            switching_times: times,
            values: Cell::default(),
        }
    }

    /// The inputs of a model, in its order, as operations: external inputs, expressions and laws.
    fn tape(&self, info: &ModelInfo) -> Tape {
        let mut tape = self.function.tape().clone();
        let values = tape.results.swap_remove(0).entries;
        let external = (0..).map(Argument::Input).take(info.input_len());
        let mut inputs: Vec<Value> = external.map(|input| tape.argument(input)).collect();
        for &Term { input, value } in &self.terms {
            inputs[input] = tape.binary(Arithmetic::Add, inputs[input], values[value]);
        }
        for placed in self.laws.iter().filter(|placed| !placed.is_outside()) {
            let desired = &values[placed.desired.clone()];
            placed.law.write(desired, &mut tape, &mut inputs);
        }
        tape.results = vec![ResultArray {
            name: "inputs".to_owned(),
            entries: inputs,
        }];
        tape
    }

    /// The equations of motion with expressions and laws substituted; `rates` are the model's. `seen` are the measurements
    /// of laws, as inputs after those of [`Controller::fill_outside`].
    pub(crate) fn closed_loop(
        &self,
        rates: &Tape,
        info: &ModelInfo,
        seen: &[Onto],
    ) -> Result<ClosedLoop, Error> {
        let outside = Outside {
            inputs: self.function.inputs(),
            is_there: self.outside().is_some(),
        };
        let rates = self.composed(&[rates], info, seen);
        ClosedLoop::new(&rates, Sizes::from(info), outside, seen.len()).map_err(Error::computation)
    }

    /// Functions of the model with expressions and laws substituted, their results in a row.
    pub(crate) fn composed(&self, functions: &[&Tape], info: &ModelInfo, seen: &[Onto]) -> Tape {
        let views = seen.iter().zip(self.function.inputs()..);
        let views: Vec<Seen> = views.map(|(onto, by)| onto.seen(by)).collect();
        closed_loop(&self.tape(info), functions, &views)
    }

    /// How many inputs the composed functions have without the disturbances.
    pub(crate) fn inputs(&self) -> usize {
        self.function.inputs()
    }

    /// What the closed loop receives from outside, if there is anything.
    pub(crate) fn outside(&self) -> Option<&'static str> {
        if self.recorded.is_some() || !self.driven.is_empty() {
            return Some("recorded inputs");
        }
        if self.has_laws_outside() {
            return Some("a law in discrete time or by inverse dynamics");
        }
        self.function
            .has_signals()
            .then_some("a table over time in the spec")
    }

    /// The switching functions of time and state of the expressions.
    pub(crate) fn crossings(&self) -> Option<Tape> {
        self.switches.as_ref().map(InputSwitches::crossing_tape)
    }

    fn has_laws_outside(&self) -> bool {
        self.laws.iter().any(PlacedLaw::is_outside)
    }
}

impl Controller<'_> {
    /// Adds the inputs of all laws, or of those outside of a closed loop.
    fn add_laws(&self, p: &[f64], t: f64, x: &[f64], values: &[f64], u: &mut [f64], all: bool) {
        let wiring = self.wiring;
        for (placed, sampler) in wiring.laws.iter().zip(&self.samplers) {
            if !(all || placed.is_outside()) {
                continue;
            }
            let at = Moment {
                model: self.model,
                t,
                x,
                p,
                desired: &values[placed.desired.clone()],
                function: &wiring.function,
                sampler: sampler.as_ref(),
            };
            placed.law.add(&at, u);
        }
    }

    /// Inputs from recordings and programs.
    fn fill_given(&self, t: f64, x: &[f64], u: &mut [f64]) {
        let wiring = self.wiring;
        match &wiring.recorded {
            Some(recorded) => recorded.inputs(t, x, u),
            None => u.fill(0.0),
        }
        if !wiring.driven.is_empty() {
            let mut own = vec![0.0; u.len()];
            for (inputs, source) in &wiring.driven {
                source.inputs(t, x, &mut own);
                for &input in inputs {
                    u[input] += own[input];
                }
            }
        }
    }

    /// Fills the external inputs of the [`ClosedLoop`]: recordings, held inputs, signals. Feedback laws are evaluated at
    /// `p` and `x`.
    pub(crate) fn fill_outside(&self, p: &[f64], t: f64, x: &[f64], u: &mut [f64]) {
        let wiring = self.wiring;
        let (declared, signals) = u.split_at_mut(wiring.function.declared().min(u.len()));
        self.fill_given(t, x, declared);
        if wiring.has_laws_outside() {
            self.with_values(p, t, x, |values| {
                self.add_laws(p, t, x, values, declared, false);
            });
        }
        wiring.function.fill_signals(t, signals);
    }

    /// The inputs with other parameters in the expressions, as many as those of the motion.
    pub fn inputs_with(&self, p: &[f64], t: f64, x: &[f64], u: &mut [f64]) {
        self.fill_given(t, x, u);
        self.with_values(p, t, x, |values| {
            for &Term { input, value } in &self.wiring.terms {
                u[input] += values[value];
            }
            self.add_laws(p, t, x, values, u, true);
        });
    }

    /// Calls a function with the values of terms and of desired values.
    fn with_values(&self, p: &[f64], t: f64, x: &[f64], call: impl FnOnce(&[f64])) {
        let function = &self.wiring.function;
        let mut values = self.values.take();
        values.resize(function.count(), 0.0);
        function.values(t, x, p, &mut values);
        call(&values);
        self.values.set(values);
    }

    /// The parameters of the motion.
    pub fn parameters(&self) -> &[f64] {
        &self.parameters
    }
}

impl InputSource for Controller<'_> {
    fn inputs(&self, t: f64, x: &[f64], u: &mut [f64]) {
        self.inputs_with(&self.parameters, t, x, u);
    }

    fn switching_times(&self) -> Vec<f64> {
        self.switching_times.clone()
    }

    fn bounds(&self, along: &Along<'_>, u: &mut [Enclosure]) {
        let wiring = self.wiring;
        match &wiring.recorded {
            Some(recorded) => recorded.bounds(along, u),
            None => u.fill(Enclosure::constant(0.0)),
        }
        let mut own = u.to_vec();
        for (inputs, source) in &wiring.driven {
            source.bounds(along, &mut own);
            for &input in inputs {
                u[input] += own[input];
            }
        }
        let mut values = vec![Enclosure::constant(0.0); wiring.function.count()];
        let p = &self.parameters;
        wiring.function.bounds(&Along { p, ..*along }, &mut values);
        for &Term { input, value } in &wiring.terms {
            u[input] += values[value];
        }
        for placed in &wiring.laws {
            let desired = &values[placed.desired.clone()];
            placed.law.bounds(desired, along, u);
        }
    }

    fn switching(&self) -> Option<&dyn Switching> {
        let switches = self.wiring.switches.as_ref();
        switches.map(|switches| switches as &dyn Switching)
    }
}
