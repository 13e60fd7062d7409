//! Hinges, slides, balls, and bodies that are free.

use appell_spec::{Code, did_you_mean};
use roxmltree::Attribute;

use crate::model::{Joint, Motion};
use crate::rotation::{Vector, unit};
use crate::xml::{Element, child, children, exactly, tag};

use super::Reader;

impl<'x> Reader<'x, '_> {
    /// The joints of a body, in the order in which they move it.
    pub(super) fn joints(
        &self,
        body: Element<'x>,
        name: &str,
        class: Option<&'x str>,
    ) -> Vec<Joint> {
        if let Some(free) = child(body, "freejoint") {
            let name = free.attribute("name").unwrap_or(name).to_owned();
            return vec![Joint::without_axis(name, Motion::Free, [0.0; 3])];
        }
        let elements: Vec<Element<'x>> = children(body, "joint").collect();
        let count = elements.len();
        let joints = elements.into_iter().enumerate();
        let joints = joints.filter_map(|(index, element)| {
            let name = element.attribute("name").map_or_else(
                || match count {
                    1 => format!("joint_{name}"),
                    _ => format!("joint_{name}_{}", index + 1),
                },
                str::to_owned,
            );
            let class = self.class(element, "class").or(class);
            self.joint(element, name, class)
        });
        joints.collect()
    }

    fn joint(&self, element: Element<'x>, name: String, class: Option<&'x str>) -> Option<Joint> {
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
        if !motion.has_axis() {
            let anchor = vector("pos", "a position, x y z,").unwrap_or_default();
            let positive = |key: &str| number(key).filter(|number| *number != 0.0);
            let mut left_out = vec!["stiffness", "frictionloss"];
            left_out.extend((motion == Motion::Free).then_some("armature"));
            for &key in &left_out {
                if positive(key).is_some() {
                    self.findings.warning(
                        Code::NotAllowedHere,
                        tag(element),
                        format!("`{key}` of joint `{name}` is left out"),
                        "it is read of hinges and slides; add a load to the spec",
                    );
                }
            }
            return Some(Joint {
                damping: number("damping").unwrap_or_default(),
                armature: if motion == Motion::Free {
                    0.0
                } else {
                    number("armature").unwrap_or_default()
                },
                ..Joint::without_axis(name, motion, anchor)
            });
        }
        let angle = |value: f64| match motion {
            Motion::Turning => self.compiler.angles.radians(value),
            _ => value,
        };
        if let Some(given) = attribute("springdamper")
            && given
                .value()
                .split_ascii_whitespace()
                .any(|word| word != "0")
        {
            self.findings.error(
                Code::NotAllowedHere,
                given.range(),
                format!("`springdamper` of joint `{name}` is not read yet"),
                "write `stiffness` and `damping`",
            );
        }
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
            anchor: vector("pos", "a position, x y z,").unwrap_or_default(),
            zero: angle(number("ref").unwrap_or_default()),
            range: range
                .filter(|[from, to]| limited && from < to)
                .map(|range| range.map(angle)),
            damping: number("damping").unwrap_or_default(),
            armature: number("armature").unwrap_or_default(),
            friction: number("frictionloss").unwrap_or_default(),
            stiffness: number("stiffness").unwrap_or_default(),
            relaxed: angle(number("springref").unwrap_or_default()),
            name,
        })
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
