//! The variables of nonparametric laws.
//!
//! Harmonics are functions of a variable. They may be multiplied by the time, for varying friction; by an
//! input, for a gain that varies with time or position, or friction that grows with the load; and by a rate or its
//! sign, for friction that varies with position, or a clock that drifts.

use std::f64::consts::{PI, TAU};

use appell_estimate::{Along, Measured, Recording};
use appell_runtime::model::{At, Model};
use appell_spec::units;

use super::super::Bench;
use super::super::unmodelled::UnmodelledChannel;

/// Number of harmonics of a variable.
pub(super) const WAVES: usize = 24;
/// Number of harmonics of a position for forces: teeth and poles have short periods.
const FINE: usize = 64;
/// Number of harmonics of the time: drifts are slow.
const SLOW: usize = 4;
/// Number of harmonics of a rate that are multiplied by a load or the time: such laws are smooth.
const MULTIPLIED: usize = 8;
/// Range of a rate relative to the typical rate.
const REACH: f64 = 2.5;
/// Width over which the sign of a rate is smoothed, relative to its range.
const SMALL: f64 = 0.02;

/// The variable of the harmonics.
#[derive(Clone, Copy)]
enum Source<'b> {
    /// A state, then an input.
    Own(usize),
    /// The change of an input since the previous row.
    Change(usize),
    /// The time.
    Time,
    /// A channel outside the model.
    Unmodelled(&'b UnmodelledChannel),
}

/// The factor of the harmonics.
#[derive(Clone, Copy, PartialEq)]
enum Factor {
    /// Nothing.
    One,
    /// The time.
    Time,
    /// An input.
    Input(usize),
    /// The magnitude of an input.
    Load(usize),
    /// A rate.
    Rate(usize),
    /// The sign of a rate, smoothed over a small one.
    Sign(usize, f64),
}

/// The variable and the factor of a law.
#[derive(Clone, Copy)]
pub(in super::super) struct Dependence<'b> {
    source: Source<'b>,
    factor: Factor,
    /// Angular frequency of the first harmonic per unit.
    first: f64,
    /// Whether it is a position.
    is_position: bool,
    /// Lowest and highest value.
    pub(in super::super) range: (f64, f64),
}

/// A dependence in the language of a spec.
pub(in super::super) struct Written {
    /// The variable as a pure number.
    pub(in super::super) variable: String,
    /// The factor of the harmonics; `None` if that is one.
    pub(in super::super) factor: Option<String>,
    /// Its unit.
    pub(in super::super) factor_unit: Option<String>,
}

impl<'b> Dependence<'b> {
    /// A law of a channel outside the model.
    pub(super) fn unmodelled(channel: &'b UnmodelledChannel) -> Self {
        Self::over(Source::Unmodelled(channel), channel.range)
    }

    fn over(source: Source<'b>, range: (f64, f64)) -> Self {
        Self {
            source,
            factor: Factor::One,
            first: PI / (range.1 - range.0),
            is_position: false,
            range,
        }
    }

