//! Hinge, slide, ball and free joints.

use appell_spec::{Code, did_you_mean};
use roxmltree::Attribute;

use crate::model::{Joint, Motion};
use crate::rotation::{Vector, is_zero, unit};
use crate::xml::{Element, exactly, tag};

use super::{Held, Reader};

impl<'x> Reader<'x, '_> {
    /// The joints of a body, in the order in which they move it.
    pub(super) fn joints(&self, held: &[Held<'x>], name: &str) -> Vec<Joint> {
        let joints = held
            .iter()
            .filter(|held| ["joint", "freejoint"].contains(&held.element.tag_name().name()));
        let count = joints.clone().count();
        let joints = joints.enumerate().filter_map(|(index, held)| {
            let (element, within) = (held.element, held.pose);
            let given = element.attribute("name").map(str::to_owned);
            if element.has_tag_name("freejoint") {
                // Defaults of joints do not apply.
                return Some(Joint {
                    place: tag(element),
                    ..Joint::without_axis(given.unwrap_or(name.to_owned()), Motion::Free, [0.0; 3])
                });
            }
            let name = given.unwrap_or_else(|| match count {
                1 => format!("joint_{name}"),
                _ => format!("joint_{name}_{}", index + 1),
            });
            let class = self.class(element, "class").or(held.class);
            let joint = self.joint_of(element, name, class)?;
            Some(Joint {
                axis: within.rotation.of(joint.axis),
                anchor: if joint.motion == Motion::Free {
                    [0.0; 3]
                } else {
                    within.of(joint.anchor)
                },
                ..joint
            })
        });
        joints.collect()
    }

    fn joint_of(
        &self,
        element: Element<'x>,
        name: String,
        class: Option<&'x str>,
    ) -> Option<Joint> {
        let attribute = |key: &str| {
            let own = element.attribute_node(key);
            own.or_else(|| self.defaults.attribute("joint", class, key))
        };
        let number = |key: &str| {
            let given = attribute(key)?;
            exactly::<1>(self.findings, &given, &format!("`{key}`")).map(|[number]| number)
        };
        let vector = |key: &str, what: &str| {
            let given = attribute(key)?;
            exactly::<3>(self.findings, &given, what)
        };
        let kind = attribute("type");
        let motion = self.motion(element, kind)?;
        let polynomial = |key: &str| self.polynomial(attribute(key));
        let friction = number("frictionloss").unwrap_or_default();
        let armature = number("armature").unwrap_or_default();
        if !motion.has_axis() {
            let joint = Joint {
                anchor: vector("pos", "a position, x y z,").unwrap_or_default(),
                damping: polynomial("damping"),
                stiffness: polynomial("stiffness"),
                armature,
                friction,
                settles: self.springdamper(&attribute),
                place: tag(element),
                ..Joint::along(name, motion, [1.0, 0.0, 0.0])
            };
            let free = attribute("limited").is_some_and(|given| given.value() == "false");
            let limited = motion == Motion::Ball && attribute("range").is_some() && !free;
            return Some(self.without_axis(joint, limited));
        }
        let angle = |value: f64| match motion {
            Motion::Turning => self.compiler.angles.radians(value),
            _ => value,
        };
        let along: Vector = vector("axis", "a direction, x y z,").unwrap_or([0.0, 0.0, 1.0]);
        let axis = unit(along).unwrap_or_else(|| {
            let at = attribute("axis").map_or_else(|| tag(element), |given| given.range_value());
            let message = format!("the axis of joint `{name}` has length zero");
            self.findings.error(
                Code::VanishingLength,
                at,
                message,
                "give its direction, such as `0 0 1`",
            );
            [0.0, 0.0, 1.0]
        });
        let limited = attribute("limited").map(|given| given.value() == "true");
        let range = attribute("range");
        let range =
            range.and_then(|given| exactly::<2>(self.findings, &given, "a range, from to,"));
        let auto = self.compiler.autolimits && range.is_some_and(|[from, to]| from < to);
        let limited = match attribute("limited").map(|given| given.value()) {
            Some("auto") | None => auto,
            _ => limited == Some(true),
        };
        Some(Joint {
            motion,
            axis,
            drive_range: self.bounds(&attribute, "actuatorfrcrange", "actuatorfrclimited"),
            anchor: vector("pos", "a position, x y z,").unwrap_or_default(),
            zero: angle(number("ref").unwrap_or_default()),
            range: range
                .filter(|[from, to]| limited && from < to)
                .map(|range| range.map(angle)),
            damping: polynomial("damping"),
            armature,
            friction,
            stiffness: polynomial("stiffness"),
            settles: self.springdamper(&attribute),
            place: tag(element),
            relaxed: angle(number("springref").unwrap_or_default()),
            name,
        })
    }

    /// A joint without an axis; properties without a counterpart give warnings.
    fn without_axis(&self, joint: Joint, limited: bool) -> Joint {
        let [damping, higher @ ..] = joint.damping;
        for (what, is_there) in [
            ("stiffness", !is_zero(joint.stiffness)),
            ("springdamper", joint.settles.is_some()),
            ("range", limited),
            ("damping", higher.iter().any(|factor| *factor != 0.0)),
        ] {
            if is_there {
                let which = if what == "damping" {
                    " beyond its first factor"
                } else {
                    ""
                };
                let name = &joint.name;
                self.findings.warning(
                    Code::NotAllowedHere,
                    joint.place.clone(),
                    format!(
                        "`{what}`{which} of joint `{name}` is left out, which changes the motion"
                    ),
                    "it needs a hinge or a slide; add a load to the spec",
                );
            }
        }
        Joint {
            damping: [damping, 0.0, 0.0],
            stiffness: [0.0; 3],
            anchor: if joint.motion == Motion::Free {
                [0.0; 3]
            } else {
                joint.anchor
            },
            ..joint
        }
    }

    /// Time constant and damping ratio of a spring with a damper, where both are positive.
    fn springdamper(
        &self,
        attribute: &dyn Fn(&str) -> Option<Attribute<'x, 'x>>,
    ) -> Option<[f64; 2]> {
        let given = attribute("springdamper")?;
        let what = "a time constant and a damping ratio";
        exactly(self.findings, &given, what)
            .filter(|both: &[f64; 2]| both.iter().all(|one| *one > 0.0))
    }

    fn motion(&self, element: Element<'x>, kind: Option<Attribute<'_, '_>>) -> Option<Motion> {
        let Some(kind) = kind else {
            return Some(Motion::Turning);
        };
        // The type may be that of a class elsewhere.
        let at = element
            .attribute_node("type")
            .map_or_else(|| tag(element), |own| own.range_value());
        match kind.value() {
            "hinge" => Some(Motion::Turning),
            "slide" => Some(Motion::Sliding),
            "ball" => Some(Motion::Ball),
            "free" => Some(Motion::Free),
            other => {
                let kinds = ["hinge", "slide", "ball", "free"];
                self.findings.error(
                    Code::UnknownWord,
                    at,
                    format!(
                        "there are no joints of type `{}`",
                        appell_spec::shown(other)
                    ),
                    did_you_mean(other, kinds, || format!("types are {}", kinds.join(", "))),
                );
                None
            }
        }
    }
}
