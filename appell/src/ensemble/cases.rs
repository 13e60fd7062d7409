//! The cases of a study: their factors, initial conditions and inputs, and their rows.

use std::cell::Cell;

use appell_ensemble::design::Design;
use appell_ensemble::rows::{Role, Rows};
use appell_ensemble::study::{Keep, Motion, Study};
use appell_runtime::Simulation;
use appell_runtime::integrate::{Cause, Options};
use appell_runtime::model::ModelInfo;
use appell_runtime::simulate::{Response, SimulationError, Validity};

use super::factors::Target;
use super::layout::Layout;
use super::noise::{Draws, Noisy};
use super::variant::Variant;

/// A study whose specs and laws are compiled.
pub(super) struct Cases {
    pub(super) study: Study,
    pub(super) design: Design,
    /// Values of the factors that choose between numbers.
    pub(super) choices: Vec<Vec<f64>>,
    pub(super) task: Task,
    /// One for each spec and law, laws varying fastest.
    pub(super) variants: Vec<Variant>,
    /// Number of laws between which a factor chooses, or 1.
    pub(super) laws: usize,
}

/// The kept quantities of a motion, and their columns.
pub(super) struct Task {
    pub(super) keep: Vec<Keep>,
    /// Indices among the kept quantities of the study.
    pub(super) which: Vec<usize>,
    pub(super) layout: Layout,
}

/// Result of a case.
pub(super) struct Row {
    pub(super) values: Vec<f64>,
    /// End time of the motion, in s.
    end: f64,
    /// Why it ended early.
    reason: String,
}

impl Row {
    /// Rows without values.
    pub(super) fn empty(task: &Task, count: usize) -> Vec<Self> {
        let empty = || Self {
            values: vec![f64::NAN; task.layout.columns.len()],
            end: 0.0,
            reason: String::new(),
        };
        std::iter::repeat_with(empty).take(count).collect()
    }

    pub(super) fn fail(&mut self, reason: String) {
        self.end_at(0.0, reason);
    }

    pub(super) fn end_at(&mut self, end: f64, reason: String) {
        (self.end, self.reason) = (end, reason);
    }
}

/// Initial conditions of a case.
pub(super) struct Start {
    pub(super) parameters: Vec<f64>,
    pub(super) initial: Vec<f64>,
}

/// A case with its initial conditions.
pub(super) struct Ride<'r> {
    draws: Draws<'r>,
    pub(super) start: Start,
    pub(super) row: &'r mut Row,
}

impl Cases {
    /// Number of factors, whose columns are the first ones of a row.
    pub(super) fn factors(&self) -> usize {
        self.design.factors().len()
    }

    /// The motions of each variant; writes their factors, and the reason where one cannot start.
    pub(super) fn drawn<'r>(&self, draws: &[Draws<'r>], rows: &'r mut [Row]) -> Vec<Vec<Ride<'r>>> {
        let mut rides: Vec<Vec<Ride<'_>>> = self.variants.iter().map(|_| Vec::new()).collect();
        for (row, &draws) in rows.iter_mut().zip(draws) {
            let variant = self.draw(draws, &mut row.values);
            let factors = &row.values[..self.design.factors().len()];
            match start(&self.variants[variant], factors) {
                Ok(start) => rides[variant].push(Ride { draws, start, row }),
                Err(reason) => row.fail(reason),
            }
        }
        rides
    }

    /// Appends rows, without the values that an early end leaves open.
    pub(super) fn push(&self, all: Vec<Row>, rows: &mut Rows) {
        for mut row in all {
            if !row.reason.is_empty() {
                self.forget(&mut row.values);
            }
            rows.push(&row.values, row.end, &row.reason);
        }
    }

    /// Writes the factors of a case; returns the number of its variant.
    fn draw(&self, draws: Draws<'_>, row: &mut [f64]) -> usize {
        let count = self.design.factors().len();
        match draws {
            Draws::Case(case) => self.design.point(case, &mut row[..count]),
            Draws::Scores(scores) => self.design.point_at(scores, &mut row[..count]),
        }
        let [mut model, mut law] = [0; 2];
        for (value, target) in row[..count].iter().zip(&self.variants[0].targets) {
            // The number of a choice.
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            match target {
                Target::Model => model = *value as usize,
                Target::Feedback => law = *value as usize,
                _ => {}
            }
        }
        for (value, items) in row.iter_mut().zip(&self.choices) {
            // The number of a choice.
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            if let Some(item) = items.get(*value as usize) {
                *value = *item;
            }
        }
        model * self.laws + law
    }

    /// Clears values that a motion with an early end does not determine; its courses until then and the events that
    /// happened remain.
    fn forget(&self, row: &mut [f64]) {
        let mut is_unknown = false;
        for (value, column) in row.iter_mut().zip(&self.task.layout.columns) {
            is_unknown = match column.role {
                Role::Value => true,
                Role::Event => *value == 0.0,
                // That of the number or event before it.
                Role::When => is_unknown,
                Role::Factor(_) | Role::Course { .. } => false,
            };
            if is_unknown {
                *value = f64::NAN;
            }
        }
    }

    /// The inputs of a motion.
    pub(super) fn source<'v>(&self, variant: &'v Variant, ride: &Ride<'v>) -> Noisy<'v> {
        let until = self.study.motion.t_end;
        Noisy {
            controller: variant.wiring.controller(
                variant.model.equations(),
                ride.start.parameters.clone(),
                until,
            ),
            noises: &variant.noises,
            draws: ride.draws,
            drawn: self.design.drawn().count(),
            until,
            scratch: Cell::default(),
        }
    }

    pub(super) fn simulation<'v>(
        &self,
        variant: &'v Variant,
        start: &Start,
        inputs: &'v Noisy<'v>,
    ) -> Simulation<'v> {
        let motion = &self.study.motion;
        Simulation {
            parameters: start.parameters.clone(),
            initial_state: start.initial.clone(),
            inputs,
            span: [0.0, motion.t_end],
            validity: Validity {
                ranges: if motion.ignore_ranges {
                    Response::Ignore
                } else {
                    Response::Stop
                },
                ..Validity::default()
            },
            ..Simulation::new(variant.model.equations())
        }
    }

    /// The most values of noise in a motion.
    pub(super) fn noise_times(&self) -> u64 {
        let until = self.study.motion.t_end;
        let counts = self.variants.iter().map(|variant| {
            let counts = variant.noises.iter().map(|noise| noise.count(until) as u64);
            counts.sum()
        });
        counts.max().unwrap_or(0)
    }
}