    /// Positions and rates, over full turns for an angle with several; inputs; rates with the
    /// time and with the load; the time, alone and with inputs; channels outside the model.
    pub(in super::super) fn all(bench: &'b Bench<'_>) -> Vec<Self> {
        let info = bench.effects.info();
        let (states, inputs) = (info.state_len(), bench.recordings[0].input_len());
        let moving: Vec<usize> = (0..inputs)
            .filter(|input| bench.range(states + input).is_some())
            .collect();
        // Among many joints products with inputs are too many; the command of a servo is no force.
        let factors_of_inputs: &[usize] = if bench.is_of_robot { &[] } else { &moving };
        let mut all = Vec::new();
        for index in 0..states + inputs {
            let Some(range) = bench.range(index) else {
                continue;
            };
            let one = Self::own(bench, index, range);
            all.push(one);
            if index < info.speeds {
                let factors = factors_of_inputs.iter().map(|&input| Factor::Load(input));
                let factors = std::iter::once(Factor::Time).chain(factors);
                all.extend(factors.map(|factor| Self { factor, ..one }));
            } else if index < states {
                let rate = (index - info.speeds < info.speeds).then(|| index - info.speeds);
                let rate = rate.and_then(|rate| Some((rate, bench.range(rate)?)));
                let factors = rate.into_iter().flat_map(|(rate, (low, high))| {
                    let small = SMALL * (high - low);
                    [Factor::Rate(rate), Factor::Sign(rate, small)]
                });
                let factors =
                    factors.chain(factors_of_inputs.iter().map(|&input| Factor::Input(input)));
                all.extend(factors.map(|factor| Self { factor, ..one }));
            }
        }
        all.extend(moving.iter().filter_map(|&input| {
            let size = change(&bench.recordings, input)?;
            let range = (-REACH * size, REACH * size);
            Some(Self::over(Source::Change(input), range))
        }));
        let time = Self::over(Source::Time, times(bench));
        let walking = |factor| Self { factor, ..time };
        all.extend(moving.iter().map(|&input| walking(Factor::Input(input))));
        all.extend((0..info.speeds).map(|rate| walking(Factor::Rate(rate))));
        // In a single run a drift is process noise; in runs with the same motion it cannot be separated from a
        // function of the state.
        if bench.recordings.len() > 1 && !are_alike(&bench.recordings) {
            all.push(walking(Factor::One));
        }
        all.extend(bench.unmodelled.iter().map(Self::unmodelled));
        all
    }

    fn own(bench: &Bench<'_>, index: usize, range: (f64, f64)) -> Self {
        let info = bench.effects.info();
        let is_angle = (info.states.get(index))
            .is_some_and(|state| units::parse(&state.unit).is_ok_and(|unit| unit.is_angle()));
        let mut own = Self::over(Source::Own(index), range);
        if is_angle && range.1 - range.0 > TAU {
            own.first = 1.0;
        }
        own.is_position = (info.speeds..info.state_len()).contains(&index);
        own
    }

    /// The variable at a state and time; NaN if it was not recorded.
    pub(in super::super) fn variable(
        self,
        bench: &Bench<'_>,
        model: &dyn Model,
        run: usize,
        at: At<'_>,
    ) -> f64 {
        let states = bench.effects.info().state_len();
        match self.source {
            Source::Own(index) if index < states => at.x[bench.place(index, model)],
            Source::Own(index) => at.u[index - states],
            Source::Change(input) => {
                let recording = &bench.recordings[run];
                let row = recording.times().partition_point(|&own| own <= at.t);
                let value = |row: usize| recording.inputs(row)[input];
                row.checked_sub(2)
                    .map_or(0.0, |before| at.u[input] - value(before))
            }
            Source::Time => at.t,
            Source::Unmodelled(channel) => channel.at(run, at.t),
        }
    }

    /// The factor of the harmonics at a state and time.
    pub(in super::super) fn factor(self, bench: &Bench<'_>, model: &dyn Model, at: At<'_>) -> f64 {
        match self.factor {
            Factor::One => 1.0,
            Factor::Time => at.t,
            Factor::Input(input) => at.u[input],
            Factor::Load(input) => at.u[input].abs(),
            Factor::Rate(rate) => at.x[bench.place(rate, model)],
            Factor::Sign(rate, small) => {
                let rate = at.x[bench.place(rate, model)];
                rate / rate.hypot(small)
            }
        }
    }

    /// The harmonics at a state and time, as pairs of sine and cosine.
    pub(super) fn waves_at(
        self,
        bench: &Bench<'_>,
        model: &dyn Model,
        run: usize,
        at: At<'_>,
        to: &mut [f64],
    ) {
        let x = self.variable(bench, model, run, at);
        if x.is_nan() {
            return to.fill(0.0);
        }
        // Each by the angle added to the one before.
        let (sin, cos) = (self.first * x).sin_cos();
        let mut before = [0.0, self.factor(bench, model, at)];
        for pair in to.chunks_exact_mut(2) {
            let [s, c] = before;
            before = [s * cos + c * sin, c * cos - s * sin];
            pair.copy_from_slice(&before);
        }
    }

