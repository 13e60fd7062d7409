//! What nobody has named: a force in an equation or an error of a channel, as a law of a position, a
//! rate, an input, or a channel that was recorded beside them. A law is a sum of waves of the variable
//! whose sizes fall off as those of a law with a step do, or one wave alone. About the best hypothesis
//! they tell what it leaves and on what that depends.
//!
//! A law is linear in the sizes of its waves, so what it gains, and how probable it makes the recordings
//! when its sizes are normal, has a closed form (C. E. Rasmussen and C. K. I. Williams, *Gaussian
//! Processes for Machine Learning*, 2006, chapter 2). Waves of time alone are left out: what does not
//! return with the state is a disturbance, and there are levels for these. A law has to predict runs
//! that it was not found in.

use std::f64::consts::{PI, TAU};

use appell_estimate::{Along, Disturbance, Estimation, Innovation, Measured, Recording, Shapes};
use appell_runtime::model::{At, Model};
use appell_spec::units;
use nalgebra::{DMatrix, DVector};

use super::DiagnoseError;
use super::bench::Bench;
use super::compare::TIED;
use super::evidence::{NormalSizes, log_sum, occam};
use super::hypothesis::Fitted;
use super::screen::{Projected, moving};
use super::unmodelled::UnmodelledChannel;

/// Waves of a variable.
const WAVES: usize = 24;
/// Waves of a position along which a force acts: teeth and poles are many along a path.
const FINE: usize = 64;
/// Range of a rate in typical rates.
const REACH: f64 = 2.5;
/// Part of its gain that a law has to repeat on runs that it was not found in.
const REPEATED: f64 = 0.5;

/// What a law that nobody has named would gain beside a hypothesis.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Unnamed {
    /// What it adds to.
    pub(super) along: Along,
    /// Index of the pseudo-velocity whose equation has it, or of the channel.
    pub(super) place: usize,
    /// Name of the variable.
    pub(super) variable: String,
    /// Gain in log-likelihood.
    pub(super) gain: f64,
    /// Gain on runs that it was not found in.
    pub(super) cross_validated: f64,
    /// Logarithm of the Bayes factor for it.
    pub(super) log_bayes_factor: f64,
}

/// All of them together.
#[derive(Debug, Clone)]
pub(super) struct Leftover {
    /// The one that the recordings speak for most.
    pub(super) first: Unnamed,
    /// Logarithm of the Bayes factor for any of them, all alike beforehand.
    pub(super) log_bayes_factor: f64,
}

/// Where the values of a variable are from.
#[derive(Clone, Copy)]
enum Source<'b> {
    /// States, then inputs.
    Own(usize),
    /// A channel that the model does not know.
    Unmodelled(&'b UnmodelledChannel),
}

/// What the laws of a variable depend on.
#[derive(Clone, Copy)]
struct Variable<'b> {
    source: Source<'b>,
    /// Angle of the first wave per unit.
    first: f64,
    /// Whether it is a position.
    is_position: bool,
    /// The waves also grow with time: a friction that changes.
    drifts: bool,
}

impl Variable<'_> {
    fn of(self, (bench, model): (&Bench<'_>, &dyn Model), run: usize, at: At<'_>) -> f64 {
        let states = bench.effects.info().state_len();
        match self.source {
            Source::Own(index) if index < states => at.x[bench.place(index, model)],
            Source::Own(index) => at.u[index - states],
            Source::Unmodelled(channel) => channel.at(run, at.t),
        }
    }

    fn name(self, bench: &Bench<'_>) -> String {
        let info = bench.effects.info();
        let mut quantities = info.states.iter().chain(info.inputs.iter());
        let name = match self.source {
            Source::Own(index) => quantities.nth(index).map_or("", |own| own.name.as_ref()),
            Source::Unmodelled(channel) => &channel.name,
        };
        if self.drifts {
            format!("{name} and time")
        } else {
            name.to_owned()
        }
    }

    /// How many waves a law of it has.
    fn waves(self, along: Along) -> usize {
        match along {
            Along::Disturbances if self.is_position => FINE,
            _ => WAVES,
        }
    }

    /// A law of this variable at a place.
    fn unnamed(self, bench: &Bench<'_>, (along, place): (Along, usize), law: LawGain) -> Unnamed {
        Unnamed {
            along,
            place,
            variable: self.name(bench),
            gain: law.gain,
            cross_validated: law.cross_validated,
            log_bayes_factor: law.log_bayes_factor,
        }
    }
}

