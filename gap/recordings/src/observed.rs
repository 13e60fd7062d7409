//! A data set as recordings for estimation: columns by the indices of a model.

use appell_estimate::{EstimateError, Recording};
use appell_runtime::model::{Interpolation, ModelInfo};

use appell_spec::Mechanism;
use appell_spec::mechanism;

use crate::{Channel, DataSet, Measured, Parameter, Part, Reading, Role, Row};

impl DataSet {
    /// The runs of one part.
    #[must_use]
    pub fn only(&self, part: Part) -> Self {
        let mut set = self.clone();
        set.runs.retain(|run| run.part == part);
        set
    }

    /// All runs as those of one part.
    #[must_use]
    pub fn all(&self, part: Part) -> Self {
        let mut set = self.clone();
        for run in &mut set.runs {
            run.part = part;
        }
        set
    }

    /// The same recordings of a mechanism with further parameters, whose values its spec states.
    #[must_use]
    pub fn bound_to(&self, mechanism: &Mechanism) -> Self {
        let own = |parameter: &mechanism::Parameter| {
            let mut names = self.mechanism.parameters.iter().map(|p| &p.label.name);
            let known = names.position(|name| *name == parameter.label.name);
            known.map_or_else(
                || Parameter::stated(parameter),
                |index| self.parameters[index],
            )
        };
        Self {
            parameters: mechanism.parameters.iter().map(own).collect(),
            mechanism: mechanism.clone(),
            ..self.clone()
        }
    }

    /// The measured channels whose quantities the model has, with the quantities.
    pub fn measured(&self, info: &ModelInfo) -> Vec<(&Channel, appell_estimate::Measured)> {
        let shown = |channel: &Channel| match channel.role {
            Role::Measures(measured) => {
                let name = &measured.label(&self.mechanism).name;
                match measured {
                    Measured::Coordinate(_) | Measured::PseudoVelocity(_) => {
                        info.state_index(name).map(appell_estimate::Measured::State)
                    }
                    Measured::Output(_) => info
                        .output_index(name)
                        .map(appell_estimate::Measured::Output),
                }
            }
            Role::Input(_) | Role::Recorded => None,
        };
        let channels = self.channels.iter();
        channels
            .filter_map(|channel| Some((channel, shown(channel)?)))
            .collect()
    }

    /// The runs of a part, with the channels of [`DataSet::measured`]. Inputs that were not
    /// recorded are zero.
    pub fn recordings(
        &self,
        part: Part,
        info: &ModelInfo,
    ) -> Result<Vec<Recording>, EstimateError> {
        let index = |channel: &Channel| {
            let mut columns = self.channels.iter().map(|other| &other.column);
            columns.position(|column| *column == channel.column)
        };
        let measured = self.measured(info);
        let measured: Vec<usize> = measured.iter().filter_map(|(c, _)| index(c)).collect();
        let input = |name: &str| {
            self.channels.iter().position(|channel| {
                let label = channel.role.label(&self.mechanism);
                matches!(channel.role, Role::Input(_)) && label.is_some_and(|l| l.name == name)
            })
        };
        let inputs = info.inputs.iter().take(info.declared_inputs);
        let inputs: Vec<Option<usize>> = inputs.map(|own| input(&own.name)).collect();
        let between = inputs.iter().map(|column| {
            let channel = column.map(|column| &self.channels[column]);
            channel.map_or(Interpolation::Hold, Channel::between_rows)
        });
        let between: Vec<Interpolation> = between.collect();
        let runs = self.runs.iter().filter(|run| run.part == part);
        runs.map(|run| {
            let rows = 0..run.times.len();
            let commanded = rows.clone().flat_map(|row| {
                let values = inputs.iter();
                values.map(move |column| column.map_or(0.0, |column| run.values[column][row]))
            });
            let commanded: Vec<f64> = commanded.collect();
            let seen = rows.flat_map(|row| measured.iter().map(move |&c| run.values[c][row]));
            let recording = Recording::new(run.times.clone(), commanded.clone(), seen.collect())?;
            let differences = run.differences.iter().filter_map(|difference| {
                Some((info.parameter_index(&difference.parameter)?, difference.by))
            });
            let recording = recording.with_differences(differences.collect());
            let listed = |rows: &[Row]| -> (Vec<f64>, Vec<f64>) {
                let values = rows.iter().flat_map(|row| {
                    let values = inputs.iter();
                    values.map(|column| column.map_or(0.0, |column| row.values[column]))
                });
                (rows.iter().map(|row| row.t).collect(), values.collect())
            };
            let (mut times, mut earlier) = listed(&run.earlier);
            let recording = recording.interpolated(&between)?.after(&times, &earlier);
            let between = (!run.between.is_empty()).then(|| listed(&run.between));
            let recording = match between.clone() {
                Some((times, inputs)) => recording.subsampled(times, inputs),
                None => recording,
            };
            if self.robot.is_none() {
                return Ok(recording);
            }
            let (own, values) = between.unwrap_or_else(|| (run.times.clone(), commanded));
            times.extend(own);
            earlier.extend(values);
            Ok(recording.with_outputs(self.reading == Reading::Mean, times, earlier))
        })
        .collect()
    }
}
