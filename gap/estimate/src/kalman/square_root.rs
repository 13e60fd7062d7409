//! Square roots S of covariances, P = S Sᵀ, so that P is symmetric and positive semidefinite by
//! construction (G. J. Bierman, *Factorization Methods for Discrete Sequential Estimation*, 1977).

use crate::matrix::{add_scaled, dot};

/// The lower triangular L with L Lᵀ = R Rᵀ, by Householder reflections of the columns of R.
///
/// `rows` holds R, n rows of at least n entries each, and is overwritten; `factor` becomes L, n ×
/// n.
pub(crate) fn triangularise(rows: &mut [f64], n: usize, factor: &mut [f64]) {
    let width = rows.len() / n;
    factor.fill(0.0);
    for i in 0..n {
        let (upper, below) = rows.split_at_mut((i + 1) * width);
        let mirror = &mut upper[i * width + i..];
        let length = dot(mirror, mirror).sqrt();
        // The sign that avoids cancellation.
        let pivot = if mirror[0] > 0.0 { -length } else { length };
        // Directions that have died out, whose squares are no numbers any more, are as none.
        let scale = (pivot * (mirror[0] - pivot)).recip();
        if scale.is_finite() {
            mirror[0] -= pivot;
            for row in below.chunks_exact_mut(width) {
                let along = scale * dot(mirror, &row[i..]);
                add_scaled(along, mirror, &mut row[i..]);
            }
        }
        factor[i * n + i] = pivot;
        for (row, below) in below.chunks_exact(width).enumerate() {
            factor[(i + 1 + row) * n + i] = below[i];
        }
    }
}

/// S after a measurement with noise variance `r` (J. E. Potter, 1963): P⁺ = P − a aᵀ/s with
/// a = P c and s = cᵀ P c + r. `projection` is Sᵀ c, and `a` is P c = S Sᵀ c.
pub(crate) fn potter(root: &mut [f64], projection: &[f64], a: &[f64], s: f64, r: f64) {
    let n = a.len();
    let weight = 1.0 / (s * (1.0 + (r / s).sqrt()));
    for (row, &a) in root.chunks_exact_mut(n).zip(a) {
        add_scaled(-weight * a, projection, row);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::matrix::multiply_transposed;

    fn covariance(root: &[f64], n: usize) -> Vec<f64> {
        let mut p = vec![0.0; n * n];
        multiply_transposed(root, root, root.len() / n, &mut p);
        p
    }

    #[test]
    fn a_triangular_root_has_the_covariance_of_the_wide_one() {
        let wide = [
            1.0, -2.0, 0.5, 0.25, 3.0, 1.0, -1.0, 2.0, 0.0, 0.0, 1.5, -0.5,
        ];
        let mut factor = [0.0; 9];
        triangularise(&mut wide.clone(), 3, &mut factor);
        for (got, wanted) in covariance(&factor, 3).iter().zip(covariance(&wide, 3)) {
            assert!((got - wanted).abs() < 1e-14, "{got} against {wanted}");
        }
        assert!(factor[1] == 0.0 && factor[2] == 0.0 && factor[5] == 0.0);
    }

    #[test]
    fn a_root_of_zeros_stays_one() {
        let mut factor = [1.0; 4];
        triangularise(&mut [0.0; 6], 2, &mut factor);
        assert!(factor.iter().all(|&entry| entry == 0.0));
    }

    #[test]
    fn directions_that_have_died_out_are_as_none() {
        for size in [1e-150, 1e-160, 1e-200, 1e-320] {
            let mut factor = [1.0; 4];
            triangularise(&mut [size, size, 1.0, 2.0], 2, &mut factor);
            let length = f64::hypot(factor[2], factor[3]);
            assert!(
                (length - 5.0_f64.sqrt()).abs() < 1e-12,
                "{size}: {factor:?}"
            );
        }
    }

    #[test]
    fn potters_update_takes_from_the_covariance_what_was_measured() {
        let (mut root, c, r) = ([2.0, 0.0, 1.0, 0.5], [1.0, -1.0], 0.3);
        let p = covariance(&root, 2);
        let projection = [
            root[0] * c[0] + root[2] * c[1],
            root[1] * c[0] + root[3] * c[1],
        ];
        let a = [p[0] * c[0] + p[1] * c[1], p[2] * c[0] + p[3] * c[1]];
        let s = a[0] * c[0] + a[1] * c[1] + r;
        potter(&mut root, &projection, &a, s, r);
        let after = covariance(&root, 2);
        for i in 0..2 {
            for j in 0..2 {
                let wanted = p[i * 2 + j] - a[i] * a[j] / s;
                assert!((after[i * 2 + j] - wanted).abs() < 1e-14);
            }
        }
    }
}
