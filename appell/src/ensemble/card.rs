//! Runs the cases of a study on a graphics card, a thread each.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use appell_card::{Argument, Card, CardError, Kernel};
use appell_ensemble::rows::Rows;
use appell_ensemble::run::Watch;
use appell_runtime::inputs::ModelInputs;
use appell_runtime::integrate::{Cause, SharedTimes, Timetable};
use appell_runtime::simulate::Prepared;

use super::cases::{Cases, Ride, Row, cause_of, told};
use super::kernel::{self, Kinds};
use super::noise::Draws;
use super::variant::Variant;
use crate::Error;
use crate::card::refused;

/// Cases of a call: enough for all threads of a large card.
pub(super) const TOGETHER: u64 = 1 << 18;
/// Limit on the numbers of a call.
const NUMBERS: usize = 1 << 27;
/// Cases of a call that is not divided if it does not fit into the memory of the card.
const FEW: usize = 64;
/// Cases of a call on a card that ends long kernels.
const BRIEF: u64 = 4096;

/// The kernels of a study, one for each spec and law.
pub(super) struct OnCard {
    kernels: Vec<Kernel>,
    /// Times at which quantities are recorded, each with the index of the quantity and its column.
    moment_times: Vec<f64>,
    moment_places: Vec<i32>,
    /// Cases of a call.
    together: u64,
    /// Held during a call: its arrays are the only ones on the card.
    calling: Mutex<()>,
    /// Why a call failed.
    failure: Mutex<Option<CardError>>,
}

/// The arrays of several motions of a variant.
#[derive(Default)]
struct Motions {
    parameters: Vec<Vec<f64>>,
    starts: Vec<Vec<f64>>,
    noise: Vec<f64>,
    changes: Vec<f64>,
    paces: Vec<f64>,
    /// First and count of the changes of each motion, then of its paces.
    places: Vec<i32>,
    last: Option<(Timetable, [i32; 4])>,
}

/// What a kernel computes.
struct Ended {
    rows: Vec<f64>,
    ends: Vec<f64>,
    endings: Vec<i32>,
}

/// An index of an array, whose lengths [`NUMBERS`] bounds.
fn place(index: usize) -> i32 {
    i32::try_from(index).unwrap_or(i32::MAX)
}

impl OnCard {
    /// Compiles the motions of a study for the first card of this machine.
    pub(super) fn new(study: &Cases) -> Result<Self, Error> {
        let variants = study.variants.iter();
        let sources = variants.map(|variant| kernel::source(study, variant));
        let sources = sources.collect::<Result<Vec<_>, _>>()?;
        let card = Card::first().map_err(refused)?;
        let mut kernels = Vec::new();
        for source in &sources {
            kernels.extend(card.compile(source, &[kernel::NAME]).map_err(refused)?);
        }
        let task = &study.task;
        let factors = study.factors();
        let recorded = Kinds::of(task).recorded;
        let places = task.layout.moments.iter().flat_map(|moment| {
            let which = recorded.iter().position(|&keep| keep == moment.keep);
            [which.unwrap_or(0), moment.column - factors].map(place)
        });
        Ok(Self {
            kernels,
            moment_times: task.layout.moments.iter().map(|moment| moment.t).collect(),
            moment_places: places.collect(),
            together: if card.has_time_limit().map_err(refused)? {
                BRIEF
            } else {
                TOGETHER
            },
            calling: Mutex::default(),
            failure: Mutex::default(),
        })
    }

