//! The acceleration energy and its derivatives: mass matrix and bias of Appell's equations.

use appell_spec::Code;
use appell_spec::mechanism::{BodyId, FrameId, GROUND, Mechanism, PointId};

use super::algebra::{Algebra, named3};
use super::expressions::Setting;
use super::finding::{Finding, Item, Outcome, unless_any};
use super::frames::FrameVector;
use super::kinematics::Kinematics;
use crate::symbolic::vector::{self, Mat3, Vec3};
use crate::symbolic::{Expr, Graph, Rational, Substitution};

/// Motion of one body, linear in the pseudo-accelerations.
#[derive(Debug, Clone)]
pub struct BodyMotion {
    /// Name of the body.
    pub name: String,
    /// Mass.
    pub mass: Expr,
    /// Motion of the centre of mass.
    pub centre: Translation,
    /// Rotation; `None` for a point mass.
    pub rotation: Option<Rotation>,
}

/// Motion of a centre of mass, in a frame chosen for it.
#[derive(Debug, Clone)]
pub struct Translation {
    /// Name of the point.
    pub point: String,
    /// Velocity.
    pub velocity: FrameVector,
    /// Partial velocities ∂v/∂ω, one per pseudo-velocity.
    pub partial: Vec<Vec3>,
    /// Acceleration at zero pseudo-accelerations.
    pub bias: Vec3,
}

/// Rotation of a rigid body, in the frame of its inertia tensor.
#[derive(Debug, Clone)]
pub struct Rotation {
    /// Angular velocity of the body.
    pub velocity: FrameVector,
    /// Partial angular velocities ∂ω/∂ω, one per pseudo-velocity.
    pub partial: Vec<Vec3>,
    /// Inertia about the centre of mass.
    pub inertia: Mat3,
    /// Angular acceleration at zero pseudo-accelerations.
    pub bias: Vec3,
    /// Rate of the angular momentum at zero pseudo-accelerations: I ω̇ + Ω × I ω.
    pub momentum_rate: Vec3,
}

/// Motions of all bodies for the speeds `directions`.
pub fn body_motions(
    algebra: &mut Algebra,
    setting: Setting<'_>,
    kinematics: &Kinematics,
    directions: &[Expr],
) -> Outcome<Vec<BodyMotion>> {
    let mechanism = setting.mechanism;
    let mut motions = Vec::with_capacity(mechanism.bodies.len());
    let mut findings = Vec::new();
    for (index, body) in mechanism.bodies.entries() {
        let item = Item::Body(index);
        let mass = setting.lower_in(&mut algebra.graph, item, &body.mass)?;
        let velocity = kinematics.velocity(body.centre);
        let point = body.centre;
        let centre = translation(algebra, setting, directions, kinematics, point, velocity);
        let rotation = match (body.frame, &body.inertia) {
            (Some(frame), Some(inertia)) => {
                let matrix = setting.inertia(&mut algebra.graph, index)?;
                if frame != inertia.frame {
                    findings.extend(check_invariance(
                        algebra, mechanism, kinematics, index, &matrix,
                    ));
                }
                let v = kinematics.turning_in(&mut algebra.graph, index, inertia.frame);
                let velocity = FrameVector::new(inertia.frame, algebra.shortest3(v));
                Some(rotation(
                    algebra, setting, directions, kinematics, &body.name, velocity, matrix,
                ))
            }
            _ => None,
        };
        motions.push(BodyMotion {
            name: body.name.clone(),
            mass,
            centre,
            rotation,
        });
    }
    unless_any(findings)?;
    Ok(motions)
}

impl Setting<'_> {
    /// Inertia tensor of a body about its centre of mass, in the frame in which it is given; zero for a point mass.
    pub(super) fn inertia(self, graph: &mut Graph, body: BodyId) -> Outcome<Mat3> {
        let mut tensor = [vector::ZERO; 3];
        if let Some(inertia) = &self.mechanism.bodies[body].inertia {
            for (target, row) in tensor.iter_mut().zip(&inertia.matrix) {
                *target = self.lower_all_in(graph, Item::Body(body), row)?;
            }
        }
        Ok(tensor)
    }
}

