//! Positions differentiated twice along a motion.

use appell_runtime::{Dual, Real};
use appell_spec::mechanism::{Axis, BodyId, ConstraintKind, GROUND};

use super::Setting;
use super::evaluate::Values;

/// A function of time with its first derivative.
pub type Jet<S> = Dual<S, 1>;
/// A function of time with its first and second derivatives.
pub type Jet2<S> = Dual<Dual<S, 1>, 1>;
/// Three components in the ground.
pub type V3<S> = [S; 3];
/// A rotation matrix: components of the frame into those of the ground.
pub type M3<S> = [[S; 3]; 3];

/// A motion of a mechanism at one time, vectors in the ground.
#[derive(Debug, Clone)]
pub struct Motion<S: Real> {
    /// Rotations of the frames.
    pub rotations: Vec<M3<S>>,
    /// Positions of the points.
    pub positions: Vec<V3<S>>,
    /// Velocities and accelerations of the points.
    pub velocities: Vec<V3<Jet<S>>>,
    /// Angular velocities and accelerations of the frames.
    pub turning: Vec<V3<Jet<S>>>,
    /// Violation of each scalar constraint and its rate.
    pub rows: Vec<Jet<S>>,
    /// Pseudo-velocities by definition, and their rates.
    pub speeds: Vec<Jet<S>>,
    /// Velocity of the material point of a body at a point, as far as a load asks for it.
    bodies: Vec<(usize, Option<usize>)>,
}

impl<S: Real> Motion<S> {
    /// The motion with coordinates, generalised velocities and accelerations at the time `passed`
    /// after the setting's.
    pub fn new(setting: &Setting<'_>, q: &[S], qd: &[S], qdd: &[S], passed: S) -> Self {
        let mechanism = setting.mechanism;
        let one = S::constant(1.0);
        let path = |value: S, first: S, second: S| Jet2::<S> {
            value: Dual {
                value,
                partials: [first],
            },
            partials: [Dual {
                value: first,
                partials: [second],
            }],
        };
        let zero = S::constant(0.0);
        let coordinates = (0..q.len()).map(|i| path(q[i], qd[i], qdd[i])).collect();
        // The third derivative of a coordinate is never asked for.
        let rates = (0..q.len()).map(|i| path(qd[i], qdd[i], zero)).collect();
        let values = Values::new(setting, coordinates, rates, path(passed, one, zero));

        let mut rotations: Vec<M3<Jet2<S>>> = Vec::new();
        for frame in &mechanism.frames {
            let mut r = frame
                .parent
                .map_or_else(identity, |parent| rotations[parent]);
            for turn in &frame.turns {
                let angle = values.of(&turn.angle);
                r = product(
                    &r,
                    &elementary(turn.axis, if turn.negative { -angle } else { angle }),
                );
            }
            rotations.push(r);
        }
        let mut positions: Vec<V3<Jet2<S>>> = Vec::new();
        for point in &mechanism.points {
            let offset = apply(&rotations[point.frame], values.of3(&point.at));
            positions.push(
                point
                    .from
                    .map_or(offset, |from| add(positions[from], offset)),
            );
        }
        let bodies: Vec<_> = mechanism
            .bodies
            .iter()
            .map(|b| (b.centre, b.frame))
            .collect();
        let mut motion = Self {
            velocities: positions.iter().map(|p| p.map(|c| c.partials[0])).collect(),
            turning: rotations.iter().map(angular_velocity).collect(),
            positions: positions.iter().map(|p| p.map(|c| c.value.value)).collect(),
            rotations: rotations
                .iter()
                .map(|r| r.map(|row| row.map(|c| c.value.value)))
                .collect(),
            rows: Vec::new(),
            speeds: Vec::new(),
            bodies,
        };
        let first = |value: Jet2<S>| value.value;
        let place = |point: usize| positions[point].map(|c| c.value);
        for constraint in &mechanism.constraints {
            match &constraint.kind {
                ConstraintKind::Rolling { body, contact } => {
                    motion.rows.extend(motion.material(*body, *contact, place));
                }
                ConstraintKind::Velocity { zero, equals, .. } => {
                    motion.rows.push(first(values.of(zero) - values.of(equals)));
                }
                ConstraintKind::FixedVelocity {
                    point,
                    body,
                    frame,
                    direction,
                    equals,
                } => {
                    let along = apply(&rotations[*frame], values.of3(direction)).map(first);
                    let v = match body {
                        Some(body) => motion.material(*body, *point, place),
                        None => motion.velocities[*point],
                    };
                    motion.rows.push(dot(along, v) - first(values.of(equals)));
                }
                ConstraintKind::Position { .. } => panic!("reserved"),
            }
        }
        let definitions = mechanism.pseudo_velocities.iter();
        motion.speeds = definitions
            .map(|w| first(values.of(&w.definition)))
            .collect();
        motion
    }

