//! Mass and inertia of homogeneous geoms.

use std::f64::consts::PI;

use appell_spec::Code;

use crate::inertia::Inertia;
use crate::rotation::{Pose, Rotation, Vector, add, dot, minus, scaled, unit};
use crate::xml::{Element, children, exactly, no_such, no_type, tag};

use super::defaults::Given;
use super::meshes::called;
use super::{Held, Reader};

/// Default density, that of water.
const DENSITY: f64 = 1000.0;
const SHAPES: [&str; 9] = [
    "sphere",
    "capsule",
    "cylinder",
    "ellipsoid",
    "box",
    "mesh",
    "plane",
    "hfield",
    "sdf",
];

impl<'x> Reader<'x, '_> {
    /// The combined inertia of the geoms of a body, in its frame.
    pub(super) fn of_geoms(&self, held: &[Held<'x>], matters: bool) -> Inertia {
        let geoms = held.iter().filter(|held| held.element.has_tag_name("geom"));
        geoms.fold(Inertia::NONE, |sum, held| {
            let class = self.class(held.element, "class").or(held.class);
            match self.geom(held.element, class, matters) {
                Some((own, within)) => sum.with(&own.placed(held.pose.then(within))),
                None => sum,
            }
        })
    }

    /// Records the position in the file of a geom that could collide.
    pub(super) fn touch(&mut self, geom: Element<'x>, class: Option<&'x str>) {
        let class = self.class(geom, "class").or(class);
        let given = self.given(geom, "geom", class);
        if ["contype", "conaffinity"]
            .iter()
            .any(|key| given.word(key) != Some("0"))
        {
            self.touching.push(tag(geom));
        }
    }

    /// The inertia of a geom about its own axes, and its pose.
    fn geom(
        &self,
        geom: Element<'x>,
        class: Option<&'x str>,
        matters: bool,
    ) -> Option<(Inertia, Pose)> {
        let given = self.given(geom, "geom", class);
        let mesh = given.word("mesh");
        let shape = given.word("type");
        let shape = shape.unwrap_or(if mesh.is_some() { "mesh" } else { "sphere" });
        let group = given.number("group").unwrap_or_default();
        let [first, last] = self.compiler.groups;
        if !(first..=last).contains(&group) {
            return None;
        }
        let given_mass = given.number("mass");
        let density = given.number("density").unwrap_or(DENSITY);
        let massless = given_mass == Some(0.0) || (given_mass.is_none() && density == 0.0);
        if massless || (shape == "plane" && given_mass.is_none()) {
            return None;
        }
        let of_surface = given.word("shellinertia") == Some("true");
        let unknown = match shape {
            "mesh" => None,
            _ if of_surface => Some("with `shellinertia`".to_owned()),
            "plane" | "sdf" => Some(format!("of type `{shape}`")),
            _ => mesh.map(|_| format!("a {shape} that is fitted to a mesh")),
        };
        if let Some(what) = unknown {
            if matters {
                self.mass_unknown(geom, &what);
            }
            return None;
        }
        if shape == "mesh" {
            let pose = self.pose(&given);
            return match self.mesh(self.root, mesh.unwrap_or_default()) {
                Ok((volume, one)) => {
                    let mass = given_mass.unwrap_or(density * volume);
                    let tensor = one.tensor.map(|entry| entry * mass);
                    Some((
                        Inertia {
                            mass,
                            tensor,
                            ..one
                        },
                        pose,
                    ))
                }
                Err(why) => {
                    if matters {
                        self.mass_unknown(geom, &format!("made of a mesh: {why}"));
                    }
                    None
                }
            };
        }
        if !SHAPES.contains(&shape) {
            let place = given.place("type");
            self.findings.add(no_type("geoms", shape, place, &SHAPES));
            return None;
        }
        let (pose, half) = self.placed(&given)?;
        let size = match shape {
            "hfield" => self.field(&given)?,
            _ => self.size(&given, shape, half)?,
        };
        let (volume, moments) = homogeneous(shape, size);
        let mass = given_mass.unwrap_or(density * volume);
        let [xx, yy, zz] = moments.map(|moment| moment * mass);
        let inertia = Inertia {
            mass,
            centre: [0.0; 3],
            tensor: [xx, yy, zz, 0.0, 0.0, 0.0],
        };
        Some((inertia, pose))
    }

    fn mass_unknown(&self, geom: Element<'_>, what: &str) {
        let message = format!("the mass of a geom is not known, {what}");
        let help = "give the body an `inertial`, or the geom `mass=\"0\"`";
        self.findings
            .error(Code::NotAllowedHere, tag(geom), message, help);
    }

    /// Where a geom is, and half its length if it is given by its ends.
    fn placed(&self, given: &Given<'_, 'x>) -> Option<(Pose, Option<f64>)> {
        let Some(ends) = given.attribute("fromto") else {
            return Some((self.pose(given), None));
        };
        let [a, b, c, d, e, f] = exactly(self.findings, &ends, "two ends, x y z x y z,")?;
        let (from, to): (Vector, Vector) = ([a, b, c], [d, e, f]);
        let way = minus(to, from);
        let Some(direction) = unit(way) else {
            let help = "give two different ends, or `pos` and `size`";
            let message = "both ends are at one place";
            self.findings
                .error(Code::VanishingLength, ends.range_value(), message, help);
            return None;
        };
        let pose = Pose {
            rotation: Rotation::between([0.0, 0.0, 1.0], direction),
            position: scaled(add(from, to), 0.5),
        };
        Some((pose, Some(0.5 * dot(way, way).sqrt())))
    }

    /// Half lengths of the box that a field of heights counts as, whatever its heights: a quarter of the highest one and
    /// half its base.
    fn field(&self, given: &Given<'_, 'x>) -> Option<Vector> {
        let name = given.word("hfield").unwrap_or_default();
        let fields = children(self.root, "asset").flat_map(|asset| children(asset, "hfield"));
        let known: Vec<(String, Element<'x>)> = fields
            .filter_map(|field| Some((called(field)?, field)))
            .collect();
        let Some((_, field)) = known.iter().find(|(own, _)| own == name) else {
            let known = known.iter().map(|(own, _)| own.as_str());
            let (at, help) = (given.place("hfield"), "name one of the assets");
            self.findings
                .add(no_such("`hfield`", name, at, known, help));
            return None;
        };
        let size = field.attribute_node("size");
        let what = "a size, half lengths, height and base,";
        let [x, y, top, base] = if let Some(given) = size {
            exactly(self.findings, &given, what)?
        } else {
            let (message, help) = (
                "`hfield` has no `size`",
                "write `size=\"x y height base\"`, in m",
            );
            self.findings
                .error(Code::MissingKey, tag(*field), message, help);
            return None;
        };
        Some([x, y, 0.25 * top + 0.5 * base])
    }

    /// Radii and half lengths along the own axes.
    fn size(&self, given: &Given<'_, 'x>, shape: &str, half: Option<f64>) -> Option<Vector> {
        let sizes = match given.attribute("size") {
            Some(_) => given.numbers("size")?,
            None => Vec::new(),
        };
        let needs = match shape {
            "sphere" => 1,
            "capsule" | "cylinder" if half.is_some() => 1,
            "capsule" | "cylinder" => 2,
            _ if half.is_some() => 1,
            _ => 3,
        };
        let whole = sizes.len() >= needs && sizes.iter().take(needs).all(|size| *size > 0.0);
        if !whole {
            let plural = if needs == 1 { "number" } else { "numbers" };
            let message = format!("the size of a {shape} has {needs} positive {plural}");
            let help = "write `size=\"…\"`: radii and half lengths in m";
            self.findings
                .error(Code::WrongType, given.place("size"), message, help);
            return None;
        }
        let at = |index: usize| sizes.get(index).copied().unwrap_or(sizes[0]);
        Some(match shape {
            "sphere" => [at(0); 3],
            "capsule" | "cylinder" => [at(0), at(0), half.unwrap_or_else(|| at(1))],
            _ => match half {
                // Between two ends a geom is as wide as it is deep.
                Some(half) => [at(0), at(0), half],
                None => [at(0), at(1), at(2)],
            },
        })
    }
}

/// Volume, and principal moments over the mass.
fn homogeneous(shape: &str, [a, b, c]: Vector) -> (f64, Vector) {
    match shape {
        "box" | "hfield" => {
            let [x, y, z] = [a * a, b * b, c * c];
            (
                8.0 * a * b * c,
                [(y + z) / 3.0, (x + z) / 3.0, (x + y) / 3.0],
            )
        }
        "cylinder" => {
            let across = (3.0 * a * a + 4.0 * c * c) / 12.0;
            (2.0 * PI * a * a * c, [across, across, a * a / 2.0])
        }
        "capsule" => {
            let (ball, rod) = (4.0 / 3.0 * PI * a * a * a, 2.0 * PI * a * a * c);
            let volume = ball + rod;
            let along = (ball * 0.4 * a * a + rod * 0.5 * a * a) / volume;
            let of_rod = rod * (3.0 * a * a + 4.0 * c * c) / 12.0;
            let of_ball = ball * (0.4 * a * a + c * c + 0.75 * a * c);
            let across = (of_rod + of_ball) / volume;
            (volume, [across, across, along])
        }
        // A sphere is an ellipsoid.
        _ => {
            let [x, y, z] = [a * a, b * b, c * c];
            let moments = [(y + z) / 5.0, (x + z) / 5.0, (x + y) / 5.0];
            (4.0 / 3.0 * PI * a * b * c, moments)
        }
    }
}
