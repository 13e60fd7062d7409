//! Values of a study file, each with its place, and how they are read.

use appell_recordings::fields::{Fields, Value};
use appell_spec::diagnostic::MAX_SHOWN;
use appell_spec::expr::Span;
use appell_spec::limits::MAX_SENTENCE;
use appell_spec::{Code, did_you_mean, is_forbidden, name, shown};
use toml::de::{DeTable, DeValue};

use crate::design::Sampling;
use crate::limits::{MAX_ENTRIES, MAX_LIST};

/// The text of the file with its findings.
pub(super) struct Reader<'t> {
    pub(super) fields: Fields<'t>,
    pub(super) document: &'t str,
}

impl Reader<'_> {
    pub(super) fn tell(&mut self, code: Code, message: impl Into<String>, at: Span, help: &str) {
        self.fields.tell(code, message, at, help);
    }

    /// Rejects invisible characters and those that reorder the visible ones.
    pub(super) fn characters(&mut self) {
        let hidden = self
            .document
            .char_indices()
            .filter(|(at, c)| is_forbidden(*c) && !(*at == 0 && *c == '\u{feff}'));
        for (at, c) in hidden.take(MAX_SHOWN) {
            let message = format!("the character U+{:04X} is not allowed", u32::from(c));
            let at = at..at + c.len_utf8();
            self.tell(Code::ForbiddenCharacter, message, at, "remove it");
        }
    }

    /// A number or a text.
    pub(super) fn value(&mut self, value: &Value<'_>) -> Option<Text> {
        let text = match value.get_ref() {
            DeValue::String(text) => text.to_string(),
            // In base ten, as expressions have it.
            DeValue::Integer(integer) => i128::from_str_radix(integer.as_str(), integer.radix())
                .map_or_else(|_| integer.to_string(), |whole| whole.to_string()),
            DeValue::Float(float) => float.to_string(),
            _ => {
                self.fields
                    .wrong_type(value, "a number, or a text such as \"30cm\"");
                return None;
            }
        };
        self.plain(Text {
            text,
            at: value.span(),
        })
    }

    /// A text that may be absent.
    pub(super) fn text(&mut self, table: &DeTable<'_>, key: &str) -> Option<Text> {
        let (text, at) = self.fields.string(table, key)?;
        self.plain(Text { text, at })
    }

    /// A text of one line without invisible characters, which escapes may contain.
    fn plain(&mut self, text: Text) -> Option<Text> {
        let Some(c) = text
            .text
            .chars()
            .find(|c| is_forbidden(*c) || c.is_control())
        else {
            return Some(text);
        };
        let message = format!("the character U+{:04X} is not allowed here", u32::from(c));
        let help = "write one line of plain text";
        self.tell(Code::ForbiddenCharacter, message, text.at, help);
        None
    }

    /// A sentence that may be absent.
    pub(super) fn sentence(&mut self, table: &DeTable<'_>, key: &str) -> String {
        let Some(sentence) = self.text(table, key) else {
            return String::new();
        };
        if sentence.text.len() > MAX_SENTENCE {
            let message = format!("`{key}` has more than {MAX_SENTENCE} bytes");
            self.tell(Code::LimitExceeded, message, sentence.at, "shorten it");
        }
        sentence.text
    }

    /// A finite number that may be absent.
    pub(super) fn number(&mut self, table: &DeTable<'_>, key: &str) -> Option<Placed<f64>> {
        let value = table.get(key)?;
        Some(Placed {
            value: self.fields.number(value)?,
            at: value.span(),
        })
    }

    /// A positive number, up to a largest one, that may be absent.
    pub(super) fn positive(
        &mut self,
        table: &DeTable<'_>,
        key: &str,
        most: f64,
    ) -> Option<Placed<f64>> {
        let number = self.number(table, key)?;
        if number.value > 0.0 && number.value <= most {
            return Some(number);
        }
        let message = if number.value > 0.0 {
            format!("`{key}` must not be larger than {most}")
        } else {
            format!("`{key}` must be a positive number")
        };
        self.tell(Code::ValueOutsideLimits, message, number.at, "");
        None
    }

    /// An optional non-negative integer.
    pub(super) fn whole(&mut self, table: &DeTable<'_>, key: &str) -> Option<Placed<u64>> {
        let value = table.get(key)?;
        let DeValue::Integer(integer) = value.get_ref() else {
            self.fields.wrong_type(value, "a whole number");
            return None;
        };
        let at = value.span();
        match u64::from_str_radix(integer.as_str(), integer.radix()) {
            Ok(value) => Some(Placed { value, at }),
            Err(_) if integer.as_str().starts_with('-') => {
                let message = format!("`{key}` must be a whole number that is not negative");
                self.tell(Code::ValueOutsideLimits, message, at, "");
                None
            }
            Err(_) => {
                let message = format!("`{key}` is a number of more than 64 bits");
                self.tell(Code::LimitExceeded, message, at, "write a smaller one");
                None
            }
        }
    }

    /// An optional integer from 1 to a maximum.
    pub(super) fn count(
        &mut self,
        table: &DeTable<'_>,
        key: &str,
        most: u64,
    ) -> Option<Placed<u64>> {
        let number = self.whole(table, key)?;
        if number.value == 0 {
            let message = format!("`{key}` must be at least 1");
            self.tell(Code::ValueOutsideLimits, message, number.at, "");
            return None;
        }
        if number.value > most {
            let message = format!("`{key}` is {}, at most {most} are possible", number.value);
            self.tell(
                Code::LimitExceeded,
                message,
                number.at,
                "write a smaller number",
            );
            return None;
        }
        Some(number)
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

    /// The only one of several keys that an entry has. Else `wrong` tells what is wrong with none and with several of
    /// them, unless an unknown key has been reported already.
    pub(super) fn only_one(
        &mut self,
        name: &Text,
        entry: &DeTable<'_>,
        [forms, others]: [&[&'static str]; 2],
        wrong: [&str; 2],
    ) -> Option<&'static str> {
        let given = forms.iter().filter(|form| entry.contains_key(**form));
        let given: Vec<&str> = given.copied().collect();
        let is_known = |key: &str| forms.contains(&key) || others.contains(&key);
        if let [form] = given[..] {
            return Some(form);
        }
        if !given.is_empty() || entry.keys().all(|key| is_known(key.get_ref())) {
            let message = format!("`{}` {}", name.text, wrong[usize::from(!given.is_empty())]);
            let help = format!("write one of {}", forms.join(", "));
            self.tell(Code::ConflictingKeys, message, name.at.clone(), &help);
        }
        None
    }

    /// The items of a section in the order of the text. Their names are those of specs: columns, figures and files
    /// are called after them.
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
        if let Some((name, _)) = named.get(MAX_ENTRIES) {
            let message = format!("`[{section}]` has more than {MAX_ENTRIES} entries");
            self.tell(Code::LimitExceeded, message, name.at.clone(), "remove some");
            named.truncate(MAX_ENTRIES);
        }
        named.retain(|(name, _)| {
            // Numbers of a robot file are called `ELEMENT.ATTRIBUTE`.
            let of_model = section != "keep";
            let is_valid =
                name::is_valid(&name.text) || of_model && name.text.split('.').all(name::is_valid);
            if !is_valid {
                let message = format!("`{}` is not a valid name", shown(&name.text));
                let help = format!("a name is {}", name::RULE);
                self.tell(Code::InvalidName, message, name.at.clone(), &help);
            }
            is_valid
        });
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
        if let Some(value) = list.get(MAX_LIST) {
            let message = format!("a list of more than {MAX_LIST} values");
            let help = "write them as `range = [from, to]` with `count`, or into a `table`";
            self.tell(Code::LimitExceeded, message, value.span(), help);
            return None;
        }
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

    pub(super) fn sampling(&mut self, table: &DeTable<'_>) -> Option<Placed<Sampling>> {
        let word = self.text(table, "sampling")?;
        let value = self.word(&word, &Sampling::ALL)?;
        Some(Placed { value, at: word.at })
    }

    /// Pairs of factors with their correlations, each pair once.
    pub(super) fn correlations(&mut self, table: &DeTable<'_>) -> Vec<Correlation> {
        let Some(value) = table.get("correlations") else {
            return Vec::new();
        };
        let Some(list) = value.get_ref().as_array() else {
            self.fields
                .wrong_type(value, "a list such as [[\"m\", \"h\", 0.6]]");
            return Vec::new();
        };
        let mut read: Vec<Correlation> = Vec::new();
        for value in list.iter().take(MAX_LIST) {
            let Some(triple) = self.values(value, Some(3)) else {
                continue;
            };
            let Ok([a, b, number]) = <[Text; 3]>::try_from(triple) else {
                continue;
            };
            let pair = [a.text.as_str(), b.text.as_str()];
            let mut others = read
                .iter()
                .map(|other| other.pair.each_ref().map(|own| own.text.as_str()));
            let message = match number.text.parse::<f64>() {
                _ if a.text == b.text => "a quantity is always correlated with itself",
                _ if others.any(|[c, d]| [c, d] == pair || [d, c] == pair) => {
                    "this pair has a correlation already"
                }
                Ok(value) if value.abs() <= 1.0 => {
                    let value = Placed {
                        value,
                        at: number.at,
                    };
                    read.push(Correlation {
                        pair: [a, b],
                        value,
                    });
                    continue;
                }
                _ => "a correlation is a number from -1 to 1",
            };
            self.tell(Code::ValueOutsideLimits, message, value.span(), "");
        }
        read
    }
}

/// A text with its place in the study file, which its `Debug` leaves out.
#[derive(Clone, PartialEq, Eq)]
pub struct Text {
    /// The text; of a number its digits.
    pub text: String,
    /// Its position, quotes included.
    pub at: Span,
}

impl std::fmt::Debug for Text {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.text.fmt(f)
    }
}

/// A value with its place in the study file, which its `Debug` leaves out.
#[derive(Clone, PartialEq)]
pub struct Placed<T> {
    /// The value.
    pub value: T,
    /// Its position.
    pub at: Span,
}

impl<T: std::fmt::Debug> std::fmt::Debug for Placed<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.value.fmt(f)
    }
}

/// A pair of factors with the correlation of their normal scores.
#[derive(Debug, Clone, PartialEq)]
pub struct Correlation {
    /// Their names.
    pub pair: [Text; 2],
    /// From −1 to 1.
    pub value: Placed<f64>,
}

/// A name with a value.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Entry {
    /// The name.
    pub name: Text,
    /// The value.
    pub value: Text,
}
