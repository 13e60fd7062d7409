//! The file of an effect.
//!
//! ```toml
//! [effect]
//! family   = "force"                 # force, parameter, actuator, sensor, constraint, joint
//! site     = "coordinate"            # see SiteKind
//! about    = "spring at {site}"
//! words    = { part = "0.5" }        # further placeholders and their texts
//! variants = [{ axis = "x" }]        # separate hypotheses, each with its own placeholders
//! vector   = true                    # the variants are components of one vector
//! together = true                    # also as one hypothesis at all drives, where there are many, or at the channels of an encoder
//! counts   = 2                       # number of effects as which it counts in the prior
//! switch   = "{effect}_on"           # a parameter that is 1 with the effect and 0 without
//! filter   = "lag"                   # outside the equations of motion: lag, delay, bias, scale, late, slow
//!
//! [parameters]                       # value 0: size of the effect; other values: its shape
//! "{effect}_stiffness" = { value = 0, unit = "{force}/({unit})" }
//!
//! [loads]                            # and any other section of the spec language
//! "{effect}" = { kind = "generalized", coordinate = "{site}", force = "-{effect}_stiffness*{site}" }
//!
//! [input]                            # terms added to an input wherever it acts
//!
//! [geometry]                         # terms added to a coordinate in frames and points
//!
//! [load]                             # terms added to the expression of a load
//!
//! [channel]                          # quantities measured instead of a coordinate or pseudo-velocity; an empty
//! "{site}" = "{site} + {effect}"     # text changes nothing
//! ```

use appell_spec::outline::Outline;
use appell_spec::{Code, Report, closest, did_you_mean, shown};
use toml::de::DeTable;

use super::acts::Acts;
use super::site_kind::{KINDS, SiteKind};
use appell_recordings::fields::{Fields, Value};

/// Families of effects.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
#[expect(missing_docs, reason = "the words of the report")]
pub enum Family {
    #[default]
    Force,
    Parameter,
    Actuator,
    Constraint,
    Joint,
    Sensor,
}

impl Family {
    const WORDS: [(&'static str, Self); 6] = [
        ("force", Self::Force),
        ("parameter", Self::Parameter),
        ("actuator", Self::Actuator),
        ("constraint", Self::Constraint),
        ("joint", Self::Joint),
        ("sensor", Self::Sensor),
    ];

    /// Its word.
    pub const fn word(self) -> &'static str {
        Self::WORDS[self as usize].0
    }

    /// Domain of a gap of this family; backlash of a joint is a violated constraint.
    pub const fn domain(self) -> &'static str {
        match self {
            Self::Joint => Self::Constraint.word(),
            other => other.word(),
        }
    }
}

/// How an effect outside the equations of motion acts at the site of an index.
type ActsAt = fn(usize) -> Acts;

/// The same by the word of its filter.
const FILTERS: [(&str, ActsAt); 7] = [
    ("value", Acts::Parameter),
    ("lag", Acts::Lag),
    ("delay", Acts::Delay),
    ("bias", Acts::Bias),
    ("scale", Acts::Scale),
    ("late", Acts::Late),
    ("slow", Acts::Slow),
];

/// An effect, for any site.
#[derive(Debug, Clone)]
pub struct Effect {
    /// Its kind, such as `viscous_friction`.
    pub name: String,
    /// Its family.
    pub family: Family,
    /// Its kind of sites.
    pub site: &'static SiteKind,
    /// One sentence with `{site}`.
    pub about: String,
    /// Placeholders of the text, one list for each variant.
    pub(super) variants: Vec<Vec<(String, String)>>,
    /// Whether the variants are components of one vector.
    pub(super) is_vector: bool,
    /// Whether it is also a candidate at all drives together.
    pub(super) is_together: bool,
    /// Number of effects as which it counts in the prior.
    pub(super) counts: usize,
    pub(super) switch: Option<String>,
    /// How it acts at the site of an index.
    pub(super) acts: ActsAt,
    /// Whether its size has the tolerance that the line of an input or of a channel states.
    pub(super) has_tolerance: bool,
    /// The whole file.
    pub(super) text: String,
    /// The name of the file; `None` for shipped effects.
    pub(super) file: Option<String>,
}

/// Why the file of an effect cannot be used, with positions.
#[derive(Debug, Clone, thiserror::Error)]
#[error("{}", .0.plain())]
pub struct EffectError(pub Box<Report>);

impl From<Report> for EffectError {
    fn from(report: Report) -> Self {
        Self(Box::new(report))
    }
}

/// Keys of the section `[effect]`.
pub(super) const KEYS: &[&str] = &[
    "name",
    "family",
    "site",
    "about",
    "words",
    "variants",
    "vector",
    "together",
    "counts",
    "switch",
    "filter",
    "tolerance",
];
/// Placeholders that are available at every site.
const EVERYWHERE: &[&str] = &["effect", "site"];

