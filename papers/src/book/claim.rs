//! Claims of a paper, compared with computed results, and the part of the book that they make.

use std::collections::BTreeMap;
use std::fmt::Display;

use appell_runtime::model::ModelInfo;
use serde::{Deserialize, Serialize};

use super::{Result, computation, failed};

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
    pub erratum: Option<String>,
    /// Whether the comparison gives its expected result (for an erratum: the corrected statement
    /// holds); `false` indicates a regression.
    pub as_expected: bool,
    /// The command that reproduces it.
    pub command: String,
}

/// Agreement of a statement with the computed result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
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
}

/// A statement before its comparison with a computed result.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Statement {
    /// Its place in the paper.
    pub(crate) place: String,
    /// The statement, with corrections.
    pub(crate) published: String,
    /// The command that reproduces the computed result.
    #[serde(default)]
    pub(crate) command: String,
    /// The agreement if it holds; of a number exact, else approximate.
    pub(crate) agreement: Option<Reproduction>,
    /// Digits in which a number must agree.
    pub(crate) digits: Option<u32>,
    /// Basis of the agreement, or reason for its absence.
    #[serde(default)]
    pub(crate) note: String,
    /// For an erratum: the kind of error.
    pub(crate) erratum: Option<String>,
}

impl Statement {
    /// It holds or not. An erratum differs, and statements that cannot be checked or are not in the
    /// paper remain so.
    pub(crate) fn found(self, ours: impl Into<String>, holds: bool) -> Claim {
        let agreement = match self.agreement {
            _ if self.erratum.is_some() => Reproduction::Differs,
            Some(fixed @ (Reproduction::CannotBeChecked | Reproduction::NotInPaper)) => fixed,
            _ if !holds => Reproduction::Differs,
            Some(stated) => stated,
            None if self.digits.is_some() => Reproduction::Exact,
            None => Reproduction::Approximate,
        };
        let note = match &self.erratum {
            Some(kind) if self.note.is_empty() => format!("erratum: {kind}"),
            _ => self.note,
        };
        Claim {
            place: self.place,
            published: self.published,
            ours: ours.into(),
            agreement,
            note,
            erratum: self.erratum,
            as_expected: holds,
            command: self.command,
        }
    }

    /// A number and its computed value.
    pub(crate) fn number(mut self, [wanted, found]: [f64; 2]) -> Claim {
        let agreeing = digits(wanted, found);
        if self.erratum.is_none() {
            let verb = if agreeing == 1 {
                "digit agrees"
            } else {
                "digits agree"
            };
            self.note = format!("{agreeing} {verb}");
        }
        let holds = self.digits.is_some_and(|needed| agreeing >= needed);
        self.found(shown(found), holds)
    }
}

/// Counts of statements by agreement.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(transparent)]
pub struct Tally(BTreeMap<Reproduction, usize>);

impl Tally {
    /// Of the parts of a book.
    pub fn of(sections: &[Section]) -> Self {
        let mut counts = BTreeMap::from(Reproduction::ALL.map(|agreement| (agreement, 0)));
        for claim in sections.iter().flat_map(|section| &section.claims) {
            *counts.entry(claim.agreement).or_default() += 1;
        }
        Self(counts)
    }

    fn count(&self, agreement: Reproduction) -> usize {
        self.0.get(&agreement).copied().unwrap_or(0)
    }

    /// Statements of the paper, without additional results.
    pub fn statements(&self) -> usize {
        self.0.values().sum::<usize>() - self.count(Reproduction::NotInPaper)
    }

    /// One line.
    pub fn words(&self) -> String {
        let [exact, approximate, differ, unchecked, added] =
            Reproduction::ALL.map(|agreement| self.count(agreement));
        format!(
            "{} statements of the paper: {exact} exact, {approximate} approximate, {differ} differ, \
             {unchecked} cannot be checked; {added} results beyond the paper",
            self.statements(),
        )
    }
}

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

/// The texts of a part. In them `{name}` is a value that the computation sets.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Texts {
    title: String,
    about: String,
    /// The command of statements without their own.
    #[serde(default)]
    command: String,
    #[serde(default)]
    captions: BTreeMap<String, String>,
    #[serde(default)]
    statements: BTreeMap<String, Statement>,
    /// Definitions and laws: place, content, and the place of their use.
    #[serde(default)]
    definitions: Vec<[String; 3]>,
    /// A table of parameters: name, unit as printed, value in SI.
    #[serde(default)]
    parameters: Vec<(String, String, f64)>,
}

/// A part: its texts, and the claims and pictures so far.
pub(crate) struct Part {
    texts: Texts,
    values: BTreeMap<&'static str, String>,
    pub(crate) claims: Vec<Claim>,
    pictures: Vec<Picture>,
}

