//! The inputs of a simulation as one function of time and state.

mod bounds;

use std::cell::Cell;
use std::sync::Arc;

use appell_analysis::control::sampled::Sampling;
use appell_analysis::control::sampler::Sampler;
use appell_codegen::jit::Sizes;
use appell_codegen::symbolic::Expr as Lowered;
use appell_codegen::tape::Tape;
use appell_runtime::inputs::{InputSource, TabulatedInputs};
use appell_runtime::model::{Along, At, Model, ModelInfo, Switching};
use appell_runtime::real::Enclosure;
use appell_spec::expr::Expr;
use appell_spec::mechanism::InputId;
use appell_spec::{Scope, Snippet, formula};
use nalgebra::DVector;

use crate::formula::{StateFunction, Workbench};
use crate::inputs::by_model::ModelLaw;
use crate::inputs::closed_loop::{ClosedLoop, Onto, Outside};
use crate::inputs::feedback::{self, Aim, Feedback, Gains, Sampled};
use crate::inputs::law::{self, ScheduledLaw, Slot, Term};
use crate::inputs::switching::InputSwitches;
use crate::inputs::tabulated::Table;
use crate::motion::Driven;
use crate::setup::{Assignment, Setup, bracketed};
use crate::{Error, Field};

/// The sum of expressions, feedback laws and recordings in one motion.
pub struct Controller<'w> {
    wiring: &'w Wiring,
    model: &'w dyn Model,
    parameters: Vec<f64>,
    /// Measurements of the discrete-time laws with gains.
    samplers: Vec<Sampler>,
    /// The same for laws by inverse dynamics; nothing for one in continuous time.
    model_samplers: Vec<Option<Sampler>>,
    switching_times: Vec<f64>,
    /// Buffer for the values of the function.
    values: Cell<Vec<f64>>,
}

/// The common parts of all motions under the same expressions, laws and recordings.
pub struct Wiring {
    /// One value per entry of `slots`.
    function: StateFunction,
    slots: Vec<Slot>,
    recorded: Option<TabulatedInputs>,
    driven: Vec<DrivenInputs>,
    sampled: Vec<SampledLaw>,
    scheduled: Vec<ScheduledLaw>,
    by_model: Vec<ModelLaw>,
    switching_times: Vec<f64>,
    /// Switching functions of the expressions.
    switches: Option<InputSwitches>,
}

/// A discrete-time law.
struct SampledLaw {
    sampling: Sampling,
    inputs: Vec<usize>,
    pending_gains: Vec<Vec<f64>>,
}

/// Inputs computed by a program, with their indices.
type DrivenInputs = (Vec<usize>, Arc<dyn InputSource + Send + Sync>);