/// Tolerances of the motions, and the limit of their steps.
pub(super) fn options(motion: &Motion) -> Options {
    let options = Options::with_tolerances(motion.rtol, motion.atol);
    let max_steps = motion.max_steps.and_then(|most| usize::try_from(most).ok());
    Options {
        max_steps: max_steps.unwrap_or(options.max_steps),
        ..options
    }
}

/// Parameters and initial values of a case, or why it has none.
fn start(variant: &Variant, factors: &[f64]) -> Result<Start, String> {
    let mut parameters = variant.parameters.clone();
    let mut initial = variant.initial.clone();
    let info = variant.model.info();
    for (&value, target) in factors.iter().zip(&variant.targets) {
        if let Target::Parameter(index) = *target {
            parameters[index] = value;
        }
    }
    let mut value = [0.0];
    for (index, function) in &variant.set {
        function.values(0.0, &initial, &parameters, &mut value);
        parameters[*index] = value[0];
    }
    let limits = parameters.iter().zip(&variant.limits);
    if let Some(index) = limits
        .into_iter()
        .position(|(p, [low, high])| !(*low..=*high).contains(p))
    {
        let name = &info.parameters[index].name;
        return Err(format!("`{name}` is outside its limits"));
    }
    for (index, function) in &variant.start {
        function.values(0.0, &variant.initial, &parameters, &mut value);
        initial[*index] = value[0];
    }
    for (&value, target) in factors.iter().zip(&variant.targets) {
        if let Target::State(index) = *target {
            initial[index] = value;
        }
    }
    Ok(Start {
        parameters,
        initial,
    })
}

/// The cause of an early end, without its numbers.
pub(super) fn cause_of(cause: &Cause, info: &ModelInfo) -> String {
    let name = |index: usize| info.states.get(index).map_or("?", |q| q.name.as_ref());
    match *cause {
        Cause::NonFinite { component } => {
            format!("`{}` or its rate is not finite", name(component))
        }
        Cause::OutOfRange { component, .. } => format!("`{}` leaves its range", name(component)),
        Cause::StepTooSmall { .. } => "the step shrank to nothing".to_owned(),
        Cause::TooManySteps { .. } => "the limit of steps was reached".to_owned(),
        Cause::Inconsistent | Cause::Chattering => cause.to_string(),
    }
}

/// Why a motion cannot start, without its numbers.
pub(super) fn told(error: &SimulationError, variant: &Variant) -> String {
    let info = variant.model.info();
    match error {
        SimulationError::Inconsistent { source, .. } => {
            let name = info
                .states
                .get(source.state)
                .map_or("?", |q| q.name.as_ref());
            format!("the mechanism cannot be assembled: no value of `{name}` fits")
        }
        SimulationError::Undetermined { .. } => {
            "the pseudo-velocities do not determine the motion at the start".to_owned()
        }
        other => other.to_string(),
    }
}
