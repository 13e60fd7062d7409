//! Values: numbers, units, names, sentences, expressions and lists of them.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::Num;
use toml::de::DeValue;

use crate::ast::{ExprAst, ExprAstKind, ItemAst, Spanned, ValueAst};
use crate::diagnostic::{Code, Diagnostic};
use crate::language::{AXES, Form, Key, Sense, Word};
use crate::limits::{MAX_DIGITS, MAX_SAMPLES, MAX_SENTENCE, MAX_TURNS};
use crate::number::{NumberError, exact};
use crate::suggest::{self, did_you_mean, shown};
use crate::units;

use super::expression::{self, unit_diagnostic};
use super::reader::{Reader, TomlValue, is_forbidden};
use super::source::Source;

impl Reader<'_> {
    /// Reads the value of a key; `None` where it could not be read, already reported.
    pub(super) fn value(&mut self, key: &'static Key, value: &TomlValue<'_>) -> Option<ValueAst> {
        match &key.form {
            Form::Text => self.sentence(value).map(ValueAst::Text),
            Form::Name | Form::NewName => {
                let name = self.string(value, "a name")?;
                self.is_valid_name(name, value.span())
                    .then(|| ValueAst::Text(name.to_owned()))
            }
            Form::Reference(target) => self
                .string(value, &format!("the name of a {}", target.word()))
                .map(|name| ValueAst::Text(name.to_owned())),
            Form::Unit => self.unit(value).map(ValueAst::Unit),
            Form::Number => self.number(value).map(ValueAst::Number),
            Form::Numbers => self.numbers(value, None).map(ValueAst::Numbers),
            Form::Range => self
                .numbers(value, Some((2, "the two ends, as a list of two numbers")))
                .map(ValueAst::Numbers),
            Form::Values(count) => self
                .numbers(value, Some((*count, &format!("a list of {count} numbers"))))
                .map(ValueAst::Numbers),
            Form::NewNames(count) => {
                let wanted = format!("a list of {count} names");
                let array = self.array(value, &wanted)?;
                let array = self.of_length(array, value, &wanted, *count)?;
                self.names(array, "a name", true)
            }
            Form::Direction => {
                if let DeValue::String(_) = value.get_ref() {
                    self.word(key, AXES, value).map(ValueAst::Word)
                } else {
                    let wanted = "an axis such as `\"z\"`, or three components";
                    self.components(value, wanted).map(ValueAst::Components)
                }
            }
            Form::Expression => Some(ValueAst::Expression(self.expression(value))),
            Form::Components => self
                .components(value, "three components")
                .map(ValueAst::Components),
            Form::Matrix => {
                let [a, b, c] = self.elements::<3>(value, "three rows")?;
                let rows = [a, b, c].map(|row| self.components(row, "three components"));
                let [Some(a), Some(b), Some(c)] = rows else {
                    return None;
                };
                Some(ValueAst::Matrix(Box::new([*a, *b, *c])))
            }
            Form::Two(target) => {
                let word = target.word();
                let names = self.elements::<2>(value, &format!("the names of two {word}s"))?;
                self.names(names, &format!("the name of a {word}"), false)
            }
            Form::Quaternion => {
                let names = self.elements::<4>(value, "the names of four coordinates")?;
                self.names(names, "the name of a coordinate", false)
            }
            Form::Word(words) => self.word(key, words, value).map(ValueAst::Word),
            Form::Flag => self.flag(value).map(ValueAst::Flag),
            Form::Inertia(keys) => match value.get_ref() {
                DeValue::Table(_) => self.inner_table(key.name, keys, value),
                _ => Some(ValueAst::Expression(self.expression(value))),
            },
            Form::Table(keys) => self.inner_table(key.name, keys, value),
            Form::Tables(keys) => self.tables(key, keys, value).map(ValueAst::Tables),
        }
    }

    fn tables(
        &mut self,
        key: &Key,
        keys: &'static [Key],
        value: &TomlValue<'_>,
    ) -> Option<Vec<ItemAst>> {
        let array = self.array(value, "a list of tables")?;
        if array.is_empty() || array.len() > MAX_TURNS {
            let message = format!("`{}` has between 1 and {MAX_TURNS} entries", key.name);
            self.exceeded(value.span(), message, array.len(), "entries");
            return None;
        }
        // All tables are parsed first, so that the errors of all are reported.
        let tables: Vec<Option<ItemAst>> = array
            .iter()
            .map(|v| self.table_item(key.name, keys, v))
            .collect();
        tables.into_iter().collect()
    }

    fn flag(&mut self, value: &TomlValue<'_>) -> Option<bool> {
        let flag = value.get_ref().as_bool();
        if flag.is_none() {
            self.wrong_type(value, "`true` or `false`");
        }
        flag
    }

    /// Names; `defines` are those that are defined here. All are read first, so that the errors of all are reported.
    fn names<'v, 'a: 'v>(
        &mut self,
        values: impl IntoIterator<Item = &'v TomlValue<'a>>,
        wanted: &str,
        defines: bool,
    ) -> Option<ValueAst> {
        let names: Vec<_> = values
            .into_iter()
            .map(|value| {
                let name = self.string(value, wanted)?;
                let is_name = !defines || self.is_valid_name(name, value.span());
                is_name.then(|| Spanned {
                    value: name.to_owned(),
                    span: value.span(),
                })
            })
            .collect();
        let names: Option<Vec<_>> = names.into_iter().collect();
        names.map(ValueAst::Names)
    }

    fn string<'v>(&mut self, value: &'v TomlValue<'_>, wanted: &str) -> Option<&'v str> {
        let text = value.get_ref().as_str();
        if text.is_none() {
            self.wrong_type(value, wanted);
        }
        text
    }

    /// One line of prose: it ends up in comments, tables and labels.
    fn sentence(&mut self, value: &TomlValue<'_>) -> Option<String> {
        let text = self.string(value, "a string")?;
        if text.len() > MAX_SENTENCE {
            let message = format!("a sentence has at most {MAX_SENTENCE} bytes");
            self.exceeded(value.span(), message, text.len(), "bytes");
            return None;
        }
        // Escapes such as `\u202E` appear only in the decoded text.
        if let Some(c) = text.chars().find(|c| is_forbidden(*c) || c.is_control()) {
            let written = self.text.get(value.span()).unwrap_or_default();
            if is_forbidden(c) && written.contains(c) {
                // Already reported by the check of the whole file.
                return None;
            }
            let message = format!("the character U+{:04X} is not allowed here", u32::from(c));
            let help = "write one line of plain text";
            self.error(Code::ForbiddenCharacter, value.span(), message, help);
            return None;
        }
        Some(text.to_owned())
    }

    fn unit(&mut self, value: &TomlValue<'_>) -> Option<units::Unit> {
        let text = self.string(value, "a unit, as a string")?;
        let source = Source::new(self.text, text, value.span());
        match units::parse(text) {
            Ok(unit) => Some(unit),
            Err(error) => {
                self.tell(unit_diagnostic(&error, |at| source.span(at)));
                None
            }
        }
    }

    fn number(&mut self, value: &TomlValue<'_>) -> Option<BigRational> {
        let result = match value.get_ref() {
            DeValue::Integer(_) | DeValue::Float(_) => number_of(value.get_ref()),
            other => {
                self.wrong_type(value, "a number");
                if let (Some(text), Some(last)) = (other.as_str(), self.findings.last_mut()) {
                    let help = if exact(text.trim()).is_ok() {
                        "write the number without quotes"
                    } else {
                        "write a number alone; it is read in the unit of the quantity"
                    };
                    last.help = Some(help.to_owned());
                }
                return None;
            }
        };
        match result {
            Ok(number) => Some(number),
            Err(error) => {
                let text = self.text.get(value.span()).unwrap_or_default();
                let diagnostic = expression::number_diagnostic(error, text);
                self.tell(diagnostic.at(value.span(), ""));
                None
            }
        }
    }

    fn numbers(
        &mut self,
        value: &TomlValue<'_>,
        length: Option<(usize, &str)>,
    ) -> Option<Vec<Spanned<BigRational>>> {
        let wanted = length.map_or("a list of numbers", |(_, wanted)| wanted);
        let mut array = self.array(value, wanted)?;
        if let Some((count, _)) = length {
            array = self.of_length(array, value, wanted, count)?;
        }
        if array.len() > MAX_SAMPLES {
            let message = format!("a signal has at most {MAX_SAMPLES} samples");
            self.exceeded(value.span(), message, array.len(), "samples");
            return None;
        }
        let read: Vec<_> = array
            .iter()
            .map(|v| {
                Some(Spanned {
                    value: self.number(v)?,
                    span: v.span(),
                })
            })
            .collect();
        read.into_iter().collect()
    }

    fn array<'v, 'a>(
        &mut self,
        value: &'v TomlValue<'a>,
        wanted: &str,
    ) -> Option<&'v [TomlValue<'a>]> {
        if let DeValue::Array(array) = value.get_ref() {
            return Some(array);
        }
        self.wrong_type(value, wanted);
        None
    }

    /// A list, if it has a length.
    fn of_length<'v, 'a>(
        &mut self,
        array: &'v [TomlValue<'a>],
        value: &TomlValue<'_>,
        wanted: &str,
        count: usize,
    ) -> Option<&'v [TomlValue<'a>]> {
        let found = array.len();
        if found == count {
            return Some(array);
        }
        let plural = if found == 1 { "y" } else { "ies" };
        let message = format!("expected {wanted}, found a list of {found}");
        let finding = Diagnostic::error(Code::WrongType, message);
        self.tell(finding.at(value.span(), format!("{found} entr{plural}")));
        None
    }

    fn elements<'v, 'a, const N: usize>(
        &mut self,
        value: &'v TomlValue<'a>,
        wanted: &str,
    ) -> Option<&'v [TomlValue<'a>; N]> {
        let array = self.array(value, &format!("{wanted}, as a list"))?;
        self.of_length(array, value, wanted, N)?.try_into().ok()
    }

    fn components(&mut self, value: &TomlValue<'_>, wanted: &str) -> Option<Box<[ExprAst; 3]>> {
        let elements = self.elements::<3>(value, wanted)?;
        Some(Box::new(elements.each_ref().map(|v| self.expression(v))))
    }

    /// An expression; an invalid one becomes a placeholder that causes no further error.
    fn expression(&mut self, value: &TomlValue<'_>) -> ExprAst {
        let broken = ExprAst {
            kind: ExprAstKind::Broken,
            span: value.span(),
        };
        match value.get_ref() {
            DeValue::String(text) => {
                let source = Source::new(self.text, text, value.span());
                match expression::parse(&source) {
                    Ok(expression) => expression,
                    Err(diagnostic) => {
                        self.tell(diagnostic);
                        broken
                    }
                }
            }
            DeValue::Integer(_) | DeValue::Float(_) => match self.number(value) {
                Some(number) => ExprAst {
                    kind: ExprAstKind::Number(number, None),
                    span: value.span(),
                },
                None => broken,
            },
            _ => {
                self.wrong_type(value, "an expression, as a string");
                broken
            }
        }
    }

    fn word(&mut self, key: &Key, words: &'static [Word], value: &TomlValue<'_>) -> Option<Sense> {
        let text = self.string(value, "a word, as a string")?;
        if let Some(word) = words.iter().find(|word| word.text == text) {
            return Some(word.sense);
        }
        let known = || words.iter().map(|word| word.text);
        let help = did_you_mean(text, known(), || {
            format!("write one of {}", suggest::list(known()))
        });
        let message = format!("`{}` cannot be `{}`", key.name, shown(text));
        self.unknown_word(message, value.span(), help);
        None
    }
}

fn number_of(value: &DeValue<'_>) -> Result<BigRational, NumberError> {
    match value {
        DeValue::Float(float) => exact(float.as_str()),
        DeValue::Integer(integer) if integer.radix() == 10 => exact(integer.as_str()),
        DeValue::Integer(integer) if integer.as_str().len() <= MAX_DIGITS => {
            BigInt::from_str_radix(integer.as_str(), integer.radix())
                .map(BigRational::from_integer)
                .map_err(|_| NumberError::Syntax)
        }
        DeValue::Integer(_) => Err(NumberError::TooLarge),
        _ => Err(NumberError::Syntax),
    }
}