/// What a hypothesis leaves that a law without a name explains; nothing where no law generalises
/// other runs.
pub(super) fn leftover(
    bench: &Bench<'_>,
    fitted: &Fitted,
) -> Result<Option<Leftover>, DiagnoseError> {
    let setup = bench.setup(&fitted.members);
    let estimation = Estimation::new(&setup, &bench.recordings)?;
    let (mut smooth, mut single) = (Family::default(), Family::default());
    for variable in variables(bench) {
        for along in [Along::Disturbances, Along::Channels] {
            if along == Along::Channels && variable.drifts {
                continue;
            }
            for (place, wave_scores) in wave_scores(bench, &estimation, fitted, variable, along)? {
                let unnamed = |law| variable.unnamed(bench, (along, place), law);
                smooth.add(wave_scores.smooth().map(unnamed));
                for wave in 0..variable.waves(along) {
                    single.add(wave_scores.single(wave).map(unnamed));
                }
            }
        }
    }
    Ok(joined(smooth, single))
}

/// What the waves of a variable tell of the force in each equation, or of the error of each channel.
fn wave_scores(
    bench: &Bench<'_>,
    estimation: &Estimation<'_>,
    fitted: &Fitted,
    variable: Variable<'_>,
    along: Along,
) -> Result<Vec<(usize, WaveScores)>, DiagnoseError> {
    let (free, setup) = (moving(fitted), estimation.setup());
    let waves = 2 * variable.waves(along);
    let write = |run: usize, at: At<'_>, values: &mut [f64]| {
        let x = variable.of((bench, setup.model), run, at);
        if x.is_nan() {
            return values.fill(0.0);
        }
        let grown = if variable.drifts { at.t } else { 1.0 };
        for (wave, pair) in values.chunks_exact_mut(2).enumerate() {
            let (sin, cos) = ((wave + 1) as f64 * variable.first * x).sin_cos();
            pair.copy_from_slice(&[grown * sin, grown * cos]);
        }
    };
    let shapes = Shapes {
        along,
        count: waves,
        values: &write,
    };
    let tangent = estimation.tangent(&fitted.fit.values, &free, Some(shapes))?;
    let projected = Projected::new((&tangent, bench.weight), fitted, free.len(), 0..0);
    let places: Vec<Option<usize>> = match along {
        Along::Disturbances => (setup.disturbances.iter())
            .map(|one| match *one {
                Disturbance::Force(equation) => Some(equation),
                Disturbance::Rate(_) => None,
            })
            .collect(),
        Along::Channels => (0..setup.channels.len()).map(Some).collect(),
    };
    let places = places.into_iter().enumerate();
    Ok(places
        .filter_map(|(block, place)| {
            let first = free.len() + block * waves;
            let columns: Vec<usize> = (first..first + waves).collect();
            Some((
                place?,
                WaveScores::new(&projected, &projected.slopes(&columns)),
            ))
        })
        .collect())
}

/// Laws of one kind.
#[derive(Default)]
struct Family {
    tried: usize,
    found: Vec<Unnamed>,
}

impl Family {
    fn add(&mut self, unnamed: Option<Unnamed>) {
        self.tried += 1;
        let generalises = |one: &Unnamed| one.cross_validated > REPEATED * one.gain;
        self.found.extend(unnamed.filter(generalises));
    }
}

/// Both kinds are as probable beforehand, and so are the laws of a kind.
fn joined(smooth: Family, single: Family) -> Option<Leftover> {
    let weight = |family: &Family| -((2 * family.tried.max(1)) as f64).ln();
    let weights = [weight(&smooth), weight(&single)];
    let mut all: Vec<(f64, Unnamed)> = Vec::new();
    for (family, weight) in [smooth, single].into_iter().zip(weights) {
        let found = family.found.into_iter();
        all.extend(found.map(|one| (one.log_bayes_factor + weight, one)));
    }
    let log = log_sum(all.iter().map(|(log, _)| *log));
    let first = all.into_iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(Leftover {
        first: first.1,
        log_bayes_factor: log,
    })
}

