//! Variation of parameters from run to run: each run fitted alone, compared with the fit of all runs.
//!
//! An interval is that of one value common to all runs. Where friction, temperature or a payload
//! differs, runs have different values, whose spread beyond their own intervals is estimated
//! (R. `DerSimonian` and N. Laird, *Meta-analysis in clinical trials*, Controlled Clinical Trials 7, 1986). Whether they
//! differ at all is tested by Q, the sum of their squared deviations over their variances, which is χ² distributed
//! if they do not (W. G. Cochran, 1954), at 5 % for all parameters together (Bonferroni).

use appell_estimate::{
    Effort, Estimation, Fit, Free, Recording, Setup, Unknown, chi_squared_probability,
};

use super::IdentifyError;
use super::problem::begin;

/// Fits of single runs end within some hundredths of a standard deviation.
const EFFORT: Effort = Effort {
    gain: 1e-3,
    steps: 50,
    floor: f64::NEG_INFINITY,
};

/// A parameter in the single runs.
#[derive(Debug, Clone, PartialEq)]
pub struct Repeatability {
    /// Name of the parameter.
    pub name: String,
    /// For each run its file, the value and its standard deviation, in SI.
    pub runs: Vec<(String, [f64; 2])>,
    /// Standard deviation of the value from run to run in SI, beyond that of the single values.
    pub spread: f64,
    /// Probability of values at least as different as these if all runs share one value.
    pub p_value: f64,
    /// Whether that is below 5 % over the number of parameters.
    pub differs: bool,
}

/// Probability of a difference of any parameter where there is none.
const LEVEL: f64 = 0.05;

/// The repeatability of all free parameters; empty where a single run cannot be fitted. Deviations of the
/// single values are widened by these factors, as those of the joint fit are for correlated residuals.
pub(super) fn repeatability(
    setup: &Setup<'_>,
    runs: &[(&str, &Recording)],
    free: &[Free],
    names: &[String],
    widening: &[f64],
    all: &Estimation<'_>,
    fit: &Fit,
) -> Result<Vec<Repeatability>, IdentifyError> {
    let mut found: Vec<Repeatability> = names
        .iter()
        .map(|name| Repeatability {
            name: name.clone(),
            runs: Vec::new(),
            spread: 0.0,
            p_value: 1.0,
            differs: false,
        })
        .collect();
    for (name, recording) in runs {
        let Some(values) = alone(setup, recording, free, all, fit)? else {
            continue;
        };
        for (one, value) in found.iter_mut().zip(values) {
            one.runs.push(((*name).to_owned(), value));
        }
    }
    let count = found.len() as f64;
    for (one, widening) in found.iter_mut().zip(widening) {
        let values = one.runs.iter();
        let values: Vec<[f64; 2]> = values
            .map(|(_, [value, deviation])| [*value, widening * deviation])
            .collect();
        let own = Heterogeneity::of(&values);
        one.spread = own.spread;
        one.p_value = own.p_value;
        one.differs = own.p_value < LEVEL / count;
    }
    Ok(found)
}

/// Values and standard deviations of the parameters in one run, with the noise levels of the joint fit.
fn alone(
    setup: &Setup<'_>,
    recording: &Recording,
    free: &[Free],
    all: &Estimation<'_>,
    fit: &Fit,
) -> Result<Option<Vec<[f64; 2]>>, IdentifyError> {
    let recordings = [recording.clone()];
    let estimation = Estimation::new(setup, &recordings)?;
    let layout = estimation.layout();
    let mut start = estimation.nominal();
    let first_run = all.layout().place(Unknown::Initial { run: 0, state: 0 })?;
    // The values before those of the runs have the same indices.
    start[..first_run].copy_from_slice(&fit.values[..first_run]);
    begin(&estimation, &mut start)?;
    let mut around = Vec::with_capacity(free.len());
    for one in free {
        let value = start[layout.place(one.unknown)?];
        around.push(match one.prior {
            Some([_, tolerance]) => one.around(value, tolerance),
            None => *one,
        });
    }
    let Ok(alone) = Fit::quick(&estimation, &start, &around, EFFORT) else {
        return Ok(None);
    };
    let mut values = Vec::with_capacity(free.len());
    for (place, one) in free.iter().enumerate() {
        let Ok(deviation) = alone.deviation(place) else {
            return Ok(None);
        };
        values.push([alone.values[layout.place(one.unknown)?], deviation]);
    }
    Ok(Some(values))
}

/// Heterogeneity of values.
struct Heterogeneity {
    /// Standard deviation between them in excess of their own.
    spread: f64,
    p_value: f64,
}

impl Heterogeneity {
    /// From values with their standard deviations.
    fn of(values: &[[f64; 2]]) -> Self {
        let is_known = |[_, deviation]: &&[f64; 2]| deviation.is_finite() && *deviation > 0.0;
        let known: Vec<[f64; 2]> = values.iter().filter(is_known).copied().collect();
        if known.len() < 2 {
            return Self {
                spread: 0.0,
                p_value: 1.0,
            };
        }
        let weight = |[_, deviation]: &[f64; 2]| deviation.powi(-2);
        let sum: f64 = known.iter().map(weight).sum();
        let squares: f64 = known.iter().map(|one| weight(one).powi(2)).sum();
        let mean = known.iter().map(|one| weight(one) * one[0]).sum::<f64>() / sum;
        let q: f64 = known
            .iter()
            .map(|one| weight(one) * (one[0] - mean).powi(2))
            .sum();
        let freedom = (known.len() - 1) as f64;
        Self {
            spread: ((q - freedom) / (sum - squares / sum)).max(0.0).sqrt(),
            p_value: 1.0 - chi_squared_probability(q, freedom),
        }
    }
}

#[cfg(test)]
mod tests {
    use appell_test_kit::Random;

    use super::{Heterogeneity, LEVEL};

    #[test]
    fn what_intervals_explain_is_no_spread() {
        let same = Heterogeneity::of(&[[1.0, 0.5], [1.4, 0.5], [0.7, 0.5]]);
        assert!(same.spread.abs() < 1e-12 && same.p_value > 0.5);
        let other = Heterogeneity::of(&[[1.0, 0.01], [2.0, 0.01], [3.0, 0.01]]);
        assert!((other.spread - 1.0).abs() < 1e-3, "{}", other.spread);
        assert!(other.p_value < 1e-12);
        let alone = Heterogeneity::of(&[[1.0, 0.1]]);
        assert!(alone.spread.abs() < 1e-12 && alone.p_value > 0.5);
    }

    #[test]
    fn runs_that_share_a_value_are_told_to_differ_as_seldom_as_stated() {
        let mut random = Random::of("runs that share a value");
        let trials = 2000;
        let different = (0..trials).filter(|_| {
            let run = |_| {
                let deviation = random.between(0.5, 2.0);
                [3.0 + deviation * random.normal(), deviation]
            };
            let values: Vec<[f64; 2]> = (0..4).map(run).collect();
            Heterogeneity::of(&values).p_value < LEVEL
        });
        let part = different.count() as f64 / f64::from(trials);
        // Three standard deviations of a count of 100.
        assert!((part - LEVEL).abs() < 0.015, "{part}");
    }
}