/// Collects the sources of the inputs.
pub struct Plan {
    bench: Workbench,
    exprs: Vec<Lowered>,
    slots: Vec<Slot>,
    /// Terms whose desired value is zero.
    zero: Vec<Term>,
    sampled: Vec<(Sampled, Vec<usize>)>,
    scheduled: Vec<ScheduledLaw>,
    by_model: Vec<ModelLaw>,
    recorded: Option<Table>,
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
            slots: Vec::new(),
            zero: Vec::new(),
            sampled: Vec::new(),
            scheduled: Vec::new(),
            by_model: Vec::new(),
            recorded: None,
            driven: Vec::new(),
            switching_times: Vec::new(),
            set: Vec::new(),
        }
    }

    /// Whether there is no source.
    pub fn is_empty(&self) -> bool {
        let laws = self.zero.is_empty() && self.scheduled.is_empty() && self.by_model.is_empty();
        let given = self.recorded.is_some() || !self.driven.is_empty();
        self.slots.is_empty() && laws && !given
    }

    /// The last time of a recording in s.
    pub fn recorded_until(&self) -> Option<f64> {
        self.recorded.as_ref().map(|table| table.until)
    }

    /// Recorded inputs that change smoothly although they are held, see [`Table::smooth`].
    pub fn recorded_smooth(&self) -> Option<&[(String, f64)]> {
        self.recorded.as_ref().map(|table| table.smooth.as_slice())
    }

    fn take(&mut self, field: Field, input: usize, setup: &Setup<'_>) -> Result<(), Error> {
        if self.set.contains(&input) {
            let name = &setup.mechanism.inputs[InputId::new(input)].label.name;
            let message = format!("the input `{name}` is given twice");
            return Err(Error::request(field, message));
        }
        self.set.push(input);
        Ok(())
    }

    /// Adds an expression, which may not divide by the number zero.
    fn push(&mut self, slot: Slot, expr: &Expr) -> Result<(), &'static str> {
        let lowered = self.bench.lower(expr);
        self.exprs
            .push(lowered.ok_or("an expression divides by the number zero")?);
        self.slots.push(slot);
        Ok(())
    }

    /// Adds an expression to an input.
    pub fn expression(&mut self, assignment: &Assignment, setup: &Setup<'_>) -> Result<(), Error> {
        let Assignment { name, value } = assignment;
        let input = setup.input(Field::Input, name)?;
        let unit = &setup.mechanism.inputs[InputId::new(input)].label.unit;
        let text = bracketed(value);
        let expr = formula(
            setup.spec,
            &Snippet::alone(&text),
            "the input",
            Scope::Law,
            unit,
        )
        .map_err(Error::expression(Field::Input, name, &text))?;
        self.input(input, &expr, setup)
    }

    /// Adds an expression that has been read.
    pub fn input(&mut self, input: usize, expr: &Expr, setup: &Setup<'_>) -> Result<(), Error> {
        self.take(Field::Input, input, setup)?;
        let name = &setup.mechanism.inputs[InputId::new(input)].label.name;
        self.push(Slot::Input(input), expr)
            .map_err(|reason| Error::request(Field::Input, format!("{name}: {reason}")))
    }

    /// Adds the inputs of a recording.
    pub fn recording(&mut self, table: Table, setup: &Setup<'_>) -> Result<(), Error> {
        for &input in &table.given {
            self.take(Field::Recorded, input, setup)?;
        }
        self.switching_times.extend(table.values.switching_times());
        self.recorded = Some(table);
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
        for (&input, offset) in feedback.inputs.iter().zip(&feedback.offsets) {
            if let Some(offset) = offset {
                self.push(Slot::Input(input), offset).map_err(told)?;
            }
        }
        self.switching_times.extend(&feedback.switching_times);
        let gains = match feedback.gains {
            Gains::Fixed(gains) => gains,
            Gains::ByModel(law) => {
                let sampling = feedback.sampled.map(|sampled| sampled.sampling);
                return self.by_model(law, feedback.inputs, sampling).map_err(told);
            }
            Gains::Scheduled(over, schedule) => {
                let (states, desired): (Vec<_>, Vec<_>) = feedback.states.into_iter().unzip();
                let law = self.scheduled.len();
                for (place, expr) in desired.iter().enumerate() {
                    if let Some(expr) = expr {
                        self.push(Slot::Beside(law, place), expr).map_err(told)?;
                    }
                }
                self.scheduled.push(ScheduledLaw {
                    over,
                    schedule,
                    inputs: feedback.inputs,
                    states,
                });
                return Ok(());
            }
        };
        let law = feedback.sampled.is_some().then_some(self.sampled.len());
        for (&input, gains) in feedback.inputs.iter().zip(&gains) {
            for ((state, desired), &gain) in feedback.states.iter().zip(gains) {
                let term = Term {
                    input,
                    state: *state,
                    gain,
                    law,
                };
                match desired {
                    Some(expr) => self.push(Slot::Desired(term), expr).map_err(told)?,
                    None => self.zero.push(term),
                }
            }
        }
        if let Some(sampled) = feedback.sampled {
            self.sampled.push((sampled, feedback.inputs));
        }
        Ok(())
    }

    /// Adds a law that computes inputs from the equations of motion.
    fn by_model(
        &mut self,
        law: feedback::ModelLaw,
        inputs: Vec<usize>,
        sampling: Option<Sampling>,
    ) -> Result<(), &'static str> {
        let place = self.by_model.len();
        if let Aim::ComputedTorque { followed, .. } = &law.aim {
            for (which, followed) in followed.iter().enumerate() {
                let mut value = self.bench.lower(&followed.desired);
                for order in 0..3 {
                    let lowered = value.ok_or("an expression divides by the number zero")?;
                    self.exprs.push(lowered);
                    self.slots.push(Slot::Followed(place, which, order));
                    value = Some(self.bench.rate(lowered));
                }
            }
        }
        self.by_model.push(ModelLaw {
            inputs,
            aim: law.aim,
            believed: law.believed,
            sampling,
        });
        Ok(())
    }

    /// The inputs as functions of time and state, for motions of at most `until` in s.
    pub fn wiring(self, setup: &Setup<'_>, until: f64) -> Result<Wiring, Error> {
        let switches = InputSwitches::new(&self.bench, setup.info, &self.exprs)?;
        let function = self.bench.function(setup.info, self.exprs)?;
        let mut slots = self.slots;
        // Values beyond those of the function are zero.
        slots.extend(self.zero.into_iter().map(Slot::Desired));
        let sampled = self.sampled.into_iter().map(|(law, inputs)| SampledLaw {
            sampling: law.sampling,
            inputs,
            pending_gains: law.pending_gains,
        });
        let sampled: Vec<SampledLaw> = sampled.collect();
        let samplings = sampled.iter().map(|law| law.sampling);
        for sampling in samplings.chain(self.by_model.iter().filter_map(|law| law.sampling)) {
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
            slots,
            recorded: self.recorded.map(|table| table.values),
            driven: self.driven,
            sampled,
            scheduled: self.scheduled,
            by_model: self.by_model,
            switching_times: self.switching_times,
            switches,
        })
    }
}

