//! Values of the factors in each case, determined by the number of the case alone.

use crate::distribution::Distribution;
use crate::limits::MAX_CASES;
use crate::normal;
use crate::random::{Permutation, Stream};
use crate::sobol::{self, Coordinate};

/// How the unit cube of the drawn factors is sampled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sampling {
    /// Independent points.
    Random,
    /// A Latin hypercube: each of as many equal parts of every factor once.
    Latin,
    /// Scrambled Sobol points.
    Sobol,
    /// For sensitivity indices: d + 2 cases from each pair A, B of Sobol points in d factors, namely A, B, and A with
    /// one factor of B.
    Sensitivity,
}

impl Sampling {
    /// All, as a study file writes them.
    pub const ALL: [(&'static str, Self); 4] = [
        ("random", Self::Random),
        ("latin", Self::Latin),
        ("sobol", Self::Sobol),
        ("sensitivity", Self::Sensitivity),
    ];

    /// As a study file writes it.
    pub fn word(self) -> &'static str {
        let known = Self::ALL.iter().find(|(_, other)| *other == self);
        known.map_or("", |(word, _)| word)
    }
}

/// How a factor varies.
#[derive(Debug, Clone, PartialEq)]
pub enum Variation {
    /// At random.
    Drawn(Distribution),
    /// All these values, with all values of the other grids.
    Grid(Vec<f64>),
    /// The rows of the table, which all its columns run through together.
    Table(Vec<f64>),
}

/// Variation of a factor.
#[derive(Debug, Clone, PartialEq)]
pub struct Factor {
    /// Its name, from which its random numbers follow.
    pub name: String,
    /// How it varies.
    pub variation: Variation,
}

/// Why a design is impossible.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DesignError {
    /// The correlations contradict each other.
    #[error("the correlations contradict each other: no joint distribution has them")]
    Correlations,
    /// A correlation names a factor that is not drawn.
    #[error("`{name}` is not drawn at random, so that it has no correlation")]
    NotDrawn {
        /// The factor.
        name: String,
    },
    /// Sensitivity indices need independent draws.
    #[error("sensitivity indices need independent factors that are drawn: {0}")]
    NotIndependent(&'static str),
    /// More factors than the sequence has dimensions.
    #[error("{found} factors are too many for Sobol points; at most {most} are possible")]
    Dimensions {
        /// Factors.
        found: usize,
        /// The most.
        most: usize,
    },
    /// More cases than can be numbered.
    #[error("{found} cases are too many; at most {most} are possible with this sampling")]
    Cases {
        /// Requested cases.
        found: u128,
        /// The most.
        most: u64,
    },
    /// The design is empty.
    #[error("there is no case")]
    Empty,
}

/// The values of all cases.
#[derive(Debug, Clone)]
pub struct Design {
    factors: Vec<Factor>,
    sampling: Sampling,
    /// Points; cases for each node of the grids.
    count: u64,
    cases: u64,
    /// The drawn factors.
    drawn: Vec<Drawn>,
    /// Rows of the Cholesky factor of the correlations; empty without any.
    mixing: Vec<Vec<f64>>,
}

#[derive(Debug, Clone)]
struct Drawn {
    factor: usize,
    distribution: Distribution,
    stream: Stream,
    permutation: Permutation,
    /// In point A, and in point B.
    coordinates: Option<[Coordinate; 2]>,
}

impl Design {
    /// `count` points, or as many for each node of the grids and each row of the table. `correlations` are those of
    /// the normal scores of pairs of factors.
    pub fn new(
        factors: Vec<Factor>,
        sampling: Sampling,
        count: u64,
        seed: u64,
        correlations: &[(usize, usize, f64)],
    ) -> Result<Self, DesignError> {
        let is_drawn = |f: &&Factor| matches!(f.variation, Variation::Drawn(_));
        let d = factors.iter().filter(is_drawn).count();
        let dimensions = match sampling {
            Sampling::Random | Sampling::Latin => 0,
            Sampling::Sobol => d,
            Sampling::Sensitivity => 2 * d,
        };
        if dimensions > sobol::MOST_DIMENSIONS {
            let most = sobol::MOST_DIMENSIONS * d / dimensions.max(1);
            return Err(DesignError::Dimensions { found: d, most });
        }
        if sampling == Sampling::Sensitivity {
            independent(&factors, d, correlations)?;
        }
        let cases = count_cases(&factors, sampling, count, d)?;
        let mut drawn = Vec::new();
        for (factor, Factor { name, variation }) in factors.iter().enumerate() {
            let Variation::Drawn(distribution) = variation else {
                continue;
            };
            let stream = Stream::new(seed, name);
            let dimension = drawn.len();
            drawn.push(Drawn {
                factor,
                distribution: distribution.clone(),
                stream,
                permutation: Permutation::new(cases, stream),
                coordinates: (dimensions > 0).then(|| {
                    // Point B has the later dimensions, with an independent scramble.
                    let other = Stream::new(seed, &format!("{name} (B)"));
                    let later = (dimension + d).min(sobol::MOST_DIMENSIONS - 1);
                    [
                        Coordinate::new(dimension, stream),
                        Coordinate::new(later, other),
                    ]
                }),
            });
        }
        let mixing = mixing(&factors, &drawn, correlations)?;
        Ok(Self {
            factors,
            sampling,
            count,
            cases,
            drawn,
            mixing,
        })
    }

