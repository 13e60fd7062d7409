//! Input-free identification of parameters, and recovered inputs, from recorded motions.
//!
//! The input-free relations hold for any inputs; see [`appell_estimate::inverse`]. Training runs
//! are used; their coordinates have to be measured.

use appell_estimate::inverse::{
    Consistency, Found, InverseError, Record, Relations, Sought, Track,
};
use appell_runtime::model::{Model, Quantity};
use nalgebra::{DMatrix, DVector};

use appell_recordings::{DataSet, Measured, Part, Role};

/// Values of a profile on each side of the nominal one.
const PROFILE: i32 = 12;
/// Ratio of consecutive values of a profile.
const FACTOR: f64 = 1.12;

/// The sought values.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Parameters by name.
    pub free: Vec<String>,
    /// Columns whose bias is unknown.
    pub biased: Vec<String>,
}

/// Why the identification failed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RelationError {
    /// No such parameter.
    #[error("the spec has no parameter `{name}`; there are {known}")]
    UnknownParameter {
        /// The requested name.
        name: String,
        /// Available names.
        known: String,
    },
    /// No such column of a coordinate.
    #[error("no column `{name}` measures a coordinate; there are {known}")]
    UnknownColumn {
        /// The requested name.
        name: String,
        /// Available names.
        known: String,
    },
    /// The computation failed.
    #[error(transparent)]
    Inverse(#[from] InverseError),
}

/// A sought value.
#[derive(Debug, Clone)]
pub struct Estimate {
    /// A parameter, or the coordinate whose column is biased.
    pub quantity: Quantity,
    /// Whether it is the bias of a column.
    pub is_bias: bool,
    /// Nominal value in SI.
    pub nominal: f64,
    /// Value in SI.
    pub value: f64,
    /// Standard deviation from the noise.
    pub std: f64,
    /// Robust standard deviation, from stretches of the recordings.
    pub robust_std: f64,
    /// 95 % interval; infinite at an unbounded end.
    pub interval95: [f64; 2],
    /// Profile: values, and the increase of the inconsistency with all others fitted; parameters only.
    pub profile: Vec<[f64; 2]>,
}

impl Estimate {
    /// Whether the motions bound the value on both sides.
    pub fn is_bounded(&self) -> bool {
        self.interval95.iter().all(|end| end.is_finite())
    }
}

/// The inputs of a run.
#[derive(Debug, Clone)]
pub struct Inputs {
    /// Name of the run.
    pub run: String,
    /// Times in s.
    pub times: Vec<f64>,
    /// For each declared input its values in SI.
    pub values: Vec<Vec<f64>>,
    /// Their standard deviations.
    pub stds: Vec<Vec<f64>>,
}

/// Result of the input-free identification.
#[derive(Debug, Clone)]
pub struct Answer {
    /// The sought values.
    pub estimates: Vec<Estimate>,
    /// Result of the search; `None` if no value was sought.
    pub found: Option<Found>,
    /// Number of input-free relations at each time.
    pub relations: usize,
    /// Mean square of the whitened relations at the estimates.
    pub normalised_square: f64,
    /// Spacing of the knots of the splines in s.
    pub spacing: f64,
    /// Measured columns with their noise in SI.
    pub noise: Vec<(String, f64)>,
    /// Correlation of the noise of the columns.
    pub correlation: DMatrix<f64>,
    /// The inputs of each run.
    pub inputs: Vec<Inputs>,
}

/// Estimates the sought values and the inputs.
pub fn find(set: &DataSet, model: &dyn Model, options: &Options) -> Result<Answer, RelationError> {
    let info = model.info();
    let columns = coordinates(set);
    let sought = sought(set, model, &columns, options)?;
    let runs = set.runs.iter().filter(|run| run.part == Part::Fit);
    let records: Vec<Record> = runs
        .clone()
        .map(|run| {
            let values = columns.iter();
            let values = values.map(|(column, _)| DVector::from_column_slice(&run.values[*column]));
            Record {
                times: run.times.clone(),
                values: DMatrix::from_columns(&values.collect::<Vec<_>>()),
            }
        })
        .collect();
    let track = Track::of(&records)?;
    let p: Vec<f64> = set.parameters.iter().map(|own| own.value).collect();
    let measured: Vec<usize> = columns.iter().map(|(_, coordinate)| *coordinate).collect();
    let relations = Relations::new(model, &measured, &track.stretches[0].motions[0], &p)?;
    let count = relations.len();
    let consistency = Consistency::new(relations, track, p, sought)?;
    let (found, values, normalised_square) = if consistency.sought().is_empty() {
        let values = consistency.nominal();
        let here = consistency.at(&values)?;
        (None, values, 2.0 * here.cost / here.count.max(1) as f64)
    } else {
        let found = consistency.find()?;
        let (values, square) = (found.values.clone(), found.normalised_square());
        (Some(found), values, square)
    };
    let track = consistency.track();
    let std = |k: usize| track.noise[(k, k)].sqrt();
    let estimate = |(index, sought): (usize, &Sought)| {
        let found = found.as_ref()?;
        Some(estimate(&consistency, found, index, *sought, info))
    };
    let estimates = consistency.sought().iter().enumerate().filter_map(estimate);
    let estimates = estimates.collect::<Result<_, InverseError>>()?;
    let inputs = runs.enumerate().map(|(number, run)| {
        let none = vec![Vec::new(); info.declared_inputs];
        let mut inputs = Inputs {
            run: run.name.clone(),
            times: Vec::new(),
            values: none.clone(),
            stds: none,
        };
        inputs.add(&consistency, &values, found.as_ref(), number)?;
        Ok(inputs)
    });
    Ok(Answer {
        estimates,
        relations: count,
        normalised_square,
        spacing: track.spacing,
        noise: (columns.iter().enumerate())
            .map(|(k, (column, _))| (set.channels[*column].column.clone(), std(k)))
            .collect(),
        correlation: DMatrix::from_fn(measured.len(), measured.len(), |i, j| {
            track.noise[(i, j)] / (std(i) * std(j))
        }),
        inputs: inputs.collect::<Result<_, InverseError>>()?,
        found,
    })
}

