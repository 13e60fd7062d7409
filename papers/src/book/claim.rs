//! Claims of a paper, compared with computed results.

use serde::Serialize;

/// A part of the book.
#[derive(Debug, Serialize)]
pub struct Section {
    /// Its heading.
    pub title: String,
    /// Its introduction.
    pub about: String,
    /// Its claims.
    pub claims: Vec<Claim>,
    /// Pictures, in the book only.
    #[serde(skip)]
    pub pictures: Vec<Picture>,
}

/// A figure with its caption.
#[derive(Debug)]
pub struct Picture {
    /// SVG.
    pub svg: String,
    /// Its caption.
    pub caption: String,
}

/// A statement of the paper, compared with the computed result.
#[derive(Debug, Serialize)]
pub struct Claim {
    /// Its place in the paper.
    pub place: String,
    /// The statement of the paper, with corrections.
    pub published: String,
    /// The computed result.
    pub ours: String,
    /// Agreement of the two.
    pub agreement: Reproduction,
    /// Basis of the agreement, or reason for its absence.
    pub note: String,
    /// For an erratum: the kind of error.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub erratum: Option<&'static str>,
    /// Whether the comparison gives its expected result (for an erratum: the corrected statement
    /// holds); `false` indicates a regression.
    pub as_expected: bool,
    /// The command that reproduces it.
    pub command: String,
}

/// Agreement of a statement with the computed result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Reproduction {
    /// The same function, by the identity test; or a number that agrees in every published digit,
    /// with a formula in at least ten.
    Exact,
    /// It agrees within a tolerance, or holds at every tested point.
    Approximate,
    /// The results differ.
    Differs,
    /// Not comparable: a definition, or recordings that are not public.
    CannotBeChecked,
    /// An additional result without a statement in the paper.
    NotInPaper,
}

impl Reproduction {
    /// All values, in the order in which they are counted.
    pub const ALL: [Self; 5] = [
        Self::Exact,
        Self::Approximate,
        Self::Differs,
        Self::CannotBeChecked,
        Self::NotInPaper,
    ];

    /// Its description.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Approximate => "approximate",
            Self::Differs => "differs",
            Self::CannotBeChecked => "cannot be checked",
            Self::NotInPaper => "not in the paper",
        }
    }
}

/// Why statements about unpublished recordings cannot be checked.
pub(super) const NOT_PUBLIC: &str = "the paper's recordings are not public";

/// A statement before its comparison with a computed result.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Statement<'a> {
    /// Its place in the paper.
    pub(crate) place: &'a str,
    /// The statement, with corrections.
    pub(crate) published: &'a str,
    /// The command that reproduces the computed result.
    pub(crate) command: &'a str,
}

impl Statement<'_> {
    /// It holds or not, within a tolerance or at the tested points.
    pub(crate) fn found(self, ours: impl Into<String>, holds: bool) -> Claim {
        Claim {
            place: self.place.to_owned(),
            published: self.published.to_owned(),
            ours: ours.into(),
            agreement: if holds {
                Reproduction::Approximate
            } else {
                Reproduction::Differs
            },
            note: String::new(),
            erratum: None,
            as_expected: holds,
            command: self.command.to_owned(),
        }
    }

    /// A number and its computed value, of which `needed` digits must agree.
    pub(crate) fn number(self, [wanted, found]: [f64; 2], needed: u32) -> Claim {
        let digits = digits(wanted, found);
        let agree = if digits == 1 {
            "digit agrees"
        } else {
            "digits agree"
        };
        self.found(shown(found), digits >= needed)
            .exactly()
            .noted(format!("{digits} {agree}"))
    }

    /// A statement about unpublished recordings, tested on simulated ones. It is expected to show or not as
    /// [`SIMULATED`] tells; where that tells nothing, either may be.
    pub(crate) fn simulated(self, ours: impl Into<String>, shows: bool) -> Claim {
        let mut known = SIMULATED.iter();
        let known = known
            .find(|(place, published, _)| *place == self.place && *published == self.published);
        Claim {
            as_expected: known.is_none_or(|(.., expected)| *expected == shows),
            ..self.found(ours, shows)
        }
        .noted("on simulated rides")
    }
}

impl Claim {
    /// If it holds, it holds exactly.
    #[must_use]
    pub fn exactly(mut self) -> Self {
        if self.agreement == Reproduction::Approximate {
            self.agreement = Reproduction::Exact;
        }
        self
    }

    /// If it holds, it holds within a tolerance.
    #[must_use]
    pub fn approximately(mut self) -> Self {
        if self.agreement == Reproduction::Exact {
            self.agreement = Reproduction::Approximate;
        }
        self
    }

    /// With the basis of the agreement.
    #[must_use]
    pub fn noted(mut self, note: impl Into<String>) -> Self {
        self.note = note.into();
        self
    }

