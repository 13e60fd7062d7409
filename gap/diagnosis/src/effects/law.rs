//! Laws outside the library: measured forces, and forces that depend on the past motion, each with an unmeasured state.

use appell_spec::Mechanism;
use toml_edit::{DocumentMut, InlineTable, Item, Table, Value};

use super::acts::Acts;
use super::candidate::{Candidate, Part, filled, identifier, unused};
use super::effect::Family;
use super::site::{LENGTH, Scales, Sites, number};

/// Normal prior of a coefficient: mean and standard deviation.
pub(crate) type Known = [f64; 2];

/// A force with a hidden state, with its coordinate and parameters in SI.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Memory {
    /// A mass coupled to a coordinate by a spring and a damper, which the spec includes in the inertia of the coordinate:
    /// a swinging load, a sloshing liquid, an elastic drive.
    HiddenMass {
        /// The coordinate.
        behind: String,
        /// Mass, or moment of inertia.
        mass: Known,
        /// Undamped natural frequency in rad/s.
        rate: Known,
        /// Damping ratio.
        damping: Known,
    },
    /// A force that depends on the travel since the last reversal: dry friction with presliding displacement, as of a
    /// belt, a rubber bush, a cable. With the state `z` in −1 to 1, the force is `-F z`, and `δ dz/dt = q' - |q'| z`
    /// (P. R. Dahl, *A solid friction model*, The Aerospace Corporation, 1968).
    Hysteresis {
        /// The coordinate.
        along: String,
        /// Force after a long travel in one direction.
        force: Known,
        /// Presliding displacement δ.
        way: Known,
    },
}

/// Lower limits of positive parameters relative to their first estimates.
const LEAST: f64 = 1e-3;

/// Filter steps over the presliding displacement at the typical rate.
const STEPS: f64 = 4.0;

/// Initial standard deviations of z and of its integral: z is unknown, the integral irrelevant.
const BEGINS: [f64; 2] = [0.7, 0.0];

/// Items common to masses and moments of inertia; `{unit}` is that of the coordinate, `{kg}` that of the inertia.
const HELD: &str = r#"
[parameters]
"{law}_mass"    = { value = {mass_value}, unit = "{kg}", at_least = {mass_least}, about = "mass that swings behind {site}" }
"{law}_rate"    = { value = {rate_value}, unit = "1/s", at_least = {rate_least}, about = "rate of its swing" }
"{law}_damping" = { value = {damping_value}, unit = "1", at_least = 0, about = "damping ratio of its swing" }

[coordinates]
"{law}_lead" = { unit = "{unit}", about = "lead of the mass over {site}" }

[pseudo_velocities]
"{law}_lead_rate" = { value = "dot({law}_lead)", unit = "{unit}/s", about = "rate of the lead" }

[loads]
"{law}" = { kind = "generalized", coordinate = "{law}_lead", force = "-{law}_mass*({law}_rate^2*{law}_lead + 2*{law}_damping*{law}_rate*dot({law}_lead))" }
"#;

/// Of a length.
const SLIDING: &str = r#"
[points]
"{law}_at"    = { from = "O", in = "ground", at = ["{across_x}*{site}", "{across_y}*{site}", "{across_z}*{site}"] }
"{law}_swing" = { from = "{law}_at", in = "ground", at = ["{across_x}*{law}_lead", "{across_y}*{law}_lead", "{across_z}*{law}_lead"] }

[bodies]
"{law}_swing" = { centre = "{law}_swing", mass = "{law}_mass" }
"{law}_at"    = { centre = "{law}_at", mass = "{law}_mass", taken_away = true, about = "the same, as counted by the spec" }
"#;

/// Of an angle.
const TURNING: &str = r#"
[frames]
"{law}_at"    = { parent = "ground", about_axis = "{across_1}", by = "{site}" }
"{law}_swing" = { parent = "ground", about_axis = "{across_1}", by = "{site} + {law}_lead" }

[bodies]
"{law}_swing" = { frame = "{law}_swing", centre = "O", mass = 0, inertia = { in = "{law}_swing", diagonal = ["{law}_mass", "{law}_mass", "{law}_mass"] } }
"{law}_at"    = { frame = "{law}_at", centre = "O", mass = 0, inertia = { in = "{law}_at", diagonal = ["{law}_mass", "{law}_mass", "{law}_mass"] }, taken_away = true, about = "the same, as counted by the spec" }
"#;

/// A spec has no first-order states; the rate of an otherwise free inertia serves as one. `{unit}` is that of the
/// coordinate, `{force}` that of the force along it.
const HYSTERESIS: &str = r#"
[mechanism]
longest_step = {step}

[parameters]
"{law}_force" = { value = {force_value}, unit = "{force}", about = "force along {site} after a long travel in one direction" }
"{law}_way"   = { value = {way_value}, unit = "{unit}", at_least = {way_least}, about = "presliding displacement" }

[coordinates]
"{law}_memory" = { unit = "rad", about = "its rate in rad/s is the hysteresis state of {site}, -1 to 1" }

[pseudo_velocities]
"{law}_memory_rate" = { value = "dot({law}_memory)", unit = "rad/s", about = "hysteresis state of {site}" }

[frames]
"{law}_memory" = { parent = "ground", about_axis = "{across_1}", by = "{law}_memory" }

[bodies]
"{law}_memory" = { frame = "{law}_memory", centre = "O", mass = 0, inertia = { in = "{law}_memory", diagonal = ["1 [kg*m^2]", "1 [kg*m^2]", "1 [kg*m^2]"] }, about = "no body: an inertia of 1 kg m^2 makes the state one of first order" }

