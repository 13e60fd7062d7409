//! Closed forms of a measured law: simple functions with one or two coefficients instead of a curve.

use appell_estimate::{Estimation, Shapes};
use appell_runtime::model::At;

use super::DiagnoseError;
use super::bench::Bench;
use super::evidence::Fitted;
use super::report::Form;
use super::unknown::{Dependence, LawGain, TermScores, Unnamed, term_scores};

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

/// One function of the variable.
struct Term {
    of: Box<dyn Fn(f64) -> f64 + Sync>,
}

/// A form with the indices of its terms, and the number of forms of its kind.
struct Trial {
    text: String,
    terms: Vec<usize>,
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
) -> Result<Vec<Form>, DiagnoseError> {
    let (terms, tried) = trials(bench, dependence);
    let mut forms = scored(bench, base, dependence, law, &terms, tried)?;
    // The frequencies of harmonics are a grid: the best one is refined between its neighbours.
    let best = forms.iter().find_map(|(rate, _)| *rate);
    if let Some(rate) = best {
        let step = dependence.rate(1) - dependence.rate(0);
        let finer = (0..=2 * FINER).map(|place| {
            let beside = (f64::from(place) - f64::from(FINER)) / f64::from(FINER);
            rate + beside * step
        });
        let finer: Vec<f64> = finer.filter(|rate| *rate > 0.0).collect();
        let (terms, tried) = waves(bench, dependence, &finer);
        let finer = scored(bench, base, dependence, law, &terms, tried)?;
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
    terms: &[Term],
    trials: Vec<Trial>,
) -> Result<Vec<(Option<f64>, Form)>, DiagnoseError> {
    let setup = bench.setup(&base.members);
    let estimation = Estimation::new(&setup, &bench.recordings)?;
    let write = |run: usize, at: At<'_>, values: &mut [f64]| {
        let x = dependence.variable(bench, setup.model, run, at);
        let factor = dependence.factor(bench, setup.model, at);
        for (value, term) in values.iter_mut().zip(terms) {
            *value = if x.is_nan() {
                0.0
            } else {
                factor * (term.of)(x)
            };
        }
    };
    let shapes = Shapes {
        along: law.along,
        count: terms.len(),
        values: &write,
    };
    let scores = term_scores(bench, &estimation, base, shapes, &[shapes.count])?;
    let mut scores = scores.into_iter().flatten();
    let Some((_, scores)) = scores.find(|(place, _)| *place == law.place) else {
        return Ok(Vec::new());
    };
    let mut forms: Vec<(Option<f64>, Form)> = trials
        .into_iter()
        .filter_map(|trial| Some((trial.rate, judged(trial, &scores, law.gain)?)))
        .filter(|(_, form)| form.share > NEAR)
        .collect();
    forms.sort_by(|(_, a), (_, b)| b.log_bayes_factor.total_cmp(&a.log_bayes_factor));
    Ok(forms)
}

fn judged(trial: Trial, scores: &TermScores, most: f64) -> Option<Form> {
    let LawGain {
        gain,
        log_bayes_factor,
        ..
    } = scores.of(&trial.terms)?;
    Some(Form {
        text: trial.text,
        share: gain / most.max(f64::MIN_POSITIVE),
        log_bayes_factor: log_bayes_factor - (trial.alike as f64).ln(),
    })
}

/// All forms of a variable, and the functions of which they consist.
fn trials(bench: &Bench<'_>, dependence: Dependence<'_>) -> (Vec<Term>, Vec<Trial>) {
    let (name, written) = dependence.letters(bench);
    let (low, high) = dependence.range;
    let (range, scale) = (high - low, dependence.unit(bench).1);
    let width = STEP * range;
    let mut terms: Vec<Term> = Vec::new();
    let mut trials: Vec<Trial> = Vec::new();
    let mut add = |text: String, alike: usize, functions: Vec<Box<dyn Fn(f64) -> f64 + Sync>>| {
        let first = terms.len();
        terms.extend(functions.into_iter().map(|of| Term { of }));
        let text = match &written {
            Some(factor) => format!("{factor}*{text}"),
            None => text,
        };
        trials.push(Trial {
            text,
            terms: (first..terms.len()).collect(),
            alike,
            rate: None,
        });
    };
    let unit = range.abs().max(f64::MIN_POSITIVE);
    add(name.clone(), 1, vec![Box::new(move |x| x / unit)]);
    add(
        format!("{name}^2"),
        1,
        vec![Box::new(move |x| (x / unit).powi(2))],
    );
    add(
        format!("{name}^3"),
        1,
        vec![Box::new(move |x| (x / unit).powi(3))],
    );
    if low < 0.0 && high > 0.0 {
        add(
            format!("sign({name})"),
            1,
            vec![Box::new(move |x| (x / width).tanh())],
        );
        add(format!("abs({name})"), 1, vec![Box::new(f64::abs)]);
        add(
            format!("{name}*abs({name})"),
            1,
            vec![Box::new(move |x| x / unit * (x / unit).abs())],
        );
    }
    for place in 1..=PLACES {
        let part = place as f64 / (PLACES + 1) as f64;
        let corner = low + part * range;
        let shown = format!("{:.3e}", corner / scale);
        let shown = shown
            .parse::<f64>()
            .map_or(shown, |value| value.to_string());
        add(
            format!("step at {name} = {shown}"),
            PLACES,
            vec![Box::new(move |x| ((x - corner) / width).tanh())],
        );
        add(
            format!("max({name} - {shown}, 0)"),
            PLACES,
            vec![Box::new(move |x| (x - corner).max(0.0) / unit)],
        );
        let length = part * range;
        let shown = format!("{:.2e}", length / scale);
        let shown = shown
            .parse::<f64>()
            .map_or(shown, |value| value.to_string());
        add(
            format!("exp(-{name}/{shown})"),
            PLACES,
            vec![Box::new(move |x| (-(x - low) / length).exp())],
        );
    }
    let rates: Vec<f64> = (0..WAVES).map(|wave| dependence.rate(wave)).collect();
    let (more, waves) = waves(bench, dependence, &rates);
    let first = terms.len();
    trials.extend(waves.into_iter().map(|wave| Trial {
        terms: wave.terms.iter().map(|term| first + term).collect(),
        ..wave
    }));
    terms.extend(more);
    (terms, trials)
}

/// A sine with a free phase for each of these frequencies.
fn waves(bench: &Bench<'_>, dependence: Dependence<'_>, rates: &[f64]) -> (Vec<Term>, Vec<Trial>) {
    let (name, written) = dependence.letters(bench);
    let scale = dependence.unit(bench).1;
    let (mut terms, mut trials) = (Vec::new(), Vec::new());
    for &rate in rates {
        let shown = format!("{:.3e}", rate * scale);
        let shown = (shown.parse::<f64>()).map_or(shown, |value| value.to_string());
        let text = format!("sin({shown}*{name} + phase)");
        let first = terms.len();
        terms.extend([
            Term {
                of: Box::new(move |x| (rate * x).sin()),
            },
            Term {
                of: Box::new(move |x| (rate * x).cos()),
            },
        ]);
        trials.push(Trial {
            text: match &written {
                Some(factor) => format!("{factor}*{text}"),
                None => text,
            },
            terms: vec![first, first + 1],
            alike: WAVES,
            rate: Some(rate),
        });
    }
    (terms, trials)
}