/// Motion of a point in the frame of its velocity.
fn translation(
    algebra: &mut Algebra,
    setting: Setting<'_>,
    directions: &[Expr],
    kinematics: &Kinematics,
    point: PointId,
    velocity: FrameVector,
) -> Translation {
    let name = &setting.mechanism.points[point].name;
    let partial = partial_velocities(algebra, velocity.v, directions);
    let w_frame = frame_rate(algebra, setting.mechanism, kinematics, velocity.frame);
    let componentwise = setting.rate3(algebra, velocity.v);
    let named_velocity = named3(algebra, &format!("v_{name}"), velocity.v);
    let turning = algebra.graph.cross(w_frame, named_velocity);
    let bias = algebra.graph.add3(componentwise, turning);
    let mut bias = algebra.shortest3(bias);
    if !algebra.quaternions.is_empty() {
        // Norms of quaternions cancel only in velocities without names.
        let turning = algebra.graph.cross(w_frame, velocity.v);
        let plain = algebra.graph.add3(componentwise, turning);
        let plain = algebra.shortest3(plain);
        if algebra.graph.operations(&plain) <= algebra.graph.operations(&bias) {
            bias = plain;
        }
    }
    Translation {
        point: name.clone(),
        velocity,
        partial,
        bias: named3(algebra, &format!("a0_{name}"), bias),
    }
}

/// The bodies for gravity and reactions: accelerations of centres of mass that are in other frames are
/// expressed in the ground.
pub fn motions_in_ground(
    algebra: &mut Algebra,
    setting: Setting<'_>,
    kinematics: &Kinematics,
    bodies: &[BodyMotion],
) -> Vec<BodyMotion> {
    let (mechanism, symbols) = (setting.mechanism, setting.symbols);
    let mut motions = bodies.to_vec();
    for (motion, body) in motions.iter_mut().zip(&mechanism.bodies) {
        let moving = motion.centre.velocity;
        if moving.frame == GROUND {
            continue;
        }
        let frames = &kinematics.frames;
        let v = frames.express(&mut algebra.graph, moving, GROUND);
        let velocity = FrameVector::new(GROUND, algebra.shortest3(v));
        let (speeds, point) = (&symbols.speeds, body.centre);
        let fixed = translation(algebra, setting, speeds, kinematics, point, velocity);
        let mut acceleration = |centre: &Translation| {
            let graph = &mut algebra.graph;
            let v = along(graph, centre.bias, &centre.partial, &symbols.accelerations);
            let a = FrameVector::new(centre.velocity.frame, v);
            let a = frames.express(graph, a, GROUND);
            graph.operations(&a)
        };
        if acceleration(&fixed) <= acceleration(&motion.centre) {
            motion.centre = fixed;
        }
    }
    motions
}

fn rotation(
    algebra: &mut Algebra,
    setting: Setting<'_>,
    directions: &[Expr],
    kinematics: &Kinematics,
    body: &str,
    velocity: FrameVector,
    inertia: Mat3,
) -> Rotation {
    let partial = partial_velocities(algebra, velocity.v, directions);
    let w_frame = frame_rate(algebra, setting.mechanism, kinematics, velocity.frame);
    let componentwise = setting.rate3(algebra, velocity.v);
    let componentwise = algebra.shortest3(componentwise);
    // The inertia tensor is constant in its frame, so ḣ = I ω̇ + Ω × h.
    let momentum = algebra.graph.mat_vec(&inertia, velocity.v);
    let growth = algebra.graph.mat_vec(&inertia, componentwise);
    let turning = algebra.graph.cross(w_frame, momentum);
    let rate = algebra.graph.add3(growth, turning);
    let rate = algebra.shortest3(rate);
    let momentum_rate = named3(algebra, &format!("h0_{body}"), rate);
    let turning = algebra.graph.cross(w_frame, velocity.v);
    let bias = algebra.graph.add3(componentwise, turning);
    let bias = algebra.shortest3(bias);
    Rotation {
        velocity,
        partial,
        inertia,
        bias,
        momentum_rate,
    }
}

