//! `[motion]`: the motion of each case.

use appell_spec::Code;
use toml::de::DeTable;

use super::read::Reader;
use super::value::{Entry, Text};

/// The integrators.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Order 8 with step-size control.
    Dop853,
    /// Order 5 with step-size control.
    Dopri5,
    /// Taylor series of an order that follows from the tolerances.
    Taylor,
}

/// The motion of a case.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// Final time in s.
    pub t_end: f64,
    /// Interval of kept courses in s.
    pub interval: Option<f64>,
    /// The integrator.
    pub method: Method,
    /// Relative tolerance.
    pub rtol: f64,
    /// Absolute tolerance, in SI.
    pub atol: f64,
    /// The most steps.
    pub max_steps: Option<u64>,
    /// Whether states may leave their ranges.
    pub ignore_ranges: bool,
    /// Parameters, which may follow from others.
    pub set: Vec<Entry>,
    /// Initial values.
    pub initial: Vec<Entry>,
    /// Inputs.
    pub input: Vec<Entry>,
    /// Files of feedback laws.
    pub feedback: Vec<Text>,
}

/// Tolerances of the integration: an error of some 1e-9 after ten seconds, which no statistic sees.
const TOLERANCE: f64 = 1e-9;

impl Default for Motion {
    fn default() -> Self {
        Self {
            t_end: 10.0,
            interval: None,
            method: Method::Dop853,
            rtol: TOLERANCE,
            atol: TOLERANCE,
            max_steps: None,
            ignore_ranges: false,
            set: Vec::new(),
            initial: Vec::new(),
            input: Vec::new(),
            feedback: Vec::new(),
        }
    }
}

const KEYS: [&str; 11] = [
    "t_end_s",
    "dt_s",
    "method",
    "rtol",
    "atol",
    "max_steps",
    "ignore_ranges",
    "set",
    "initial",
    "input",
    "feedback",
];

pub(super) fn read(read: &mut Reader<'_>, table: &DeTable<'_>) -> Option<Motion> {
    let section = read.fields.section(table, "motion")?;
    read.fields.only(section, &KEYS);
    let default = Motion::default();
    let t_end = read.positive(section, "t_end_s").unwrap_or(default.t_end);
    let interval = read.positive(section, "dt_s");
    let method = read.text(section, "method").and_then(|word| {
        let words = [
            ("dop853", Method::Dop853),
            ("dopri5", Method::Dopri5),
            ("taylor", Method::Taylor),
        ];
        read.word(&word, &words)
    });
    let feedback = match section.get("feedback") {
        None => Vec::new(),
        Some(value) if value.get_ref().is_array() => read.values(value, None).unwrap_or_default(),
        Some(value) => read.value(value).into_iter().collect(),
    };
    if interval.is_some_and(|interval| t_end / interval > 1e5) {
        let at = section.get("dt_s").map_or(0..0, toml::Spanned::span);
        let message = "a course would have more than 100000 times";
        read.tell(
            Code::ValueOutsideLimits,
            message,
            at,
            "choose a longer `dt_s`",
        );
    }
    Some(Motion {
        t_end,
        interval,
        method: method.unwrap_or(default.method),
        rtol: read.positive(section, "rtol").unwrap_or(default.rtol),
        atol: read.positive(section, "atol").unwrap_or(default.atol),
        max_steps: read.count(section, "max_steps"),
        ignore_ranges: read.fields.flag(section, "ignore_ranges"),
        set: read.entries(section, "set"),
        initial: read.entries(section, "initial"),
        input: read.entries(section, "input"),
        feedback,
    })
}