    /// Angular frequency of a harmonic per unit.
    pub(in super::super) fn rate(self, wave: usize) -> f64 {
        (wave + 1) as f64 * self.first
    }

    /// Number of harmonics of a law.
    pub(super) fn waves(self, along: Along) -> usize {
        match (self.source, self.factor, along) {
            (Source::Time, ..) => SLOW,
            (_, Factor::Load(_) | Factor::Time | Factor::Rate(_) | Factor::Sign(..), _) => {
                MULTIPLIED
            }
            (_, _, Along::Disturbances) if self.is_position => FINE,
            _ => WAVES,
        }
    }

    /// Whether errors of channels may depend on it: on a variable alone, or on a drifting clock.
    pub(super) fn is_of_channels(self) -> bool {
        match (self.source, self.factor) {
            (Source::Time, Factor::Rate(_)) => true,
            (Source::Time | Source::Change(_), _) => false,
            (_, factor) => factor == Factor::One,
        }
    }

    /// Whether forces may depend on it.
    pub(super) fn is_of_forces(self) -> bool {
        !matches!((self.source, self.factor), (Source::Time, Factor::Rate(_)))
    }

    /// The variable in formulas, its unit, and how many SI units that has.
    pub(in super::super) fn letters(self, bench: &Bench<'_>) -> (String, String, f64) {
        match self.source {
            Source::Own(index) => quantity(bench, index),
            Source::Change(input) => {
                let states = bench.effects.info().state_len();
                let (name, unit, scale) = quantity(bench, states + input);
                (format!("the change of {name}"), unit, scale)
            }
            Source::Time => ("t".to_owned(), "s".to_owned(), 1.0),
            Source::Unmodelled(channel) => (channel.name.clone(), String::new(), 1.0),
        }
    }

    /// Name and unit of the quantity in the factor; `None` without one.
    fn of_factor(self, bench: &Bench<'_>) -> Option<(String, String)> {
        let states = bench.effects.info().state_len();
        let (name, unit, _) = match self.factor {
            Factor::One => return None,
            Factor::Time => return Some(("t".to_owned(), "s".to_owned())),
            Factor::Input(input) | Factor::Load(input) => quantity(bench, states + input),
            Factor::Rate(rate) | Factor::Sign(rate, _) => quantity(bench, rate),
        };
        Some((name, unit))
    }

    /// In words.
    pub(in super::super) fn name(self, bench: &Bench<'_>) -> String {
        let source = match self.source {
            Source::Time => "time".to_owned(),
            _ => self.letters(bench).0,
        };
        let (other, _) = self.of_factor(bench).unwrap_or_default();
        match self.factor {
            Factor::One => source,
            Factor::Time => format!("{source} and time"),
            Factor::Input(_) => format!("{other} and {source}"),
            Factor::Load(_) => format!("{source} and |{other}|"),
            Factor::Rate(_) => format!("{source} and {other}"),
            Factor::Sign(..) => format!("{source} and the sign of {other}"),
        }
    }

    /// In the language of a spec; `None` for channels outside the model.
    pub(in super::super) fn written(self, bench: &Bench<'_>) -> Option<Written> {
        if matches!(self.source, Source::Change(_) | Source::Unmodelled(_)) {
            return None;
        }
        let (name, unit, _) = self.letters(bench);
        let variable = pure(&name, &si(&unit));
        let factor = self.of_factor(bench).map(|(name, unit)| {
            let unit = si(&unit);
            match self.factor {
                Factor::Load(_) => (format!("abs({name})"), unit),
                Factor::Sign(_, small) => {
                    let rate = pure(&name, &unit);
                    let sign = format!("{rate}/sqrt(({rate})^2 + {:e})", small * small);
                    (sign, "1".to_owned())
                }
                _ => (name, unit),
            }
        });
        let (factor, factor_unit) = factor.unzip();
        Some(Written {
            variable,
            factor,
            factor_unit,
        })
    }
}

