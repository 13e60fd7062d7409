//! The evidence of a hypothesis: the likelihood, averaged over the prior of its parameters (Laplace's method;
//! D. J. C. `MacKay`, *Information Theory, Inference, and Learning Algorithms*, 2003, chapter 28).
//!
//! Effects of different kinds are compared on equal terms because the prior of a size refers to its influence on the
//! recordings, not to its unit: the logarithm of d′, the size in its own standard deviations, is uniform from 1 to a
//! thousand. Levels of measurement and process noise are common to all hypotheses; they are not averaged but maximised.

use std::collections::BTreeMap;
use std::f64::consts::{LN_2, TAU};

use appell_estimate::{Fit, Free, Layout, Unknown};
use nalgebra::{DMatrix, DVector};

use super::Bench;
use super::hardware::LN_1000;
use crate::effects::{Acts, Candidate};

/// Sizes below this many standard deviations cannot be distinguished from zero.
const SMALLEST: f64 = 1.0;

/// A set of candidates, fitted.
#[derive(Debug, Clone)]
pub(super) struct Fitted {
    /// Indices of the candidates; none for the nominal model.
    pub(super) members: Vec<usize>,
    /// Indices of the values.
    pub(super) layout: Layout,
    pub(super) fit: Fit,
    pub(super) evidence: Evidence,
    /// The part of its log evidence by process noise with memory.
    pub(super) coloured: f64,
}

impl Fitted {
    /// Whether the sizes of all members differ from zero by more than a standard deviation.
    pub(super) fn is_there(&self) -> bool {
        self.evidence.smallest > SMALLEST
    }

    /// Whether a size of a member is zero within a standard deviation.
    pub(super) fn is_idle(&self, bench: &Bench<'_>, member: usize) -> bool {
        let setup = bench.setup(&self.members);
        let brought = bench.brought(member, &setup);
        let is_own = |unknown: Unknown| {
            bench.is_wrong(&[member], unknown) || brought.iter().any(|own| own.unknown == unknown)
        };
        let (_, sizes) = Evidence::with_sizes(bench, &self.members, &self.fit, 0.0);
        let mut own = sizes.iter().filter(|(unknown, _)| is_own(*unknown));
        own.any(|(_, size)| *size <= SMALLEST)
    }
}

/// The evidence of a fitted hypothesis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Evidence {
    /// Logarithm of the likelihood at the optimum.
    pub(super) log_likelihood: f64,
    /// Change of that by averaging over the parameters (Occam factor).
    pub(super) occam: f64,
    /// Gain by impulses of feedback inputs.
    pub(super) by_inputs: f64,
    /// Smallest size of a member in its standard deviations.
    pub(super) smallest: f64,
}

impl Evidence {
    pub(super) fn of(bench: &Bench<'_>, members: &[usize], fit: &Fit, by_inputs: f64) -> Self {
        Self::with_sizes(bench, members, fit, by_inputs).0
    }

    /// The same with the sizes of members in their standard deviations.
    fn with_sizes(
        bench: &Bench<'_>,
        members: &[usize],
        fit: &Fit,
        by_inputs: f64,
    ) -> (Self, Vec<(Unknown, f64)>) {
        let is_level = |i: usize| fit.free[i].unknown.is_level();
        let open: Vec<usize> = (0..fit.free.len())
            .filter(|&i| !is_level(i) && !fit.at_limit[i])
            .collect();
        let information = DMatrix::from_fn(open.len(), open.len(), |i, j| {
            fit.information[(open[i], open[j])]
        });
        let (log_volume, deviations) = volume(&information);
        let mut occam = log_volume;
        let mut sizes: Vec<(Unknown, f64)> = Vec::new();
        let own = bench.problem.wanted.len();
        let of_error = |free: &Free, coordinate: f64| {
            let [expected, _] = free
                .prior
                .filter(|_| bench.is_wrong(members, free.unknown))?;
            let error = free.to_value(coordinate) - expected;
            bench.hardware.of_error(free.unknown, error)
        };
        let whole = fit.covariance();
        let mut densities = BTreeMap::new();
        for (place, &i) in open.iter().enumerate() {
            let free = &fit.free[i];
            let density = if let Some((density, times)) = of_error(free, fit.coordinates[i]) {
                sizes.push((free.unknown, times));
                density
            } else if let Some([expected, deviation]) = free.prior {
                let off = (fit.coordinates[i] - free.to_coordinate(expected)) / deviation;
                -0.5 * off * off - deviation.ln() - 0.5 * TAU.ln()
            } else {
                let neutral = if matches!(free.unknown, Unknown::Scale(_)) {
                    1.0
                } else {
                    0.0
                };
                let size = (free.to_value(fit.coordinates[i]) - neutral).abs();
                let in_value = match free.unknown {
                    // The coordinate of a lag, and its deviation, are logarithmic.
                    Unknown::Lag(_) => size * deviations[place],
                    _ => deviations[place],
                };
                // Noise levels may be correlated with the size of a member: its deviation is the marginal one. The
                // last step that was not taken counts as a further error, except over windows, whose likelihood is
                // rough within its tolerance.
                let promised = if bench.is_over_windows() {
                    0.0
                } else {
                    fit.promised[i]
                };
                let left = whole.as_ref().map_or(0.0, |whole| {
                    deviations[place] / whole[(i, i)].sqrt().hypot(promised)
                });
                sizes.push((free.unknown, size / in_value * left));
                // The Jacobian of the coordinate: that of a lag is logarithmic.
                let stretch = (in_value / deviations[place]).ln();
                let two_sided = free.range[0] < neutral;
                let hardware = &bench.hardware;
                hardware.of_size(free.unknown, size, in_value, two_sided) + stretch
            };
            occam += density;
            densities.insert(i, density);
        }
        let groups = groups(bench, members, fit, &densities);
        let of_groups = groups.iter().map(|places| of_group(fit, places));
        occam += of_groups.sum::<f64>();
        // A member whose size is zero, at its limit, is not significant.
        for i in own..fit.free.len() {
            let free = &fit.free[i];
            if fit.at_limit[i] && free.prior.is_none() && !is_level(i) {
                sizes.push((free.unknown, 0.0));
            }
        }
        if members.is_empty() {
            sizes.clear();
        }
        let evidence = Self {
            log_likelihood: fit.log_likelihood,
            occam,
            by_inputs,
            smallest: smallest(bench, members, &sizes),
        };
        (evidence, sizes)
    }

