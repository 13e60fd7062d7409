//! Sobol's sensitivity indices: which part of the variance a factor is responsible for, alone (first order) and with
//! all others (total).

use crate::random::Stream;

/// Groups of points, of which the bootstrap draws; fewer where many columns have many factors.
const GROUPS: [u64; 2] = [100, 1000];
/// Numbers of all groups of all columns together.
const ROOM: u64 = 1 << 23;
/// Draws of the bootstrap.
const DRAWS: u64 = 1000;

/// An index with its interval of 95 %.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Index {
    /// The estimate.
    pub value: f64,
    /// Its interval.
    pub interval: [f64; 2],
}

/// Indices of a factor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Indices {
    /// First order.
    pub first: Index,
    /// Total.
    pub total: Index,
}

/// Sums over points A, B and A with one factor of B.
#[derive(Debug, Clone)]
pub struct Sums {
    factors: usize,
    points: u64,
    /// Offset subtracted from all values, to avoid cancellation in sums of products.
    shift: f64,
    /// For each group: number, sum, sum of squares of A and B, then both numerators of each factor.
    groups: Vec<Vec<f64>>,
    /// Points with a missing value.
    pub missing: u64,
}

impl Sums {
    /// Of `points` pairs in a number of factors; `shift` is a number near the mean, and so many columns have sums.
    pub fn new(factors: usize, points: u64, shift: f64, columns: usize) -> Self {
        let room = ROOM / ((3 + 2 * factors) * columns.max(1)) as u64;
        // At most a thousand.
        #[allow(clippy::cast_possible_truncation)]
        let groups = points.min(room.clamp(GROUPS[0], GROUPS[1])) as usize;
        Self {
            factors,
            points,
            shift,
            groups: vec![vec![0.0; 3 + 2 * factors]; groups],
            missing: 0,
        }
    }

    /// Adds the values of a point: A, B, and A with each factor of B.
    pub fn add(&mut self, point: u64, values: &[f64]) {
        let place = u128::from(point) * self.groups.len() as u128 / u128::from(self.points.max(1));
        let group = usize::try_from(place).ok();
        let Some(sums) = group.and_then(|group| self.groups.get_mut(group)) else {
            return;
        };
        if values.len() != self.factors + 2 || values.iter().any(|value| !value.is_finite()) {
            self.missing += 1;
            return;
        }
        let [a, b] = [values[0] - self.shift, values[1] - self.shift];
        sums[0] += 1.0;
        sums[1] += a + b;
        sums[2] += a * a + b * b;
        for (factor, mixed) in values[2..].iter().enumerate() {
            let mixed = mixed - self.shift;
            // First order by A. Saltelli et al. (2010), total by M. J. W. Jansen (1999).
            sums[3 + 2 * factor] += b * (mixed - a);
            sums[4 + 2 * factor] += 0.5 * (a - mixed) * (a - mixed);
        }
    }

    /// The indices of all factors; none without variance.
    pub fn indices(&self, seed: u64, name: &str) -> Option<Vec<Indices>> {
        let whole = self.estimate(|_| 1.0)?;
        let stream = Stream::new(seed, &format!("{name} (bootstrap)"));
        let count = self.groups.len() as u64;
        let mut draws: Vec<Vec<f64>> = vec![Vec::new(); whole.len()];
        for draw in 0..DRAWS {
            let mut weights = vec![0.0; self.groups.len()];
            for index in 0..count {
                if let Ok(group) = usize::try_from(stream.below(count, draw, index)) {
                    weights[group] += 1.0;
                }
            }
            let drawn = self.estimate(|group| weights[group]);
            for (list, value) in draws.iter_mut().zip(drawn.into_iter().flatten()) {
                list.push(value);
            }
        }
        let index = |place: usize| {
            let mut list = draws[place].clone();
            list.sort_by(f64::total_cmp);
            // Of a thousand draws.
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            let end = |part: f64| {
                let rank = (part * list.len().saturating_sub(1) as f64).round() as usize;
                list.get(rank).copied().unwrap_or(f64::NAN)
            };
            Index {
                value: whole[place],
                interval: [end(0.025), end(0.975)],
            }
        };
        let indices = (0..self.factors).map(|factor| Indices {
            first: index(2 * factor),
            total: index(2 * factor + 1),
        });
        Some(indices.collect())
    }

    /// First order and total of each factor, with weights of the groups.
    fn estimate(&self, weight: impl Fn(usize) -> f64) -> Option<Vec<f64>> {
        let mut sums = vec![0.0; 3 + 2 * self.factors];
        for (group, own) in self.groups.iter().enumerate() {
            let weight = weight(group);
            for (sum, own) in sums.iter_mut().zip(own) {
                *sum += weight * own;
            }
        }
        let points = sums[0];
        let mean = sums[1] / (2.0 * points);
        let variance = sums[2] / (2.0 * points) - mean * mean;
        (points > 1.0 && variance > 0.0).then(|| {
            sums[3..]
                .iter()
                .map(|sum| sum / points / variance)
                .collect()
        })
    }
}