/// The root mean square of the change of an input from row to row; `None` if it is constant.
fn change(recordings: &[Recording], input: usize) -> Option<f64> {
    let changes = recordings.iter().flat_map(|run| {
        let rows = 1..run.times().len();
        rows.map(move |row| run.inputs(row)[input] - run.inputs(row - 1)[input])
    });
    let (count, squares) = changes.fold((0.0_f64, 0.0), |(count, squares), one| {
        (count + 1.0, squares + one * one)
    });
    let size = (squares / count.max(1.0)).sqrt();
    (size > 0.0).then_some(size)
}

/// A quantity as a pure number.
fn pure(name: &str, si: &str) -> String {
    if si == "1" {
        name.to_owned()
    } else {
        format!("{name}/(1 [{si}])")
    }
}

/// The SI unit of the dimension of a unit.
fn si(unit: &str) -> String {
    let dimension = units::parse(unit).map(|unit| unit.dimension);
    dimension.map_or_else(|_| "1".to_owned(), |own| units::Unit::si(own).text)
}

/// Name, unit and SI units of a state, then an input.
fn quantity(bench: &Bench<'_>, index: usize) -> (String, String, f64) {
    let info = bench.effects.info();
    let mut quantities = info.states.iter().chain(info.inputs.iter());
    quantities.nth(index).map_or_else(
        || (String::new(), "1".to_owned(), 1.0),
        |own| (own.name.to_string(), own.unit.to_string(), own.scale),
    )
}

/// Whether the runs show the same motion at the same times.
fn are_alike(runs: &[Recording]) -> bool {
    /// Mean square difference between two runs, relative to the variance of the channel, below which they are alike.
    const OWN: f64 = 0.2;
    let Some((first, others)) = runs.split_first() else {
        return false;
    };
    let channels = first.measured(0).len();
    let is_alike = |other: &Recording, channel: usize| {
        let rows = 0..first.times().len().min(other.times().len());
        let pairs = rows.map(|row| [first, other].map(|run| run.measured(row)[channel]));
        let pairs: Vec<[f64; 2]> = pairs
            .filter(|pair| pair.iter().all(|v| !v.is_nan()))
            .collect();
        let count = pairs.len().max(1) as f64;
        let mean = pairs.iter().map(|[value, _]| value).sum::<f64>() / count;
        let spread: f64 = pairs.iter().map(|[value, _]| (value - mean).powi(2)).sum();
        let apart: f64 = pairs.iter().map(|[a, b]| (a - b).powi(2)).sum();
        apart < OWN * spread
    };
    others
        .iter()
        .any(|other| (0..channels).all(|channel| is_alike(other, channel)))
}

/// First and last time of all runs.
fn times(bench: &Bench<'_>) -> (f64, f64) {
    let runs = bench.recordings.iter().map(Recording::times);
    runs.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), times| {
        (low.min(times[0]), high.max(times[times.len() - 1]))
    })
}

impl Bench<'_> {
    /// Range of a state or input along the recordings: as recorded, or from typical rates of measured
    /// coordinates.
    pub(in super::super) fn range(&self, index: usize) -> Option<(f64, f64)> {
        let states = self.effects.info().state_len();
        let shown = |shown: &Measured| *shown == Measured::State(index);
        let channel = self.measured.iter().position(shown);
        let recorded = |run: &Recording, row: usize| match channel {
            Some(channel) => run.measured(row)[channel],
            None => run.inputs(row)[index - states],
        };
        if channel.is_none() && index < states {
            let size = self.sizes.get(index).copied()?;
            return (size > 0.0).then_some((-REACH * size, REACH * size));
        }
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for run in &self.recordings {
            for row in 0..run.times().len() {
                let value = recorded(run, row);
                // Missing values change neither.
                (low, high) = (low.min(value), high.max(value));
            }
        }
        (high > low).then_some((low, high))
    }
}
