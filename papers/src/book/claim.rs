//! What a paper says, what is found, and what that means.

use serde::Serialize;

/// A part of the book.
#[derive(Debug, Serialize)]
pub struct Section {
    /// Its heading.
    pub title: String,
    /// A few sentences on what is shown.
    pub about: String,
    /// What is claimed and found.
    pub claims: Vec<Claim>,
    /// Pictures, in the book only.
    #[serde(skip)]
    pub pictures: Vec<Picture>,
}

/// A figure with what it shows.
#[derive(Debug)]
pub struct Picture {
    /// SVG.
    pub svg: String,
    /// What it shows.
    pub caption: String,
}

/// One statement of the paper beside ours.
#[derive(Debug, Serialize)]
pub struct Claim {
    /// Where it stands.
    pub place: String,
    /// What the paper says; corrected formulas beside what is printed.
    pub published: String,
    /// What is found.
    pub ours: String,
    /// What that means.
    pub verdict: Verdict,
    /// Whether the comparison came out as it should. For an erratum: the corrected statement holds.
    pub holds: bool,
    /// What makes it, without the book.
    pub command: String,
}

/// How a statement fares.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The same function, proved by the identity test.
    Exact,
    /// A number that agrees in so many digits.
    Digits(u32),
    /// A statement in words that is found true.
    True,
    /// What a letter means; there is nothing to compare.
    Definition,
    /// Printed wrong, with the kind of error.
    Erratum(&'static str),
    /// Not in the paper.
    Added,
    /// A finding on recordings that are not public; on simulated ones it does not show.
    NotHere,
    /// A number that depends on recordings that nobody can get.
    NoData,
}

impl Verdict {
    /// Whether the paper errs.
    pub const fn is_erratum(&self) -> bool {
        matches!(self, Self::Erratum(_))
    }

    /// For people.
    pub fn words(&self) -> String {
        match self {
            Self::Exact => "exact".to_owned(),
            Self::Digits(1) => "reproduced to 1 digit".to_owned(),
            Self::Digits(n) => format!("reproduced to {n} digits"),
            Self::True => "found true".to_owned(),
            Self::Definition => "definition".to_owned(),
            Self::Erratum(kind) => format!("erratum: {kind}"),
            Self::Added => "not in the paper".to_owned(),
            Self::NotHere => "not on the simulated rides".to_owned(),
            Self::NoData => "depends on data that nobody can get".to_owned(),
        }
    }
}

impl Claim {
    /// A statement in words that is true or not.
    pub fn that(
        place: &str,
        published: &str,
        ours: impl Into<String>,
        holds: bool,
        command: &str,
    ) -> Self {
        Self {
            place: place.to_owned(),
            published: published.to_owned(),
            ours: ours.into(),
            verdict: Verdict::True,
            holds,
            command: command.to_owned(),
        }
    }

    /// A number beside its published value, of which `needed` digits must agree.
    pub fn number(
        place: &str,
        published: &str,
        [wanted, found]: [f64; 2],
        needed: u32,
        command: &str,
    ) -> Self {
        let digits = digits(wanted, found);
        Self {
            verdict: Verdict::Digits(digits),
            ..Self::that(place, published, shown(found), digits >= needed, command)
        }
    }

    /// What the paper found on recordings that are not public: it shows on other ones, or it does not.
    /// Either is an answer.
    pub fn finding(
        place: &str,
        published: &str,
        ours: impl Into<String>,
        shows: bool,
        command: &str,
    ) -> Self {
        let claim = Self::that(place, published, ours, true, command);
        if shows {
            claim
        } else {
            claim.verdict(Verdict::NotHere)
        }
    }

    /// The same statement with another verdict.
    pub fn verdict(self, verdict: Verdict) -> Self {
        Self { verdict, ..self }
    }
}

/// Leading digits in which two numbers agree, up to the fifteen that a number has.
pub(crate) fn digits(wanted: f64, found: f64) -> u32 {
    let apart = (found - wanted).abs() / wanted.abs().max(f64::MIN_POSITIVE);
    (0..=15)
        .rev()
        .find(|&n| apart <= 0.5 * 10f64.powi(-n + 1))
        .map_or(0, i32::unsigned_abs)
}

/// A number with the digits that can be trusted.
pub(crate) fn shown(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let decimals = (12.0 - value.abs().log10().floor()).clamp(0.0, 16.0);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between 0 and 16"
    )]
    let text = format!("{value:.*}", decimals as usize);
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_that_agree_are_counted() {
        assert_eq!(digits(10.0, 10.0), 15);
        assert_eq!(digits(1.21, 1.213), 3);
        assert_eq!(digits(536.67, 563.67), 1);
        assert_eq!(digits(1.0, -1.0), 0);
        assert_eq!(digits(1.0, f64::NAN), 0);
        assert_eq!(shown(0.990_454_441_153_150_7), "0.9904544411532");
        assert_eq!(shown(-2042.5), "-2042.5");
    }
}
