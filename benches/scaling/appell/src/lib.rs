//! `void appell_ROBOT_rates(const double *row, double *out)`, and `_jacobians` likewise.
//!
//! A row is state and inputs in the order of the spec. Jacobians return the rates, then A row by row, then B.
//! References to arrays are the pointers of C.

macro_rules! kernels {
    ($module:ident, $rates:ident, $jacobians:ident, $n:literal, $m:literal) => {
        #[allow(non_snake_case, dead_code, missing_docs)]
        mod $module {
            include!(concat!(env!("OUT_DIR"), "/", stringify!($module), ".rs"));
        }

        #[unsafe(no_mangle)]
        pub extern "C" fn $rates(row: &[f64; $n + $m], out: &mut [f64; $n]) {
            let (x, u) = parts::<$n, $m>(row);
            let (x, u) = ($module::State::from(x), $module::Inputs::from(u));
            *out = $module::rates(&$module::Parameters::default(), &x, &u).into();
        }

        #[unsafe(no_mangle)]
        pub extern "C" fn $jacobians(row: &[f64; $n + $m], out: &mut [f64; $n * (1 + $n + $m)]) {
            let (x, u) = parts::<$n, $m>(row);
            let (x, u) = ($module::State::from(x), $module::Inputs::from(u));
            let all = $module::jacobians(&$module::Parameters::default(), &x, &u);
            let (rates, rest) = out.split_at_mut($n);
            let (a, b) = rest.split_at_mut($n * $n);
            rates.copy_from_slice(&<[f64; $n]>::from(all.rates));
            a.copy_from_slice(all.a.map(<[f64; $n]>::from).to_array().as_flattened());
            b.copy_from_slice(all.b.map(<[f64; $m]>::from).to_array().as_flattened());
        }
    };
}

fn parts<const N: usize, const M: usize>(row: &[f64]) -> ([f64; N], [f64; M]) {
    let (x, u) = row.split_at(N);
    let (x, u) = (x.try_into(), u.try_into());
    (x.expect("N numbers"), u.expect("M numbers"))
}

include!(concat!(env!("OUT_DIR"), "/modules.rs"));
