//! Rolling contacts with inconsistent geometry.
//!
//! A contact point moves along the ground; the material point that coincides with it is instantaneously at
//! rest. So the normal components of both velocities vanish by geometry, and the tangential ones differ.

use appell_spec::Code;
use appell_spec::mechanism::{BodyId, ConstraintKind, GROUND, Normal, PointId};

use super::bench::shown;
use crate::mechanics::algebra::Algebra;
use crate::mechanics::expressions::Setting;
use crate::mechanics::finding::{Finding, Item, listed};
use crate::mechanics::initial::InitialState;
use crate::mechanics::kinematics::{Effort, Kinematics};
use crate::mechanics::rank::{LinearRow, Standing, standings};
use crate::symbolic::vector;
use crate::symbolic::{Expr, Graph};

/// At most one finding per rolling contact.
pub(super) fn findings(algebra: &mut Algebra, setting: Setting<'_>) -> Vec<Finding> {
    let Ok(kinematics) = Kinematics::new(algebra, setting, &[], Effort::Plain) else {
        return Vec::new();
    };
    let mut geometry = Geometry {
        algebra,
        setting,
        kinematics,
    };
    let constraints = setting.mechanism.constraints.entries();
    constraints
        .filter_map(|(index, constraint)| {
            let ConstraintKind::Rolling {
                body,
                contact,
                on: None,
                normal,
                ..
            } = constraint.kind
            else {
                return None;
            };
            let (message, help) = geometry
                .contradiction(body, contact)
                .or_else(|| geometry.wrong_normal(body, contact, normal?))?;
            Some(Finding {
                code: Code::ContactGeometry,
                message,
                item: Item::Constraint(index),
                help,
            })
        })
        .collect()
}

struct Geometry<'a> {
    algebra: &'a mut Algebra,
    setting: Setting<'a>,
    kinematics: Kinematics,
}