impl Part {
    pub(crate) fn read(texts: &str) -> Result<Self> {
        Ok(Self {
            texts: toml::from_str(texts).map_err(computation)?,
            values: BTreeMap::new(),
            claims: Vec::new(),
            pictures: Vec::new(),
        })
    }

    /// Sets the value of a name in the texts from here on.
    pub(crate) fn set(&mut self, name: &'static str, value: impl Display) {
        self.values.insert(name, value.to_string());
    }

    fn filled(&self, text: &str) -> String {
        let names = self.values.iter();
        names.fold(text.to_owned(), |text, (name, value)| {
            text.replace(&format!("{{{name}}}"), value)
        })
    }

    pub(crate) fn statement(&self, key: &str) -> Result<Statement> {
        let statement = self.texts.statements.get(key);
        let statement = statement.ok_or_else(|| failed(&format!("no statement `{key}`")))?;
        let command = match statement.command.as_str() {
            "" => &self.texts.command,
            command => command,
        };
        Ok(Statement {
            place: self.filled(&statement.place),
            published: self.filled(&statement.published),
            command: self.filled(command),
            note: self.filled(&statement.note),
            ..statement.clone()
        })
    }

    /// A statement holds or not.
    pub(crate) fn found(&mut self, key: &str, ours: impl Into<String>, holds: bool) -> Result<()> {
        let claim = self.statement(key)?.found(ours, holds);
        self.claims.push(claim);
        Ok(())
    }

    /// The definitions, each with these words before the place of its use.
    pub(crate) fn define(&mut self, words: &str) {
        let definitions = self.texts.definitions.iter().cloned();
        let claims = definitions.map(|[place, published, used]| {
            let statement = Statement {
                place,
                published,
                command: self.texts.command.clone(),
                agreement: Some(Reproduction::CannotBeChecked),
                note: "a definition".to_owned(),
                ..Statement::default()
            };
            statement.found(format!("{words} {used}"), true)
        });
        self.claims.extend(claims);
    }

    /// A number and its computed value.
    pub(crate) fn number(&mut self, key: &str, pair: [f64; 2]) -> Result<()> {
        let claim = self.statement(key)?.number(pair);
        self.claims.push(claim);
        Ok(())
    }

    /// The values of the parameters.
    pub(crate) fn parameters(&mut self, info: &ModelInfo) -> Result<()> {
        for (name, unit, value) in self.texts.parameters.clone() {
            let index = info.parameter_index(&name);
            let found = index.map_or(f64::NAN, |index| info.parameters[index].value);
            self.set("parameter", format!("{name} = {value}{unit}"));
            self.number("parameter", [value, found])?;
        }
        Ok(())
    }

    /// A picture with the caption of a key.
    pub(crate) fn picture(&mut self, key: &str, svg: String) -> Result<()> {
        let caption = self.texts.captions.get(key);
        let caption = caption.ok_or_else(|| failed(&format!("no caption `{key}`")))?;
        let caption = self.filled(caption);
        self.pictures.push(Picture { svg, caption });
        Ok(())
    }

    pub(crate) fn section(self) -> Section {
        Section {
            about: self.filled(&self.texts.about),
            title: self.texts.title,
            claims: self.claims,
            pictures: self.pictures,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_agree_to_half_a_unit_of_the_last_one() {
        for (wanted, found, agreeing) in [
            (9.81, 9.814, 3),
            (9.81, 9.85, 2),
            (0.099, 0.0994, 2),
            (-2.0, 2.0, 0),
            (10.0, 10.0, 15),
            (536.67, 563.67, 1),
            (1.0, f64::NAN, 0),
        ] {
            assert_eq!(digits(wanted, found), agreeing, "{wanted} {found}");
        }
        assert_eq!(shown(0.990_454_441_153_150_7), "0.9904544411532");
        assert_eq!(shown(-2042.5), "-2042.5");
    }

    #[test]
    fn statements_are_counted_apart() {
        let number = |mut statement: Statement, published, found| {
            statement.digits = Some(3);
            statement.number([published, found])
        };
        let plain = Statement::default;
        let stated = |agreement| Statement {
            agreement: Some(agreement),
            ..plain()
        };
        let erratum = Statement {
            erratum: Some("misprint".to_owned()),
            ..plain()
        };
        let claims = vec![
            number(plain(), 1.21, 1.213),
            number(plain(), 0.61, 0.77),
            number(stated(Reproduction::Approximate), 1.0, 1.001),
            number(erratum, 1.0, 1.0),
            number(stated(Reproduction::CannotBeChecked), 0.61, 0.77),
            number(stated(Reproduction::NotInPaper), 1.0, 1.0),
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
}