/// Angular velocity of a frame with named components.
pub(super) fn frame_rate(
    algebra: &mut Algebra,
    mechanism: &Mechanism,
    kinematics: &Kinematics,
    frame: FrameId,
) -> Vec3 {
    let w = kinematics.frames.angular_velocity(frame).v;
    named3(algebra, &format!("w_{}", mechanism.frames[frame].name), w)
}

/// The named parts of the bodies' motions, each with its definition expanded down to the rates of the frames.
pub fn named_parts(graph: &mut Graph, bodies: &[BodyMotion]) -> Vec<(Expr, Expr)> {
    let velocities = bodies.iter().flat_map(|body| body.centre.velocity.v);
    let mut parts: Vec<(Expr, Expr)> = velocities
        .filter_map(|v| Some((graph.name_of(v)?, v)))
        .collect();
    let mut written_out = Substitution::of_parts(graph, &parts);
    for body in bodies {
        let rotation = body
            .rotation
            .iter()
            .flat_map(|rotation| rotation.momentum_rate);
        for part in body.centre.bias.into_iter().chain(rotation) {
            if let Some(value) = graph.named_value(part) {
                // If the expansion fails, the names stay: the value is the same.
                let value = written_out.apply(graph, value).unwrap_or(value);
                parts.push((part, value));
            }
        }
    }
    parts
}

/// Partial velocities: coefficients of the directions in a velocity.
pub fn partial_velocities(algebra: &mut Algebra, v: Vec3, directions: &[Expr]) -> Vec<Vec3> {
    directions
        .iter()
        .map(|&direction| {
            let partial = v.map(|component| algebra.derivative(component, direction));
            algebra.shortest3(partial)
        })
        .collect()
}

/// A tensor given in a frame other than the body's must be invariant under the rotation between.
fn check_invariance(
    algebra: &mut Algebra,
    mechanism: &Mechanism,
    kinematics: &Kinematics,
    body: BodyId,
    inertia: &Mat3,
) -> Option<Finding> {
    let item = &mechanism.bodies[body];
    let (body_frame, written) = (item.frame?, item.inertia.as_ref()?.frame);
    // I is invariant if R I = I R; the columns of R are the body's axes.
    let mut axes = [vector::ZERO; 3];
    for (axis, unit) in axes.iter_mut().zip(vector::IDENTITY) {
        let unit = FrameVector::new(body_frame, unit);
        *axis = kinematics.frames.express(&mut algebra.graph, unit, written);
    }
    let r = vector::transpose(&axes);
    let (left, right) = (
        algebra.graph.mat_mat(&r, inertia),
        algebra.graph.mat_mat(inertia, &r),
    );
    let differs = left
        .iter()
        .flatten()
        .zip(right.iter().flatten())
        .any(|(&a, &b)| a != b && !algebra.test.are_equal(&algebra.graph, a, b));
    differs.then(|| Finding {
        code: Code::InertiaNotInvariant,
        message: format!(
            "the inertia of `{}` is given in `{}`, but the body rotates relative to that frame and the \
             tensor changes with the rotation",
            item.name, mechanism.frames[written].name
        ),
        item: Item::Body(body),
        help: format!(
            "give the inertia in `{}`",
            mechanism.frames[body_frame].name
        ),
    })
}

/// The coefficients of Appell's equations `M ω̇ + b = Π`: `M` and `b` are those of ∂S/∂ω̇.
#[derive(Debug, Clone)]
pub struct GibbsForm {
    /// M, row by row.
    pub mass_matrix: Vec<Vec<Expr>>,
    /// b.
    pub bias: Vec<Expr>,
}

/// `M ω̇ + b − Π` of one equation, with a row of M.
pub(super) fn demand(
    graph: &mut Graph,
    mass: &[Expr],
    accelerations: &[Expr],
    bias: Expr,
    force: Expr,
) -> Expr {
    let inertial = mass.iter().zip(accelerations);
    let mut terms: Vec<Expr> = inertial.map(|(&m, &w_dot)| graph.mul(m, w_dot)).collect();
    terms.extend([bias, graph.neg(force)]);
    graph.sum(&terms)
}

