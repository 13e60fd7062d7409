//! Columns of a row.

use std::collections::BTreeSet;

use appell_ensemble::TAKEN;
use appell_ensemble::limits::MAX_COLUMNS;
use appell_ensemble::rows::{Column, Role};
use appell_ensemble::study::{Keep, Kept, Text};
use appell_runtime::model::{ModelInfo, Quantity};
use appell_spec::{Code, shown, units};

use super::reading::Reading;
use super::spec::Quantity as Kind;

/// A value that is kept at a given time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Moment {
    pub(super) t: f64,
    /// The kept quantity.
    pub(super) keep: usize,
    pub(super) column: usize,
}

/// The columns of a row after the factors.
#[derive(Debug)]
pub(super) struct Layout {
    pub(super) columns: Vec<Column>,
    /// The first column of each kept quantity.
    pub(super) first: Vec<usize>,
    /// Sorted by time.
    pub(super) moments: Vec<Moment>,
    /// Sampling interval of courses in s, the shortest duration that every kept quantity resolves.
    pub(super) interval: f64,
}

/// Times of a course without an interval.
const TIMES: f64 = 100.0;

/// The columns of a study.
pub(super) fn layout(
    reading: &mut Reading<'_>,
    factors: Vec<Column>,
    keep: &[Keep],
    info: &ModelInfo,
    kept: &[Kind],
) -> Layout {
    let study = reading.study;
    let t_end = study.motion.t_end;
    let given = study.motion.interval.as_ref();
    let interval = given.map_or(t_end / TIMES, |dt| dt.value);
    let mut layout = Layout {
        columns: factors,
        first: Vec::new(),
        moments: Vec::new(),
        interval,
    };
    // Courses come last, as they have many columns.
    let mut courses = Vec::new();
    for (index, (keep, source)) in keep.iter().zip(kept).enumerate() {
        let quantity = match *source {
            Kind::State(state) => &info.states[state],
            Kind::Input(input) => &info.inputs[input],
            Kind::Output(output, _) => &info.outputs[output],
        };
        let is_own = !keep.about.is_empty();
        let about = if is_own {
            keep.about.clone()
        } else {
            sentence(keep)
        };
        let (unit, scale) = unit(reading, keep, quantity);
        let value = Column {
            name: keep.name.text.clone(),
            about,
            unit,
            scale,
            role: Role::Value,
        };
        layout.first.push(layout.columns.len());
        let when = Column {
            name: format!("{}_t_s", keep.name.text),
            about: format!("when: {}", value.about),
            unit: "s".to_owned(),
            scale: 1.0,
            role: Role::When,
        };
        match keep.kept {
            Kept::Course => courses.push((index, value)),
            Kept::End | Kept::Mean => layout.columns.push(value),
            Kept::At(t) => {
                if !(0.0..=t_end).contains(&t) {
                    let message =
                        format!("{t} s is not a time of the motion, which ends at {t_end} s");
                    reading.tell(Code::ValueOutsideLimits, message, &keep.name, "");
                }
                let column = layout.columns.len();
                layout.moments.push(Moment {
                    t,
                    keep: index,
                    column,
                });
                layout.columns.push(value);
            }
            Kept::Max | Kept::Min => layout.columns.extend([value, when]),
            Kept::When { .. } => {
                let event = Column {
                    unit: String::new(),
                    scale: 1.0,
                    role: Role::Event,
                    ..value
                };
                layout.columns.extend([event, when]);
            }
        }
    }
    if !are_bounded(reading, keep, &courses, interval) {
        courses.clear();
    }
    for (index, value) in courses {
        layout.first[index] = layout.columns.len();
        for t in times(t_end, interval) {
            let column = layout.columns.len();
            layout.moments.push(Moment {
                t,
                keep: index,
                column,
            });
            layout.columns.push(Column {
                name: format!("{}@{t}", value.name),
                role: Role::Course {
                    of: value.name.clone(),
                    t,
                },
                ..value.clone()
            });
        }
    }
    layout.moments.sort_by(|a, b| a.t.total_cmp(&b.t));
    unique(reading, &layout.columns);
    layout
}

