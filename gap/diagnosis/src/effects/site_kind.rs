//! Kinds of sites at which effects act, the sites of each in a mechanism, and the placeholders that it defines.

use super::site::{ANGLE, LENGTH, Site, Sites};

/// A kind of sites.
#[derive(Debug)]
pub struct SiteKind {
    /// Its keyword.
    pub word: &'static str,
    /// Description of such a site.
    pub about: &'static str,
    /// Lists of placeholders at such a site, in addition to `effect` and `site`.
    words: &'static [&'static str],
    sites: fn(&Sites<'_>) -> Vec<Site>,
}

/// All kinds.
pub(super) static KINDS: [SiteKind; 19] = [
    SiteKind {
        word: "coordinate",
        about: "length or angle that is not prescribed",
        words: &[OF_COORDINATE, ACROSS],
        sites: |all| all.coordinates(|q| all.units(q).is_some()),
    },
    SiteKind {
        word: "slider",
        about: "length that is not prescribed",
        words: &[OF_COORDINATE, ACROSS],
        sites: |all| all.coordinates(|q| all.units(q) == Some(LENGTH)),
    },
    SiteKind {
        word: "hinge",
        about: "angle that is not prescribed",
        words: &[OF_COORDINATE, ACROSS],
        sites: |all| all.coordinates(|q| all.units(q) == Some(ANGLE)),
    },
    SiteKind {
        word: "driven_slider",
        about: "driven length whose rate is a pseudo-velocity",
        words: &[OF_COORDINATE, ACROSS, OF_DRIVEN, LATER_DRIVEN],
        sites: |all| all.driven(LENGTH),
    },
    SiteKind {
        word: "driven_hinge",
        about: "driven angle whose rate is a pseudo-velocity",
        words: &[OF_COORDINATE, ACROSS, OF_DRIVEN, LATER_DRIVEN],
        sites: |all| all.driven(ANGLE),
    },
    SiteKind {
        word: "body",
        about: "body",
        words: &[OF_BODY, LATER_BODY],
        sites: |all| all.bodies(),
    },
    SiteKind {
        word: "rigid_body",
        about: "body with a frame",
        words: &[OF_BODY, OF_RIGID, LATER_BODY],
        sites: |all| all.rigid_bodies(),
    },
    SiteKind {
        word: "wheel",
        about: "body that rolls",
        words: &[OF_BODY, OF_WHEEL, LATER_BODY],
        sites: |all| all.wheels(),
    },
    SiteKind {
        word: "contact",
        about: "rolling contact",
        words: &[],
        sites: |all| all.contacts(),
    },
    SiteKind {
        word: "gravity",
        about: "weight",
        words: &["gravity", ACROSS],
        sites: |all| all.gravity().into_iter().collect(),
    },
    SiteKind {
        word: "parameter",
        about: "parameter with a tolerance",
        words: &[],
        sites: |all| all.parameters(),
    },
    SiteKind {
        word: "input",
        about: "input that was used",
        words: &["unit largest narrow"],
        sites: |all| all.inputs(),
    },
    SiteKind {
        word: "channel",
        about: "measured column",
        words: &[],
        sites: |all| all.channels(),
    },
    SiteKind {
        word: "reached",
        about: "measured coordinate that reversed at an end of its range",
        words: &[OF_COORDINATE, ACROSS, OF_REACHED],
        sites: |all| all.reached(),
    },
    SiteKind {
        word: "pair",
        about: "pair of coordinates, of neighbours only where there are many",
        words: &[OF_PAIR],
        sites: |all| all.pairs(),
    },
    SiteKind {
        word: "load",
        about: "load that depends on the motion like a feedback controller",
        words: &[OF_LOAD],
        sites: |all| all.loads(false),
    },
    SiteKind {
        word: "servo",
        about: "such a load with the name of its input, the actuator of a robot",
        words: &[OF_LOAD],
        sites: |all| all.loads(true),
    },
    SiteKind {
        word: "joint",
        about: "coordinate driven by the actuator of a robot: a load with the name of its input",
        words: &[OF_COORDINATE, ACROSS],
        sites: |all| all.coordinates(|q| all.units(q).is_some() && all.is_joint(q)),
    },
    SiteKind {
        word: "encoder",
        about: "measured column of such a coordinate",
        words: &["coordinate unit"],
        sites: |all| all.encoders(),
    },
];

impl SiteKind {
    /// Its placeholders.
    pub(super) fn words(&self) -> Vec<&'static str> {
        let lists = self.words.iter();
        lists.flat_map(|list| list.split_whitespace()).collect()
    }

    /// Whether an effect there may add a coordinate.
    pub(super) fn bears_coordinate(&self) -> bool {
        self.words.contains(&LATER_DRIVEN)
    }

    /// Its sites in a mechanism.
    pub(super) fn of(&self, all: &Sites<'_>) -> Vec<Site> {
        let sites = (self.sites)(all);
        let mut known = self.words();
        let is_later = |word: &str| LATER_BODY == word || LATER_DRIVEN.contains(word);
        known.retain(|word| !is_later(word));
        known.sort_unstable();
        for site in &sites {
            let mut own: Vec<&str> = site.words.iter().map(|(word, _)| *word).collect();
            own.sort_unstable();
            debug_assert_eq!(own, known, "words of {}", self.word);
        }
        sites
    }
}

const OF_COORDINATE: &str = "unit force typical_rate narrow_rate";
const ACROSS: &str = "across_1 across_2 across_x across_y across_z";
const OF_REACHED: &str = "upper lower range";
const OF_PAIR: &str = "first second first_unit second_unit first_force second_force ratio";
const OF_BODY: &str = "centre frame speed velocity_x velocity_y velocity_z";
const OF_RIGID: &str = "away_x away_y away_z reach";
const OF_WHEEL: &str = "contact roll narrow_rate axle_rate spin normal_x normal_y normal_z";
const OF_LOAD: &str = "expression unit largest narrow";
const OF_DRIVEN: &str = "pseudo_velocity";
/// Placeholders whose texts depend on the equations of the mechanism.
const LATER_DRIVEN: &str = "drive inertia";
/// A placeholder whose text depends on the other effects of the body.
const LATER_BODY: &str = "last_centre";