    /// Logarithm of the evidence.
    pub(super) fn log(&self) -> f64 {
        self.log_likelihood + self.by_inputs + self.occam
    }
}

/// The places of the sizes of each effect at a group of signals, with their log prior densities.
fn groups(
    bench: &Bench<'_>,
    members: &[usize],
    fit: &Fit,
    densities: &BTreeMap<usize, f64>,
) -> Vec<Vec<(usize, f64)>> {
    let setup = bench.setup(members);
    let place = |candidate: &Candidate| {
        let free = bench.of_signal(candidate.acts, &setup)?;
        let mut all = fit.free.iter();
        let place = all.position(|own| own.unknown == free.unknown)?;
        Some((place, *densities.get(&place)?))
    };
    let mut groups: BTreeMap<String, Vec<Option<(usize, f64)>>> = BTreeMap::new();
    for candidate in members.iter().map(|&member| bench.candidate(member)) {
        if candidate.is_of_group() && candidate.acts != Acts::Items {
            let group = groups.entry(candidate.name()).or_default();
            group.push(place(candidate));
        }
    }
    // Without one of them a group is none.
    let known = groups.into_values();
    let known = known.filter_map(|group| group.into_iter().collect::<Option<Vec<_>>>());
    known.filter(|group| group.len() > 1).collect()
}

/// Change of the log evidence if the values of a fit with these places and log prior densities may be separate or the
/// same, with the same probability; none if they are not determined. They are sizes of an effect at a group of sites
/// that may be one and the same, such as the delay of all drives or of the position and the rate from one encoder.
fn of_group(fit: &Fit, places: &[(usize, f64)]) -> f64 {
    let covariance = fit.covariance().ok();
    let gain = covariance.and_then(|own| of_common(&fit.coordinates, &own, places));
    gain.map_or(0.0, |gain| {
        gain.max(0.0) + (-gain.abs()).exp().ln_1p() - LN_2
    })
}

/// Log evidence of a common value against separate ones with these places and log prior densities: the ratio of the
/// posterior and prior densities of their differences at zero (J. M. Dickey, *The weighted likelihood ratio, linear
/// hypotheses on normal location parameters*, The Annals of Mathematical Statistics 42, 1971).
fn of_common(
    values: &DVector<f64>,
    covariance: &DMatrix<f64>,
    places: &[(usize, f64)],
) -> Option<f64> {
    let (&(first, _), others) = places.split_first()?;
    let differences = DVector::from_iterator(
        others.len(),
        others
            .iter()
            .map(|&(other, _)| values[other] - values[first]),
    );
    let between = |i: usize, j: usize| {
        let (i, j) = (others[i].0, others[j].0);
        covariance[(i, j)] - covariance[(i, first)] - covariance[(first, j)]
            + covariance[(first, first)]
    };
    let factor = DMatrix::from_fn(others.len(), others.len(), between).cholesky()?;
    let squares = differences.dot(&factor.solve(&differences));
    let posterior = -0.5 * (others.len() as f64 * TAU.ln() + factor.ln_determinant() + squares);
    Some(posterior - others.iter().map(|(_, density)| density).sum::<f64>())
}

