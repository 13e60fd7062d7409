//! How far parameters differ from run to run: each run fitted alone, beside all together.
//!
//! An interval tells how well one value is known that all runs share. Where friction, temperature or a payload
//! differs, runs have values of their own, whose spread is estimated beyond what their intervals explain
//! (R. `DerSimonian` and N. Laird, *Meta-analysis in clinical trials*, Controlled Clinical Trials 7, 1986).

use appell_estimate::{Effort, Estimation, Fit, Free, Recording, Setup, Unknown};

use super::IdentifyError;
use super::problem::begin;

/// Fits of single runs end within some hundredths of a standard deviation.
const EFFORT: Effort = Effort {
    gain: 1e-3,
    steps: 50,
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
}

/// Of all free parameters, from the fit of all runs; nothing where a run alone cannot be fitted.
pub(super) fn repeatability(
    setup: &Setup<'_>,
    runs: &[(&str, &Recording)],
    (free, names): (&[Free], &[String]),
    whole: (&Estimation<'_>, &Fit),
) -> Result<Vec<Repeatability>, IdentifyError> {
    let mut found: Vec<Repeatability> = names
        .iter()
        .map(|name| Repeatability {
            name: name.clone(),
            runs: Vec::new(),
            spread: 0.0,
        })
        .collect();
    for (name, recording) in runs {
        let Some(values) = alone(setup, recording, free, whole)? else {
            continue;
        };
        for (one, value) in found.iter_mut().zip(values) {
            one.runs.push(((*name).to_owned(), value));
        }
    }
    for one in &mut found {
        let values: Vec<[f64; 2]> = one.runs.iter().map(|(_, value)| *value).collect();
        one.spread = spread(&values);
    }
    Ok(found)
}

/// Values and standard deviations of the parameters in one run, levels as in all of them.
fn alone(
    setup: &Setup<'_>,
    recording: &Recording,
    free: &[Free],
    (all, fit): (&Estimation<'_>, &Fit),
) -> Result<Option<Vec<[f64; 2]>>, IdentifyError> {
    let recordings = [recording.clone()];
    let estimation = Estimation::new(setup, &recordings)?;
    let layout = estimation.layout();
    let mut start = estimation.nominal();
    let first_run = all.layout().place(Unknown::Initial { run: 0, state: 0 })?;
    // What comes before the runs stands at the same places.
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

/// Standard deviation between values beyond their own.
fn spread(values: &[[f64; 2]]) -> f64 {
    let known = values
        .iter()
        .filter(|[_, deviation]| deviation.is_finite() && *deviation > 0.0);
    let known: Vec<[f64; 2]> = known.copied().collect();
    if known.len() < 2 {
        return 0.0;
    }
    let weight = |[_, deviation]: &[f64; 2]| deviation.powi(-2);
    let sum: f64 = known.iter().map(weight).sum();
    let squares: f64 = known.iter().map(|one| weight(one).powi(2)).sum();
    let mean = known.iter().map(|one| weight(one) * one[0]).sum::<f64>() / sum;
    let off: f64 = known
        .iter()
        .map(|one| weight(one) * (one[0] - mean).powi(2))
        .sum();
    let beyond = off - (known.len() - 1) as f64;
    (beyond / (sum - squares / sum)).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::spread;

    #[test]
    fn what_intervals_explain_is_no_spread() {
        assert!(spread(&[[1.0, 0.5], [1.4, 0.5], [0.7, 0.5]]).abs() < 1e-12);
        let spread = spread(&[[1.0, 0.01], [2.0, 0.01], [3.0, 0.01]]);
        assert!((spread - 1.0).abs() < 1e-3, "{spread}");
        assert!(super::spread(&[[1.0, 0.1]]).abs() < 1e-12);
    }
}
