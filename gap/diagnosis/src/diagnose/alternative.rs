//! Another spec of the same rig as a hypothesis, such as a model with a further degree of freedom.
//!
//! It is fitted to the same recordings as the nominal model, and its evidence is compared with that of
//! the effects. Channels that only the alternative measures give it no advantage: the evidence is that of
//! the samples of common channels, each conditional on all earlier samples. A filter with the common channels alone
//! would diverge for an unstable mechanism.

use appell_estimate::Innovation;

use super::{Bench, Changes, DiagnoseError, Fitted, Result, Value};
use crate::effects::EffectModel;
use appell_recordings::{DataSet, Spec};

/// A spec with the training runs.
pub(super) struct Alternative {
    set: DataSet,
    model: EffectModel,
}

/// An alternative after its fit.
pub(super) struct Rival<'a> {
    /// Name of the hypothesis.
    pub(super) name: String,
    pub(super) bench: Bench<'a>,
    pub(super) fitted: Fitted,
    /// Logarithm of its evidence.
    pub(super) log: f64,
}

/// Effects of a hypothesis that could not be fitted, with the reason.
type Lost = (Vec<String>, String);

impl Alternative {
    /// Of a spec, with the training runs.
    pub(super) fn new(fitted: &DataSet, spec: &Spec) -> Result<Self> {
        Ok(Self {
            set: fitted.rebound(spec)?,
            model: EffectModel::new(spec, Vec::new())?,
        })
    }

    /// Name of its hypothesis.
    fn name(&self) -> String {
        format!("alternative:{}", self.set.mechanism.name)
    }
}

impl<'a> Rival<'a> {
    /// Those that can be fitted, and the names of the others with the reasons.
    pub(super) fn all(
        alternatives: &'a [Alternative],
        main: &Bench<'_>,
    ) -> Result<(Vec<Self>, Vec<Lost>)> {
        let (mut rivals, mut lost) = (Vec::new(), Vec::new());
        for alternative in alternatives {
            match Self::of(alternative, main) {
                Ok(rival) => rivals.push(rival),
                Err(DiagnoseError::Estimate(error)) => {
                    lost.push((vec![alternative.name()], error.to_string()));
                }
                Err(other) => return Err(other),
            }
        }
        Ok((rivals, lost))
    }

    /// Fits an alternative to the model of `main`.
    fn of(alternative: &'a Alternative, main: &Bench<'_>) -> Result<Self> {
        let name = alternative.set.mechanism.name.clone();
        let shared = columns(main);
        let own = measured(&alternative.set, &alternative.model);
        if let Some(column) = shared.iter().find(|column| !own.contains(column)) {
            return Err(DiagnoseError::LacksChannel {
                name,
                column: column.clone(),
            });
        }
        let mut bench = Bench::new(&alternative.set, &alternative.model)?;
        let mut fitted = bench.nominal()?;
        if main.is_over_windows() {
            let windows = main.set.rebound(&alternative.set.spec)?;
            let levels = bench.levels(&fitted)?;
            bench = Bench::over(&windows, &bench, &levels)?;
            (bench.weight, bench.told) = (main.weight, main.told);
            fitted = bench.nominal()?;
        }
        let extra: Vec<bool> = own.iter().map(|column| !shared.contains(column)).collect();
        let of_extra = of_channels(&bench, &fitted, &extra)?;
        Ok(Self {
            name: alternative.name(),
            log: fitted.evidence.log() - of_extra,
            bench,
            fitted,
        })
    }

    /// Noise of its channels as in the main model; infinite for channels that only it has.
    pub(super) fn noise(&self, main: &Bench<'_>, noise: &[f64]) -> Vec<f64> {
        let shared = columns(main);
        let of = |column: &String| {
            let place = shared.iter().position(|own| own == column);
            place.map_or(f64::INFINITY, |place| noise[place])
        };
        columns(&self.bench).iter().map(of).collect()
    }

    /// Parameters after the fit.
    pub(super) fn values(&self) -> Result<Vec<Value>> {
        let parameters = Changes::of(&self.bench, &self.fitted)?.parameters;
        let values = parameters.into_iter().map(|one| Value {
            name: format!("{}.{}", self.name, one.name),
            value: one.value,
            std: one.std.unwrap_or(0.0),
            unit: one.unit,
            is_determined: true,
            ..Value::default()
        });
        Ok(values.collect())
    }
}

/// Names of the measured channels.
pub(super) fn columns(bench: &Bench<'_>) -> Vec<String> {
    measured(&bench.set, bench.effects)
}

fn measured(set: &DataSet, model: &EffectModel) -> Vec<String> {
    let measured = set.measured(model.info());
    let columns = measured.iter().map(|(channel, _)| channel.column.clone());
    columns.collect()
}

/// Log-likelihood of the samples of some channels, each given all samples before it.
fn of_channels(bench: &Bench<'_>, fitted: &Fitted, channels: &[bool]) -> Result<f64> {
    let runs = bench.innovations(fitted)?;
    let samples = runs.iter().flatten();
    let own = samples.filter(|sample| channels[sample.channel]);
    Ok(bench.weight * own.map(Innovation::log_likelihood).sum::<f64>())
}