impl Effect {
    /// The whole file.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The sentences at the top of its file, which state its law.
    pub fn law(&self) -> String {
        let lines = self.heading().take_while(|line| !line.is_empty());
        let lines: Vec<&str> = lines.map(str::trim).collect();
        lines.join(" ")
    }

    /// The drawing below them, in characters.
    pub fn picture(&self) -> String {
        let lines = self.heading().skip_while(|line| !line.is_empty()).skip(1);
        lines.collect::<Vec<_>>().join("\n")
    }

    /// Comments at the top of its file.
    fn heading(&self) -> impl Iterator<Item = &str> {
        self.text.lines().map_while(|line| line.strip_prefix('#'))
    }

    /// Reads a user-defined effect from a file; `name` is its name unless the file states one.
    pub fn read(name: &str, file: &str, text: &str) -> Result<Self, EffectError> {
        let (mut fields, table) = Fields::new(file, text);
        let table = table.get_ref();
        if fields.is_wrong() {
            return Err(fields.report().into());
        }
        let Some(header) = fields.section(table, "effect") else {
            if table.get("effect").is_none() {
                let help = "write `family`, `site` and `about` there";
                let message = "the section `[effect]` is missing";
                fields.tell(Code::MissingSection, message, 0..0, help);
            }
            return Err(fields.report().into());
        };
        fields.only(header, KEYS);
        let at = table.get("effect").map_or(0..0, Value::span);
        let family = choice(&mut fields, header, "family", &Family::WORDS);
        let kinds = KINDS.each_ref().map(|kind| (kind.word, kind));
        let site = choice(&mut fields, header, "site", &kinds);
        let filter = choice(&mut fields, header, "filter", &FILTERS);
        let about = fields.string(header, "about");
        for key in ["family", "site", "about"] {
            if header.get(key).is_none() {
                let message = format!("`{key}` is missing");
                fields.tell(Code::MissingKey, message, at.clone(), "");
            }
        }
        let own = fields.string(header, "name");
        let switch = fields.string(header, "switch");
        let variants = variants(&mut fields, header);
        let is_vector = flag(&mut fields, header, "vector");
        let is_together = flag(&mut fields, header, "together");
        let counts = count(&mut fields, header, "counts");
        let has_tolerance = flag(&mut fields, header, "tolerance");
        if let Some(site) = site {
            let mut known = [EVERYWHERE, &site.words()].concat();
            known.extend(variants.iter().flatten().map(|(word, _)| word.as_str()));
            unknown_words(&mut fields, text, &known);
            if let Some(coordinates) = table.get("coordinates")
                && !site.bears_coordinate()
            {
                let message =
                    "an effect adds a coordinate only at a `driven_slider` or `driven_hinge`";
                fields.tell(Code::NotAllowedHere, message, coordinates.span(), "");
            }
        }
        let (Some(family), Some(site), Some((about, _)), false) =
            (family, site, about, fields.is_wrong())
        else {
            return Err(fields.report().into());
        };
        Ok(Self {
            name: own.map_or_else(|| name.to_owned(), |(own, _)| own),
            family,
            site,
            about,
            variants,
            is_vector,
            is_together,
            counts,
            switch: switch.map(|(switch, _)| switch),
            acts: filter.unwrap_or(|_| Acts::Items),
            has_tolerance,
            text: text.to_owned(),
            file: Some(file.to_owned()),
        })
    }
}

/// The keywords of families and filters.
#[cfg(test)]
pub(super) fn choices() -> Vec<&'static str> {
    let families = Family::WORDS.map(|(word, _)| word);
    [&families[..], &FILTERS.map(|(word, _)| word)].concat()
}

/// `true` or `false`; `false` if the key is absent.
fn flag(fields: &mut Fields<'_>, header: &DeTable<'_>, key: &str) -> bool {
    let Some(value) = header.get(key) else {
        return false;
    };
    let flag = value.get_ref().as_bool();
    if flag.is_none() {
        fields.wrong_type(value, "`true` or `false`");
    }
    flag.unwrap_or(false)
}

/// A number of effects; one if the key is absent.
fn count(fields: &mut Fields<'_>, header: &DeTable<'_>, key: &str) -> usize {
    const MOST: usize = 3;
    let Some(value) = header.get(key) else {
        return 1;
    };
    let digits = value
        .get_ref()
        .as_integer()
        .map(toml::de::DeInteger::as_str);
    let count = digits.and_then(|digits| digits.parse().ok());
    let count = count.filter(|count| (1..=MOST).contains(count));
    if count.is_none() {
        fields.wrong_type(value, "1, 2 or 3");
    }
    count.unwrap_or(1)
}

