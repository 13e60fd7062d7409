//! The factors of a study: from the entries of `[vary]` and the table to distributions in SI.

use std::path::Path;

use appell_ensemble::design::{Design, DesignError, Factor, Sampling, Variation};
use appell_ensemble::digest::Digest;
use appell_ensemble::distribution::Distribution;
use appell_ensemble::limits::{MAX_ENTRIES, MAX_TABLE};
use appell_ensemble::rows::{Column, Role};
use appell_ensemble::study::{Correlation, FEEDBACK, MODEL, Text, Varied, Vary};
use appell_spec::units::Unit;
use appell_spec::{Code, did_you_mean, shown};

use super::reading::Reading;
use crate::Error;
use crate::setup::Setup;

/// Target of a factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Target {
    Parameter(usize),
    State(usize),
    /// Which of the specs.
    Model,
    /// Which of the laws.
    Feedback,
}

/// The targets of factors in a spec; unknown names are reported.
pub(super) fn targets(reading: &mut Reading<'_>, setup: &Setup<'_>, table: &Table) -> Vec<Target> {
    let study = reading.study;
    let mut targets = Vec::new();
    let vary = study.vary.iter().map(|vary| &vary.name);
    let file = study.table.as_ref();
    let columns = table.names.iter().map(|name| (name.as_str(), file));
    for (name, at) in vary
        .map(|name| (name.text.as_str(), Some(name)))
        .chain(columns)
    {
        let target = match name {
            MODEL => Some(Target::Model),
            FEEDBACK => Some(Target::Feedback),
            name => named(setup, name),
        };
        match (target, at) {
            (Some(target), _) => targets.push(target),
            (None, Some(at)) => unknown(reading, setup, name, at),
            (None, None) => {}
        }
    }
    targets
}

/// A parameter or a state of a spec.
pub(super) fn named(setup: &Setup<'_>, name: &str) -> Option<Target> {
    let name = setup.in_spec(name);
    let parameter = setup.info.parameter_index(name).map(Target::Parameter);
    parameter.or_else(|| setup.info.state_index(name).map(Target::State))
}

fn unknown(reading: &mut Reading<'_>, setup: &Setup<'_>, name: &str, at: &Text) {
    let info = setup.info;
    if info.input_index(setup.in_spec(name)).is_some() {
        let message = format!("`{name}` is an input, which is a function of time");
        let help = format!(
            "drive it under `[motion.input]`, such as `{name} = \"push\"`, and let a quantity of the study's own vary: \
             `push = {{ uniform = [1, 2], unit = \"…\" }}`"
        );
        reading.tell(Code::NotAllowedHere, message, at, &help);
        return;
    }
    let quantities = info.parameters.iter().chain(info.states.iter());
    let help = did_you_mean(name, quantities.map(|q| q.name.as_ref()), || {
        "a quantity of the study's own needs its `unit`".to_owned()
    });
    let message = format!("there is no parameter or state `{}`", shown(name));
    reading.tell(Code::UnknownName, message, at, &help);
}

/// Unit of a target.
fn unit(setup: &Setup<'_>, target: Target) -> Unit {
    match target {
        Target::Parameter(index) => setup.unit_of_parameter(index).clone(),
        Target::State(index) => setup.unit_of_state(index).clone(),
        Target::Model | Target::Feedback => none(),
    }
}

fn none() -> Unit {
    Unit::si(appell_spec::units::Dimension::NONE)
}

/// A table of factors.
#[derive(Debug, Default)]
pub(super) struct Table {
    pub(super) names: Vec<String>,
    /// In the units of the spec.
    pub(super) columns: Vec<Vec<f64>>,
    /// Hash of its bytes, part of the hash of the study.
    pub(super) hash: String,
}

impl Table {
    /// The optional table of a study; nothing if it is invalid, which is reported.
    pub(super) fn read(reading: &mut Reading<'_>, folder: &Path) -> Result<Self, Error> {
        let study = reading.study;
        let Some(name) = &study.table else {
            return Ok(Self::default());
        };
        let Some(path) = reading.file(folder, name) else {
            return Ok(Self::default());
        };
        let bytes = appell_files::read(&path, MAX_TABLE).map_err(Error::from);
        let columns = appell_recordings::columns(&path).map_err(Error::from);
        let bytes = reading.at(name, bytes)?;
        let Some(((names, columns), bytes)) = reading.at(name, columns)?.zip(bytes) else {
            return Ok(Self::default());
        };
        if columns.iter().any(Vec::is_empty) || names.is_empty() {
            reading.tell(Code::WrongType, "the table has no rows", name, "");
            return Ok(Self::default());
        }
        if names.len() > MAX_ENTRIES {
            let message = format!("the table has more than {MAX_ENTRIES} columns");
            reading.tell(Code::LimitExceeded, message, name, "");
            return Ok(Self::default());
        }
        for (column, values) in names.iter().zip(&columns) {
            if let Some(row) = values.iter().position(|value| !value.is_finite()) {
                let message = format!(
                    "the table has no finite number in row {} of column `{}`",
                    row + 1,
                    shown(column)
                );
                reading.tell(Code::NotFinite, message, name, "");
            }
        }
        let mut digest = Digest::default();
        digest.add(&bytes);
        Ok(Self {
            names,
            columns,
            hash: digest.text(),
        })
    }
}

