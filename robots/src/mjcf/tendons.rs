//! Tendons that are sums of coordinates.

use appell_spec::{Code, did_you_mean};
use roxmltree::Attribute;

use crate::model::{Joint, LeftOut, Polynomial, Sum, Tendon};
use crate::xml::{Element, children, elements, exactly, numbers, tag};

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
        let acts = |key: &str| {
            let own = element.attribute_node(key);
            let given = own.or_else(|| self.defaults.attribute("tendon", class, key));
            given.is_some_and(|given| {
                given
                    .value()
                    .split_ascii_whitespace()
                    .any(|word| word != "0")
            })
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
        let attribute = |key: &str| {
            let own = element.attribute_node(key);
            own.or_else(|| self.defaults.attribute("tendon", class, key))
        };
        let number = |key: &str| {
            let given = attribute(key)?;
            exactly::<1>(self.findings, &given, &format!("`{key}`")).map(|[number]| number)
        };
        let polynomial = |key: &str| self.polynomial(attribute(key));
        let name = element.attribute("name");
        let name = name.map_or_else(|| format!("tendon_{}", count + 1), str::to_owned);
        let length = self.sum(element)?;
        let springlength = match attribute("springlength") {
            Some(given) => numbers(self.findings, &given)?,
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
        let limited = attribute("limited").is_none_or(|given| given.value() != "false");
        let zero = |word: &str| word == "0";
        let bounds = |given: &Attribute<'_, '_>| !given.value().split_ascii_whitespace().all(zero);
        let given = attribute("range").filter(bounds);
        let range =
            given.and_then(|given| exactly::<2>(self.findings, &given, "a range, from to,"));
        let bounded = given.filter(|_| limited).map(|range| LeftOut {
            what: "tendon/range".to_owned(),
            name: Some(name.clone()),
            effect: Some("its length is not bounded"),
            place: range.range(),
        });
        let tendon = Tendon {
            name,
            length,
            damping: polynomial("damping"),
            stiffness: polynomial("stiffness"),
            relaxed,
            friction: number("frictionloss").unwrap_or_default(),
            armature: number("armature").unwrap_or_default(),
            range,
            drive_range: self.bounds(&attribute, "actuatorfrcrange", "actuatorfrclimited"),
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
            let factor = match term.attribute_node("coef") {
                Some(given) => exactly::<1>(self.findings, &given, "`coef`")?[0],
                None => 1.0,
            };
            sum.terms.push((joint.name.clone(), factor));
        }
        if sum.terms.is_empty() {
            let help = "write `<joint joint=\"…\" coef=\"1\"/>`";
            self.findings.error(
                Code::MissingKey,
                tag(tendon),
                "the tendon has no joint",
                help,
            );
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
            self.findings.error(
                Code::UnknownReference,
                given.range_value(),
                format!("there is no joint `{}`", appell_spec::shown(given.value())),
                did_you_mean(given.value(), known, || {
                    "name a hinge or a slide of the file".to_owned()
                }),
            );
        }
        found
    }

    /// Up to three factors.
    pub(super) fn polynomial(&self, given: Option<Attribute<'x, 'x>>) -> Polynomial {
        let read = given.and_then(|given| numbers(self.findings, &given));
        let mut polynomial = [0.0; 3];
        for (factor, read) in polynomial.iter_mut().zip(read.into_iter().flatten()) {
            *factor = read;
        }
        polynomial
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
                self.findings.error(
                    Code::UnknownReference,
                    given.range_value(),
                    format!("there is no fixed tendon `{}`", appell_spec::shown(given.value())),
                    did_you_mean(given.value(), known, || {
                        "name a `tendon/fixed`; remove what couples spatial tendons, and add position constraints to \
                         the spec"
                            .to_owned()
                    }),
                );
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
