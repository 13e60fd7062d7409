//! Hinge, slide, ball and free joints.

use appell_spec::Code;
use roxmltree::Attribute;

use crate::model::{Joint, Motion};
use crate::rotation::{is_zero, unit};
use crate::xml::{Element, no_type, tag};

use super::defaults::Given;
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
        let given = self.given(element, "joint", class);
        let motion = self.motion(element, given.attribute("type"))?;
        let joint = Joint {
            anchor: given
                .exactly("pos", "a position, x y z,")
                .unwrap_or_default(),
            damping: given.polynomial("damping"),
            stiffness: given.polynomial("stiffness"),
            armature: given.number("armature").unwrap_or_default(),
            friction: given.number("frictionloss").unwrap_or_default(),
            settles: springdamper(&given),
            place: tag(element),
            ..Joint::along(name, motion, [1.0, 0.0, 0.0])
        };
        let limited = given.word("limited");
        if !motion.has_axis() {
            let ranged = motion == Motion::Ball && given.attribute("range").is_some();
            return Some(self.without_axis(joint, ranged && limited != Some("false")));
        }
        let angle = |value: f64| match motion {
            Motion::Turning => self.compiler.angles.radians(value),
            _ => value,
        };
        let along = given.exactly("axis", "a direction, x y z,");
        let axis = unit(along.unwrap_or([0.0, 0.0, 1.0])).unwrap_or_else(|| {
            let message = format!("the axis of joint `{}` has length zero", joint.name);
            let help = "give its direction, such as `0 0 1`";
            self.findings
                .error(Code::VanishingLength, given.place("axis"), message, help);
            [0.0, 0.0, 1.0]
        });
        let range = given.exactly::<2>("range", "a range, from to,");
        let limited = match limited {
            Some("auto") | None => self.compiler.autolimits,
            Some(word) => word == "true",
        };
        let range = range.filter(|[from, to]| limited && from < to);
        Some(Joint {
            axis,
            drive_range: self.bounds(&given, "actuatorfrcrange", "actuatorfrclimited"),
            zero: angle(given.number("ref").unwrap_or_default()),
            range: range.map(|range| range.map(angle)),
            relaxed: angle(given.number("springref").unwrap_or_default()),
            ..joint
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
                let message = format!(
                    "`{what}`{which} of joint `{name}` is left out, which changes the motion"
                );
                let help = "it needs a hinge or a slide; add a load to the spec";
                self.findings
                    .warning(Code::NotAllowedHere, joint.place.clone(), message, help);
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
                self.findings.add(no_type("joints", other, at, &kinds));
                None
            }
        }
    }
}

/// Time constant and damping ratio of a spring with a damper, where both are positive.
fn springdamper(given: &Given<'_, '_>) -> Option<[f64; 2]> {
    let both = given.exactly("springdamper", "a time constant and a damping ratio");
    both.filter(|both: &[f64; 2]| both.iter().all(|one| *one > 0.0))
}
