//! The probability of a rare event by adaptive multilevel splitting: at each level the lowest particles are replaced
//! by copies of higher ones (F. Cérou and A. Guyader, Stochastic Analysis and Applications 25, 2007; in standard
//! normal space S.-K. Au and J. L. Beck, Probabilistic Engineering Mechanics 16, 2001).
//!
//! Independent replicates give the interval: particles within a replicate have common ancestors.

use crate::normal;
use crate::random::Stream;
use crate::rows::{Column, Role, Rows};
use crate::run::{Engine, Watch};
use crate::statistics::beta::student_95;
use std::ops::Range;

/// A function of independent standard normal numbers; the event is that it is positive.
pub trait Landscape: Sync {
    /// How many numbers.
    fn dimension(&self) -> usize;
    /// The function at several points.
    fn heights(&self, scores: &[Vec<f64>]) -> Vec<f64>;
}

/// Metropolis steps of a copied particle.
const MOVES: usize = 10;
/// Reciprocal of the fraction of particles replaced at a level.
const LOWEST: usize = 4;
/// Points evaluated together, between which a replicate may be cancelled.
const TOGETHER: usize = 64;
/// Limit on levels; the probability is then below 1e-100.
const MOST_LEVELS: usize = 1000;
/// Replicates of a splitting.
pub const REPLICATES: u64 = 10;
/// The fewest particles of a replicate.
pub const LEAST_PARTICLES: usize = 20;

/// The columns of replicates.
pub fn columns() -> Vec<Column> {
    let column = |name: &str, about: &str| Column {
        name: name.to_owned(),
        about: about.to_owned(),
        unit: String::new(),
        scale: 1.0,
        role: Role::Value,
    };
    vec![
        column("probability", "estimate of a replicate"),
        column("evaluations", "motions of a replicate"),
    ]
}

/// Replicates as cases: a row has the estimate and the number of evaluations.
pub struct Splitting<'a> {
    landscape: &'a dyn Landscape,
    particles: usize,
    stream: Stream,
    columns: Vec<Column>,
}

impl<'a> Splitting<'a> {
    /// With this many particles in each replicate.
    pub fn new(landscape: &'a dyn Landscape, particles: usize, seed: u64) -> Self {
        Self {
            landscape,
            particles: particles.max(LEAST_PARTICLES),
            stream: Stream::new(seed, "(splitting)"),
            columns: columns(),
        }
    }

    /// The estimate of a replicate and its evaluations; nothing if cancelled.
    fn climb(&self, replicate: u64, watch: &Watch<'_>) -> Option<[f64; 2]> {
        let mut draws = Draws {
            stream: self.stream,
            replicate,
            next: 0,
        };
        let (n, d) = (self.particles, self.landscape.dimension());
        let mut evaluations = 0_u64;
        let mut heights = |all: &[Vec<f64>]| -> Option<Vec<f64>> {
            let mut heights = Vec::with_capacity(all.len());
            for some in all.chunks(TOGETHER) {
                if !(watch.go_on)() {
                    return None;
                }
                evaluations += some.len() as u64;
                heights.extend(self.landscape.heights(some));
            }
            for height in heights.iter_mut().filter(|height| height.is_nan()) {
                *height = f64::NEG_INFINITY;
            }
            Some(heights)
        };
        let start: Vec<Vec<f64>> = (0..n)
            .map(|_| (0..d).map(|_| draws.normal()).collect())
            .collect();
        let mut particles: Vec<(f64, Vec<f64>)> = heights(&start)?.into_iter().zip(start).collect();
        let (mut probability, mut stride) = (1.0, 0.5_f64);
        for _ in 0..MOST_LEVELS {
            particles.sort_by(|a, b| a.0.total_cmp(&b.0));
            let level = particles[(n / LOWEST).max(1) - 1].0;
            if level > 0.0 {
                break;
            }
            let low = particles.partition_point(|particle| particle.0 <= level);
            if low == n {
                // All particles are at the same level: no progress is possible.
                probability = 0.0;
                break;
            }
            probability *= 1.0 - low as f64 / n as f64;
            let (mut tried, mut taken) = (0_u32, 0_u32);
            for particle in 0..low {
                let parent = low + draws.below(n - low);
                particles[particle] = particles[parent].clone();
            }
            let keep = (1.0 - stride * stride).sqrt();
            for _ in 0..MOVES {
                let mut near = |(_, scores): &(f64, Vec<f64>)| -> Vec<f64> {
                    let scores = scores.iter();
                    scores.map(|z| keep * z + stride * draws.normal()).collect()
                };
                let proposed: Vec<Vec<f64>> = particles[..low].iter().map(&mut near).collect();
                let reached = heights(&proposed)?;
                for (particle, proposed) in
                    particles.iter_mut().zip(reached.into_iter().zip(proposed))
                {
                    tried += 1;
                    if proposed.0 > level {
                        taken += 1;
                        *particle = proposed;
                    }
                }
            }
            let part = f64::from(taken) / f64::from(tried.max(1));
            if part < 0.25 {
                stride *= 0.8;
            } else if part > 0.45 {
                stride = (stride * 1.25).min(1.0);
            }
        }
        let above = particles.iter().filter(|particle| particle.0 > 0.0).count();
        probability *= above as f64 / n as f64;
        Some([probability, evaluations as f64])
    }
}

