//! Inputs from a file, each value held until the next row or joined to the next by a line.

use std::io::BufRead;
use std::path::Path;

use appell_recordings::between::Smooth;
use appell_recordings::csv::Rows;
use appell_recordings::limits::MAX_MISTAKES;
use appell_recordings::{DataError, DataSet, MANIFEST, Measured, Role, Run};
use appell_report::recording::differences;
use appell_runtime::Signal;
use appell_runtime::inputs::TabulatedInputs;
use appell_runtime::model::{Interpolation, Model, Quantity, SignalTable};
use appell_runtime::trajectory::{self, Extras};
use appell_spec::expr::Span;
use appell_spec::mechanism::InputId;
use appell_spec::{Code, shown};

use crate::setup::{Setup, unknown};
use crate::source::Source;
use crate::{Error, Field, files, recording};

/// Remarks on the inputs of a motion.
#[derive(Debug, Clone, Default)]
pub struct Remarks {
    /// Whether neither inputs nor feedback drive the mechanism.
    pub undriven: bool,
    /// The time in s from which the last values of recorded inputs are held, if it comes before the end.
    pub held_from: Option<f64>,
    /// A remark on recorded inputs that are held by default.
    pub smooth: Option<String>,
    /// Coordinates in the first row of a recorded run whose inputs drive the motion, if it begins elsewhere.
    pub begins: Option<String>,
    /// What differs in that run from the other runs, and so from the model, a sentence for each parameter.
    pub differs: Vec<String>,
}

/// Inputs of a file.
pub struct Table {
    /// Values over time; inputs that are not given are zero.
    pub values: TabulatedInputs,
    /// Indices of those that are given.
    pub given: Vec<usize>,
    /// What there is to say about them; the last values are held from the last time on.
    pub remarks: Remarks,
}

/// The inputs of a CSV file, for a motion until a time in s.
///
/// The header names `t` in s and inputs in the units of the spec; columns of the mechanism's other
/// quantities are ignored, so that a written trajectory can be fed back. Rows are held if `interpolation` is not given.
/// A `recording.toml` with the name of a run defines names, units and interpolation itself.
pub fn read(
    path: &Path,
    name: &str,
    setup: &Setup<'_>,
    model: &dyn Model,
    until: f64,
    interpolation: Option<Interpolation>,
) -> Result<Table, Error> {
    let file = path.to_string_lossy();
    let described = described(&file);
    let columns = match described {
        Some(_) if interpolation.is_some() => {
            let message = "a data set says itself how its inputs run from row to row: write `interpolation` in the line of the channel";
            return Err(Error::request(Field::Interpolation, message));
        }
        Some((description, run)) => recorded(description, run, name, setup)?,
        None => tabulated(
            path,
            setup,
            model,
            interpolation.unwrap_or(Interpolation::Hold),
        )?,
    };
    let is_stated = described.is_some() || interpolation.is_some();
    let [from, to] =
        [columns.times.first(), columns.times.last()].map(|end| end.copied().unwrap_or(0.0));
    if from > until {
        let message = format!(
            "the inputs begin at {from} s, and the motion ends at {until} s: let the times of the file begin with the motion"
        );
        return Err(Error::data(file, message));
    }
    let names = setup.declared_inputs();
    let smooth = columns.inputs.iter().filter(|_| !is_stated);
    let smooth = smooth.filter_map(|column| {
        let late = Smooth::of([column.values.as_slice()].into_iter())?.held;
        Some(format!(
            "`{}` by {:.2} %",
            names[column.input].name,
            100.0 * late
        ))
    });
    let smooth = are_smooth(&smooth.collect::<Vec<_>>());
    let mut signals = Vec::new();
    for (input, quantity) in names.iter().enumerate() {
        let column = columns.inputs.iter().find(|column| column.input == input);
        let (times, values, interpolation) = match column {
            Some(own) => (columns.times.clone(), own.values.clone(), own.interpolation),
            None => (vec![0.0], vec![0.0], Interpolation::Hold),
        };
        let table = SignalTable {
            name: quantity.name.clone(),
            times: times.into(),
            values: values.into(),
            interpolation,
        };
        let signal = Signal::new(&table).map_err(|error| Error::data(&file, error.to_string()))?;
        signals.push(signal);
    }
    Ok(Table {
        values: TabulatedInputs::new(signals),
        given: columns.inputs.iter().map(|column| column.input).collect(),
        remarks: Remarks {
            held_from: Some(to),
            smooth,
            ..columns.remarks
        },
    })
}

