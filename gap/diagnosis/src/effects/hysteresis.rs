//! A force that depends on the travel since the last reversal: dry friction with presliding displacement, as of a
//! belt, a rubber bush, a cable.
//!
//! With the state `z` in −1 to 1, the force is `-F z`, and `δ dz/dt = q' - |q'| z` (P. R. Dahl, *A solid friction
//! model*, The Aerospace Corporation, 1968). A spec has no first-order states; the rate of an otherwise free inertia
//! serves as one.

use appell_spec::Mechanism;

use super::candidate::{Candidate, filled};
use super::site::{Scales, Sites, number};
use super::site_kind::SiteKind;
use super::stem::{Known, Stem};

/// Its coordinate and parameters, in SI.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Hysteresis {
    /// The coordinate.
    pub(crate) along: String,
    /// Force after a long travel in one direction.
    pub(crate) force: Known,
    /// Presliding displacement δ.
    pub(crate) way: Known,
}

/// Lower limit of the displacement relative to its first estimate.
const LEAST: f64 = 1e-3;

/// Filter steps over the presliding displacement at the typical rate.
const STEPS: f64 = 4.0;

/// Initial standard deviations of z and of its integral: z is unknown, the integral irrelevant.
const BEGINS: [f64; 2] = [0.7, 0.0];

/// `{unit}` is that of the coordinate, `{force}` that of the force along it.
const LAW: &str = r#"
[mechanism]
longest_step = {step}

[parameters]
"{law}_force" = { value = {size}, unit = "{force}", about = "force along {site} after a long travel in one direction" }
"{law}_way"   = { value = {way}, unit = "{unit}", at_least = {least_way}, about = "presliding displacement" }

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

impl Hysteresis {
    /// The law; `None` where the rate of the coordinate appears in no pseudo-velocity.
    pub(super) fn candidate(&self, mechanism: &Mechanism, scales: &Scales) -> Option<Candidate> {
        let coordinate = self.along.as_str();
        let sites = Sites::new(mechanism, scales).of(SiteKind::Coordinate);
        let site = sites.into_iter().find(|site| site.name == coordinate)?;
        let step = self.way[0] / (STEPS * scales.rates[site.index]);
        let values = [
            (
                "step",
                mechanism.longest_step.map_or(step, |own| own.min(step)),
            ),
            ("size", self.force[0]),
            ("way", self.way[0]),
            ("least_way", LEAST * self.way[0]),
        ];
        let values = values.map(|(word, value)| (word, number(value)));
        let stem = Stem::of(coordinate, mechanism);
        let mut words = stem.words();
        words.extend(site.words.iter().map(|(word, text)| (*word, text.as_str())));
        words.extend(values.iter().map(|(word, text)| (*word, text.as_str())));
        let about =
            format!("a force that depends on the travel of {coordinate} since its last reversal");
        let known = [("force", self.force), ("way", self.way)];
        Some(stem.candidate(about, filled(LAW, &words), &known, BEGINS))
    }
}