/// Channels that the model does not know and on which the gap of a hypothesis depends, each with the
/// place where it shows most: one false one in twenty.
pub(super) fn hints(bench: &Bench<'_>, fitted: &Fitted) -> Result<Vec<Unnamed>, DiagnoseError> {
    let setup = bench.setup(&fitted.members);
    let estimation = Estimation::new(&setup, &bench.recordings)?;
    let along = Along::Disturbances;
    let mut found = Vec::new();
    let mut tried = 0;
    for variable in bench.unmodelled.iter().map(Variable::unmodelled) {
        let mut family = Family::default();
        for (place, wave_scores) in wave_scores(bench, &estimation, fitted, variable, along)? {
            let smooth = wave_scores.smooth();
            family.add(smooth.map(|law| variable.unnamed(bench, (along, place), law)));
        }
        tried += family.tried;
        let log = |one: &Unnamed| one.log_bayes_factor;
        let all = family.found.into_iter();
        found.extend(all.max_by(|a, b| log(a).total_cmp(&log(b))));
    }
    let least = TIED + (tried.max(1) as f64).ln();
    found.retain(|one| one.log_bayes_factor > least);
    found.sort_by(|a, b| b.log_bayes_factor.total_cmp(&a.log_bayes_factor));
    Ok(found)
}

impl<'b> Variable<'b> {
    fn unmodelled(channel: &'b UnmodelledChannel) -> Self {
        Self {
            source: Source::Unmodelled(channel),
            first: PI / (channel.range.1 - channel.range.0),
            is_position: false,
            drifts: false,
        }
    }
}

/// Positions and rates that return, over whole turns where an angle makes several; inputs; channels
/// that the model does not know.
fn variables<'b>(bench: &'b Bench<'_>) -> Vec<Variable<'b>> {
    let info = bench.effects.info();
    let mut variables = Vec::new();
    for index in 0..info.state_len() + bench.recordings[0].input_len() {
        let Some((low, high)) = bench.range(index) else {
            continue;
        };
        let range = high - low;
        let is_angle = (info.states.get(index))
            .is_some_and(|state| units::parse(&state.unit).is_ok_and(|unit| unit.is_angle()));
        let first = if is_angle && range > TAU {
            1.0
        } else {
            PI / range
        };
        let one = Variable {
            source: Source::Own(index),
            first,
            is_position: (info.speeds..info.state_len()).contains(&index),
            drifts: false,
        };
        variables.push(one);
        if index < info.speeds {
            variables.push(Variable {
                drifts: true,
                ..one
            });
        }
    }
    variables.extend(bench.unmodelled.iter().map(Variable::unmodelled));
    variables
}

impl Bench<'_> {
    /// Range of a state or input along the recordings: as recorded, or typical rates of what is
    /// measured.
    pub(super) fn range(&self, index: usize) -> Option<(f64, f64)> {
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
                // What is missing changes neither.
                (low, high) = (low.min(value), high.max(value));
            }
        }
        (high > low).then_some((low, high))
    }
}

/// What a law would gain, on all runs and on runs that it was not found in.
#[derive(Clone, Copy)]
struct LawGain {
    gain: f64,
    cross_validated: f64,
    log_bayes_factor: f64,
}

/// What the waves of a variable tell, run by run: the squares of their slopes and their scores.
struct WaveScores {
    runs: Vec<(DMatrix<f64>, DVector<f64>)>,
    squares: DMatrix<f64>,
    scores: DVector<f64>,
}

