//! Quantiles of χ² (M. Abramowitz and I. Stegun, *Handbook of Mathematical Functions*, chapters 6
//! and 26).

/// Half the width of a 95 % interval of a normal distribution, in standard deviations.
pub const HALF_WIDTH_95: f64 = 1.959_963_984_540_054;
/// Largest number of terms of a series or a continued fraction.
const MOST_TERMS: usize = 100_000;

/// The `p` quantile of χ² with `freedom` degrees of freedom, to about twelve digits; NaN outside
/// 0 < p < 1 and without degrees of freedom.
pub fn chi_squared_quantile(p: f64, freedom: f64) -> f64 {
    if !(p > 0.0 && p < 1.0 && freedom > 0.0) {
        return f64::NAN;
    }
    let (mut low, mut high) = (0.0, freedom.max(1.0));
    while chi_squared_probability(high, freedom) < p {
        (low, high) = (high, 2.0 * high);
    }
    // Bisection is robust, and fifty halvings reach rounding.
    for _ in 0..60 {
        let middle = f64::midpoint(low, high);
        if chi_squared_probability(middle, freedom) < p {
            low = middle;
        } else {
            high = middle;
        }
    }
    f64::midpoint(low, high)
}

/// Probability that χ² with `freedom` degrees of freedom stays below `x`.
pub fn chi_squared_probability(x: f64, freedom: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    let (a, x) = (0.5 * freedom, 0.5 * x);
    let density = (a * x.ln() - x - log_gamma(a)).exp();
    if x < a + 1.0 {
        density * series(a, x)
    } else {
        1.0 - density * fraction(a, x)
    }
}

/// Σ xᵏ / (a (a + 1) … (a + k)).
fn series(a: f64, x: f64) -> f64 {
    let (mut term, mut sum) = (1.0 / a, 1.0 / a);
    for k in 1..MOST_TERMS {
        term *= x / (a + k as f64);
        sum += term;
        if term < 1e-17 * sum {
            break;
        }
    }
    sum
}

/// The continued fraction of the upper tail, by the method of Lentz.
fn fraction(a: f64, x: f64) -> f64 {
    let mut b = x + 1.0 - a;
    let (mut c, mut d) = (1e300, 1.0 / b);
    let mut product = d;
    for k in 1..MOST_TERMS {
        let k = k as f64;
        let weight = k * (a - k);
        b += 2.0;
        d = 1.0 / (weight * d + b);
        c = b + weight / c;
        product *= c * d;
        if (c * d - 1.0).abs() < 1e-16 {
            break;
        }
    }
    product
}

/// ln Γ(a) for a > 0: Stirling's series after a shift beyond 12.
fn log_gamma(a: f64) -> f64 {
    let (mut shifted, mut product) = (a, 1.0);
    while shifted < 12.0 {
        product *= shifted;
        shifted += 1.0;
    }
    let square = 1.0 / (shifted * shifted);
    let correction =
        (1.0 / 12.0 - square * (1.0 / 360.0 - square * (1.0 / 1260.0 - square / 1680.0))) / shifted;
    let half_log_tau = 0.5 * std::f64::consts::TAU.ln();
    (shifted - 0.5) * shifted.ln() - shifted + half_log_tau + correction - product.ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        // Table 26.8 of the handbook.
        let table = [
            (0.95, 1.0, 3.841_458_820_694_124),
            (0.99, 2.0, 9.210_340_371_976_18),
            (0.005, 10.0, 2.155_856_481_304_6),
            (0.995, 100.0, 140.169_489_441_5),
        ];
        for (p, freedom, wanted) in table {
            let got = chi_squared_quantile(p, freedom);
            assert!(
                (got - wanted).abs() < 1e-8 * wanted,
                "{got} against {wanted}"
            );
        }
    }

    #[test]
    fn many_degrees_of_freedom_are_normal() {
        // Wilson and Hilferty's approximation, which is good to five digits there.
        let freedom = 2e4_f64;
        let part = 2.0 / (9.0 * freedom);
        let wanted = freedom * (1.0 - part + 2.575_829_303_548_9 * part.sqrt()).powi(3);
        let got = chi_squared_quantile(0.995, freedom);
        assert!(
            (got - wanted).abs() < 1e-5 * wanted,
            "{got} against {wanted}"
        );
    }

    #[test]
    fn nonsense_has_no_quantile() {
        assert!(chi_squared_quantile(1.0, 3.0).is_nan());
        assert!(chi_squared_quantile(0.5, 0.0).is_nan());
    }
}
