//! Balancing and the Hessenberg form, both in place, row by row.

/// Clears entries that are negligible relative to the largest one and whose squares would underflow.
pub(super) fn drop_negligible(a: &mut [f64]) {
    const NOTHING: f64 = 1e-60;
    let largest = a.iter().map(|entry| entry.abs()).fold(0.0, f64::max);
    let small = |entry: &&mut f64| entry.abs() <= NOTHING * largest;
    a.iter_mut().filter(small).for_each(|entry| *entry = 0.0);
}

/// Makes rows and columns of similar size by a diagonal similarity of powers of two, which rounds
/// nothing (Parlett and Reinsch, Numerische Mathematik 13, 1969).
pub(super) fn balance(a: &mut [f64], n: usize) {
    /// Sums that fall by less are not worth another round.
    const GAIN: f64 = 0.95;
    loop {
        let mut changed = false;
        for i in 0..n {
            let others = || (0..n).filter(|&j| j != i);
            let mut column: f64 = others().map(|j| a[j * n + i].abs()).sum();
            let row: f64 = others().map(|j| a[i * n + j].abs()).sum();
            if column == 0.0 || row == 0.0 {
                continue;
            }
            let (before, mut scale) = (column + row, 1.0);
            while column < row / 2.0 {
                (column, scale) = (column * 4.0, scale * 2.0);
            }
            while column > row * 2.0 {
                (column, scale) = (column / 4.0, scale / 2.0);
            }
            // Both sums in the unit of the row.
            if (column + row) / scale < GAIN * before {
                changed = true;
                for j in 0..n {
                    a[i * n + j] /= scale;
                    a[j * n + i] *= scale;
                }
            }
        }
        if !changed {
            return;
        }
    }
}

/// Zeros below the first subdiagonal by reflections of Householder.
pub(super) fn reduce(a: &mut [f64], n: usize, reflector: &mut [f64]) {
    for k in 1..n.saturating_sub(1) {
        let below = (k + 1..n).map(|i| a[i * n + k - 1].abs());
        if below.sum::<f64>() == 0.0 {
            continue;
        }
        // v = x ± ‖x‖ e, with the sign that cancels nothing.
        let largest = (k..n).map(|i| a[i * n + k - 1].abs()).fold(0.0, f64::max);
        let mut square = 0.0;
        for i in k..n {
            reflector[i] = a[i * n + k - 1] / largest;
            square += reflector[i] * reflector[i];
        }
        let length = square.sqrt().copysign(reflector[k]);
        let half = square + length * reflector[k];
        reflector[k] += length;
        for j in k - 1..n {
            let along: f64 = (k..n).map(|i| reflector[i] * a[i * n + j]).sum();
            for i in k..n {
                a[i * n + j] -= along / half * reflector[i];
            }
        }
        for i in 0..n {
            let along: f64 = (k..n).map(|j| a[i * n + j] * reflector[j]).sum();
            for j in k..n {
                a[i * n + j] -= along / half * reflector[j];
            }
        }
        for i in k + 1..n {
            a[i * n + k - 1] = 0.0;
        }
    }
}
