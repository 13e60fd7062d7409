//! `void appell_KERNEL(const double *x, const double *u, const double *p, double *out)` for every kernel.
//!
//! State, inputs and parameters follow the specs; results stand one after the other, row by row.
//! References to arrays are the pointers of C.

macro_rules! emitted {
    ($($name:ident),*) => {$(
        #[allow(non_snake_case, dead_code, missing_docs)]
        mod $name {
            include!(concat!(env!("OUT_DIR"), "/", stringify!($name), ".rs"));
        }
    )*};
}
emitted!(
    unicycle_rates,
    unicycle_jacobians,
    euc_rates,
    euc_jacobians,
    bicycle_equations,
    bicycle_state,
    bicycle_parameters
);

/// What the build script tells: kernel, seconds, operations.
#[unsafe(no_mangle)]
pub static APPELL_TOLD: &[u8; include_bytes!(concat!(env!("OUT_DIR"), "/told.tsv")).len()] =
    include_bytes!(concat!(env!("OUT_DIR"), "/told.tsv"));

/// Rows of a Jacobian as an array.
macro_rules! rows {
    ($matrix:expr, $columns:literal) => {
        &$matrix.map(<[f64; $columns]>::from).to_array()
    };
}

macro_rules! kernel {
    ($symbol:ident, $module:ident, [$n:literal, $m:literal, $k:literal] -> $size:literal,
     |$p:ident, $x:ident, $u:ident, $out:ident| $body:block) => {
        #[unsafe(no_mangle)]
        pub extern "C" fn $symbol(
            x: &[f64; $n],
            u: &[f64; $m],
            p: &[f64; $k],
            $out: &mut [f64; $size],
        ) {
            let ($p, $x, $u) = (
                &$module::Parameters::from(*p),
                &$module::State::from(*x),
                &$module::Inputs::from(*u),
            );
            $body
        }
    };
}

/// Rates, A and B, the two side by side in every row.
fn lay<const N: usize, const M: usize>(
    out: &mut [f64],
    rates: [f64; N],
    a: &[[f64; N]; N],
    b: &[[f64; M]; N],
) {
    let (first, rest) = out.split_at_mut(N);
    first.copy_from_slice(&rates);
    for (row, (a, b)) in rest.chunks_exact_mut(N + M).zip(a.iter().zip(b)) {
        row[..N].copy_from_slice(a);
        row[N..].copy_from_slice(b);
    }
}

kernel!(appell_unicycle_rates, unicycle_rates, [10, 1, 4] -> 10, |p, x, u, out| {
    *out = unicycle_rates::rates(p, x, u).into();
});
kernel!(appell_unicycle_jacobians, unicycle_jacobians, [10, 1, 4] -> 120, |p, x, u, out| {
    let j = unicycle_jacobians::jacobians(p, x, u);
    lay(out, j.rates.into(), rows!(j.a, 10), rows!(j.b, 1));
});
kernel!(appell_euc_rates, euc_rates, [6, 2, 11] -> 6, |p, x, u, out| {
    *out = euc_rates::rates(p, x, u).into();
});
kernel!(appell_euc_jacobians, euc_jacobians, [6, 2, 11] -> 54, |p, x, u, out| {
    let j = euc_jacobians::jacobians(p, x, u);
    lay(out, j.rates.into(), rows!(j.a, 6), rows!(j.b, 2));
});
kernel!(appell_bicycle_equations, bicycle_equations, [11, 2, 26] -> 12, |p, x, u, out| {
    let left = bicycle_equations::mass_matrix_and_bias(p, x, u);
    out[..9].copy_from_slice(left.mass_matrix.as_flattened());
    out[9..].copy_from_slice(&<[f64; 3]>::from(left.bias));
});
kernel!(appell_bicycle_state, bicycle_state, [11, 2, 26] -> 154, |p, x, u, out| {
    let j = bicycle_state::jacobians(p, x, u);
    lay(out, j.rates.into(), rows!(j.a, 11), rows!(j.b, 2));
});
kernel!(appell_bicycle_parameters, bicycle_parameters, [11, 2, 26] -> 440, |p, x, u, out| {
    let j = bicycle_parameters::jacobians(p, x, u);
    let (state, parameters) = out.split_at_mut(154);
    lay(state, j.rates.into(), rows!(j.a, 11), rows!(j.b, 2));
    let all = bicycle_parameters::parameter_jacobian(p, x, u);
    parameters.copy_from_slice(rows!(all, 26).as_flattened());
});
