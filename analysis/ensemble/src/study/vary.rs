//! `[vary]` and `[noise]`: factors with their distributions, and noise over time.

use appell_spec::Code;
use toml::de::DeTable;

use super::read::{Placed, Reader, Text};
use crate::limits::{MAX_VALUES, MAX_VARIANTS};

/// Entries of `[vary]` that choose between specs and between laws.
pub const MODEL: &str = "model";
/// See [`MODEL`].
pub const FEEDBACK: &str = "feedback";

/// An entry of `[vary]`.
#[derive(Debug, Clone, PartialEq)]
pub struct Vary {
    /// A parameter or a state of the spec, a quantity defined by the study, or [`MODEL`] or [`FEEDBACK`].
    pub name: Text,
    /// How it varies.
    pub varied: Varied,
    /// Truncation limits of the distribution.
    pub truncate: Option<[Text; 2]>,
    /// Unit of a quantity defined by the study.
    pub unit: Option<Text>,
    /// A sentence; may be empty.
    pub about: String,
}

/// How a quantity varies.
#[derive(Debug, Clone, PartialEq)]
pub enum Varied {
    /// Normal about the value of the spec, with this part of it as standard deviation.
    Scatter(Text),
    /// Mean, standard deviation.
    Normal([Text; 2]),
    /// Ends.
    Uniform([Text; 2]),
    /// Median, standard deviation of the logarithm.
    Lognormal([Text; 2]),
    /// Lower end, mode, upper end.
    Triangular([Text; 3]),
    /// One of these, with weights.
    Choice(Vec<Text>, Vec<f64>),
    /// All of these.
    Grid(Vec<Text>),
    /// As many values as this between two ends.
    Range([Text; 2], u64),
}

impl Varied {
    /// Whether all values are taken instead of a draw.
    pub fn is_grid(&self) -> bool {
        matches!(self, Self::Grid(_) | Self::Range(..))
    }
}

/// Noise over time: independent normal numbers, each held for an interval.
#[derive(Debug, Clone, PartialEq)]
pub struct Noise {
    /// A state, which laws and inputs then measure with the noise, or a quantity defined by the study.
    pub name: Text,
    /// Standard deviation.
    pub deviation: Text,
    /// Hold interval, in s.
    pub every: Placed<f64>,
    /// Unit of a quantity defined by the study.
    pub unit: Option<Text>,
}

const FORMS: [&str; 8] = [
    "scatter",
    "normal",
    "uniform",
    "lognormal",
    "triangular",
    "choice",
    "grid",
    "range",
];
const OTHERS: [&str; 5] = ["count", "weights", "truncate", "unit", "about"];

pub(super) fn read(read: &mut Reader<'_>, table: &DeTable<'_>) -> Vec<Vary> {
    let mut all = Vec::new();
    for (name, value) in read.items(table, "vary") {
        let Some(entry) = read.table(value, "a table such as { normal = [5, 0.2] }") else {
            continue;
        };
        read.fields.only(entry, &[&FORMS[..], &OTHERS].concat());
        let unit = read.text(entry, "unit");
        let about = read.sentence(entry, "about");
        let truncate = entry.get("truncate").and_then(|value| pair(read, value));
        if let Some(varied) = form(read, entry, &name) {
            if truncate.is_some() && (varied.is_grid() || matches!(varied, Varied::Choice(..))) {
                let message = "a list is not truncated";
                let at = entry.get("truncate").map_or(0..0, toml::Spanned::span);
                read.tell(Code::ConflictingKeys, message, at, "leave `truncate` out");
            }
            all.push(Vary {
                name,
                varied,
                truncate,
                unit,
                about,
            });
        }
    }
    all
}

