//! An effect at a site, in one of its variants: a hypothesis on a missing part of the model.

use appell_spec::Mechanism;
use appell_spec::compose::Composition;
use appell_spec::edit::EditError;
use toml_edit::{DocumentMut, InlineTable, Item, TableLike, Value};

use super::acts::Acts;
use super::effect::{Effect, EffectError, Family};
use super::load::Stated;
use super::place::Source;
use super::site::{DRIVES, Site, Sites};
use super::term::{Term, texts};

/// Role of a parameter of a candidate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Part {
    /// Size of the effect; zero without it.
    Size,
    /// Shape of the effect, undetermined at size zero: of fixed sign, or of any sign with this prior standard deviation.
    Shape(Option<f64>),
    /// Switch: one with the effect, zero without.
    Switch,
    /// A coefficient with a normal prior of this mean and standard deviation.
    Term([f64; 2]),
}

impl Part {
    /// Whether it is undetermined at size zero.
    pub(crate) const fn is_shape(self) -> bool {
        matches!(self, Self::Shape(_))
    }
}

/// An effect at a site.
#[derive(Debug, Clone, Default)]
pub struct Candidate {
    /// Kind of the effect.
    pub kind: String,
    /// Name of the site.
    pub site: String,
    /// The sites on which it acts, where it is one effect at several of them; of a component one of them.
    pub(super) group: Vec<String>,
    /// Family of the effect.
    pub family: Family,
    /// One sentence.
    pub about: String,
    /// Whether it is a component of a vector: others of its name may join it.
    pub(crate) is_component: bool,
    /// How it acts.
    pub acts: Acts,
    /// Its parameters in the spec, each with its role.
    pub(crate) parameters: Vec<(String, Part)>,
    /// Prefix of its names in the spec.
    pub(super) stem: String,
    /// Centre of mass of the body on which it acts, if any.
    pub(super) centre: Option<String>,
    /// Items for the spec.
    pub(super) items: String,
    /// The pseudo-velocity of the joint, for an effect with an additional coordinate. Such an effect has its own model,
    /// whose last coordinate and pseudo-velocity are the additional ones.
    pub(crate) brings: Option<usize>,
    /// For a law with a hidden state: initial standard deviations of its rate and of its coordinate, the last one of
    /// the model, which is not measured and has no process noise.
    pub(crate) hides: Option<[f64; 2]>,
    /// Terms added to quantities of the spec.
    pub(crate) added: Vec<Term>,
    /// The load that it limits, with the term added to its expression.
    pub(super) limits: Option<(Stated, String)>,
    /// Whether its size has the tolerance that the line of an input or of a channel states.
    pub(crate) has_tolerance: bool,
    /// Number of effects as which it counts in the prior.
    pub(crate) counts: usize,
    /// Outputs that channels measure instead of a coordinate or pseudo-velocity: its name and the output.
    pub(crate) shows: Vec<(String, String)>,
    /// Its file, for effects of users.
    pub(super) source: Option<Source>,
}

impl Candidate {
    /// `kind@site`
    pub fn name(&self) -> String {
        format!("{}@{}", self.kind, self.site)
    }

    /// The items that it adds to a spec, with sizes of zero.
    pub fn items(&self) -> &str {
        &self.items
    }

    /// Whether it is a single effect at several sites, such as all drives.
    pub(crate) fn is_of_group(&self) -> bool {
        !self.group.is_empty()
    }

    /// Its sites in the mechanism.
    pub(crate) fn sites(&self) -> Vec<String> {
        match self.group.as_slice() {
            [] => vec![self.site.clone()],
            group => group.to_vec(),
        }
    }

    /// Whether it replaces rolling of a contact by creep.
    pub(crate) fn creeps(&self) -> bool {
        self.family == Family::Constraint
    }

