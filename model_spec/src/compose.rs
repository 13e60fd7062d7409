//! Specs composed from parts: additional items, and expressions substituted for names.

use toml_edit::{DocumentMut, Item, TableLike, Value};

use crate::edit::EditError;
use crate::expr::Word;
use crate::foreign::sentence;
use crate::language::{Form, Key, SECTIONS, Shape};

/// A spec that grows, with its comments and layout untouched.
#[derive(Debug, Clone)]
pub struct Composition {
    document: DocumentMut,
}

impl Composition {
    /// Starts with the text of a spec.
    pub fn new(text: &str) -> Result<Self, EditError> {
        Ok(Self {
            document: document(text)?,
        })
    }

    /// Adds the items of a fragment, which has the syntax and the sections of a spec. Where the spec
    /// has an item of the same name, the keys of the fragment replace its own.
    pub fn add(&mut self, fragment: &str) -> Result<(), EditError> {
        self.add_noted(fragment, "")
    }

    /// Adds the items of a fragment, with a comment above the new items of each section.
    pub fn add_noted(&mut self, fragment: &str, note: &str) -> Result<(), EditError> {
        let fragment = document(fragment)?;
        for (section, items) in fragment.iter() {
            let Some(items) = items.as_table_like() else {
                continue;
            };
            let own = self.document.entry(section).or_insert(toml_edit::table());
            let own = own.as_table_like_mut().ok_or_else(|| EditError::Syntax {
                message: format!("`{section}` is not a section"),
            })?;
            let mut note = note;
            for (name, item) in items.iter() {
                if merge(own, name, item) && !note.is_empty() {
                    comment(own, name, note);
                    note = "";
                }
            }
        }
        Ok(())
    }

    /// Substitutes an expression for a name in all expressions of the sections.
    pub fn substitute(&mut self, sections: &[&str], name: &str, by: &str) {
        for section in sections {
            let keys = keys(section);
            let Some(items) = self
                .document
                .get_mut(section)
                .and_then(Item::as_table_like_mut)
            else {
                continue;
            };
            for (_, item) in items.iter_mut() {
                if let Some(table) = item.as_table_like_mut() {
                    replace_in(table, &keys, name, by);
                }
            }
        }
    }

    /// The text of the composed spec.
    pub fn text(&self) -> String {
        self.document.to_string()
    }
}

fn document(text: &str) -> Result<DocumentMut, EditError> {
    text.parse()
        .map_err(|e: toml_edit::TomlError| EditError::Syntax {
            message: e.message().to_owned(),
        })
}

/// Whether the item is new.
fn merge(own: &mut dyn TableLike, name: &str, item: &Item) -> bool {
    let there = own.get_mut(name).and_then(Item::as_table_like_mut);
    match (there, item.as_table_like()) {
        (Some(there), Some(keys)) => {
            for (key, value) in keys.iter() {
                there.insert(key, value.clone());
            }
            false
        }
        _ => own.insert(name, item.clone()).is_none(),
    }
}

/// Writes a comment above an item.
fn comment(own: &mut dyn TableLike, name: &str, note: &str) {
    let comment = format!("# {}\n", sentence(note));
    if let Some(Item::Table(table)) = own.get_mut(name) {
        table.decor_mut().set_prefix(format!("\n{comment}"));
    } else if let Some(mut key) = own.key_mut(name) {
        key.leaf_decor_mut().set_prefix(comment);
    }
}

/// Keys of a section.
fn keys(section: &str) -> Vec<&'static Key> {
    let section = SECTIONS.iter().find(|known| known.name == section);
    match section.map(|section| &section.shape) {
        Some(Shape::Items(keys, _) | Shape::Table(keys)) => keys.iter().collect(),
        Some(Shape::Kinds(kinds)) => kinds.iter().flat_map(|kind| kind.keys).collect(),
        Some(Shape::States) | None => Vec::new(),
    }
}

