//! Applied loads in the ground frame: as forces with the velocities conjugate to them, and as potentials.

use appell_spec::expr::Expr as Spec;
use appell_spec::mechanism::{Connection, LoadKind, Spring};

use super::inertial::Inertial;
use crate::mechanics::algebra::Algebra;
use crate::mechanics::finding::Outcome;
use crate::symbolic::vector::Vec3;
use crate::symbolic::{Expr, Graph, Rational};

/// A force, torque or generalised force, and the velocity conjugate to it.
#[derive(Clone, Copy)]
pub(super) struct Effort {
    pub(super) force: Vec3,
    pub(super) velocity: Vec3,
    /// Whether it is an external force on the mechanism.
    pub(super) external: bool,
}

/// Loads represented as forces.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Which {
    All,
    /// Only those without a [`potential`].
    WithoutPotential,
}

/// All applied loads.
pub(super) fn efforts(
    algebra: &mut Algebra,
    inertial: &Inertial<'_>,
    which: Which,
) -> Outcome<Vec<Effort>> {
    let mechanism = inertial.setting.mechanism;
    let mut all = Vec::new();
    for load in &mechanism.loads {
        match &load.kind {
            LoadKind::Gravity { down, acceleration } if which == Which::All => {
                let g = inertial.lower(algebra, acceleration)?;
                for (index, body) in mechanism.bodies.entries() {
                    let mass = inertial.mass(algebra, index)?;
                    let weight = algebra.graph.mul(mass, g);
                    let down = down.map(|c| algebra.graph.integer(c.into()));
                    all.push(Effort {
                        force: algebra.graph.scale3(weight, down),
                        velocity: inertial.velocity(&mut algebra.graph, None, body.centre),
                        external: true,
                    });
                }
            }
            LoadKind::SpringDamper {
                between,
                spring,
                damping,
            } => {
                let spring = spring.as_ref().filter(|_| which == Which::All);
                let line = Line::new(algebra, inertial, between)?;
                let tension = line.tension(algebra, inertial, spring, damping.as_ref())?;
                all.push(line.under(&mut algebra.graph, tension));
            }
            LoadKind::Gravity { .. } => {}
            LoadKind::Force {
                on,
                body,
                reaction_on,
                ..
            } => {
                let mut velocity = inertial.velocity(&mut algebra.graph, *body, *on);
                if let Some(other) = reaction_on {
                    let other = inertial.velocity(&mut algebra.graph, None, *other);
                    velocity = algebra.graph.sub3(velocity, other);
                }
                all.push(Effort {
                    force: acting(algebra, inertial, &load.kind)?,
                    velocity,
                    external: reaction_on.is_none(),
                });
            }
            LoadKind::Torque {
                on, reaction_on, ..
            } => {
                let mut velocity = inertial.turning(*on);
                if let Some(other) = reaction_on {
                    velocity = algebra.graph.sub3(velocity, inertial.turning(*other));
                }
                all.push(Effort {
                    force: acting(algebra, inertial, &load.kind)?,
                    velocity,
                    external: false,
                });
            }
            LoadKind::Generalized { velocity, .. } => {
                let velocity = inertial.velocity_along(algebra, velocity)?;
                all.push(Effort {
                    force: acting(algebra, inertial, &load.kind)?,
                    velocity: [velocity, Graph::ZERO, Graph::ZERO],
                    external: false,
                });
            }
        }
    }
    algebra.check_size()?;
    Ok(all)
}

/// The force of a load as named in expressions: in the ground frame, or as first component if it is a scalar.
pub(super) fn acting(
    algebra: &mut Algebra,
    inertial: &Inertial<'_>,
    load: &LoadKind,
) -> Outcome<Vec3> {
    let force = match load {
        // Cannot be named in expressions.
        LoadKind::Gravity { .. } => Graph::ZERO,
        LoadKind::Force { frame, vector, .. } | LoadKind::Torque { frame, vector, .. } => {
            return inertial.in_ground(algebra, *frame, vector);
        }
        LoadKind::SpringDamper {
            between,
            spring,
            damping,
        } => {
            let line = Line::new(algebra, inertial, between)?;
            line.tension(algebra, inertial, spring.as_ref(), damping.as_ref())?
        }
        LoadKind::Generalized { force, .. } => inertial.lower(algebra, force)?,
    };
    Ok([force, Graph::ZERO, Graph::ZERO])
}