    /// Variation of the factors.
    pub fn factors(&self) -> &[Factor] {
        &self.factors
    }

    /// How points are chosen.
    pub fn sampling(&self) -> Sampling {
        self.sampling
    }

    /// The number of cases.
    pub fn cases(&self) -> u64 {
        self.cases
    }

    /// Factors that are drawn, in the order of the factors.
    pub fn drawn(&self) -> impl Iterator<Item = usize> + '_ {
        self.drawn.iter().map(|drawn| drawn.factor)
    }

    /// Whether the values of a case depend on how many there are.
    pub fn depends_on_count(&self) -> bool {
        let has_nodes = self.factors.iter().any(|f| levels(f) > 1);
        self.sampling == Sampling::Latin || (has_nodes && self.count > 1)
    }

    /// The values of the factors in a case.
    pub fn point(&self, case: u64, values: &mut [f64]) {
        let mut node = case / self.count.max(1);
        let mut row = None;
        for (factor, value) in self.factors.iter().zip(values.iter_mut()).rev() {
            let (list, is_table) = match &factor.variation {
                Variation::Grid(list) => (list, false),
                Variation::Table(list) => (list, true),
                Variation::Drawn(_) => continue,
            };
            let count = list.len().max(1) as u64;
            let place = match row {
                Some(row) if is_table => row,
                _ => {
                    let place = node % count;
                    node /= count;
                    place
                }
            };
            if is_table {
                row = Some(place);
            }
            let index = usize::try_from(place).unwrap_or(usize::MAX);
            *value = list.get(index).copied().unwrap_or(f64::NAN);
        }
        for (place, drawn) in self.drawn.iter().enumerate() {
            let u = self.uniform(case, place);
            values[drawn.factor] = drawn.distribution.quantile(u);
        }
    }

    /// The values of the drawn factors at independent normal scores; the others keep theirs.
    pub fn point_at(&self, scores: &[f64], values: &mut [f64]) {
        for (place, drawn) in self.drawn.iter().enumerate() {
            let score = match self.mixing.get(place) {
                None => scores[place],
                Some(row) => row.iter().zip(scores).map(|(w, z)| w * z).sum(),
            };
            values[drawn.factor] = drawn.distribution.at_score(score);
        }
    }

    /// The coordinate of a drawn factor in the unit cube, correlations included.
    fn uniform(&self, case: u64, place: usize) -> f64 {
        match self.mixing.get(place) {
            None => self.independent(case, place),
            Some(row) => {
                let terms = row.iter().enumerate().filter(|(_, weight)| **weight != 0.0);
                let score = terms.fold(0.0, |sum, (other, weight)| {
                    sum + weight * normal::quantile(self.independent(case, other))
                });
                normal::probability(score)
            }
        }
    }

    fn independent(&self, case: u64, place: usize) -> f64 {
        let drawn = &self.drawn[place];
        match (self.sampling, &drawn.coordinates) {
            (Sampling::Latin, _) => {
                let part = drawn.permutation.of(case) as f64;
                (part + drawn.stream.uniform(case, 0)) / self.cases as f64
            }
            (Sampling::Sobol, Some([a, _])) => a.at(case),
            (Sampling::Sensitivity, Some([a, b])) => {
                let d = self.drawn.len() as u64;
                let (point, role) = (case / (d + 2), case % (d + 2));
                if role == 1 || role == 2 + place as u64 {
                    b.at(point)
                } else {
                    a.at(point)
                }
            }
            _ => drawn.stream.uniform(case, 0),
        }
    }
}

/// Values of a factor that is not drawn.
fn levels(factor: &Factor) -> usize {
    match &factor.variation {
        Variation::Drawn(_) => 1,
        Variation::Grid(list) | Variation::Table(list) => list.len(),
    }
}

fn independent(
    factors: &[Factor],
    drawn: usize,
    correlations: &[(usize, usize, f64)],
) -> Result<(), DesignError> {
    let reason = if !correlations.is_empty() {
        "there are correlations"
    } else if drawn < factors.len() {
        "one of the factors is on a grid or in a table"
    } else if drawn == 0 {
        "nothing is drawn"
    } else {
        return Ok(());
    };
    Err(DesignError::NotIndependent(reason))
}

