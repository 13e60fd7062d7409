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
            Form::NewNames(count) => self.new_names(value, *count).map(ValueAst::Names),
            Form::Direction => match value.get_ref() {
                DeValue::String(_) => self.word(key, AXES, value).map(ValueAst::Word),
                _ => self
                    .elements::<3>(value, "an axis such as `\"z\"`, or three components")
                    .map(|elements| elements.map(|v| self.expression(v)))
                    .map(|c| ValueAst::Components(Box::new(c))),
            },
            Form::Expression => Some(ValueAst::Expression(self.expression(value))),
            Form::Components => self
                .components(value)
                .map(|c| ValueAst::Components(Box::new(c))),
            Form::Matrix => {
                let [a, b, c] = self.elements::<3>(value, "three rows")?;
                let rows = [self.components(a), self.components(b), self.components(c)];
                let [Some(a), Some(b), Some(c)] = rows else {
                    return None;
                };
                Some(ValueAst::Matrix(Box::new([a, b, c])))
            }
            Form::Two(target) => {
                let word = target.word();
                let names = self.elements::<2>(value, &format!("the names of two {word}s"))?;
                let one = format!("the name of a {word}");
                let [Some(a), Some(b)] = names.map(|v| self.named(v, &one)) else {
                    return None;
                };
                Some(ValueAst::Pair([a, b]))
            }
            Form::Quaternion => {
                let names = self.elements::<4>(value, "the names of four coordinates")?;
                let names = names.map(|v| self.named(v, "the name of a coordinate"));
                let [Some(a), Some(b), Some(c), Some(d)] = names else {
                    return None;
                };
                Some(ValueAst::Four(Box::new([a, b, c, d])))
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
        let DeValue::Array(array) = value.get_ref() else {
            self.wrong_type(value, "a list of tables");
            return None;
        };
        if array.is_empty() || array.len() > MAX_TURNS {
            self.tell(
                Diagnostic::error(
                    Code::LimitExceeded,
                    format!("`{}` has between 1 and {MAX_TURNS} entries", key.name),
                )
                .at(value.span(), format!("{} entries", array.len())),
            );
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

    fn named(&mut self, value: &TomlValue<'_>, wanted: &str) -> Option<Spanned<String>> {
        let name = self.string(value, wanted)?;
        Some(Spanned {
            value: name.to_owned(),
            span: value.span(),
        })
    }

    fn new_names(&mut self, value: &TomlValue<'_>, count: usize) -> Option<Vec<Spanned<String>>> {
        let wanted = format!("a list of {count} names");
        let DeValue::Array(array) = value.get_ref() else {
            self.wrong_type(value, &wanted);
            return None;
        };
        if array.len() != count {
            self.wrong_length(value, &wanted, array.len());
            return None;
        }
        let names: Vec<_> = array
            .iter()
            .map(|v| {
                let name = self.named(v, "a name")?;
                self.is_valid_name(&name.value, v.span()).then_some(name)
            })
            .collect();
        names.into_iter().collect()
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
            self.tell(
                Diagnostic::error(
                    Code::LimitExceeded,
                    format!("a sentence has at most {MAX_SENTENCE} bytes"),
                )
                .at(value.span(), format!("{} bytes", text.len())),
            );
            return None;
        }
        // Escapes such as `\u202E` appear only in the decoded text.
        if let Some(c) = text.chars().find(|c| is_forbidden(*c) || c.is_control()) {
            let written = self.text.get(value.span()).unwrap_or_default();
            if is_forbidden(c) && written.contains(c) {
                // Already reported by the check of the whole file.
                return None;
            }
            self.tell(
                Diagnostic::error(
                    Code::ForbiddenCharacter,
                    format!("the character U+{:04X} is not allowed here", u32::from(c)),
                )
                .at(value.span(), "")
                .help("write one line of plain text"),
            );
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
        let DeValue::Array(array) = value.get_ref() else {
            self.wrong_type(value, wanted);
            return None;
        };
        if length.is_some_and(|(n, _)| array.len() != n) {
            self.wrong_length(value, wanted, array.len());
            return None;
        }
        if array.len() > MAX_SAMPLES {
            self.tell(
                Diagnostic::error(
                    Code::LimitExceeded,
                    format!("a signal has at most {MAX_SAMPLES} samples"),
                )
                .at(value.span(), format!("{} samples", array.len())),
            );
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

    fn wrong_length(&mut self, value: &TomlValue<'_>, wanted: &str, found: usize) {
        let plural = if found == 1 { "y" } else { "ies" };
        self.tell(
            Diagnostic::error(
                Code::WrongType,
                format!("expected {wanted}, found a list of {found}"),
            )
            .at(value.span(), format!("{found} entr{plural}")),
        );
    }

    fn elements<'v, const N: usize>(
        &mut self,
        value: &'v TomlValue<'_>,
        wanted: &str,
    ) -> Option<[&'v TomlValue<'v>; N]> {
        let DeValue::Array(array) = value.get_ref() else {
            self.wrong_type(value, &format!("{wanted}, as a list"));
            return None;
        };
        let elements: Vec<&TomlValue<'_>> = array.iter().take(N + 1).collect();
        let found = array.len();
        elements
            .try_into()
            .inspect_err(|_| self.wrong_length(value, wanted, found))
            .ok()
    }

    fn components(&mut self, value: &TomlValue<'_>) -> Option<[ExprAst; 3]> {
        self.elements::<3>(value, "three components")
            .map(|elements| elements.map(|v| self.expression(v)))
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
