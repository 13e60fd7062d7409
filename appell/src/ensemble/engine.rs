//! Runs the cases of a study, eight motions at once.

use std::cell::{Cell, RefCell};
use std::ops::Range;

use appell_ensemble::rows::{Column, Role, Rows};
use appell_ensemble::run::{Engine, Watch};
use appell_ensemble::study::{Kept, Method, Motion};
use appell_runtime::Simulation;
use appell_runtime::inputs::ModelInputs;
use appell_runtime::integrate::{
    BlockSolver, Cause, Direction, Dop853, Dopri5, Ending, Event, Options,
};
use appell_runtime::lanes::LANES;
use appell_runtime::model::ModelInfo;
use appell_runtime::real::Enclosure;
use appell_runtime::simulate::{
    Observed, Prepared, Response, SimulationError, Validity, Viewer, observe_together,
};

use super::factors::Target;
use super::noise::{Draws, Noisy};
use super::observer::{Gauge, Keeper};
use super::spec::Quantity;
use super::variant::Variant;
use super::{Ensemble, Task};
use crate::inputs::closed_loop::ClosedLoop;

/// Cases that are set up together and grouped into blocks of the same spec and law: fewer if each has many switching
/// times of noise, but at least a block.
const TOGETHER: u64 = 64;
/// Limit on the switching times of all of them.
const TIMES: u64 = 1 << 20;

impl Engine for Ensemble {
    fn columns(&self) -> &[Column] {
        &self.task.layout.columns
    }

    fn run(&self, cases: Range<u64>, watch: &Watch<'_>, rows: &mut Rows) {
        #[cfg(feature = "cuda")]
        if let Some(card) = &self.card {
            return card.run(self, cases, watch, rows);
        }
        let mut solvers = Solvers::default();
        let mut next = cases.start;
        let times = self.noise_times();
        let together = (TIMES / times.max(1)).clamp(LANES as u64, TOGETHER);
        while next < cases.end {
            if !(watch.go_on)() {
                return;
            }
            let some = next..cases.end.min(next + together);
            let draws: Vec<Draws<'_>> = some.clone().map(Draws::Case).collect();
            let motions = self.motions(&self.task, &draws, &mut solvers, watch.go_on);
            if !(watch.go_on)() {
                // Motions may have been interrupted.
                return;
            }
            self.push(motions, rows);
            (watch.done)(some.end - some.start);
            next = some.end;
        }
    }
}

/// Work arrays of all methods.
#[derive(Default)]
struct Solvers {
    dop853: BlockSolver<Dop853>,
    dopri5: BlockSolver<Dopri5>,
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
    initial: Vec<f64>,
}

/// A case with its initial conditions.
pub(super) struct Ride<'r> {
    draws: Draws<'r>,
    pub(super) start: Start,
    pub(super) row: &'r mut Row,
}