/// Maximum number of measurements in a motion.
const MOST_MEASUREMENTS: f64 = 1e6;

impl Wiring {
    /// The inputs of a motion of a model from 0 to `until` in s.
    pub fn controller<'w>(
        &'w self,
        model: &'w dyn Model,
        parameters: Vec<f64>,
        until: f64,
    ) -> Controller<'w> {
        let mut times = self.switching_times.clone();
        let sampler = |sampling: Sampling| Sampler::new(sampling, until);
        let samplers = self.sampled.iter().map(|law| sampler(law.sampling));
        let samplers: Vec<Sampler> = samplers.collect();
        let model_samplers = self.by_model.iter().map(|law| law.sampling.map(sampler));
        let model_samplers: Vec<Option<Sampler>> = model_samplers.collect();
        let all = samplers.iter().chain(model_samplers.iter().flatten());
        times.extend(all.flat_map(Sampler::switching_times));
        Controller {
            wiring: self,
            model,
            parameters,
            samplers,
            model_samplers,
            switching_times: times,
            values: Cell::default(),
        }
    }

    /// Expressions and continuous-time laws as operations.
    fn law(&self, info: &ModelInfo) -> Tape {
        law::tape(&self.function, &self.slots, &self.scheduled, info)
    }

    /// The equations of motion with expressions and laws substituted; `rates` are the model's. `seen` are the measurements
    /// of laws, as inputs after those of [`Controller::fill_outside`].
    pub(crate) fn closed_loop(
        &self,
        rates: &Tape,
        info: &ModelInfo,
        seen: &[Onto],
    ) -> Result<ClosedLoop, Error> {
        let given = self.recorded.is_some() || !self.driven.is_empty() || !self.by_model.is_empty();
        let outside = Outside {
            inputs: self.function.inputs(),
            is_there: given || !self.sampled.is_empty() || self.function.has_signals(),
        };
        ClosedLoop::new(&self.law(info), rates, Sizes::from(info), outside, seen)
            .map_err(Error::computation)
    }

    /// Subtracts from each input the feedback of a law, or of the continuous-time terms.
    fn feedback(&self, law: Option<usize>, x: &[f64], values: &[f64], inputs: &mut [f64]) {
        for (slot, value) in self.slots.iter().zip(values) {
            match slot {
                Slot::Desired(term) if term.law == law => {
                    inputs[term.input] -= term.gain * (x[term.state] - value);
                }
                _ => {}
            }
        }
    }
}