[loads]
"{law}" = { kind = "generalized", coordinate = "{site}", force = "-{law}_force*dot({law}_memory)/(1 [rad/s])" }
"{law}_memory" = { kind = "generalized", coordinate = "{law}_memory", force = "1 [kg*m^2/s]*(dot({site}) - smooth_abs(dot({site}), {narrow_rate} [{unit}/s])*dot({law}_memory)/(1 [rad/s]))/{law}_way" }
"#;

/// The prefix of the names of a law at a site.
fn prefix(site: &str, mechanism: &Mechanism) -> String {
    unused(format!("law_{}", identifier(site)), mechanism)
}

impl Candidate {
    /// A measured force along a pseudo-velocity: `force` is an expression of the spec language, in which `{law}` is the
    /// prefix of its coefficients. Each of these has a unit and a normal prior.
    pub(crate) fn measured(
        mechanism: &Mechanism,
        speed: &str,
        force: &str,
        numbers: &[(String, String, Known)],
    ) -> Self {
        let stem = prefix(speed, mechanism);
        let mut document = DocumentMut::new();
        let mut parameters = Table::new();
        for (name, unit, known) in numbers {
            let (value, unit) = (Value::from(known[0]), Value::from(unit));
            let item = InlineTable::from_iter([("value", value), ("unit", unit)]);
            parameters.insert(&format!("{stem}_{name}"), Item::Value(item.into()));
        }
        let load = InlineTable::from_iter([
            ("kind", Value::from("generalized")),
            ("velocity", speed.into()),
            ("force", filled(force, &[("law", &stem)]).into()),
        ]);
        let loads = Table::from_iter([(stem.clone(), Value::from(load))]);
        document.insert("parameters", Item::Table(parameters));
        document.insert("loads", Item::Table(loads));
        let known = numbers.iter();
        let known = known.map(|(name, _, known)| (name.as_str(), *known));
        Self {
            about: format!("measured force along {speed}"),
            items: document.to_string(),
            ..Self::law(stem, speed, &known.collect::<Vec<_>>())
        }
    }

    /// A force with a hidden state; `None` where its first estimate is not positive and finite, or where the rate of its
    /// coordinate appears in no pseudo-velocity.
    pub(crate) fn remembering(
        mechanism: &Mechanism,
        scales: &Scales,
        memory: &Memory,
    ) -> Option<Self> {
        let (coordinate, size) = match memory {
            Memory::HiddenMass { behind, mass, .. } => (behind, mass[0]),
            Memory::Hysteresis { along, force, .. } => (along, force[0]),
        };
        if size <= 0.0 || !size.is_finite() {
            return None;
        }
        let sites = Sites {
            mechanism,
            scales,
            text: "",
        };
        let sites = sites.coordinates(|q| sites.units(q).is_some());
        let site = sites.into_iter().find(|site| site.name == *coordinate)?;
        let typical = scales.rates[site.index];
        let (about, mut text, known, begins) = match memory {
            Memory::HiddenMass {
                mass,
                rate,
                damping,
                ..
            } => {
                let is_length = site.words.contains(&("unit", LENGTH[0].to_owned()));
                let (form, kg) = if is_length {
                    (SLIDING, "kg")
                } else {
                    (TURNING, "kg*m^2")
                };
                (
                    format!("a mass that swings behind {coordinate}"),
                    [HELD, form].concat().replace("{kg}", kg),
                    vec![("mass", *mass), ("rate", *rate), ("damping", *damping)],
                    // Initial deflection: up to the travel of the coordinate in one radian of the oscillation.
                    [typical, typical / rate[0]],
                )
            }
            Memory::Hysteresis { force, way, .. } => {
                let step = way[0] / (STEPS * typical);
                let step = mechanism.longest_step.map_or(step, |own| own.min(step));
                (
                    format!(
                        "a force that depends on the travel of {coordinate} since its last reversal"
                    ),
                    HYSTERESIS.replace("{step}", &number(step)),
                    vec![("force", *force), ("way", *way)],
                    BEGINS,
                )
            }
        };
        for (name, [mean, _]) in &known {
            text = text.replace(&format!("{{{name}_value}}"), &number(*mean));
            text = text.replace(&format!("{{{name}_least}}"), &number(LEAST * mean));
        }
        let stem = prefix(coordinate, mechanism);
        let mut words = vec![("law", stem.as_str()), ("site", coordinate)];
        words.extend(site.words.iter().map(|(word, text)| (*word, text.as_str())));
        Some(Self {
            about,
            items: filled(&text, &words),
            hides: Some(begins),
            ..Self::law(stem.clone(), coordinate, &known)
        })
    }

    /// The coefficients of a law, which are named after its stem and have normal priors.
    fn law(stem: String, site: &str, known: &[(&str, Known)]) -> Self {
        let parameter =
            |(name, known): &(&str, Known)| (format!("{stem}_{name}"), Part::Term(*known));
        Self {
            kind: "law".to_owned(),
            site: site.to_owned(),
            family: Family::Force,
            acts: Acts::Items,
            parameters: known.iter().map(parameter).collect(),
            stem,
            counts: 1,
            ..Self::default()
        }
    }

    /// Whether it is a measured force.
    pub(crate) fn is_measured(&self) -> bool {
        self.kind == "law"
    }

    /// Prior means of its coefficients.
    pub(crate) fn expected(&self) -> Vec<f64> {
        let expected = |(_, part): &(String, Part)| match part {
            Part::Term([expected, _]) => Some(*expected),
            _ => None,
        };
        self.parameters.iter().filter_map(expected).collect()
    }
}
