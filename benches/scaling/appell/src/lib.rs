//! `void appell_ROBOT_rates(const double *x, const double *u, double *out)`, and `_jacobians` likewise.
//!
//! State and inputs follow the specs. Jacobians return the rates, then A row by row, then B. References to
//! arrays are the pointers of C.

macro_rules! kernels {
    ($module:ident, $rates:ident, $jacobians:ident, $n:literal, $m:literal, $size:expr) => {
        #[allow(non_snake_case, dead_code, missing_docs)]
        mod $module {
            include!(concat!(env!("OUT_DIR"), "/", stringify!($module), ".rs"));
        }

        #[unsafe(no_mangle)]
        pub extern "C" fn $rates(x: &[f64; $n], u: &[f64; $m], out: &mut [f64; $n]) {
            let (x, u) = (&$module::State::from(*x), &$module::Inputs::from(*u));
            *out = $module::rates(&$module::Parameters::default(), x, u).into();
        }

        #[unsafe(no_mangle)]
        pub extern "C" fn $jacobians(x: &[f64; $n], u: &[f64; $m], out: &mut [f64; $size]) {
            let (x, u) = (&$module::State::from(*x), &$module::Inputs::from(*u));
            let all = $module::jacobians(&$module::Parameters::default(), x, u);
            let (rates, rest) = out.split_at_mut($n);
            let (a, b) = rest.split_at_mut($n * $n);
            rates.copy_from_slice(&<[f64; $n]>::from(all.rates));
            for (row, values) in a.chunks_exact_mut($n).zip(all.a.to_array()) {
                row.copy_from_slice(&<[f64; $n]>::from(values));
            }
            for (row, values) in b.chunks_exact_mut($m).zip(all.b.to_array()) {
                row.copy_from_slice(&<[f64; $m]>::from(values));
            }
        }
    };
}

include!(concat!(env!("OUT_DIR"), "/modules.rs"));
