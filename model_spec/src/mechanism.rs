//! A checked mechanism, ready for the derivation of its equations.
//!
//! Everything here is in SI units. References between items are ids in the lists of
//! [`Mechanism`]; the checks of this crate guarantee that they are in range, that parents come
//! before children, and that every expression has the dimension its place requires.

use num_traits::Zero;

use crate::expr::{Expr, ExprKind, Quantity, Response, Span};
use crate::units::{Dimension, Unit};

pub use crate::axis::Axis;
pub use crate::ids::{
    BodyId, ConstraintId, CoordinateId, FrameId, InputId, List, LoadId, OutputId, ParameterId,
    PointId, SignalId, SpeedId,
};

/// The inertial frame, named `ground` in a spec.
pub const GROUND: FrameId = FrameId::new(0);
/// The origin of the ground, named `O` in a spec.
pub const ORIGIN: PointId = PointId::new(0);

/// Three components in some frame.
pub type Components = [Expr; 3];

/// A mechanism whose names, references and units have been checked.
#[derive(Debug, Clone)]
pub struct Mechanism {
    /// Name, a valid identifier.
    pub name: String,
    /// One-line title.
    pub title: String,
    /// Where the model comes from.
    pub source: Option<String>,
    /// Largest integration step of the state estimator, in s, for models with fast modes.
    pub longest_step: Option<f64>,
    /// Name of the spec file, for messages and comments in emitted code.
    pub file: String,
    /// Constants of the mechanism.
    pub parameters: List<ParameterId, Parameter>,
    /// Generalised coordinates.
    pub coordinates: List<CoordinateId, Coordinate>,
    /// Inputs that a controller or a recording supplies.
    pub inputs: List<InputId, Input>,
    /// Known functions of time, given as data.
    pub signals: List<SignalId, Signal>,
    /// Frames, parents first; the first is the ground.
    pub frames: List<FrameId, Frame>,
    /// Points, origins first; the first is the origin of the ground.
    pub points: List<PointId, Point>,
    /// Rigid bodies and point masses.
    pub bodies: List<BodyId, Body>,
    /// Constraints on velocities and positions.
    pub constraints: List<ConstraintId, Constraint>,
    /// Pseudo-velocities, the speeds of Appell's equations.
    pub pseudo_velocities: List<SpeedId, PseudoVelocity>,
    /// Applied forces and torques.
    pub loads: List<LoadId, Load>,
    /// Named quantities of interest.
    pub outputs: List<OutputId, Output>,
    /// Named expressions; they are substituted where they are used.
    pub definitions: Vec<Definition>,
}

/// Name, description and unit of a quantity.
#[derive(Debug, Clone)]
pub struct Label {
    /// Identifier in the spec.
    pub name: String,
    /// One-sentence description; empty if the spec gives none.
    pub about: String,
    /// Unit in which people read and write it.
    pub unit: Unit,
    /// Line of the definition in the spec, from 1.
    pub line: usize,
    /// Position of the definition in the spec text; empty for predefined items.
    pub span: Span,
}

/// A constant of the mechanism.
#[derive(Debug, Clone)]
pub struct Parameter {
    /// Name, sentence and unit.
    pub label: Label,
    /// Value in SI.
    pub value: f64,
    /// Smallest admissible value in SI.
    pub at_least: Option<f64>,
    /// Largest admissible value in SI.
    pub at_most: Option<f64>,
    /// Standard deviation to which the value is known, in SI; zero if it is known exactly.
    pub std: Option<f64>,
}

/// A generalised coordinate.
#[derive(Debug, Clone)]
pub struct Coordinate {
    /// Name, sentence and unit.
    pub label: Label,
    /// Declared range in SI, ends included; the equations hold inside it.
    pub range: Option<[f64; 2]>,
    /// Initial value in SI.
    pub initial: f64,
}

/// A named expression.
#[derive(Debug, Clone)]
pub struct Definition {
    /// Name, sentence and unit.
    pub label: Label,
    /// Its value.
    pub value: Expr,
}

