//! Validation of statements of the data set under the best hypothesis: tolerances of parameters, and the interpolation
//! of inputs between rows.

use appell_estimate::Estimation;
use appell_recordings::{Channel, DataSet, FindingKind};
use appell_spec::mechanism::Interpolation;
use nalgebra::{DMatrix, DVector};

use super::bench::SHARES;
use super::calibration::TIED;
use super::{Bench, Fitted, Interpolated, Result, Tolerances};

/// Factors on all tolerances that are tried.
const FACTORS: [f64; 6] = [1.5, 2.0, 2.5, 3.0, 5.0, 10.0];
/// Smallest number of parameters that determine a common factor.
const FEWEST: usize = 2;

/// The most probable factor on all tolerances, if the re-fitted parameters contradict the stated ones.
///
/// In units of its tolerance a parameter has a normal prior of variance s². With the information H of the
/// recordings and the estimate m under s = 1, the marginal likelihood of s is that of a Gaussian (C. M. Bishop,
/// *Pattern Recognition and Machine Learning*, 2006, section 3.5).
pub(super) fn tolerances(fitted: &Fitted) -> Option<Tolerances> {
    let fit = &fitted.fit;
    let known: Vec<(usize, f64, f64)> = (0..fit.free.len())
        .filter(|&i| !fit.at_limit[i])
        .filter_map(|i| {
            let [expected, deviation] = fit.free[i].prior?;
            let moved = fit.coordinates[i] - fit.free[i].to_coordinate(expected);
            Some((i, moved / deviation, deviation))
        })
        .collect();
    if known.len() < FEWEST {
        return None;
    }
    let covariance = fit.covariance().ok()?;
    let relative = DMatrix::from_fn(known.len(), known.len(), |i, j| {
        let ((a, _, of_a), (b, _, of_b)) = (known[i], known[j]);
        covariance[(a, b)] / (of_a * of_b)
    });
    let posterior = relative.try_inverse()?;
    let information = &posterior - DMatrix::identity(known.len(), known.len());
    let moves = DVector::from_iterator(known.len(), known.iter().map(|(_, moved, _)| *moved));
    let score = &posterior * moves;
    let log_evidence = |factor: f64| -> Option<f64> {
        let mut precision = information.clone();
        for i in 0..known.len() {
            precision[(i, i)] += factor.powi(-2);
        }
        let factored = precision.cholesky()?;
        let volume: f64 = (factored.l_dirty().diagonal().iter()).map(|l| l.ln()).sum();
        let explained = 0.5 * score.dot(&factored.solve(&score));
        Some(explained - volume - known.len() as f64 * factor.ln())
    };
    let stated = log_evidence(1.0)?;
    let best = FACTORS
        .into_iter()
        .filter_map(|factor| Some((factor, log_evidence(factor)? - stated)))
        .max_by(|a, b| a.1.total_cmp(&b.1))?;
    (best.1 > TIED).then_some(Tolerances {
        factor: best.0,
        log_bayes_factor: best.1,
    })
}

/// Smooth inputs without a stated interpolation for which linear interpolation between the rows of `set` improves the
/// one-step predictions of the best hypothesis.
pub(super) fn interpolated(
    bench: &Bench<'_>,
    fitted: &Fitted,
    set: &DataSet,
) -> Result<Vec<Interpolated>> {
    let is_smooth = |channel: &&Channel| {
        let mut findings = set.findings.iter();
        channel.interpolation.is_none()
            && findings.any(|one| {
                one.kind == FindingKind::SmoothInput
                    && one.channel.as_ref() == Some(&channel.column)
            })
    };
    let smooth: Vec<&Channel> = set.channels.iter().filter(is_smooth).collect();
    if smooth.is_empty() {
        return Ok(Vec::new());
    }
    let held = log_likelihood(bench, fitted, set)?;
    let mut found = Vec::new();
    for channel in smooth {
        let mut joined = set.clone();
        for own in &mut joined.channels {
            if own.column == channel.column {
                own.interpolation = Some(Interpolation::Linear);
            }
        }
        let gain = log_likelihood(bench, fitted, &joined)? - held;
        if gain > TIED {
            found.push(Interpolated {
                input: channel.column.clone(),
                log_likelihood: gain,
            });
        }
    }
    Ok(found)
}

/// Log likelihood of the one-step predictions of a hypothesis after a fit to these recordings.
fn log_likelihood(bench: &Bench<'_>, fitted: &Fitted, set: &DataSet) -> Result<f64> {
    let stepwise = Bench::new(set, bench.effects)?;
    let setup = stepwise.setup(&fitted.members);
    let estimation = Estimation::new(&setup, &stepwise.recordings)?;
    let mut start = bench.carried(fitted, &estimation);
    if bench.is_over_windows() {
        for free in &stepwise.problem.levels {
            let place = stepwise.layout.place(free.unknown)?;
            start[estimation.layout().place(free.unknown)?] = stepwise.problem.start[place];
        }
        stepwise.begin(&estimation, &mut start)?;
    }
    let again = stepwise.fit(SHARES, &fitted.members, &estimation, &start)?;
    Ok(again.fit.log_likelihood)
}