/// An optional choice among keywords; any other value is reported.
fn choice<T: Copy>(
    fields: &mut Fields<'_>,
    header: &DeTable<'_>,
    key: &str,
    known: &[(&'static str, T)],
) -> Option<T> {
    let (word, at) = fields.string(header, key)?;
    let found = known.iter().find(|(own, _)| *own == word);
    if found.is_none() {
        let known: Vec<&str> = known.iter().map(|(word, _)| *word).collect();
        let message = format!("`{key}` is one of {}", known.join(", "));
        let help = did_you_mean(&word, known, String::new);
        fields.tell(Code::UnknownName, message, at, &help);
    }
    found.map(|(_, meaning)| *meaning)
}

/// Placeholders with their texts, one list for each variant: the common ones, then its own.
fn variants(fields: &mut Fields<'_>, header: &DeTable<'_>) -> Vec<Vec<(String, String)>> {
    let common = header.get("words").map_or_else(Vec::new, |value| {
        words(
            fields,
            value,
            "a table of texts, such as { part = \"0.5\" }",
        )
    });
    let Some(value) = header.get("variants") else {
        return vec![common];
    };
    let wanted = "a list of tables of texts, such as [{ part = \"0.5\" }]";
    let Some(list) = value.get_ref().as_array() else {
        fields.wrong_type(value, wanted);
        return Vec::new();
    };
    if list.is_empty() {
        return vec![common];
    }
    let own = list.iter().map(|value| words(fields, value, wanted));
    own.map(|own| [common.clone(), own].concat()).collect()
}

/// Placeholders with their texts.
fn words(fields: &mut Fields<'_>, value: &Value<'_>, wanted: &str) -> Vec<(String, String)> {
    let Some(table) = value.get_ref().as_table() else {
        fields.wrong_type(value, wanted);
        return Vec::new();
    };
    let mut words = Vec::new();
    for (key, value) in table {
        match value.get_ref().as_str() {
            Some(text) => words.push((key.get_ref().to_string(), text.to_owned())),
            None => fields.wrong_type(value, "a text in quotes"),
        }
    }
    words
}

/// Reports unknown placeholders, in keys and in texts.
fn unknown_words(fields: &mut Fields<'_>, text: &str, known: &[&str]) {
    let Outline { keys, strings } = Outline::new(text);
    for place in keys.into_iter().chain(strings).map(|part| part.span) {
        let part = text.get(place.clone()).unwrap_or_default();
        for (start, _) in part.match_indices('{') {
            let rest = &part[start + 1..];
            let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
            let end = rest.find(|c| !is_word(c)).unwrap_or(rest.len());
            let word = &rest[..end];
            if word.is_empty() || !rest[end..].starts_with('}') || known.contains(&word) {
                continue;
            }
            let from = place.start + start;
            let message = format!("unknown placeholder `{{{}}}`", shown(word));
            let all: Vec<String> = known.iter().map(|word| format!("{{{word}}}")).collect();
            let similar = closest(word, known.iter().copied());
            let help = similar.map_or_else(
                || format!("placeholders at such a site: {}", all.join(", ")),
                |similar| format!("did you mean `{{{similar}}}`?"),
            );
            fields.tell(Code::UnknownName, message, from..from + end + 2, &help);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn errors(text: &str) -> String {
        let read = Effect::read("own", "mine/own.toml", text);
        read.err()
            .map_or_else(String::new, |error| error.to_string())
    }

    #[test]
    fn a_file_tells_what_it_lacks_and_where() {
        let slew = "[effect]\nfamily = 'actuator'\nsite = 'input'\nabout = 'slew rate of {site}'\n[coordinates]\n\
                    z = { unit = 'm' }";
        let moon = "[effect]\nfamily = 'force'\nsite = 'moon'";
        let famly = "[effect]\nfamly = 'force'";
        for (text, message, place) in [
            ("[loads]", "the section `[effect]` is missing", "1:1"),
            ("[effect]\nsite = 'body'", "`family` is missing", "1:"),
            (moon, "`site` is one of coordinate", "3:8"),
            (famly, "did you mean `family`?", "2:1"),
            (
                slew,
                "an effect adds a coordinate only at a `driven_slider`",
                "5:",
            ),
        ] {
            let place = format!("mine/own.toml:{place}");
            let errors = errors(text);
            assert!(
                errors.contains(message) && errors.contains(&place),
                "{errors}"
            );
        }
    }

    #[test]
    fn an_unknown_placeholder_is_reported_with_its_position() {
        let text = "[effect]\nfamily = 'force'\nsite = 'body'\nabout = 'drag on {site}'\n\
                    [loads]\n# as {nobody} reads this\n'{effect}' = { on = '{center}', force = '{unit}' }\n";
        let message = errors(text);
        for part in [
            "unknown placeholder `{center}`",
            "mine/own.toml:7:22",
            "did you mean `{centre}`?",
            "unknown placeholder `{unit}`",
            "placeholders at such a site: {effect}, {site}, {centre}, {frame}",
        ] {
            assert!(message.contains(part), "`{part}` is missing in\n{message}");
        }
        assert!(!message.contains("`{nobody}`"), "{message}");
    }
}