/// An input.
#[derive(Debug, Clone)]
pub struct Input {
    /// Name, sentence and unit.
    pub label: Label,
}

/// A known function of time, tabulated.
#[derive(Debug, Clone)]
pub struct Signal {
    /// Name, sentence and unit.
    pub label: Label,
    /// Sampling times in seconds, strictly increasing.
    pub times: Vec<f64>,
    /// Values in SI, one per time.
    pub values: Vec<f64>,
    /// Interpolation between two samples.
    pub interpolation: Interpolation,
}

/// Interpolation of a signal between two samples; outside the table the end values hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interpolation {
    /// Constant until the next sample.
    Hold,
    /// Straight lines.
    Linear,
    /// Natural cubic spline: two continuous derivatives, as an imposed motion needs.
    Cubic,
}

impl Interpolation {
    /// How many of the signal's derivatives equations may contain: an imposed position enters with
    /// its velocity and acceleration, an imposed velocity with its acceleration.
    pub const fn derivatives(self) -> u8 {
        match self {
            Self::Hold => 0,
            Self::Linear => 1,
            Self::Cubic => 2,
        }
    }

    /// Name of a derivative of a signal: `lift_dot`, `lift_ddot`.
    pub fn derivative_name(signal: &str, order: u8) -> String {
        let again = "d".repeat(usize::from(order.saturating_sub(1)));
        format!("{signal}_{again}dot")
    }
}

/// A frame, rotated relative to its parent by a chain of rotations about coordinate axes.
#[derive(Debug, Clone)]
pub struct Frame {
    /// Identifier.
    pub name: String,
    /// One-sentence description.
    pub about: String,
    /// Parent frame; `None` for the ground.
    pub parent: Option<FrameId>,
    /// Rotations, first the one next to the parent.
    pub turns: Vec<Turn>,
    /// Alternatively the coordinates of a unit quaternion, scalar part first. It maps the components of
    /// a vector in this frame to those in the parent.
    pub quaternion: Option<[CoordinateId; 4]>,
    /// Line of the definition, from 1; 0 for the ground.
    pub line: usize,
    /// Position of the definition in the spec text; empty for predefined items.
    pub span: Span,
}

/// One rotation about a coordinate axis.
#[derive(Debug, Clone)]
pub struct Turn {
    /// Axis of rotation.
    pub axis: Axis,
    /// Whether the rotation is about the negative axis.
    pub negative: bool,
    /// Angle, right-handed about the axis; depends on coordinates, parameters, signals, time.
    pub angle: Expr,
}

/// A point, given by its position relative to another point.
#[derive(Debug, Clone)]
pub struct Point {
    /// Identifier.
    pub name: String,
    /// One-sentence description.
    pub about: String,
    /// The reference point; `None` for the origin of the ground.
    pub from: Option<PointId>,
    /// Frame in which `at` is written.
    pub frame: FrameId,
    /// Position from `from`, components in `frame`.
    pub at: Components,
    /// Line of the definition, from 1; 0 for the origin.
    pub line: usize,
    /// Position of the definition in the spec text; empty for predefined items.
    pub span: Span,
}

/// A rigid body or a point mass.
#[derive(Debug, Clone)]
pub struct Body {
    /// Identifier.
    pub name: String,
    /// One-sentence description.
    pub about: String,
    /// Frame fixed in the body; `None` for a point mass.
    pub frame: Option<FrameId>,
    /// Centre of mass.
    pub centre: PointId,
    /// Mass; negated if the body is subtracted (`taken_away`).
    pub mass: Expr,
    /// Inertia about the centre of mass; `None` for a point mass. Negated if the body is
    /// subtracted (`taken_away`).
    pub inertia: Option<Inertia>,
    /// Whether mass and inertia are subtracted: a hole, or a part already included in another body.
    pub taken_away: bool,
    /// Line of the definition, from 1.
    pub line: usize,
    /// Position of the definition in the spec text; empty for predefined items.
    pub span: Span,
}

