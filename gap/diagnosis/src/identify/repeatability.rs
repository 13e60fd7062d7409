//! Variation of parameters from run to run: each run fitted alone, compared with the fit of all runs.
//!
//! An interval is that of one value common to all runs. Where friction, temperature or a payload
//! differs, runs have different values, whose spread beyond their own intervals is estimated
//! (R. `DerSimonian` and N. Laird, *Meta-analysis in clinical trials*, Controlled Clinical Trials 7, 1986). Whether they
//! differ at all is tested by Q, the sum of their squared deviations over their variances, which is χ² distributed
//! if they do not (W. G. Cochran, 1954), at 5 % for all parameters together (Bonferroni).

use appell_estimate::{Effort, Estimation, Fit, Free, Recording, chi_squared_probability};

use super::IdentifyError;
use super::answer::Estimate;
use super::problem::{Problem, begun};

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

/// The repeatability of all free parameters in runs of these names; empty where a single run cannot be fitted.
/// Deviations of the single values are widened as those of the joint fit are for correlated residuals.
pub(super) fn repeatability(
    runs: &[&str],
    all: &Estimation<'_>,
    problem: &Problem,
    fit: &Fit,
    parameters: &[Estimate],
) -> Result<Vec<Repeatability>, IdentifyError> {
    let mut values = vec![Vec::new(); parameters.len()];
    for (&run, recording) in runs.iter().zip(all.recordings()) {
        let own = alone(recording, &problem.wanted, all, fit)?;
        for (values, value) in values.iter_mut().zip(own.into_iter().flatten()) {
            values.push((run.to_owned(), value));
        }
    }
    let found = parameters.iter().zip(values).map(|(parameter, runs)| {
        let widening = if parameter.std > 0.0 {
            parameter.wider_std() / parameter.std
        } else {
            1.0
        };
        let values = runs.iter();
        let values: Vec<[f64; 2]> = values
            .map(|(_, [value, deviation])| [*value, widening * deviation])
            .collect();
        let [spread, p_value] = heterogeneity(&values);
        Repeatability {
            name: parameter.quantity.name.to_string(),
            runs,
            spread,
            p_value,
            differs: p_value < LEVEL / parameters.len() as f64,
        }
    });
    Ok(found.collect())
}

/// Values and standard deviations of the parameters in one run, with the noise levels of the joint fit.
fn alone(
    recording: &Recording,
    free: &[Free],
    all: &Estimation<'_>,
    fit: &Fit,
) -> Result<Option<Vec<[f64; 2]>>, IdentifyError> {
    let recordings = [recording.clone()];
    let estimation = Estimation::new(all.setup(), &recordings)?;
    let layout = estimation.layout();
    let start = begun(&estimation, &fit.values)?;
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

/// Of values with their standard deviations: the standard deviation between them in excess of their own, and the
/// probability of values at least as different if they are the same.
fn heterogeneity(values: &[[f64; 2]]) -> [f64; 2] {
    let is_known = |[_, deviation]: &&[f64; 2]| deviation.is_finite() && *deviation > 0.0;
    let known: Vec<[f64; 2]> = values.iter().filter(is_known).copied().collect();
    if known.len() < 2 {
        return [0.0, 1.0];
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
    let spread = ((q - freedom) / (sum - squares / sum)).max(0.0).sqrt();
    [spread, 1.0 - chi_squared_probability(q, freedom)]
}

#[cfg(test)]
mod tests {
    use appell_test_kit::Random;

    use super::{LEVEL, heterogeneity};

    #[test]
    fn what_intervals_explain_is_no_spread() {
        let [spread, p_value] = heterogeneity(&[[1.0, 0.5], [1.4, 0.5], [0.7, 0.5]]);
        assert!(spread.abs() < 1e-12 && p_value > 0.5);
        let [spread, p_value] = heterogeneity(&[[1.0, 0.01], [2.0, 0.01], [3.0, 0.01]]);
        assert!((spread - 1.0).abs() < 1e-3, "{spread}");
        assert!(p_value < 1e-12);
        let [spread, p_value] = heterogeneity(&[[1.0, 0.1]]);
        assert!(spread.abs() < 1e-12 && p_value > 0.5);
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
            heterogeneity(&values)[1] < LEVEL
        });
        let part = different.count() as f64 / f64::from(trials);
        // Three standard deviations of a count of 100.
        assert!((part - LEVEL).abs() < 0.015, "{part}");
    }
}
