//! A compiled kernel, and its calls.
// The driver starts a kernel with addresses, and cannot check that they fit. The library of the driver is loaded, and its
// code runs, as that of any library.
#![allow(unsafe_code)]

use std::sync::Arc;

use cudarc::driver::{
    CudaFunction, CudaSlice, CudaStream, DevicePtr as _, DeviceRepr, LaunchConfig,
    PushKernelArg as _,
};

use crate::error::CardError;

/// Threads of a block: few, since a motion needs many registers.
const THREADS: u32 = 64;

/// An argument of a kernel.
#[derive(Debug)]
pub enum Argument<'a> {
    /// An integer.
    Integer(i32),
    /// A number.
    Number(f64),
    /// Numbers that it reads.
    Numbers(&'a [f64]),
    /// Integers that it reads.
    Integers(&'a [i32]),
    /// Numbers that it writes.
    Into(&'a mut [f64]),
    /// Integers that it writes.
    IntoIntegers(&'a mut [i32]),
    /// The address of an array in the memory of the card.
    At(u64),
}

/// Numbers in the memory of a card.
#[derive(Debug)]
pub struct Memory(pub(crate) CudaSlice<f64>);

impl Drop for Memory {
    fn drop(&mut self) {
        // It may be freed by a thread that has not used the card. If this fails, so does freeing.
        let _ = self.0.stream().context().bind_to_thread();
    }
}

impl Memory {
    /// Their address.
    pub fn address(&self) -> u64 {
        self.0.device_ptr(self.0.stream()).0
    }

    /// A copy.
    pub fn read(&self) -> Result<Vec<f64>, CardError> {
        let numbers = self.0.stream().clone_dtoh(&self.0)?;
        self.0.stream().synchronize()?;
        Ok(numbers)
    }
}

/// A compiled kernel.
#[derive(Debug, Clone)]
pub struct Kernel {
    stream: Arc<CudaStream>,
    function: CudaFunction,
}

/// An argument as it is passed.
enum Passed {
    Integer(i32),
    Number(f64),
    Numbers(CudaSlice<f64>),
    Integers(CudaSlice<i32>),
    At(u64),
}

/// Whether the libraries of the driver and of the compiler are there.
pub(crate) fn libraries() -> Result<(), CardError> {
    // SAFETY: loading runs the initialisers of these libraries, as linking to them would.
    if !unsafe { cudarc::driver::sys::is_culib_present() } {
        return Err(CardError::Missing {
            what: "driver of a graphics card",
            library: "libcuda.so",
            package: "the driver of NVIDIA",
        });
    }
    // SAFETY: as above.
    if !unsafe { cudarc::nvrtc::sys::is_culib_present() } {
        return Err(CardError::Missing {
            what: "compiler for graphics cards",
            library: "libnvrtc.so",
            package: "the CUDA toolkit or the package `nvidia-cuda-nvrtc-cu12`",
        });
    }
    Ok(())
}

impl Kernel {
    pub(crate) fn new(stream: Arc<CudaStream>, function: CudaFunction) -> Self {
        Self { stream, function }
    }

    /// Calls the kernel with so many places, a thread each, and waits for it. The number of places is its first argument.
    ///
    /// The kernel must have these arguments and must stay within the arrays: the emitted ones do if the arrays have the
    /// lengths that their sources state.
    pub fn call(&self, places: usize, arguments: &mut [Argument<'_>]) -> Result<(), CardError> {
        let Ok(count) = i32::try_from(places) else {
            let most = i32::MAX as usize;
            return Err(CardError::TooMany { places, most });
        };
        if count == 0 {
            return Ok(());
        }
        let passed = arguments.iter().map(|argument| self.passed(argument));
        let passed = passed.collect::<Result<Vec<_>, CardError>>()?;
        let mut launch = self.stream.launch_builder(&self.function);
        launch.arg(&count);
        for argument in &passed {
            match argument {
                Passed::Integer(one) => launch.arg(one),
                Passed::Number(one) => launch.arg(one),
                Passed::Numbers(all) => launch.arg(all),
                Passed::Integers(all) => launch.arg(all),
                Passed::At(address) => launch.arg(address),
            };
        }
        let config = LaunchConfig {
            grid_dim: (count.unsigned_abs().div_ceil(THREADS), 1, 1),
            block_dim: (THREADS, 1, 1),
            shared_mem_bytes: 0,
        };
        // SAFETY: the caller passes the arguments of the kernel, as documented.
        unsafe { launch.launch(config) }?;
        for (argument, passed) in arguments.iter_mut().zip(&passed) {
            match (argument, passed) {
                (Argument::Into(all), Passed::Numbers(held)) if !all.is_empty() => {
                    self.stream.memcpy_dtoh(held, *all)?;
                }
                (Argument::IntoIntegers(all), Passed::Integers(held)) if !all.is_empty() => {
                    self.stream.memcpy_dtoh(held, *all)?;
                }
                _ => {}
            }
        }
        self.stream.synchronize()?;
        Ok(())
    }

    /// An argument with its array in the memory of the card.
    fn passed(&self, argument: &Argument<'_>) -> Result<Passed, CardError> {
        Ok(match argument {
            Argument::Integer(one) => Passed::Integer(*one),
            Argument::Number(one) => Passed::Number(*one),
            Argument::Numbers(all) => Passed::Numbers(self.copied(all)?),
            Argument::Integers(all) => Passed::Integers(self.copied(all)?),
            Argument::Into(all) => Passed::Numbers(self.stream.alloc_zeros(all.len().max(1))?),
            Argument::IntoIntegers(all) => {
                Passed::Integers(self.stream.alloc_zeros(all.len().max(1))?)
            }
            Argument::At(address) => Passed::At(*address),
        })
    }

    /// A copy in the memory of the card, which has no empty arrays.
    fn copied<T: DeviceRepr + Default + Clone>(
        &self,
        all: &[T],
    ) -> Result<CudaSlice<T>, CardError> {
        let one = [T::default()];
        let all = if all.is_empty() { &one } else { all };
        Ok(self.stream.clone_htod(all)?)
    }
}