impl Body {
    /// Whether its position matters: a body without mass whose centre is the origin, such as the rotor of a
    /// drive, has rotational inertia only.
    pub fn has_place(&self) -> bool {
        let massless = matches!(&self.mass.kind, ExprKind::Number(mass) if mass.is_zero());
        !(massless && self.centre == ORIGIN)
    }

    /// Minus one for subtracted bodies.
    pub(crate) fn sign(&self) -> f64 {
        if self.taken_away { -1.0 } else { 1.0 }
    }
}

/// Inertia tensor about a centre of mass.
#[derive(Debug, Clone)]
pub struct Inertia {
    /// Frame in which the components are written. If it is not fixed in the body, the tensor must
    /// be invariant under the rotation between the two; the derivation checks that.
    pub frame: FrameId,
    /// Symmetric matrix, products of inertia with their sign (`I_xy = -∫xy dm`).
    pub matrix: [[Expr; 3]; 3],
    /// Line of the definition, from 1.
    pub line: usize,
    /// Position of the definition in the spec text; empty for predefined items.
    pub span: Span,
}

/// A constraint.
#[derive(Debug, Clone)]
pub struct Constraint {
    /// Identifier.
    pub name: String,
    /// One-sentence description.
    pub about: String,
    /// Its equations.
    pub kind: ConstraintKind,
    /// Line of the definition, from 1.
    pub line: usize,
    /// Position of the definition in the spec text; empty for predefined items.
    pub span: Span,
}

/// The equations of a constraint.
#[derive(Debug, Clone)]
pub enum ConstraintKind {
    /// The material points of `body` and of the surface have the same velocity at `contact`.
    Rolling {
        /// The rolling body.
        body: BodyId,
        /// Contact point.
        contact: PointId,
        /// The body to which the surface belongs; `None` is the ground.
        on: Option<BodyId>,
        /// Normal of the surface, if the spec gives it.
        normal: Option<Normal>,
        /// Coefficient of friction, if the spec gives it.
        friction: Option<Expr>,
        /// Creep coefficients of the contact, if the spec gives them.
        creep: Option<Box<Creep>>,
    },
    /// `zero = equals`, `zero` linear in the generalised velocities, `equals` a function of
    /// coordinates, parameters, signals and time.
    Velocity {
        /// Expression in the generalised velocities.
        zero: Expr,
        /// Prescribed value, of the same dimension.
        equals: Expr,
        /// That dimension.
        dimension: Dimension,
    },
    /// The velocity of `point` along `direction` equals `equals`.
    FixedVelocity {
        /// The point; the material point of `body` there when a body is named.
        point: PointId,
        /// Body whose material point is meant.
        body: Option<BodyId>,
        /// Frame in which `direction` is written.
        frame: FrameId,
        /// Direction, dimensionless.
        direction: Components,
        /// Prescribed velocity.
        equals: Expr,
        /// Whether the constraint is unilateral: its reaction acts only in the sense of `direction`.
        one_sided: bool,
    },
    /// `zero = 0`, an equation between coordinates, parameters, signals and time.
    Position {
        /// Expression in the coordinates.
        zero: Expr,
        /// Its dimension.
        dimension: Dimension,
        /// The dependent coordinate; chosen automatically if the spec names none.
        dependent: Option<CoordinateId>,
        /// Whether the constraint is unilateral: its reaction acts only towards positive `zero`.
        one_sided: bool,
    },
}

/// The normal of a surface: an axis that points from it into the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Normal {
    /// Frame that has the axis; the ground or one that follows the surface.
    pub frame: FrameId,
    /// The axis.
    pub axis: Axis,
    /// Whether the normal points backwards along it.
    pub negative: bool,
}

