//! Sections, items and tables of keys.

use toml::de::{DeTable, DeValue};

use crate::ast::{Entry, ItemAst, Spanned, ValueAst};
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::Span;
use crate::language::{Form, ItemKind, Key, Kind, LoadWord, Need, Section, Shape};
use crate::limits::{MAX_ITEMS, MAX_PARAMETERS};
use crate::name;
use crate::suggest::{self, did_you_mean, shown};

use super::reader::{Reader, TomlKey, TomlValue, in_text_order, phrase};

/// The form of every value in a section of numbers.
static STATE_VALUE: Key = Key {
    name: "value",
    form: Form::Number,
    need: Need::Always,
    about: "Initial value in the unit of the state.",
};

/// Name and position of the definition of a table.
struct Owner<'a> {
    name: &'a str,
    span: Span,
}

impl Reader<'_> {
    pub(super) fn items(
        &mut self,
        section: &'static Section,
        key: &TomlKey<'_>,
        table: &DeTable<'_>,
    ) -> Vec<ItemAst> {
        if let Shape::Table(keys) = section.shape {
            let owner = Owner {
                name: section.name,
                span: key.span(),
            };
            return vec![self.keys(&owner, keys, None, table)];
        }
        let most = match section.name {
            "parameters" => MAX_PARAMETERS,
            _ => MAX_ITEMS,
        };
        if table.len() > most {
            self.incomplete = true;
            let message = format!("`[{}]` has at most {most} items", section.name);
            self.exceeded(key.span(), message, table.len(), "items");
        }
        let mut items = Vec::new();
        for (key, value) in in_text_order(table).into_iter().take(most) {
            if self.is_valid_name(key.get_ref(), key.span()) {
                items.extend(self.item(section, key, value));
            } else {
                self.incomplete = true;
            }
        }
        items
    }

    fn item(
        &mut self,
        section: &'static Section,
        key: &TomlKey<'_>,
        value: &TomlValue<'_>,
    ) -> Option<ItemAst> {
        let owner = Owner {
            name: key.get_ref(),
            span: key.span(),
        };
        let item = match (&section.shape, value.get_ref()) {
            (Shape::Items(keys, _), DeValue::Table(table)) => self.keys(&owner, keys, None, table),
            (Shape::Items(keys, Some(only)), _) => {
                let key = keys.iter().find(|k| k.name == *only)?;
                self.single(&owner, key, value)
            }
            (Shape::States, _) => self.single(&owner, &STATE_VALUE, value),
            (Shape::Kinds(kinds), DeValue::Table(table)) => self.kind(&owner, kinds, table),
            _ => {
                self.wrong_type(value, "a table");
                empty(&owner)
            }
        };
        Some(item)
    }

    /// An item that is written as one bare value.
    fn single(&mut self, owner: &Owner<'_>, key: &'static Key, value: &TomlValue<'_>) -> ItemAst {
        let mut item = empty(owner);
        if let Some(read) = self.value(key, value) {
            item.entries.push(Entry {
                key,
                span: value.span(),
                value: read,
            });
            item.intact = true;
        }
        item
    }

    /// An item whose keys depend on its kind.
    fn kind(&mut self, owner: &Owner<'_>, kinds: &'static [Kind], table: &DeTable<'_>) -> ItemAst {
        let list = || {
            let words = suggest::list(kinds.iter().map(|k| k.word));
            format!("the kinds are {words}")
        };
        let Some(value) = table.get("kind") else {
            self.missing_key(owner, "kind", &list());
            return empty(owner);
        };
        let DeValue::String(word) = value.get_ref() else {
            self.wrong_type(value, "one of the kinds, as a string");
            return empty(owner);
        };
        let Some(kind) = kinds.iter().find(|k| k.word == word.as_ref()) else {
            let instead = kinds
                .iter()
                .find_map(|kind| written_otherwise(kind, word, owner.name));
            let help =
                instead.unwrap_or_else(|| did_you_mean(word, kinds.iter().map(|k| k.word), list));
            self.unknown_word(
                format!("unknown kind `{}`", shown(word)),
                value.span(),
                help,
            );
            return empty(owner);
        };
        self.keys(owner, kind.keys, Some((kind, kinds)), table)
    }

    pub(super) fn unknown_word(&mut self, message: String, at: Span, help: String) {
        self.error(Code::UnknownWord, at, message, help);
    }

    fn keys(
        &mut self,
        owner: &Owner<'_>,
        keys: &'static [Key],
        kind: Option<(&'static Kind, &'static [Kind])>,
        table: &DeTable<'_>,
    ) -> ItemAst {
        let mut item = empty(owner);
        item.kind = kind.map(|k| k.0);
        item.intact = true;
        let mut meant: Vec<&str> = Vec::new();
        for (name, value) in in_text_order(table) {
            let text = name.get_ref().as_ref();
            if kind.is_some() && text == "kind" {
                continue;
            }
            let Some(key) = keys.iter().find(|k| k.name == text) else {
                item.intact = false;
                meant.extend(self.unknown_key(text, name.span(), keys, kind));
                continue;
            };
            match self.value(key, value) {
                Some(read) => item.entries.push(Entry {
                    key,
                    span: value.span(),
                    value: read,
                }),
                None => item.intact = false,
            }
        }
        let present = |key: &Key| table.contains_key(key.name) || meant.contains(&key.name);
        item.intact &= self.required(owner, keys, table, present);
        item
    }

    /// Reports an unknown key; returns the probably intended one.
    fn unknown_key(
        &mut self,
        name: &str,
        at: Span,
        keys: &'static [Key],
        kind: Option<(&'static Kind, &'static [Kind])>,
    ) -> Option<&'static str> {
        let similar = suggest::closest(name, keys.iter().map(|k| k.name));
        let elsewhere = kind.and_then(|(_, kinds)| {
            kinds
                .iter()
                .find(|k| k.keys.iter().any(|key| key.name == name))
        });
        let help = match (similar, elsewhere) {
            (Some(similar), _) => suggest::meant(similar),
            (None, Some(other)) => format!("`{name}` belongs to the kind `{}`", other.word),
            (None, None) => {
                format!(
                    "the keys are {}",
                    suggest::list(keys.iter().map(|k| k.name))
                )
            }
        };
        let message = format!("unknown key `{}`", shown(name));
        self.error(Code::UnknownKey, at, message, help);
        similar
    }

    /// Checks that all required keys are present, and only one of several alternatives.
    fn required(
        &mut self,
        owner: &Owner<'_>,
        keys: &'static [Key],
        table: &DeTable<'_>,
        present: impl Fn(&Key) -> bool,
    ) -> bool {
        let mut complete = true;
        for key in keys.iter().filter(|k| k.need == Need::Always) {
            if !present(key) {
                self.missing_key(owner, key.name, &phrase(key.about));
                complete = false;
            }
        }
        let way = |n: u8| keys.iter().filter(move |k| k.need == Need::Way(n));
        let ways: Vec<u8> = (0..3).filter(|n| way(*n).next().is_some()).collect();
        let chosen: Vec<u8> = ways
            .iter()
            .copied()
            .filter(|n| way(*n).any(&present))
            .collect();
        match chosen.as_slice() {
            [] if ways.is_empty() => {}
            [] => {
                let texts: Vec<String> = ways
                    .iter()
                    .map(|n| join(way(*n).map(|k| k.name), " with "))
                    .collect();
                self.missing_key(
                    owner,
                    way(ways[0]).next().map_or("", |k| k.name),
                    &format!("write {}", texts.join(", or ")),
                );
                complete = false;
            }
            [one] => {
                for key in way(*one) {
                    if !present(key) {
                        self.missing_key(owner, key.name, &phrase(key.about));
                        complete = false;
                    }
                }
            }
            [first, second, ..] => {
                let [first, second] = [*first, *second].map(|n| {
                    let place = in_text_order(table)
                        .into_iter()
                        .find(|(name, _)| way(n).any(|k| k.name == name.get_ref().as_ref()))
                        .map_or_else(|| owner.span.clone(), |(name, _)| name.span());
                    (join(way(n).map(|k| k.name), " with "), place)
                });
                self.conflict(owner, first, second);
                complete = false;
            }
        }
        complete
    }

    fn missing_key(&mut self, owner: &Owner<'_>, key: &str, help: &str) {
        if self.broken {
            return;
        }
        self.tell(
            Diagnostic::error(Code::MissingKey, format!("`{}` has no `{key}`", owner.name))
                .at(owner.span.clone(), format!("`{key}` is missing"))
                .help(help),
        );
    }

    /// Reports two mutually exclusive keys, at the later one.
    fn conflict(&mut self, owner: &Owner<'_>, a: (String, Span), b: (String, Span)) {
        let (first, second) = if a.1.start <= b.1.start {
            (a, b)
        } else {
            (b, a)
        };
        let message = format!("`{}` has both {} and {}", owner.name, first.0, second.0);
        let help = format!("keep either {} or {}", first.0, second.0);
        let finding = Diagnostic::error(Code::ConflictingKeys, message);
        self.tell(
            finding
                .at(second.1, "said again")
                .at(first.1, "said here")
                .help(help),
        );
    }

    /// Whether a name may be defined; `false` where that has been reported.
    pub(super) fn is_valid_name(&mut self, name: &str, at: Span) -> bool {
        if name::is_valid(name) {
            return true;
        }
        let message = format!("`{}` is not a valid name", shown(name));
        let help = format!("a name is {}", name::RULE);
        self.error(Code::InvalidName, at, message, help);
        false
    }

    /// A table inside a value.
    pub(super) fn inner_table(
        &mut self,
        name: &str,
        keys: &'static [Key],
        value: &TomlValue<'_>,
    ) -> Option<ValueAst> {
        self.table_item(name, keys, value)
            .map(|item| ValueAst::Table(Box::new(item)))
    }

    pub(super) fn table_item(
        &mut self,
        name: &str,
        keys: &'static [Key],
        value: &TomlValue<'_>,
    ) -> Option<ItemAst> {
        let DeValue::Table(table) = value.get_ref() else {
            self.wrong_type(value, "a table");
            return None;
        };
        let owner = Owner {
            name,
            span: value.span(),
        };
        Some(self.keys(&owner, keys, None, table))
    }
}