/// A remark on inputs that seem to be sampled from a continuous signal, each with the relative error of holding it.
fn are_smooth(inputs: &[String]) -> Option<String> {
    (!inputs.is_empty()).then(|| {
        format!(
            "inputs change smoothly from row to row, and each row is held to the next: if they were sampled from a \
             continuous signal, they act half a row late ({} of their size); write `linear` or `hold`",
            inputs.join(", ")
        )
    })
}

/// The description and the run in `rig/recording.toml:run1.csv`.
fn described(text: &str) -> Option<(&str, &str)> {
    let end = text.rfind(MANIFEST)? + MANIFEST.len();
    let (description, run) = text.split_at(end);
    let run = run.strip_prefix(':').or(run.is_empty().then_some(""))?;
    Path::new(description)
        .ends_with(MANIFEST)
        .then_some((description, run))
}

/// The inputs of a run of a data set.
fn recorded(description: &str, run: &str, name: &str, setup: &Setup<'_>) -> Result<Columns, Error> {
    // The spec may be in no file; a description of a robot has the names of its file.
    let text = setup.robot.map_or(setup.spec, |robot| &robot.text);
    let mut set = recording::read_with(&[description.into()], Some(&Source::of(name, text)))?;
    recording::check_units(&set)?;
    let Some(place) = set.runs.iter().position(|own| own.name == run) else {
        let names: Vec<&str> = set.runs.iter().map(|own| own.name.as_str()).collect();
        let missing = if run.is_empty() {
            format!("{description} needs a run")
        } else {
            format!("{description} has no run `{run}`")
        };
        let message = format!("{missing}; append one of {}", names.join(", "));
        return Err(Error::request(Field::Recorded, message));
    };
    let remarks = Remarks {
        begins: begins(&set, &set.runs[place], setup),
        differs: differences(&set, &set.runs[place]),
        ..Remarks::default()
    };
    let run = set.runs.swap_remove(place);
    let mut inputs: Vec<Column> = Vec::new();
    for (channel, values) in set.channels.iter().zip(run.values) {
        if let Role::Input(input) = channel.role
            && inputs.iter().all(|column| column.input != input)
        {
            inputs.push(Column {
                position: 0,
                input,
                scale: 1.0,
                interpolation: channel.between_rows(),
                values,
            });
        }
    }
    if inputs.is_empty() {
        let message = "no channel is an input; write `input = \"…\"` in `[channels]`";
        return Err(Error::data(description, message));
    }
    // Time is counted from the start of the run, whatever the logger's clock.
    let start = run.times.first().copied().unwrap_or(0.0);
    let times = run.times.iter().map(|t| t - start).collect();
    Ok(Columns {
        times,
        inputs,
        remarks,
    })
}

/// The inputs of a CSV file.
fn tabulated(
    path: &Path,
    setup: &Setup<'_>,
    model: &dyn Model,
    interpolation: Interpolation,
) -> Result<Columns, Error> {
    let text = files::read(path, files::MAX_DATA)?;
    let reader = Reader {
        rows: Rows::new(path, text.as_bytes())?,
        recorded: trajectory::recorded(model, Extras::ALL),
        interpolation,
        mistakes: Vec::new(),
    };
    Ok(reader.columns(setup)?)
}

struct Columns {
    times: Vec<f64>,
    inputs: Vec<Column>,
    remarks: Remarks,
}

/// `hip = 0.347 rad, knee = -0.783 rad`: measured coordinates in the first row of a run, if the motion begins elsewhere.
fn begins(set: &DataSet, run: &Run, setup: &Setup<'_>) -> Option<String> {
    /// Difference, relative to the motion, from which on the start is another one.
    const ELSEWHERE: f64 = 0.1;
    let mut is_elsewhere = false;
    let mut places = Vec::new();
    for (channel, values) in set.channels.iter().zip(&run.values) {
        let Role::Measures(Measured::Coordinate(coordinate)) = channel.role else {
            continue;
        };
        let Some(first) = values.iter().copied().find(|value| value.is_finite()) else {
            continue;
        };
        let state = setup.info.speeds + coordinate;
        let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        is_elsewhere |= (first - setup.initial[state]).abs() > ELSEWHERE * (most - least);
        let quantity = &setup.info.states[state];
        let value = format!("{:.3e}", first / quantity.scale).parse::<f64>();
        places.push(format!(
            "{} = {} {}",
            quantity.name,
            value.unwrap_or(first),
            quantity.unit
        ));
    }
    is_elsewhere.then(|| places.join(", "))
}

