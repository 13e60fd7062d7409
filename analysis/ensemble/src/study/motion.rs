//! `[motion]`: the motion of each case.

use appell_spec::Code;
use toml::de::DeTable;

use super::read::{Entry, Placed, Reader, Text};
use crate::limits::{DURATIONS, MAX_STEPS, MAX_TIMES, MAX_TOLERANCE, MAX_VARIANTS};

/// The integrators.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Order 8 with step-size control.
    Dop853,
    /// Order 5 with step-size control.
    Dopri5,
}

/// The motion of a case.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// Final time in s.
    pub t_end: f64,
    /// Sampling interval of kept courses in s.
    pub interval: Option<Placed<f64>>,
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

/// Tolerances of the integration: an error of some 1e-9 after ten seconds, negligible in statistics.
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
    let t_end = read.positive(section, "t_end_s", DURATIONS[1]);
    if let Some(short) = t_end.as_ref().filter(|t_end| t_end.value < DURATIONS[0]) {
        let message = format!("a motion lasts at least {} s", DURATIONS[0]);
        let at = short.at.clone();
        read.tell(Code::ValueOutsideLimits, message, at, "write a longer one");
    }
    let t_end = t_end.map_or(default.t_end, |t_end| t_end.value);
    let interval = read.positive(section, "dt_s", f64::MAX);
    let method = read.text(section, "method").and_then(|word| {
        let words = [("dop853", Method::Dop853), ("dopri5", Method::Dopri5)];
        read.word(&word, &words)
    });
    let feedback = match section.get("feedback") {
        None => Vec::new(),
        Some(value) if value.get_ref().is_array() => read.values(value, None).unwrap_or_default(),
        Some(value) => read.value(value).into_iter().collect(),
    };
    if let Some(law) = feedback.get(MAX_VARIANTS) {
        let message = format!("more than {MAX_VARIANTS} laws");
        read.tell(Code::LimitExceeded, message, law.at.clone(), "remove some");
    }
    if let Some(interval) = interval.as_ref().filter(|dt| t_end / dt.value > MAX_TIMES) {
        let message = format!("a course would have more than {MAX_TIMES} times");
        let help = format!("write {} or more", t_end / MAX_TIMES);
        let at = interval.at.clone();
        read.tell(Code::LimitExceeded, message, at, &help);
    }
    let mut tolerance = |key: &str, usual: f64| {
        let given = read.positive(section, key, MAX_TOLERANCE);
        given.map_or(usual, |given| given.value)
    };
    Some(Motion {
        t_end,
        interval,
        method: method.unwrap_or(default.method),
        rtol: tolerance("rtol", default.rtol),
        atol: tolerance("atol", default.atol),
        max_steps: read
            .count(section, "max_steps", MAX_STEPS)
            .map(|most| most.value),
        ignore_ranges: read.fields.flag(section, "ignore_ranges"),
        set: read.entries(section, "set"),
        initial: read.entries(section, "initial"),
        input: read.entries(section, "input"),
        feedback,
    })
}
