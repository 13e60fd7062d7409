//! Evaluation of eight points at once.
//!
//! A *block* is [`LANES`] points that are evaluated together, component by component: component i of point l is
//! `x[i][l]`. The processor evaluates a block as one vector of eight numbers, as two of four, or number by number, as
//! detected at run time. Blocks always have eight points, and every lane executes the same operations, so that no
//! result depends on the processor. Fill an incomplete block by repeating the last point.

// Only inlined functions are compiled for the vector instructions of the processor.
#![allow(clippy::inline_always)]

mod blocks;

pub use blocks::Blocks;

/// Number of points of a block.
pub const LANES: usize = 8;

/// Several points at which equations are evaluated. All numbers in SI, in the order of the model's vectors.
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

/// Runs a task that is compiled for the widest vectors of this processor: AVX-512, or AVX2 with fused multiply-adds.
/// This applies to inlined code only: mark the task, and all it calls, `#[inline(always)]`.
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