/// An item with a name only.
fn empty(owner: &Owner<'_>) -> ItemAst {
    ItemAst {
        name: Spanned {
            value: owner.name.to_owned(),
            span: owner.span.clone(),
        },
        kind: None,
        entries: Vec::new(),
        intact: false,
    }
}

fn join<'a>(names: impl Iterator<Item = &'a str>, with: &str) -> String {
    names
        .map(|name| format!("`{name}`"))
        .collect::<Vec<_>>()
        .join(with)
}

/// The line to suggest for words that are no kinds of loads, such as `motor` and `weight`.
fn written_otherwise(kind: &Kind, word: &str, name: &str) -> Option<String> {
    let generalized = |force: &str| {
        format!(
            "write `{name} = {{ kind = \"generalized\", coordinate = \"q\", force = \"{force}\" }}`"
        )
    };
    let name = shown(name);
    let ItemKind::Load(LoadWord::Generalized) = kind.is else {
        return None;
    };
    match word.to_ascii_lowercase().as_str() {
        "friction" | "coulomb" | "dry_friction" | "stiction" => {
            let line = generalized("-F*smooth_sign(dot(q), 0.01 [rad/s])");
            Some(format!(
                "{line}, F being the friction; what grows with the speed is of kind \"damper\""
            ))
        }
        "motor" | "actuator" | "drive" => Some(generalized("tau") + " with an input `tau`"),
        "viscous" | "dashpot" => Some(format!(
            "write `{name} = {{ kind = \"damper\", coordinate = \"q\", damping = \"c\" }}`"
        )),
        "weight" => Some(format!(
            "write `{name} = {{ kind = \"gravity\", down = \"-z\", acceleration = \"g\" }}`"
        )),
        _ => None,
    }
}
