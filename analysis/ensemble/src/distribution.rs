//! Distributions by their quantiles.

use crate::normal;

/// How a number is distributed.
#[derive(Debug, Clone, PartialEq)]
pub enum Distribution {
    /// Mean and standard deviation.
    Normal([f64; 2]),
    /// Lower and upper end.
    Uniform([f64; 2]),
    /// Median, and the standard deviation of the logarithm.
    Lognormal([f64; 2]),
    /// Lower end, mode, upper end.
    Triangular([f64; 3]),
    /// One of the numbers 0, 1, …, with the probability in proportion to its weight.
    Choice(Vec<f64>),
    /// Another one, truncated to these ends.
    Truncated(Box<Distribution>, [f64; 2]),
}

impl Distribution {
    /// The number below which the part `u` of all lies, 0 < u < 1.
    pub fn quantile(&self, u: f64) -> f64 {
        match self {
            Self::Normal([mean, deviation]) => mean + deviation * normal::quantile(u),
            Self::Uniform([low, high]) => low + (high - low) * u,
            Self::Lognormal([median, deviation]) => {
                median * libm::exp(deviation * normal::quantile(u))
            }
            Self::Triangular([low, mode, high]) => {
                let (left, right) = (mode - low, high - mode);
                if u * (high - low) < left {
                    low + libm::sqrt(u * (high - low) * left)
                } else {
                    high - libm::sqrt((1.0 - u) * (high - low) * right)
                }
            }
            Self::Choice(weights) => {
                let total: f64 = weights.iter().sum();
                let mut left = u * total;
                let chosen = weights.iter().position(|weight| {
                    left -= weight;
                    left < 0.0
                });
                // Rounding may leave the last one.
                chosen.unwrap_or(weights.len().saturating_sub(1)) as f64
            }
            Self::Truncated(whole, [low, high]) => {
                let [from, to] = [whole.probability(*low), whole.probability(*high)];
                whole.quantile(from + (to - from) * u).clamp(*low, *high)
            }
        }
    }

    /// The number at a normal score: as far out as a standard normal number is there.
    pub fn at_score(&self, score: f64) -> f64 {
        match self {
            // No digit of the tail is lost.
            Self::Normal([mean, deviation]) => mean + deviation * score,
            Self::Lognormal([median, deviation]) => median * libm::exp(deviation * score),
            _ => {
                let u = normal::probability(score);
                self.quantile(u.clamp(f64::MIN_POSITIVE, 1.0 - f64::EPSILON / 2.0))
            }
        }
    }

    /// The part of all that lies below a number.
    pub fn probability(&self, x: f64) -> f64 {
        match self {
            Self::Normal([mean, deviation]) if *deviation > 0.0 => {
                normal::probability((x - mean) / deviation)
            }
            Self::Lognormal([median, deviation]) if *deviation > 0.0 => {
                let ratio = x / median;
                if ratio <= 0.0 {
                    0.0
                } else {
                    normal::probability(libm::log(ratio) / deviation)
                }
            }
            Self::Normal([middle, _]) | Self::Lognormal([middle, _]) => {
                f64::from(u8::from(x >= *middle))
            }
            Self::Uniform([low, high]) if high > low => ((x - low) / (high - low)).clamp(0.0, 1.0),
            Self::Uniform([low, _]) => f64::from(u8::from(x >= *low)),
            Self::Triangular([low, mode, high]) => {
                if x <= *low {
                    0.0
                } else if x >= *high {
                    1.0
                } else if x < *mode {
                    (x - low).powi(2) / ((high - low) * (mode - low))
                } else {
                    1.0 - (high - x).powi(2) / ((high - low) * (high - mode))
                }
            }
            Self::Choice(weights) => {
                let total: f64 = weights.iter().sum();
                let below = weights.iter().enumerate().filter(|(i, _)| *i as f64 <= x);
                below.map(|(_, weight)| weight).sum::<f64>() / total
            }
            Self::Truncated(whole, [low, high]) => {
                let [from, to] = [whole.probability(*low), whole.probability(*high)];
                ((whole.probability(x) - from) / (to - from)).clamp(0.0, 1.0)
            }
        }
    }

    /// The part of all between the ends of a truncation; 1 without one.
    pub fn kept(&self) -> f64 {
        match self {
            Self::Truncated(whole, [low, high]) => {
                whole.probability(*high) - whole.probability(*low)
            }
            _ => 1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probability_inverts_the_quantile_of_every_distribution() {
        let normal = Distribution::Normal([65.0, 10.0]);
        for distribution in [
            normal.clone(),
            Distribution::Uniform([-1.0, 3.0]),
            Distribution::Lognormal([2.0, 0.3]),
            Distribution::Triangular([0.0, 1.0, 5.0]),
            Distribution::Truncated(Box::new(normal), [60.0, 90.0]),
        ] {
            for i in 1..100 {
                let u = f64::from(i) / 100.0;
                let back = distribution.probability(distribution.quantile(u));
                assert!((back - u).abs() < 1e-12, "{distribution:?} {u} {back}");
            }
        }
    }

    #[test]
    fn choices_come_in_proportion_to_their_weights() {
        let choice = Distribution::Choice(vec![1.0, 0.0, 3.0]);
        let found: Vec<f64> = [0.1, 0.249, 0.251, 0.999]
            .into_iter()
            .map(|u| choice.quantile(u))
            .collect();
        assert_eq!(found, [0.0, 0.0, 2.0, 2.0]);
    }
}