/// The smallest size; of an effect at all drives the one that most of them exceed counts, for some may not have it.
fn smallest(bench: &Bench<'_>, members: &[usize], sizes: &[(Unknown, f64)]) -> f64 {
    let of_drives = members.iter().filter(|&&member| {
        let own = bench.candidate(member);
        own.is_of_group() && own.acts == Acts::Items
    });
    let mut sizes = sizes.to_vec();
    let mut medians = Vec::new();
    for &member in of_drives {
        let own = bench.own(bench.candidate(member));
        let is_own = |unknown: Unknown| {
            let mut own = own.iter();
            own.any(|(index, _)| Unknown::Parameter(*index) == unknown)
        };
        let mut all: Vec<f64> = (sizes.iter())
            .filter(|(unknown, _)| is_own(*unknown))
            .map(|(_, size)| *size)
            .collect();
        all.sort_by(f64::total_cmp);
        medians.extend(all.get(all.len().saturating_sub(1) / 2));
        sizes.retain(|(unknown, _)| !is_own(*unknown));
    }
    let others = sizes.into_iter().map(|(_, size)| size);
    others.chain(medians).fold(f64::INFINITY, f64::min)
}

/// Logarithm of the integral of an unnormalised normal density with this information, and its standard deviations.
pub(super) fn volume(information: &DMatrix<f64>) -> (f64, Vec<f64>) {
    let k = information.nrows();
    if k == 0 {
        return (0.0, Vec::new());
    }
    let scale: Vec<f64> = (0..k)
        .map(|i| information[(i, i)].max(f64::MIN_POSITIVE).sqrt())
        .collect();
    let mut scaled = DMatrix::from_fn(k, k, |i, j| information[(i, j)] / (scale[i] * scale[j]));
    for i in 0..k {
        scaled[(i, i)] += 1e-10;
    }
    let Some(factor) = scaled.cholesky() else {
        return (0.0, scale.iter().map(|scale| scale.recip()).collect());
    };
    let log_determinant: f64 = (0..k)
        .map(|i| 2.0 * (factor.l_dirty()[(i, i)].ln() + scale[i].ln()))
        .sum();
    let inverse = factor.inverse();
    let deviations = (0..k).map(|i| inverse[(i, i)].sqrt() / scale[i]);
    (
        0.5 * (k as f64 * TAU.ln() - log_determinant),
        deviations.collect(),
    )
}

/// The evidence for sizes with a normal prior, averaged over its variance.
#[derive(Debug, Clone, Copy)]
pub(super) struct NormalSizes {
    /// Log Bayes factor for them.
    pub(super) log_bayes_factor: f64,
    /// The most likely variance.
    pub(super) variance: f64,
}

impl NormalSizes {
    /// From the Gram matrix of the sensitivities to them and from their scores.
    pub(super) fn of(squares: &DMatrix<f64>, scores: &DVector<f64>) -> Option<Self> {
        /// Number of prior deviations that are averaged, each twice the one before.
        const SIZES: usize = 12;
        if scores.is_empty() {
            return None;
        }
        let eigen = squares.clone().symmetric_eigen();
        let most = eigen.eigenvalues.max();
        if most.is_nan() || most <= 0.0 {
            return None;
        }
        let along = eigen.eigenvectors.tr_mul(scores);
        let log = |variance: f64| -> f64 {
            let pairs = eigen.eigenvalues.iter().zip(along.iter());
            pairs
                .map(|(square, score)| {
                    let grown = 1.0 + variance * square.max(0.0);
                    0.5 * (variance * score * score / grown - grown.ln())
                })
                .sum()
        };
        let variances = (0..SIZES).map(|i| 4.0_f64.powi(i32::try_from(i).unwrap_or(0)) / most);
        let logs: Vec<(f64, f64)> = variances
            .map(|variance| (variance, log(variance)))
            .collect();
        let (variance, _) = *logs.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(Self {
            log_bayes_factor: log_sum(logs.iter().map(|(_, log)| *log)) - (SIZES as f64).ln(),
            variance,
        })
    }
}

/// Logarithm of a sum of exponentials.
pub(super) fn log_sum(logs: impl Iterator<Item = f64> + Clone) -> f64 {
    let most = logs.clone().fold(f64::NEG_INFINITY, f64::max);
    most + logs.map(|log| (log - most).exp()).sum::<f64>().ln()
}

/// The Occam penalty of one size with a given gain.
pub(super) fn occam(gain: f64) -> f64 {
    let d = (2.0 * gain).sqrt().max(SMALLEST);
    (2.0 * d * LN_1000).ln() - 0.5 * TAU.ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two values with unit deviations and uniform priors of width w, by the integrals themselves.
    #[test]
    fn the_ratio_of_densities_is_that_of_the_integrals() {
        let (width, covariance) = (20.0_f64, DMatrix::identity(2, 2));
        for difference in [0.0, 1.0, 4.0] {
            let values = DVector::from_vec(vec![10.0, 10.0 + difference]);
            let places = [(0, -width.ln()), (1, -width.ln())];
            let found = of_common(&values, &covariance, &places).expect("a ratio");
            let (steps, mut common) = (20_000, 0.0);
            for step in 0..steps {
                let x = width * (f64::from(step) + 0.5) / f64::from(steps);
                let squares = (x - values[0]).powi(2) + (x - values[1]).powi(2);
                common += (-0.5 * squares).exp() / f64::from(steps);
            }
            let separate = TAU / width.powi(2);
            let expected = (common / separate).ln();
            assert!((found - expected).abs() < 1e-6, "{found} {expected}");
        }
    }
}
