//! A force that follows the way since the last turn: dry friction of what gives way before it slides, a belt, a
//! rubber bush, a cable.
//!
//! With the state `z` in −1 to 1, the force is `-F z`, and `δ dz/dt = q' - |q'| z` (P. R. Dahl, *A solid friction
//! model*, The Aerospace Corporation, 1968). A spec has no states of first order; the rate of an inertia that
//! nothing else moves is one.

use appell_spec::Mechanism;

use super::candidate::{Candidate, filled};
use super::site::{Scales, Sites, number};
use super::site_kind::SiteKind;
use super::stem::{Known, Stem};

/// Where it is, and its numbers, in SI.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Hysteresis {
    /// The coordinate.
    pub(crate) along: String,
    /// Force after a long way in one direction.
    pub(crate) force: Known,
    /// Way over which it follows a turn.
    pub(crate) way: Known,
}

/// Part of a way below which it is none.
const LEAST: f64 = 1e-3;

/// Steps of a filter in which it follows a turn at the typical rate.
const STEPS: f64 = 4.0;

/// What is remembered when a run begins may be anything; for how long, nothing follows.
const BEGINS: [f64; 2] = [0.7, 0.0];

/// `{unit}` is that of the coordinate, `{force}` that of the force along it.
const LAW: &str = r#"
[mechanism]
longest_step = {step}

[parameters]
"{law}_force" = { value = {size}, unit = "{force}", about = "force along {site} after a long way in one direction" }
"{law}_way"   = { value = {way}, unit = "{unit}", at_least = {least_way}, about = "way over which it follows a turn" }

[coordinates]
"{law}_memory" = { unit = "rad", about = "its rate in rad/s is what {site} remembers of its way, -1 to 1" }

[pseudo_velocities]
"{law}_memory_rate" = { value = "dot({law}_memory)", unit = "rad/s", about = "what {site} remembers of its way" }

[frames]
"{law}_memory" = { parent = "ground", about_axis = "{across_1}", by = "{law}_memory" }

[bodies]
"{law}_memory" = { frame = "{law}_memory", centre = "O", mass = 0, inertia = { in = "{law}_memory", diagonal = ["1 [kg*m^2]", "1 [kg*m^2]", "1 [kg*m^2]"] }, about = "no body: 1 kg m^2 makes the law of the memory one of first order" }

[loads]
"{law}" = { kind = "generalized", coordinate = "{site}", force = "-{law}_force*dot({law}_memory)/(1 [rad/s])" }
"{law}_memory" = { kind = "generalized", coordinate = "{law}_memory", force = "1 [kg*m^2/s]*(dot({site}) - smooth_abs(dot({site}), {narrow_rate} [{unit}/s])*dot({law}_memory)/(1 [rad/s]))/{law}_way" }
"#;

impl Hysteresis {
    /// The law; nothing where the coordinate moves nothing by itself.
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
        let about = format!("a force that follows the way of {coordinate} since it turned");
        let known = [("force", self.force), ("way", self.way)];
        Some(stem.candidate(about, filled(LAW, &words), &known, BEGINS))
    }
}
