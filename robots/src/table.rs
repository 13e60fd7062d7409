//! Sections of a spec as TOML, one item a line.

use std::fmt::Write as _;

pub(crate) use appell_spec::foreign::toml_string as quoted;

use crate::names::Names;
use crate::xml::Span;

/// A section with its items.
#[derive(Debug, Default)]
pub(crate) struct Section {
    items: Vec<(String, String)>,
    names: Names,
    /// Where in the file of the robot the items come from, as far as that is known.
    places: Vec<Span>,
}

/// Keys of an item, in order.
#[derive(Debug, Default)]
pub(crate) struct Item(Vec<String>);

impl Item {
    /// A key with a sentence or a name.
    pub(crate) fn text(self, key: &str, value: &str) -> Self {
        self.raw(key, &quoted(value))
    }

    /// A key with a TOML value.
    pub(crate) fn raw(mut self, key: &str, value: &str) -> Self {
        self.0.push(format!("{key} = {value}"));
        self
    }

    /// A key with a sentence if a condition holds.
    pub(crate) fn text_if(self, holds: bool, key: &str, value: &str) -> Self {
        if holds { self.text(key, value) } else { self }
    }

    /// A key with a TOML value if a condition holds.
    pub(crate) fn raw_if(self, holds: bool, key: &str, value: &str) -> Self {
        if holds { self.raw(key, value) } else { self }
    }

    /// A key with an expression; a plain number needs no quotes.
    pub(crate) fn expression(self, key: &str, value: &str) -> Self {
        self.raw(key, &expression(value))
    }

    /// A generalised force along what a key and its value give.
    pub(crate) fn generalized((key, along): (&str, &str), force: &str) -> Self {
        let item = Self::default().text("kind", "generalized");
        item.text(key, along).text("force", force)
    }

    /// A point, with its components from another one in a frame.
    pub(crate) fn point(from: &str, frame: &str, at: &[String]) -> Self {
        let item = Self::default().text("from", from).text("in", frame);
        item.raw("at", &list(at))
    }

    /// A key with a list of expressions.
    pub(crate) fn expressions(self, key: &str, values: &[String]) -> Self {
        self.raw(key, &list(values))
    }

    /// The inline table.
    pub(crate) fn table(&self) -> String {
        format!("{{ {} }}", self.0.join(", "))
    }
}

fn expression(text: &str) -> String {
    let is_number =
        text.parse::<f64>().is_ok() && text.starts_with(|c: char| c.is_ascii_digit() || c == '-');
    if is_number {
        text.to_owned()
    } else {
        quoted(text)
    }
}

/// A TOML list of expressions.
pub(crate) fn list(values: &[String]) -> String {
    let values: Vec<String> = values.iter().map(|value| expression(value)).collect();
    format!("[{}]", values.join(", "))
}

impl Section {
    /// Adds an item, and returns its name; a number is appended to it if it is taken.
    pub(crate) fn add(&mut self, name: &str, item: &Item) -> String {
        let name = self.names.new_one(name);
        self.items.push((name.clone(), item.table()));
        name
    }

    /// Adds a key whose value is no table.
    pub(crate) fn key(&mut self, name: &str, value: String) {
        self.items.push((name.to_owned(), value));
    }

    /// Records the source of the items that were added since the last call.
    pub(crate) fn mark(&mut self, place: &Span) {
        self.places.resize(self.items.len(), place.clone());
    }

    /// Writes the section, unless it is empty; keeps for each line where it begins and where it comes from.
    pub(crate) fn write(&self, title: &str, to: &mut String, lines: &mut Vec<(usize, Span)>) {
        if self.items.is_empty() {
            return;
        }
        let width = self
            .items
            .iter()
            .map(|(name, _)| name.len())
            .max()
            .unwrap_or(0);
        let _ = writeln!(to, "\n[{title}]");
        for (index, (name, value)) in self.items.iter().enumerate() {
            lines.extend(
                self.places
                    .get(index)
                    .map(|place| (to.len(), place.clone())),
            );
            let _ = writeln!(to, "{name:width$} = {value}");
        }
    }
}
