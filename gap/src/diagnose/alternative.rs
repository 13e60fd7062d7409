//! Another spec of the same thing as a hypothesis of its own: a missing degree of freedom, say.
//!
//! It is fitted to the same recordings as the nominal model is, and its evidence stands beside that of
//! the effects. Channels that it knows and the other one does not are no gain: the evidence is that of
//! the channels of both, given these, log p(all) − log p(these).

use appell_runtime::estimate::{Estimation, Recording};

use super::DiagnoseError;
use super::bench::Bench;
use super::changes::Changes;
use super::hypothesis::Fitted;
use super::report::Value;
use crate::data::{DataSet, Spec};
use crate::effects::EffectModel;

/// A spec with the runs to fit.
pub(super) struct Alternative {
    spec: Spec,
    set: DataSet,
    model: EffectModel,
}

/// An alternative after its fit.
pub(super) struct Rival<'a> {
    spec: &'a Spec,
    /// Name of the hypothesis.
    pub(super) name: String,
    pub(super) bench: Bench<'a>,
    pub(super) fitted: Fitted,
    /// Logarithm of its evidence.
    pub(super) log: f64,
}

impl Alternative {
    pub(super) fn new(fitted: &DataSet, spec: &Spec) -> Result<Self, DiagnoseError> {
        Ok(Self {
            spec: spec.clone(),
            set: fitted.rebound(spec)?,
            model: EffectModel::new(spec, Vec::new())?,
        })
    }
}

impl<'a> Rival<'a> {
    /// Fits an alternative; `main` is the model beside which it stands.
    pub(super) fn of(
        alternative: &'a Alternative,
        main: &Bench<'_>,
    ) -> Result<Self, DiagnoseError> {
        let name = alternative.set.mechanism.name.clone();
        let shared = columns(main);
        let own = measured(&alternative.set, &alternative.model);
        if let Some(column) = shared.iter().find(|column| !own.contains(column)) {
            return Err(DiagnoseError::LacksChannel {
                name,
                column: column.clone(),
            });
        }
        let bench = Bench::new(&alternative.set, &alternative.model)?;
        let fitted = bench.nominal()?;
        let extra: Vec<bool> = own.iter().map(|column| !shared.contains(column)).collect();
        let given = given(&bench, &fitted, &extra)?;
        Ok(Self {
            spec: &alternative.spec,
            name: format!("alternative:{name}"),
            log: fitted.evidence.log() - given,
            bench,
            fitted,
        })
    }

    /// Runs that were held out, bound to it.
    pub(super) fn rebound(&self, test: &DataSet) -> Result<DataSet, DiagnoseError> {
        Ok(test.rebound(self.spec)?)
    }

    /// Noise of its channels as the main model has it; infinite for those that are its own.
    pub(super) fn noise(&self, main: &Bench<'_>, noise: &[f64]) -> Vec<f64> {
        let shared = columns(main);
        let of = |column: &String| {
            let place = shared.iter().position(|own| own == column);
            place.map_or(f64::INFINITY, |place| noise[place])
        };
        columns(&self.bench).iter().map(of).collect()
    }

    /// Parameters after the fit.
    pub(super) fn values(&self) -> Result<Vec<Value>, DiagnoseError> {
        let parameters = Changes::of(&self.bench, &self.fitted)?.parameters;
        let values = parameters.into_iter().map(|one| Value {
            name: format!("{}.{}", self.name, one.name),
            value: one.value,
            std: one.std.unwrap_or(0.0),
            unit: one.unit,
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

/// Log-likelihood of some of the channels alone.
fn given(bench: &Bench<'_>, fitted: &Fitted, channels: &[bool]) -> Result<f64, DiagnoseError> {
    if !channels.contains(&true) {
        return Ok(0.0);
    }
    let alone = |recording: &Recording| {
        let rows = 0..recording.times().len();
        let values = rows.flat_map(|row| {
            let seen = recording.measured(row).iter().zip(channels);
            seen.map(|(value, own)| if *own { *value } else { f64::NAN })
        });
        recording.with_measurements(values.collect())
    };
    let recordings: Vec<Recording> = bench
        .recordings
        .iter()
        .map(alone)
        .collect::<Result<_, _>>()?;
    let setup = bench.setup(&fitted.members);
    let estimation = Estimation::new(&setup, &recordings)?;
    Ok(estimation.log_likelihood(&fitted.fit.values)?)
}
