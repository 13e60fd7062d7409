//! Lagrange's equations with multipliers: `d/dt ∂T/∂q̇ - ∂T/∂q + ∂V/∂q = Q + Cᵀ λ`, `C q̈ = -ċ`.

use appell_runtime::{Dual, Real};
use appell_spec::mechanism::ConstraintKind;
use nalgebra::{DMatrix, DVector};

use super::Setting;
use super::evaluate::Values;
use super::kane::{Velocities, coordinate_rates, loads_without_potential, motion};
use super::loads::{potential, power};
use super::motion::{Motion, apply, apply_transposed, dot};

/// Two nested directions.
type Second = Dual<Dual<f64, 1>, 1>;

/// Solution of Lagrange's equations.
#[derive(Debug, Clone)]
pub struct Lagrange {
    /// Generalised accelerations.
    pub coordinate_accelerations: Vec<f64>,
    /// Pseudo-accelerations that belong to them.
    pub accelerations: Vec<f64>,
    /// Reactions by the name of their place, in the ground; `None` where geometry satisfies a
    /// constraint, whose reaction does not appear in these equations, and where constraints follow from
    /// others.
    pub reactions: Vec<(String, [Option<f64>; 3])>,
}

/// Kinetic energy for given coordinates and velocities.
fn kinetic<S: Real>(setting: &Setting<'_>, q: &[S], qd: &[S], passed: S) -> S {
    let zeros = vec![S::constant(0.0); q.len()];
    let motion = Motion::new(setting, q, qd, &zeros, passed);
    let values = Values::new(setting, q.to_vec(), qd.to_vec(), passed);
    let mut twice = S::constant(0.0);
    for (index, body) in setting.mechanism.bodies.iter().enumerate() {
        let v = motion.centre(index).map(|c| c.value);
        twice += values.of(&body.mass) * dot(v, v);
        if let Some(inertia) = &body.inertia {
            let w = apply_transposed(
                &motion.rotations[inertia.frame],
                motion.body_turning(index).map(|c| c.value),
            );
            let tensor = [0, 1, 2].map(|i| values.of3(&inertia.matrix[i]));
            twice += dot(w, apply(&tensor, w));
        }
    }
    S::constant(0.5) * twice
}