    /// The name of one of its parameters without the prefix.
    pub(crate) fn short<'p>(&self, parameter: &'p str) -> &'p str {
        let short = parameter.strip_prefix(self.stem.as_str());
        short.map_or(parameter, |short| short.trim_start_matches('_'))
    }

    /// The name of the parameter that is in error: that of a relative error, or `value`.
    pub(crate) fn short_of_error<'p>(&self, parameter: &'p str) -> &'p str {
        if self.has_tolerance {
            self.short(parameter)
        } else {
            "value"
        }
    }

    /// The error of a relative error with a tolerance, once it is a parameter of the spec.
    pub(crate) fn of_parameter(&self, index: usize) -> Self {
        Self {
            acts: Acts::Parameter(index),
            parameters: Vec::new(),
            items: String::new(),
            added: Vec::new(),
            limits: None,
            ..self.clone()
        }
    }

    /// The candidate; one that adds a coordinate with the declarations of its parameters only.
    pub(super) fn declared(&self) -> Self {
        if self.brings.is_none() {
            return self.clone();
        }
        let mut document: DocumentMut = self.items.parse().unwrap_or_default();
        document.retain(|section, _| section == "parameters");
        Self {
            items: document.to_string(),
            ..self.clone()
        }
    }

    /// A zero force along its coordinate, as an expression.
    pub(super) fn nothing(&self) -> String {
        let words = self.source.iter().flat_map(|source| &source.words);
        let mut units = words.filter(|(word, _)| word == "force");
        let unit = units.next().map_or("N", |(_, unit)| unit.as_str());
        format!("0 [{unit}]")
    }

    /// Replaces the placeholders that depend on the equations of motion.
    pub(super) fn with_words(&self, words: &[(&str, &str)]) -> Self {
        Self {
            items: filled(&self.items, words),
            ..self.clone()
        }
    }

    /// All candidates of an effect in a mechanism, by site and variant, beside those of other effects, which may have the
    /// same name.
    pub(super) fn all(
        effect: &Effect,
        sites: &Sites<'_>,
        others: &[Self],
    ) -> Result<Vec<Self>, EffectError> {
        let encoders = sites.encoders();
        let mut candidates = Vec::new();
        for site in effect.site.of(sites) {
            for (index, variant) in effect.variants.iter().enumerate() {
                let mut words = variant.iter();
                let along = words.find(|(word, _)| word == "offset_along");
                if along.is_some_and(|(_, axis)| site.placed_along.contains(&axis.as_str())) {
                    continue;
                }
                let stem = format!("{}_{}", effect.name, identifier(&site.name));
                let id = if effect.variants.len() > 1 {
                    format!("{stem}_{}", index + 1)
                } else {
                    stem
                };
                let mut id = unused(id, sites.mechanism);
                while others.iter().any(|own| own.stem == id) {
                    id += "_too";
                }
                let candidate = Self::new(effect, &site, &id, variant)?;
                // The input of a servo is a set-point; what its actuator adds is a term of the load.
                let adds_to = |name: &str| candidate.added.iter().any(|own| own.quantity == name);
                // Those of an encoder in the loop of a servo are other effects of the same names.
                let is_in_loop = matches!(candidate.acts, Acts::Bias(_) | Acts::Scale(_))
                    && encoders.iter().any(|own| own.index == site.index);
                if !(adds_to(&site.name) && sites.is_servo(&site.name) || is_in_loop) {
                    candidates.push(candidate);
                }
            }
        }
        if effect.is_together {
            for (name, members) in sites.groups(effect.site) {
                candidates.extend(Self::together(effect, sites, &name, &members)?);
            }
        }
        Ok(candidates)
    }

    /// An effect at a group of sites, with sizes for each of them; of signals, a component for each site.
    fn together(
        effect: &Effect,
        sites: &Sites<'_>,
        group: &str,
        members: &[String],
    ) -> Result<Vec<Self>, EffectError> {
        let mut places = effect.site.of(sites);
        places.retain(|site| members.contains(&site.name));
        let stem = unused(
            format!("{}_{}", effect.name, identifier(group)),
            sites.mechanism,
        );
        let own = places.iter().map(|site| {
            let id = format!("{stem}_{}", identifier(&site.name));
            Self::new(effect, site, &id, &effect.variants[0])
        });
        let own = own.collect::<Result<Vec<Self>, _>>()?;
        let [first, _, ..] = own.as_slice() else {
            return Ok(Vec::new());
        };
        let all = if group == DRIVES {
            "every drive"
        } else {
            group
        };
        let about = effect.about.replace("{site}", all);
        if first.acts != Acts::Items {
            let component = |one: Self| Self {
                group: vec![one.site],
                site: group.to_owned(),
                about: about.clone(),
                is_component: true,
                ..one
            };
            return Ok(own.into_iter().map(component).collect());
        }
        Ok(vec![Self {
            site: group.to_owned(),
            group: places.iter().map(|place| place.name.clone()).collect(),
            about,
            parameters: own.iter().flat_map(|one| one.parameters.clone()).collect(),
            stem,
            items: merged(&own).unwrap_or_default(),
            ..first.clone()
        }])
    }

    fn new(
        effect: &Effect,
        site: &Site,
        id: &str,
        variant: &[(String, String)],
    ) -> Result<Self, EffectError> {
        let mut words: Vec<(&str, &str)> = vec![("effect", id), ("site", &site.name)];
        let own = variant.iter();
        let own = own.map(|(word, text)| (word.as_str(), text.as_str()));
        // Placeholders of a variant may contain placeholders of the site.
        let of_site = site.words.iter().map(|(word, text)| (*word, text.as_str()));
        words.extend(own.chain(of_site));
        let filled = filled(&filled(&effect.text, &words), &words);
        let source = Source {
            file: effect.file.as_ref().unwrap_or(&effect.name).clone(),
            text: effect.text.clone(),
            words: (words.iter())
                .map(|(word, text)| ((*word).to_owned(), (*text).to_owned()))
                .collect(),
        };
        let mut document: DocumentMut = filled.parse().map_err(|e: toml_edit::TomlError| {
            let problem = "with its placeholders replaced, the file is not TOML";
            source.wrong(&[], &format!("{problem}: {}", e.message()))
        })?;
        let added = Term::of(&mut document);
        let load = document.remove("load");
        let limits = load.iter().flat_map(texts).map(|(_, text)| text).next();
        let limits = site.stated.clone().zip(limits);
        let shows = shown(&mut document, id);
        document.remove("effect");
        let switch = effect.switch.as_deref();
        let switch = switch.map(|text| self::filled(text, &words));
        let mut parameters = Vec::new();
        if let Some(table) = document
            .get_mut("parameters")
            .and_then(Item::as_table_like_mut)
        {
            for (name, item) in table.iter_mut() {
                let name = name.get().to_owned();
                let item = item.as_table_like_mut().ok_or_else(|| {
                    source.wrong(&["parameters", &name], "a parameter is a table")
                })?;
                for key in ["value", "at_least", "at_most", "std"] {
                    compute(item, key).map_err(|text| {
                        let message = format!("`{text}` is no product of numbers");
                        source.wrong(&["parameters", &name, key], &message)
                    })?;
                }
                let is_zero = item.get("value").and_then(number).is_some_and(|v| v == 0.0);
                let std = item.remove("std").as_ref().and_then(number);
                let part = if switch.as_ref() == Some(&name) {
                    Part::Switch
                } else if is_zero && std.is_none() {
                    Part::Size
                } else {
                    Part::Shape(std)
                };
                parameters.push((name, part));
            }
        }
        Ok(Self {
            kind: effect.name.clone(),
            site: site.name.clone(),
            family: effect.family,
            about: self::filled(&effect.about, &words),
            is_component: effect.is_vector,
            acts: (effect.acts)(site.index),
            parameters,
            stem: id.to_owned(),
            centre: (site.words.iter())
                .find(|(word, _)| *word == "centre")
                .map(|(_, name)| name.clone()),
            items: document.to_string(),
            brings: document.contains_key("coordinates").then_some(site.index),
            added,
            limits,
            has_tolerance: effect.has_tolerance,
            counts: effect.counts,
            shows,
            source: effect.file.is_some().then_some(source),
            ..Self::default()
        })
    }
}

