//! Code for the vectors of the processor at hand.

/// Vectors that code is compiled for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// What every processor of the target has.
    Plain,
    /// Four numbers and fused multiply-adds: AVX2 and FMA.
    Avx2,
    /// Eight numbers: AVX-512.
    Avx512,
}

impl Level {
    /// All levels.
    pub const ALL: [Self; 3] = [Self::Plain, Self::Avx2, Self::Avx512];

    /// The widest vectors of this processor.
    #[must_use]
    pub fn best() -> Self {
        let available = |level: &Self| level.is_available();
        let widest = Self::ALL.into_iter().rev().find(available);
        widest.unwrap_or(Self::Plain)
    }

    /// Whether this processor has them.
    #[must_use]
    pub fn is_available(self) -> bool {
        match self {
            Self::Plain => true,
            #[cfg(all(feature = "std", target_arch = "x86_64"))]
            Self::Avx2 => pulp::x86::V3::is_available(),
            #[cfg(all(feature = "std", target_arch = "x86_64"))]
            Self::Avx512 => pulp::x86::V4::is_available(),
            #[cfg(not(all(feature = "std", target_arch = "x86_64")))]
            Self::Avx2 | Self::Avx512 => false,
        }
    }

    /// Runs a task that is compiled for this level, or for the next lower one that the processor has. Only
    /// what is inlined into the task is: mark it, and all it calls, `#[inline(always)]`.
    #[inline(always)]
    pub fn run(self, task: impl FnMut()) {
        if let Err(mut task) = self.run_in_vectors(task) {
            task();
        }
    }

    /// Runs a task only if there is code for vectors and fused multiply-adds that the processor has, and gives it back
    /// otherwise; beyond x86-64 every processor counts as one.
    // A task that is called by reference is not inlined. Beyond x86-64 none comes back.
    #[cfg_attr(
        not(all(feature = "std", target_arch = "x86_64")),
        allow(clippy::unnecessary_wraps)
    )]
    #[inline(always)]
    pub(super) fn run_in_vectors<F: FnMut()>(self, task: F) -> Result<(), F> {
        #[cfg(all(feature = "std", target_arch = "x86_64"))]
        {
            use pulp::Simd;
            if self >= Self::Avx512
                && let Some(simd) = pulp::x86::V4::try_new()
            {
                Simd::vectorize(simd, Task(task));
                return Ok(());
            }
            if self >= Self::Avx2
                && let Some(simd) = pulp::x86::V3::try_new()
            {
                Simd::vectorize(simd, Task(task));
                return Ok(());
            }
            Err(task)
        }
        #[cfg(not(all(feature = "std", target_arch = "x86_64")))]
        {
            let _ = self;
            let mut task = task;
            task();
            Ok(())
        }
    }
}

/// Runs a task that is compiled for the widest vectors of this processor, see [`Level::run`].
#[inline(always)]
pub fn dispatch(task: impl FnMut()) {
    Level::Avx512.run(task);
}

#[cfg(all(feature = "std", target_arch = "x86_64"))]
struct Task<F>(F);

#[cfg(all(feature = "std", target_arch = "x86_64"))]
impl<F: FnMut()> pulp::WithSimd for Task<F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(mut self, _: S) {
        (self.0)();
    }
}
