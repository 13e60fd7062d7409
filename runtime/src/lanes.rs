//! Eight places at once.
//!
//! A *block* is [`LANES`] places that are evaluated together, component by component: component i of
//! place l lies at `x[i][l]`. The processor does a block as one vector of eight numbers, as two of
//! four, or number by number; what it has is found out when the program runs. A block has eight places in
//! all cases, and every lane goes the same way, so that no result depends on the processor. Where
//! places are left over, repeat the last one.

// What is not inlined is not compiled for the vectors of the processor.
#![allow(clippy::inline_always)]

/// How many places a block has.
pub const LANES: usize = 8;

/// Where equations are evaluated, several places at once. All numbers in SI, in the order of the
/// model's vectors.
#[derive(Debug, Clone, Copy)]
pub struct AtLanes<'a> {
    /// Times in seconds.
    pub t: &'a [f64; LANES],
    /// States: pseudo-velocities, coordinates.
    pub x: &'a [[f64; LANES]],
    /// Inputs, then signals.
    pub u: &'a [[f64; LANES]],
    /// Parameters.
    pub p: &'a [[f64; LANES]],
}

/// Runs a task that is compiled for the widest vectors of this processor: AVX-512, or AVX2 with fused
/// multiply-adds. Only what is inlined into the task is: mark it, and all it calls, `#[inline(always)]`.
#[inline(always)]
pub fn dispatch(task: impl FnMut()) {
    #[cfg(target_arch = "x86_64")]
    {
        use pulp::Simd;
        if let Some(simd) = pulp::x86::V4::try_new() {
            Simd::vectorize(simd, Task(task));
            return;
        }
        if let Some(simd) = pulp::x86::V3::try_new() {
            Simd::vectorize(simd, Task(task));
            return;
        }
    }
    let mut task = task;
    task();
}

#[cfg(target_arch = "x86_64")]
struct Task<F>(F);

#[cfg(target_arch = "x86_64")]
impl<F: FnMut()> pulp::WithSimd for Task<F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(mut self, _: S) {
        (self.0)();
    }
}
