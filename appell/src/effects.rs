//! The library of effects for readers: the law of each, its sites, and its form in a spec.

use std::fmt::Write as _;

use appell_gap::effects::{Candidate, Scales, candidates, shipped, written};
use appell_models::ALL;
use appell_recordings::Spec;
use appell_report::row;
use appell_report::text::table;
use serde_json::{Value, json};

use crate::diagnosis::Effect;
use crate::source::Source;
use crate::{Error, Field, Mechanism};

/// An effect in a mechanism.
pub struct Example {
    /// The effect.
    pub effect: Effect,
    /// The mechanism.
    pub mechanism: String,
    /// The sites there, as reports name them.
    pub sites: Vec<String>,
    /// The site of `items`: the first one where the effect can be written.
    pub shown: Option<String>,
    /// Items that the effect adds to the spec there; empty where a spec cannot express it.
    pub items: String,
}

/// The shipped effects.
pub fn library() -> Result<Vec<Effect>, Error> {
    Ok(shipped()?)
}

/// One effect; those of one name differ by their sites.
pub fn named(name: &str) -> Result<Vec<Effect>, Error> {
    let all = library()?;
    let names: Vec<String> = all.iter().map(|effect| effect.name.clone()).collect();
    let own: Vec<Effect> = all.into_iter().filter(|one| one.name == name).collect();
    if own.is_empty() {
        let known = names.iter().map(String::as_str);
        let begun = known.clone().find(|own| own.starts_with(name));
        let help = appell_spec::did_you_mean(name, known, || match begun {
            Some(own) => format!("did you mean `{own}`?"),
            None => "`appell effects` lists them".to_owned(),
        });
        let message = format!("there is no effect `{}`; {help}", appell_spec::shown(name));
        return Err(Error::request(Field::Effect, message));
    }
    Ok(own)
}

/// The library as a table.
pub fn overview(effects: &[Effect]) -> String {
    let mut rows = vec![row!["effect", "family", "sites", "law"]];
    for effect in effects {
        let law = effect.law();
        let first = law
            .split_once(". ")
            .map_or(law.as_str(), |(first, _)| first);
        let (family, site) = (effect.family.word(), effect.site.word.replace('_', " "));
        rows.push(row![effect.name, family, site, first.trim_end_matches('.')]);
    }
    table(&rows, 0..0)
}

impl Example {
    /// In a mechanism; by default in the first shipped one that has a site for it.
    pub fn new(effect: Effect, model: Option<&str>) -> Result<Self, Error> {
        if let Some(model) = model {
            return Self::of(effect, &Source::find(model)?);
        }
        let mut last = None;
        for shipped in ALL {
            let example = Self::of(effect.clone(), &Source::shipped(shipped.name)?)?;
            if example.shown.is_some() {
                return Ok(example);
            }
            last = Some(example);
        }
        last.ok_or_else(|| Error::request(Field::Model, "no mechanism is shipped"))
    }

    fn of(effect: Effect, source: &Source) -> Result<Self, Error> {
        let mechanism = source.mechanism()?;
        let spec = Spec::from(source);
        let scales = magnitudes(&mechanism);
        let effects = std::slice::from_ref(&effect);
        let all = candidates(&mechanism, &spec, effects, &scales).map_err(Error::computation)?;
        let mut sites: Vec<String> = all.iter().map(Candidate::name).collect();
        sites.dedup();
        let mut shown = None;
        for candidate in &all {
            shown = written(&spec, candidate).map_err(Error::computation)?;
            if shown.is_some() {
                break;
            }
        }
        Ok(Self {
            effect,
            mechanism: mechanism.name,
            sites,
            shown: shown.as_ref().map(Candidate::name),
            items: shown.map_or_else(String::new, |one| one.items().to_owned()),
        })
    }

    /// All of it.
    pub fn text(&self) -> String {
        let effect = &self.effect;
        let mut text = format!("{}, {} effect\n\n", effect.name, effect.family.word());
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{}", effect.law());
        let picture = effect.picture();
        if !picture.is_empty() {
            let _ = writeln!(text, "\n{picture}");
        }
        let _ = writeln!(
            text,
            "\nSites: each {}. In {}: {}",
            effect.site.about,
            self.mechanism,
            if self.sites.is_empty() {
                "none".to_owned()
            } else {
                self.sites.join(", ")
            }
        );
        let Some(shown) = &self.shown else {
            if !self.sites.is_empty() {
                text += "\nNo input drives one of them through a constant lever, without which it is not identifiable.\n";
            }
            return text;
        };
        if self.items.trim().is_empty() {
            text += "A spec cannot express it: it acts on signals or values of a rig, and `appell apply` says where it \
                     belongs.\n";
        } else {
            let _ = writeln!(
                text,
                "\nIn a spec, {shown} is (sizes at zero, where `appell apply` writes those that it found):\n\n{}",
                self.items.trim()
            );
        }
        text += "\n`appell diagnose` looks for it wherever it has a site.\n";
        text
    }

    /// The same for programs.
    pub fn json(&self) -> Value {
        let effect = &self.effect;
        json!({
            "name": effect.name,
            "family": effect.family.word(),
            "site": effect.site.word,
            "sites": effect.site.about,
            "about": effect.about,
            "law": effect.law(),
            "picture": effect.picture(),
            "example": { "mechanism": self.mechanism, "sites": self.sites, "items": self.items },
        })
    }
}

/// Magnitudes of recordings that there are none of: ones.
fn magnitudes(mechanism: &Mechanism) -> Scales {
    /// As a diagnosis has it for slow motions.
    const NARROW: f64 = 0.005;
    let coordinates = mechanism.coordinates.iter().count();
    let channels = mechanism.coordinates.iter();
    Scales {
        rates: vec![1.0; coordinates],
        narrow: vec![NARROW; coordinates],
        largest: vec![1.0; mechanism.inputs.iter().count()],
        reached: vec![Some([-1.0, 1.0]); coordinates],
        loads: vec![1.0; mechanism.loads.iter().count()],
        channels: channels.map(|one| one.label.name.clone()).collect(),
        coordinates: (0..coordinates).map(Some).collect(),
        speeds: vec![None; coordinates],
        uncertain: (0..mechanism.parameters.iter().count()).collect(),
    }
}
