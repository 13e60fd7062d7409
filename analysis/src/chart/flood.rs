//! A grid over a plane, filled from motions that are known: each spreads to the places beside it.
//!
//! Over one place several motions may lie, on sheets that meet in folds. A sheet is filled as far as
//! it goes from one of its motions.

use std::collections::VecDeque;
use std::ops::Range;

use nalgebra::DVector;

use super::plane::Plane;
use crate::steady::SteadyProblem;

/// Motions of some rows of the grid.
pub(crate) struct Flood<'a> {
    plane: &'a Plane<'a>,
    rows: Range<usize>,
    /// Those of each place, the horizontal quantity running fastest.
    pub(crate) motions: Vec<Vec<DVector<f64>>>,
    /// Place and number of those that have not spread yet.
    open: VecDeque<(usize, usize)>,
}

/// Motions of one place that differ by less, relative to their size, are the same.
const SAME: f64 = 1e-5;
/// Holes that are sought in vain before the rest is taken for empty.
const MOST_PROBES: usize = 8;
/// Starting points in a hole at most.
const PROBE_STARTS: usize = 20;
/// A hole is this many places away from what is known; nearer ones are edges.
const DEEP: usize = 3;

impl<'a> Flood<'a> {
    /// Nothing yet.
    pub(crate) fn over(plane: &'a Plane<'a>, rows: Range<usize>) -> Self {
        let places = rows.len() * plane.axes[0].count;
        Self {
            plane,
            rows,
            motions: vec![Vec::new(); places],
            open: VecDeque::new(),
        }
    }

    pub(crate) fn first_row(&self) -> usize {
        self.rows.start
    }

    /// Of bands of rows that follow each other; their edges are to spread again.
    pub(crate) fn joined(plane: &'a Plane<'a>, bands: Vec<Self>) -> Self {
        let mut all = Self::over(plane, 0..plane.axes[1].count);
        let count = plane.axes[0].count;
        let mut motions = Vec::with_capacity(all.motions.len());
        for band in bands {
            let edges = [band.rows.start, band.rows.end - 1];
            for place in edges.into_iter().flat_map(|j| j * count..(j + 1) * count) {
                let own = place - band.rows.start * count;
                all.open
                    .extend((0..band.motions[own].len()).map(|motion| (place, motion)));
            }
            motions.extend(band.motions);
        }
        all.motions = motions;
        all
    }

    /// Takes a motion from anywhere to the nearest place, if that is in these rows.
    pub(crate) fn seed(&mut self, z: &DVector<f64>) {
        let from = self.plane.place(z);
        let [i, j] = [0, 1].map(|k: usize| self.plane.axes[k].nearest(from[k]));
        if let Some(row) = j.checked_sub(self.rows.start).filter(|_| j < self.rows.end) {
            let place = row * self.plane.axes[0].count + i;
            let found = self.plane.approach(from, z, self.values(place));
            self.add(place, found);
        }
    }

    /// Spreads until nothing further is reached.
    pub(crate) fn spread(&mut self) {
        while let Some((place, motion)) = self.open.pop_front() {
            let z = self.motions[place][motion].clone();
            let beside = self.beside(place);
            for (to, behind) in [(0, 1), (1, 0), (2, 3), (3, 2)] {
                if let Some(to) = beside[to] {
                    self.reach([place, to], &z, beside[behind]);
                }
            }
        }
    }

    /// Seeks motions from many starting points where nothing is known.
    pub(crate) fn fill_holes(&mut self, problem: &SteadyProblem<'_>, starts: usize) {
        let mut vain = Vec::new();
        while vain.len() < MOST_PROBES
            && let Some(place) = self.deepest_hole(&vain)
        {
            let found = self.probe(problem, place, starts.min(PROBE_STARTS));
            if found.is_empty() {
                vain.push(place);
            }
            for z in found {
                self.add(place, Some(z));
            }
            self.spread();
        }
    }

    fn probe(&self, problem: &SteadyProblem<'_>, place: usize, starts: usize) -> Vec<DVector<f64>> {
        let mut here = problem.clone();
        for (axis, value) in self.plane.axes.iter().zip(self.values(place)) {
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

    /// The place without a motion that is farthest from all others, by steps to any of the eight
    /// places around.
    fn deepest_hole(&self, vain: &[usize]) -> Option<usize> {
        let count = self.plane.axes[0].count;
        let known = |place: usize| !self.motions[place].is_empty() || vain.contains(&place);
        let places = self.motions.len();
        let mut depth: Vec<usize> = (0..places)
            .map(|place| if known(place) { 0 } else { places })
            .collect();
        // From the first place to the last by what lies before, and back by what lies behind.
        for place in 0..places {
            let i = place % count;
            let before = [
                (i > 0).then(|| place - 1),
                place.checked_sub(count),
                place.checked_sub(count + 1).filter(|_| i > 0),
                place.checked_sub(count - 1).filter(|_| i + 1 < count),
            ];
            for other in before.into_iter().flatten() {
                depth[place] = depth[place].min(depth[other] + 1);
            }
        }
        for place in (0..places).rev() {
            let i = place % count;
            let after = [
                (i + 1 < count).then_some(place + 1),
                Some(place + count),
                (i + 1 < count).then_some(place + count + 1),
                (i > 0).then(|| place + count - 1),
            ];
            for other in after.into_iter().flatten().filter(|&other| other < places) {
                depth[place] = depth[place].min(depth[other] + 1);
            }
        }
        let deepest = (0..places).max_by_key(|&place| depth[place])?;
        (depth[deepest] >= DEEP).then_some(deepest)
    }

    /// Values of the axes at a place.
    fn values(&self, place: usize) -> [f64; 2] {
        let [x, y] = &self.plane.axes;
        [
            x.value(place % x.count),
            y.value(self.rows.start + place / x.count),
        ]
    }

    /// The places to the right, to the left, above and below.
    fn beside(&self, place: usize) -> [Option<usize>; 4] {
        let count = self.plane.axes[0].count;
        let i = place % count;
        [
            (i + 1 < count).then_some(place + 1),
            (i > 0).then(|| place - 1),
            Some(place + count).filter(|&above| above < self.motions.len()),
            place.checked_sub(count),
        ]
    }

    /// Takes a motion from a place to the next one. What lies behind tells where it will be.
    fn reach(&mut self, [from, to]: [usize; 2], z: &DVector<f64>, behind: Option<usize>) {
        let behind = behind.and_then(|place| nearest(&self.motions[place], z));
        let ahead = behind.map(|behind| z * 2.0 - behind);
        let (here, there) = (self.values(from), self.values(to));
        let found = ahead.as_ref().and_then(|ahead| {
            let way = (ahead - z).norm();
            // On the same sheet a motion is nearer to where it was expected than to the last one.
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

    /// Keeps a motion that is new at its place.
    fn add(&mut self, place: usize, found: Option<DVector<f64>>) {
        let Some(z) = found else { return };
        let same = |other: &DVector<f64>| (other - &z).norm() <= SAME * (1.0 + z.norm());
        if !self.motions[place].iter().any(same) {
            self.open.push_back((place, self.motions[place].len()));
            self.motions[place].push(z);
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
