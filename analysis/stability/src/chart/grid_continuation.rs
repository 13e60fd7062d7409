//! Continuation over a grid: from each known motion to the neighbouring grid points.
//!
//! A grid point may have several motions, on branches that meet in folds. Each branch is continued
//! from one of its motions as far as it extends.

use std::collections::VecDeque;
use std::ops::Range;

use nalgebra::DVector;

use super::plane::Plane;
use crate::steady::SteadyProblem;

/// Motions of some rows of the grid.
pub(crate) struct GridContinuation<'a> {
    plane: &'a Plane<'a>,
    rows: Range<usize>,
    /// Those of each grid point, the horizontal quantity running fastest.
    pub(crate) motions: Vec<Vec<DVector<f64>>>,
    /// Grid point and number of those whose neighbours have not been sought.
    open: VecDeque<(usize, usize)>,
}

/// Motions of one grid point that differ by less, relative to their size, are the same: near a fold this is the
/// accuracy with which continuation from different neighbours agrees.
const SAME_AT_POINT: f64 = 1e-5;
/// Failed probes of holes after which the rest is taken as empty.
const MOST_PROBES: usize = 8;
/// Largest number of starting points in a hole.
const PROBE_STARTS: usize = 20;
/// Distance in grid points from known motions at which a gap counts as a hole, not an edge.
const DEEP: usize = 3;

impl<'a> GridContinuation<'a> {
    /// Without motions.
    pub(crate) fn over(plane: &'a Plane<'a>, rows: Range<usize>) -> Self {
        let nodes = rows.len() * plane.axes[0].count;
        Self {
            plane,
            rows,
            motions: vec![Vec::new(); nodes],
            open: VecDeque::new(),
        }
    }

    /// Joins consecutive bands of rows; motions at their edges are continued again.
    pub(crate) fn joined(plane: &'a Plane<'a>, bands: Vec<Self>) -> Self {
        let mut all = Self::over(plane, 0..plane.axes[1].count);
        let count = plane.axes[0].count;
        let mut motions = Vec::with_capacity(all.motions.len());
        for band in bands {
            let edges = [band.rows.start, band.rows.end - 1];
            for node in edges.into_iter().flat_map(|j| j * count..(j + 1) * count) {
                let in_band = node - band.rows.start * count;
                all.open
                    .extend((0..band.motions[in_band].len()).map(|motion| (node, motion)));
            }
            motions.extend(band.motions);
        }
        all.motions = motions;
        all
    }

    /// Continues any motion to the nearest grid point, if that is in these rows.
    pub(crate) fn seed(&mut self, z: &DVector<f64>) {
        let from = self.plane.coordinates(z);
        let [i, j] = [0, 1].map(|k: usize| self.plane.axes[k].nearest(from[k]));
        if let Some(row) = j.checked_sub(self.rows.start).filter(|_| j < self.rows.end) {
            let node = row * self.plane.axes[0].count + i;
            let found = self.plane.approach(from, z, self.values(node));
            self.add(node, found);
        }
    }

    /// Continues all motions until no further one is reached.
    pub(crate) fn continue_all(&mut self) {
        while let Some((node, motion)) = self.open.pop_front() {
            let z = self.motions[node][motion].clone();
            let beside = self.beside(node);
            for (to, behind) in [(0, 1), (1, 0), (2, 3), (3, 2)] {
                if let Some(to) = beside[to] {
                    self.reach([node, to], &z, beside[behind]);
                }
            }
        }
    }

    /// Seeks motions from many starting points where none are known.
    pub(crate) fn fill_holes(&mut self, problem: &SteadyProblem<'_>, starts: usize) {
        let mut empty = Vec::new();
        while empty.len() < MOST_PROBES
            && let Some(node) = self.deepest_hole(&empty)
        {
            let found = self.probe(problem, node, starts.min(PROBE_STARTS));
            if found.is_empty() {
                empty.push(node);
            }
            for z in found {
                self.add(node, Some(z));
            }
            self.continue_all();
        }
    }