impl GibbsForm {
    /// Expands the named `parts` in the bias if terms cancel, in all entries; names are restored where they are
    /// shorter.
    pub fn write_out_what_cancels(&mut self, algebra: &mut Algebra, parts: &[(Expr, Expr)]) {
        let written_out = |&named| algebra.written_out(named, parts).unwrap_or(named);
        let mut bias: Vec<Expr> = self.bias.iter().map(written_out).collect();
        for (i, &named) in self.bias.iter().enumerate() {
            let before = algebra.graph.operations(&bias);
            let plain = std::mem::replace(&mut bias[i], named);
            if algebra.graph.operations(&bias) > before {
                bias[i] = plain;
            }
        }
        if algebra.graph.operations(&bias) < algebra.graph.operations(&self.bias) {
            self.bias = bias;
        }
    }
}

/// ∂S/∂ω̇ by body: `Σ m v_i · a + w_i · ḣ` with the partial velocities `v_i` and `w_i`.
pub fn gibbs_form(algebra: &mut Algebra, bodies: &[BodyMotion], speeds: usize) -> GibbsForm {
    let mut mass_matrix = vec![vec![Graph::ZERO; speeds]; speeds];
    let mut bias = Vec::with_capacity(speeds);
    for i in 0..speeds {
        for j in 0..=i {
            let mut parts = Vec::new();
            for body in bodies {
                let product = algebra
                    .graph
                    .dot(body.centre.partial[i], body.centre.partial[j]);
                parts.push(algebra.graph.mul(body.mass, product));
                if let Some(rotation) = &body.rotation {
                    let momentum = algebra
                        .graph
                        .mat_vec(&rotation.inertia, rotation.partial[j]);
                    parts.push(algebra.graph.dot(rotation.partial[i], momentum));
                }
            }
            let entry = algebra.graph.sum(&parts);
            let entry = algebra.shortest(entry);
            mass_matrix[i][j] = entry;
            mass_matrix[j][i] = entry;
        }
        let mut parts = Vec::new();
        for body in bodies {
            let inertial = algebra.graph.dot(body.centre.partial[i], body.centre.bias);
            parts.push(algebra.graph.mul(body.mass, inertial));
            if let Some(rotation) = &body.rotation {
                parts.push(
                    algebra
                        .graph
                        .dot(rotation.partial[i], rotation.momentum_rate),
                );
            }
        }
        let entry = algebra.graph.sum(&parts);
        bias.push(algebra.shortest(entry));
    }
    GibbsForm { mass_matrix, bias }
}

/// The acceleration energy of a body without the terms free of accelerations:
/// `S = ½ m a·a + ½ α·I α + α·(ω × I ω)`, for given pseudo-accelerations.
pub fn acceleration_energy(
    algebra: &mut Algebra,
    body: &BodyMotion,
    accelerations: &[Expr],
) -> Expr {
    let terms = acceleration_energies(algebra, body, accelerations);
    algebra.graph.sum(&terms)
}

/// The three terms of the acceleration energy, named.
pub fn acceleration_energies(
    algebra: &mut Algebra,
    body: &BodyMotion,
    accelerations: &[Expr],
) -> [Expr; 3] {
    let ActualMotion { a, alpha, .. } = ActualMotion::new(algebra, body, accelerations);
    let graph = &mut algebra.graph;
    let half = Rational::new(1, 2);
    let square = graph.dot(a, a);
    let moving = graph.product(&[body.mass, square]);
    let moving = graph.scale(&half, moving);
    let Some(rotation) = &body.rotation else {
        let moving = graph.name(&format!("s_{}", body.name), moving);
        return [moving, Graph::ZERO, Graph::ZERO];
    };
    let moment = graph.mat_vec(&rotation.inertia, alpha);
    let square = graph.dot(alpha, moment);
    let turning = graph.scale(&half, square);
    let momentum = graph.mat_vec(&rotation.inertia, rotation.velocity.v);
    let moment = graph.cross(rotation.velocity.v, momentum);
    let gyroscopic = graph.dot(alpha, moment);
    let terms = [
        ("moving", moving),
        ("turning", turning),
        ("gyroscopic", gyroscopic),
    ];
    terms.map(|(how, s)| graph.name(&format!("s_{how}_{}", body.name), s))
}

