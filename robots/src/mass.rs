//! The mass matrix at a pose, by composite inertias (Featherstone, *Rigid Body Dynamics Algorithms*, 2008, chapter 6).

use crate::assembly::Configuration;
use crate::inertia::Inertia;
use crate::kinematics::{Freedom, Twist};
use crate::model::{Drive, Law, Link, On, Tendon};
use crate::rotation::{Pose, Vector, add, cross, dot, scaled};

/// Largest number of freedoms for which the mass matrix is computed.
pub(crate) const MOST_FREEDOMS: usize = 512;

/// Inertia of a rigid body about the origin of the ground.
#[derive(Debug, Clone, Copy, Default)]
struct Spatial {
    mass: f64,
    /// Mass times centre of mass.
    moment: Vector,
    tensor: [Vector; 3],
}

impl Spatial {
    fn of(inertia: &Inertia, pose: Pose) -> Self {
        let own = inertia.placed(pose);
        let c = own.centre;
        let mut tensor = own.rows();
        for (i, row) in tensor.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                let square = if i == j { dot(c, c) } else { 0.0 };
                *entry += own.mass * (square - c[i] * c[j]);
            }
        }
        Self {
            mass: own.mass,
            moment: scaled(c, own.mass),
            tensor,
        }
    }

    fn with(self, other: Self) -> Self {
        Self {
            mass: self.mass + other.mass,
            moment: add(self.moment, other.moment),
            tensor: [0, 1, 2].map(|i| add(self.tensor[i], other.tensor[i])),
        }
    }

    /// The size of the terms of twice the kinetic energy.
    fn terms(&self, of: Twist) -> f64 {
        let size = |v: Vector| dot(v, v).sqrt();
        let (turn, shift) = (size(of.turn), size(of.shift));
        let tensor = self.tensor.iter().map(|row| size(*row)).fold(0.0, f64::max);
        tensor * turn * turn
            + 2.0 * size(self.moment) * turn * shift
            + self.mass.abs() * shift * shift
    }

    /// Angular and linear momentum of a velocity.
    fn momentum(&self, of: Twist) -> [Vector; 2] {
        let turning = self.tensor.map(|row| dot(row, of.turn));
        [
            add(turning, cross(self.moment, of.shift)),
            add(scaled(of.shift, self.mass), cross(of.turn, self.moment)),
        ]
    }
}

/// A mass matrix; rows and columns are the freedoms.
pub(crate) struct Mass {
    pub(crate) entries: Vec<Vec<f64>>,
    /// By freedom: the magnitude of the terms of the diagonal entry, before cancellation.
    terms: Vec<f64>,
}

/// M of the tree at given poses of the links, with the armature of joints and tendons.
pub(crate) fn matrix(links: &[Link], tendons: &[Tendon], poses: &[Pose]) -> Mass {
    let each = links.iter().zip(poses);
    let mut carried: Vec<Spatial> = each
        .map(|(link, pose)| Spatial::of(&link.inertia, *pose))
        .collect();
    for index in (0..links.len()).rev() {
        if let Some(parent) = links[index].parent {
            carried[parent] = carried[parent].with(carried[index]);
        }
    }
    let freedoms = Freedom::all(links);
    let twists = freedoms.iter().map(|one| one.twist(links, poses));
    let twists: Vec<Twist> = twists.collect();
    let mut first = vec![freedoms.len(); links.len() + 1];
    for (column, freedom) in freedoms.iter().enumerate().rev() {
        first[freedom.link] = column;
    }
    let mut m = vec![vec![0.0; freedoms.len()]; freedoms.len()];
    let mut terms = Vec::with_capacity(freedoms.len());
    for (column, freedom) in freedoms.iter().enumerate() {
        let [turning, linear] = carried[freedom.link].momentum(twists[column]);
        let mut at = Some(freedom.link);
        while let Some(link) = at {
            let own = links[link].joint.as_ref();
            let count = own.map_or(0, |joint| joint.motion.freedoms());
            for row in first[link]..first[link] + count {
                let entry = dot(twists[row].turn, turning) + dot(twists[row].shift, linear);
                m[row][column] = entry;
                m[column][row] = entry;
            }
            at = links[link].parent;
        }
        let joint = links[freedom.link].joint.as_ref();
        m[column][column] += joint.map_or(0.0, |joint| joint.armature);
        terms.push(carried[freedom.link].terms(twists[column]) + m[column][column].abs());
    }
    for tendon in tendons.iter().filter(|tendon| tendon.armature != 0.0) {
        let rates = freedoms
            .iter()
            .map(|one| one.rate(links, &tendon.length.terms));
        let rates: Vec<f64> = rates.collect();
        for (row, i) in m.iter_mut().zip(&rates) {
            for (entry, j) in row.iter_mut().zip(&rates) {
                *entry += tendon.armature * i * j;
            }
        }
    }
    Mass { entries: m, terms }
}