/// Substitutes an expression for a name in the expressions of a table.
fn replace_in(table: &mut dyn TableLike, keys: &[&'static Key], name: &str, by: &str) {
    for (key, item) in table.iter_mut() {
        let mut forms = keys.iter().filter(|own| own.name == key.get());
        let form = forms.find_map(|own| match own.form {
            Form::Expression | Form::Components | Form::Matrix | Form::Inertia(_) => Some(None),
            Form::Tables(inner) => Some(Some(inner)),
            _ => None,
        });
        match (form, item) {
            (Some(None), Item::Value(value)) => replace(value, name, by),
            (Some(Some(inner)), Item::Value(Value::Array(tables))) => {
                let inner: Vec<&Key> = inner.iter().collect();
                for table in tables.iter_mut().filter_map(Value::as_inline_table_mut) {
                    replace_in(table, &inner, name, by);
                }
            }
            (Some(Some(inner)), Item::ArrayOfTables(tables)) => {
                let inner: Vec<&Key> = inner.iter().collect();
                for table in tables.iter_mut() {
                    replace_in(table, &inner, name, by);
                }
            }
            _ => {}
        }
    }
}

fn replace(value: &mut Value, name: &str, by: &str) {
    match value {
        Value::String(text) => {
            let replaced = replaced(text.value(), name, by);
            if replaced != *text.value() {
                let decor = text.decor().clone();
                *value = Value::from(replaced);
                *value.decor_mut() = decor;
            }
        }
        Value::Array(parts) => parts.iter_mut().for_each(|part| replace(part, name, by)),
        _ => {}
    }
}

/// An expression with `by` substituted for a name; units in brackets are kept.
fn replaced(expression: &str, name: &str, by: &str) -> String {
    let mut out = String::with_capacity(expression.len());
    let mut rest = expression;
    while let Some(first) = rest.chars().next() {
        let is_word = |c: char| c.is_alphanumeric() || c == '_';
        let mut len = if first == '[' {
            rest.find(']').map_or(rest.len(), |end| end + 1)
        } else if is_word(first) {
            rest.find(|c| !is_word(c)).unwrap_or(rest.len())
        } else {
            first.len_utf8()
        };
        // `velocity(P, x)` has names of items and axes.
        if Word::from_name(&rest[..len]).is_some() && rest[len..].starts_with('(') {
            len = rest.find(')').map_or(rest.len(), |end| end + 1);
        }
        let (part, after) = rest.split_at(len);
        if part == name {
            out += "(";
            out += by;
            out += ")";
        } else {
            out += part;
        }
        rest = after;
    }
    out
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;

    const SPEC: &str = "\
# A rig.
[parameters]
m = { value = 10, unit = \"kg\" }  # weighed

[bodies.cart]
centre = \"C\"
mass   = \"m\"

[loads]
push = { kind = \"force\", on = \"F\", vector = [\"F + 2 [F]\", 0, \"F_1\"] }
[frames]
arm = { parent = \"ground\", turns = [{ about_axis = \"x\", by = \"pi/2\" }, { about_axis = \"z\", by = \"q\" }] }
";

    #[test]
    fn items_are_added_and_keys_replaced_while_comments_stay() {
        let mut spec = Composition::new(SPEC).unwrap();
        let fragment = "\
[parameters]
c = { value = 0, unit = \"N\" }
[bodies]
cart = { centre = \"D\" }
[points]
D = { from = \"C\" }
";
        spec.add(fragment).unwrap();
        let text = spec.text();
        assert!(text.contains("# weighed"), "{text}");
        let read: DocumentMut = text.parse().unwrap();
        assert_eq!(read["parameters"]["c"]["unit"].as_str(), Some("N"));
        assert_eq!(read["bodies"]["cart"]["centre"].as_str(), Some("D"));
        assert_eq!(read["bodies"]["cart"]["mass"].as_str(), Some("m"));
        assert_eq!(read["points"]["D"]["from"].as_str(), Some("C"));
    }

    #[test]
    fn what_is_new_has_a_comment_above_it() {
        let mut spec = Composition::new(SPEC).unwrap();
        let fragment = "\
[parameters]
m = { value = 11 }
c = { value = 0, unit = \"N\" }
d = { value = 0, unit = \"N\" }
[bodies.box]
centre = \"C\"
";
        spec.add_noted(fragment, "found").unwrap();
        let text = spec.text();
        for expected in [
            "# weighed\n# found\nc = {",
            "}\nd = {",
            "# found\n[bodies.box]",
        ] {
            assert!(text.contains(expected), "{expected} in\n{text}");
        }
        assert!(text.parse::<DocumentMut>().is_ok());
    }

    #[test]
    fn whole_names_in_expressions_are_replaced_and_nothing_else() {
        let mut spec = Composition::new(SPEC).unwrap();
        spec.substitute(&["loads"], "F", "F + b");
        let read: DocumentMut = spec.text().parse().unwrap();
        let push = &read["loads"]["push"];
        assert_eq!(push["on"].as_str(), Some("F"));
        assert_eq!(push["vector"][0].as_str(), Some("(F + b) + 2 [F]"));
        assert_eq!(push["vector"][2].as_str(), Some("F_1"));
    }

    #[test]
    fn expressions_of_several_turns_are_replaced() {
        let mut spec = Composition::new(SPEC).unwrap();
        spec.substitute(&["frames"], "q", "q - b");
        let read: DocumentMut = spec.text().parse().unwrap();
        let turns = read["frames"]["arm"]["turns"].as_array().unwrap();
        let by = turns
            .iter()
            .map(|turn| turn.as_inline_table().unwrap()["by"].as_str());
        assert_eq!(by.collect::<Vec<_>>(), [Some("pi/2"), Some("(q - b)")]);
    }
}
