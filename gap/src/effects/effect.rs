//! What the file of an effect says.
//!
//! ```toml
//! [effect]
//! family   = "force"                 # force, parameter, actuator, sensor, constraint, joint
//! site     = "coordinate"            # see SiteKind
//! about    = "spring at {site}"
//! variants = [{ part = "0.5" }]      # each a hypothesis of its own; its words stand in the text
//! switch   = "{effect}_on"           # a parameter that is 1 where the effect is there
//! filter   = "lag"                   # what acts beside the equations: lag, delay, bias, scale, late
//!
//! [parameters]                       # value 0: how much of the effect there is; other values: its shape
//! "{effect}_stiffness" = { value = 0, unit = "{force}/({unit})" }
//!
//! [loads]                            # and any other section of the spec language
//! "{effect}" = { kind = "generalized", coordinate = "{site}", force = "-{effect}_stiffness*{site}" }
//!
//! [input]                            # what is added to an input wherever it acts
//! ```

use toml_edit::{DocumentMut, Item, TableLike};

use super::site::SiteKind;

/// Where effects belong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[expect(missing_docs, reason = "the words of the report")]
pub enum Family {
    Force,
    Parameter,
    Actuator,
    Constraint,
    Joint,
    Sensor,
}

impl Family {
    const ALL: [Self; 6] = [
        Self::Force,
        Self::Parameter,
        Self::Actuator,
        Self::Constraint,
        Self::Joint,
        Self::Sensor,
    ];

    /// Its word.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Force => "force",
            Self::Parameter => "parameter",
            Self::Actuator => "actuator",
            Self::Constraint => "constraint",
            Self::Joint => "joint",
            Self::Sensor => "sensor",
        }
    }

    /// Where a gap of this family lies: a joint with play is one that does not hold.
    pub const fn domain(self) -> &'static str {
        match self {
            Self::Joint => Self::Constraint.word(),
            other => other.word(),
        }
    }
}

/// What acts beside the equations of motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Filter {
    /// The site is a parameter, and its value is looked for.
    Value,
    /// An input lags.
    Lag,
    /// An input is delayed.
    Delay,
    /// A channel has a bias.
    Bias,
    /// A channel has a scale.
    Scale,
    /// A channel is late.
    Late,
}

impl Filter {
    const ALL: [(&'static str, Self); 6] = [
        ("value", Self::Value),
        ("lag", Self::Lag),
        ("delay", Self::Delay),
        ("bias", Self::Bias),
        ("scale", Self::Scale),
        ("late", Self::Late),
    ];
}

/// An effect, for any place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Effect {
    /// Its kind, such as `viscous_friction`.
    pub name: String,
    /// Where it belongs.
    pub family: Family,
    /// Where it makes sense.
    pub site: SiteKind,
    /// One sentence with `{site}`.
    pub about: String,
    /// Words for the text, one list for each variant.
    pub(super) variants: Vec<Vec<(String, String)>>,
    pub(super) switch: Option<String>,
    pub(super) filter: Option<Filter>,
    /// The whole file.
    pub(super) text: String,
}

/// Why the file of an effect cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{file}: {message}")]
pub struct EffectError {
    /// Name of the file.
    pub file: String,
    /// What is wrong.
    pub message: String,
}

impl Effect {
    /// Reads a file; `file` names the effect unless it has a `name` of its own.
    pub fn read(file: &str, text: &str) -> Result<Self, EffectError> {
        let wrong = |message: String| EffectError {
            file: file.to_owned(),
            message,
        };
        let document: DocumentMut = text
            .parse()
            .map_err(|e: toml_edit::TomlError| wrong(e.to_string()))?;
        let header = document
            .get("effect")
            .and_then(Item::as_table_like)
            .ok_or_else(|| wrong("the section `[effect]` is missing".to_owned()))?;
        let word = |key: &str| header.get(key).and_then(Item::as_str);
        let needed = |key: &str| word(key).ok_or_else(|| wrong(format!("`{key}` is missing")));
        let choice = |key: &str, known: String| wrong(format!("`{key}` is one of {known}"));
        let family = needed("family")?;
        let families = Family::ALL.iter();
        let family = families.clone().find(|own| own.word() == family).copied();
        let names: Vec<&str> = families.map(|own| own.word()).collect();
        let family = family.ok_or_else(|| choice("family", names.join(", ")))?;
        let site = needed("site")?;
        let site = SiteKind::of(site).ok_or_else(|| choice("site", SiteKind::words()))?;
        let filter = match word("filter") {
            None => None,
            Some(filter) => {
                let found = Filter::ALL.iter().find(|(word, _)| *word == filter);
                let names: Vec<&str> = Filter::ALL.iter().map(|(word, _)| *word).collect();
                let found = found.ok_or_else(|| choice("filter", names.join(", ")))?;
                Some(found.1)
            }
        };
        let variants = header.get("variants").and_then(Item::as_array);
        let variants: Vec<Vec<(String, String)>> = variants
            .into_iter()
            .flatten()
            .filter_map(|variant| variant.as_inline_table())
            .map(|table| words(table))
            .collect();
        Ok(Self {
            name: word("name").unwrap_or(file).to_owned(),
            family,
            site,
            about: needed("about")?.to_owned(),
            variants: if variants.is_empty() {
                vec![Vec::new()]
            } else {
                variants
            },
            switch: word("switch").map(str::to_owned),
            filter,
            text: text.to_owned(),
        })
    }
}

fn words(table: &dyn TableLike) -> Vec<(String, String)> {
    let words = table.iter();
    words
        .filter_map(|(key, item)| Some((key.to_owned(), item.as_str()?.to_owned())))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_tells_what_it_lacks() {
        let told = |text: &str| Effect::read("own", text).map_err(|error| error.to_string());
        let lacks = |text, message: &str| assert_eq!(told(text), Err(format!("own: {message}")));
        lacks("[loads]", "the section `[effect]` is missing");
        lacks("[effect]\nsite = 'body'", "`family` is missing");
        let error = told("[effect]\nfamily = 'force'\nsite = 'moon'");
        assert!(error.is_err_and(|e| e.contains("`site` is one of coordinate")));
    }
}