fn form(read: &mut Reader<'_>, entry: &DeTable<'_>, name: &Text) -> Option<Varied> {
    let wrong = ["does not say how it varies", "varies in two ways"];
    let form = read.only_one(name, entry, [&FORMS, &OTHERS], wrong)?;
    let value = entry.get(form)?;
    let chooses = [MODEL, FEEDBACK].contains(&name.text.as_str());
    if chooses && !matches!(form, "choice" | "grid") {
        let message = format!("`{}` is one of several files", name.text);
        let help = "write `choice = [\"one.toml\", \"other.toml\"]`, or `grid` for each of them";
        read.tell(Code::UnknownWord, message, value.span(), help);
        return None;
    }
    if chooses && let Some(file) = value.get_ref().as_array().and_then(|l| l.get(MAX_VARIANTS)) {
        let message = format!("more than {MAX_VARIANTS} files to choose from");
        read.tell(Code::LimitExceeded, message, file.span(), "remove some");
        return None;
    }
    for (key, of) in [("count", "range"), ("weights", "choice")] {
        if let Some(value) = entry.get(key).filter(|_| form != of) {
            let message = format!("`{key}` belongs to `{of}`");
            let help = format!("leave `{key}` out");
            read.tell(Code::ConflictingKeys, message, value.span(), &help);
        }
    }
    Some(match form {
        "scatter" => Varied::Scatter(read.value(value)?),
        "normal" => Varied::Normal(pair(read, value)?),
        "uniform" => Varied::Uniform(pair(read, value)?),
        "lognormal" => Varied::Lognormal(pair(read, value)?),
        "triangular" => Varied::Triangular(read.values(value, Some(3))?.try_into().ok()?),
        "choice" => {
            let items = read.values(value, None)?;
            let weights = weights(read, entry, items.len())?;
            Varied::Choice(items, weights)
        }
        "grid" => Varied::Grid(read.values(value, None)?),
        _ => {
            let ends = pair(read, value)?;
            if entry.get("count").is_none() {
                let help = "write how many values, such as `count = 11`";
                let message = "a range needs `count`";
                read.tell(Code::MissingKey, message, value.span(), help);
            }
            Varied::Range(ends, read.count(entry, "count", MAX_VALUES)?.value)
        }
    })
}

fn pair(read: &mut Reader<'_>, value: &appell_recordings::fields::Value<'_>) -> Option<[Text; 2]> {
    read.values(value, Some(2))?.try_into().ok()
}

/// Weights of choices, by default equal ones.
fn weights(read: &mut Reader<'_>, entry: &DeTable<'_>, count: usize) -> Option<Vec<f64>> {
    let Some(value) = entry.get("weights") else {
        return Some(vec![1.0; count]);
    };
    let texts = read.values(value, Some(count))?;
    let numbers = texts.iter().map(|text| text.text.parse::<f64>().ok());
    let numbers: Option<Vec<f64>> = numbers.collect();
    let fit = |numbers: &Vec<f64>| {
        let sum: f64 = numbers.iter().sum();
        numbers.iter().all(|w| *w >= 0.0) && sum > 0.0 && sum.is_finite()
    };
    let numbers = numbers.filter(fit);
    if numbers.is_none() {
        let message = "weights are numbers from 0 on, not all of them 0";
        read.tell(Code::ValueOutsideLimits, message, value.span(), "");
    }
    numbers
}

pub(super) fn noise(read: &mut Reader<'_>, table: &DeTable<'_>) -> Vec<Noise> {
    let mut all = Vec::new();
    for (name, value) in read.items(table, "noise") {
        let wanted = "a table such as { deviation = \"0.2deg\", every_s = 0.01 }";
        let Some(entry) = read.table(value, wanted) else {
            continue;
        };
        read.fields.only(entry, &["deviation", "every_s", "unit"]);
        let deviation = entry.get("deviation").and_then(|value| read.value(value));
        let every = read.positive(entry, "every_s", f64::MAX);
        let unit = read.text(entry, "unit");
        for key in ["deviation", "every_s"] {
            if entry.get(key).is_none() {
                let message = format!("the key `{key}` is missing");
                read.tell(Code::MissingKey, message, name.at.clone(), wanted);
            }
        }
        if let Some((deviation, every)) = deviation.zip(every) {
            all.push(Noise {
                name,
                deviation,
                every,
                unit,
            });
        }
    }
    all
}