impl Geometry<'_> {
    /// The inconsistency of a contact, and the fix.
    fn contradiction(&mut self, body: BodyId, contact: PointId) -> Option<(String, String)> {
        let mechanism = self.setting.mechanism;
        let (body_name, point) = (
            &mechanism.bodies[body].name,
            &mechanism.points[contact].name,
        );
        if self.is_centre(body, contact) {
            return Some((
                format!(
                    "the contact of `{body_name}` is its centre `{point}`: that keeps the centre at \
                     rest whatever the rotation"
                ),
                format!(
                    "place a point where `{body_name}` touches the ground, one radius from its \
                     centre, and name it as `contact`"
                ),
            ));
        }
        if self.is_pinned(body, contact) {
            return Some((
                format!(
                    "`{point}` is fixed in `{body_name}`: the constraint is a pivot on the \
                     ground, and nothing rolls"
                ),
                format!(
                    "place `{point}` in a frame that does not spin with `{body_name}`, and give \
                     the body's frame an angle of rotation of its own"
                ),
            ));
        }
        let material = self.material_velocity(body, contact);
        let centre = mechanism.bodies[body].centre;
        let is_bound = !self.velocities_of_positions().is_empty();
        let graph = &mut self.algebra.graph;
        // Position constraints rotate the plane of the velocities: the arm is tested without them.
        let arm = if is_bound {
            vector::ZERO
        } else {
            self.kinematics.between(graph, contact, centre, GROUND)
        };
        let standings = self.after_positions(&material, &arm);
        let count = |wanted| standings.iter().filter(|&s| *s == wanted).count();
        let removed = count(Standing::Independent);
        if removed == 3 && !self.stays_level(contact) {
            return Some(self.leaves_the_ground(contact));
        }
        // If two velocities lie in the plane of the arm, that plane is not tangent to the body.
        if removed == 3 || removed == 2 && !is_bound && count(Standing::Inconsistent) == 0 {
            return Some(self.is_not_tangent(body, contact));
        }
        self.is_overhead(body, contact).then(|| {
            (
                format!(
                    "gravity pulls `{body_name}` away from its contact `{point}`, which lies \
                     above its centre"
                ),
                format!(
                    "reverse the sign of the position of `{point}`, or `down` of the gravity load"
                ),
            )
        })
    }

    /// The inconsistency of a surface normal, and the fix.
    fn wrong_normal(
        &mut self,
        body: BodyId,
        contact: PointId,
        normal: Normal,
    ) -> Option<(String, String)> {
        let (k, frame) = (normal.axis.index(), normal.frame);
        let graph = &mut self.algebra.graph;
        let mechanism = self.setting.mechanism;
        let v = (self.kinematics).material_velocity(graph, Some(body), contact, frame);
        let point = &mechanism.points[contact].name;
        if self.independent_of_positions(&[v[k]]) > 0 {
            let graph = &mut self.algebra.graph;
            let of_point = self.kinematics.velocity_in(graph, contact, frame);
            if self.independent_of_positions(&[of_point[k]]) == 0 {
                return Some(self.is_not_tangent(body, contact));
            }
            return Some((
                format!(
                    "the coordinates allow the contact `{point}` to move along the normal of its surface"
                ),
                "name the axis normal to the surface, in a frame that follows the surface"
                    .to_owned(),
            ));
        }
        let centre = mechanism.bodies[body].centre;
        let graph = &mut self.algebra.graph;
        let arm = self.kinematics.between(graph, contact, centre, frame);
        let state = InitialState::new(graph, mechanism, self.setting.symbols);
        let height = state.of(graph, &[arm[k]])[0];
        let height = if normal.negative { -height } else { height };
        (height < 0.0).then(|| {
            (
                format!(
                    "the normal at `{point}` points away from `{}`: the contact could only pull",
                    mechanism.bodies[body].name
                ),
                "reverse the sign of `normal`: it points from the surface into the body".to_owned(),
            )
        })
    }

    fn is_centre(&mut self, body: BodyId, contact: PointId) -> bool {
        let centre = self.setting.mechanism.bodies[body].centre;
        let graph = &mut self.algebra.graph;
        let arm = self.kinematics.between(graph, centre, contact, GROUND);
        self.vanishes(&arm)
    }

    /// Whether the contact point is body-fixed in every motion.
    fn is_pinned(&mut self, body: BodyId, contact: PointId) -> bool {
        let material = self.material_velocity(body, contact);
        let graph = &mut self.algebra.graph;
        let point = self.kinematics.velocity_in(graph, contact, GROUND);
        let passing = graph.sub3(material, point);
        self.vanishes(&passing)
    }

    /// Whether a point has constant height under the position constraints.
    fn stays_level(&mut self, point: PointId) -> bool {
        let Some(down) = self.setting.mechanism.down() else {
            return false;
        };
        let graph = &mut self.algebra.graph;
        let v = self.kinematics.velocity_in(graph, point, GROUND);
        let down = down.map(|c| graph.integer(c.into()));
        let falls = graph.dot(down, v);
        self.independent_of_positions(&[falls]) == 0
    }

    fn is_not_tangent(&self, body: BodyId, contact: PointId) -> (String, String) {
        let mechanism = self.setting.mechanism;
        let body = &mechanism.bodies[body];
        let point = &mechanism.points[contact].name;
        let (name, centre) = (&body.name, &mechanism.points[body.centre].name);
        (
            format!(
                "`{name}` does not touch the ground at `{point}`: as it turns, its material there \
                 moves towards the ground or away from it, so its surface is not tangent to the \
                 ground, and the constraint removes a velocity too many"
            ),
            format!(
                "check the position of `{point}` relative to the centre `{centre}`, its signs too: the \
                 normal of the surface at `{point}` is that of the ground; a round wheel touches \
                 straight below its centre"
            ),
        )
    }

    /// The number of velocities that are independent under the position constraints.
    fn independent_of_positions(&mut self, wanted: &[Expr]) -> usize {
        let standings = self.after_positions(wanted, &vec![Graph::ZERO; wanted.len()]);
        let open = standings.iter();
        open.filter(|standing| **standing == Standing::Independent)
            .count()
    }

    /// Rank relations of velocities, each with a rest, to earlier ones and to the position constraints.
    fn after_positions(&mut self, wanted: &[Expr], rests: &[Expr]) -> Vec<Standing> {
        let of_positions = self.velocities_of_positions();
        let positions = of_positions.len();
        let velocities = of_positions.into_iter().map(|v| (v, Graph::ZERO));
        let wanted = wanted.iter().copied().zip(rests.iter().copied());
        let rates = self.setting.rates;
        let rows: Vec<LinearRow> = velocities
            .chain(wanted)
            .map(|(velocity, rest)| {
                let coefficients = rates.iter().map(|&rate| {
                    let coefficient = self.algebra.derivative(velocity, rate);
                    let vanishes = self.algebra.vanishes(coefficient);
                    if vanishes { Graph::ZERO } else { coefficient }
                });
                LinearRow {
                    coefficients: coefficients.collect(),
                    rest,
                }
            })
            .collect();
        standings(self.algebra, &rows).split_off(positions)
    }

    /// Time derivatives of the position constraints.
    fn velocities_of_positions(&mut self) -> Vec<Expr> {
        let mut velocities = Vec::new();
        for constraint in &self.setting.mechanism.constraints {
            if let ConstraintKind::Position { zero, .. } = &constraint.kind
                && let Ok(zero) = self.setting.lower(&mut self.algebra.graph, zero)
            {
                velocities.push(self.setting.rate(self.algebra, zero));
            }
        }
        velocities
    }

    fn leaves_the_ground(&mut self, contact: PointId) -> (String, String) {
        let point = &self.setting.mechanism.points[contact].name;
        let across = match self.height(contact) {
            Some((height, coordinates)) if !coordinates.is_empty() => {
                let height = shown(&self.algebra.graph, height);
                let names = listed(coordinates.iter().map(String::as_str));
                format!("its height `{height}` depends on {names}")
            }
            _ => "it can move in all directions".to_owned(),
        };
        (
            format!(
                "the coordinates do not keep the contact `{point}` on the ground: {across}, and the \
                 constraint then removes a third velocity"
            ),
            format!(
                "place the body at the height at which `{point}` stays on the ground, such as \
                 `R*cos(lean)` for a leaning wheel, or keep it there with a constraint of kind \
                 `position`"
            ),
        )
    }

    /// Height of a point, opposite to gravity, and the coordinates that change it.
    fn height(&mut self, point: PointId) -> Option<(Expr, Vec<String>)> {
        let mechanism = self.setting.mechanism;
        let down = mechanism.down()?;
        let graph = &mut self.algebra.graph;
        let position = self.kinematics.position(graph, point);
        let down = down.map(|c| graph.integer((-c).into()));
        let height = graph.dot(down, position);
        let height = self.algebra.shortest(height);
        let graph = &self.algebra.graph;
        let coordinates = mechanism.coordinates.iter();
        let changing = coordinates.zip(&self.setting.symbols.coordinates);
        let changing = changing.filter(|&(_, &symbol)| {
            let symbol = graph.as_symbol(symbol);
            symbol.is_some_and(|symbol| graph.mentions(height, &[symbol]))
        });
        let changing = changing.map(|(q, _)| q.label.name.clone()).collect();
        Some((height, changing))
    }

    /// Whether the contact lies above the centre of the body at the initial state.
    fn is_overhead(&mut self, body: BodyId, contact: PointId) -> bool {
        let Some(down) = self.setting.mechanism.down() else {
            return false;
        };
        let mechanism = self.setting.mechanism;
        let centre = mechanism.bodies[body].centre;
        let graph = &mut self.algebra.graph;
        let arm = self.kinematics.between(graph, centre, contact, GROUND);
        let down = down.map(|c| graph.integer(c.into()));
        let depth = graph.dot(down, arm);
        let state = InitialState::new(graph, mechanism, self.setting.symbols);
        state.of(graph, &[depth])[0] < 0.0
    }

    fn material_velocity(&mut self, body: BodyId, contact: PointId) -> [Expr; 3] {
        let graph = &mut self.algebra.graph;
        self.kinematics
            .material_velocity(graph, Some(body), contact, GROUND)
    }

    fn vanishes(&mut self, v: &[Expr; 3]) -> bool {
        let Algebra { graph, test, .. } = &mut *self.algebra;
        v.iter().all(|&component| test.is_zero(graph, component))
    }
}