/// The line of action of a spring or damper.
struct Line {
    length: Expr,
    /// Unit vector along which the length grows, and the relative velocity of the ends.
    direction: Vec3,
    velocity: Vec3,
}

impl Line {
    fn new(algebra: &mut Algebra, inertial: &Inertial<'_>, between: &Connection) -> Outcome<Self> {
        Ok(match between {
            Connection::Along(displacement) => {
                let length = inertial.lower(algebra, displacement)?;
                let velocity = inertial.setting.rate(algebra, length);
                Self {
                    length,
                    direction: [Graph::ONE, Graph::ZERO, Graph::ZERO],
                    velocity: [velocity, Graph::ZERO, Graph::ZERO],
                }
            }
            &Connection::Points(a, b) => {
                let graph = &mut algebra.graph;
                let arm = graph.sub3(inertial.position(b), inertial.position(a));
                let square = graph.dot(arm, arm);
                let length = graph.sqrt(square);
                let inverse = graph.pow(length, -1);
                let v_a = inertial.velocity(graph, None, a);
                let v_b = inertial.velocity(graph, None, b);
                Self {
                    length,
                    direction: graph.scale3(inverse, arm),
                    velocity: graph.sub3(v_b, v_a),
                }
            }
        })
    }

    /// `k (length − relaxed) + c d(length)/dt`
    fn tension(
        &self,
        algebra: &mut Algebra,
        inertial: &Inertial<'_>,
        spring: Option<&Spring>,
        damping: Option<&Spec>,
    ) -> Outcome<Expr> {
        let mut tension = Vec::new();
        if let Some(Spring { stiffness, relaxed }) = spring {
            let k = inertial.lower(algebra, stiffness)?;
            let relaxed = inertial.lower(algebra, relaxed)?;
            let extension = algebra.graph.sub(self.length, relaxed);
            tension.push(algebra.graph.mul(k, extension));
        }
        if let Some(damping) = damping {
            let c = inertial.lower(algebra, damping)?;
            let rate = algebra.graph.dot(self.direction, self.velocity);
            tension.push(algebra.graph.mul(c, rate));
        }
        Ok(algebra.graph.sum(&tension))
    }

    /// A tension opposes the growth of the length.
    fn under(self, graph: &mut Graph, tension: Expr) -> Effort {
        let pull = graph.neg(tension);
        Effort {
            force: graph.scale3(pull, self.direction),
            velocity: self.velocity,
            external: false,
        }
    }
}

/// Virtual power per unit of the velocity `direction`, in which all velocities are linear.
pub(super) fn generalized_force(
    algebra: &mut Algebra,
    efforts: &[Effort],
    direction: Expr,
) -> Expr {
    let mut parts = Vec::with_capacity(efforts.len());
    for effort in efforts {
        let partial = effort.velocity.map(|c| algebra.derivative(c, direction));
        parts.push(algebra.graph.dot(effort.force, partial));
    }
    algebra.graph.sum(&parts)
}

/// Potential energy of gravity and springs.
pub(super) fn potential(algebra: &mut Algebra, inertial: &Inertial<'_>) -> Outcome<Expr> {
    let mechanism = inertial.setting.mechanism;
    let mut parts = Vec::new();
    for load in &mechanism.loads {
        match &load.kind {
            LoadKind::Gravity { down, acceleration } => {
                let g = inertial.lower(algebra, acceleration)?;
                for (index, body) in mechanism.bodies.entries() {
                    let mass = inertial.mass(algebra, index)?;
                    let down = down.map(|c| algebra.graph.integer(c.into()));
                    let fallen = algebra.graph.dot(down, inertial.position(body.centre));
                    let energy = algebra.graph.product(&[mass, g, fallen]);
                    parts.push(algebra.graph.neg(energy));
                }
            }
            LoadKind::SpringDamper {
                between,
                spring: Some(Spring { stiffness, relaxed }),
                ..
            } => {
                let k = inertial.lower(algebra, stiffness)?;
                let relaxed = inertial.lower(algebra, relaxed)?;
                let line = Line::new(algebra, inertial, between)?;
                let extension = algebra.graph.sub(line.length, relaxed);
                let square = algebra.graph.square(extension);
                let twice = algebra.graph.mul(k, square);
                parts.push(algebra.graph.scale(&Rational::new(1, 2), twice));
            }
            LoadKind::Force { .. }
            | LoadKind::Torque { .. }
            | LoadKind::SpringDamper { .. }
            | LoadKind::Generalized { .. } => {}
        }
    }
    Ok(algebra.graph.sum(&parts))
}