/// Lagrange's equations in a setting.
pub fn lagrange(setting: &Setting<'_>) -> Lagrange {
    let n = setting.coordinates.len();
    let velocities = Velocities::new(setting);
    let rates = coordinate_rates(setting, &velocities);

    // Outer direction: ∂/∂q̇_i. Inner direction: along the motion, or ∂/∂q̇_j.
    let lift = |value: f64, inner: f64, outer: f64| Second {
        value: Dual {
            value,
            partials: [inner],
        },
        partials: [Dual {
            value: outer,
            partials: [0.0],
        }],
    };
    let one = |k: usize, i: usize| if k == i { 1.0 } else { 0.0 };
    let q = |along: f64| -> Vec<Second> {
        (0..n)
            .map(|k| lift(setting.coordinates[k], along * rates[k], 0.0))
            .collect()
    };
    let mut matrix = DMatrix::zeros(n, n);
    let mut right = DVector::zeros(n);
    let loads = loads_without_potential(setting, &rates);
    let zeros = vec![0.0; n];
    let rest = motion(setting, &zeros, &zeros);
    for i in 0..n {
        for j in 0..=i {
            let qd: Vec<Second> = (0..n)
                .map(|k| lift(rates[k], one(k, j), one(k, i)))
                .collect();
            let t = kinetic(setting, &q(0.0), &qd, lift(0.0, 0.0, 0.0));
            matrix[(i, j)] = t.partials[0].partials[0];
            matrix[(j, i)] = matrix[(i, j)];
        }
        let qd: Vec<Second> = (0..n).map(|k| lift(rates[k], 0.0, one(k, i))).collect();
        let drift = kinetic(setting, &q(1.0), &qd, lift(0.0, 1.0, 0.0)).partials[0].partials[0];
        let first = |value: f64, slope: f64| Dual::<f64, 1> {
            value,
            partials: [slope],
        };
        let varied: Vec<_> = (0..n)
            .map(|k| first(setting.coordinates[k], one(k, i)))
            .collect();
        let fixed: Vec<_> = rates.iter().map(|&r| first(r, 0.0)).collect();
        let slope = kinetic(setting, &varied, &fixed, first(0.0, 0.0)).partials[0]
            - potential(setting, &varied, first(0.0, 0.0)).partials[0];
        let unit: Vec<f64> = (0..n).map(|k| one(k, i)).collect();
        let force =
            power(&loads, &motion(setting, &unit, &zeros), &unit) - power(&loads, &rest, &zeros);
        right[i] = force + slope - drift;
    }

    // M q̈ - Cᵀ λ = right, C q̈ = -ċ.
    let c = velocities.active.len();
    let now = motion(setting, &rates, &zeros);
    let mut whole = DMatrix::zeros(n + c, n + c);
    let mut target = DVector::zeros(n + c);
    whole.view_mut((0, 0), (n, n)).copy_from(&matrix);
    target.rows_mut(0, n).copy_from(&right);
    for (row, &active) in velocities.active.iter().enumerate() {
        for k in 0..n {
            whole[(n + row, k)] = velocities.coefficients[active][k];
            whole[(k, n + row)] = -velocities.coefficients[active][k];
        }
        target[n + row] = -now.rows[active].partials[0];
    }
    let solution = whole
        .full_piv_lu()
        .solve(&target)
        .expect("constraints are independent");
    let coordinate_accelerations: Vec<f64> = solution.iter().take(n).copied().collect();
    let actual = motion(setting, &rates, &coordinate_accelerations);
    let multipliers: Vec<Option<f64>> = (0..now.rows.len())
        .map(|i| {
            velocities
                .active
                .iter()
                .position(|&a| a == i && !velocities.redundant)
                .map(|row| solution[n + row])
        })
        .collect();
    Lagrange {
        accelerations: actual.speeds.iter().map(|w| w.partials[0]).collect(),
        coordinate_accelerations,
        reactions: reactions(setting, &now, &multipliers),
    }
}

/// The multipliers as forces at the places of the constraints.
fn reactions(
    setting: &Setting<'_>,
    now: &Motion<f64>,
    multipliers: &[Option<f64>],
) -> Vec<(String, [Option<f64>; 3])> {
    let mechanism = setting.mechanism;
    let values = Values::new(
        setting,
        setting.coordinates.to_vec(),
        vec![0.0; setting.coordinates.len()],
        0.0,
    );
    let mut places: Vec<(String, [Option<f64>; 3])> = Vec::new();
    let mut act = |name: &str, force: [Option<f64>; 3]| {
        let known = places.iter().position(|(place, _)| place == name);
        let place = known.unwrap_or_else(|| {
            places.push((name.to_owned(), [Some(0.0); 3]));
            places.len() - 1
        });
        for (total, part) in places[place].1.iter_mut().zip(force) {
            *total = total.zip(part).map(|(total, part)| total + part);
        }
    };
    let mut rest = multipliers.iter().copied();
    for constraint in &mechanism.constraints {
        match &constraint.kind {
            ConstraintKind::Rolling { contact, .. } => {
                let force = [(); 3].map(|()| rest.next().unwrap());
                act(&mechanism.points[*contact].name, force);
            }
            ConstraintKind::Velocity { .. } => {
                act(
                    &constraint.name,
                    [rest.next().unwrap(), Some(0.0), Some(0.0)],
                );
            }
            ConstraintKind::FixedVelocity {
                point,
                frame,
                direction,
                ..
            } => {
                let along = apply(&now.rotations[*frame], values.of3(direction));
                let multiplier = rest.next().unwrap();
                act(
                    &mechanism.points[*point].name,
                    along.map(|c| multiplier.map(|m| m * c)),
                );
            }
            ConstraintKind::Position { .. } => panic!("reserved"),
        }
    }
    places
}
