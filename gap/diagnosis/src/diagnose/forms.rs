//! Closed forms of a measured law: simple functions with one or two coefficients instead of a curve.

use appell_estimate::{Estimation, Shapes};
use appell_runtime::model::At;

use super::unknown::{Dependence, Unnamed, term_scores};
use super::{Bench, Fitted, Form, Result};

/// Largest number of reported forms.
const TOLD: usize = 3;
/// Smallest gain of a form relative to that of the law.
const NEAR: f64 = 0.5;
/// Number of positions of corners and steps in the range of the variable.
const PLACES: usize = 9;
/// Number of single harmonics.
const WAVES: usize = 48;
/// Number of frequencies on either side of the best harmonic, up to its neighbours.
const FINER: u32 = 12;
/// Width of a step relative to the range.
const STEP: f64 = 0.01;

/// A function of the variable.
type Function = Box<dyn Fn(f64) -> f64 + Sync>;

/// A sum of functions with coefficients, and the number of forms of its kind.
struct Trial {
    text: String,
    functions: Vec<Function>,
    alike: usize,
    /// Frequency of a harmonic in radians per SI unit of the variable.
    rate: Option<f64>,
}

/// The forms close to a law.
pub(super) fn forms(
    bench: &Bench<'_>,
    base: &Fitted,
    dependence: Dependence<'_>,
    law: &Unnamed,
) -> Result<Vec<Form>> {
    let tried = trials(bench, dependence);
    let mut forms = scored(bench, base, dependence, law, tried)?;
    // The frequencies of harmonics are a grid: the best one is refined between its neighbours.
    let best = forms.iter().find_map(|(rate, _)| *rate);
    if let Some(rate) = best {
        let step = dependence.rate(1) - dependence.rate(0);
        let finer = (0..=2 * FINER).map(|place| {
            let beside = (f64::from(place) - f64::from(FINER)) / f64::from(FINER);
            rate + beside * step
        });
        let finer = finer.filter(|rate| *rate > 0.0);
        let tried = waves(bench, dependence, finer).collect();
        let finer = scored(bench, base, dependence, law, tried)?;
        let place = forms.iter().position(|(own, _)| *own == best);
        let better = finer.into_iter().next().zip(place);
        if let Some((better, place)) = better {
            forms[place] = better;
        }
    }
    let mut forms: Vec<Form> = forms.into_iter().map(|(_, form)| form).collect();
    forms.sort_by(|a, b| b.log_bayes_factor.total_cmp(&a.log_bayes_factor));
    forms.truncate(TOLD);
    Ok(forms)
}

/// Forms close to the law, the best first; harmonics with their frequencies.
fn scored(
    bench: &Bench<'_>,
    base: &Fitted,
    dependence: Dependence<'_>,
    law: &Unnamed,
    trials: Vec<Trial>,
) -> Result<Vec<(Option<f64>, Form)>> {
    let setup = bench.setup(&base.members);
    let estimation = Estimation::new(&setup, &bench.recordings)?;
    let functions = || trials.iter().flat_map(|trial| &trial.functions);
    let write = |run: usize, at: At<'_>, values: &mut [f64]| {
        let x = dependence.variable(bench, setup.model, run, at);
        let factor = dependence.factor(bench, setup.model, at);
        for (value, function) in values.iter_mut().zip(functions()) {
            *value = if x.is_nan() {
                0.0
            } else {
                factor * function(x)
            };
        }
    };
    let shapes = Shapes {
        along: law.along,
        count: functions().count(),
        values: &write,
    };
    let scores = term_scores(bench, &estimation, base, shapes, &[shapes.count])?;
    let mut scores = scores.into_iter().flatten();
    let Some((_, scores)) = scores.find(|(place, _)| *place == law.place) else {
        return Ok(Vec::new());
    };
    let written = dependence.written(bench).and_then(|own| own.factor);
    let mut forms: Vec<(Option<f64>, Form)> = Vec::new();
    let mut first = 0;
    for trial in trials {
        let terms = first..first + trial.functions.len();
        first = terms.end;
        let Some(own) = scores.of(&terms.collect::<Vec<_>>()) else {
            continue;
        };
        let share = own.gain / law.gains.gain.max(f64::MIN_POSITIVE);
        if share > NEAR {
            let form = Form {
                text: match &written {
                    Some(factor) => format!("{factor}*{}", trial.text),
                    None => trial.text,
                },
                share,
                log_bayes_factor: own.log_bayes_factor - (trial.alike as f64).ln(),
            };
            forms.push((trial.rate, form));
        }
    }
    forms.sort_by(|(_, a), (_, b)| b.log_bayes_factor.total_cmp(&a.log_bayes_factor));
    Ok(forms)
}

/// All forms of a variable.
fn trials(bench: &Bench<'_>, dependence: Dependence<'_>) -> Vec<Trial> {
    let (name, _, scale) = dependence.letters(bench);
    let (low, high) = dependence.range;
    let range = high - low;
    let width = STEP * range;
    let mut trials: Vec<Trial> = Vec::new();
    let mut add = |text: String, alike: usize, function: Function| {
        trials.push(Trial {
            text,
            functions: vec![function],
            alike,
            rate: None,
        });
    };
    let unit = range.abs().max(f64::MIN_POSITIVE);
    add(name.clone(), 1, Box::new(move |x| x / unit));
    add(
        format!("{name}^2"),
        1,
        Box::new(move |x| (x / unit).powi(2)),
    );
    add(
        format!("{name}^3"),
        1,
        Box::new(move |x| (x / unit).powi(3)),
    );
    if low < 0.0 && high > 0.0 {
        let sign = Box::new(move |x: f64| (x / width).tanh());
        add(format!("sign({name})"), 1, sign);
        add(format!("abs({name})"), 1, Box::new(f64::abs));
        let square = Box::new(move |x: f64| x / unit * (x / unit).abs());
        add(format!("{name}*abs({name})"), 1, square);
    }
    for place in 1..=PLACES {
        let part = place as f64 / (PLACES + 1) as f64;
        let corner = low + part * range;
        let shown = rounded(corner / scale, 3);
        let step = Box::new(move |x: f64| ((x - corner) / width).tanh());
        add(format!("step at {name} = {shown}"), PLACES, step);
        let ramp = Box::new(move |x: f64| (x - corner).max(0.0) / unit);
        add(format!("max({name} - {shown}, 0)"), PLACES, ramp);
        let length = part * range;
        let decay = Box::new(move |x: f64| (-(x - low) / length).exp());
        let shown = rounded(length / scale, 2);
        add(format!("exp(-{name}/{shown})"), PLACES, decay);
    }
    let rates = (0..WAVES).map(|wave| dependence.rate(wave));
    trials.extend(waves(bench, dependence, rates));
    trials
}

/// A sine with a free phase for each of these frequencies.
fn waves(
    bench: &Bench<'_>,
    dependence: Dependence<'_>,
    rates: impl Iterator<Item = f64>,
) -> impl Iterator<Item = Trial> {
    let (name, _, scale) = dependence.letters(bench);
    rates.map(move |rate| Trial {
        text: format!("sin({}*{name} + phase)", rounded(rate * scale, 3)),
        functions: vec![
            Box::new(move |x| (rate * x).sin()),
            Box::new(move |x| (rate * x).cos()),
        ],
        alike: WAVES,
        rate: Some(rate),
    })
}

/// A number with so many digits after the first.
fn rounded(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$e}");
    text.parse::<f64>().map_or(text, |value| value.to_string())
}
