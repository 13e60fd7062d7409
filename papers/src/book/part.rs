//! A part of the book in the making: its texts are a file next to the source that computes it.

use std::collections::BTreeMap;
use std::fmt::Display;

use appell_runtime::model::ModelInfo;
use serde::Deserialize;

use super::claim::{Claim, Picture, Reproduction, Section, Statement};
use super::{Result, computation, failed};

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

    /// The statement of a key.
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

    /// Values of a table of parameters: name, the unit as printed, value in SI.
    pub(crate) fn parameters(
        &mut self,
        info: &ModelInfo,
        table: &[(&str, &str, f64)],
    ) -> Result<()> {
        for (name, unit, value) in table {
            let index = info.parameter_index(name);
            let found = index.map_or(f64::NAN, |index| info.parameters[index].value);
            self.set("parameter", format!("{name} = {value}{unit}"));
            self.number("parameter", [*value, found])?;
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
