//! Tendons that are sums of coordinates.

use appell_spec::Code;
use roxmltree::Attribute;

use crate::model::{Joint, LeftOut, Sum, Tendon};
use crate::xml::{Element, children, elements, no_such, number, tag};

use super::schema::effect;
use super::{Equality, Reader};

/// Value of an attribute that means the length at which all springs are relaxed.
const BY_JOINTS: f64 = -1.0;

impl<'x> Reader<'x, '_> {
    /// Reads `<tendon>`.
    pub(super) fn tendons(&mut self) -> Vec<Tendon> {
        let mut tendons: Vec<Tendon> = Vec::new();
        for element in children(self.root, "tendon").flat_map(elements) {
            let count = tendons.len();
            match element.tag_name().name() {
                "fixed" => tendons.extend(self.fixed_tendon(element, count)),
                _ => self.spatial_tendon(element),
            }
        }
        tendons
    }

    /// A spatial tendon: listed as left out if it exerts a force.
    fn spatial_tendon(&mut self, element: Element<'x>) {
        let class = self.class(element, "class");
        let does = ["stiffness", "damping", "frictionloss", "armature", "range"];
        let given = self.given(element, "tendon", class);
        let acts = |key: &str| {
            let words = given.word(key).unwrap_or_default();
            words.split_ascii_whitespace().any(|word| word != "0")
        };
        let effect = does.into_iter().any(acts).then(|| effect(element));
        self.left_out.push(LeftOut {
            what: "tendon/spatial".to_owned(),
            name: element.attribute("name").map(str::to_owned),
            effect: effect.flatten(),
            place: tag(element),
        });
    }

    fn fixed_tendon(&mut self, element: Element<'x>, count: usize) -> Option<Tendon> {
        let class = self.class(element, "class");
        let given = self.given(element, "tendon", class);
        let name = element.attribute("name");
        let name = name.map_or_else(|| format!("tendon_{}", count + 1), str::to_owned);
        let length = self.sum(element)?;
        let springlength = match given.attribute("springlength") {
            Some(_) => given.numbers("springlength")?,
            None => vec![BY_JOINTS],
        };
        let relaxed = match springlength.as_slice() {
            [one, ..] if *one == BY_JOINTS => {
                [length.at(|joint| self.joint(joint).map_or(0.0, |own| own.relaxed)); 2]
            }
            [from, to, ..] => [*from, *to],
            [one] => [*one; 2],
            [] => [0.0; 2],
        };
        let limited = given.word("limited") != Some("false");
        let zero = |word: &str| word == "0";
        let bounds = |range: &Attribute<'_, '_>| !range.value().split_ascii_whitespace().all(zero);
        let ranged = given.attribute("range").filter(bounds);
        let range = ranged.and_then(|_| given.exactly("range", "a range, from to,"));
        let bounded = ranged.filter(|_| limited).map(|range| LeftOut {
            what: "tendon/range".to_owned(),
            name: Some(name.clone()),
            effect: Some("its length is not bounded"),
            place: range.range(),
        });
        let tendon = Tendon {
            name,
            length,
            damping: given.polynomial("damping"),
            stiffness: given.polynomial("stiffness"),
            relaxed,
            friction: given.number("frictionloss").unwrap_or_default(),
            armature: given.number("armature").unwrap_or_default(),
            range,
            drive_range: self.bounds(&given, "actuatorfrcrange", "actuatorfrclimited"),
            place: tag(element),
        };
        self.left_out.extend(bounded);
        Some(tendon)
    }

    /// The joints of a fixed tendon with their factors.
    fn sum(&self, tendon: Element<'x>) -> Option<Sum> {
        let mut sum = Sum::default();
        for term in children(tendon, "joint") {
            let joint = self.joint_named(term, "joint")?;
            let factor = if term.has_attribute("coef") {
                number(self.findings, term, "coef")?
            } else {
                1.0
            };
            sum.terms.push((joint.name.clone(), factor));
        }
        if sum.terms.is_empty() {
            let (message, help) = (
                "the tendon has no joint",
                "write `<joint joint=\"…\" coef=\"1\"/>`",
            );
            self.findings
                .error(Code::MissingKey, tag(tendon), message, help);
            return None;
        }
        Some(sum)
    }

    /// A joint with an axis by its name.
    pub(super) fn joint(&self, name: &str) -> Option<&Joint> {
        let link = *self.joint_links.get(name)?;
        self.links[link].joint.as_ref()
    }

    /// The joint with an axis that an attribute names, which has to exist.
    pub(super) fn joint_named(&self, element: Element<'x>, key: &str) -> Option<&Joint> {
        let given = element.attribute_node(key)?;
        let found = self.joint(given.value());
        if found.is_none() {
            let known = self.joint_links.keys().map(String::as_str);
            let (name, at) = (given.value(), given.range_value());
            let help = "name a hinge or a slide of the file";
            self.findings.add(no_such("joint", name, at, known, help));
        }
        found
    }

    /// `equality/tendon`: the length of a tendon is a polynomial of another one, or constant.
    pub(super) fn coupled_tendons(
        &self,
        element: Element<'x>,
        tendons: &[Tendon],
        read: &mut Equality,
    ) -> Option<()> {
        let find = |key: &str| {
            let given = element.attribute_node(key)?;
            let found = tendons.iter().find(|tendon| tendon.name == given.value());
            if found.is_none() {
                let known = tendons.iter().map(|tendon| tendon.name.as_str());
                let (name, at) = (given.value(), given.range_value());
                let help = "name a `tendon/fixed`; remove what couples spatial tendons, and add position constraints to \
                            the spec";
                self.findings
                    .add(no_such("fixed tendon", name, at, known, help));
            }
            found
        };
        let follows = find("tendon1")?;
        let other = match element.attribute_node("tendon2") {
            Some(_) => Some(find("tendon2")?),
            None => None,
        };
        let drawn = |tendon: &Tendon| {
            tendon
                .length
                .at(|joint| self.joint(joint).map_or(0.0, |own| own.zero))
        };
        let zeros = [drawn(follows), other.map_or(0.0, drawn)];
        let follows = follows.length.clone();
        let other = other.map(|other| other.length.clone());
        self.couple(element, follows, other, zeros, read)
    }
}