    fn probe(&self, problem: &SteadyProblem<'_>, node: usize, starts: usize) -> Vec<DVector<f64>> {
        let mut here = problem.clone();
        for (axis, value) in self.plane.axes.iter().zip(self.values(node)) {
            if here.fix(axis.term, value).is_err() {
                return Vec::new();
            }
        }
        let found = here.solve_isolated(starts).unwrap_or_default();
        let found = found.iter();
        found
            .map(|motion| self.plane.equations.unknowns_of(&motion.point))
            .collect()
    }

    /// The grid point without a motion that is farthest from all motions, in steps to any of the eight
    /// neighbours.
    fn deepest_hole(&self, empty: &[usize]) -> Option<usize> {
        let count = self.plane.axes[0].count;
        let known = |node: usize| !self.motions[node].is_empty() || empty.contains(&node);
        let nodes = self.motions.len();
        let mut depth: Vec<usize> = (0..nodes)
            .map(|node| if known(node) { 0 } else { nodes })
            .collect();
        // Forwards from the preceding neighbours, then backwards from the following ones, which are those that precede
        // in the grid turned about.
        for turned in [false, true] {
            let place = |node: usize| if turned { nodes - 1 - node } else { node };
            for node in 0..nodes {
                let i = node % count;
                let before = [
                    (i > 0).then(|| node - 1),
                    node.checked_sub(count),
                    node.checked_sub(count + 1).filter(|_| i > 0),
                    node.checked_sub(count - 1).filter(|_| i + 1 < count),
                ];
                for other in before.into_iter().flatten() {
                    depth[place(node)] = depth[place(node)].min(depth[place(other)] + 1);
                }
            }
        }
        let deepest = (0..nodes).max_by_key(|&node| depth[node])?;
        (depth[deepest] >= DEEP).then_some(deepest)
    }

    /// Values of the axes at a grid point.
    fn values(&self, node: usize) -> [f64; 2] {
        let [x, y] = &self.plane.axes;
        [
            x.value(node % x.count),
            y.value(self.rows.start + node / x.count),
        ]
    }

    /// The grid points to the right, to the left, above and below.
    fn beside(&self, node: usize) -> [Option<usize>; 4] {
        let count = self.plane.axes[0].count;
        let i = node % count;
        [
            (i + 1 < count).then_some(node + 1),
            (i > 0).then(|| node - 1),
            Some(node + count).filter(|&above| above < self.motions.len()),
            node.checked_sub(count),
        ]
    }

    /// Continues a motion to the next grid point, extrapolated from the one behind.
    fn reach(&mut self, [from, to]: [usize; 2], z: &DVector<f64>, behind: Option<usize>) {
        let behind = behind.and_then(|node| nearest(&self.motions[node], z));
        let ahead = behind.map(|behind| z * 2.0 - behind);
        let (here, there) = (self.values(from), self.values(to));
        let found = ahead.as_ref().and_then(|ahead| {
            let way = (ahead - z).norm();
            // On the same branch a motion is nearer to the extrapolation than to the last motion.
            let expected = |other: &DVector<f64>| (other - ahead).norm() <= 0.5 * way;
            let known = self.motions[to].iter().find(|other| expected(other));
            known.cloned().or_else(|| {
                let found = self.plane.near(there, ahead);
                found.filter(expected)
            })
        });
        let found = found.or_else(|| self.plane.approach(here, z, there));
        self.add(to, found);
    }

    /// Keeps a motion that is new at its grid point.
    fn add(&mut self, node: usize, found: Option<DVector<f64>>) {
        let Some(z) = found else { return };
        let same = |other: &DVector<f64>| (other - &z).norm() <= SAME_AT_POINT * (1.0 + z.norm());
        if !self.motions[node].iter().any(same) {
            self.open.push_back((node, self.motions[node].len()));
            self.motions[node].push(z);
        }
    }
}

/// The motion that is nearest to another one.
pub(crate) fn nearest<'z>(
    motions: &'z [DVector<f64>],
    z: &DVector<f64>,
) -> Option<&'z DVector<f64>> {
    let away = |other: &&DVector<f64>| (*other - z).norm_squared();
    motions.iter().min_by(|a, b| away(a).total_cmp(&away(b)))
}