/// A column of an input.
struct Column {
    position: usize,
    input: usize,
    /// Factor from the unit of the input to SI.
    scale: f64,
    interpolation: Interpolation,
    /// In SI.
    values: Vec<f64>,
}

struct Reader<R> {
    rows: Rows<R>,
    /// The columns that a written trajectory may have.
    recorded: Vec<Quantity>,
    interpolation: Interpolation,
    mistakes: Vec<DataError>,
}

impl<R: BufRead> Reader<R> {
    fn tell(&mut self, code: Code, message: impl Into<String>, at: Span, help: Option<&str>) {
        let help = help.map(str::to_owned);
        self.mistakes
            .push(self.rows.mistake(code, message, at, help));
    }

    fn columns(mut self, setup: &Setup<'_>) -> Result<Columns, DataError> {
        let (time, inputs) = self.header(setup);
        let mut columns = Columns {
            times: Vec::new(),
            inputs,
            remarks: Remarks::default(),
        };
        let Some(time) = time else {
            let help = "name the column of times in seconds `t`";
            self.tell(Code::MissingKey, "there is no column `t`", 0..0, Some(help));
            return Err(DataError::several(self.mistakes));
        };
        while self.mistakes.len() < MAX_MISTAKES && self.rows.advance()? {
            if let Some(uneven) = self.rows.uneven() {
                self.mistakes.push(uneven);
                continue;
            }
            let t = self.number(time);
            for column in &mut columns.inputs {
                let value = self.number(column.position);
                column.values.push(value * column.scale);
            }
            if columns.times.last().is_some_and(|last| *last >= t) {
                let message = "the time does not increase";
                self.tell(Code::SignalTable, message, self.rows.line(), None);
            }
            columns.times.push(t);
        }
        if columns.times.is_empty() && self.mistakes.is_empty() {
            self.tell(Code::SignalTable, "there are no rows", 0..0, None);
        }
        if self.mistakes.is_empty() {
            Ok(columns)
        } else {
            Err(DataError::several(self.mistakes))
        }
    }

    /// Position of the column of times, and the columns of inputs.
    fn header(&mut self, setup: &Setup<'_>) -> (Option<usize>, Vec<Column>) {
        let inputs = &setup.mechanism.inputs;
        let names = || inputs.iter().map(|input| input.label.name.as_str());
        let mut time = None;
        let mut columns: Vec<Column> = Vec::new();
        for (position, name) in self.rows.header().to_vec().iter().enumerate() {
            let at = self.rows.place(position);
            let input = names().position(|input| input == name);
            let twice = match input {
                Some(input) => columns.iter().any(|column| column.input == input),
                None => name == "t" && time.is_some(),
            };
            if twice {
                let message = format!("the column `{name}` is given twice");
                self.tell(Code::DuplicateName, message, at, None);
            } else if let Some(input) = input {
                columns.push(Column {
                    position,
                    input,
                    scale: inputs[InputId::new(input)].label.unit.scale,
                    interpolation: self.interpolation,
                    values: Vec::new(),
                });
            } else if name == "t" {
                time = Some(position);
            } else if self.recorded.iter().all(|column| column.name != *name) {
                let message = unknown(name, "input", names());
                self.tell(Code::UnknownName, message, at, None);
            }
        }
        (time, columns)
    }

    /// The finite number in a cell; reports any other.
    fn number(&mut self, column: usize) -> f64 {
        let cell = self.rows.cell(column);
        if let Some(number) = cell.parse::<f64>().ok().filter(|number| number.is_finite()) {
            return number;
        }
        let message = format!("`{}` is not a finite number", shown(cell));
        let help = "an input needs a value in every row";
        let at = self.rows.place(column);
        self.tell(Code::WrongType, message, at, Some(help));
        0.0
    }
}