/// The actual motion, with the solved pseudo-accelerations.
#[derive(Debug, Clone)]
pub struct ActualMotion {
    /// Acceleration of the centre of mass, in the frame of its velocity.
    pub a: Vec3,
    /// Angular acceleration, in the frame of the inertia tensor.
    pub alpha: Vec3,
    /// Rate of the angular momentum about the centre of mass, in the same frame.
    pub momentum_rate: Vec3,
}

impl ActualMotion {
    /// The motion of a body with named components.
    pub fn new(algebra: &mut Algebra, body: &BodyMotion, accelerations: &[Expr]) -> Self {
        let graph = &mut algebra.graph;
        let a = along(graph, body.centre.bias, &body.centre.partial, accelerations);
        let (mut alpha, mut momentum_rate) = (vector::ZERO, vector::ZERO);
        if let Some(rotation) = &body.rotation {
            alpha = along(graph, rotation.bias, &rotation.partial, accelerations);
            let componentwise = along(graph, vector::ZERO, &rotation.partial, accelerations);
            let growth = graph.mat_vec(&rotation.inertia, componentwise);
            momentum_rate = graph.add3(growth, rotation.momentum_rate);
        }
        let name = &body.name;
        Self {
            a: named3(algebra, &format!("a_{}", body.centre.point), a),
            alpha: named3(algebra, &format!("alpha_{name}"), alpha),
            momentum_rate: named3(algebra, &format!("h_{name}"), momentum_rate),
        }
    }
}

/// `bias + Σ partial ω̇`
pub fn along(graph: &mut Graph, bias: Vec3, partial: &[Vec3], accelerations: &[Expr]) -> Vec3 {
    let mut a = bias;
    for (&direction, &acceleration) in partial.iter().zip(accelerations) {
        let part = graph.scale3(acceleration, direction);
        a = graph.add3(a, part);
    }
    a
}

/// Kinetic energy `½ m v·v + ½ ω·I ω` of a body.
pub fn kinetic_energy(algebra: &mut Algebra, body: &BodyMotion) -> Expr {
    kinetic_energy_with(algebra, body, body.centre.velocity.v)
}

/// The kinetic energy for display: named `T_body`, or with another letter than T, and in terms of the named
/// velocity of the centre of mass unless that is longer.
pub fn kinetic_energy_by_velocity(
    algebra: &mut Algebra,
    body: &BodyMotion,
    letter: &str,
) -> (Vec3, Expr) {
    let v = body.centre.velocity.v;
    let velocity = named3(algebra, &format!("v_{}", body.centre.point), v);
    let mut energy = kinetic_energy_with(algebra, body, velocity);
    let written_out = kinetic_energy(algebra, body);
    if algebra.graph.operations(&[written_out]) < algebra.graph.operations(&[energy]) {
        energy = written_out;
    }
    let name = format!("{letter}_{}", body.name);
    (velocity, algebra.graph.name(&name, energy))
}

fn kinetic_energy_with(algebra: &mut Algebra, body: &BodyMotion, v: Vec3) -> Expr {
    let square = algebra.graph.dot(v, v);
    let mut parts = vec![algebra.graph.mul(body.mass, square)];
    if let Some(rotation) = &body.rotation {
        let momentum = algebra
            .graph
            .mat_vec(&rotation.inertia, rotation.velocity.v);
        parts.push(algebra.graph.dot(rotation.velocity.v, momentum));
    }
    let twice = algebra.graph.sum(&parts);
    let half = algebra.graph.scale(&Rational::new(1, 2), twice);
    algebra.shortest(half)
}
