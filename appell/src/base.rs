//! Base parameters: the identifiable combinations of inertial and load parameters, and their estimates.

use std::fmt::Write as _;

use appell_codegen::mechanics::Regressor;
use appell_gap::base;
use appell_recordings::DataSet;
use appell_report::row;
use appell_report::text::{number, table};
use serde_json::{Value, json};

pub use appell_gap::base::{BaseError, Combination, Estimate, Fit, Speed, Structure};

use crate::{Error, Model, Source, recording};

/// The base parameters of a mechanism.
#[derive(Debug, Clone)]
pub struct BaseParameters {
    /// Name of the mechanism.
    pub mechanism: String,
    /// The structure: base parameters and their combinations.
    pub structure: Structure,
    /// Estimates from recordings, if any were given.
    pub fit: Option<Fit>,
}

impl Source {
    /// Inverse dynamics as a linear function of inertial and load parameters.
    pub fn regressor(&self) -> Result<Regressor, Error> {
        Ok(appell_codegen::compile::regressor(&self.file, &self.text)?)
    }
}

impl Model {
    /// The combinations of parameters on which forces depend at all; with recordings of motions and of all inputs
    /// their values by least squares.
    ///
    /// ```
    /// let model = appell::Model::shipped("pendulum")?;
    /// let found = model.base_parameters(None)?;
    /// // The mass of a pendulum counts through its moments about the pivot only.
    /// assert_eq!(found.structure.base.len(), 3);
    /// # Ok::<(), appell::Error>(())
    /// ```
    pub fn base_parameters(&self, set: Option<&DataSet>) -> Result<BaseParameters, Error> {
        let regressor = self.source().regressor()?;
        let equations = self.equations();
        let p = match set {
            Some(set) => set.parameters.iter().map(|own| own.value).collect(),
            None => self.info().default_parameters(),
        };
        let structure = base::structure(equations, &regressor, &p)?;
        let fit = match set {
            Some(set) => {
                recording::check(set)?;
                Some(base::fit(set, equations, &regressor, &structure)?)
            }
            None => None,
        };
        Ok(BaseParameters {
            mechanism: self.info().name.to_string(),
            structure,
            fit,
        })
    }
}

impl BaseParameters {
    /// As JSON, in SI.
    pub fn to_json(&self) -> Value {
        let structure = &self.structure;
        let parameters = structure.parameters.iter().zip(&structure.values);
        let parameters = parameters
            .map(|(own, value)| json!({ "name": own.name, "unit": own.unit, "value": value }));
        let mut estimates = self.fit.iter().flat_map(|fit| &fit.estimates);
        let base = structure.base.iter().map(|combination| {
            let leading = &structure.parameters[combination.leading];
            let others = combination.others.iter().map(|&(other, factor)| {
                json!({ "name": structure.parameters[other].name, "factor": factor })
            });
            let mut value = json!({
                "name": leading.name, "unit": leading.unit, "text": structure.text(combination),
                "others": others.collect::<Vec<_>>(), "nominal": combination.nominal,
            });
            if let Some(found) = estimates.next() {
                value["value"] = json!(found.value);
                value["std"] = json!(found.std);
                value["interval95"] = json!(found.interval95);
            }
            value
        });
        let mut value = json!({
            "schema": "base/1",
            "mechanism": self.mechanism,
            "parameters": parameters.collect::<Vec<_>>(),
            "base": base.collect::<Vec<_>>(),
            "without_effect": structure.without_effect,
        });
        if let Some(fit) = &self.fit {
            value["motions"] = json!(fit.motions);
            value["condition"] = json!(fit.condition);
            value["training"] = json!(fit.training);
            value["test"] = json!(fit.test);
        }
        value
    }

    /// As text tables.
    pub fn to_text(&self) -> String {
        let structure = &self.structure;
        let mut text = format!(
            "{} of {} parameters or combinations of them are identifiable from motions and forces\n\n",
            structure.base.len(),
            structure.parameters.len() + structure.without_effect.len(),
        );
        text += &match &self.fit {
            None => self.structure_table(),
            Some(fit) => self.fit_table(fit),
        };
        if !structure.without_effect.is_empty() {
            let _ = write!(
                text,
                "\nno motion notices {}\n",
                structure.without_effect.join(", ")
            );
        }
        if let Some(fit) = &self.fit {
            let _ = write!(
                text,
                "\n{} motions, condition number {}; 95 % intervals\n",
                fit.motions,
                number(fit.condition)
            );
            for (title, speeds) in [("training runs", &fit.training), ("test runs", &fit.test)] {
                if !speeds.is_empty() {
                    let _ = write!(
                        text,
                        "\nforces in {title}, root mean squares in SI\n{}",
                        speed_table(speeds)
                    );
                }
            }
        }
        text
    }

    fn structure_table(&self) -> String {
        let mut rows = vec![row!["parameter", "by the spec", "unit", "with"]];
        for combination in &self.structure.base {
            let leading = &self.structure.parameters[combination.leading];
            let (nominal, others) = (combination.nominal, self.structure.others(combination));
            rows.push(row![leading.name, number(nominal), leading.unit, others]);
        }
        table(&rows, 1..2)
    }

    fn fit_table(&self, fit: &Fit) -> String {
        let mut rows = vec![row![
            "parameter",
            "by the spec",
            "found",
            "from",
            "to",
            "unit",
            "",
            "with"
        ]];
        for (combination, estimate) in self.structure.base.iter().zip(&fit.estimates) {
            let [low, high] = estimate.interval95;
            let remark = match combination.nominal {
                _ if !estimate.is_told() => "not significantly different from zero",
                nominal if nominal < low || nominal > high => "differs from the spec",
                _ => "",
            };
            let leading = &self.structure.parameters[combination.leading];
            let numbers = [combination.nominal, estimate.value, low, high].map(number);
            let others = self.structure.others(combination);
            let mut row = row![leading.name];
            row.extend(numbers);
            row.extend(row![leading.unit, remark, others]);
            rows.push(row);
        }
        table(&rows, 1..5)
    }
}

fn speed_table(speeds: &[Speed]) -> String {
    let mut rows = vec![row![
        "along",
        "of the inputs",
        "left by the spec",
        "left by the estimates"
    ]];
    for speed in speeds {
        let [inputs, nominal, left] = [speed.inputs, speed.nominal, speed.left].map(number);
        rows.push(row![speed.name, inputs, nominal, left]);
    }
    table(&rows, 1..4)
}