/// Random numbers of a replicate, one after the other.
struct Draws {
    stream: Stream,
    replicate: u64,
    next: u64,
}

impl Draws {
    fn place(&mut self) -> u64 {
        self.next += 1;
        self.next
    }

    fn normal(&mut self) -> f64 {
        let place = self.place();
        normal::quantile(self.stream.uniform(self.replicate, place))
    }

    fn below(&mut self, count: usize) -> usize {
        let place = self.place();
        let below = self.stream.below(count as u64, self.replicate, place);
        usize::try_from(below).unwrap_or(0)
    }
}

impl Engine for Splitting<'_> {
    fn columns(&self) -> &[Column] {
        &self.columns
    }

    fn run(&self, cases: Range<u64>, watch: &Watch<'_>, rows: &mut Rows) {
        for replicate in cases {
            let Some(row) = self.climb(replicate, watch) else {
                return;
            };
            rows.push(&row, 0.0, "");
            (watch.done)(1);
        }
    }
}

/// The probability of a rare event.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Probability {
    /// The estimate, whose mean is the probability.
    pub value: f64,
    /// An interval of 95 %, from the spread of the replicates.
    pub interval: [f64; 2],
    /// Motions that it took.
    pub evaluations: f64,
}

impl Probability {
    /// From the rows of all replicates.
    pub fn new(rows: &Rows) -> Option<Self> {
        let [values, evaluations] = &rows.values[..] else {
            return None;
        };
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
        if values.len() < 2 {
            return None;
        }
        let error = (squares / (n - 1.0) / n).sqrt();
        // In the logarithm, so that no end is negative.
        let factor = libm::exp(student_95(n - 1.0) * error / mean);
        let interval = if mean > 0.0 {
            [mean / factor, (mean * factor).min(1.0)]
        } else {
            [0.0, 1.0]
        };
        Some(Self {
            value: mean,
            interval,
            evaluations: evaluations.iter().sum(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sum of ten normal numbers over √10 is one.
    struct Plane(f64);

    impl Landscape for Plane {
        fn dimension(&self) -> usize {
            10
        }

        fn heights(&self, scores: &[Vec<f64>]) -> Vec<f64> {
            let height = |scores: &Vec<f64>| scores.iter().sum::<f64>() / 10_f64.sqrt() - self.0;
            scores.iter().map(height).collect()
        }
    }

    #[test]
    fn the_probability_beyond_a_plane_is_found() {
        let plane = Plane(5.0);
        let watch = Watch {
            go_on: &|| true,
            done: &|_| {},
        };
        let mut rows = Rows::new(0, 2, 10);
        Splitting::new(&plane, 200, 1).run(0..REPLICATES, &watch, &mut rows);
        let found = Probability::new(&rows).expect("ten replicates");
        let known = normal::probability(-5.0);
        let [low, high] = found.interval;
        // One interval of twenty misses; by little.
        assert!(
            low / 1.5 < known && known < 1.5 * high,
            "{found:?} {known:e}"
        );
        assert!(high / low < 4.0, "{found:?}");
    }
}
