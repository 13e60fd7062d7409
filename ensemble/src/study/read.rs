//! Values of a study file, each with its place.

use appell_recordings::fields::{Fields, Value};
use appell_spec::expr::Span;
use appell_spec::{Code, did_you_mean, shown};
use toml::de::{DeTable, DeValue};

use super::value::{Entry, Text};
use crate::design::Sampling;

/// The text of the file with what is wrong in it.
pub(super) struct Reader<'t> {
    pub(super) fields: Fields<'t>,
    pub(super) document: &'t str,
}

impl Reader<'_> {
    pub(super) fn tell(&mut self, code: Code, message: impl Into<String>, at: Span, help: &str) {
        self.fields.tell(code, message, at, help);
    }

    /// A number or a text.
    pub(super) fn value(&mut self, value: &Value<'_>) -> Option<Text> {
        let text = match value.get_ref() {
            DeValue::String(text) => text.to_string(),
            DeValue::Integer(_) | DeValue::Float(_) => self
                .document
                .get(value.span())
                .unwrap_or_default()
                .replace('_', ""),
            _ => {
                self.fields
                    .wrong_type(value, "a number, or a text such as \"30cm\"");
                return None;
            }
        };
        Some(Text {
            text,
            at: value.span(),
        })
    }

    /// A text that may be absent.
    pub(super) fn text(&mut self, table: &DeTable<'_>, key: &str) -> Option<Text> {
        let (text, at) = self.fields.string(table, key)?;
        Some(Text { text, at })
    }

    /// A finite number that may be absent.
    pub(super) fn number(&mut self, table: &DeTable<'_>, key: &str) -> Option<f64> {
        let value = table.get(key)?;
        self.fields.number(value)
    }

    /// A positive number that may be absent.
    pub(super) fn positive(&mut self, table: &DeTable<'_>, key: &str) -> Option<f64> {
        let number = self.number(table, key)?;
        if number > 0.0 {
            return Some(number);
        }
        let at = table.get(key).map_or(0..0, toml::Spanned::span);
        let message = format!("`{key}` must be a positive number");
        self.tell(Code::ValueOutsideLimits, message, at, "");
        None
    }

    /// A whole number that may be absent and is not negative.
    pub(super) fn whole(&mut self, table: &DeTable<'_>, key: &str) -> Option<u64> {
        let value = table.get(key)?;
        let DeValue::Integer(integer) = value.get_ref() else {
            self.fields.wrong_type(value, "a whole number");
            return None;
        };
        let number = integer.as_str().replace('_', "").parse::<u64>().ok();
        if number.is_none() {
            let message = format!("`{key}` must be a whole number that is not negative");
            self.tell(Code::ValueOutsideLimits, message, value.span(), "");
        }
        number
    }

    /// A whole number from 1 on that may be absent.
    pub(super) fn count(&mut self, table: &DeTable<'_>, key: &str) -> Option<u64> {
        let number = self.whole(table, key)?;
        if number > 0 {
            return Some(number);
        }
        let at = table.get(key).map_or(0..0, toml::Spanned::span);
        self.tell(
            Code::ValueOutsideLimits,
            format!("`{key}` must be at least 1"),
            at,
            "",
        );
        None
    }

    /// The table behind a value.
    pub(super) fn table<'v, 'd>(
        &mut self,
        value: &'v Value<'d>,
        wanted: &str,
    ) -> Option<&'v DeTable<'d>> {
        let table = value.get_ref().as_table();
        if table.is_none() {
            self.fields.wrong_type(value, wanted);
        }
        table
    }

    /// The items of a section in the order of the text.
    pub(super) fn items<'v, 'd>(
        &mut self,
        table: &'v DeTable<'d>,
        section: &str,
    ) -> Vec<(Text, &'v Value<'d>)> {
        let Some(items) = self.fields.section(table, section) else {
            return Vec::new();
        };
        let named = items.iter().map(|(name, value)| {
            let text = Text {
                text: name.get_ref().to_string(),
                at: name.span(),
            };
            (text, value)
        });
        let mut named: Vec<_> = named.collect();
        named.sort_by_key(|(name, _)| name.at.start);
        named
    }

    /// Names with values, in the order of the text.
    pub(super) fn entries(&mut self, table: &DeTable<'_>, key: &str) -> Vec<Entry> {
        let items = self.items(table, key).into_iter();
        let entries = items.filter_map(|(name, value)| {
            let value = self.value(value)?;
            Some(Entry { name, value })
        });
        entries.collect()
    }

    /// A list of values; as many as `count`, if that is given.
    pub(super) fn values(&mut self, value: &Value<'_>, count: Option<usize>) -> Option<Vec<Text>> {
        let list = value.get_ref().as_array();
        let wanted = match count {
            Some(count) => format!("a list of {count} values"),
            None => "a list of values".to_owned(),
        };
        let fits = |list: &&toml::de::DeArray<'_>| {
            count.map_or(list.iter().count() > 0, |count| {
                list.iter().count() == count
            })
        };
        let Some(list) = list.filter(fits) else {
            self.fields.wrong_type(value, &wanted);
            return None;
        };
        let values: Vec<Option<Text>> = list.iter().map(|value| self.value(value)).collect();
        values.into_iter().collect()
    }

    /// One of several words.
    pub(super) fn word<T: Copy>(&mut self, text: &Text, words: &[(&'static str, T)]) -> Option<T> {
        let found = words.iter().find(|(word, _)| *word == text.text);
        if found.is_none() {
            let names = || words.iter().map(|(word, _)| *word);
            let help = did_you_mean(&text.text, names(), || {
                format!("the words are {}", names().collect::<Vec<_>>().join(", "))
            });
            let message = format!("unknown word `{}`", shown(&text.text));
            self.tell(Code::UnknownWord, message, text.at.clone(), &help);
        }
        found.map(|(_, value)| *value)
    }

    pub(super) fn sampling(&mut self, table: &DeTable<'_>) -> Option<Sampling> {
        let word = self.text(table, "sampling")?;
        self.word(&word, &Sampling::ALL)
    }

    pub(super) fn correlations(&mut self, table: &DeTable<'_>) -> Vec<(Text, Text, f64)> {
        let Some(value) = table.get("correlations") else {
            return Vec::new();
        };
        let Some(list) = value.get_ref().as_array() else {
            self.fields
                .wrong_type(value, "a list such as [[\"m\", \"h\", 0.6]]");
            return Vec::new();
        };
        let mut read = Vec::new();
        for value in list {
            let Some(triple) = self.values(value, Some(3)) else {
                continue;
            };
            let Ok([a, b, number]) = <[Text; 3]>::try_from(triple) else {
                continue;
            };
            match number.text.parse::<f64>() {
                Ok(number) if number.abs() < 1.0 => read.push((a, b, number)),
                _ => self.tell(
                    Code::ValueOutsideLimits,
                    "a correlation is a number between -1 and 1",
                    number.at,
                    "",
                ),
            }
        }
        read
    }
}