    /// Why a call failed, if one did.
    pub(super) fn failure(&self) -> Option<CardError> {
        let failure = self.failure.lock();
        failure.unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Forgets an earlier failure.
    pub(super) fn start(&self) {
        *self.failure.lock().unwrap_or_else(PoisonError::into_inner) = None;
    }

    /// Appends the rows of consecutive cases, in their order; none after a failure.
    pub(super) fn run(&self, study: &Cases, cases: Range<u64>, watch: &Watch<'_>, rows: &mut Rows) {
        let together = self
            .together
            .min((NUMBERS / numbers_of_a_motion(study)).max(1) as u64);
        let mut next = cases.start;
        while next < cases.end && (watch.go_on)() && self.failure().is_none() {
            let some = next..cases.end.min(next + together);
            let draws: Vec<Draws<'_>> = some.clone().map(Draws::Case).collect();
            let mut all = Row::empty(&study.task, draws.len());
            let rides = study.drawn(&draws, &mut all);
            for ((kernel, variant), mut rides) in
                self.kernels.iter().zip(&study.variants).zip(rides)
            {
                if let Err(error) = self.ride(study, kernel, variant, &mut rides) {
                    let mut failure = self.failure.lock().unwrap_or_else(PoisonError::into_inner);
                    *failure = Some(error);
                    return;
                }
            }
            study.push(all, rows);
            (watch.done)(some.end - some.start);
            next = some.end;
        }
    }

    /// Runs motions under one spec and law; in halves if they do not fit into the memory of the card.
    fn ride(
        &self,
        study: &Cases,
        kernel: &Kernel,
        variant: &Variant,
        rides: &mut [Ride<'_>],
    ) -> Result<(), CardError> {
        match self.in_parts(study, kernel, variant, rides) {
            Err(CardError::Memory) if rides.len() > FEW => {
                let (first, second) = rides.split_at_mut(rides.len() / 2);
                self.ride(study, kernel, variant, first)?;
                self.ride(study, kernel, variant, second)
            }
            ended => ended,
        }
    }

    /// Runs motions in parts whose lists of times are bounded.
    fn in_parts(
        &self,
        study: &Cases,
        kernel: &Kernel,
        variant: &Variant,
        rides: &mut [Ride<'_>],
    ) -> Result<(), CardError> {
        let (mut motions, mut started) = (Motions::default(), Vec::new());
        let shared = SharedTimes::default();
        for index in 0..rides.len() {
            match motions.add(study, variant, &rides[index], &shared) {
                Ok(()) => started.push(index),
                Err(reason) => rides[index].row.fail(reason),
            }
            if motions.changes.len() + motions.paces.len() > NUMBERS {
                self.finish(study, kernel, variant, rides, (&motions, &started))?;
                (motions, started) = (Motions::default(), Vec::new());
            }
        }
        self.finish(study, kernel, variant, rides, (&motions, &started))
    }

    /// Calls the kernel for motions, given with the indices of their rides, and writes their rows.
    fn finish(
        &self,
        study: &Cases,
        kernel: &Kernel,
        variant: &Variant,
        rides: &mut [Ride<'_>],
        (motions, started): (&Motions, &[usize]),
    ) -> Result<(), CardError> {
        let ended = self.call(study, kernel, motions)?;
        let factors = study.factors();
        for (motion, &index) in started.iter().enumerate() {
            let row = &mut *rides[index].row;
            for (column, value) in row.values[factors..].iter_mut().enumerate() {
                *value = ended.rows[column * started.len() + motion];
            }
            let reason =
                cause(ended.endings[motion]).map(|cause| cause_of(&cause, variant.model.info()));
            row.end_at(ended.ends[motion], reason.unwrap_or_default());
        }
        Ok(())
    }

    fn call(&self, study: &Cases, kernel: &Kernel, motions: &Motions) -> Result<Ended, CardError> {
        let count = motions.starts.len();
        let columns = study.task.layout.columns.len() - study.factors();
        let mut ended = Ended {
            rows: vec![f64::NAN; columns * count],
            ends: vec![0.0; count],
            endings: vec![0; count],
        };
        let noises = motions.noise.len() / count.max(1);
        let _only = self.calling.lock().unwrap_or_else(PoisonError::into_inner);
        kernel.call(
            count,
            &mut [
                Argument::Integer(place(noises)),
                Argument::Integer(place(self.moment_times.len())),
                Argument::Numbers(&by_quantity(&motions.parameters)),
                Argument::Numbers(&by_quantity(&motions.starts)),
                Argument::Numbers(&motions.noise),
                Argument::Numbers(&motions.changes),
                Argument::Numbers(&motions.paces),
                Argument::Integers(&motions.places),
                Argument::Numbers(&self.moment_times),
                Argument::Integers(&self.moment_places),
                Argument::Into(&mut ended.rows),
                Argument::Into(&mut ended.ends),
                Argument::IntoIntegers(&mut ended.endings),
            ],
        )?;
        Ok(ended)
    }
}

impl Motions {
    /// Adds a motion, or returns why it cannot start.
    fn add(
        &mut self,
        study: &Cases,
        variant: &Variant,
        ride: &Ride<'_>,
        shared: &SharedTimes,
    ) -> Result<(), String> {
        let model = variant.model.equations();
        let source = study.source(variant, ride);
        let inputs = ModelInputs::new(model.info(), &source);
        let inputs = inputs.map_err(|error| told(&error.into(), variant))?;
        let simulation = study.simulation(variant, &ride.start, &source);
        let prepared = Prepared::new(&simulation, &inputs);
        let prepared = prepared.map_err(|error| told(&error, variant))?;
        let table = prepared.timetable(shared);
        let table = table.ok_or_else(|| Cause::Chattering.to_string())?;
        self.parameters.push(ride.start.parameters.clone());
        self.starts.push(prepared.start().to_vec());
        source.numbers(&mut self.noise);
        // Motions whose switching times are the same share a list.
        let places = match &self.last {
            Some((last, places)) if *last == table => *places,
            _ => {
                let places = [
                    self.changes.len(),
                    table.changes.len(),
                    self.paces.len() / 2,
                    table.paces.len(),
                ];
                self.changes.extend(&table.changes);
                self.paces.extend(table.paces.iter().flatten());
                places.map(place)
            }
        };
        self.places.extend(places);
        self.last = Some((table, places));
        Ok(())
    }
}

/// Numbers that a motion takes in a call.
fn numbers_of_a_motion(study: &Cases) -> usize {
    let own = study.variants.iter().map(|variant| {
        let noise = (variant.noises.iter()).map(|noise| noise.count(study.study.motion.t_end));
        variant.parameters.len() + variant.initial.len() + noise.sum::<usize>()
    });
    study.task.layout.columns.len() + own.max().unwrap_or(0) + 1
}

/// Vectors as one array with the entries of each quantity one after another.
fn by_quantity(vectors: &[Vec<f64>]) -> Vec<f64> {
    let length = vectors.first().map_or(0, Vec::len);
    let quantities = (0..length).flat_map(|k| vectors.iter().map(move |vector| vector[k]));
    quantities.collect()
}

/// Why a motion ended early.
fn cause(ending: i32) -> Option<Cause> {
    let component = usize::try_from(ending / 8).unwrap_or(0);
    match ending % 8 {
        1 => Some(Cause::NonFinite { component }),
        2 => Some(Cause::OutOfRange {
            component,
            range: [f64::NAN; 2],
        }),
        3 => Some(Cause::StepTooSmall { h: f64::NAN }),
        4 => Some(Cause::TooManySteps { steps: 0 }),
        5 => Some(Cause::Chattering),
        _ => None,
    }
}