    /// Velocity of the material point of a body that is at a point now.
    fn material(
        &self,
        body: BodyId,
        point: usize,
        place: impl Fn(usize) -> V3<Jet<S>>,
    ) -> V3<Jet<S>> {
        let (centre, frame) = self.bodies[body];
        let Some(frame) = frame else {
            return self.velocities[centre];
        };
        let arm = subtract(place(point), place(centre));
        add(self.velocities[centre], cross(self.turning[frame], arm))
    }

    /// Velocity of the material point of a body, or of the point itself.
    pub fn velocity(&self, body: Option<BodyId>, point: usize) -> V3<S> {
        match body {
            Some(body) => {
                let place = |point: usize| self.positions[point].map(Dual::fixed);
                self.material(body, point, place).map(|c| c.value)
            }
            None => self.velocities[point].map(|c| c.value),
        }
    }

    /// Angular velocity of a body; zero for a point mass.
    pub fn body_turning(&self, body: BodyId) -> V3<Jet<S>> {
        let frame = self.bodies[body].1.unwrap_or(GROUND);
        self.turning[frame]
    }

    /// Velocity and acceleration of a body's centre of mass.
    pub fn centre(&self, body: BodyId) -> V3<Jet<S>> {
        self.velocities[self.bodies[body].0]
    }
}

/// ω from Ṙ Rᵀ, which is the cross-product matrix of ω.
fn angular_velocity<S: Real>(r: &M3<Jet2<S>>) -> V3<Jet<S>> {
    let now = r.map(|row| row.map(|c| c.value));
    let rate = r.map(|row| row.map(|c| c.partials[0]));
    let spin = |i: usize, j: usize| dot(rate[i], now[j]);
    [spin(2, 1), spin(0, 2), spin(1, 0)]
}

fn elementary<T: Real>(axis: Axis, angle: T) -> M3<T> {
    let (sin, cos) = angle.sin_cos();
    let (zero, one) = (T::constant(0.0), T::constant(1.0));
    match axis {
        Axis::X => [[one, zero, zero], [zero, cos, -sin], [zero, sin, cos]],
        Axis::Y => [[cos, zero, sin], [zero, one, zero], [-sin, zero, cos]],
        Axis::Z => [[cos, -sin, zero], [sin, cos, zero], [zero, zero, one]],
    }
}

fn identity<T: Real>() -> M3<T> {
    let (zero, one) = (T::constant(0.0), T::constant(1.0));
    [[one, zero, zero], [zero, one, zero], [zero, zero, one]]
}

fn product<T: Real>(a: &M3<T>, b: &M3<T>) -> M3<T> {
    let column = |j: usize| [b[0][j], b[1][j], b[2][j]];
    std::array::from_fn(|i| std::array::from_fn(|j| dot(a[i], column(j))))
}

/// `A v`
pub fn apply<T: Real>(a: &M3<T>, v: V3<T>) -> V3<T> {
    a.map(|row| dot(row, v))
}

/// `Aᵀ v`
pub fn apply_transposed<T: Real>(a: &M3<T>, v: V3<T>) -> V3<T> {
    std::array::from_fn(|i| dot([a[0][i], a[1][i], a[2][i]], v))
}

/// `a · b`
pub fn dot<T: Real>(a: V3<T>, b: V3<T>) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `a × b`
pub fn cross<T: Real>(a: V3<T>, b: V3<T>) -> V3<T> {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// `a + b`
pub fn add<T: Real>(a: V3<T>, b: V3<T>) -> V3<T> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// `a - b`
pub fn subtract<T: Real>(a: V3<T>, b: V3<T>) -> V3<T> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `s a`
pub fn scale<T: Real>(s: T, a: V3<T>) -> V3<T> {
    a.map(|c| s * c)
}
