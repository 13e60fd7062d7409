//! A mass that a spring and a damper hold at a coordinate, and that the spec counts with what the coordinate
//! moves: a load that swings, a liquid that sloshes, an elastic drive.

use appell_spec::Mechanism;

use super::candidate::{Acts, Candidate, Part, filled, identifier, unused};
use super::effect::Family;
use super::site::{Scales, SiteKind, Sites, number};

/// Where it is, and its numbers, in SI, each with what is known of it beforehand: mean and standard deviation.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct HiddenMass {
    /// The coordinate.
    pub(crate) behind: String,
    /// Mass, or moment of inertia.
    pub(crate) mass: [f64; 2],
    /// Rate at which it swings, without damping.
    pub(crate) rate: [f64; 2],
    /// Damping ratio.
    pub(crate) damping: [f64; 2],
}

/// Part of a number below which there is no such mass.
const LEAST: f64 = 1e-3;

/// What both kinds have; `{m}` is the unit of the coordinate, `{kg}` that of the inertia.
const HELD: &str = r#"
[parameters]
"{law}_mass"    = { value = {mass}, unit = "{kg}", at_least = {least_mass}, about = "mass that swings behind {site}" }
"{law}_rate"    = { value = {rate}, unit = "1/s", at_least = {least_rate}, about = "rate of its swing" }
"{law}_damping" = { value = {damping}, unit = "1", at_least = 0, about = "damping ratio of its swing" }

[coordinates]
"{law}_lead" = { unit = "{m}", about = "lead of the mass over {site}" }

[pseudo_velocities]
"{law}_lead_rate" = { value = "dot({law}_lead)", unit = "{m}/s", about = "rate of the lead" }

[loads]
"{law}" = { kind = "generalized", coordinate = "{law}_lead", force = "-{law}_mass*({law}_rate^2*{law}_lead + 2*{law}_damping*{law}_rate*dot({law}_lead))" }
"#;

const SLIDING: &str = r#"
[points]
"{law}_at"    = { from = "O", in = "ground", at = ["{across_x}*{site}", "{across_y}*{site}", "{across_z}*{site}"] }
"{law}_swing" = { from = "{law}_at", in = "ground", at = ["{across_x}*{law}_lead", "{across_y}*{law}_lead", "{across_z}*{law}_lead"] }

[bodies]
"{law}_swing" = { centre = "{law}_swing", mass = "{law}_mass" }
"{law}_at"    = { centre = "{law}_at", mass = "{law}_mass", taken_away = true, about = "the same, as counted by the spec" }
"#;

const TURNING: &str = r#"
[frames]
"{law}_at"    = { parent = "ground", about_axis = "{across_1}", by = "{site}" }
"{law}_swing" = { parent = "ground", about_axis = "{across_1}", by = "{site} + {law}_lead" }

[bodies]
"{law}_swing" = { frame = "{law}_swing", centre = "O", mass = 0, inertia = { in = "{law}_swing", diagonal = ["{law}_mass", "{law}_mass", "{law}_mass"] } }
"{law}_at"    = { frame = "{law}_at", centre = "O", mass = 0, inertia = { in = "{law}_at", diagonal = ["{law}_mass", "{law}_mass", "{law}_mass"] }, taken_away = true, about = "the same, as counted by the spec" }
"#;

impl Candidate {
    /// A hidden mass behind a coordinate; nothing where it is no mass, or the coordinate moves nothing by itself.
    pub(crate) fn hidden_mass(
        mechanism: &Mechanism,
        scales: &Scales,
        hidden: &HiddenMass,
    ) -> Option<Self> {
        if hidden.mass[0] <= 0.0 || !hidden.mass[0].is_finite() {
            return None;
        }
        let coordinate = hidden.behind.as_str();
        let sites = Sites::new(mechanism, scales);
        let kinds = [
            (SiteKind::Slider, SLIDING, "m", "kg"),
            (SiteKind::Hinge, TURNING, "rad", "kg*m^2"),
        ];
        let (site, text, m, kg) = kinds.into_iter().find_map(|(kind, text, m, kg)| {
            let mut sites = sites.of(kind).into_iter();
            let site = sites.find(|site| site.name == coordinate)?;
            Some((site, text, m, kg))
        })?;
        let stem = unused(format!("law_{}", identifier(coordinate)), mechanism);
        let [mass, rate, damping] = [hidden.mass, hidden.rate, hidden.damping].map(|own| own[0]);
        let values = [
            ("mass", mass),
            ("least_mass", LEAST * mass),
            ("rate", rate),
            ("least_rate", LEAST * rate),
            ("damping", damping),
        ];
        let values = values.map(|(word, value)| (word, number(value)));
        let mut words = vec![
            ("law", stem.as_str()),
            ("site", coordinate),
            ("m", m),
            ("kg", kg),
        ];
        words.extend(site.words.iter().map(|(word, text)| (*word, text.as_str())));
        words.extend(values.iter().map(|(word, text)| (*word, text.as_str())));
        let known = [
            ("mass", hidden.mass),
            ("rate", hidden.rate),
            ("damping", hidden.damping),
        ];
        let parameters = known.map(|(name, known)| (format!("{stem}_{name}"), Part::Term(known)));
        Some(Self {
            kind: "law".to_owned(),
            site: coordinate.to_owned(),
            family: Family::Force,
            about: format!("a mass that swings behind {coordinate}"),
            is_component: false,
            acts: Acts::Items,
            parameters: parameters.to_vec(),
            centre: None,
            items: filled(&format!("{HELD}{text}"), &words),
            brings: None,
            hides: true,
            added: Vec::new(),
            source: None,
            stem,
        })
    }
}