    /// An erratum of the paper: the two differ, whatever else agrees.
    #[must_use]
    pub fn erratum(self, kind: &'static str) -> Self {
        Self {
            agreement: Reproduction::Differs,
            erratum: Some(kind),
            ..self
        }
        .noted(format!("erratum: {kind}"))
    }

    /// Not comparable, for a reason.
    #[must_use]
    pub fn unchecked(self, why: &str) -> Self {
        Self {
            agreement: Reproduction::CannotBeChecked,
            ..self
        }
        .noted(why)
    }

    /// An additional result.
    #[must_use]
    pub fn added(self) -> Self {
        Self {
            agreement: Reproduction::NotInPaper,
            ..self
        }
    }
}

/// Counts of statements by agreement.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Tally {
    /// The same function, or every published digit.
    pub exact: usize,
    /// Within a tolerance.
    pub approximate: usize,
    /// The results differ.
    pub differs: usize,
    /// Definitions, and numbers from recordings that are not public.
    pub cannot_be_checked: usize,
    /// Additional results.
    pub not_in_paper: usize,
}

impl Tally {
    /// Of the parts of a book.
    pub fn of(sections: &[Section]) -> Self {
        let mut tally = Self::default();
        for claim in sections.iter().flat_map(|section| &section.claims) {
            *tally.count(claim.agreement) += 1;
        }
        tally
    }

    fn count(&mut self, agreement: Reproduction) -> &mut usize {
        match agreement {
            Reproduction::Exact => &mut self.exact,
            Reproduction::Approximate => &mut self.approximate,
            Reproduction::Differs => &mut self.differs,
            Reproduction::CannotBeChecked => &mut self.cannot_be_checked,
            Reproduction::NotInPaper => &mut self.not_in_paper,
        }
    }

    /// Statements of the paper, without additional results.
    pub const fn statements(self) -> usize {
        self.exact + self.approximate + self.differs + self.cannot_be_checked
    }

    /// One line.
    pub fn words(self) -> String {
        format!(
            "{} statements of the paper: {} exact, {} approximate, {} differ, {} cannot be checked; \
             {} results beyond the paper",
            self.statements(),
            self.exact,
            self.approximate,
            self.differs,
            self.cannot_be_checked,
            self.not_in_paper
        )
    }
}

/// Findings of the paper on the electric unicycle, by place and sentence, that show on the simulated rides or
/// do not.
pub const SIMULATED: &[(&str, &str, bool)] = &[
    (
        "figure 8",
        "figure-eight has the largest error at the optimal h",
        true,
    ),
    (
        "figure 8",
        "the curve of constant speed is flat: a large range of h gives similar torques",
        true,
    ),
    (
        "figure 8",
        "the curve of figure-eight is flat: a large range of h gives similar torques",
        true,
    ),
    ("height", "constant speed is not sensitive to h", true),
    ("height", "figure-eight is not sensitive to h", true),
    (
        "figure 8",
        "deceleration has the smallest error at the optimal h",
        false,
    ),
    (
        "figure 8, deceleration",
        "3 DoF has the smaller error at its minimum",
        false,
    ),
    (
        "figure 8, deceleration",
        "3 DoF identifies the larger h",
        false,
    ),
];

/// Leading digits in which two numbers agree: the most after which they differ by no more than half a unit
/// of the last one, up to the fifteen that a number has.
pub(crate) fn digits(wanted: f64, found: f64) -> u32 {
    let unit = 10f64.powf(wanted.abs().max(f64::MIN_POSITIVE).log10().floor());
    let apart = (found - wanted).abs() / unit;
    (0..=15)
        .rev()
        .find(|&n| apart <= 0.5 * 10f64.powi(-n + 1))
        .map_or(0, i32::unsigned_abs)
}

/// A number with its reliable digits.
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
    fn digits_agree_to_half_a_unit_of_the_last_one() {
        assert_eq!(digits(9.81, 9.814), 3);
        assert_eq!(digits(9.81, 9.85), 2);
        assert_eq!(digits(1.21, 1.2131), 3);
        assert_eq!(digits(0.099, 0.0994), 2);
        assert_eq!(digits(-2.0, 2.0), 0);
    }

    #[test]
    fn statements_are_counted_apart() {
        let statement = Statement {
            place: "",
            published: "",
            command: "",
        };
        let number = |published, found| statement.number([published, found], 3);
        let claims = vec![
            number(1.21, 1.213),
            number(0.61, 0.77),
            number(1.0, 1.001).approximately(),
            number(1.0, 1.0).erratum("misprint"),
            number(0.61, 0.77).unchecked(NOT_PUBLIC),
            number(1.0, 1.0).added(),
        ];
        let section = Section {
            title: String::new(),
            about: String::new(),
            claims,
            pictures: Vec::new(),
        };
        let tally = Tally::of(&[section]);
        assert_eq!(tally.statements(), 5);
        assert_eq!(
            tally.words(),
            "5 statements of the paper: 1 exact, 1 approximate, 2 differ, 1 cannot be checked; \
             1 results beyond the paper"
        );
    }

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