/// The inverse of a positive definite matrix.
fn inverse(mut m: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let count = m.len();
    let mut inverse: Vec<Vec<f64>> = (0..count)
        .map(|row| {
            (0..count)
                .map(|column| f64::from(u8::from(row == column)))
                .collect()
        })
        .collect();
    for k in 0..count {
        let factor = 1.0 / m[k][k];
        for matrix in [&mut m, &mut inverse] {
            matrix[k].iter_mut().for_each(|entry| *entry *= factor);
        }
        let own = (m[k].clone(), inverse[k].clone());
        for row in (0..count).filter(|row| *row != k) {
            let factor = m[row][k];
            for (matrix, own) in [(&mut m, &own.0), (&mut inverse, &own.1)] {
                for (entry, own) in matrix[row].iter_mut().zip(own) {
                    *entry -= factor * own;
                }
            }
        }
    }
    inverse
}

/// Computes stiffness and damping from time constant and damping ratio, with the inertia as drawn. False if the robot
/// is too large for that.
pub(crate) fn settle(links: &mut [Link], tendons: &[Tendon]) -> bool {
    let settles = |link: &Link| {
        link.joint
            .as_ref()
            .is_some_and(|joint| joint.settles.is_some())
    };
    if !links.iter().any(settles) {
        return true;
    }
    if Freedom::all(links).len() > MOST_FREEDOMS {
        return false;
    }
    let drawn = Configuration::new(links, |_| 0.0).poses(links);
    let mobility = inverse(matrix(links, tendons, &drawn).entries);
    let mut first = 0;
    for joint in links.iter_mut().filter_map(|link| link.joint.as_mut()) {
        let next = first + joint.motion.freedoms();
        if let Some([time, ratio]) = joint.settles {
            // As in MuJoCo 4.0: with all other joints free.
            let sum: f64 = (first..next).map(|row| mobility[row][row]).sum();
            let inertia = (next - first) as f64 / sum;
            let inertia = if inertia.is_finite() { inertia } else { 0.0 };
            joint.damping = [2.0 * inertia / time, 0.0, 0.0];
            joint.stiffness = [inertia / (time * time * ratio * ratio), 0.0, 0.0];
        }
        first = next;
    }
    true
}

/// Computes the damping of position servos from their damping ratios, which are positive factors of the rate in the bias,
/// with the inertia as drawn. False if the robot is too large for that.
pub(crate) fn damp(drives: &mut [Drive], links: &[Link], tendons: &[Tendon]) -> bool {
    let by_ratio = |drive: &Drive| drive.law() == Law::Position && drive.bias[2] > 0.0;
    if !drives.iter().any(by_ratio) {
        return true;
    }
    let freedoms = Freedom::all(links);
    if freedoms.len() > MOST_FREEDOMS {
        return false;
    }
    let drawn = Configuration::new(links, |_| 0.0).poses(links);
    let mobility = inverse(matrix(links, tendons, &drawn).entries);
    for drive in drives.iter_mut().filter(|drive| by_ratio(drive)) {
        let terms = match &drive.on {
            On::Joint(name) => vec![(name.clone(), 1.0)],
            On::Tendon(name) => {
                let tendon = tendons.iter().find(|tendon| tendon.name == *name);
                tendon.map_or_else(Vec::new, |tendon| tendon.length.terms.clone())
            }
        };
        // As in MuJoCo 4.0: m = (J M⁻¹ Jᵀ)⁻¹.
        let along = freedoms
            .iter()
            .map(|one| drive.gear * one.rate(links, &terms));
        let along: Vec<f64> = along.collect();
        let rows = mobility.iter().zip(&along);
        let sum: f64 = rows
            .map(|(row, own)| own * row.iter().zip(&along).map(|(a, b)| a * b).sum::<f64>())
            .sum();
        drive.bias[2] *= -2.0 * (drive.gain[0] / sum).sqrt();
    }
    true
}

