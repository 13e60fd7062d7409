//! Runs the cases of a study, eight motions at once.

use std::cell::RefCell;
use std::ops::Range;

use appell_ensemble::rows::Rows;
use appell_ensemble::run::Watch;
use appell_ensemble::study::{Kept, Method};
use appell_runtime::inputs::ModelInputs;
use appell_runtime::integrate::{BlockSolver, Direction, Dop853, Dopri5, Ending, Event};
use appell_runtime::lanes::LANES;
use appell_runtime::model::ModelInfo;
use appell_runtime::real::Enclosure;
use appell_runtime::simulate::{Observed, Prepared, SimulationError, Viewer, observe_together};

use super::cases::{Cases, Ride, Row, Start, Task, cause_of, options, told};
use super::noise::{Draws, Noisy};
use super::observer::{Gauge, Keeper};
use super::spec::Quantity;
use super::variant::Variant;
use crate::inputs::closed_loop::ClosedLoop;

/// Cases that are set up together and grouped into blocks of the same spec and law: fewer if each has many switching
/// times of noise, but at least a block.
const TOGETHER: u64 = 64;
/// Limit on the switching times of all of them.
const TIMES: u64 = 1 << 20;

/// Work arrays of all methods.
#[derive(Default)]
struct Solvers {
    dop853: BlockSolver<Dop853>,
    dopri5: BlockSolver<Dopri5>,
}

impl Cases {
    /// Appends the rows of consecutive cases, eight motions at once.
    pub(super) fn run(&self, cases: Range<u64>, watch: &Watch<'_>, rows: &mut Rows) {
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
        let mut rows = Row::empty(task, draws.len());
        let rides = self.drawn(draws, &mut rows);
        for (variant, mut rides) in self.variants.iter().zip(rides) {
            if !rides.is_empty() {
                self.ride(task, variant, &mut rides, solvers, go_on);
            }
        }
        rows
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
        let simulations = starts.iter().zip(&sources);
        let simulations: Vec<_> = simulations
            .map(|(start, source)| self.simulation(variant, start, source))
            .collect();
        // Motions with initial conditions, their events, and their indices.
        let (mut prepared, mut awaited, mut which) = (Vec::new(), Vec::new(), Vec::new());
        for (place, (simulation, inputs)) in simulations.iter().zip(&inputs).enumerate() {
            match Prepared::new(simulation, inputs) {
                Ok(mut start) => {
                    let values = &mut rows[place].values;
                    let events = Awaited::new(task, &gauges[place], start.start(), values);
                    if events.is_over {
                        start.end_at_start();
                    }
                    prepared.push(start);
                    awaited.push(events);
                    which.push(place);
                }
                Err(error) => rows[place].fail(told(&error, variant)),
            }
        }
        let mut values: Vec<Option<&mut [f64]>> = rows
            .iter_mut()
            .map(|row| Some(row.values.as_mut_slice()))
            .collect();
        let viewers = prepared.iter().zip(awaited.iter().zip(&which)).filter_map(
            |(prepared, (awaited, &place))| {
                let gauge = &gauges[place];
                let (t, x) = (prepared.span()[0], prepared.start());
                let row = values[place].take()?;
                Some(Viewer {
                    events: awaited.events(task, gauge),
                    observer: Keeper::new(gauge, &task.keep, &task.layout, row, t, x, go_on),
                })
            },
        );
        let viewers = viewers.collect();
        let sources: Vec<&Noisy<'_>> = which.iter().map(|&place| &sources[place]).collect();
        let ended = self.observe(solvers, &variant.closed, &sources, &prepared, viewers);
        let mut ends = Vec::new();
        for (ended, (awaited, place)) in ended.into_iter().zip(awaited.iter().zip(which)) {
            let end = ended.map(|(observed, keeper)| {
                let values = keeper.finish(&task.layout, observed.t);
                awaited.happened(&observed, values);
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
            rows[place].end_at(end, reason);
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