/// Linear creep: creepage (sliding velocity over rolling velocity) per unit of tangential force over
/// normal force.
#[derive(Debug, Clone)]
pub struct Creep {
    /// In the direction of travel.
    pub longitudinal: Expr,
    /// Across it.
    pub lateral: Expr,
}

impl ConstraintKind {
    /// Its word in a spec, after `kind =`.
    pub const fn word(&self) -> &'static str {
        match self {
            Self::Rolling { .. } => "rolling",
            Self::Velocity { .. } => "velocity",
            Self::FixedVelocity { .. } => "fixed_velocity",
            Self::Position { .. } => "position",
        }
    }

    /// Its number of scalar equations.
    pub const fn rows(&self) -> usize {
        match self {
            Self::Rolling { .. } => 3,
            Self::Velocity { .. } | Self::FixedVelocity { .. } | Self::Position { .. } => 1,
        }
    }

    /// Dimension of its equations at velocity level: a multiplier is a power divided by it. `None`
    /// where it overflows.
    pub fn rate_dimension(&self) -> Option<Dimension> {
        match self {
            Self::Rolling { .. } | Self::FixedVelocity { .. } => Some(Dimension::VELOCITY),
            Self::Velocity { dimension, .. } => Some(*dimension),
            Self::Position { dimension, .. } => dimension.rate().ok(),
        }
    }
}

/// A pseudo-velocity: a linear combination of generalised velocities.
#[derive(Debug, Clone)]
pub struct PseudoVelocity {
    /// Name, sentence and unit.
    pub label: Label,
    /// Definition, linear in `dot(q)`.
    pub definition: Expr,
    /// Its prescribed rate, if any; an actuator then supplies the required generalised force.
    pub rate: Option<Expr>,
    /// Initial value in SI.
    pub initial: f64,
}

/// An applied force or torque.
#[derive(Debug, Clone)]
pub struct Load {
    /// Identifier.
    pub name: String,
    /// One-sentence description.
    pub about: String,
    /// Its kind.
    pub kind: LoadKind,
    /// Line of the definition, from 1.
    pub line: usize,
    /// Position of the definition in the spec text; empty for predefined items.
    pub span: Span,
}

/// The kinds of loads.
#[derive(Debug, Clone)]
pub enum LoadKind {
    /// Weight of every body.
    Gravity {
        /// Direction of the weight, a unit vector of the ground.
        down: [i8; 3],
        /// Gravitational acceleration.
        acceleration: Expr,
    },
    /// A force on a point, with the opposite force on another point when one is named.
    Force {
        /// Point of application.
        on: PointId,
        /// Body whose material point at `on` is meant; without it the velocity of the point itself counts.
        body: Option<BodyId>,
        /// Point of application of the reaction.
        reaction_on: Option<PointId>,
        /// Frame in which `vector` is written.
        frame: FrameId,
        /// Components of the force.
        vector: Components,
    },
    /// A torque on a body, with the opposite torque on another body when one is named.
    Torque {
        /// Body.
        on: BodyId,
        /// Body on which the reaction acts.
        reaction_on: Option<BodyId>,
        /// Frame in which `vector` is written.
        frame: FrameId,
        /// Components of the torque.
        vector: Components,
    },
    /// A linear spring, a linear damper, or both in parallel.
    SpringDamper {
        /// The displacement along which it acts.
        between: Connection,
        /// Its spring.
        spring: Option<Spring>,
        /// Damping coefficient.
        damping: Option<Expr>,
    },
    /// A generalised force: its power is `force * velocity`.
    Generalized {
        /// The velocity along which it acts: the rate of a coordinate, or a combination of rates and
        /// pseudo-velocities.
        velocity: Expr,
        /// Generalised force.
        force: Expr,
    },
}

impl Mechanism {
    /// Direction of the weight, a unit vector of the ground; `None` without gravity.
    pub fn down(&self) -> Option<[i8; 3]> {
        self.loads.iter().find_map(|load| match load.kind {
            LoadKind::Gravity { down, .. } => Some(down),
            _ => None,
        })
    }

