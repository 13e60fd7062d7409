//! `<compiler>`: settings of the reader, and adjustments of masses and inertias.

use appell_spec::{Code, did_you_mean};

use crate::inertia::Inertia;
use crate::xml::{Element, Findings, children, exactly, number, tag};

use super::orientation::Angles;

/// Groups of geoms.
const GROUPS: [f64; 2] = [0.0, 5.0];

/// Settings of the reader.
pub(crate) struct Compiler {
    pub(super) angles: Angles,
    /// Whether a range implies a limit.
    pub(super) autolimits: bool,
    pub(super) inertia_from: InertiaFrom,
    /// First and last group of the geoms that have mass.
    pub(super) groups: [f64; 2],
    /// Whether principal moments that violate the triangle inequality are set to their mean.
    balance: bool,
    least_mass: f64,
    least_moment: f64,
    /// Mass to which that of the whole robot is scaled.
    pub(super) total_mass: Option<f64>,
}

/// Where the inertia of a body comes from.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum InertiaFrom {
    /// `inertial`, or the geoms where there is none.
    Either,
    Geoms,
    Inertial,
}

impl Compiler {
    /// Reads `<compiler>`; later elements add to earlier ones.
    pub(super) fn read(root: Element<'_>, findings: &Findings) -> Self {
        let mut compiler = Self {
            angles: Angles::default(),
            autolimits: true,
            inertia_from: InertiaFrom::Either,
            groups: GROUPS,
            balance: false,
            least_mass: 0.0,
            least_moment: 0.0,
            total_mass: None,
        };
        for element in children(root, "compiler") {
            compiler.add(element, findings);
        }
        compiler
    }

    fn add(&mut self, element: Element<'_>, findings: &Findings) {
        let word = |key: &str, words: &[&str]| word_of(element, key, words, findings);
        let number = |key: &str| number(findings, element, key);
        if let Some(unit) = word("angle", &["degree", "radian"]) {
            self.angles.degrees = unit == 0;
        }
        if let Some(on) = word("autolimits", &["false", "true"]) {
            self.autolimits = on == 1;
        }
        if let Some(from) = word("inertiafromgeom", &["auto", "true", "false"]) {
            self.inertia_from = [
                InertiaFrom::Either,
                InertiaFrom::Geoms,
                InertiaFrom::Inertial,
            ][from];
        }
        if word("coordinate", &["local", "global"]) == Some(1) {
            let help = "global coordinates were removed from the format: save the file anew with MuJoCo 2.3 or older";
            let message = "`coordinate=\"global\"` is not read";
            findings.error(Code::NotAllowedHere, tag(element), message, help);
        }
        if let Some(given) = element.attribute_node("eulerseq") {
            self.angles.read_sequence(&given, findings);
        }
        if let Some(given) = element.attribute_node("inertiagrouprange")
            && let Some(groups) = exactly(findings, &given, "a range of groups")
        {
            self.groups = groups;
        }
        if let Some(on) = word("balanceinertia", &["false", "true"]) {
            self.balance = on == 1;
        }
        self.least_mass = number("boundmass").unwrap_or(self.least_mass);
        self.least_moment = number("boundinertia").unwrap_or(self.least_moment);
        if let Some(total) = number("settotalmass") {
            self.total_mass = (total > 0.0).then_some(total);
        }
    }

    /// Whether masses and inertias of bodies can differ from those that are written.
    pub(super) fn adjusts(&self) -> bool {
        self.balance || self.least_mass > 0.0 || self.least_moment > 0.0
    }

    /// Mass and inertia of a body after the adjustments.
    pub(super) fn corrected(&self, inertia: Inertia) -> Inertia {
        let mut inertia = inertia;
        inertia.mass = inertia.mass.max(self.least_mass);
        inertia.bound_moments(self.least_moment);
        if self.balance && inertia.exceeds_triangle() {
            let [xx, yy, zz, ..] = inertia.tensor;
            let mean = (xx + yy + zz) / 3.0;
            inertia.tensor = [mean, mean, mean, 0.0, 0.0, 0.0];
        }
        inertia
    }
}

/// The word of an attribute, out of several.
pub(super) fn word_of(
    element: Element<'_>,
    key: &str,
    words: &[&str],
    findings: &Findings,
) -> Option<usize> {
    let given = element.attribute_node(key)?;
    let found = words.iter().position(|word| *word == given.value());
    if found.is_none() {
        let message = format!("`{key}` cannot be `{}`", appell_spec::shown(given.value()));
        let help = did_you_mean(given.value(), words.iter().copied(), || {
            format!("write {}", words.join(" or "))
        });
        findings.error(Code::UnknownWord, given.range_value(), message, help);
    }
    found
}
