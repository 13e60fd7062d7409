//! Kane's equations: `Σ (F - m a)·v_i + (T - I α - ω × I ω)·ω_i = 0` for every pseudo-velocity.

use nalgebra::{DMatrix, DVector};

use super::Setting;
use super::evaluate::Values;
use super::loads::{Applied, applied, external_force, power};
use super::motion::{Jet, Motion, V3, add, apply, apply_transposed, cross, dot, scale, subtract};

/// Coefficients and solution of Kane's equations, in the notation of Appell's.
#[derive(Debug, Clone)]
pub struct Kane {
    /// Generalised velocities.
    pub coordinate_rates: Vec<f64>,
    /// M.
    pub mass_matrix: DMatrix<f64>,
    /// b.
    pub bias: DVector<f64>,
    /// Π.
    pub forces: DVector<f64>,
    /// Pseudo-accelerations.
    pub accelerations: DVector<f64>,
    /// Sum of all reactions of the constraints by Newton's law for the whole.
    pub total_reaction: V3<f64>,
}

/// The linear map from pseudo-velocities and violations to generalised velocities.
pub struct Velocities {
    inverse: DMatrix<f64>,
    /// Rows of the constraints that neither geometry nor the rows before them satisfy.
    pub active: Vec<usize>,
    /// Whether rows follow from others, so that no multiplier is known.
    pub redundant: bool,
    /// Coefficients of the generalised velocities in all constraint rows.
    pub coefficients: Vec<Vec<f64>>,
    speeds: usize,
}

impl Velocities {
    /// From the definitions and the constraints.
    pub fn new(setting: &Setting<'_>) -> Self {
        let n = setting.coordinates.len();
        let rest = motion(setting, &vec![0.0; n], &vec![0.0; n]);
        let units: Vec<Motion<f64>> = (0..n)
            .map(|k| motion(setting, &unit(n, k), &vec![0.0; n]))
            .collect();
        let slopes = |get: &dyn Fn(&Motion<f64>) -> f64| -> Vec<f64> {
            units.iter().map(|m| get(m) - get(&rest)).collect()
        };
        let definitions: Vec<Vec<f64>> = (0..rest.speeds.len())
            .map(|i| slopes(&|m| m.speeds[i].value))
            .collect();
        let coefficients: Vec<Vec<f64>> = (0..rest.rows.len())
            .map(|i| slopes(&|m| m.rows[i].value))
            .collect();
        // A row that geometry satisfies has no coefficients but for rounding.
        let moving: Vec<usize> = (0..coefficients.len())
            .filter(|&i| coefficients[i].iter().any(|c| c.abs() > 1e-9))
            .collect();
        let active = independent(&coefficients, &moving);
        let redundant = active.len() < moving.len();
        let rows: Vec<&Vec<f64>> = definitions
            .iter()
            .chain(active.iter().map(|&i| &coefficients[i]))
            .collect();
        assert_eq!(rows.len(), n, "as many equations as generalised velocities");
        let matrix = DMatrix::from_fn(n, n, |i, j| rows[i][j]);
        let inverse = matrix
            .try_inverse()
            .expect("pseudo-velocities determine the motion");
        Self {
            inverse,
            active,
            redundant,
            coefficients,
            speeds: definitions.len(),
        }
    }

    /// Generalised velocities, or accelerations, with which the definitions and the constraints
    /// grow from `start` to `target` and 0.
    pub fn solve(&self, target: &[f64], start_speeds: &[f64], start_rows: &[f64]) -> Vec<f64> {
        let wanted = target
            .iter()
            .zip(start_speeds)
            .map(|(target, start)| target - start);
        let rows = self.active.iter().map(|&i| -start_rows[i]);
        let right = DVector::from_iterator(self.inverse.nrows(), wanted.chain(rows));
        (&self.inverse * right).iter().copied().collect()
    }

    /// Generalised velocities per unit of pseudo-velocity `i`.
    fn direction(&self, i: usize) -> Vec<f64> {
        self.inverse.column(i).iter().copied().collect()
    }
}

/// The rows that are no sum of rows before them, by Gram and Schmidt.
fn independent(rows: &[Vec<f64>], candidates: &[usize]) -> Vec<usize> {
    let mut basis: Vec<DVector<f64>> = Vec::new();
    let mut kept = Vec::new();
    for &candidate in candidates {
        let row = DVector::from_column_slice(&rows[candidate]);
        let mut rest = row.clone();
        for _ in 0..2 {
            for unit in &basis {
                rest -= unit * unit.dot(&rest);
            }
        }
        if rest.norm() > 1e-9 * row.norm() {
            basis.push(rest.normalize());
            kept.push(candidate);
        }
    }
    kept
}

/// How velocities of the bodies grow with one pseudo-velocity.
struct Partial {
    /// Of the centres of mass.
    v: Vec<V3<f64>>,
    /// Of the turning.
    w: Vec<V3<f64>>,
}

impl Partial {
    /// From the motion with one unit of the pseudo-velocity and the one without any.
    fn new(along: &Motion<f64>, rest: &Motion<f64>, bodies: usize) -> Self {
        let now = |jet: V3<Jet<f64>>| jet.map(|c| c.value);
        Self {
            v: (0..bodies)
                .map(|k| subtract(now(along.centre(k)), now(rest.centre(k))))
                .collect(),
            w: (0..bodies)
                .map(|k| subtract(now(along.body_turning(k)), now(rest.body_turning(k))))
                .collect(),
        }
    }
}