/// The values of all cases, the columns of the factors, and the values of those that are chosen.
type Drawn = (Design, Vec<Column>, Vec<Vec<f64>>);

/// The values of all cases, with the columns of the factors.
pub(super) fn design(
    reading: &mut Reading<'_>,
    setup: &Setup<'_>,
    targets: &[Target],
    table: &Table,
) -> Option<Drawn> {
    let study = reading.study;
    let (mut factors, mut columns, mut choices) = (Vec::new(), Vec::new(), Vec::new());
    for (vary, &target) in study.vary.iter().zip(targets) {
        let Some((variation, items)) = variation(reading, setup, vary, target) else {
            continue;
        };
        factors.push(Factor {
            name: vary.name.text.clone(),
            variation,
        });
        columns.push(column(setup, vary, target));
        choices.push(items);
    }
    let rest = table.names.iter().zip(&table.columns);
    for ((name, values), &target) in rest.zip(&targets[study.vary.len().min(targets.len())..]) {
        let scale = unit(setup, target).scale;
        factors.push(Factor {
            name: name.clone(),
            variation: Variation::Table(values.iter().map(|v| v * scale).collect()),
        });
        columns.push(Column {
            name: name.clone(),
            ..quantity(setup, target, "")
        });
        choices.push(Vec::new());
    }
    twice(reading, &factors);
    let mut correlations = Vec::new();
    for Correlation { pair, value } in &study.correlations {
        let mut place = |name: &Text| {
            let place = factors.iter().position(|f| f.name == name.text);
            if place.is_none() {
                let help =
                    did_you_mean(&name.text, factors.iter().map(|f| f.name.as_str()), || {
                        "name two entries of `[vary]`".to_owned()
                    });
                let message = format!("`{}` does not vary", shown(&name.text));
                reading.tell(Code::UnknownName, message, name, &help);
            }
            place
        };
        if let [Some(a), Some(b)] = pair.each_ref().map(&mut place) {
            correlations.push((a, b, value.value));
        }
    }
    if !reading.findings.is_empty() {
        return None;
    }
    // Without factors only noise varies.
    let sampling = if factors.is_empty() {
        Sampling::Random
    } else {
        study.sampling.value
    };
    let design = Design::new(
        factors,
        sampling,
        study.count.value,
        study.seed,
        &correlations,
    );
    let error = match design {
        Ok(design) => return Some((design, columns, choices)),
        Err(error) => error,
    };
    let message = error.to_string();
    let mut correlation = study
        .correlations
        .iter()
        .map(|correlation| &correlation.value);
    match (&error, correlation.next_back()) {
        (DesignError::Correlations, Some(last)) => {
            let help = "the matrix of all correlations must be positive semidefinite";
            reading.tell(Code::ValueOutsideLimits, message, last, help);
        }
        (DesignError::NotDrawn { name }, Some(last)) => {
            let pairs = study.correlations.iter().flat_map(|c| &c.pair);
            match pairs.clone().find(|own| own.text == *name) {
                Some(own) => reading.tell(Code::ConflictingKeys, message, own, ""),
                None => reading.tell(Code::ConflictingKeys, message, last, ""),
            }
        }
        (DesignError::NotIndependent { .. } | DesignError::Dimensions { .. }, _) => {
            let help = "choose `sampling = \"random\"` or `\"latin\"`";
            reading.tell(Code::ConflictingKeys, message, &study.sampling, help);
        }
        _ => {
            let help = "ask for fewer cases, or take nodes off the grids";
            reading.tell(Code::LimitExceeded, message, &study.count, help);
        }
    }
    None
}

fn twice(reading: &mut Reading<'_>, factors: &[Factor]) {
    for (i, factor) in factors.iter().enumerate() {
        let is_same = |other: &Factor| other.name == factor.name;
        if let (true, Some(at)) = (factors[..i].iter().any(is_same), &reading.study.table) {
            let message = format!("`{}` stands twice in `[vary]` and the table", factor.name);
            reading.tell(Code::DuplicateName, message, at, "remove one of them");
        }
    }
}

fn quantity(setup: &Setup<'_>, target: Target, about: &str) -> Column {
    let quantity = match target {
        Target::Parameter(index) => Some(&setup.info.parameters[index]),
        Target::State(index) => Some(&setup.info.states[index]),
        Target::Model | Target::Feedback => None,
    };
    let own = quantity.map_or("", |q| q.about.as_ref());
    let at_start = if matches!(target, Target::State(_)) {
        " at the start"
    } else {
        ""
    };
    Column {
        name: String::new(),
        about: if about.is_empty() {
            format!("{own}{at_start}")
        } else {
            about.to_owned()
        },
        unit: quantity.map_or_else(String::new, |q| q.unit.to_string()),
        scale: quantity.map_or(1.0, |q| q.scale),
        role: Role::Factor(Vec::new()),
    }
}

