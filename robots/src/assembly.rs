//! Joint positions, and the nearest ones that satisfy the constraints, by the Gauss–Newton method.

use crate::elimination::largest;
use crate::kinematics::Freedom;
use crate::model::{Link, Motion};
use crate::rotation::{Pose, Rotation, Vector, add, minus};

/// Residuals that count as zero, relative to the longest lever.
pub(crate) const HELD: f64 = 1e-9;
/// Largest number of steps, of halvings of one, and the longest step, in m or rad.
const MOST_STEPS: usize = 40;
const MOST_HALVINGS: usize = 6;
const LONGEST_STEP: f64 = 0.5;
/// Largest ratio of the sums of squares after and before an accepted step.
const BETTER: f64 = 0.99;
/// Squared relative norm of the gradient at which a linear problem counts as solved.
const SOLVED: f64 = 1e-26;

/// Displacement of each link relative to its parent, from the drawn configuration.
#[derive(Debug, Clone)]
pub(crate) struct Configuration {
    /// Along or about the axis of its joint.
    pub(crate) ways: Vec<f64>,
    /// By a joint without an axis.
    pub(crate) turned: Vec<Pose>,
}

/// Jacobian and residuals of the constraints at a configuration.
#[derive(Default)]
pub(crate) struct Linear {
    pub(crate) rows: Vec<Vec<f64>>,
    pub(crate) off: Vec<f64>,
}

impl Linear {
    /// The largest residual relative to the longest lever.
    pub(crate) fn size(&self) -> f64 {
        let lever = self.rows.iter().map(|row| largest(row)).fold(1.0, f64::max);
        largest(&self.off) / lever
    }
}

impl Configuration {
    pub(crate) fn new(links: &[Link], ways: impl Fn(usize) -> f64) -> Self {
        Self {
            ways: (0..links.len()).map(ways).collect(),
            turned: vec![Pose::IDENTITY; links.len()],
        }
    }

    /// Poses of all links.
    pub(crate) fn poses(&self, links: &[Link]) -> Vec<Pose> {
        let mut poses: Vec<Pose> = Vec::with_capacity(links.len());
        for (index, link) in links.iter().enumerate() {
            let on = link.parent.map_or(Pose::IDENTITY, |parent| poses[parent]);
            let within = link.moved(self.ways[index]).then(self.turned[index]);
            poses.push(on.then(within));
        }
        poses
    }

    /// Displaces each freedom by an amount.
    pub(crate) fn step(&mut self, links: &[Link], freedoms: &[Freedom], by: &[f64]) {
        let poses = self.poses(links);
        for (freedom, &by) in freedoms.iter().zip(by) {
            let (link, component) = (freedom.link, freedom.component);
            let Some(joint) = &links[link].joint else {
                continue;
            };
            let turned = &mut self.turned[link];
            let about = |component: usize, anchor: Vector| {
                let rotation = Rotation::about(component, by);
                let position = minus(anchor, rotation.of(anchor));
                Pose { rotation, position }
            };
            match joint.motion {
                Motion::Turning | Motion::Sliding => self.ways[link] += by,
                Motion::Ball => *turned = turned.then(about(component, joint.anchor)),
                Motion::Free if component >= 3 => {
                    *turned = turned.then(about(component - 3, [0.0; 3]));
                }
                // Along an axis of the ground.
                Motion::Free => {
                    let drawn = poses[link].rotation.then(turned.rotation.inverse());
                    let shift = drawn.inverse().0.map(|row| row[component] * by);
                    turned.position = add(turned.position, shift);
                }
            }
        }
    }

    /// The nearest place where equations hold, and by how much they deviate there: where they contradict each other, or
    /// are far from holding, it is the last one that was better than those before.
    pub(crate) fn assembled(
        mut self,
        links: &[Link],
        freedoms: &[Freedom],
        equations: &dyn Fn(&Self) -> Linear,
    ) -> (Self, Linear) {
        let mut now = equations(&self);
        for _ in 0..MOST_STEPS {
            if now.size() <= HELD {
                break;
            }
            let step = least(&now.rows, &now.off);
            let mut share = (LONGEST_STEP / largest(&step)).min(1.0);
            let mut better = None;
            for _ in 0..MOST_HALVINGS {
                let by: Vec<f64> = step.iter().map(|way| -share * way).collect();
                let mut next = self.clone();
                next.step(links, freedoms, &by);
                let there = equations(&next);
                if squares(&there.off) < BETTER * squares(&now.off) {
                    better = Some((next, there));
                    break;
                }
                share /= 2.0;
            }
            let Some(next) = better else {
                break;
            };
            (self, now) = next;
        }
        (self, now)
    }
}

fn squares(a: &[f64]) -> f64 {
    a.iter().map(|x| x * x).sum()
}

/// The shortest solution by least squares, by conjugate gradients (Björck, *Numerical Methods for Least Squares Problems*,
/// 1996, section 7.4); rows may be linearly dependent.
fn least(rows: &[Vec<f64>], right: &[f64]) -> Vec<f64> {
    let count = rows.first().map_or(0, Vec::len);
    let across = |left: &[f64]| -> Vec<f64> {
        let mut sum = vec![0.0; count];
        for (row, left) in rows.iter().zip(left) {
            sum.iter_mut()
                .zip(row)
                .for_each(|(sum, entry)| *sum += entry * left);
        }
        sum
    };
    let mut solution = vec![0.0; count];
    let mut rest = right.to_vec();
    let mut way = across(&rest);
    let first = squares(&way);
    let mut gradient = first;
    for _ in 0..2 * rows.len().min(count) {
        if gradient <= SOLVED * first {
            break;
        }
        let along: Vec<f64> = rows
            .iter()
            .map(|row| row.iter().zip(&way).map(|(a, b)| a * b).sum())
            .collect();
        let length = gradient / squares(&along);
        for (own, way) in solution.iter_mut().zip(&way) {
            *own += length * way;
        }
        for (own, along) in rest.iter_mut().zip(&along) {
            *own -= length * along;
        }
        let steepest = across(&rest);
        let next = squares(&steepest);
        for (own, steepest) in way.iter_mut().zip(steepest) {
            *own = steepest + next / gradient * *own;
        }
        gradient = next;
    }
    solution
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shortest_solution_is_found_where_rows_depend_on_each_other() {
        let rows = [
            vec![1.0, 1.0, 0.0],
            vec![2.0, 2.0, 0.0],
            vec![0.0, 0.0, 4.0],
        ];
        let solution = least(&rows, &[1.0, 2.0, 2.0]);
        for (own, expected) in solution.iter().zip([0.5, 0.5, 0.5]) {
            assert!((own - expected).abs() < 1e-14, "{solution:?}");
        }
        assert_eq!(least(&rows, &[0.0; 3]), [0.0; 3]);
    }
}
