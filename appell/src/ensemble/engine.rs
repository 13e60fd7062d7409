//! Runs the cases of a study, one motion after the other. Whatever runs several at once replaces this file.

use std::cell::{Cell, RefCell};
use std::ops::Range;

use appell_ensemble::rows::{Column, Role, Rows};
use appell_ensemble::run::{Engine, Watch};
use appell_ensemble::study::{Kept, Method as Word};
use appell_runtime::Simulation;
use appell_runtime::inputs::ModelInputs;
use appell_runtime::integrate::{Cause, Direction, Ending, Event, Options};
use appell_runtime::model::ModelInfo;
use appell_runtime::simulate::{Method, Observed, Response, SimulationError, Validity};

use super::factors::Target;
use super::noise::{Draws, Noisy};
use super::observer::{Gauge, Keeper};
use super::spec::Quantity;
use super::variant::Variant;
use super::{Ensemble, Task};

impl Engine for Ensemble {
    fn columns(&self) -> &[Column] {
        &self.task.layout.columns
    }

    fn run(&self, cases: Range<u64>, watch: &Watch<'_>, rows: &mut Rows) {
        let mut row = vec![f64::NAN; self.task.layout.columns.len()];
        for case in cases {
            if !(watch.go_on)() {
                return;
            }
            let (end, reason) = self.motion(&self.task, Draws::Case(case), &mut row);
            if !reason.is_empty() {
                self.forget(&mut row);
            }
            rows.push(&row, end, &reason);
            (watch.done)(1);
        }
    }
}

/// What a case begins with.
struct Start {
    parameters: Vec<f64>,
    initial: Vec<f64>,
}

impl Ensemble {
    /// Runs a motion; returns when it ended, and why it ended early.
    pub(super) fn motion(&self, task: &Task, draws: Draws<'_>, row: &mut [f64]) -> (f64, String) {
        row.fill(f64::NAN);
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
        let variant = &self.variants[model * self.laws + law];
        let start = match start(variant, &row[..count]) {
            Ok(start) => start,
            Err(reason) => return (0.0, reason),
        };
        let moved = self.moved(task, variant, draws, start, row);
        moved.unwrap_or_else(|error| (0.0, told(&error, variant)))
    }

    /// Of a motion that ended early nobody knows the numbers of the whole: its courses until then and the events that
    /// happened are left.
    fn forget(&self, row: &mut [f64]) {
        let mut is_unknown = false;
        for (value, column) in row.iter_mut().zip(&self.task.layout.columns) {
            is_unknown = match column.role {
                Role::Value => true,
                Role::Event => *value == 0.0,
                // Of the number or event before it.
                Role::When => is_unknown,
                Role::Factor(_) | Role::Course { .. } => false,
            };
            if is_unknown {
                *value = f64::NAN;
            }
        }
    }

    fn moved(
        &self,
        task: &Task,
        variant: &Variant,
        draws: Draws<'_>,
        start: Start,
        row: &mut [f64],
    ) -> Result<(f64, String), SimulationError> {
        let study = &self.study;
        let until = study.motion.t_end;
        let model = variant.model.equations();
        let p = start.parameters.clone();
        let source = Noisy {
            controller: variant.wiring.controller(start.parameters, until),
            noises: &variant.noises,
            draws,
            drawn: self.design.drawn().count(),
            until,
            scratch: Cell::default(),
        };
        let inputs = ModelInputs::new(model.info(), &source)?;
        let kept: Vec<Quantity> = task.which.iter().map(|&k| variant.kept[k]).collect();
        let gauge = RefCell::new(Gauge::new(model, &inputs, &p, &kept));
        let (mut events, mut columns) = (Vec::new(), Vec::new());
        let mut over = false;
        for (index, keep) in task.keep.iter().enumerate() {
            let Kept::When { stop } = keep.kept else {
                continue;
            };
            let gauge = &gauge;
            let g = move |t: f64, x: &[f64]| gauge.borrow_mut().value(index, t, x);
            let column = task.layout.first[index];
            let holds = g(0.0, &start.initial) > 0.0;
            row[column] = f64::from(u8::from(holds));
            if holds {
                row[column + 1] = 0.0;
                over |= stop;
                continue;
            }
            columns.push(column);
            events.push(Event {
                terminal: stop,
                ..Event::new(Direction::Rising, g)
            });
        }
        let motion = &study.motion;
        let options = Options::with_tolerances(motion.rtol, motion.atol);
        let max_steps = motion.max_steps.and_then(|most| usize::try_from(most).ok());
        let simulation = Simulation {
            parameters: p.clone(),
            initial_state: start.initial,
            inputs: &source,
            span: [0.0, if over { 0.0 } else { until }],
            method: match motion.method {
                Word::Dop853 => Method::Dop853,
                Word::Dopri5 => Method::Dopri5,
            },
            options: Options {
                max_steps: max_steps.unwrap_or(options.max_steps),
                ..options
            },
            validity: Validity {
                ranges: if motion.ignore_ranges {
                    Response::Ignore
                } else {
                    Response::Stop
                },
                ..Validity::default()
            },
            events,
            ..Simulation::new(model)
        };
        let (observed, keeper) = simulation
            .observe(|span, x| Keeper::new(&gauge, &task.keep, &task.layout, row, (span[0], x)))?;
        let row = keeper.finish(&task.layout, observed.t);
        for hit in &observed.events {
            let column = columns[hit.event];
            if row[column] == 0.0 {
                row[column] = 1.0;
                row[column + 1] = hit.t;
            }
        }
        let reason = reason(&observed, model.info());
        if reason.is_empty() {
            for (index, keep) in task.keep.iter().enumerate() {
                if keep.kept == Kept::End {
                    let value = gauge.borrow_mut().value(index, observed.t, &observed.state);
                    row[task.layout.first[index]] = value;
                }
            }
        }
        Ok((observed.t, reason))
    }
}

/// Parameters and initial values of a case; or why it has none.
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

/// Why a motion ended early, in words that many cases share; empty where it did not.
fn reason(observed: &Observed, info: &ModelInfo) -> String {
    let cause = match &observed.ending {
        Ok(Ending::Finished | Ending::Event(_)) => return String::new(),
        Ok(Ending::Stopped) => {
            let breach = observed.breaches.last();
            return breach.map_or_else(String::new, |breach| breach.describe(info));
        }
        Err(cause) => cause,
    };
    let name = |index: usize| info.states.get(index).map_or("?", |q| q.name.as_ref());
    match *cause {
        Cause::NonFinite { component } => {
            format!("`{}` or its rate is not finite", name(component))
        }
        Cause::NotAnalytic { component } => {
            format!("`{}` has no Taylor series", name(component))
        }
        Cause::OutOfRange { component, .. } => format!("`{}` leaves its range", name(component)),
        Cause::StepTooSmall { .. } => "the step shrank to nothing".to_owned(),
        Cause::TooManySteps { .. } => "the limit of steps was reached".to_owned(),
        Cause::Inconsistent => cause.to_string(),
    }
}

/// Why a motion does not begin, without its numbers.
fn told(error: &SimulationError, variant: &Variant) -> String {
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