fn column(setup: &Setup<'_>, vary: &Vary, target: Target) -> Column {
    let items = match (&vary.varied, target) {
        (Varied::Choice(items, _) | Varied::Grid(items), Target::Model | Target::Feedback) => {
            items.iter().map(|item| item.text.clone()).collect()
        }
        _ => Vec::new(),
    };
    Column {
        name: vary.name.text.clone(),
        role: Role::Factor(items),
        ..quantity(setup, target, &vary.about)
    }
}

/// Distribution of a factor, in SI; for a choice the numbers among which it chooses.
fn variation(
    reading: &mut Reading<'_>,
    setup: &Setup<'_>,
    vary: &Vary,
    target: Target,
) -> Option<(Variation, Vec<f64>)> {
    let unit = unit(setup, target);
    let chooses = matches!(target, Target::Model | Target::Feedback);
    let several = |reading: &mut Reading<'_>, texts: &[Text], units: &[&Unit]| {
        let values = texts.iter().zip(units);
        let values = values.map(|(text, unit)| reading.constant(setup, text, unit));
        values
            .collect::<Vec<_>>()
            .into_iter()
            .collect::<Option<Vec<f64>>>()
    };
    let (one, two) = (none(), [&unit, &unit]);
    let distribution = match &vary.varied {
        Varied::Scatter(part) => {
            let nominal = match target {
                Target::Parameter(index) => setup.parameters[index],
                Target::State(index) => setup.initial[index],
                Target::Model | Target::Feedback => 0.0,
            };
            let (text, part) = (part, reading.constant(setup, part, &one)?);
            reading.not_negative(text, part)?;
            Distribution::Normal([nominal, (nominal * part).abs()])
        }
        Varied::Normal(texts) => {
            let values = several(reading, texts, &two)?;
            reading.not_negative(&texts[1], values[1])?;
            Distribution::Normal([values[0], values[1]])
        }
        Varied::Uniform(texts) => {
            let values = several(reading, texts, &two)?;
            increasing(reading, texts, &values)?;
            Distribution::Uniform([values[0], values[1]])
        }
        Varied::Lognormal(texts) => {
            let values = several(reading, texts, &[&unit, &one])?;
            reading.not_negative(&texts[1], values[1])?;
            if values[0] <= 0.0 {
                let message = "the median of a lognormal distribution is positive";
                reading.tell(Code::ValueOutsideLimits, message, &texts[0], "");
                return None;
            }
            Distribution::Lognormal([values[0], values[1]])
        }
        Varied::Triangular(texts) => {
            let values = several(reading, texts, &[&unit, &unit, &unit])?;
            increasing(reading, texts, &values)?;
            Distribution::Triangular([values[0], values[1], values[2]])
        }
        Varied::Choice(items, weights) => {
            let values = if chooses {
                Vec::new()
            } else {
                several(reading, items, &vec![&unit; items.len()])?
            };
            let choice = Distribution::Choice(weights.clone());
            return Some((Variation::Drawn(choice), values));
        }
        Varied::Grid(items) if chooses => {
            let all = (0..items.len()).map(|item| item as f64).collect();
            return Some((Variation::Grid(all), Vec::new()));
        }
        Varied::Grid(items) => {
            let values = several(reading, items, &vec![&unit; items.len()])?;
            return Some((Variation::Grid(values), Vec::new()));
        }
        Varied::Range(ends, count) => {
            let values = several(reading, ends, &two)?;
            let last = count.saturating_sub(1).max(1) as f64;
            let value = |k: u64| values[0] + (values[1] - values[0]) * (k as f64 / last);
            return Some((
                Variation::Grid((0..*count).map(value).collect()),
                Vec::new(),
            ));
        }
    };
    let Some(ends) = &vary.truncate else {
        return Some((Variation::Drawn(distribution), Vec::new()));
    };
    let values = several(reading, ends, &two)?;
    increasing(reading, ends, &values)?;
    let truncated = Distribution::Truncated(Box::new(distribution), [values[0], values[1]]);
    if truncated.kept() < 1e-9 {
        let message = "next to nothing of the distribution lies between these ends";
        reading.tell(Code::EmptyRange, message, &ends[0], "");
        return None;
    }
    Some((Variation::Drawn(truncated), Vec::new()))
}

fn increasing(reading: &mut Reading<'_>, texts: &[Text], values: &[f64]) -> Option<()> {
    let last = values.len() - 1;
    if values.windows(2).any(|w| w[0] > w[1]) || values[0] >= values[last] {
        let message = "the ends must increase";
        reading.tell(Code::EmptyRange, message, &texts[0], "");
        return None;
    }
    Some(())
}
