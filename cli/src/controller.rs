//! Everything that drives the inputs of a simulation.

use appell_codegen::symbolic::Expr as Lowered;
use appell_runtime::inputs::{InputSource, TabulatedInputs};
use appell_spec::expr::Expr;
use appell_spec::{Report, Scope, Snippet, formula};

use crate::failure::Failure;
use crate::feedback::Feedback;
use crate::formula::{StateFunction, Workbench, switching_times};
use crate::setup::{Assignment, Setup, bracketed};

/// Inputs from expressions, feedback laws and recordings; they add up.
pub(crate) struct Controller {
    /// One value per entry of `slots`.
    function: StateFunction,
    slots: Vec<Slot>,
    parameters: Vec<f64>,
    recorded: Option<TabulatedInputs>,
    switching_times: Vec<f64>,
}

/// What a value of the function means.
enum Slot {
    /// It is added to an input.
    Input(usize),
    /// It is the desired value of a state: the input falls by the gain times the deviation.
    Desired {
        input: usize,
        state: usize,
        gain: f64,
    },
}

/// Collects what drives the inputs.
pub(crate) struct Plan {
    bench: Workbench,
    exprs: Vec<Lowered>,
    slots: Vec<Slot>,
    /// Desired values of zero need no expression.
    zero: Vec<(usize, usize, f64)>,
    recorded: Option<TabulatedInputs>,
    switching_times: Vec<f64>,
    /// Inputs that an expression or a recording sets.
    set: Vec<usize>,
}

impl Plan {
    /// No inputs.
    pub(crate) fn new(setup: &Setup<'_>) -> Self {
        Self {
            bench: Workbench::new(&setup.mechanism),
            exprs: Vec::new(),
            slots: Vec::new(),
            zero: Vec::new(),
            recorded: None,
            switching_times: Vec::new(),
            set: Vec::new(),
        }
    }

    /// Whether nothing drives the mechanism.
    pub(crate) fn is_empty(&self) -> bool {
        self.slots.is_empty() && self.zero.is_empty() && self.recorded.is_none()
    }

    fn take(&mut self, input: usize, setup: &Setup<'_>) -> Result<(), Failure> {
        if self.set.contains(&input) {
            let name = &setup.mechanism.inputs[input].label.name;
            return Err(Failure::Usage(format!("the input `{name}` is given twice")));
        }
        self.set.push(input);
        Ok(())
    }

    /// Takes an expression, which may not divide by the number zero.
    fn push(&mut self, slot: Slot, expr: &Expr) -> Result<(), &'static str> {
        let lowered = self.bench.lower(expr);
        self.exprs
            .push(lowered.ok_or("an expression divides by the number zero")?);
        self.slots.push(slot);
        switching_times(expr, &mut self.switching_times);
        Ok(())
    }

    /// `--input NAME=EXPR`
    pub(crate) fn expression(
        &mut self,
        assignment: &Assignment,
        setup: &Setup<'_>,
    ) -> Result<(), Failure> {
        let input = setup.input(&assignment.name)?;
        self.take(input, setup)?;
        let unit = &setup.mechanism.inputs[input].label.unit;
        let text = bracketed(&assignment.value);
        let expr = formula(
            setup.spec,
            &Snippet::alone(&text),
            "the input",
            Scope::Law,
            unit,
        )
        .map_err(|findings| {
            let label = format!("--input {}", assignment.name);
            Failure::Expression(Box::new(Report::new(label, text.as_ref(), findings)))
        })?;
        self.push(Slot::Input(input), &expr)
            .map_err(|told| Failure::Usage(format!("--input {}: {told}", assignment.name)))
    }

    /// `--inputs FILE`
    pub(crate) fn recording(
        &mut self,
        recorded: TabulatedInputs,
        inputs: &[usize],
        setup: &Setup<'_>,
    ) -> Result<(), Failure> {
        for &input in inputs {
            self.take(input, setup)?;
        }
        self.switching_times.extend(recorded.switching_times());
        self.recorded = Some(recorded);
        Ok(())
    }

    /// `--feedback FILE`
    pub(crate) fn feedback(&mut self, feedback: Feedback) -> Result<(), Failure> {
        let told = |told| Failure::Data(format!("{}: {told}", feedback.file));
        let input = feedback.input;
        if let Some(offset) = &feedback.offset {
            self.push(Slot::Input(input), offset).map_err(told)?;
        }
        for (state, gain, desired) in feedback.terms {
            match desired {
                Some(expr) => self
                    .push(Slot::Desired { input, state, gain }, &expr)
                    .map_err(told)?,
                None => self.zero.push((input, state, gain)),
            }
        }
        self.switching_times.extend(feedback.switching_times);
        Ok(())
    }

    /// The inputs as a function of time and state.
    pub(crate) fn controller(self, setup: &Setup<'_>) -> Result<Controller, Failure> {
        let function = self
            .bench
            .function(setup.info, self.exprs)
            .map_err(|error| Failure::Computation(error.to_string()))?;
        let mut slots = self.slots;
        // Values beyond those of the function are zero.
        slots.extend(
            self.zero
                .into_iter()
                .map(|(input, state, gain)| Slot::Desired { input, state, gain }),
        );
        Ok(Controller {
            function,
            slots,
            parameters: setup.parameters.clone(),
            recorded: self.recorded,
            switching_times: self.switching_times,
        })
    }
}

impl InputSource for Controller {
    fn inputs(&self, t: f64, x: &[f64], u: &mut [f64]) {
        match &self.recorded {
            Some(recorded) => recorded.inputs(t, x, u),
            None => u.fill(0.0),
        }
        let mut values = vec![0.0; self.slots.len()];
        self.function.values(t, x, &self.parameters, &mut values);
        for (slot, value) in self.slots.iter().zip(values) {
            match *slot {
                Slot::Input(input) => u[input] += value,
                Slot::Desired { input, state, gain } => u[input] -= gain * (x[state] - value),
            }
        }
    }

    fn switching_times(&self) -> Vec<f64> {
        self.switching_times.clone()
    }
}