    /// The pseudo-velocity that is the rate of a coordinate, if one is.
    pub fn speed_of(&self, coordinate: CoordinateId) -> Option<SpeedId> {
        let rate = Quantity::Rate(coordinate);
        let mut speeds = self.pseudo_velocities.entries();
        let found = speeds.find(
            |(_, speed)| matches!(&speed.definition.kind, ExprKind::Quantity(own) if *own == rate),
        );
        found.map(|(id, _)| id)
    }

    /// The loads in dependency order: each after those whose forces it uses. There are no cycles.
    pub fn loads_after_what_they_name(&self) -> Vec<LoadId> {
        let mut waiting: Vec<(LoadId, Vec<LoadId>)> = Vec::new();
        for (index, load) in self.loads.entries() {
            let mut named = Vec::new();
            for expr in load.kind.expressions() {
                expr.visit(&mut |quantity| {
                    if let Quantity::Response(Response::Force(other, _)) = quantity {
                        named.push(other);
                    }
                });
            }
            named.sort_unstable();
            named.dedup();
            waiting.push((index, named));
        }
        let mut done = vec![false; waiting.len()];
        let mut order = Vec::with_capacity(waiting.len());
        loop {
            let before = order.len();
            waiting.retain(|(index, named)| {
                let ready = named.iter().all(|other| done[other.index()]);
                if ready {
                    done[index.index()] = true;
                    order.push(*index);
                }
                !ready
            });
            if order.len() == before {
                return order;
            }
        }
    }
}

impl LoadKind {
    /// The displacement of a spring or damper.
    pub const fn between(&self) -> Option<&Connection> {
        match self {
            Self::SpringDamper { between, .. } => Some(between),
            Self::Gravity { .. }
            | Self::Force { .. }
            | Self::Torque { .. }
            | Self::Generalized { .. } => None,
        }
    }

    /// All its expressions: the velocity of a generalised force, then the [`coefficients`](Self::coefficients).
    pub fn expressions(&self) -> Vec<&Expr> {
        let velocity = match self {
            Self::Generalized { velocity, .. } => Some(velocity),
            _ => None,
        };
        velocity.into_iter().chain(self.coefficients()).collect()
    }

    /// The expressions that determine its size.
    pub fn coefficients(&self) -> Vec<&Expr> {
        match self {
            Self::Gravity { acceleration, .. } => vec![acceleration],
            Self::Force { vector, .. } | Self::Torque { vector, .. } => vector.iter().collect(),
            Self::SpringDamper {
                spring, damping, ..
            } => {
                let spring = spring.iter().flat_map(|own| [&own.stiffness, &own.relaxed]);
                spring.chain(damping).collect()
            }
            Self::Generalized { force, .. } => vec![force],
        }
    }

    /// The points it names: those that a force or the ends of a connection act on.
    pub fn points(&self) -> Vec<PointId> {
        match self {
            Self::Force {
                on, reaction_on, ..
            } => [Some(*on), *reaction_on].into_iter().flatten().collect(),
            Self::SpringDamper {
                between: Connection::Points(a, b),
                ..
            } => vec![*a, *b],
            _ => Vec::new(),
        }
    }
}

/// A linear spring.
#[derive(Debug, Clone)]
pub struct Spring {
    /// Stiffness.
    pub stiffness: Expr,
    /// Displacement at which it is relaxed.
    pub relaxed: Expr,
}

/// The displacement of a spring or damper.
#[derive(Debug, Clone)]
pub enum Connection {
    /// The distance between two points.
    Points(PointId, PointId),
    /// A coordinate, or the sum of angles between two frames.
    Along(Expr),
}

/// A named quantity of interest.
#[derive(Debug, Clone)]
pub struct Output {
    /// Name, sentence and unit.
    pub label: Label,
    /// Value from coordinates, pseudo-velocities, parameters, inputs, signals and time.
    pub value: Expr,
}
