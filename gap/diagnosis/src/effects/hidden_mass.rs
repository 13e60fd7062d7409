//! A mass coupled to a coordinate by a spring and a damper, which the spec includes in the inertia of the
//! coordinate: a swinging load, a sloshing liquid, an elastic drive.

use appell_spec::Mechanism;

use super::candidate::{Candidate, filled};
use super::site::{Scales, Sites, number};
use super::site_kind::SiteKind;
use super::stem::{Known, Stem};

/// Its coordinate and parameters, in SI.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct HiddenMass {
    /// The coordinate.
    pub(crate) behind: String,
    /// Mass, or moment of inertia.
    pub(crate) mass: Known,
    /// Undamped natural frequency in rad/s.
    pub(crate) rate: Known,
    /// Damping ratio.
    pub(crate) damping: Known,
}

/// Lower limits relative to the first estimates.
const LEAST: f64 = 1e-3;

/// Items common to masses and moments of inertia; `{m}` is the unit of the coordinate, `{kg}` that of the inertia.
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

impl HiddenMass {
    /// The law; `None` without a positive mass, or where the rate of the coordinate appears in no pseudo-velocity.
    pub(super) fn candidate(&self, mechanism: &Mechanism, scales: &Scales) -> Option<Candidate> {
        let coordinate = self.behind.as_str();
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
        let [mass, rate, damping] = [self.mass, self.rate, self.damping].map(|own| own[0]);
        let values = [
            ("mass", mass),
            ("least_mass", LEAST * mass),
            ("rate", rate),
            ("least_rate", LEAST * rate),
            ("damping", damping),
        ];
        let values = values.map(|(word, value)| (word, number(value)));
        let stem = Stem::of(coordinate, mechanism);
        let mut words = stem.words();
        words.extend([("m", m), ("kg", kg)]);
        words.extend(site.words.iter().map(|(word, text)| (*word, text.as_str())));
        words.extend(values.iter().map(|(word, text)| (*word, text.as_str())));
        let items = filled(&format!("{HELD}{text}"), &words);
        let known = [
            ("mass", self.mass),
            ("rate", self.rate),
            ("damping", self.damping),
        ];
        let about = format!("a mass that swings behind {coordinate}");
        // Initial deflection: up to the travel of the coordinate in one radian of the oscillation.
        let typical = scales.rates[site.index];
        Some(stem.candidate(about, items, &known, [typical, typical / rate]))
    }
}