/// The first freedom without inertia along it, from the leaves of the tree inwards.
///
/// The freedoms are reduced to the independent ones: `rows` are the equations between them in reduced echelon form.
pub(crate) fn without_inertia(mass: &Mass, rows: &[(usize, Vec<f64>)]) -> Option<usize> {
    let m = &mass.entries;
    let count = m.len();
    let follows = |column: usize| rows.iter().any(|(pivot, _)| *pivot == column);
    let free: Vec<usize> = (0..count).rev().filter(|&c| !follows(c)).collect();
    // Partial velocities of all freedoms with respect to an independent one.
    let moves = |column: usize| {
        let mut all = vec![0.0; count];
        all[column] = 1.0;
        for (pivot, row) in rows {
            all[*pivot] = -row[column];
        }
        all
    };
    let moves: Vec<Vec<f64>> = free.iter().map(|&column| moves(column)).collect();
    let momenta = moves.iter().map(|one| -> Vec<f64> {
        let of = |row: &Vec<f64>| row.iter().zip(one).map(|(a, b)| a * b).sum();
        m.iter().map(of).collect()
    });
    let momenta: Vec<Vec<f64>> = momenta.collect();
    let entry =
        |i: usize, j: usize| -> f64 { moves[i].iter().zip(&momenta[j]).map(|(a, b)| a * b).sum() };
    let mut reduced: Vec<Vec<f64>> = (0..free.len())
        .map(|i| (0..free.len()).map(|j| entry(i, j)).collect())
        .collect();
    for k in 0..free.len() {
        let terms = moves[k].iter().zip(&mass.terms);
        let whole: f64 = terms.map(|(rate, terms)| rate * rate * terms).sum();
        let pivot = reduced[k][k];
        if pivot.abs() <= ROUNDING * whole {
            return Some(free[k]);
        }
        let row = reduced[k].clone();
        for below in reduced.iter_mut().skip(k + 1) {
            let factor = below[k] / pivot;
            for (own, other) in below.iter_mut().zip(&row).skip(k) {
                *own -= factor * other;
            }
        }
    }
    None
}

/// Relative rounding error of a vanishing inertia.
const ROUNDING: f64 = 1e-13;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Joint, Motion};

    #[test]
    fn two_hinged_links_have_the_mass_matrix_of_the_textbook() {
        let rod = |name: &str, parent, x: f64| {
            let mut link = Link::fixed(name.to_owned(), parent, Pose::IDENTITY, 0..0);
            link.pose.position = [x, 0.0, 0.0];
            link.inertia = Inertia {
                mass: 2.0,
                centre: [0.5, 0.0, 0.0],
                tensor: [0.0, 0.1, 0.1, 0.0, 0.0, 0.0],
            };
            link.joint = Some(Joint::along(
                name.to_owned(),
                Motion::Turning,
                [0.0, 1.0, 0.0],
            ));
            link
        };
        let links = [rod("a", None, 0.0), rod("b", Some(0), 1.0)];
        let poses = Configuration::new(&links, |link| [0.3, 0.7][link]).poses(&links);
        let m = matrix(&links, &[], &poses).entries;
        let (own, cos) = (0.1 + 2.0 * 0.25, 0.7_f64.cos());
        let expected = [[2.0 * own + 2.0 + 2.0 * cos, own + cos], [own + cos, own]];
        for (row, expected) in m.iter().zip(expected) {
            for (entry, expected) in row.iter().zip(expected) {
                assert!((entry - expected).abs() < 1e-14, "{m:?}");
            }
        }
    }
}