/// Columns that measure coordinates, with the coordinates.
pub(crate) fn coordinates(set: &DataSet) -> Vec<(usize, usize)> {
    let columns = set.channels.iter().enumerate();
    columns
        .filter_map(|(column, channel)| match channel.role {
            Role::Measures(Measured::Coordinate(coordinate)) => Some((column, coordinate)),
            _ => None,
        })
        .collect()
}

fn sought(
    set: &DataSet,
    model: &dyn Model,
    columns: &[(usize, usize)],
    options: &Options,
) -> Result<Vec<Sought>, RelationError> {
    let info = model.info();
    let name = |(column, _): &(usize, usize)| set.channels[*column].column.as_str();
    let parameter = |wanted: &String| {
        let index = info.parameter_index(wanted).map(Sought::Parameter);
        index.ok_or_else(|| RelationError::UnknownParameter {
            name: wanted.clone(),
            known: listed(info.parameters.iter().map(|own| own.name.as_ref())),
        })
    };
    let bias = |wanted: &String| {
        let place = columns.iter().position(|own| name(own) == wanted);
        let place = place.map(Sought::Bias);
        place.ok_or_else(|| RelationError::UnknownColumn {
            name: wanted.clone(),
            known: listed(columns.iter().map(name)),
        })
    };
    let parameters = options.free.iter().map(parameter);
    parameters.chain(options.biased.iter().map(bias)).collect()
}

fn listed<'n>(names: impl Iterator<Item = &'n str>) -> String {
    let names: Vec<&str> = names.collect();
    if names.is_empty() {
        return "none".to_owned();
    }
    names.join(", ")
}

fn estimate(
    consistency: &Consistency<'_>,
    found: &Found,
    index: usize,
    sought: Sought,
    info: &appell_runtime::model::ModelInfo,
) -> Result<Estimate, InverseError> {
    let nominal = consistency.nominal()[index];
    let (quantity, is_bias) = match sought {
        Sought::Parameter(parameter) => (info.parameters[parameter].clone(), false),
        Sought::Bias(measured) => {
            let coordinate = consistency.relations().measured()[measured];
            (info.coordinate_quantities()[coordinate].clone(), true)
        }
    };
    let profile = if is_bias {
        Vec::new()
    } else {
        let at: Vec<f64> = (-PROFILE..=PROFILE)
            .map(|step| found.values[index] * FACTOR.powi(step))
            .collect();
        let costs = consistency.profile(index, &at)?;
        at.iter()
            .zip(costs)
            .map(|(&at, cost)| [at, cost - found.cost])
            .collect()
    };
    Ok(Estimate {
        quantity,
        is_bias,
        nominal,
        value: found.values[index],
        std: found.covariance[(index, index)].sqrt(),
        robust_std: found.robust[(index, index)].sqrt(),
        interval95: found.intervals[index],
        profile,
    })
}

impl Inputs {
    /// Adds the inputs of a run with their band: noise of the motion, and uncertainty of the values.
    fn add(
        &mut self,
        consistency: &Consistency<'_>,
        values: &DVector<f64>,
        found: Option<&Found>,
        run: usize,
    ) -> Result<(), InverseError> {
        let (relations, track) = (consistency.relations(), consistency.track());
        let stretches = track.stretches.iter();
        for stretch in stretches.filter(|stretch| stretch.run == run) {
            for (place, motion) in stretch.motions.iter().enumerate() {
                let spread = track.spread(stretch, place);
                let at = |values: &DVector<f64>| {
                    let motion = consistency.corrected(motion, values);
                    relations.inputs(&motion, &consistency.parameters(values), &spread)
                };
                let (mean, mut covariance) = at(values)?;
                if let Some(found) = found {
                    let mut slopes = DMatrix::zeros(mean.len(), values.len());
                    for index in 0..values.len() {
                        let std = found.covariance[(index, index)].sqrt();
                        let mut varied = values.clone();
                        varied[index] += std;
                        slopes.set_column(index, &((at(&varied)?.0 - &mean) / std));
                    }
                    covariance += &slopes * &found.covariance * slopes.transpose();
                }
                self.times.push(motion.t);
                for (input, values) in self.values.iter_mut().enumerate() {
                    values.push(mean[input]);
                    self.stds[input].push(covariance[(input, input)].sqrt());
                }
            }
        }
        Ok(())
    }
}