fn count_cases(
    factors: &[Factor],
    sampling: Sampling,
    count: u64,
    drawn: usize,
) -> Result<u64, DesignError> {
    let grids = factors
        .iter()
        .filter(|f| matches!(f.variation, Variation::Grid(_)));
    let nodes = grids.fold(1_u128, |nodes, f| nodes.saturating_mul(levels(f) as u128));
    let table = factors
        .iter()
        .find(|f| matches!(f.variation, Variation::Table(_)));
    let nodes = nodes.saturating_mul(table.map_or(1, levels) as u128);
    let roles = match sampling {
        Sampling::Sensitivity => drawn as u128 + 2,
        _ => 1,
    };
    let found = nodes
        .saturating_mul(u128::from(count))
        .saturating_mul(roles);
    let most = match sampling {
        Sampling::Random | Sampling::Latin => MAX_CASES,
        Sampling::Sobol => sobol::MOST_POINTS.min(MAX_CASES),
        Sampling::Sensitivity => sobol::MOST_POINTS
            .saturating_mul(drawn as u64 + 2)
            .min(MAX_CASES),
    };
    match u64::try_from(found) {
        Ok(0) => Err(DesignError::Empty),
        Ok(cases) if cases <= most => Ok(cases),
        _ => Err(DesignError::Cases { found, most }),
    }
}

/// The lower Cholesky factor of the correlations.
fn mixing(
    factors: &[Factor],
    drawn: &[Drawn],
    correlations: &[(usize, usize, f64)],
) -> Result<Vec<Vec<f64>>, DesignError> {
    if correlations.is_empty() {
        return Ok(Vec::new());
    }
    let n = drawn.len();
    let mut matrix = vec![vec![0.0; n]; n];
    for (i, row) in matrix.iter_mut().enumerate() {
        row[i] = 1.0;
    }
    let place = |factor: usize| {
        let found = drawn.iter().position(|drawn| drawn.factor == factor);
        found.ok_or_else(|| DesignError::NotDrawn {
            name: factors[factor].name.clone(),
        })
    };
    for &(a, b, correlation) in correlations {
        let (a, b) = (place(a)?, place(b)?);
        matrix[a][b] = correlation;
        matrix[b][a] = correlation;
    }
    factor(&matrix).ok_or(DesignError::Correlations)
}

/// Rounding error of a zero pivot.
const NO_PIVOT: f64 = 1e-12;

/// The lower Cholesky factor of a correlation matrix; nothing if it is not positive semidefinite. A variable that
/// depends linearly on earlier ones has a zero pivot, below which the column must vanish within rounding.
fn factor(matrix: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    let n = matrix.len();
    let mut lower = vec![vec![0.0; n]; n];
    for i in 0..n {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| lower[i][k] * lower[j][k]).sum();
            let rest = matrix[i][j] - known;
            lower[i][j] = if i == j {
                if rest < -NO_PIVOT {
                    return None;
                }
                if rest < NO_PIVOT { 0.0 } else { rest.sqrt() }
            } else if lower[j][j] > 0.0 {
                rest / lower[j][j]
            } else if rest.abs() > NO_PIVOT.sqrt() {
                return None;
            } else {
                0.0
            };
        }
    }
    Some(lower)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn symmetric([ab, ac, bc]: [f64; 3]) -> Vec<Vec<f64>> {
        vec![vec![1.0, ab, ac], vec![ab, 1.0, bc], vec![ac, bc, 1.0]]
    }

    #[test]
    fn correlations_that_no_distribution_has_are_refused_and_singular_ones_are_not() {
        // det = 1 + 2 ab ac bc − ab² − ac² − bc² is negative, zero, zero, positive.
        assert_eq!(factor(&symmetric([0.9, 0.9, -0.9])), None);
        assert_eq!(factor(&symmetric([1.0, 0.5, 0.2])), None);
        for singular in [
            [0.6, 0.8, 0.0],
            [1.0, 0.5, 0.5],
            [1.0, 1.0, 1.0],
            [0.1, 0.2, 0.3],
        ] {
            let matrix = symmetric(singular);
            let lower = factor(&matrix).expect("a factor");
            for (i, row) in matrix.iter().enumerate() {
                for (j, wanted) in row.iter().enumerate() {
                    let product: f64 = lower[i].iter().zip(&lower[j]).map(|(a, b)| a * b).sum();
                    assert!((product - wanted).abs() < 1e-6, "{singular:?}");
                }
            }
        }
    }
}