impl Ensemble {
    /// Runs motions with new work arrays.
    pub(super) fn rows_of(&self, task: &Task, draws: &[Draws<'_>]) -> Vec<Row> {
        self.motions(task, draws, &mut Solvers::default(), &|| true)
    }

    /// Runs motions; returns a row for each.
    fn motions(
        &self,
        task: &Task,
        draws: &[Draws<'_>],
        solvers: &mut Solvers,
        go_on: &(dyn Fn() -> bool + Sync),
    ) -> Vec<Row> {
        let mut rows = self.empty_rows(task, draws.len());
        let rides = self.drawn(draws, &mut rows);
        for (variant, mut rides) in self.variants.iter().zip(rides) {
            if !rides.is_empty() {
                self.ride(task, variant, &mut rides, solvers, go_on);
            }
        }
        rows
    }

    /// Rows without values.
    pub(super) fn empty_rows(&self, task: &Task, count: usize) -> Vec<Row> {
        let empty = || Row {
            values: vec![f64::NAN; task.layout.columns.len()],
            end: 0.0,
            reason: String::new(),
        };
        std::iter::repeat_with(empty).take(count).collect()
    }

    /// The motions of each variant; writes their factors, and the reason where one cannot start.
    pub(super) fn drawn<'r>(
        &self,
        draws: &[Draws<'r>],
        rows: &'r mut [Row],
    ) -> Vec<Vec<Ride<'r>>> {
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

    /// Runs motions under one spec and law.
    fn ride(
        &self,
        task: &Task,
        variant: &Variant,
        rides: &mut [Ride<'_>],
        solvers: &mut Solvers,
        go_on: &(dyn Fn() -> bool + Sync),
    ) {
        let sources: Vec<Noisy<'_>> = rides
            .iter()
            .map(|ride| self.source(variant, ride))
            .collect();
        let (starts, mut rows): (Vec<&Start>, Vec<&mut Row>) = rides
            .iter_mut()
            .map(|ride| (&ride.start, &mut *ride.row))
            .unzip();
        let model = variant.model.equations();
        let inputs = sources
            .iter()
            .map(|source| ModelInputs::new(model.info(), source));
        let inputs = match inputs.collect::<Result<Vec<_>, _>>() {
            Ok(inputs) => inputs,
            Err(error) => {
                let reason = told(&error.into(), variant);
                return rows.iter_mut().for_each(|row| row.fail(reason.clone()));
            }
        };
        let kept: Vec<Quantity> = task.which.iter().map(|&k| variant.kept[k]).collect();
        let gauges = starts.iter().zip(inputs.iter().zip(&sources));
        let gauges: Vec<_> = gauges
            .map(|(start, (inputs, source))| {
                RefCell::new(Gauge::new(model, inputs, source, &start.parameters, &kept))
            })
            .collect();
        let (mut awaited, mut simulations) = (Vec::new(), Vec::new());
        for (((start, row), gauge), source) in
            starts.iter().zip(&mut rows).zip(&gauges).zip(&sources)
        {
            let events = Awaited::new(task, gauge, &start.initial, &mut row.values);
            simulations.push(self.simulation(variant, start, source, events.is_over));
            awaited.push(events);
        }
        // Motions with initial conditions, and their indices.
        let (mut prepared, mut which) = (Vec::new(), Vec::new());
        for (place, (simulation, inputs)) in simulations.iter().zip(&inputs).enumerate() {
            match Prepared::new(simulation, inputs) {
                Ok(start) => {
                    prepared.push(start);
                    which.push(place);
                }
                Err(error) => rows[place].fail(told(&error, variant)),
            }
        }
        let mut values: Vec<Option<&mut [f64]>> = rows
            .iter_mut()
            .map(|row| Some(row.values.as_mut_slice()))
            .collect();
        let viewers = prepared
            .iter()
            .zip(&which)
            .filter_map(|(prepared, &place)| {
                let gauge = &gauges[place];
                let (t, x) = (prepared.span()[0], prepared.start());
                let row = values[place].take()?;
                Some(Viewer {
                    events: awaited[place].events(task, gauge),
                    observer: Keeper::new(gauge, &task.keep, &task.layout, row, t, x, go_on),
                })
            });
        let viewers = viewers.collect();
        let sources: Vec<&Noisy<'_>> = which.iter().map(|&place| &sources[place]).collect();
        let ended = self.observe(solvers, &variant.closed, &sources, &prepared, viewers);
        let mut ends = Vec::new();
        for (ended, place) in ended.into_iter().zip(which) {
            let end = ended.map(|(observed, keeper)| {
                let values = keeper.finish(&task.layout, observed.t);
                awaited[place].happened(&observed, values);
                let reason = reason(&observed, model.info());
                if reason.is_empty() {
                    let mut gauge = gauges[place].borrow_mut();
                    for (index, keep) in task.keep.iter().enumerate() {
                        if keep.kept == Kept::End {
                            let value = gauge.value(index, observed.t, &observed.state);
                            values[task.layout.first[index]] = value;
                        }
                    }
                }
                (observed.t, reason)
            });
            ends.push((
                place,
                end.unwrap_or_else(|error| (0.0, told(&error, variant))),
            ));
        }
        for (place, (end, reason)) in ends {
            (rows[place].end, rows[place].reason) = (end, reason);
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
        is_over: bool,
    ) -> Simulation<'v> {
        let motion = &self.study.motion;
        Simulation {
            parameters: start.parameters.clone(),
            initial_state: start.initial.clone(),
            inputs,
            span: [0.0, if is_over { 0.0 } else { motion.t_end }],
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

    fn observe<'w>(
        &self,
        solvers: &mut Solvers,
        closed: &ClosedLoop,
        sources: &[&Noisy<'_>],
        prepared: &'w [Prepared<'w>],
        viewers: Vec<Viewer<'w, Keeper<'w>>>,
    ) -> Vec<Result<(Observed, Keeper<'w>), SimulationError>> {
        let motion = &self.study.motion;
        let options = options(motion);
        let rates = closed.rates_of(|which, t, x, u| sources[which].fill_outside(t, x, u));
        observe_together(prepared, viewers, |motions| match motion.method {
            Method::Dopri5 => solvers.dopri5.integrate(rates, motions, &options),
            Method::Dop853 => solvers.dop853.integrate(rates, motions, &options),
        })
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

/// Events that have not happened yet.
struct Awaited {
    /// Indices among the kept quantities, and in the row.
    places: Vec<(usize, usize)>,
    /// Whether a stopping event has happened at the start.
    is_over: bool,
}

impl Awaited {
    /// Writes the events at the start.
    fn new(task: &Task, gauge: &RefCell<Gauge<'_>>, x: &[f64], row: &mut [f64]) -> Self {
        let (mut places, mut is_over) = (Vec::new(), false);
        for (index, keep) in task.keep.iter().enumerate() {
            let Kept::When { stop } = keep.kept else {
                continue;
            };
            let column = task.layout.first[index];
            let holds = gauge.borrow_mut().value(index, 0.0, x) > 0.0;
            row[column] = f64::from(u8::from(holds));
            if holds {
                row[column + 1] = 0.0;
                is_over |= stop;
            } else {
                places.push((index, column));
            }
        }
        Self { places, is_over }
    }

    fn events<'g>(&self, task: &Task, gauge: &'g RefCell<Gauge<'g>>) -> Vec<Event<'g>> {
        let event = |&(index, _): &(usize, usize)| {
            let g = move |t: f64, x: &[f64]| gauge.borrow_mut().value(index, t, x);
            Event {
                terminal: task.keep[index].kept == Kept::When { stop: true },
                longest: task.layout.interval,
                hides: Some(Box::new(move |piece, start, interior| {
                    let (keeps, size) = (Enclosure::keeps_its_sign, piece.size());
                    let mut gauge = gauge.borrow_mut();
                    gauge.hides(index, piece, start, interior, keeps, size)
                })),
                ..Event::new(Direction::Rising, g)
            }
        };
        self.places.iter().map(event).collect()
    }

    /// Writes which events happened, and their first times.
    fn happened(&self, observed: &Observed, row: &mut [f64]) {
        for hit in &observed.events {
            let (_, column) = self.places[hit.event];
            if row[column] == 0.0 {
                row[column] = 1.0;
                row[column + 1] = hit.t;
            }
        }
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

/// Why a motion ended early, as one of few texts; empty if it did not.
fn reason(observed: &Observed, info: &ModelInfo) -> String {
    match &observed.ending {
        Ok(Ending::Finished | Ending::Event(_)) => String::new(),
        Ok(Ending::Stopped) => {
            let breach = observed.breaches.last();
            breach.map_or_else(String::new, |breach| breach.describe(info))
        }
        Err(cause) => cause_of(cause, info),
    }
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