impl WaveScores {
    fn new(projected: &Projected<'_>, slopes: &DMatrix<f64>) -> Self {
        let samples = &projected.tangent.samples;
        // By rows the products below run along the memory.
        let turned = slopes.transpose();
        let wave_scores = |from: usize, rows: usize| {
            let turned = turned.columns(from, rows);
            let squares = turned * slopes.rows(from, rows);
            (squares, -(turned * projected.rest.rows(from, rows)))
        };
        let mut runs = Vec::new();
        let mut from = 0;
        while let Some((run, _)) = samples.get(from) {
            let of_run = |sample: &&(usize, Innovation)| sample.0 == *run;
            let rows = samples[from..].iter().take_while(of_run).count();
            runs.push(wave_scores(from, rows));
            from += rows;
        }
        // The rows for what is known of the parameters beforehand belong to no run.
        let (mut squares, mut scores) = wave_scores(from, slopes.nrows() - from);
        for (own, score) in &runs {
            squares += own;
            scores += score;
        }
        Self {
            runs,
            squares,
            scores,
        }
    }

    /// A law whose waves fall off as one over their number, averaged over its size.
    fn smooth(&self) -> Option<LawGain> {
        let count = self.scores.len().min(2 * WAVES);
        let fall = DVector::from_fn(count, |i, _| ((i / 2 + 1) as f64).recip());
        let scaled = self.scaled(&fall);
        let sizes = NormalSizes::of(&scaled.squares, &scaled.scores)?;
        let (gain, cross_validated) = scaled.gains(sizes.variance.recip())?;
        Some(LawGain {
            gain,
            cross_validated,
            log_bayes_factor: sizes.log_bayes_factor,
        })
    }

    /// One wave of two sizes.
    fn single(&self, wave: usize) -> Option<LawGain> {
        /// A little of the larger square keeps a wave that is hardly there in place.
        const FLOOR: f64 = 1e-9;
        let pair = Self::part(&self.squares, &self.scores, 2 * wave);
        let runs = self.runs.iter();
        let own = Self {
            runs: runs
                .map(|(squares, scores)| Self::part(squares, scores, 2 * wave))
                .collect(),
            squares: pair.0,
            scores: pair.1,
        };
        let size = own.squares.diagonal().max();
        if size.is_nan() || size <= 0.0 {
            return None;
        }
        let (gain, cross_validated) = own.gains(FLOOR * size)?;
        Some(LawGain {
            gain,
            cross_validated,
            log_bayes_factor: gain - 2.0 * occam(gain),
        })
    }

    fn part(
        squares: &DMatrix<f64>,
        scores: &DVector<f64>,
        from: usize,
    ) -> (DMatrix<f64>, DVector<f64>) {
        let squares = squares.view((from, from), (2, 2)).into_owned();
        (squares, scores.rows(from, 2).into_owned())
    }

    fn scaled(&self, by: &DVector<f64>) -> Self {
        let scale = |squares: &DMatrix<f64>, scores: &DVector<f64>| {
            let squares =
                DMatrix::from_fn(by.len(), by.len(), |i, j| by[i] * squares[(i, j)] * by[j]);
            (squares, by.component_mul(&scores.rows(0, by.len())))
        };
        let (squares, scores) = scale(&self.squares, &self.scores);
        Self {
            runs: self
                .runs
                .iter()
                .map(|(squares, scores)| scale(squares, scores))
                .collect(),
            squares,
            scores,
        }
    }

    /// What the most probable sizes gain, and what those found in the other runs gain in each; `held`
    /// is the inverse of their variance.
    fn gains(&self, held: f64) -> Option<(f64, f64)> {
        let sizes = solved(&self.squares, &self.scores, held)?;
        let gain = gained(&sizes, &self.squares, &self.scores);
        if self.runs.len() < 2 {
            return Some((gain, gain));
        }
        let mut cross_validated = 0.0;
        for (squares, scores) in &self.runs {
            let sizes = solved(&(&self.squares - squares), &(&self.scores - scores), held)?;
            cross_validated += gained(&sizes, squares, scores);
        }
        Some((gain, cross_validated))
    }
}

fn gained(sizes: &DVector<f64>, squares: &DMatrix<f64>, scores: &DVector<f64>) -> f64 {
    sizes.dot(scores) - 0.5 * sizes.dot(&(squares * sizes))
}

fn solved(squares: &DMatrix<f64>, scores: &DVector<f64>, held: f64) -> Option<DVector<f64>> {
    let mut squares = squares.clone();
    for i in 0..squares.nrows() {
        squares[(i, i)] += held;
    }
    Some(squares.cholesky()?.solve(scores))
}
