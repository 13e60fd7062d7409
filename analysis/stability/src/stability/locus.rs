//! Modes tracked along a branch, through crossings of their eigenvalues.

use super::Stability;
use appell_spectra::spectrum::{Complex, Mode};

/// Eigenvalues along a branch, one list per mode: the k-th entry of each belongs to the k-th point.
///
/// From point to point a mode is matched by its eigenvalue and its eigenvector. Modes that a point
/// does not have are NaN there.
pub fn loci<'a>(points: impl IntoIterator<Item = &'a Stability>) -> Vec<Vec<Complex<f64>>> {
    let missing = Complex::new(f64::NAN, f64::NAN);
    let mut loci: Vec<Vec<Complex<f64>>> = Vec::new();
    // The last mode of each list.
    let mut last: Vec<Option<&Mode>> = Vec::new();
    for (count, point) in points.into_iter().enumerate() {
        let modes: Vec<&Mode> = point
            .deciding
            .iter()
            .map(|&m| &point.spectrum.modes[m])
            .collect();
        let unit = point.spectrum.norm.max(f64::MIN_POSITIVE);
        let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
        for (i, from) in last.iter().enumerate() {
            let distances = modes.iter().enumerate();
            pairs
                .extend(distances.filter_map(|(j, to)| Some((distance((*from)?, to, unit), i, j))));
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut next: Vec<Option<&Mode>> = vec![None; last.len()];
        let mut taken = vec![false; modes.len()];
        for (_, i, j) in pairs {
            if next[i].is_none() && !taken[j] {
                next[i] = Some(modes[j]);
                taken[j] = true;
            }
        }
        for (mode, _) in modes.iter().zip(&taken).filter(|(_, taken)| !**taken) {
            loci.push(vec![missing; count]);
            last.push(None);
            next.push(Some(mode));
        }
        for (i, locus) in loci.iter_mut().enumerate() {
            locus.push(next[i].map_or(missing, |mode| mode.value));
            // A list that has ended is not resumed.
            last[i] = next[i];
        }
    }
    loci
}

/// Distance of two modes: eigenvalues relative to the matrix, and the angle between eigenvectors.
fn distance(from: &Mode, to: &Mode, unit: f64) -> f64 {
    let alike = if from.right.len() == to.right.len() {
        from.right.dotc(&to.right).norm()
    } else {
        0.0
    };
    10.0 * (from.value - to.value).norm() / unit + (1.0 - alike)
}