/// A motion from the setting's coordinates.
pub fn motion(setting: &Setting<'_>, rates: &[f64], accelerations: &[f64]) -> Motion<f64> {
    Motion::new(setting, setting.coordinates, rates, accelerations, 0.0)
}

fn unit(n: usize, k: usize) -> Vec<f64> {
    (0..n).map(|i| if i == k { 1.0 } else { 0.0 }).collect()
}

/// Generalised velocities of the setting.
pub fn coordinate_rates(setting: &Setting<'_>, velocities: &Velocities) -> Vec<f64> {
    let zeros = vec![0.0; setting.coordinates.len()];
    let rest = motion(setting, &zeros, &zeros);
    let speeds: Vec<f64> = rest.speeds.iter().map(|w| w.value).collect();
    let rows: Vec<f64> = rest.rows.iter().map(|c| c.value).collect();
    velocities.solve(setting.speeds, &speeds, &rows)
}

/// Inertia tensor of a body times a vector, in the ground.
fn momentum(
    setting: &Setting<'_>,
    values: &Values<f64>,
    m: &Motion<f64>,
    body: usize,
    w: V3<f64>,
) -> V3<f64> {
    let Some(inertia) = &setting.mechanism.bodies[body].inertia else {
        return [0.0; 3];
    };
    let r = &m.rotations[inertia.frame];
    let tensor = [0, 1, 2].map(|i| values.of3(&inertia.matrix[i]));
    apply(r, apply(&tensor, apply_transposed(r, w)))
}

/// Kane's equations in a setting.
pub fn kane(setting: &Setting<'_>) -> Kane {
    let (n, s) = (setting.coordinates.len(), setting.speeds.len());
    let bodies = setting.mechanism.bodies.len();
    let velocities = Velocities::new(setting);
    assert_eq!(velocities.speeds, s);
    let rates = coordinate_rates(setting, &velocities);
    let values = Values::new(setting, setting.coordinates.to_vec(), rates.clone(), 0.0);

    // The motion without pseudo-accelerations.
    let zeros = vec![0.0; n];
    let drift = motion(setting, &rates, &zeros);
    let accelerate = |target: &[f64]| {
        let speeds: Vec<f64> = drift.speeds.iter().map(|w| w.partials[0]).collect();
        let rows: Vec<f64> = drift.rows.iter().map(|c| c.partials[0]).collect();
        velocities.solve(target, &speeds, &rows)
    };
    let coasting = motion(setting, &rates, &accelerate(&vec![0.0; s]));

    // Partial velocities of the centres of mass and of the bodies' turning.
    let rest = motion(setting, &zeros, &zeros);
    let partial: Vec<Partial> = (0..s)
        .map(|i| {
            Partial::new(
                &motion(setting, &velocities.direction(i), &zeros),
                &rest,
                bodies,
            )
        })
        .collect();

    let loads = applied(setting, &values, &drift, true);
    let inertial = |m: &Motion<f64>, body: usize| -> (V3<f64>, V3<f64>) {
        let mass = values.of(&setting.mechanism.bodies[body].mass);
        let a = m.centre(body).map(|c| c.partials[0]);
        let turning = m.body_turning(body);
        let (w, alpha) = (turning.map(|c| c.value), turning.map(|c| c.partials[0]));
        let growth = momentum(setting, &values, m, body, alpha);
        let gyroscopic = cross(w, momentum(setting, &values, m, body, w));
        (scale(mass, a), add(growth, gyroscopic))
    };
    let mut mass_matrix = DMatrix::zeros(s, s);
    let mut bias = DVector::zeros(s);
    let mut forces = DVector::zeros(s);
    for i in 0..s {
        let Partial { v, w } = &partial[i];
        for body in 0..bodies {
            let (force, moment) = inertial(&coasting, body);
            bias[i] += dot(force, v[body]) + dot(moment, w[body]);
            let mass = values.of(&setting.mechanism.bodies[body].mass);
            for j in 0..s {
                let Partial { v: vj, w: wj } = &partial[j];
                let spin = momentum(setting, &values, &rest, body, wj[body]);
                mass_matrix[(i, j)] += mass * dot(v[body], vj[body]) + dot(w[body], spin);
            }
        }
        let direction = velocities.direction(i);
        let along = motion(setting, &direction, &zeros);
        forces[i] = power(&loads, &along, &direction) - power(&loads, &rest, &zeros);
    }
    let accelerations = mass_matrix
        .clone()
        .lu()
        .solve(&(&forces - &bias))
        .expect("M is regular");

    let target: Vec<f64> = accelerations.iter().copied().collect();
    let actual = motion(setting, &rates, &accelerate(&target));
    let mut total_reaction = scale(-1.0, external_force(&loads));
    for body in 0..bodies {
        total_reaction = add(total_reaction, inertial(&actual, body).0);
    }
    Kane {
        coordinate_rates: rates,
        mass_matrix,
        bias,
        forces,
        accelerations,
        total_reaction,
    }
}

/// Loads at the setting, for a formulation that treats potentials in another way.
pub fn loads_without_potential(setting: &Setting<'_>, rates: &[f64]) -> Vec<Applied> {
    let values = Values::new(setting, setting.coordinates.to_vec(), rates.to_vec(), 0.0);
    let now = motion(setting, rates, &vec![0.0; rates.len()]);
    applied(setting, &values, &now, false)
}
