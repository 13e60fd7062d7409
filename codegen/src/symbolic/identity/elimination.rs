//! Linear systems in the field.

use super::super::field::Element;

/// Gaussian elimination; `None` for a singular matrix.
pub(super) fn solve(mut a: Vec<Element>, mut b: Vec<Element>) -> Option<Box<[Element]>> {
    let n = b.len();
    for k in 0..n {
        let pivot = (k..n).find(|&i| !a[i * n + k].is_zero())?;
        for j in 0..n {
            a.swap(k * n + j, pivot * n + j);
        }
        b.swap(k, pivot);
        let inverse = a[k * n + k].inverse()?;
        for i in 0..n {
            let factor = a[i * n + k] * inverse;
            if i == k || factor.is_zero() {
                continue;
            }
            for j in k..n {
                a[i * n + j] = a[i * n + j] - factor * a[k * n + j];
            }
            b[i] = b[i] - factor * b[k];
        }
    }
    (0..n)
        .map(|k| Some(b[k] * a[k * n + k].inverse()?))
        .collect()
}