impl Controller<'_> {
    /// Adds the held values of discrete-time laws to `count` inputs.
    fn add_held(
        &self,
        t: f64,
        x: &[f64],
        values: &[f64],
        count: usize,
        mut add: impl FnMut(usize, f64),
    ) {
        let wiring = self.wiring;
        let laws = wiring.sampled.iter().zip(&self.samplers);
        for (law, (sampled, sampler)) in laws.enumerate() {
            let acting = sampler.acting(t, |pending| {
                let mut asked = vec![0.0; count];
                wiring.feedback(Some(law), x, values, &mut asked);
                sampled.asked(&asked, &pending.concat())
            });
            for (&input, acting) in sampled.inputs.iter().zip(acting.iter().flatten()) {
                add(input, *acting);
            }
        }
    }

    /// Adds the inputs of laws by inverse dynamics to the declared inputs.
    fn add_by_model(&self, p: &[f64], t: f64, x: &[f64], values: &[f64], u: &mut [f64]) {
        let wiring = self.wiring;
        if wiring.by_model.is_empty() {
            return;
        }
        let mut all = vec![0.0; self.model.info().input_len()];
        let (declared, signals) = all.split_at_mut(u.len());
        wiring.function.fill_signals(t, signals);
        declared.copy_from_slice(u);
        let laws = wiring.by_model.iter().zip(&self.model_samplers);
        for (law, (by_model, sampler)) in laws.enumerate() {
            let mut desired = vec![[0.0; 3]; by_model.inputs.len()];
            for (slot, value) in wiring.slots.iter().zip(values) {
                if let Slot::Followed(of, which, order) = *slot
                    && of == law
                {
                    desired[which][order] = *value;
                }
            }
            let at = At { t, x, u: &all, p };
            let asked = || by_model.asked(self.model, at, &desired);
            let acting = match sampler {
                Some(sampler) => sampler.acting(t, |_| asked()),
                None => Some(asked()),
            };
            for (&input, acting) in by_model.inputs.iter().zip(acting.iter().flatten()) {
                all[input] += acting;
            }
        }
        u.copy_from_slice(&all[..u.len()]);
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

    /// External inputs of the [`ClosedLoop`] of the wiring: recordings, held inputs, signals. The parameters and the state
    /// are those that laws measure.
    pub(crate) fn fill_outside(&self, p: &[f64], t: f64, x: &[f64], u: &mut [f64]) {
        let wiring = self.wiring;
        let (declared, signals) = u.split_at_mut(wiring.function.declared().min(u.len()));
        self.fill_given(t, x, declared);
        if !wiring.sampled.is_empty() || !wiring.by_model.is_empty() {
            let mut values = vec![0.0; wiring.slots.len()];
            wiring.function.values(t, x, p, &mut values);
            let count = declared.len();
            self.add_held(t, x, &values, count, |input, held| declared[input] += held);
            self.add_by_model(p, t, x, &values, declared);
        }
        wiring.function.fill_signals(t, signals);
    }

    /// The inputs with other parameters in the expressions, as many as those of the motion.
    pub fn inputs_with(&self, p: &[f64], t: f64, x: &[f64], u: &mut [f64]) {
        let wiring = self.wiring;
        self.fill_given(t, x, u);
        let mut values = self.values.take();
        values.clear();
        values.resize(wiring.slots.len(), 0.0);
        wiring.function.values(t, x, p, &mut values);
        for (slot, value) in wiring.slots.iter().zip(&values) {
            if let Slot::Input(input) = *slot {
                u[input] += value;
            }
        }
        wiring.feedback(None, x, &values, u);
        for (law, scheduled) in wiring.scheduled.iter().enumerate() {
            scheduled.add(x, p, u, |y| {
                for (slot, value) in wiring.slots.iter().zip(&values) {
                    if let Slot::Beside(of, place) = *slot
                        && of == law
                    {
                        y[place] -= value;
                    }
                }
            });
        }
        let count = u.len();
        self.add_held(t, x, &values, count, |input, held| u[input] += held);
        self.add_by_model(p, t, x, &values, u);
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
        self.bounds_along(along, u);
    }

    fn switching(&self) -> Option<&dyn Switching> {
        let switches = self.wiring.switches.as_ref();
        switches.map(|switches| switches as &dyn Switching)
    }
}

impl ScheduledLaw {
    /// Adds the inputs of the law; `less` subtracts the desired deviations from the states.
    fn add(&self, x: &[f64], p: &[f64], u: &mut [f64], less: impl Fn(&mut DVector<f64>)) {
        let states = self.states.iter().map(|&state| x[state]);
        let mut y = DVector::from_iterator(self.states.len(), states);
        less(&mut y);
        let asked = self.schedule.at(self.over.value(x, p)).asked(&y);
        for (&input, asked) in self.inputs.iter().zip(asked.iter()) {
            u[input] += asked;
        }
    }
}

impl SampledLaw {
    /// The inputs after a measurement, from the feedback of the states and the pending inputs, the oldest
    /// first. Initially fewer inputs are pending than there are gains.
    fn asked(&self, feedback: &[f64], pending: &[f64]) -> Vec<f64> {
        let rows = self.inputs.iter().zip(&self.pending_gains);
        rows.map(|(&input, gains)| {
            let terms = gains.iter().rev().zip(pending.iter().rev());
            feedback[input] - terms.map(|(gain, pending)| gain * pending).sum::<f64>()
        })
        .collect()
    }
}