/// Unit of a kept quantity: that of the study, if it fits, or that of the quantity.
fn unit(reading: &mut Reading<'_>, keep: &Keep, quantity: &Quantity) -> (String, f64) {
    let own = (quantity.unit.to_string(), quantity.scale);
    let Some(wanted) = &keep.unit else {
        return own;
    };
    let unit = match units::parse(&wanted.text) {
        Ok(unit) => unit,
        Err(error) => {
            reading.tell(Code::UnknownUnit, error.to_string(), wanted, "");
            return own;
        }
    };
    let dimension = units::parse(&own.0).map_or(unit.dimension, |own| own.dimension);
    if dimension != unit.dimension {
        let found = units::quantity_name(&dimension);
        let message = format!(
            "`{}` is {found}, not {}",
            shown(&keep.of.text),
            units::quantity_name(&unit.dimension)
        );
        let help = format!("its unit is `{}`", own.0);
        reading.tell(Code::UnitMismatch, message, wanted, &help);
    }
    (wanted.text.clone(), unit.scale)
}

/// Multiples of an interval up to the end, which counts as one within rounding.
fn times(t_end: f64, interval: f64) -> impl Iterator<Item = f64> {
    let time = move |k: u32| {
        let t = f64::from(k) * interval;
        if (t - t_end).abs() < 1e-9 * interval {
            t_end
        } else {
            t
        }
    };
    (0..).map(time).take_while(move |t| *t <= t_end)
}

/// Description of a column for which the study has none.
fn sentence(keep: &Keep) -> String {
    let of = &keep.of.text;
    match keep.kept {
        Kept::End => format!("{of} at the end"),
        Kept::At(t) => format!("{of} at {t} s"),
        Kept::Max => format!("largest {of}"),
        Kept::Min => format!("smallest {of}"),
        Kept::Mean => format!("mean of {of}"),
        Kept::When { .. } | Kept::Course => of.clone(),
    }
}

fn unique(reading: &mut Reading<'_>, columns: &[Column]) {
    let study = reading.study;
    let mut seen: BTreeSet<&str> = TAKEN.into();
    for column in columns.iter().filter(|column| !seen.insert(&column.name)) {
        let names = study.keep.iter().map(|keep| &keep.name);
        let mut names = names.chain(study.vary.iter().map(|vary| &vary.name));
        let own = |name: &&Text| {
            let rest = column.name.strip_prefix(name.text.as_str());
            rest.is_some_and(|rest| rest.is_empty() || rest == "_t_s" || rest.starts_with('@'))
        };
        let message = format!("two columns would have the name `{}`", column.name);
        let help = "give it another name";
        match (names.find(own), &study.table) {
            (Some(at), _) => reading.tell(Code::DuplicateName, message, at, help),
            (None, Some(table)) => reading.tell(Code::DuplicateName, message, table, help),
            (None, None) => {}
        }
    }
}

/// Whether the columns of all courses together are within the limit; more are reported.
fn are_bounded(
    reading: &mut Reading<'_>,
    keep: &[Keep],
    courses: &[(usize, Column)],
    interval: f64,
) -> bool {
    let motion = &reading.study.motion;
    let (given, t_end) = (motion.interval.as_ref(), motion.t_end);
    let each = (t_end / interval).floor() + 1.0;
    let Some((first, _)) = courses.first() else {
        return true;
    };
    if each * courses.len() as f64 <= MAX_COLUMNS as f64 {
        return true;
    }
    let message = format!(
        "{} courses of {each} times are too many columns",
        courses.len()
    );
    let help =
        format!("at most {MAX_COLUMNS} are possible: write a longer `dt_s`, or keep fewer courses");
    match given {
        Some(interval) => reading.tell(Code::LimitExceeded, message, interval, &help),
        None => reading.tell(Code::LimitExceeded, message, &keep[*first].name, &help),
    }
    false
}