/// The items of all, whose names differ.
fn merged(all: &[Candidate]) -> Result<String, EditError> {
    let mut items = Composition::new("")?;
    all.iter().try_for_each(|one| items.add(&one.items))?;
    Ok(items.text())
}

/// Moves the section `[channel]` to outputs: the measured quantities with the outputs that replace them.
fn shown(document: &mut DocumentMut, id: &str) -> Vec<(String, String)> {
    let channel = document.remove("channel");
    let channel = channel.iter().flat_map(texts);
    let mut shows = Vec::new();
    for (state, value) in channel.filter(|(_, value)| !value.is_empty()) {
        let output = format!("{id}_shows_{state}");
        let item = InlineTable::from_iter([("value", Value::from(value))]);
        let outputs = document.entry("outputs").or_insert(toml_edit::table());
        if let Some(outputs) = outputs.as_table_like_mut() {
            outputs.insert(&output, Item::Value(item.into()));
        }
        shows.push((state, output));
    }
    shows
}

/// Replaces the placeholders of a text.
pub(super) fn filled(text: &str, words: &[(&str, &str)]) -> String {
    let mut text = text.to_owned();
    for (word, meaning) in words {
        text = text.replace(&format!("{{{word}}}"), meaning);
    }
    text
}

/// Replaces a product such as `0.5*12.3` by its value.
fn compute(table: &mut dyn TableLike, key: &str) -> Result<(), String> {
    let Some(text) = table.get(key).and_then(Item::as_str).map(str::to_owned) else {
        return Ok(());
    };
    let factors = text.split('*').map(|factor| factor.trim().parse::<f64>());
    let product: Result<f64, _> = factors.product();
    let product = product.map_err(|_| text.clone())?;
    table.insert(key, Item::Value(Value::from(product)));
    Ok(())
}

fn number(item: &Item) -> Option<f64> {
    let whole = || item.as_integer().map(|whole| whole as f64);
    item.as_float().or_else(whole)
}

/// A valid identifier for a name; those of columns are arbitrary.
pub(super) fn identifier(name: &str) -> String {
    let valid = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    name.chars().map(valid).collect()
}

/// A stem with which no name of the mechanism starts.
pub(super) fn unused(stem: String, mechanism: &Mechanism) -> String {
    let is_used = |stem: &str| {
        let parameters = mechanism.parameters.iter().map(|p| &p.label.name);
        let points = mechanism.points.iter().map(|p| &p.name);
        let bodies = mechanism.bodies.iter().map(|b| &b.name);
        let loads = mechanism.loads.iter().map(|l| &l.name);
        let mut names = parameters.chain(points).chain(bodies).chain(loads);
        names.any(|name| name.starts_with(stem))
    };
    let mut stem = stem;
    while is_used(&stem) {
        stem += "_too";
    }
    stem
}
